// SPDX-License-Identifier: GPL-3.0-or-later
// Section of a round foam pad for an axisymmetric drop (geometry.model = "axisymmetric"). Lengths in millimetres.
//
// The radius is along x, the height along y: the axis of the drop is x = 0, the base y = 0. Quadrangles in rows; below
// the impact zone they have the fine spacing, outside they grow to the outer one. A pad of 400 mm side and a round one of
// 200 mm radius are the same drop.

DefineConstant[
  radius = {200, Min 50, Max 500, Step 10, Name "Pad/1 Radius of the pad [mm]"},
  thickness = {50, Min 10, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  zone_radius = {100, Min 10, Max 400, Step 10, Name "Pad/3 Radius of the impact zone [mm]"},
  fine_spacing = {5, Min 0.5, Max 20, Step 0.5, Name "Pad/4 Spacing in the impact zone [mm]"},
  outer_spacing = {10, Min 0.5, Max 40, Step 0.5, Name "Pad/5 Spacing at the outer edge [mm]"}
];

If (thickness <= 0 || fine_spacing <= 0 || outer_spacing <= 0 || zone_radius <= 0)
  Error("section.geo: thickness, zone_radius, fine_spacing and outer_spacing must be above 0");
EndIf
If (zone_radius + fine_spacing + outer_spacing > radius)
  Error("section.geo: zone_radius = %g leaves less than two cells up to radius = %g", zone_radius, radius);
EndIf

cells = Round(zone_radius / fine_spacing);
rows = Round(thickness / fine_spacing);
If (cells < 1 || rows < 1)
  Error("section.geo: fine_spacing = %g is larger than the zone or the thickness", fine_spacing);
EndIf

// Cells outside the zone, each longer than the one before by the same factor.
rest = radius - zone_radius;
factor = (rest - fine_spacing) / (rest - outer_spacing);
If (Fabs(factor - 1) < 1e-6)
  outer = Round(rest / fine_spacing);
Else
  outer = 1 + Round(Log(outer_spacing / fine_spacing) / Log(factor));
EndIf

Point(1) = {0, 0, 0};
Point(2) = {zone_radius, 0, 0};
Point(3) = {radius, 0, 0};
Point(4) = {radius, thickness, 0};
Point(5) = {zone_radius, thickness, 0};
Point(6) = {0, thickness, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {5, 4};
Line(5) = {6, 5};
Line(6) = {1, 6};
Line(7) = {2, 5};
Curve Loop(1) = {1, 7, -5, -6};
Curve Loop(2) = {2, 3, -4, -7};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Transfinite Curve {1, 5} = cells + 1;
Transfinite Curve {2, 4} = outer + 1 Using Progression factor;
Transfinite Curve {3, 6, 7} = rows + 1;
Transfinite Surface {1, 2};
Recombine Surface {1, 2};

Physical Surface("pad") = {1, 2};
Physical Curve("base") = {1, 2};
Physical Curve("top") = {4, 5};
Physical Curve("sides") = {3};
