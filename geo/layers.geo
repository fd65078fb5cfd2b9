// SPDX-License-Identifier: GPL-3.0-or-later
// Square foam pad of up to three layers, a lattice of hexahedra: below "lower", on it "upper" and "cover", each a
// physical volume. A thickness of 0 leaves out the upper layer or the cover. Lengths in millimetres.
//
// The impact zone in the middle has the fine spacing, the rest the outer one in the directions that lead away.
// Neighbouring layers share the faces of their interface, as softfall-pre requires.
//
// Frame: base at z = 0, axis of the drop at x = y = 0. The quarter model is x >= 0, y >= 0.

DefineConstant[
  side = {300, Min 20, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  zone_side = {180, Min 10, Max 1000, Step 10, Name "Pad/2 Side of the impact zone [mm]"},
  lower = {20, Min 1, Max 200, Step 1, Name "Pad/3 Thickness of the lower layer [mm]"},
  upper = {25, Min 0, Max 200, Step 1, Name "Pad/4 Thickness of the upper layer [mm]"},
  cover = {5, Min 0, Max 100, Step 1, Name "Pad/5 Thickness of the cover [mm]"},
  fine_spacing = {5, Min 0.5, Max 50, Step 0.5, Name "Pad/6 Spacing in the impact zone, and across the layers [mm]"},
  outer_spacing = {10, Min 0.5, Max 50, Step 0.5, Name "Pad/7 Spacing outside the impact zone [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/8 Quarter model (x >= 0, y >= 0)"}
];

If (side <= 0 || zone_side <= 0 || lower <= 0 || upper < 0 || cover < 0 || fine_spacing <= 0 || outer_spacing <= 0)
  Error("layers.geo: lengths must be above 0; upper and cover may be 0");
EndIf
If (zone_side > side)
  Error("layers.geo: zone_side = %g is larger than side = %g", zone_side, side);
EndIf

b = side / 2;
a = zone_side / 2;
start = (quarter == 0) ? -b : 0;
length = b - start;
zone = Round(a / fine_spacing);           // cells of half the zone
outer = Round((b - a) / outer_spacing);   // cells on one side of it
If (b - a > 0 && outer < 1)
  outer = 1;
EndIf
If (zone < 1)
  Error("layers.geo: fine_spacing = %g is larger than the zone", fine_spacing);
EndIf

// Cells and relative heights of one direction.
If (quarter == 0 && outer > 0)
  cells() = {outer, 2 * zone, outer};
  ends() = {(b - a) / length, (b + a) / length, 1};
ElseIf (quarter == 0)
  cells() = {2 * zone};
  ends() = {1};
ElseIf (outer > 0)
  cells() = {zone, outer};
  ends() = {a / length, 1};
Else
  cells() = {zone};
  ends() = {1};
EndIf

Point(1) = {start, start, 0};
row() = Extrude {length, 0, 0} { Point{1}; Layers{cells(), ends()}; };
floor() = Extrude {0, length, 0} { Curve{row(1)}; Layers{cells(), ends()}; Recombine; };
layer_lower() = Extrude {0, 0, lower} { Surface{floor(1)}; Layers{(lower < 1.5 * fine_spacing) ? 1 : Round(lower / fine_spacing)}; Recombine; };
Physical Volume("lower") = {layer_lower(1)};
last = layer_lower(0);
If (upper > 0)
  layer_upper() = Extrude {0, 0, upper} { Surface{last}; Layers{(upper < 1.5 * fine_spacing) ? 1 : Round(upper / fine_spacing)}; Recombine; };
  Physical Volume("upper") = {layer_upper(1)};
  last = layer_upper(0);
EndIf
If (cover > 0)
  layer_cover() = Extrude {0, 0, cover} { Surface{last}; Layers{(cover < 1.5 * fine_spacing) ? 1 : Round(cover / fine_spacing)}; Recombine; };
  Physical Volume("cover") = {layer_cover(1)};
  last = layer_cover(0);
EndIf

// The groups of the sides are chosen by place: the surfaces inside a thin box around each plane.
high = lower + upper + cover;
tol = 1e-6 * side;
low_x() = Surface In BoundingBox{start - tol, -side, -tol, start + tol, side, high + tol};
low_y() = Surface In BoundingBox{-side, start - tol, -tol, side, start + tol, high + tol};
far() = Surface In BoundingBox{b - tol, -side, -tol, b + tol, side, high + tol};
far() += Surface In BoundingBox{-side, b - tol, -tol, side, b + tol, high + tol};
Physical Surface("base") = {floor(1)};
Physical Surface("top") = {last};
If (quarter == 0)
  Physical Surface("sides") = {far(), low_x(), low_y()};
Else
  Physical Surface("sides") = far();
  Physical Surface("symmetry_x") = low_x(); // the plane x = 0
  Physical Surface("symmetry_y") = low_y(); // the plane y = 0
EndIf
