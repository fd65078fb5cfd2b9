// SPDX-License-Identifier: GPL-3.0-or-later
// Headform-like missile: an ellipsoid, its crown down. Lengths in millimetres.
//
// The default is about the size of a head of 570 mm circumference. It is not the headform of a standard.
//
// Frame: the length along x, the width along y, the height along z; the centre is at z = height / 2, about which tilt
// turns the body. The lowest point is at the origin for tilt = 0 only. The quarter model is x >= 0, y >= 0. The surface
// is closed, but for the symmetry planes of the quarter.

SetFactory("OpenCASCADE");

DefineConstant[
  length = {200, Min 10, Max 1000, Step 5, Name "Missile/1 Length, front to back [mm]"},
  width = {160, Min 10, Max 1000, Step 5, Name "Missile/2 Width [mm]"},
  height = {220, Min 10, Max 1000, Step 5, Name "Missile/3 Height [mm]"},
  element_size = {10, Min 0.5, Max 100, Step 0.5, Name "Missile/4 Element size [mm]"},
  tilt = {0, Min -90, Max 90, Step 5, Name "Missile/5 Turned about y by [degrees]"},
  quarter = {0, Choices {0, 1}, Name "Missile/6 Quarter model (x >= 0, y >= 0)"}
];

If (length <= 0 || width <= 0 || height <= 0 || element_size <= 0)
  Error("headform.geo: length, width, height and element_size must be above 0");
EndIf
If (quarter != 0 && tilt != 0)
  Error("headform.geo: a missile that is turned has no quarter model");
EndIf

radius = length / 2;
v = newv;
Sphere(v) = {0, 0, 0, 1, -Pi / 2, Pi / 2, quarter == 0 ? 2 * Pi : Pi / 2};
Dilate {{0, 0, 0}, {length / 2, width / 2, height / 2}} { Volume{v}; }
Rotate {{0, 1, 0}, {0, 0, 0}, tilt * Pi / 180} { Volume{v}; }
Translate {0, 0, height / 2} { Volume{v}; }

far = 10 * (radius + width + height);
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
