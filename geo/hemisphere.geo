// SPDX-License-Identifier: GPL-3.0-or-later
// Hemispherical missile, dome downwards. Lengths in millimetres.
//
// Frame: the lowest point of the dome at the origin, the centre of the sphere at z = radius, the flat face on top.
// softfall-pre moves it so that it touches the pad. The quarter model is x >= 0, y >= 0.

SetFactory("OpenCASCADE");

DefineConstant[
  diameter = {160, Min 10, Max 1000, Step 5, Name "Missile/1 Diameter [mm]"},
  element_size = {10, Min 1, Max 100, Step 1, Name "Missile/2 Element size [mm]"},
  quarter = {0, Choices {0, 1}, Name "Missile/3 Quarter model (x >= 0, y >= 0)"}
];

If (diameter <= 0 || element_size <= 0)
  Error("hemisphere.geo: diameter and element_size must be positive");
EndIf

radius = diameter / 2;
tol = 1e-6 * diameter;

// Sphere cut at its equator, then its lower half; in the quarter model only the octant x >= 0, y >= 0.
v = newv;
If (quarter == 0)
  Sphere(v) = {0, 0, radius, radius, -Pi/2, 0, 2*Pi};
Else
  Sphere(v) = {0, 0, radius, radius, -Pi/2, 0, Pi/2};
EndIf

Physical Volume("missile") = {v};
top() = Surface In BoundingBox{-diameter, -diameter, radius - tol, diameter, diameter, radius + tol};
all() = Surface In BoundingBox{-diameter, -diameter, -diameter, diameter, diameter, diameter};
plane() = {};
If (quarter != 0)
  plane() += Surface In BoundingBox{-tol, -diameter, -diameter, tol, diameter, diameter};
  plane() += Surface In BoundingBox{-diameter, -tol, -diameter, diameter, tol, diameter};
  Physical Surface("missile_symmetry") = plane();
EndIf
dome() = all();
dome() -= top();
dome() -= plane();
Physical Surface("missile_surface") = dome();
Physical Surface("missile_top") = top();

Mesh.MeshSizeMin = element_size;
Mesh.MeshSizeMax = element_size;
Mesh.Algorithm3D = 1;
