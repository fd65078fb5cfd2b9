// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid round post whose axis lies along y: a support, as inside of geo/sleeve.geo. Lengths in millimetres.

SetFactory("OpenCASCADE");

DefineConstant[
  diameter = {115, Min 2, Max 1000, Step 5, Name "Post/1 Diameter [mm]"},
  length = {400, Min 10, Max 5000, Step 10, Name "Post/2 Length [mm]"},
  element_size = {5, Min 0.5, Max 100, Step 0.5, Name "Post/3 Size of the triangles [mm]"}
];

If (diameter <= 0 || length <= 0 || element_size <= 0)
  Error("round_post.geo: diameter, length and element_size must be above 0");
EndIf

Cylinder(1) = {0, -length / 2, 0, 0, length, 0, diameter / 2};
Delete { Volume{:}; } // only its surface is meshed
Physical Surface("support") = Surface{:};

Mesh.MeshSizeMin = element_size;
Mesh.MeshSizeMax = element_size;
