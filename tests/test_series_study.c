/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series of drops on one pad: what is refused. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include "post_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/series/case.cfg";

static void expect(program_result r, const char *words) {
    if (r.code != 2 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void what_a_study_cannot_judge_is_refused(void **state) {
    const program_place *p = *state;
    const char *series = fixture_source(EXAMPLE);
    static const struct {
        const char *set, *words;
    } sets[] = {{"series.counted=[]", "expected an array"},
                {"series.counted=[2, 2]", "item 2 is not the number of another drop"},
                {"series.counted=[2.5, 3.0]", "item 1 is not the number of another drop"},
                {"series.counted=[0, 3]", "item 1 is not the number of another drop"},
                {"series.counted=[1, 2]", "is not the last of the series"},
                {"series.counted=[3, 4]", "is not the last of the series"}};
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++)
        expect(program_run(p, "pre", "'%s' -o none %s --set '%s'", series, program_coarse(25), sets[k].set),
               sets[k].words);
    assert_int_equal(program_shell(p, "test -e none").code, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_study_cannot_judge_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
