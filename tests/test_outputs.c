/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What -o and --force may not do to the files of the user: inputs, devices, files of others in folders of
 * ours, and names under which a file is written first. Each program refuses before it computes, and every
 * file stays byte by byte. */
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>
#include <cmocka.h>

static int set_up(void **state) {
    program_group_example(state);
    program_result made = program_shell(*state, "cp -r \"$SF_SOURCE_DIR/examples/fit/compression\" sound");
    if (made.code != 0)
        fail_msg("%s", made.err);
    return 0;
}

typedef struct attempt {
    const char *before;          /* shell, to set the place */
    const char *program, *words; /* under test */
    const char *sentence;        /* part of it */
} attempt;

/* One sentence, a code that is not 0, nothing made, nothing changed, and soon. */
static void assert_harmless(const program_place *p, const attempt *a) {
    if (a->before && program_shell(p, "%s", a->before).code != 0)
        fail_msg("cannot prepare: %s", a->before);
    char *was = program_list_files(p);
    program_result r = program_shell(p, "timeout -s KILL %d '%s/softfall-%s' %s", 100, getenv("SF_BIN_DIR"),
                                     a->program, a->words);
    char *is = program_list_files(p);
    const char *end = strchr(r.err, '\n');
    if (r.code == 0 || r.code >= 126 || strncmp(r.err, "softfall-", 9) != 0 || !end || end[1] != '\0' ||
        !strstr(r.err, a->sentence))
        fail_msg("softfall-%s %s: exit code %d: %s", a->program, a->words, r.code, r.err);
    if (strcmp(was, is) != 0)
        fail_msg("softfall-%s %s changed something: before\n%s\nafter\n%s", a->program, a->words, was, is);
    free(was);
    free(is);
}

static void assert_all_harmless(const program_place *p, const attempt *list, size_t count) {
    for (size_t k = 0; k < count; k++)
        assert_harmless(p, &list[k]);
}

#define ASSERT_ALL_HARMLESS(state, list) assert_all_harmless(*(state), list, sizeof(list) / sizeof(list)[0])

static void an_input_is_never_an_output(void **state) {
    static const char says[] = "would replace an input", kind[] = "is not replaced, as it is ";
    static const attempt list[] = {
        {NULL, "pre", "good.cfg -o good.cfg --force", kind},
        {NULL, "pre", "good.cfg -o ./geo/../good.cfg --force", kind},
        {NULL, "pre", "good.cfg -o materials/eva35.cfg --force", kind},
        {NULL, "pre", "good.cfg -o materials/eva35.csv --force", kind},
        {NULL, "pre", "good.cfg -o geo/pad.geo --force", kind},
        {NULL, "pre", "good.cfg -o geo/hemisphere.geo --force", kind},
        {"ln good.cfg hard && ln -s good.cfg soft", "pre", "good.cfg -o hard --force", kind},
        {NULL, "pre", "good.cfg -o soft --force", kind},
        {NULL, "pre", "soft -o soft --force", kind},
        {NULL, "solve", "model.h5 -o model.h5 --force", kind},
        {"ln model.h5 linked.h5", "solve", "model.h5 -o linked.h5 --force", kind},
        {"cp model.h5 x.h5.restart", "solve", "x.h5.restart -o x.h5 --force", kind},
        {"mkdir d1 && ln results.h5 d1/history.csv", "post", "results.h5 -o d1 --force", says},
        {"cp -r out d2", "post",
         "results.h5 -o d2 --force --reference d2/acceleration.csv --reference-filter none", says},
        {"cp -r sound d4 && mv d4/fit.cfg d4/material.cfg", "fit",
         "compression d4/material.cfg -o d4 --force", says},
        {"cp -r sound d5 && mv d5/slow.csv d5/fit.csv && sed -i 's|slow.csv|fit.csv|' d5/fit.cfg", "fit",
         "compression d5/fit.cfg -o d5 --force", says},
    };
    ASSERT_ALL_HARMLESS(state, list);
}

static void a_device_or_a_pipe_is_never_an_output(void **state) {
    const program_place *p = *state;
    static const char says[] = "it is a ";
    static const attempt list[] = {
        {NULL, "pre", "good.cfg -o null --force", says},
        {NULL, "pre", "good.cfg -o to-null --force", says},
        {NULL, "pre", "good.cfg -o to-nothing --force", says},
        {NULL, "pre", "good.cfg -o pipe --force", says},
        {NULL, "solve", "model.h5 -o to-null --force", says},
        {NULL, "solve", "model.h5 -o pipe --force", says},
        {"ln -s /dev/null y.h5.restart", "solve", "model.h5 -o y.h5 --force", says},
        {"mkdir e1 && mkfifo e1/report.html", "post", "results.h5 -o e1 --force", says},
        {"mkdir e2 && ln -s /dev/null e2/summary.json", "post", "results.h5 -o e2 --force", says},
        {"mkdir e3 && ln -s /dev/null e3/fit.json", "fit", "compression sound/fit.cfg -o e3 --force", says},
        {NULL, "post", "results.h5 -o pipe --force", "is not a folder"},
    };
    /* A node of one's own, where that is possible: what would happen to /dev/null is seen on it. */
    program_shell(p, "mkfifo pipe; ln -s null to-null; ln -s nowhere to-nothing");
    if (mknod(program_path(p, "null"), S_IFCHR | 0666, makedev(1, 3)) != 0)
        assert_int_equal(symlink("/dev/null", program_path(p, "null")), 0);
    ASSERT_ALL_HARMLESS(state, list);
    assert_int_equal(program_shell(p, "test -c null && test -c /dev/null").code, 0);
}

static void a_name_that_cannot_be_made_is_refused_first(void **state) {
    const program_place *p = *state;
    static const char *const commands[][2] = {{"pre", "good.cfg"},
                                              {"solve", "model.h5"},
                                              {"post", "results.h5"},
                                              {"fit", "compression sound/fit.cfg"}};
    for (size_t k = 0; k < sizeof commands / sizeof commands[0]; k++) {
        char words[600], longer[300];
        attempt a = {.program = commands[k][0], .words = words};
        bool file = k < 2;
        snprintf(longer, sizeof longer, "%0*d", file ? 245 : 256, 0); /* X fits, X.partial or X.run do not */
        const struct {
            const char *name, *sentence;
        } rows[] = {{"''", "is empty"},
                    {longer, file ? "too long" : "File name too long"},
                    {file ? "out" : "good.cfg", file ? "it is a folder" : "is not a folder"},
                    {"missing/new", "No such file"},
                    {file ? "out/" : "''", file ? "it is a folder" : "is empty"}};
        for (size_t q = 0; q < sizeof rows / sizeof rows[0]; q++) {
            snprintf(words, sizeof words, "%s -o %s --force", commands[k][1], rows[q].name);
            a.sentence = rows[q].sentence;
            assert_harmless(p, &a);
        }
    }
}

/* The names under which files are written first may be taken, even by links: such a file is not ours. */
static void files_that_look_like_rests_stay(void **state) {
    const program_place *p = *state;
    char pre[600];
    snprintf(pre, sizeof pre, "good.cfg -o z.h5 --force %s --set solver.end_time='1 ms'", program_coarse(25));
    program_shell(
        p,
        "echo mine > precious; cp precious r.h5.partial; cp precious r.h5.restart.partial; ln -s precious z.h5.partial; "
        "echo mine > z.h5.partial-999999999-01234567");
    program_succeed(p, "pre", "%s", pre);
    program_succeed(p, "solve", "z.h5 -o r.h5 --threads 1");
    program_result r = program_shell(
        p, "for f in precious r.h5.partial r.h5.restart.partial z.h5.partial "
           "z.h5.partial-999999999-01234567; do echo mine | cmp - $f || exit 1; done; test -L z.h5.partial");
    if (r.code != 0)
        fail_msg("%s%s", r.out, r.err);
}

/* --force replaces what the program writes, and nothing else. */
static void a_file_of_another_kind_is_not_replaced(void **state) {
    static const char page[] = "is not of softfall, and is not replaced";
    static const attempt list[] = {
        {"cp good.cfg k1.cfg", "solve", "model.h5 -o k1.cfg --force", "it is no softfall-results file"},
        {"cp model.h5 k2.h5", "solve", "model.h5 -o k2.h5 --force", "a file of the format softfall-model"},
        {"cp results.h5 k3.h5", "pre", "good.cfg -o k3.h5 --force", "a file of the format softfall-results"},
        {"cp good.cfg k4.cfg", "pre", "good.cfg -o k4.cfg --force", "it is no softfall-model file"},
        {"echo mine > k5.h5.restart", "solve", "model.h5 -o k5.h5 --force",
         "it is no softfall-checkpoint file"},
        {"mkdir k6 && echo mine > k6/report.html", "post", "results.h5 -o k6 --force", page},
        {"mkdir k7 && echo mine > k7/summary.json", "post", "results.h5 -o k7 --force", page},
    };
    ASSERT_ALL_HARMLESS(state, list);
}

static void strange_files_in_a_run_folder_stay(void **state) {
    static const attempt list[] = {
        {"mkdir s1.h5.run && echo mine > s1.h5.run/frame-notes.txt", "solve", "model.h5 -o s1.h5 --force",
         "was not made by softfall"},
        {"mkdir s2.h5.run && echo mine > s2.h5.run/base.h5", "solve", "model.h5 -o s2.h5 --force",
         "was not made by softfall"},
        {"echo mine > s3.h5.run", "solve", "model.h5 -o s3.h5 --force", "cannot be opened: "},
    };
    ASSERT_ALL_HARMLESS(state, list);
}

/* In the folder of a run that goes on: a name of ours with a content that is not, and names like ours. */
static void strange_files_in_a_folder_of_ours_stay(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "model.h5 -o own.h5 --threads 1 --end-time '0.5 ms'");
    program_shell(p, "mkdir own.h5.run && cp -r own.h5.run keep"); /* empty: is taken */
    program_shell(
        p,
        "for n in frame-notes.txt frame-000001.h5.txt base.h5.bak notes; do echo mine > own.h5.run/$n; done");
    const attempt strange = {NULL, "solve", "model.h5 -o own.h5 --force", "was not made by softfall"};
    assert_harmless(p, &strange);
    program_shell(
        p,
        "printf 'softfall keeps this folder: it removes files of its own here when they are no longer needed\\n' > "
        "own.h5.run/.softfall-own");
    program_succeed(p, "solve", "model.h5 -o own.h5 --force --threads 1 --end-time '0.5 ms'");
    program_result left = program_shell(p, "cd own.h5.run && cat *; ls");
    assert_string_equal(left.out,
                        "mine\nmine\nmine\nmine\nbase.h5.bak\nframe-000001.h5.txt\nframe-notes.txt\nnotes\n");
    program_shell(
        p,
        "printf 'softfall keeps this folder: it removes files of its own here when they are no longer needed\\n' > "
        "own.h5.run/.softfall-own; echo mine > own.h5.run/frame-000001.h5");
    const attempt named = {NULL, "solve", "model.h5 -o own.h5 --force",
                           "own.h5.run/frame-000001.h5 is not a file of softfall"};
    assert_harmless(p, &named);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_input_is_never_an_output),
        cmocka_unit_test(a_device_or_a_pipe_is_never_an_output),
        cmocka_unit_test(a_name_that_cannot_be_made_is_refused_first),
        cmocka_unit_test(files_that_look_like_rests_stay),
        cmocka_unit_test(a_file_of_another_kind_is_not_replaced),
        cmocka_unit_test(strange_files_in_a_run_folder_stay),
        cmocka_unit_test(strange_files_in_a_folder_of_ours_stay),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
