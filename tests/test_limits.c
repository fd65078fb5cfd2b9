/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits of the system and OpenMP's environment: each program says one sentence of its own, is not ended by a
 * signal and leaves no pieces of files. */
#include "check.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* One line of stderr beside warnings, from the program, with `part` in it; not 0 and no signal. */
static void assert_sentence(const program_result *r, const char *part) {
    int lines = 0;
    for (const char *line = r->err; line && *line;
         line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
        if (strncmp(line, "softfall-", 9) != 0)
            fail_msg("a line that is not ours: %s", r->err);
        lines += !strstr(line, ": warning: ") || strstr(line, ": warning: ") > line + strcspn(line, "\n");
    }
    if (r->code <= 0 || r->code >= 127 || lines != 1 || !strstr(r->err, part))
        fail_msg("code %d where \"%s\" was expected: %s", r->code, part, r->err);
}

/* What each program does in the folder of the example; output NEW. */
static const char *const runs[][2] = {
    {"pre",
     "good.cfg -o NEW --set geometry.parameters.fine_spacing=20 --set "
     "geometry.parameters.outer_spacing=20.0 --set geometry.missile_parameters.element_size=20.0 --set "
     "pad.mesh_error_limit=1"},
    {"solve", "model.h5 -o NEW"},
    {"post", "results.h5 -o NEW"},
    {"fit", "compression \"$SF_SOURCE_DIR\"/examples/fit/compression/fit.cfg -o NEW"},
};
enum { RUNS = sizeof runs / sizeof runs[0] };

/* Runs program `k` after the shell's words `first`. */
static program_result run_after(const program_place *p, const char *first, int k) {
    return program_shell(p, "%s \"$SF_BIN_DIR\"/softfall-%s %s", first, runs[k][0], runs[k][1]);
}

static void impossible_values_for_openmp_are_refused_by_every_program(void **state) {
    static const char *const values[][2] = {
        {"OMP_NUM_THREADS=999999", "OMP_NUM_THREADS=\"999999\"; a number from 1 to 1024"},
        {"OMP_NUM_THREADS=-1", "OMP_NUM_THREADS=\"-1\""},
        {"OMP_NUM_THREADS=abc", "OMP_NUM_THREADS=\"abc\""},
        {"OMP_NUM_THREADS=4,0", "OMP_NUM_THREADS=\"4,0\""},
        {"OMP_THREAD_LIMIT=no", "OMP_THREAD_LIMIT=\"no\""},
    };
    for (int k = 0; k < RUNS; k++)
        for (size_t v = 0; v < (strcmp(runs[k][0], "solve") == 0 ? sizeof values / sizeof *values : 2); v++) {
            program_result r = run_after(*state, values[v][0], k);
            assert_sentence(&r, values[v][1]);
        }
    assert_int_equal(program_shell(*state, "ls NEW*").code, 2);
}

/* Of no use to softfall, and the runtime would print about them or run out of stack. */
static void other_variables_of_openmp_have_no_effect(void **state) {
    program_result r =
        program_shell(*state, "OMP_STACKSIZE=1k GOMP_STACKSIZE=zz OMP_SCHEDULE=zz OMP_NESTED=zz "
                              "OMP_MAX_ACTIVE_LEVELS=zz OMP_DISPLAY_ENV=true "
                              "OMP_NUM_THREADS=' 2, 1' OMP_PROC_BIND=FALSE OMP_DYNAMIC= "
                              "\"$SF_BIN_DIR\"/softfall-solve model.h5 -o other.h5");
    if (r.code != 0 || strncmp(r.err, "softfall-solve: warning: ", 25) != 0 || strchr(r.err, '\n')[1])
        fail_msg("code %d: %s", r.code, r.err);
}

/* Values that the runtime would know or not: the program runs and tells of them. */
static void values_for_openmp_that_are_left_out_are_told(void **state) {
    static const char *const values[] = {"OMP_WAIT_POLICY=never", "OMP_PROC_BIND=spread,close",
                                         "OMP_PLACES={0:4}", "GOMP_SPINCOUNT=100k", "GOMP_CPU_AFFINITY=0-3"};
    for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
        program_result r = program_shell(
            *state, "env '%s' \"$SF_BIN_DIR\"/softfall-solve model.h5 -o other.h5 --force", values[v]);
        if (r.code != 0 || !strstr(r.err, "of the environment has no effect"))
            fail_msg("code %d: %s", r.code, r.err);
    }
}

static void threads_that_cannot_be_started_are_refused(void **state) {
    if (SANITIZED)
        check_skip_refused("sanitizers take address space and stack of their own");
    program_result r =
        program_shell(*state, "ulimit -v 400000; \"$SF_BIN_DIR\"/softfall-solve model.h5 -o NEW -t 1000");
    assert_sentence(&r, "softfall-solve: 1000 threads cannot be started, only ");
    assert_int_equal(program_shell(*state, "ls NEW*").code, 2);
}

static void small_stacks_are_raised_or_refused(void **state) {
    if (SANITIZED)
        check_skip_refused("sanitizers take address space and stack of their own");
    for (int k = 0; k < RUNS; k++) {
        program_result r = run_after(*state, "ulimit -s 100;", k);
        assert_sentence(&r, "the stack is limited to 100 kB; at least 1024 kB are needed");
    }
    assert_int_equal(program_shell(*state, "ls NEW*").code, 2);
    program_result r =
        program_shell(*state, "ulimit -S -s 100; \"$SF_BIN_DIR\"/softfall-solve model.h5 -o stack.h5 -t 3");
    if (r.code != 0)
        fail_msg("code %d: %s", r.code, r.err);
}

static void file_size_limits_are_told_and_leave_no_pieces(void **state) {
    const program_place *p = *state;
    for (int k = 0; k < RUNS; k++) {
        program_result r = run_after(p, "ulimit -f 8;", k);
        assert_sentence(&r, "softfall-");
        program_result left = program_shell(
            p, "find . -path './NEW*' -type f ! -name log.txt ! -name .softfall-own; ls -d NEW*.* .soft*");
        if (*left.out)
            fail_msg("%s leaves %s", runs[k][0], left.out);
        program_shell(p, "rm -rf NEW*");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(impossible_values_for_openmp_are_refused_by_every_program),
        cmocka_unit_test(other_variables_of_openmp_have_no_effect),
        cmocka_unit_test(values_for_openmp_that_are_left_out_are_told),
        cmocka_unit_test(threads_that_cannot_be_started_are_refused),
        cmocka_unit_test(small_stacks_are_raised_or_refused),
        cmocka_unit_test(file_size_limits_are_told_and_leave_no_pieces),
    };
    return cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
