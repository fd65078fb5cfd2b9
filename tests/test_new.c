/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-new as a user runs it, in folders far from the examples. */
#include "check.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* A line for each folder of examples/ with a case, and a sentence in it. */
static void the_list_has_every_example(void **state) {
    const program_place *p = *state;
    program_result list = program_succeed(p, "new", "--list | tee list");
    program_result folders = program_shell(
        p,
        "cd \"$SF_SOURCE_DIR/examples\" && ls -d */case.cfg | cut -d/ -f1 | LC_ALL=C sort > '%s/folders' && "
        "cut -d' ' -f1 '%s/list' | cmp - '%s/folders'",
        p->folder, p->folder, p->folder);
    assert_int_equal(folders.code, 0);
    assert_non_null(strstr(list.out, "\neva50-v4.5 "));
    program_result odd = program_shell(p, "grep -vE '^[^ ]+  +[A-Z].*[a-z]\\.$' list");
    assert_string_equal(odd.out, "");
}

/* The commands that it prints are those of a first case; the folder moves before they run. */
static void a_new_case_runs_as_it_stands(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "new", "mine %s --set solver.end_time='1 ms'", program_coarse(25));
    assert_non_null(strstr(r.out, "mine holds the case of the example eva50-v4.5, with all that it needs"));
    program_result done =
        program_shell(p,
                      "mv mine away && PATH=\"$SF_BIN_DIR:$PATH\" && "
                      "printf '%%s\\n' '%s' | grep '^    ' | sed 's/cd mine/cd away/' > steps && "
                      "wc -l < steps && sh -e ./steps && grep -c a_max away/out/summary.json",
                      r.out);
    if (done.code != 0)
        fail_msg("%s", done.err);
    assert_int_equal(strncmp(done.out, "4\n", 2), 0);
    assert_int_equal(program_shell(p, "test $(wc -l < away/README.md) -le 10").code, 0);
    program_result keys = program_shell(p, "grep -c '# of the whole missile' away/case.cfg");
    assert_string_equal(keys.out, "1\n");
}

static void any_case_can_be_taken(void **state) {
    const program_place *p = *state;
    program_succeed(p, "new", "first --from compression --set solver.end_time='1 ms'");
    program_succeed(p, "new", "second --from first/case.cfg --set missile.friction=0.1");
    assert_int_equal(program_shell(p,
                                   "test -f second/motion.csv && grep 'friction = 0.1;' second/case.cfg && "
                                   "grep 'from first/case.cfg' second/README.md && "
                                   "diff -x README.md -qr first second | wc -l | grep -x 1")
                         .code,
                     0);
}

/* The block of README.md that begins with softfall-new, coarse. */
static void the_commands_of_the_readme_run(void **state) {
    const program_place *p = *state;
    program_result r = program_shell(
        p,
        "mkdir readme && cd readme && PATH=\"$SF_BIN_DIR:$PATH\" && "
        "awk '/^```/ { inside = !inside; take = 0; next } inside && /^softfall-new/ { take = 1 } take' "
        "\"$SF_SOURCE_DIR/README.md\" > steps && test $(grep -c '^softfall-' steps) = 4 && "
        "sed \"s/^softfall-new [^#]*/&%s --set solver.end_time='1 ms' /\" steps > coarse && sh -e ./coarse && "
        "test -s my-pad/out/summary.json && test -s my-pad/out/report.html",
        program_coarse(25));
    if (r.code != 0)
        fail_msg("%s%s", r.out, r.err);
}

/* Each leaves the folder as it was. */
static void refusals_leave_nothing(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *words;
        int code;
        const char *part;
    } cases[] = {
        {"full", 2, "full exists and is not empty"},
        {"x --from nothing", 2,
         "unknown example \"nothing\"; the examples are channels, compression, cored, "},
        {"x --from fit", 2, "unknown example \"fit\""},
        {"x --from no/case.cfg", 2, "no/case.cfg"},
        {"no/such/x", 3, "No such file or directory"},
        {"x --set missile.velocity=fast", 2, "missile.velocity"},
        {"x --set missile.speed='3 m/s'", 2, "unknown key \"speed\""},
        {"'' ", 2, "name of the new folder is empty"},
        {"", 64, "--list"},
        {"x y", 64, "one too many"},
        {"--list x", 64, "--list"},
    };
    program_shell(p, "mkdir full && echo mine > full/file");
    program_result before = program_shell(p, "find . ! -name '.std*' | sort");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        program_result r = program_run(p, "new", "%s", cases[k].words);
        if (r.code != cases[k].code || !strstr(r.err, cases[k].part))
            fail_msg("%s: exit code %d, expected %d with \"%s\": %s", cases[k].words, r.code, cases[k].code,
                     cases[k].part, r.err);
    }
    program_result after = program_shell(p, "find . ! -name '.std*' | sort");
    assert_string_equal(before.out, after.out);
}

/* In an installed tree the examples are found from the program's place. */
static void an_installed_program_finds_its_examples(void **state) {
    const program_place *p = *state;
    program_result r = program_shell(
        p, "mkdir -p i/bin i/libexec/softfall i/share/softfall/examples && "
           "cp \"$SF_BIN_DIR/softfall-new\" i/bin && cp \"$SF_BIN_DIR/softfall-mesh\" i/libexec/softfall && "
           "cp -r \"$SF_SOURCE_DIR/geo\" i/share/softfall && "
           "cp -r \"$SF_SOURCE_DIR\"/examples/compression \"$SF_SOURCE_DIR\"/examples/materials "
           "i/share/softfall/examples && unset SF_BIN_DIR && i/bin/softfall-new --list | wc -l && "
           "i/bin/softfall-new one --from compression && rm -r i/share && i/bin/softfall-new --list");
    assert_int_equal(r.code, 3);
    assert_int_equal(strncmp(r.out, "1\n", 2), 0);
    assert_non_null(strstr(r.err, "/share/softfall/examples, which comes with softfall, is missing"));
    assert_int_equal(program_shell(p, "test -f one/geo/cube.geo").code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_list_has_every_example),
        cmocka_unit_test(a_new_case_runs_as_it_stands),
        cmocka_unit_test(any_case_can_be_taken),
        cmocka_unit_test(refusals_leave_nothing),
        cmocka_unit_test(an_installed_program_finds_its_examples),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(the_commands_of_the_readme_run),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_folder, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
