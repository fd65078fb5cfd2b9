/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit_fixture.h"

#include <stdio.h>
#include <stdlib.h>

void fit_fixture_put_case(const program_place *place) {
    char text[2048];
    const char *source = getenv("SF_SOURCE_DIR");
    snprintf(
        text, sizeof text,
        "geometry: { file = \"%s/geo/pad.geo\"; missile_file = \"%s/geo/hemisphere.geo\"; length_unit = "
        "\"mm\";\nparameters = { side = 320.0; thickness = 70.0; zone_side = 200.0; fine_spacing = 17.5; "
        "outer_spacing = 30.0; quarter = 1; };\n"
        "missile_parameters = { diameter = 160.0; element_size = 15.0; quarter = 1; }; };\n"
        "material: {\n@include \"start.cfg\"\n};\n"
        "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\nsolver: { end_time = \"40 ms\"; };\n",
        source, source);
    program_write_text(place, "case.cfg", text);
    program_write_text(place, "start.cfg",
                       "density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curve = \"start.csv\"; HU = 0.01; ED = "
                       "\"2 MPa\"; BETA1 = \"5000 1/s\";\n");
    program_write_text(place, "start.csv", "strain,stress_kPa\n0,0\n0.02,8\n0.5,80\n0.9,2000\n");
}
