// SPDX-License-Identifier: GPL-3.0-or-later
// Quarter of a thick block for indentation by a sphere: tetrahedra, fine within zone_side / 2 of the point of first touch
// (0, 0, thickness) and growing with the distance from there. Lengths in millimetres; parameters as in geo/pad.geo.
SetFactory("OpenCASCADE");

DefineConstant[
  side = {400, Min 10, Max 10000, Step 10, Name "Pad/1 Side of the block [mm]"},
  thickness = {200, Min 10, Max 10000, Step 5, Name "Pad/2 Thickness [mm]"},
  zone_side = {30, Min 1, Max 10000, Step 1, Name "Pad/3 Diameter of the fine zone [mm]"},
  fine_spacing = {3, Min 0.1, Max 100, Step 0.1, Name "Pad/4 Spacing in the fine zone [mm]"},
  outer_spacing = {40, Min 1, Max 1000, Step 1, Name "Pad/5 Largest spacing [mm]"},
  quarter = {1, Choices {1}, Name "Pad/6 Quarter model (always)"}
];

b = side / 2;
v = newv;
Box(v) = {0, 0, 0, b, b, thickness};
eps = 1e-6 * side;
base() = Surface In BoundingBox{-eps, -eps, -eps, b + eps, b + eps, eps};
top() = Surface In BoundingBox{-eps, -eps, thickness - eps, b + eps, b + eps, thickness + eps};
plane_x() = Surface In BoundingBox{-eps, -eps, -eps, eps, b + eps, thickness + eps};
plane_y() = Surface In BoundingBox{-eps, -eps, -eps, b + eps, eps, thickness + eps};
Physical Surface("base") = base();
Physical Surface("top") = top();
Physical Surface("symmetry_x") = plane_x();
Physical Surface("symmetry_y") = plane_y();
Physical Volume("pad") = {v};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + 0.15 * (sqrt(x*x + y*y + (z - %g)*(z - %g)) - %g + abs(sqrt(x*x + y*y + (z - %g)*(z - %g)) - %g)) / 2",
                     fine_spacing, thickness, thickness, zone_side / 2, thickness, thickness, zone_side / 2);
Background Field = 1;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Mesh.CharacteristicLengthMax = outer_spacing;
Mesh.Algorithm3D = 1;
