/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-sweep on the example case with a coarse pad. */
#include "model_fixture.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>
#include <cmocka.h>

#include "io/folder.h"

/* Two speeds and two foams of a pad with a spacing of 20 mm. */
static void write_plan(const program_place *p, const char *name, const char *speeds) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "case = \"%s\";\ntitle = \"Two speeds & two foams\";\n"
        "set = [\"geometry.parameters.fine_spacing=20.0\", \"geometry.parameters.outer_spacing=40.0\","
        " \"pad.mesh_error_limit=9.0\"];\n"
        "factors = (\n{ key = \"missile.velocity\"; name = \"speed\"; values = %s; },\n"
        "{ key = \"material\"; name = \"foam\"; uncertain = true; files = [\"%s\", \"foam.cfg\"]; } );\n",
        fixture_source("examples/eva50-v4.5/case.cfg"), speeds,
        fixture_source("examples/materials/eva35.cfg"));
    program_write_text(p, name, text);
}

static int set_up(void **state) {
    int result = program_group_folder(state);
    const program_place *p = *state;
    program_shell(p, "sed 's/^HU = .*/HU = 0.1;/' '%s' > foam.cfg && cp '%s' .",
                  fixture_source("examples/materials/eva35.cfg"),
                  fixture_source("examples/materials/eva35.csv"));
    write_plan(p, "plan.cfg", "[\"3 m/s\", \"4 m/s\"]");
    return result;
}

static void a_dry_run_tells_the_table_and_the_cost_and_writes_nothing(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --dry-run --jobs 2");
    assert_non_null(strstr(r.out, "4 runs\n  id, speed (m/s), foam\n  1, 3, "));
    assert_non_null(strstr(r.out, "4 open runs of about "));
    assert_non_null(strstr(r.out, "the estimate of softfall-pre for the first row"));
    assert_int_equal(program_shell(p, "test -e out").code, 1);
}

/* It is a failed run of the campaign like others. */
static void a_first_row_without_a_model_is_told(void **state) {
    const program_place *p = *state;
    char text[1024];
    snprintf(text, sizeof text,
             "case = \"%s\";\n"
             "factors = ( { key = \"geometry.parameters.fine_spacing\"; values = [20.0, 5.0]; } );\n",
             fixture_source("examples/eva50-v4.5/case.cfg"));
    program_write_text(p, "coarse.cfg", text);
    program_result r = program_succeed(p, "sweep", "coarse.cfg -o out --dry-run");
    if (!strstr(r.out, "2 open runs; what they cost is not known\n  (the first row has no model: "))
        fail_msg("%s", r.out);
}

/* runs.csv without the figures that are of the machine. */
static char *table(const program_place *p) {
    program_result r =
        program_shell(p, "python3 -c \"import csv\nfor row in csv.DictReader(open('out/runs.csv')): "
                         "row.pop('wall_s'), row.pop('threads'); print(row)\"");
    assert_int_equal(r.code, 0);
    return strdup(r.out);
}

static void a_sweep_writes_its_table_and_report_and_resumes(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "4 runs: 4 done, 0 failed, 0 open"));
    assert_null(strstr(r.out, "nan"));
    assert_int_equal(program_shell(p, "test $(wc -l < out/runs.csv) = 5").code, 0);
    assert_int_equal(
        program_shell(
            p,
            "head -1 out/runs.csv | grep -q '^id,speed (m/s),foam,run_status,grade,message,folder,a_max_g,'")
            .code,
        0);
    assert_int_equal(program_shell(p, "test $(ls -d out/runs/drop-* | wc -l) = 4").code, 0);
    program_assert_page(p, "out/report.html", "Two speeds & two foams");
    program_assert_page(p, "out/report.html", "Probability of staying below the limits");
    assert_int_equal(program_shell(p, "python3 -m json.tool out/sweep.json > /dev/null").code, 0);
    assert_int_equal(
        program_shell(p, "for n in factors curves effects probability; do test -s out/$n.png || exit 1; done")
            .code,
        0);
    char *before = table(p);
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2"); /* nothing is left to do */
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
    char *again = table(p);
    assert_string_equal(again, before);
    program_shell(
        p, "rm -r out/runs.csv out/sweep.key $(ls -d out/runs/drop-* | head -1)"); /* as after a kill */
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2 --force");
    assert_non_null(strstr(r.out, "1 drops simulated, 3 were there"));
    char *resumed = table(p);
    assert_string_equal(resumed, before);
    free(before);
    free(again);
    free(resumed);
}

/* Goes on from the folder of the test before. */
static void what_a_run_reads_is_simulated_again_when_it_changes(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --dry-run");
    assert_non_null(strstr(r.out, "\n0 open runs of about "));
    program_shell(p, "sed -i 's/^HU = .*/HU = 0.2;/' foam.cfg");
    r = program_succeed(p, "sweep", "plan.cfg -o out --dry-run");
    assert_non_null(strstr(r.out, "\n4 open runs of about "));
    assert_non_null(strstr(r.out, "from 4 finished runs"));
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "every run is looked at again"));
    assert_non_null(strstr(r.out, "2 drops simulated, 2 were there"));
}

/* A material is edited while the first drop runs, and put back: no row is of other inputs or failed for good.
 */
static void inputs_that_change_meanwhile_end_the_campaign(void **state) {
    const program_place *p = *state;
    program_result r = program_shell(
        p,
        "cp foam.cfg kept.cfg; '%s/softfall-sweep' plan.cfg -o edited --jobs 1 & for k in $(seq 3000); do "
        "ls edited/runs/drop-*/log.txt >/dev/null 2>&1 && break; sleep 0.01; done; sed -i 's/^HU = .*/HU = 0.3;/' foam.cfg; "
        "wait $!",
        getenv("SF_BIN_DIR"));
    assert_int_equal(r.code, 3);
    assert_non_null(strstr(r.err, "has changed while the batch ran; repeat the command"));
    assert_int_equal(program_shell(p, "test -e edited/report.html").code, 1);
    assert_int_equal(program_shell(p, "grep -c ',open,' edited/runs.csv | grep -qx 4").code, 0);
    program_shell(p, "cp kept.cfg foam.cfg");
    r = program_succeed(p, "sweep", "plan.cfg -o edited --jobs 1");
    assert_non_null(strstr(r.out, "2 drops simulated, 2 were there"));
    assert_non_null(strstr(r.out, "4 runs: 4 done, 0 failed, 0 open"));
}

/* A file that only the mesher reads is changed when the first drop is done. */
static void a_geometry_that_changes_meanwhile_ends_the_campaign(void **state) {
    const program_place *p = *state;
    char text[1536];
    program_shell(p, "(echo 'Include \"size.geo\";'; cat '%s') > pad.geo; echo '// one' > size.geo",
                  fixture_source("geo/pad.geo"));
    snprintf(
        text, sizeof text,
        "case = \"%s\";\nset = [\"geometry.parameters.fine_spacing=20.0\", "
        "\"geometry.parameters.outer_spacing=40.0\", \"pad.mesh_error_limit=9.0\", \"geometry.file=%s/pad.geo\"];\n"
        "factors = ( { key = \"missile.velocity\"; values = [\"3 m/s\", \"4 m/s\", \"4.5 m/s\"]; } );\n",
        fixture_source("examples/eva50-v4.5/case.cfg"), p->folder);
    program_write_text(p, "included.cfg", text);
    program_result r = program_shell(
        p,
        "'%s/softfall-sweep' included.cfg -o included --jobs 1 & for k in $(seq 6000); do "
        "ls included/runs/drop-*/results.h5 >/dev/null 2>&1 && break; sleep 0.01; done; echo '// two' > size.geo; "
        "wait $!",
        getenv("SF_BIN_DIR"));
    if (r.code != 3 || !strstr(r.err, "includes or merges, or its result, changed while the campaign ran"))
        fail_msg("%d: %s%s", r.code, r.out, r.err);
    assert_int_equal(program_shell(p, "test -e included/report.html").code, 1);
    r = program_succeed(p, "sweep", "included.cfg -o included --jobs 1");
    assert_non_null(strstr(r.out, "3 runs: 3 done, 0 failed, 0 open"));
}

/* Of the same folder: the figures are those of runs.csv, in columns. */
static void runs_are_overlaid(void **state) {
    const program_place *p = *state;
    program_shell(
        p,
        "python3 -c \"import csv\nfor row in csv.DictReader(open('out/runs.csv')): print(row['folder'])\" | "
        "head -2 > pair");
    program_succeed(p, "post", "compare $(sed 's|^|out/runs/|' pair) -o both");
    program_assert_page(p, "both/report.html", "Comparison of runs");
    assert_int_equal(program_shell(p, "test -s both/compare.png").code, 0);
    program_result r = program_shell(
        p, "python3 -c \"import csv\nwanted = open('pair').read().split()\n"
           "runs = {row['folder']: row for row in csv.DictReader(open('out/runs.csv'))}\n"
           "table = list(csv.reader(open('both/compare.csv')))\n"
           "assert table[0] == ['figure'] + ['out/runs/' + name for name in wanted], table[0]\n"
           "for row in table[1:]: assert row[1:] == [runs[name][row[0]] for name in wanted], row\n"
           "print(len(table))\"");
    assert_int_equal(r.code, 0);
    assert_true(atoi(r.out) > 50);
    assert_int_equal(program_run(p, "post", "compare $(sed 's|^|out/runs/|' pair) -o both").code, 2);
    assert_int_equal(program_run(p, "post", "compare out/runs none.h5 -o third").code, 3);
    assert_int_equal(program_shell(p, "test -e third").code, 1);
}

static void assert_refused(const program_place *p, const char *words, const char *part) {
    program_result r = program_run(p, "sweep", "%s", words);
    if (r.code != 2 || !strstr(r.err, part))
        fail_msg("exit code %d, \"%s\" expected in: %s", r.code, part, r.err);
    const char *end = strchr(r.err, '\n');
    if (!end || end[1])
        fail_msg("more than a sentence: %s", r.err);
}

static void folders_that_are_not_of_the_plan_or_taken_are_refused(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    int lock = -1;
    write_plan(p, "other.cfg", "[\"3 m/s\", \"4 m/s\", \"5 m/s\"]");
    assert_refused(p, "other.cfg -o out", "holds the runs of another plan");
    assert_int_equal(sf_folder_lock(program_path(p, "out"), &lock, &err), SF_OK);
    assert_refused(p, "plan.cfg -o out", "another campaign is at work in out");
    close(lock);
    program_succeed(p, "sweep", "plan.cfg -o out");
    program_shell(p, "mkdir taken"); /* the same of softfall-cfh */
    assert_int_equal(sf_folder_lock(program_path(p, "taken"), &lock, &err), SF_OK);
    program_result r = program_run(p, "cfh", "'%s' -o taken", fixture_source("examples/eva50-v4.5/case.cfg"));
    assert_int_equal(r.code, 2);
    assert_non_null(strstr(r.err, "another campaign is at work in taken"));
    close(lock);
    program_shell(p, "mkdir used; touch used/report.html");
    assert_refused(p, "plan.cfg -o used", "used already holds report.html");
    program_shell(p, "mkdir table; echo mine > table/runs.csv");
    assert_refused(p, "plan.cfg -o table --dry-run", "table already holds runs.csv");
    program_succeed(p, "sweep", "plan.cfg -o table --dry-run --force");
    char *path = strdup(getenv("PATH"));
    program_shell(p, "mkdir -p only && ln -s /bin/true only/snakemake");
    setenv("PATH", program_path(p, "only"), 1);
    assert_refused(p, "plan.cfg -o new --engine snakemake --profile none", "no such profile of Snakemake");
    setenv("PATH", path, 1);
    free(path);
    write_plan(p, "wrong.cfg", "[\"3 kg\"]");
    assert_refused(p, "wrong.cfg -o new", "wrong.cfg:5: ");
    assert_refused(p, "none.cfg -o new", "none.cfg");
    assert_int_equal(program_shell(p, "test -e new").code, 1);
}

/* The worst run, and one whose missile reaches the anvil: report and view of each, with the figures of
 * runs.csv. */
static void runs_are_simulated_once_more_for_their_views(void **state) {
    const program_place *p = *state;
    char text[1024];
    snprintf(
        text, sizeof text,
        "case = \"%s\";\nset = [\"geometry.parameters.fine_spacing=20.0\", "
        "\"geometry.parameters.outer_spacing=40.0\", \"pad.mesh_error_limit=9.0\"];\n"
        "factors = ( { key = \"missile.velocity\"; name = \"sp<ee>d\"; values = [\"3 m/s\", \"4 m/s\", \"30 m/s\"]; } );\n",
        fixture_source("examples/eva50-v4.5/case.cfg"));
    program_write_text(p, "views.cfg", text);
    static const char *const bad[] = {"", "x", "4", "0", "worst,", "2x"};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        program_result r = program_run(p, "sweep", "views.cfg -o seen --views '%s'", bad[k]);
        assert_int_equal(r.code, SF_ERR_INPUT);
        assert_non_null(strstr(r.err, "is neither worst, limit, all nor the id of one of the 3 runs"));
    }
    assert_int_equal(program_shell(p, "test -e seen").code, 1);
    program_succeed(p, "sweep", "views.cfg -o seen --jobs 2");
    assert_int_equal(
        program_shell(p, "test -e seen/views || grep -q 'Runs to look at' seen/report.html").code, 1);
    program_succeed(p, "sweep", "views.cfg -o seen --jobs 2 --views worst,limit,3");
    program_assert_page(p, "seen/report.html",
                        "Run 2 (largest a_max_g, largest hic, a_max_g nearest to its limit,");
    program_assert_page(p, "seen/report.html", "Run 3 (asked for): sp<ee>d (m/s) 30; ");
    program_write_text(
        p, "seen.py",
        "import csv, json, os, re\npage = open('seen/report.html').read()\nrows = list(csv.DictReader(open('seen/runs.csv')))\n"
        "views = json.load(open('seen/sweep.json'))['views']\nassert [v['id'] for v in views] == [2, 3]\n"
        "for v in views:\n    here = 'views/' + v['folder']\n"
        "    for name in ('report.html', 'view.html'):\n"
        "        assert '<a href=\"%s/%s\">' % (here, name) in page and os.path.getsize('seen/%s/%s' % (here, name)) > 50000\n"
        "    told = json.load(open('seen/%s/summary.json' % here))\n"
        "    if v['id'] == 2: assert all('%.9g' % told[k] == rows[1][k] for k in ('a_max_g', 'hic', 'max_indentation_mm')) and not v['problem']\n"
        "    else: assert told['verdict']['grade'] == 'do not use' and 'anvil' in v['problem']\n");
    program_result r = program_shell(p, "python3 seen.py");
    if (r.code != 0)
        fail_msg("%s", r.err);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dry_run_tells_the_table_and_the_cost_and_writes_nothing),
        cmocka_unit_test(a_first_row_without_a_model_is_told),
        cmocka_unit_test(a_sweep_writes_its_table_and_report_and_resumes),
        cmocka_unit_test(what_a_run_reads_is_simulated_again_when_it_changes),
        cmocka_unit_test(inputs_that_change_meanwhile_end_the_campaign),
        cmocka_unit_test(a_geometry_that_changes_meanwhile_ends_the_campaign),
        cmocka_unit_test(runs_are_overlaid),
        cmocka_unit_test(folders_that_are_not_of_the_plan_or_taken_are_refused),
        cmocka_unit_test(runs_are_simulated_once_more_for_their_views),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
