/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What happens when the place for the output fails: a full disk, a folder that may not be written, an input
 * that vanishes, a standard output that nobody reads, an earlier run that was killed. Each program says it in
 * a sentence, ends with a code that is not 0, and leaves what was there before as it was.
 *
 * The full disk is a small tmpfs in a mount namespace of the command's own (unshare), which only root can
 * have; anyone else sees those tests skipped. */
#include "check.h"
#include "program_fixture.h"

#include "io/folder.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

/* The last line of stderr is the program's sentence, with `part` in it. */
static void assert_says(const program_result *r, const char *program, const char *part) {
    char begin[64];
    const char *last = r->err;
    snprintf(begin, sizeof begin, "softfall-%s: ", program);
    for (const char *c = r->err; *c; c++)
        if (c[0] == '\n' && c[1] != '\0')
            last = c + 1;
    if (r->code <= 0 || r->code >= 128)
        fail_msg("exit code %d: %s", r->code, r->err);
    if (strncmp(last, begin, strlen(begin)) != 0 || !strstr(last, part))
        fail_msg("no sentence of %s with \"%s\": %s", begin, part, r->err);
}

/* Runs the program's words with a tmpfs of `kilobytes` on full/ after the command `before`, and then the
 * command `after`, whose output goes to `seen`. Skips the test where no tmpfs can be mounted. HDF5 does not
 * release a file that it cannot close: the sanitizer looks for no leaks here. */
static void run_on_small_disk(const program_place *p, int kilobytes, const char *before, const char *program,
                              const char *words, const char *after, program_result *result,
                              program_result *seen) {
    program_result root = program_shell(p, "mkdir -p full && unshare -m true");
    if (geteuid() != 0 || root.code != 0)
        check_skip_refused("a tmpfs of one's own needs root and the right to mount");
    *result = program_shell(
        p,
        "unshare -m sh -c \"mount -t tmpfs -o size=%dk none full && %s && "
        "{ ASAN_OPTIONS=detect_leaks=0 '%s/softfall-%s' %s; code=\\$?; (%s) > seen 2>&1; exit \\$code; }\"",
        kilobytes, before, getenv("SF_BIN_DIR"), program, words, after);
    *seen = program_shell(p, "cat seen");
}

static void full_disk_is_told_and_spares_the_earlier_files(void **state) {
    const program_place *p = *state;
    char pre[512];
    snprintf(pre, sizeof pre, "good.cfg -o full/model.h5 --force %s", program_coarse(20));
    const struct {
        const char *before, *program, *words, *after, *part;
        int kilobytes;
    } rows[] = {
        /* A sound model of another run is there, and its successor does not fit beside it. */
        {"cp model.h5 full/model.h5", "pre", pre, "cmp model.h5 full/model.h5 && ls full", "full/model.h5",
         900},
        {"cp -r out/summary.json full/summary.json", "post", "results.h5 -o full --force",
         "cmp out/summary.json full/summary.json && ls -A full", "disk full", 112},
        {"true", "solve", "model.h5 -o full/results.h5", "ls full", "full/results.h5", 400},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result result, seen;
        run_on_small_disk(p, rows[k].kilobytes, rows[k].before, rows[k].program, rows[k].words, rows[k].after,
                          &result, &seen);
        assert_says(&result, rows[k].program, rows[k].part);
        if (strcmp(rows[k].program, "solve") == 0)
            continue;
        if (strcmp(seen.out, k == 0 ? "model.h5\n" : "summary.json\n") !=
            0) /* alone, and the same as before */
            fail_msg("%s left: %s", rows[k].program, seen.out);
    }
}

static void folder_that_may_not_be_written_is_told(void **state) {
    const program_place *p = *state;
    program_result result, seen;
    /* Root may write anywhere but on what is mounted read-only. */
    char pre[512];
    snprintf(pre, sizeof pre, "good.cfg -o full/model.h5 %s", program_coarse(20));
    const struct {
        const char *program, *words;
    } rows[] = {{"pre", pre}, {"solve", "model.h5 -o full/results.h5"}, {"post", "results.h5 -o full"}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        run_on_small_disk(p, 100, "mount -o remount,ro full", rows[k].program, rows[k].words, "ls full",
                          &result, &seen);
        assert_says(&result, rows[k].program, "Read-only file system");
        assert_string_equal(seen.out, "");
    }
}

/* One sentence and the code of a file that failed; the run may have warned of itself before. */
static void assert_file_fails(const program_result *r, const char *sentence) {
    assert_int_equal(r->code, SF_ERR_IO);
    const char *at = strstr(r->err, sentence), *warning = "softfall-solve: warning: ";
    bool first = at == r->err || (strncmp(r->err, warning, strlen(warning)) == 0 && at && at[-1] == '\n');
    if (!first || strchr(at, '\n') != strrchr(at, '\n'))
        fail_msg("no sentence \"%s...\": %s", sentence, r->err);
}

/* The first fields at the peak, and later ones, which must fit on the disk beside those before. */
static void peak_that_cannot_be_written_is_told(void **state) {
    const program_place *p = *state;
    static const struct {
        int kilobytes;
        const char *left;
    } rows[] = {{85, "base.h5\n"}, {215, "base.h5\nframe-000000.h5\npeak.h5\n"}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result result, seen;
        run_on_small_disk(p, rows[k].kilobytes, "true", "solve",
                          "model.h5 -o full/results.h5 --threads 1 --no-checkpoint", "ls full/results.h5.run",
                          &result, &seen);
        assert_file_fails(&result, "softfall-solve: full/results.h5.run/peak.h5.partial-");
        assert_string_equal(seen.out, rows[k].left);
    }
}

/* The model may be removed as soon as it is open: the run reads on from what it has open. */
static void input_that_vanishes_does_no_harm(void **state) {
    const program_place *p = *state;
    program_result gone = program_shell(p,
                                        "cp model.h5 vanish.h5 && { '%s/softfall-solve' vanish.h5 -o "
                                        "vanished.h5 --threads 1 & } && pid=$! && "
                                        "while ! [ -s vanished.h5 ] && kill -0 $pid 2>/dev/null; do sleep "
                                        "0.01; done; rm -f vanish.h5; wait $pid",
                                        getenv("SF_BIN_DIR"));
    assert_int_equal(gone.code, 0);
    program_succeed(p, "post", "vanished.h5 -o vanished");
    program_result later = program_run(p, "solve", "vanish.h5 -o new.h5");
    assert_says(&later, "solve", "vanish.h5 cannot be read: No such file");
}

/* What was asked for is written although nobody reads the words; the code tells that they were lost. */
static void closed_pipe_does_not_cost_the_files(void **state) {
    const program_place *p = *state;
    static const char *const rows[][3] = {
        {"pre", "good.cfg -o piped.h5", "piped.h5"},
        {"solve", "model.h5 -o piped_results.h5 --threads 1", "piped_results.h5"},
        {"post", "results.h5 -o piped", "piped/summary.json"}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        const char *coarse = k == 0 ? program_coarse(20) : "";
        /* sleep ends without having read anything; stderr goes to a file of its own. */
        program_result closed = program_shell(
            p, "( sleep 0.1; '%s/softfall-%s' %s %s; echo $? > code ) | sleep 0.01; cat code >&2; exit 9",
            getenv("SF_BIN_DIR"), rows[k][0], rows[k][1], coarse);
        if (!strstr(closed.err, "standard output cannot be written") || !strstr(closed.err, "\n3\n"))
            fail_msg("%s: %s", rows[k][0], closed.err);
        assert_int_equal(access(program_path(p, rows[k][2]), R_OK), 0);
        program_result full = program_shell(p, "'%s/softfall-%s' %s --force %s > /dev/full",
                                            getenv("SF_BIN_DIR"), rows[k][0], rows[k][1], coarse);
        assert_says(&full, rows[k][0], "standard output cannot be written");
    }
    program_succeed(p, "solve", "piped.h5 -o after.h5 --threads 1 --force");
}

/* A directory of a process that is gone is removed if it has softfall's mark; one without it, of a process
 * that lives, or a link, is not touched. */
static void leavings_of_killed_runs_are_removed(void **state) {
    const program_place *p = *state;
    char keep[64];
    program_result gone = program_shell(p, "sh -c 'echo $$'"); /* it has ended */
    int dead = atoi(gone.out);
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_folder_own(program_path(p, "own.h5.run"), &err), SF_OK);
    snprintf(keep, sizeof keep, ".softfall-%d-aaaaaa", (int)getpid());
    program_shell(
        p,
        "mkdir -p killed/.softfall-%d-bbbbbb killed/.softfall-%d-dddddd killed/%s precious; "
        "cp own.h5.run/.softfall-own killed/.softfall-%d-bbbbbb; echo x > killed/.softfall-%d-bbbbbb/pad.h5; "
        "echo x > killed/.softfall-%d-dddddd/mine; "
        "echo x > precious/file; ln -s ../precious killed/.softfall-%d-cccccc; mkdir killed/.softfall-keep",
        dead, dead, keep, dead, dead, dead, dead);
    program_succeed(p, "post", "results.h5 -o killed");
    program_result list = program_shell(p, "ls -A killed | grep '^\\.'; cat precious/file");
    char expected[128];
    snprintf(expected, sizeof expected,
             ".softfall-%d-aaaaaa\n.softfall-%d-cccccc\n.softfall-%d-dddddd\n.softfall-keep\nx\n",
             (int)getpid(), dead, dead);
    program_result sorted =
        program_shell(p,
                      "printf '%s' | sort > a; ls -A killed | grep '^\\.' > b; cat precious/file "
                      ">> b; sort -o b b; cmp a b",
                      expected);
    if (sorted.code != 0)
        fail_msg("left: %s", list.out);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_disk_is_told_and_spares_the_earlier_files),
        cmocka_unit_test(folder_that_may_not_be_written_is_told),
        cmocka_unit_test(peak_that_cannot_be_written_is_told),
        cmocka_unit_test(input_that_vanishes_does_no_harm),
        cmocka_unit_test(closed_pipe_does_not_cost_the_files),
        cmocka_unit_test(leavings_of_killed_runs_are_removed),
    };
    return cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
