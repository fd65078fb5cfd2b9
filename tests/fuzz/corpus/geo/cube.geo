// SPDX-License-Identifier: GPL-3.0-or-later
// Foam cube for a compression test, a lattice of hexahedra. Lengths in millimetres.
//
// Frame: base at z = 0, top at z = side, axis at x = y = 0. The quarter model is x >= 0, y >= 0.

DefineConstant[
  side = {50, Min 5, Max 500, Step 5, Name "Cube/1 Side [mm]"},
  spacing = {10, Min 0.5, Max 50, Step 0.5, Name "Cube/2 Spacing [mm]"},
  quarter = {0, Choices {0, 1}, Name "Cube/3 Quarter model (x >= 0, y >= 0)"}
];

If (side <= 0 || spacing <= 0)
  Error("cube.geo: side and spacing must be positive");
EndIf

b = side / 2;
a = (quarter == 0) ? -b : 0;
layers = Round(side / spacing);
cells = (quarter == 0) ? layers : Ceil(side / spacing / 2 - 1e-9); // half a cell cannot be
If (layers < 1)
  Error("cube.geo: spacing = %g is larger than the cube", spacing);
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
// The top, the volume, then the sides over the lines 1 (y = a), 2 (x = b), 3 (y = b) and 4 (x = a).
cube() = Extrude {0, 0, side} { Surface{1}; Layers{layers}; Recombine; };

Physical Volume("pad") = {cube(1)};
Physical Surface("base") = {1};
Physical Surface("top") = {cube(0)};
If (quarter == 0)
  Physical Surface("sides") = {cube(2), cube(3), cube(4), cube(5)};
Else
  Physical Surface("sides") = {cube(3), cube(4)};
  Physical Surface("symmetry_x") = {cube(5)}; // the plane x = 0
  Physical Surface("symmetry_y") = {cube(2)}; // the plane y = 0
EndIf
