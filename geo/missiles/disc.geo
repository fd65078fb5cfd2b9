// SPDX-License-Identifier: GPL-3.0-or-later
// Flat missile: a disc whose lower edge is rounded. Lengths in millimetres.
//
// Frame: the middle of the flat face at the origin, the axis along z, the disc above z = 0. The quarter model is x >= 0,
// y >= 0. The surface is closed, but for the symmetry planes of the quarter.

SetFactory("OpenCASCADE");

DefineConstant[
  diameter = {130, Min 10, Max 1000, Step 5, Name "Missile/1 Diameter [mm]"},
  thickness = {40, Min 1, Max 500, Step 1, Name "Missile/2 Thickness [mm]"},
  edge_radius = {6, Min 0.1, Max 100, Step 0.5, Name "Missile/3 Radius of the lower edge [mm]"},
  element_size = {8, Min 0.5, Max 100, Step 0.5, Name "Missile/4 Element size [mm]"},
  tilt = {0, Min -90, Max 90, Step 5, Name "Missile/5 Turned about y by [degrees]"},
  quarter = {0, Choices {0, 1}, Name "Missile/6 Quarter model (x >= 0, y >= 0)"}
];

radius = diameter / 2;
If (edge_radius <= 0 || element_size <= 0)
  Error("disc.geo: edge_radius and element_size must be above 0");
EndIf
If (edge_radius >= thickness || edge_radius >= radius)
  Error("disc.geo: edge_radius = %g must be less than the thickness and than the radius", edge_radius);
EndIf
If (quarter != 0 && tilt != 0)
  Error("disc.geo: a missile that is turned has no quarter model");
EndIf

// Half of the section, turned about the axis.
Point(1) = {0, 0, 0};
Point(2) = {radius - edge_radius, 0, 0};
Point(3) = {radius - edge_radius, 0, edge_radius};
Point(4) = {radius, 0, edge_radius};
Point(5) = {radius, 0, thickness};
Point(6) = {0, 0, thickness};
Line(1) = {1, 2};
Circle(2) = {2, 3, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {6, 1};
Curve Loop(1) = {1:5};
Plane Surface(1) = {1};
out() = Extrude {{0, 0, 1}, {0, 0, 0}, quarter == 0 ? 2 * Pi : Pi / 2} { Surface{1}; };
v = out(1);
If (quarter == 0)
  Recursive Delete { Surface{1}; } // the section, which is not a part of the surface
  Rotate {{0, 1, 0}, {0, 0, thickness / 2}, tilt * Pi / 180} { Volume{v}; }
EndIf

far = 10 * (radius + thickness);
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
