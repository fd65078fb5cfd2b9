# SPDX-License-Identifier: GPL-3.0-or-later
"""check_state.py STATE.pvsm: is the view in a layout, else the window does not show it, and is its camera where
pad_paraview.py puts it, not straight above the pad as the first rendering does?"""
import sys
import xml.etree.ElementTree as tree

root = tree.parse(sys.argv[1]).getroot()
view = root.find('.//Proxy[@type="RenderView"]')
items = root.findall('.//Proxy[@type="ViewLayout"]//Item')
assert any(item.get("view") == view.get("id") for item in items), "the view is in no layout"


def vector(name):
    return [float(element.get("value")) for element in view.findall('Property[@name="%s"]/Element' % name)]


eye = [a - b for a, b in zip(vector("CameraPosition"), vector("CameraFocalPoint"))]
assert eye[0] ** 2 + eye[1] ** 2 > eye[2] ** 2, "the camera looks along %s" % eye
