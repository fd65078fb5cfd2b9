// SPDX-License-Identifier: GPL-3.0-or-later
// Foam sleeve round a post, a full tube whose axis lies along y. Lengths in millimetres.
//
// Frame: the axis of the post is y, the missile comes along -z at x = y = 0. The post itself is not there: the inner surface, "base", is
// held. The whole outer surface is "top"; what looks away from the missile waits. The model is the quarter x >= 0, y >= 0.

SetFactory("OpenCASCADE");

DefineConstant[
  post = {115, Min 10, Max 1000, Step 5, Name "Sleeve/1 Diameter of the post [mm]"},
  thickness = {40, Min 2, Max 200, Step 1, Name "Sleeve/2 Thickness [mm]"},
  length = {300, Min 20, Max 3000, Step 10, Name "Sleeve/3 Length [mm]"},
  spacing = {6, Min 0.5, Max 40, Step 0.5, Name "Sleeve/4 Spacing [mm]"}
];

If (post <= 0 || thickness <= 0 || length <= 0 || spacing <= 0)
  Error("sleeve.geo: post, thickness, length and spacing must be above 0");
EndIf

r = post / 2;
o = r + thickness;
h = length / 2;
Disk(1) = {0, 0, 0, o};
Disk(2) = {0, 0, 0, r};
ring() = BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; };
s = news;
Rectangle(s) = {0, -o, 0, o, 2 * o};
half() = BooleanIntersection{ Surface{ring()}; Delete; }{ Surface{s}; Delete; };
Rotate {{1, 0, 0}, {0, 0, 0}, Pi / 2} { Surface{half()}; }
tube() = Extrude {0, h, 0} { Surface{half()}; Layers{Max(1, Round(h / spacing))}; Recombine; };
Recombine Surface {half()};

tol = 1e-4 * o;
base() = Surface In BoundingBox{-r - tol, -tol, -r - tol, r + tol, h + tol, r + tol};
near_x() = Surface In BoundingBox{-tol, -tol, -o - tol, tol, h + tol, o + tol};
near_y() = Surface In BoundingBox{-tol, -tol, -o - tol, o + tol, tol, o + tol};
end() = Surface In BoundingBox{-tol, h - tol, -o - tol, o + tol, h + tol, o + tol};
top() = Surface In BoundingBox{-tol, -tol, -o - tol, o + tol, h + tol, o + tol};
top() -= {base(), near_x(), near_y(), end()};
Physical Volume("pad") = Volume{:};
Physical Surface("base") = base();
Physical Surface("top") = top();
Physical Surface("symmetry_x") = near_x();
Physical Surface("symmetry_y") = near_y();

Mesh.MeshSizeMin = spacing;
Mesh.MeshSizeMax = spacing;
