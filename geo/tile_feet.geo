// SPDX-License-Identifier: GPL-3.0-or-later
// Playground tile: a square plate on square feet, in a square pattern about its middle. Lengths in millimetres.
//
// Frame: feet on z = 0, top at z = foot_height + plate, axis of the drop at x = y = 0. The gap between feet is as wide as a foot, so that
// the pitch is twice the foot; the middle is that of a foot, or with shifted = 1 that of the square between four feet. The model is always
// the quarter x >= 0, y >= 0.

DefineConstant[
  foot = {40, Min 4, Max 200, Step 1, Name "Tile/1 Side of a foot, and gap between feet [mm]"},
  foot_height = {20, Min 1, Max 200, Step 1, Name "Tile/2 Height of the feet [mm]"},
  plate = {25, Min 2, Max 200, Step 1, Name "Tile/3 Thickness of the plate [mm]"},
  squares = {7, Min 1, Max 40, Step 1, Name "Tile/4 Half squares, of half a foot, from the middle to the edge"},
  spacing = {6.667, Min 0.5, Max 40, Step 0.5, Name "Tile/5 Spacing [mm]"},
  shifted = {0, Choices {0, 1}, Name "Tile/6 Middle between four feet"}
];

If (foot <= 0 || foot_height <= 0 || plate <= 0 || spacing <= 0)
  Error("tile_feet.geo: foot, foot_height, plate and spacing must be above 0");
EndIf
If (squares < 1 || squares != Round(squares))
  Error("tile_feet.geo: squares = %g must be 1, 2, 3, ...", squares);
EndIf

// The plate's lower side as a lattice of squares of half a foot; those below which a foot stands are listed.
half = foot / 2;
cells = Round(half / spacing);
If (cells < 1)
  cells = 1;
EndIf
Point(1) = {0, 0, foot_height};
line() = {};
end = 1;
For i In {1 : squares}
  e[] = Extrude {half, 0, 0} { Point{end}; Layers{cells}; };
  end = e[0];
  line() += e[1];
EndFor
square() = {};
below() = {};
For j In {1 : squares}
  s[] = Extrude {0, half, 0} { Line{line()}; Layers{cells}; Recombine; };
  line() = {};
  For i In {1 : squares}
    line() += s[4 * (i - 1)];
    square() += s[4 * (i - 1) + 1];
    p = Floor((i + 2 * shifted) / 2);
    q = Floor((j + 2 * shifted) / 2);
    If (p % 2 == 0 && q % 2 == 0)
      below() += s[4 * (i - 1) + 1];
    EndIf
  EndFor
EndFor
up[] = Extrude {0, 0, plate} { Surface{square()}; Layers{Max(1, Round(plate / spacing))}; Recombine; };
down[] = Extrude {0, 0, -foot_height} { Surface{below()}; Layers{Max(1, Round(foot_height / spacing))}; Recombine; };

b = squares * half;
tol = 1e-6 * b;
h = foot_height + plate;
Physical Volume("pad") = Volume{:};
Physical Surface("top") = Surface In BoundingBox{-tol, -tol, h - tol, b + tol, b + tol, h + tol};
Physical Surface("base") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, b + tol, tol};
Physical Surface("symmetry_x") = Surface In BoundingBox{-tol, -tol, -tol, tol, b + tol, h + tol};
Physical Surface("symmetry_y") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, tol, h + tol};
