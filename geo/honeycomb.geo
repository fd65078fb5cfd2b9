// SPDX-License-Identifier: GPL-3.0-or-later
// Square foam pad with hexagonal holes through it, as a honeycomb about its middle. Lengths in millimetres.
//
// Frame: base at z = 0, top at z = thickness, axis of the drop at x = y = 0, which is the middle of a hole. Two sides of each hexagon lie
// along x. A margin without holes goes round the pad. The model is always the quarter x >= 0, y >= 0.

SetFactory("OpenCASCADE");

DefineConstant[
  side = {300, Min 20, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 5, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  hole = {30, Min 2, Max 200, Step 1, Name "Pad/3 Width of the holes, from side to side [mm]"},
  wall = {12, Min 1, Max 100, Step 1, Name "Pad/4 Thickness of the walls [mm]"},
  spacing = {6, Min 0.5, Max 40, Step 0.5, Name "Pad/5 Spacing [mm]"}
];

If (side <= 0 || thickness <= 0 || hole <= 0 || wall <= 0 || spacing <= 0)
  Error("honeycomb.geo: side, thickness, hole, wall and spacing must be above 0");
EndIf
b = side / 2;
If (hole / 2 + 2 * wall >= b)
  Error("honeycomb.geo: a hole of %g with walls of %g does not fit into side = %g", hole, wall, side);
EndIf

// Rows along y at a pitch of hole + wall; the next column is half a pitch higher.
pitch = hole + wall;
step = pitch * Sqrt(3) / 2;
r = hole / Sqrt(3);
columns = Ceil(b / step);
rows = Ceil(b / pitch) + 1;
Rectangle(1) = {0, 0, 0, b, b};
holes() = {};
For i In {0 : columns}
  For j In {-1 : rows}
    x = i * step;
    y = (j + 0.5 * (i % 2)) * pitch;
    If (x + r + wall <= b && y + hole / 2 + wall <= b && y + hole / 2 > 0)
      p = newp;
      For k In {0 : 5}
        Point(p + k) = {x + r * Cos(k * Pi / 3), y + r * Sin(k * Pi / 3), 0};
      EndFor
      l = newl;
      For k In {0 : 5}
        Line(l + k) = {p + k, p + (k + 1) % 6};
      EndFor
      c = newll;
      Curve Loop(c) = {l : l + 5};
      s = news;
      Plane Surface(s) = {c};
      holes() += s;
    EndIf
  EndFor
EndFor
plate() = BooleanDifference{ Surface{1}; Delete; }{ Surface{holes()}; Delete; };
Extrude {0, 0, thickness} { Surface{plate()}; Layers{Max(1, Round(thickness / spacing))}; Recombine; }
Recombine Surface {plate()};

tol = 1e-6 * side;
Physical Volume("pad") = Volume{:};
Physical Surface("base") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, b + tol, tol};
Physical Surface("top") = Surface In BoundingBox{-tol, -tol, thickness - tol, b + tol, b + tol, thickness + tol};
Physical Surface("symmetry_x") = Surface In BoundingBox{-tol, -tol, -tol, tol, b + tol, thickness + tol};
Physical Surface("symmetry_y") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, tol, thickness + tol};

Mesh.MeshSizeMin = spacing;
Mesh.MeshSizeMax = spacing;
