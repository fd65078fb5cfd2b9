// SPDX-License-Identifier: GPL-3.0-or-later
// Square foam pad with round holes through it, in a square pattern about its middle. Lengths in millimetres.
//
// Frame: base at z = 0, top at z = thickness, axis of the drop at x = y = 0, which is the middle of the pattern: of a
// hole when the number of holes along a side is odd, of four holes when it is even. The quarter model is x >= 0, y >= 0.

SetFactory("OpenCASCADE");

DefineConstant[
  side = {300, Min 20, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 5, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  hole_diameter = {16, Min 1, Max 100, Step 1, Name "Pad/3 Diameter of the holes [mm]"},
  pitch = {40, Min 2, Max 200, Step 1, Name "Pad/4 Distance of the holes' axes [mm]"},
  holes = {6, Min 1, Max 40, Step 1, Name "Pad/5 Holes along a side"},
  spacing = {6, Min 1, Max 40, Step 0.5, Name "Pad/6 Spacing [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/7 Quarter model (x >= 0, y >= 0)"}
];

If (side <= 0 || thickness <= 0 || hole_diameter <= 0 || spacing <= 0)
  Error("cored.geo: side, thickness, hole_diameter and spacing must be above 0");
EndIf
If (holes < 1 || holes != Round(holes))
  Error("cored.geo: holes = %g must be 1, 2, 3, ...", holes);
EndIf
If (pitch <= hole_diameter)
  Error("cored.geo: the holes meet: pitch = %g must be more than hole_diameter", pitch);
EndIf
If ((holes - 1) * pitch + hole_diameter >= side)
  Error("cored.geo: %g holes at a pitch of %g do not fit into side = %g", holes, pitch, side);
EndIf

b = side / 2;
layers = Round(thickness / spacing);
If (layers < 1)
  Error("cored.geo: spacing = %g is larger than the thickness", spacing);
EndIf

// The plane of the base without its holes, extruded in layers.
begin = quarter == 0 ? -b : 0;
Rectangle(1) = {begin, begin, 0, b - begin, b - begin};
hole() = {};
For i In {0 : holes - 1}
  For j In {0 : holes - 1}
    x = (i - (holes - 1) / 2) * pitch;
    y = (j - (holes - 1) / 2) * pitch;
    If (quarter == 0 || (x + hole_diameter / 2 > 0 && y + hole_diameter / 2 > 0))
      s = news;
      Disk(s) = {x, y, 0, hole_diameter / 2};
      hole() += s;
    EndIf
  EndFor
EndFor
plate() = BooleanDifference{ Surface{1}; Delete; }{ Surface{hole()}; Delete; };
Extrude {0, 0, thickness} { Surface{plate()}; Layers{layers}; Recombine; }

tol = 1e-6 * side;
Physical Volume("pad") = Volume{:};
base() = Surface In BoundingBox{-b - tol, -b - tol, -tol, b + tol, b + tol, tol};
top() = Surface In BoundingBox{-b - tol, -b - tol, thickness - tol, b + tol, b + tol, thickness + tol};
Physical Surface("base") = base();
Physical Surface("top") = top();
If (quarter != 0)
  Physical Surface("symmetry_x") = Surface In BoundingBox{-tol, -tol, -tol, tol, b + tol, thickness + tol};
  Physical Surface("symmetry_y") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, tol, thickness + tol};
EndIf

Mesh.MeshSizeMin = spacing;
Mesh.MeshSizeMax = spacing;
Mesh.Algorithm3D = 1;
