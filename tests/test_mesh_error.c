/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh that is too coarse for its drop: refused, or named and marked in the files, by the law of
 * pre/drop_check.h. */
#include "check.h"
#include "io/h5_data.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

/* Spacings of 20 and 30 mm in a pad of 50 mm lost 7 and 16 % of a_max and passed every check. */
static void coarse_mesh_is_refused_with_its_error(void **state) {
    const program_place *p = *state;
    program_result r = program_run(p, "pre",
                                   "'%s' -o coarse.h5 --set geometry.parameters.fine_spacing=30 --set "
                                   "geometry.parameters.outer_spacing=30",
                                   fixture_source(EXAMPLE));
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "expected error of a_max about 29 %"));
    assert_non_null(strstr(r.err, "pad.mesh_error_limit (10 %)"));
    assert_int_not_equal(program_shell(p, "ls coarse.h5").code, 0);
}

static double read_error(const program_place *p, const char *name) {
    double value = NAN;
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(p, name);
    sf_h5_read_scalar(file, "/model/expected_mesh_error", &value, &err);
    if (err.status != SF_OK)
        fail_msg("%s", err.text);
    sf_h5_close(&file, &err);
    return value;
}

/* A mesh that the case allows is named on stderr, and the files carry the number. */
static void allowed_coarse_mesh_is_marked(void **state) {
    const program_place *p = *state;
    program_result r = program_run(p, "pre", "'%s' -o model.h5 %s --set solver.end_time='0.2 ms'",
                                   fixture_source(EXAMPLE), program_coarse(20));
    assert_int_equal(r.code, 0);
    assert_non_null(
        strstr(r.err, "warning: the nodal spacing under the missile is 19 mm, in a pad of 50 mm"));
    assert_non_null(strstr(r.out, "expected mesh error       about 11 % of a_max"));
    program_succeed(p, "solve", "model.h5 -o results.h5");
    double error = read_error(p, "model.h5");
    assert_true(error > 0.10 && error < 0.12);
    assert_true(read_error(p, "results.h5") == error);
}

static void fine_mesh_is_not_named(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "pre", "'%s' -o fine.h5", fixture_source(EXAMPLE));
    assert_string_equal(r.err, "");
    double error = read_error(p, "fine.h5");
    assert_true(error > 0.006 && error < 0.009);
}

/* A sphere half a thickness deep covers a disc; of the smallest the dome ends at less than that depth. */
static void zone_is_the_disc_of_the_sphere(void **state) {
    (void)state;
    static const double diameter[] = {160, 320, 40};
    for (int k = 0; k < 3; k++) {
        char text[80];
        fixture f;
        snprintf(text, sizeof text, "geometry.missile_parameters.diameter=%g.0", diameter[k]);
        fixture_pad((const char *const[]){text, NULL}, &f);
        double radius = diameter[k] / 2000, depth = fmin(0.025, radius);
        double disc = sqrt(depth * (2 * radius - depth));
        assert_true(fabs(f.report.zone.half_width / disc - 1) < 0.1);
        assert_true(fabs(f.report.zone.area / (3.14159265 * disc * disc) - 1) < 0.1);
        assert_true(fabs(f.report.zone.spacing / 0.005 - 1) < 1e-6);
        fixture_free(&f);
    }
}

/* The same drop as a quarter and as a whole. */
static void symmetry_leaves_the_zone(void **state) {
    (void)state;
    fixture quarter, whole;
    const char *const coarse = "geometry.parameters.fine_spacing=10.0",
                      *const outer = "geometry.parameters.outer_spacing=20.0";
    fixture_pad((const char *const[]){coarse, outer, NULL}, &quarter);
    fixture_pad((const char *const[]){coarse, outer, "geometry.parameters.quarter=0",
                                      "geometry.missile_parameters.quarter=0", NULL},
                &whole);
    assert_true(fabs(whole.report.zone.half_width / quarter.report.zone.half_width - 1) < 0.01);
    assert_true(fabs(whole.report.zone.area / quarter.report.zone.area - 1) < 1e-6);
    assert_true(fabs(whole.model.expected_mesh_error / quarter.model.expected_mesh_error - 1) < 0.02);
    fixture_free(&quarter);
    fixture_free(&whole);
}

/* A plate with a stud of 20 mm that is 10 mm long: the stud's width counts, not that of the plate. */
static void a_part_that_leads_has_its_own_width(void **state) {
    const program_place *p = *state;
    program_write_text(p, "stud.geo",
                       "SetFactory(\"OpenCASCADE\");\n"
                       "Box(1) = {-60, -60, 70, 120, 120, 30}; Box(2) = {-10, -10, 60, 20, 20, 20};\n"
                       "v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
                       "Physical Volume(\"missile\") = v();\n"
                       "Physical Surface(\"missile_surface\") = Boundary{ Volume{v()}; };\n"
                       "Mesh.CharacteristicLengthMax = 10;\n");
    program_result r =
        program_succeed(p, "pre",
                        "'%s' -o stud.h5 --set geometry.parameters.quarter=0 --set "
                        "geometry.missile_file='\"%s\"' --set geometry.parameters.side=200.0 "
                        "--set geometry.parameters.fine_spacing=10.0 --set pad.mesh_error_limit=1 "
                        "--set geometry.parameters.zone_side=100.0 --set "
                        "'geometry.missile_parameters={}'",
                        fixture_source(EXAMPLE), program_path(p, "stud.geo"));
    const char *at = strstr(r.out, "half width ");
    double width = at ? strtod(at + strlen("half width "), NULL) : 0;
    if (!(width > 11 && width < 28))
        fail_msg("half width %g mm: %s", width, r.out);
    assert_true(read_error(p, "stud.h5") > 0.01);
}

/* A prescribed motion has no a_max. */
static void prescribed_motion_has_no_estimate(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(
        p, "pre", "'%s' -o press.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=20 ms'",
        fixture_source("examples/compression/case.cfg"));
    assert_non_null(strstr(r.out, "expected mesh error       not estimated"));
    assert_true(read_error(p, "press.h5") == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coarse_mesh_is_refused_with_its_error),
        cmocka_unit_test(allowed_coarse_mesh_is_marked),
        cmocka_unit_test(fine_mesh_is_not_named),
        cmocka_unit_test(symmetry_leaves_the_zone),
        cmocka_unit_test(prescribed_motion_has_no_estimate),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(zone_is_the_disc_of_the_sphere),
        cmocka_unit_test(a_part_that_leads_has_its_own_width),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_folder, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
