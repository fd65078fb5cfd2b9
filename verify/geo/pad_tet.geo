// SPDX-License-Identifier: GPL-3.0-or-later
// The square pad of geo/pad.geo filled with tetrahedra only: same frame, groups and parameters. Lengths in millimetres.
// The spacing is the fine one over the impact zone and grows linearly to the outer one at the edges.

DefineConstant[
  side = {400, Min 100, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 10, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  zone_side = {200, Min 20, Max 400, Step 10, Name "Pad/3 Side of the impact zone [mm]"},
  fine_spacing = {5, Min 1, Max 20, Step 0.5, Name "Pad/4 Spacing in the impact zone [mm]"},
  outer_spacing = {10, Min 1, Max 40, Step 0.5, Name "Pad/5 Spacing at the outer edges [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/6 Quarter model (x >= 0, y >= 0)"}
];

If (thickness <= 0 || fine_spacing <= 0 || outer_spacing <= 0 || zone_side <= 0 || zone_side > side)
  Error("pad_tet.geo: thickness, spacings and zone_side must be positive, and zone_side at most side");
EndIf

b = side / 2;
low = -b;
If (quarter != 0)
  low = 0;
EndIf

For k In {0:1}
  Point(4*k + 1) = {low, low, k*thickness};
  Point(4*k + 2) = {  b, low, k*thickness};
  Point(4*k + 3) = {  b,   b, k*thickness};
  Point(4*k + 4) = {low,   b, k*thickness};
EndFor
For i In {1:4}
  j = (i % 4) + 1;
  Line(i) = {i, j};
  Line(4 + i) = {4 + i, 4 + j};
  Line(8 + i) = {i, 4 + i};
EndFor
Curve Loop(1) = {1:4};
Curve Loop(2) = {5:8};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
For i In {1:4}
  j = (i % 4) + 1;
  Curve Loop(2 + i) = {i, 8 + j, -(4 + i), -(8 + i)};
  Plane Surface(2 + i) = {2 + i};
EndFor
Surface Loop(1) = {1:6};
Volume(1) = {1};

Physical Volume("pad") = {1};
Physical Surface("base") = {1};
Physical Surface("top") = {2};
If (quarter == 0)
  Physical Surface("sides") = {3:6};
Else
  Physical Surface("sides") = {4, 5};
  Physical Surface("symmetry_y") = {3}; // the plane y = 0
  Physical Surface("symmetry_x") = {6}; // the plane x = 0
EndIf

Field[1] = Box;
Field[1].VIn = fine_spacing;
Field[1].VOut = outer_spacing;
Field[1].XMin = -zone_side / 2;
Field[1].XMax = zone_side / 2;
Field[1].YMin = -zone_side / 2;
Field[1].YMax = zone_side / 2;
Field[1].ZMin = -1;
Field[1].ZMax = thickness + 1;
Field[1].Thickness = b - zone_side / 2;
Background Field = 1;
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;

// One thread and Delaunay: the same mesh, bit for bit, on every run.
Mesh.Algorithm3D = 1;
