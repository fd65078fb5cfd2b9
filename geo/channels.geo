// SPDX-License-Identifier: GPL-3.0-or-later
// Square foam pad with round channels that lie along y at half its height. Lengths in millimetres.
//
// Frame: base at z = 0, top at z = thickness, axis of the drop at x = y = 0, over the axis of a channel when the number of channels is
// odd, between two when it is even. The quarter model is x >= 0, y >= 0.

SetFactory("OpenCASCADE");

DefineConstant[
  side = {300, Min 20, Max 1000, Step 10, Name "Pad/1 Side of the pad [mm]"},
  thickness = {50, Min 5, Max 200, Step 5, Name "Pad/2 Thickness [mm]"},
  diameter = {20, Min 1, Max 100, Step 1, Name "Pad/3 Diameter of the channels [mm]"},
  pitch = {40, Min 2, Max 200, Step 1, Name "Pad/4 Distance of the channels' axes [mm]"},
  channels = {7, Min 1, Max 40, Step 1, Name "Pad/5 Channels side by side"},
  spacing = {5, Min 1, Max 40, Step 0.5, Name "Pad/6 Spacing [mm]"},
  quarter = {0, Choices {0, 1}, Name "Pad/7 Quarter model (x >= 0, y >= 0)"}
];

If (side <= 0 || diameter <= 0 || spacing <= 0)
  Error("channels.geo: side, diameter and spacing must be above 0");
EndIf
If (channels < 1 || channels != Round(channels))
  Error("channels.geo: channels = %g must be 1, 2, 3, ...", channels);
EndIf
If (thickness <= diameter)
  Error("channels.geo: the channels cut the pad: thickness = %g must be more than diameter", thickness);
EndIf
If (pitch <= diameter)
  Error("channels.geo: the channels meet: pitch = %g must be more than diameter", pitch);
EndIf
If ((channels - 1) * pitch + diameter >= side)
  Error("channels.geo: %g channels at a pitch of %g do not fit into side = %g", channels, pitch, side);
EndIf

// The profile in the plane of the drop, extruded along y.
b = side / 2;
begin = quarter == 0 ? -b : 0;
Rectangle(1) = {begin, begin, 0, b - begin, thickness};
hole() = {};
For i In {0 : channels - 1}
  x = (i - (channels - 1) / 2) * pitch;
  If (quarter == 0 || x + diameter / 2 > 0)
    s = news;
    Disk(s) = {x, begin + thickness / 2, 0, diameter / 2};
    hole() += s;
  EndIf
EndFor
profile() = BooleanDifference{ Surface{1}; Delete; }{ Surface{hole()}; Delete; };
Rotate {{1, 0, 0}, {0, begin, 0}, Pi / 2} { Surface{profile()}; }
Extrude {0, b - begin, 0} { Surface{profile()}; Layers{Round((b - begin) / spacing)}; Recombine; }
Recombine Surface {profile()};

tol = 1e-4 * side;
Physical Volume("pad") = Volume{:};
Physical Surface("base") = Surface In BoundingBox{-b - tol, -b - tol, -tol, b + tol, b + tol, tol};
Physical Surface("top") = Surface In BoundingBox{-b - tol, -b - tol, thickness - tol, b + tol, b + tol, thickness + tol};
If (quarter == 1)
  Physical Surface("symmetry_x") = Surface In BoundingBox{-tol, -tol, -tol, tol, b + tol, thickness + tol};
  Physical Surface("symmetry_y") = Surface In BoundingBox{-tol, -tol, -tol, b + tol, tol, thickness + tol};
EndIf

Mesh.CharacteristicLengthMin = spacing;
Mesh.CharacteristicLengthMax = spacing;
