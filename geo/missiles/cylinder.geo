// SPDX-License-Identifier: GPL-3.0-or-later
// Cylindrical missile with sharp edges, its end down; with tilt = 90 it lies. Lengths in millimetres.
//
// Frame: the middle of the lower end at the origin, the axis along z, the cylinder above z = 0. The quarter model is
// x >= 0, y >= 0. The surface is closed, but for the symmetry planes of the quarter.

SetFactory("OpenCASCADE");

DefineConstant[
  diameter = {115, Min 1, Max 1000, Step 5, Name "Missile/1 Diameter [mm]"},
  length = {100, Min 1, Max 1000, Step 5, Name "Missile/2 Length [mm]"},
  element_size = {8, Min 0.5, Max 100, Step 0.5, Name "Missile/3 Element size [mm]"},
  tilt = {0, Min -90, Max 90, Step 5, Name "Missile/4 Turned about y by [degrees]"},
  quarter = {0, Choices {0, 1}, Name "Missile/5 Quarter model (x >= 0, y >= 0)"}
];

If (diameter <= 0 || length <= 0 || element_size <= 0)
  Error("cylinder.geo: diameter, length and element_size must be above 0");
EndIf
If (quarter != 0 && tilt != 0)
  Error("cylinder.geo: a missile that is turned has no quarter model");
EndIf

radius = diameter / 2;
v = newv;
Cylinder(v) = {0, 0, 0, 0, 0, length, radius, quarter == 0 ? 2 * Pi : Pi / 2};
Rotate {{0, 1, 0}, {0, 0, length / 2}, tilt * Pi / 180} { Volume{v}; }

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
