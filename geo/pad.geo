// SPDX-License-Identifier: GPL-3.0-or-later
// Square foam pad with an impact zone in its middle. Lengths in millimetres.
//
// The impact zone is a lattice of hexahedra through the whole thickness; the rest is filled with tetrahedra that grow
// from the fine spacing at the zone to the outer spacing at the pad's edges. The zone's sides are not recombined and
// the zone is meshed with TransfQuadTri: the pyramids that join quadrangles to triangles then sit inside the zone's
// outermost layer, half a cell high, and the volume is exact.
//
// Frame: base at z = 0, top at z = thickness, axis of the drop at x = y = 0. The quarter model is x >= 0, y >= 0.

DefineConstant[
  side = {400, Min 100, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 10, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  zone_side = {200, Min 20, Max 400, Step 10, Name "Pad/3 Side of the impact zone [mm]"},
  fine_spacing = {5, Min 1, Max 20, Step 0.5, Name "Pad/4 Spacing in the impact zone [mm]"},
  outer_spacing = {10, Min 1, Max 40, Step 0.5, Name "Pad/5 Spacing at the outer edges [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/6 Quarter model (x >= 0, y >= 0)"}
];

If (thickness <= 0 || fine_spacing <= 0 || outer_spacing <= 0 || zone_side <= 0)
  Error("pad.geo: thickness, zone_side, fine_spacing and outer_spacing must be above 0");
EndIf
If (zone_side + 2 * fine_spacing > side)
  Error("pad.geo: zone_side = %g leaves less than one fine spacing up to side = %g", zone_side, side);
EndIf

a = zone_side / 2;
b = side / 2;
half_cells = Round(a / fine_spacing); // per half side, so that the quarter is a quarter of the full lattice
layers = Round(thickness / fine_spacing);
If (half_cells < 1 || layers < 1)
  Error("pad.geo: fine_spacing = %g is larger than the zone or the thickness", fine_spacing);
EndIf

If (quarter == 0)
  // Corners of the zone (1-4) and of the pad (5-8), counter-clockwise; +10 on the top.
  For k In {0:1}
    Point(10*k + 1) = {-a, -a, k*thickness, fine_spacing};
    Point(10*k + 2) = { a, -a, k*thickness, fine_spacing};
    Point(10*k + 3) = { a,  a, k*thickness, fine_spacing};
    Point(10*k + 4) = {-a,  a, k*thickness, fine_spacing};
    Point(10*k + 5) = {-b, -b, k*thickness, outer_spacing};
    Point(10*k + 6) = { b, -b, k*thickness, outer_spacing};
    Point(10*k + 7) = { b,  b, k*thickness, outer_spacing};
    Point(10*k + 8) = {-b,  b, k*thickness, outer_spacing};
    For i In {1:4}
      j = (i % 4) + 1;
      Line(10*k + i) = {10*k + i, 10*k + j};
      Line(10*k + 4 + i) = {10*k + 4 + i, 10*k + 4 + j};
      Transfinite Curve {10*k + i} = 2 * half_cells + 1;
    EndFor
    Curve Loop(10*k + 1) = {10*k + 1 : 10*k + 4};
    Curve Loop(10*k + 2) = {10*k + 5 : 10*k + 8};
    Plane Surface(10*k + 1) = {10*k + 1};
    Plane Surface(10*k + 2) = {10*k + 2, 10*k + 1};
  EndFor
  For i In {1:8}
    Line(20 + i) = {i, 10 + i};
  EndFor
  For i In {1:4}
    j = (i % 4) + 1;
    Transfinite Curve {20 + i} = layers + 1;
    Curve Loop(20 + i) = {i, 20 + j, -(10 + i), -(20 + i)};
    Plane Surface(20 + i) = {20 + i};
    Curve Loop(24 + i) = {4 + i, 24 + j, -(14 + i), -(24 + i)};
    Plane Surface(24 + i) = {24 + i};
  EndFor
  Transfinite Surface {1, 11, 21:24};
  Recombine Surface {1, 11};
  Surface Loop(1) = {1, 11, 21:24};
  Surface Loop(2) = {2, 12, 21:24, 25:28};
  Physical Surface("sides") = {25:28};
Else
  // Zone: 1 on the axis, 2 on +x, 3 corner, 4 on +y. Pad: 5 on +x, 6 corner, 7 on +y; +10 on the top.
  For k In {0:1}
    Point(10*k + 1) = {0, 0, k*thickness, fine_spacing};
    Point(10*k + 2) = {a, 0, k*thickness, fine_spacing};
    Point(10*k + 3) = {a, a, k*thickness, fine_spacing};
    Point(10*k + 4) = {0, a, k*thickness, fine_spacing};
    Point(10*k + 5) = {b, 0, k*thickness, outer_spacing};
    Point(10*k + 6) = {b, b, k*thickness, outer_spacing};
    Point(10*k + 7) = {0, b, k*thickness, outer_spacing};
    For i In {1:4}
      j = (i % 4) + 1;
      Line(10*k + i) = {10*k + i, 10*k + j};
      Transfinite Curve {10*k + i} = half_cells + 1;
    EndFor
    Line(10*k + 5) = {10*k + 2, 10*k + 5};
    Line(10*k + 6) = {10*k + 5, 10*k + 6};
    Line(10*k + 7) = {10*k + 6, 10*k + 7};
    Line(10*k + 8) = {10*k + 7, 10*k + 4};
    Curve Loop(10*k + 1) = {10*k + 1 : 10*k + 4};
    Curve Loop(10*k + 2) = {10*k + 5, 10*k + 6, 10*k + 7, 10*k + 8, -(10*k + 3), -(10*k + 2)};
    Plane Surface(10*k + 1) = {10*k + 1};
    Plane Surface(10*k + 2) = {10*k + 2};
  EndFor
  For i In {1:7}
    Line(20 + i) = {i, 10 + i};
  EndFor
  For i In {1:4}
    j = (i % 4) + 1;
    Transfinite Curve {20 + i} = layers + 1;
    Curve Loop(20 + i) = {i, 20 + j, -(10 + i), -(20 + i)};
    Plane Surface(20 + i) = {20 + i};
  EndFor
  Curve Loop(25) = {5, 25, -15, -22};
  Curve Loop(26) = {6, 26, -16, -25};
  Curve Loop(27) = {7, 27, -17, -26};
  Curve Loop(28) = {8, 24, -18, -27};
  For i In {25:28}
    Plane Surface(i) = {i};
  EndFor
  Transfinite Surface {1, 11, 21:24};
  Recombine Surface {1, 11, 21, 24}; // 22 and 23 are the interface: left as triangles
  Surface Loop(1) = {1, 11, 21:24};
  Surface Loop(2) = {2, 12, 22, 23, 25:28};
  Physical Surface("sides") = {26, 27};
  Physical Surface("symmetry_x") = {24, 28}; // the plane x = 0
  Physical Surface("symmetry_y") = {21, 25}; // the plane y = 0
EndIf

Volume(1) = {1};
Volume(2) = {2};
Transfinite Volume {1};
TransfQuadTri {1};
Physical Surface("base") = {1, 2};
Physical Surface("top") = {11, 12};
Physical Volume("pad") = {1, 2};

// One thread and Delaunay: the same mesh, bit for bit, on every run.
Mesh.Algorithm3D = 1;
