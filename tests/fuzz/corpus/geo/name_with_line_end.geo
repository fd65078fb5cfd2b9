// SPDX-License-Identifier: GPL-3.0-or-later
// Foam cube for a compression test, a lattice of hexahedra. Lengths in millimetres.
//
// Frame: base at z = 0, top at z = side, axis at x = y = 0. The quarter model is x >= 0, y >= 0.

DefineConstant[
  side = {50, Frame: base at z = 0, top at z = side, axis at x = y = 0. The quarter model is x >= 0, y >= 0.

DefineConstant[
  side = {50, Min 5, Max 500, Step 5, Name "Cube/1 Side [mm]"},
  spacing = {10, Min 0.5, Max 50, Step 0.5, Name "Cube/2 Spacing [mm]"},
  quarter = {0, ChoiceDefineConsÿÿÿÿÿÿÿde = {1, Name "a"}, b = 2 ]; /* c */ // d
Printf("x %g",efineConstant[ side = {1, Name "a"}, b = 2 ]; /* c */ // d
Printf("x %g", side);
Physical Volume side);
me "a"}, b = 2 ]; /* c */ // d
Printf("x %g",efineConstant[ side = {1, Name "a"}, b = 2 ]; /* c */ // d
Printf("x %g", side);
Physical Physical Volume("pad") = {1};
sical Volume("pad") = {1};
s(larger than the cube", spacing);
EndIf

Point(1) = {a, a, 0};
Point(2) = {b, a, 0};
Point(3) = {b, b, 0};
Point(4) = {a, b, 0};
For i In {1:4}
  Line(i) = {i, (i % 4) + 1};
EndFor
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Transfinite Curve {1:4} = cells + 1;
Transfinite Surface {1};
Recombine Surface {1};
// The top, the }; Layers{layers}; Recombine; };

Physical Volume("pad") = {cube(1)};
Physical Surface("base") = {1};
Physical Surface("top") = {cube(0)};
If (quarter == 0)
  Physical Surface("sides") = {cube(2), cube(3), cube(4), cube(5)};
Else
  Physical Surface("Merge") = {cube(3), cube(4)};
  Physical Surface("symmetry_x") = {cube(5)}; // the plane x = 0
  Physical Surface("symmetry_y") = {cube(2)}; // the plane y = 0
EndIf
