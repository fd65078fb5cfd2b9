// SPDX-License-Identifier: GPL-3.0-or-later
// Quarter of a square pad as a lattice of hexahedra: the mesh that the comparison with CalculiX gives to both codes.
// Lengths in millimetres. Base at z = 0, top at z = thickness, axis of the indentation at x = y = 0.

DefineConstant[
  side = {200, Min 40, Max 1000, Step 10, Name "Pad/1 Side of the whole pad [mm]"},
  thickness = {50, Min 10, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  layers = {5, Min 1, Max 100, Step 1, Name "Pad/3 Layers through the thickness"},
  half_cells = {10, Min 1, Max 400, Step 1, Name "Pad/4 Cells along half the side"}
];

b = side / 2;
Point(1) = {0, 0, 0};
Point(2) = {b, 0, 0};
Point(3) = {b, b, 0};
Point(4) = {0, b, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = half_cells + 1;
Transfinite Surface {1};
Recombine Surface {1};

Extrude {0, 0, thickness} { Surface{1}; Layers{layers}; Recombine; }

tol = 1e-6 * side;
pad() = Volume In BoundingBox{-tol, -tol, -tol, b + tol, b + tol, thickness + tol};
base() = Surface In BoundingBox{-tol, -tol, -tol, b + tol, b + tol, tol};
top() = Surface In BoundingBox{-tol, -tol, thickness - tol, b + tol, b + tol, thickness + tol};
plane_x() = Surface In BoundingBox{-tol, -tol, -tol, tol, b + tol, thickness + tol};
plane_y() = Surface In BoundingBox{-tol, -tol, -tol, b + tol, tol, thickness + tol};
sides() = Surface In BoundingBox{b - tol, -tol, -tol, b + tol, b + tol, thickness + tol};
sides() += Surface In BoundingBox{-tol, b - tol, -tol, b + tol, b + tol, thickness + tol};
Physical Volume("pad") = pad();
Physical Surface("base") = base();
Physical Surface("top") = top();
Physical Surface("sides") = sides();
Physical Surface("symmetry_x") = plane_x();
Physical Surface("symmetry_y") = plane_y();
