// SPDX-License-Identifier: GPL-3.0-or-later
// The square pad of geo/pad.geo filled with hexahedra only: same frame, groups and parameters. Lengths in millimetres.
// A lattice of the fine spacing over the impact zone; around it the cells grow in geometric progression, each direction
// by itself, so that the last cell at the edge has about the outer spacing. Layers through the thickness are uniform.

DefineConstant[
  side = {400, Min 100, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 10, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  zone_side = {200, Min 20, Max 400, Step 10, Name "Pad/3 Side of the impact zone [mm]"},
  fine_spacing = {5, Min 1, Max 20, Step 0.5, Name "Pad/4 Spacing in the impact zone [mm]"},
  outer_spacing = {10, Min 1, Max 40, Step 0.5, Name "Pad/5 Spacing at the outer edges [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/6 Quarter model (x >= 0, y >= 0)"}
];

If (thickness <= 0 || fine_spacing <= 0 || outer_spacing <= 0 || zone_side <= 0)
  Error("pad_hex.geo: thickness, zone_side, fine_spacing and outer_spacing must be positive");
EndIf
If (zone_side + 2 * outer_spacing > side)
  Error("pad_hex.geo: zone_side = %g leaves less than one outer spacing up to side = %g", zone_side, side);
EndIf

a = zone_side / 2;
b = side / 2;
half_cells = Round(a / fine_spacing); // per half side, so that the quarter is a quarter of the full lattice
layers = Round(thickness / fine_spacing);
If (half_cells < 1 || layers < 1)
  Error("pad_hex.geo: fine_spacing = %g is larger than the zone or the thickness", fine_spacing);
EndIf
// A progression from the fine to the outer spacing over b - a has this ratio and this number of cells.
ratio = (b - a - fine_spacing) / (b - a - outer_spacing);
If (Fabs(ratio - 1) < 1e-6)
  outer_cells = Round((b - a) / fine_spacing);
  ratio = 1;
Else
  outer_cells = Round(Log(outer_spacing / fine_spacing) / Log(ratio)) + 1;
EndIf

// Lines of the block structure in one direction: -b, -a, a, b, or 0, a, b in the quarter model.
If (quarter == 0)
  blocks = 3;
  at() = {-b, -a, a, b};
  cells() = {outer_cells, 2 * half_cells, outer_cells};
  grow() = {1 / ratio, 1, ratio};
Else
  blocks = 2;
  at() = {0, a, b};
  cells() = {half_cells, outer_cells};
  grow() = {1, ratio};
EndIf

For j In {0:blocks}
  For i In {0:blocks}
    Point(1 + i + 10*j) = {at(i), at(j), 0};
  EndFor
EndFor
For j In {0:blocks}
  For i In {0:blocks - 1}
    Line(100 + i + 10*j) = {1 + i + 10*j, 2 + i + 10*j}; // along x
    Transfinite Curve {100 + i + 10*j} = cells(i) + 1 Using Progression grow(i);
    Line(200 + j + 10*i) = {1 + j + 10*i, 11 + j + 10*i}; // along y
    Transfinite Curve {200 + j + 10*i} = cells(i) + 1 Using Progression grow(i);
  EndFor
EndFor
base() = {};
For j In {0:blocks - 1}
  For i In {0:blocks - 1}
    k = 1 + i + 10*j;
    Curve Loop(k) = {100 + i + 10*j, 200 + i + 1 + 10*j, -(100 + i + 10*(j + 1)), -(200 + i + 10*j)};
    Plane Surface(k) = {k};
    Transfinite Surface {k};
    Recombine Surface {k};
    base() += {k};
  EndFor
EndFor
Extrude {0, 0, thickness} { Surface{base()}; Layers{layers}; Recombine; }

tol = 1e-6 * side;
pad() = Volume In BoundingBox{-side, -side, -side, side, side, thickness + side};
top() = Surface In BoundingBox{-side, -side, thickness - tol, side, side, thickness + tol};
sides() = Surface In BoundingBox{b - tol, -side, -tol, b + tol, side, thickness + tol};
sides() += Surface In BoundingBox{-side, b - tol, -tol, side, b + tol, thickness + tol};
If (quarter == 0)
  sides() += Surface In BoundingBox{-b - tol, -side, -tol, -b + tol, side, thickness + tol};
  sides() += Surface In BoundingBox{-side, -b - tol, -tol, side, -b + tol, thickness + tol};
Else
  plane_x() = Surface In BoundingBox{-tol, -side, -tol, tol, side, thickness + tol};
  plane_y() = Surface In BoundingBox{-side, -tol, -tol, side, tol, thickness + tol};
  Physical Surface("symmetry_x") = plane_x();
  Physical Surface("symmetry_y") = plane_y();
EndIf
Physical Volume("pad") = pad();
Physical Surface("base") = base();
Physical Surface("top") = top();
Physical Surface("sides") = sides();
