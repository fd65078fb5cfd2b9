/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Indentation and mean strain refer to the plane of the undeformed top, from which the thickness is measured,
 * and not to the first contact: over a hole the missile touches the rim when it is below that plane already.
 */
#include "io/h5_data.h"
#include "model/model_io.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

#include "post_check.h"

/* A hole of 40 mm through a pad of 40 mm, in millimetres. */
static const char hole[] =
    "SetFactory(\"OpenCASCADE\");\n"
    "Box(1) = {-60, -60, 0, 120, 120, 40};\nCylinder(2) = {0, 0, -1, 0, 0, 42, 20};\n"
    "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
    "base() = Surface In BoundingBox{-61, -61, -0.1, 61, 61, 0.1};\n"
    "top() = Surface In BoundingBox{-61, -61, 39.9, 61, 61, 40.1};\n"
    "Physical Volume(\"pad\") = {3};\nPhysical Surface(\"base\") = base();\nPhysical Surface(\"top\") = top();\n"
    "Mesh.MeshSizeMin = 12;\nMesh.MeshSizeMax = 12;\nMesh.Algorithm3D = 1;\n";

static const char missile[] = "length_unit = \"mm\"; missile_file = \"geo/hemisphere.geo\"; "
                              "missile_parameters = { diameter = 160.0; element_size = 20.0; };";

static void write_case(const program_place *p, const char *name, const char *pad) {
    char text[1024];
    snprintf(text, sizeof text,
             "geometry: { file = \"%s\"; %s };\nmaterial: {\n@include \"materials/eva35.cfg\"\n};\n"
             "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\nsolver: { end_time = \"3 ms\"; };\n",
             pad, missile);
    program_write_text(p, name, text);
}

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_result made =
        program_shell(p, "cp -r \"$SF_SOURCE_DIR/geo\" \"$SF_SOURCE_DIR/examples/materials\" .");
    assert_int_equal(made.code, 0);
    program_write_text(p, "hole.geo", hole);
    write_case(p, "case.cfg", "hole.geo");
    program_succeed(p, "pre", "case.cfg -o model.h5");
    program_succeed(p, "solve", "model.h5 -o results.h5 --threads 1 --no-checkpoint");
    program_succeed(p, "post", "results.h5 -o out");
    return 0;
}

/* The sagitta of the sphere over the rim, and the way since then. */
static void over_a_hole_the_indentation_begins_with_the_depth_in_the_hole(void **state) {
    const double sagitta = 0.08 - sqrt(0.08 * 0.08 - 0.02 * 0.02);
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(*state, "results.h5");
    int64_t rows = -1;
    double *indentation, *displacement;
    void *data = NULL;
    assert_close(sagitta, 2.54e-3, 1e-5);
    assert_int_equal(sf_h5_read(file, "/history/indentation", SF_H5_F64, 1, &rows, &data, &err), SF_OK);
    indentation = data;
    assert_int_equal(sf_h5_read(file, "/history/displacement", SF_H5_F64, 1, &rows, &data, &err), SF_OK);
    displacement = data;
    assert_close(indentation[0], sagitta, 1e-6);
    for (int64_t i = 0; i < rows; i++)
        assert_close(indentation[i] - displacement[i], sagitta, 1e-6);
    free(indentation);
    free(displacement);
    sf_h5_close(&file, &err);
}

static void the_mean_strain_counts_it(void **state) {
    program_result r =
        program_shell(*state, "python3 -c \"import json; s = json.load(open('out/summary.json')); "
                              "print(s['max_mean_strain'] * 40 - s['max_indentation_mm'], "
                              "s['max_indentation_mm'])\"");
    double difference = NAN, depth = NAN;
    assert_int_equal(sscanf(r.out, "%lf %lf", &difference, &depth), 2);
    assert_close(difference, 0, 1e-6);
    assert_true(depth > 12); /* 2.54 mm, and three milliseconds at up to 4.5 m/s */
}

/* On a plane the pole touches first: the gap alone is above the pad. */
static void on_a_plane_the_clearance_is_the_gap(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_model m;
    sf_h5 *file = NULL;
    write_case(p, "plane.cfg", "geo/pad.geo");
    program_succeed(
        p, "pre",
        "plane.cfg -o plane.h5 --set missile.gap='3 mm' --set geometry.parameters.fine_spacing=20 "
        "--set geometry.parameters.outer_spacing=40 --set pad.mesh_error_limit=1");
    if (sf_model_read(program_path(p, "plane.h5"), &m, &file, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_close(m.missile.clearance, 3e-3, 1e-9);
    assert_close(sf_missile_card_depth(&m.missile, 5e-3), 2e-3, 1e-9);
    sf_model_free(&m);
    sf_h5_close(&file, &err);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(over_a_hole_the_indentation_begins_with_the_depth_in_the_hole),
        cmocka_unit_test(the_mean_strain_counts_it),
        cmocka_unit_test(on_a_plane_the_clearance_is_the_gap),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
