// SPDX-License-Identifier: GPL-3.0-or-later
// Round bar with hemispherical ends, lying along y. Lengths in millimetres.
//
// Frame: the middle of its lowest line at the origin. The quarter model is x >= 0, y >= 0. The surface is closed, but for
// the symmetry planes of the quarter.

SetFactory("OpenCASCADE");

DefineConstant[
  diameter = {50, Min 1, Max 1000, Step 5, Name "Missile/1 Diameter [mm]"},
  length = {300, Min 1, Max 2000, Step 10, Name "Missile/2 Length with its ends [mm]"},
  element_size = {6, Min 0.5, Max 100, Step 0.5, Name "Missile/3 Element size [mm]"},
  tilt = {0, Min -90, Max 90, Step 5, Name "Missile/4 One end lower: turned about x by [degrees]"},
  quarter = {0, Choices {0, 1}, Name "Missile/5 Quarter model (x >= 0, y >= 0)"}
];

radius = diameter / 2;
half = length / 2 - radius; // of the cylinder between the ends
If (diameter <= 0 || element_size <= 0)
  Error("bar.geo: diameter and element_size must be above 0");
EndIf
If (half <= 0)
  Error("bar.geo: length = %g must be more than the diameter", length);
EndIf
If (quarter != 0 && tilt != 0)
  Error("bar.geo: a missile that is turned has no quarter model");
EndIf

// Half of the section in the plane x = 0, below the axis, turned about it: the lowest line is an edge, with nodes on it.
begin = quarter == 0 ? -half : 0;
Point(1) = {0, begin, 0};
Point(2) = {0, half, 0};
Point(3) = {0, half, radius};
Point(4) = {0, half + radius, radius};
Line(1) = {1, 2};
Circle(2) = {2, 3, 4};
If (quarter == 0)
  Point(5) = {0, -half, radius};
  Point(6) = {0, -half - radius, radius};
  Line(3) = {4, 6};
  Circle(4) = {6, 5, 1};
Else
  Point(6) = {0, 0, radius};
  Line(3) = {4, 6};
  Line(4) = {6, 1};
EndIf
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
out() = Extrude {{0, -1, 0}, {0, 0, radius}, quarter == 0 ? 2 * Pi : Pi} { Surface{1}; };
v = out(1);
If (quarter == 0)
  Recursive Delete { Surface{1}; } // the section, which is not a part of the surface
  Rotate {{1, 0, 0}, {0, 0, radius}, tilt * Pi / 180} { Volume{v}; }
EndIf

far = 10 * (radius + length);
tol = 1e-6 * far;
Physical Volume("missile") = {v};
surface() = Surface In BoundingBox{-far, -far, -far, far, far, far};
If (quarter != 0)
  plane() = Surface In BoundingBox{-tol, -far, -far, tol, far, far};
  plane() += Surface In BoundingBox{-far, -tol, -far, far, tol, far};
  Physical Surface("missile_symmetry") = plane();
  surface() -= plane();
EndIf
Physical Surface("missile_surface") = surface();

Mesh.MeshSizeMin = element_size;
Mesh.MeshSizeMax = element_size;
Mesh.Algorithm3D = 1;
