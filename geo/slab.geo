// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid slab below a pad, with a round hole if wanted: a support. Lengths in millimetres.
//
// Frame: its top is z = 0, its middle x = y = 0. It is whole below a quarter model, too.

SetFactory("OpenCASCADE");

DefineConstant[
  side = {600, Min 10, Max 3000, Step 10, Name "Slab/1 Side [mm]"},
  depth = {20, Min 1, Max 500, Step 1, Name "Slab/2 Depth [mm]"},
  hole = {0, Min 0, Max 1000, Step 5, Name "Slab/3 Diameter of the hole, 0: none [mm]"},
  element_size = {20, Min 1, Max 100, Step 1, Name "Slab/4 Size of the triangles [mm]"}
];

If (side <= 0 || depth <= 0 || hole < 0 || hole >= side || element_size <= 0)
  Error("slab.geo: side, depth and element_size must be above 0, the hole must be smaller than the side");
EndIf

Box(1) = {-side / 2, -side / 2, -depth, side, side, depth};
If (hole > 0)
  Cylinder(2) = {0, 0, -2 * depth, 0, 0, 3 * depth, hole / 2};
  body() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; };
EndIf
Delete { Volume{:}; } // only its surface is meshed
Physical Surface("support") = Surface{:};

Mesh.MeshSizeMin = element_size;
Mesh.MeshSizeMax = element_size;
