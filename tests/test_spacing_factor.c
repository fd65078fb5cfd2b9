/* SPDX-License-Identifier: GPL-3.0-or-later */
/* geometry.spacing_factor: all spacings of a pad's geometry at once, also those that the case does not give.
 */
#include "model_fixture.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static int set_up(void **state) {
    int result = program_group_folder(state);
    const program_place *p = *state;
    program_shell(p, "sed 's|\"\\.\\./\\.\\./geo/|\"%s/|; s|\"\\.\\./materials/|\"%s/|' '%s' > case.cfg",
                  fixture_source("geo"), fixture_source("examples/materials"),
                  fixture_source("examples/eva50-v4.5/case.cfg"));
    return result;
}

/* The lines of softfall-pre that tell the mesh. */
static void write_mesh(const program_place *p, const char *name, const char *arguments) {
    program_result r = program_succeed(p, "pre", "%s -o %s.h5 --force", arguments, name);
    program_write_text(p, name, r.out);
    program_shell(p, "grep -E '^(nodes|cells|nodal spacing|mesh hash) ' %s > %s.mesh", name, name);
    assert_int_equal(program_shell(p, "test $(wc -l < %s.mesh) = 4", name).code, 0);
}

/* `left.cfg` leaves both spacings to own.geo, `half.cfg` one of them. */
static void spacings_of_the_geometry_are_doubled_too(void **state) {
    const program_place *p = *state;
    program_shell(
        p,
        "cp '%s' own.geo; sed 's|\"[^\"]*/pad.geo|\"own.geo|; s/ outer_spacing[^;]*;//' case.cfg > half.cfg; "
        "sed 's/ fine_spacing[^;]*;//' half.cfg > left.cfg",
        fixture_source("geo/pad.geo"));
    assert_int_equal(program_shell(p, "grep -q spacing left.cfg").code, 1);
    write_mesh(p, "given",
               "case.cfg --set geometry.parameters.fine_spacing=10.0 "
               "--set geometry.parameters.outer_spacing=20.0");
    write_mesh(p, "half", "half.cfg --set geometry.spacing_factor=2");
    write_mesh(p, "left", "left.cfg --set geometry.spacing_factor=2");
    write_mesh(p, "plain", "left.cfg");
    program_shell(p, "echo 'half_spacing = 0.5*fine_spacing;' >> own.geo"); /* follows one that is doubled */
    write_mesh(p, "derived", "left.cfg --set geometry.spacing_factor=2");
    assert_int_equal(program_shell(p, "cmp given.mesh half.mesh && cmp given.mesh left.mesh && "
                                      "cmp given.mesh derived.mesh")
                         .code,
                     0);
    assert_int_equal(program_shell(p, "cmp -s given.mesh plain.mesh").code, 1);
}

static void assert_refused(const program_place *p, const char *words) {
    program_result r = program_run(p, "pre", "left.cfg -o refused.h5 --set geometry.spacing_factor=2");
    if (r.code != 2 ||
        !strstr(r.err, "own.geo: geometry.spacing_factor needs a number, in geometry.parameters or in a "
                       "DefineConstant of this file, ") ||
        !strstr(r.err, words))
        fail_msg("%d, not \"%s\": %s", r.code, words, r.err);
}

/* Goes on from the files of the test before. */
static void spacings_that_cannot_be_doubled_are_refused(void **state) {
    static const char *const wrong[][2] = {
        {"s/outer_spacing = {10,/outer_spacing = {2 * 5,/", "for outer_spacing"},
        {"1i cell_spacing = 5;", "for cell_spacing"},
        {"1i cell_spacing = 5*2; // spacing", "for cell_spacing"},
        {"1i cell_spacing = DefineNumber[5, Name \"Pad/spacing\"];", "for cell_spacing"},
        {"s/fine_spacing/fine/g; s/outer_spacing/outer/g", "for a parameter with \"spacing\" in its name"}};
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        program_shell(p, "sed '%s' '%s' > own.geo", wrong[k][0], fixture_source("geo/pad.geo"));
        assert_refused(p, wrong[k][1]);
    }
    program_shell(p, "cp '%s' part.geo; echo 'Include \"part.geo\";' > own.geo",
                  fixture_source("geo/pad.geo"));
    assert_refused(p, "for fine_spacing");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spacings_of_the_geometry_are_doubled_too),
        cmocka_unit_test(spacings_that_cannot_be_doubled_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
