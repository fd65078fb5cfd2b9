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
  Error("cube.geo: side and spacing must be above 0");
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
Extrude {0, 0, side} { Surface{1}; Layers{layers}; Recombine; }

// The groups are chosen by place: the surfaces inside a thin box around each plane.
tol = 1e-6 * side;
low_x() = Surface In BoundingBox{a - tol, -side, -tol, a + tol, side, side + tol};
low_y() = Surface In BoundingBox{-side, a - tol, -tol, side, a + tol, side + tol};
high() = Surface In BoundingBox{b - tol, -side, -tol, b + tol, side, side + tol};
high() += Surface In BoundingBox{-side, b - tol, -tol, side, b + tol, side + tol};
base() = Surface In BoundingBox{-side, -side, -tol, side, side, tol};
top() = Surface In BoundingBox{-side, -side, side - tol, side, side, side + tol};
pad() = Volume In BoundingBox{-side, -side, -tol, side, side, side + tol};
Physical Volume("pad") = pad();
Physical Surface("base") = base();
Physical Surface("top") = top();
If (quarter == 0)
  Physical Surface("sides") = {high(), low_x(), low_y()};
Else
  Physical Surface("sides") = high();
  Physical Surface("symmetry_x") = low_x(); // the plane x = 0
  Physical Surface("symmetry_y") = low_y(); // the plane y = 0
EndIf
