/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A finished drop is used again only as long as everything that its geometry read is as it was. */
#include "program_fixture.h"

#include "study/run_folder.h"
#include "study/runner.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

/* A cube whose .geo includes one file and merges another; the drop ends at once. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    return program_shell(p,
                         "cp -r '%s/examples' '%s/geo' . && cd geo && mv cube.geo inner.geo && "
                         "printf 'Include \"inner.geo\";\\nMerge \"size.geo\";\\n' > cube.geo && "
                         "printf '// nothing\\n' > first.geo && ln -s first.geo size.geo && "
                         "printf '// something\\n' > second.geo",
                         getenv("SF_SOURCE_DIR"), getenv("SF_SOURCE_DIR"))
        .code;
}

static bool is_case_finished(const program_place *p, const char *case_path, bool simulate) {
    static const char *const overrides[] = {"geometry.parameters.spacing=25", "solver.end_time=0.2 ms"};
    sf_run_folder at;
    sf_error err = SF_ERROR_INIT;
    if (sf_run_folder_name(program_path(p, "runs"), "drop", case_path, 2, overrides, &at, &err) != SF_OK ||
        (simulate && sf_run_folder_simulate(&at, case_path, 2, overrides, 1, &err) != SF_OK))
        fail_msg("%s", err.text);
    return sf_run_folder_is_finished(&at);
}

static bool is_finished(const program_place *p, bool simulate) {
    return is_case_finished(p, program_path(p, "examples/compression/case.cfg"), simulate);
}

static void what_was_included_or_merged_counts(void **state) {
    const program_place *p = *state;
    program_shell(p, "mkdir runs");
    assert_false(is_finished(p, false));
    assert_true(is_finished(p, true));
    static const char *const changes[][2] = {
        {"cp geo/inner.geo kept; echo '// changed' >> geo/inner.geo", "cp kept geo/inner.geo"},
        {"echo '// otherwise' > geo/size.geo", "echo '// nothing' > geo/size.geo"},
        {"mv geo/size.geo away", "mv away geo/size.geo"},
        {"mv geo/size.geo away; mkdir geo/size.geo", "rmdir geo/size.geo; mv away geo/size.geo"},
        {"ln -sfn second.geo geo/size.geo", "ln -sfn first.geo geo/size.geo"},
        {"touch geo/inner.geo.opt", "rm geo/inner.geo.opt"},
        {"cp geo/platen.geo kept; echo '// changed' >> geo/platen.geo", "cp kept geo/platen.geo"},
    };
    for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        program_shell(p, "%s", changes[k][0]);
        if (is_finished(p, false))
            fail_msg("after %s the drop is used again", changes[k][0]);
        program_shell(p, "%s", changes[k][1]);
        if (!is_finished(p, false))
            fail_msg("after %s the drop is not used again", changes[k][1]);
    }
}

/* Each project has its own files, and takes its drops along. */
static void a_copied_project_is_compared_with_its_own_files(void **state) {
    const program_place *p = *state;
    const char *copy = program_path(p, "copy/examples/compression/case.cfg");
    program_shell(p, "mkdir copy && cp -a examples geo copy");
    assert_true(is_case_finished(p, copy, false));
    program_shell(p, "echo '// changed' >> copy/geo/inner.geo");
    assert_false(is_case_finished(p, copy, false));
    assert_true(is_finished(p, false));
}

static void a_moved_project_keeps_its_drops(void **state) {
    const program_place *p = *state;
    program_shell(p, "rm -r runs copy && mkdir runs one && cp -a examples geo one");
    assert_int_equal(chdir(p->folder), 0);
    assert_true(is_case_finished(p, "one/examples/compression/case.cfg", true));
    program_shell(p, "mv one two");
    assert_true(is_case_finished(p, "two/examples/compression/case.cfg", false));
    program_shell(p, "ln -sfn second.geo two/geo/size.geo");
    assert_false(is_case_finished(p, "two/examples/compression/case.cfg", false));
    assert_int_equal(chdir("/"), 0);
}

static uint64_t key_of(const char *case_path, const char *override) {
    sf_run_folder at;
    sf_error err = SF_ERROR_INIT;
    if (sf_run_folder_name("runs", "drop", case_path, override ? 1 : 0, &override, &at, &err) != SF_OK)
        fail_msg("%s", err.text);
    return at.key;
}

/* Values and contents make the key: not the names of files, nor what cannot change a drop. Names of our own
 * keys may not be taken for those of files. */
static void the_key_is_of_values_and_contents(void **state) {
    const program_place *p = *state;
    program_shell(p, "mkdir keys && cp -r examples geo keys");
    char path[1024];
    snprintf(path, sizeof path, "%s", program_path(p, "keys/examples/compression/case.cfg"));
    uint64_t key = key_of(path, NULL);
    assert_true(key == key_of(program_path(p, "examples/compression/case.cfg"), NULL));
    assert_true(key == key_of(path, "geometry.time_limit=100 s"));
    static const char *const overrides[] = {"material.density=36 kg/m3", "geometry.parameters.side=51",
                                            "kernel.support_ratio=1.9", "missile.friction=0.4",
                                            "geometry.length_unit=cm"};
    for (size_t k = 0; k < sizeof overrides / sizeof overrides[0]; k++)
        if (key == key_of(path, overrides[k]))
            fail_msg("%s: the same key", overrides[k]);
    static const char *const changes[][2] = {
        {"sed -i 's/density *= *\"[^\"]*\"/density = \"37 kg\\/m3\"/' materials/eva35.cfg", "included"},
        {"sed -i '$s/$/1/' materials/eva35.csv", "curve"},
        {"sed -i '$s/^/1/' compression/motion.csv", "motion"},
        {"echo '// changed' >> ../geo/platen.geo", "missile"},
    };
    for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        program_shell(p, "rm -r keys && mkdir keys && cp -r examples geo keys && cd keys/examples && %s",
                      changes[k][0]);
        if (key == key_of(path, NULL))
            fail_msg("changed %s: the same key", changes[k][1]);
    }
    program_shell(
        p, "rm -r keys && mkdir keys && cp -r examples geo keys && mv keys/geo/cube.geo keys/geo/c.geo "
           "&& sed -i 's/cube.geo/c.geo/' keys/examples/compression/case.cfg");
    assert_true(key == key_of(path, NULL));
}

/* An orphan that finished after its campaign was killed leaves model and checkpoint: a drop that is used
 * again has them no longer. */
static void what_an_orphan_left_goes(void **state) {
    const program_place *p = *state;
    char folder[600], source[1024];
    snprintf(folder, sizeof folder, "%s/orphan", p->folder);
    snprintf(source, sizeof source, "%s", program_path(p, "examples/compression/case.cfg"));
    sf_runner runner = {.folder = folder, .threads = 1};
    const sf_runner_drop drop = {.label = "drop",
                                 .case_path = source,
                                 .override_count = 2,
                                 .overrides = {"geometry.parameters.spacing=25", "solver.end_time=0.2 ms"}};
    for (int again = 0; again < 2; again++) {
        sf_error err = SF_ERROR_INIT;
        sf_runner_result result;
        if (sf_runner_run(&runner, &drop, &result, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_int_equal(result.reused, again);
        sf_runner_result_free(&result);
        assert_int_equal(
            program_shell(p, "cd orphan/drop-* && test ! -e model.h5 && test ! -e results.h5.restart").code,
            0);
        program_shell(p, "cd orphan/drop-* && touch model.h5 results.h5.restart");
    }
}

/* Size and time are those that its record knows. */
static void a_damaged_drop_is_simulated_again(void **state) {
    const program_place *p = *state;
    char folder[600], source[1024];
    snprintf(folder, sizeof folder, "%s/damaged", p->folder);
    snprintf(source, sizeof source, "%s", program_path(p, "examples/eva50-v4.5/case.cfg"));
    sf_runner runner = {.folder = folder, .threads = 1};
    const sf_runner_drop drop = {.label = "drop",
                                 .case_path = source,
                                 .override_count = 3,
                                 .overrides = {"geometry.parameters.fine_spacing=20",
                                               "geometry.parameters.outer_spacing=25",
                                               "pad.mesh_error_limit=1"}};
    for (int again = 0; again < 3; again++) {
        sf_error err = SF_ERROR_INIT;
        sf_runner_result result;
        if (sf_runner_run(&runner, &drop, &result, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_int_equal(result.reused, again == 1);
        sf_runner_result_free(&result);
        if (again == 1)
            assert_int_equal(
                program_shell(p, "cd damaged/drop-* && touch -r results.h5 then && dd if=/dev/zero "
                                 "of=results.h5 bs=64 count=1 conv=notrunc && touch -r then results.h5")
                    .code,
                0);
    }
}

/* The drop is simulated again where it was, and then used with the new content. */
static void a_changed_geometry_is_simulated_again(void **state) {
    const program_place *p = *state;
    program_shell(p, "echo 'Mesh.RandomFactor = 1e-9;' > geo/size.geo");
    assert_false(is_finished(p, false));
    assert_true(is_finished(p, true));
    program_shell(p, "echo '// nothing' > geo/size.geo");
    assert_false(is_finished(p, false));
}

/* Nobody knows what gmsh read. */
static void an_unconfined_drop_is_not_used_again(void **state) {
    program_shell(*state, "cp geo/inner.geo geo/cube.geo"); /* its parameters are known then */
    setenv("SOFTFALL_UNCONFINED", "1", 1);
    bool finished = is_finished(*state, true);
    unsetenv("SOFTFALL_UNCONFINED");
    assert_false(finished);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_included_or_merged_counts),
        cmocka_unit_test(a_copied_project_is_compared_with_its_own_files),
        cmocka_unit_test(the_key_is_of_values_and_contents),
        cmocka_unit_test(a_changed_geometry_is_simulated_again),
        cmocka_unit_test(what_an_orphan_left_goes),
        cmocka_unit_test(a_damaged_drop_is_simulated_again),
        cmocka_unit_test(a_moved_project_keeps_its_drops),
        cmocka_unit_test(an_unconfined_drop_is_not_used_again),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
