// SPDX-License-Identifier: GPL-3.0-or-later
// Flat square platen of a testing machine, its lower face at z = 0. Lengths in millimetres.
//
// softfall-pre moves it so that it touches the specimen, which it must overlap on all sides. Also over a quarter of a
// specimen the platen stays whole: its rim is then nowhere near the symmetry planes.

DefineConstant[
  side = {100, Min 5, Max 1000, Step 5, Name "Platen/1 Side [mm]"},
  thickness = {10, Min 1, Max 100, Step 1, Name "Platen/2 Thickness, for the picture [mm]"}
];

If (side <= 0 || thickness <= 0)
  Error("platen.geo: side and thickness must be above 0");
EndIf

b = side / 2;
Point(1) = {-b, -b, 0};
Point(2) = { b, -b, 0};
Point(3) = { b,  b, 0};
Point(4) = {-b,  b, 0};
For i In {1:4}
  Line(i) = {i, (i % 4) + 1};
EndFor
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
// The cells behind the face tell which side of it is outside.
Transfinite Curve {1:4} = 3;
Transfinite Surface {1};
Extrude {0, 0, thickness} { Surface{1}; Layers{1}; }

tol = 1e-6 * thickness;
platen() = Volume In BoundingBox{-side, -side, -tol, side, side, thickness + tol};
face() = Surface In BoundingBox{-side, -side, -tol, side, side, tol};
Physical Volume("missile") = platen();
Physical Surface("missile_surface") = face();
