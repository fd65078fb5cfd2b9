/* SPDX-License-Identifier: GPL-3.0-or-later */
/* view.html of softfall-post: what it holds, how large it is, and how it works in a browser; how report.html
 * prints, and the words of a case about the test. What needs Chromium is skipped without it. */
#include "check.h"
#include "io/h5_data.h"
#include "io/replace.h"
#include "model_fixture.h"
#include "post/results/results.h"
#include "program_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <hdf5.h>

/* NAME_results.h5 and the folder NAME from a case. */
static void simulate(const program_place *p, const char *name, const char *case_and_options) {
    program_succeed(p, "pre", "%s -o %s.h5", case_and_options, name);
    program_succeed(p, "solve", "%s.h5 -o %s_results.h5 -t 1", name, name);
    program_succeed(p, "post", "%s_results.h5 -o %s", name, name);
}

/* A drop on a quarter of a pad, and a compression test. */
static int set_up(void **state) {
    program_group_example(state);
    const program_place *p = *state;
    char options[1024];
    snprintf(options, sizeof options, "good.cfg %s", program_coarse(15));
    simulate(p, "quarter", options);
    snprintf(options, sizeof options,
             "'%s' --set geometry.parameters.spacing=25 --set 'solver.end_time=20 ms'",
             fixture_source("examples/compression/case.cfg"));
    simulate(p, "pressed", options);
    return 0;
}

/* The text of folder/view.html. */
static char *read_page(const program_place *p, const char *folder) {
    char name[128];
    snprintf(name, sizeof name, "%s/view.html", folder);
    return program_read_file(program_path(p, name)).data;
}

static int count_of(const char *text, const char *words) {
    int count = 0;
    for (const char *at = strstr(text, words); at; at = strstr(at + 1, words))
        count++;
    return count;
}

/* ---- in a browser ---- */

static const sf_frame_head *head_at(const sf_results *r, double time) {
    for (int64_t k = 0; k < r->frame_count; k++)
        if (fabs(r->frames[k].time - time) < 1e-8)
            return &r->frames[k];
    assert_true(r->has_peak && fabs(r->peak.time - time) < 1e-8);
    return &r->peak;
}

static sf_frame_field field_of(const char *name) {
    return strcmp(name, "compression") == 0        ? SF_FRAME_LARGEST_COMPRESSION
           : strcmp(name, "contact pressure") == 0 ? SF_FRAME_CONTACT_PRESSURE
                                                   : SF_FRAME_VON_MISES;
}

/* A node as the page told it against results.h5, within the error that the page states. */
static void assert_told(const sf_results *r, const char *line) {
    double time, value, error, place[3], within;
    char field[64];
    int node;
    sf_frame frame;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sscanf(line, "%lf %63[^\t] %d %lf %lf %lf %lf %lf %lf", &time, field, &node, &value,
                            &error, &place[0], &place[1], &place[2], &within),
                     9);
    assert_in_range(node, 0, r->node_count - 1);
    assert_int_equal(sf_frame_read(r, head_at(r, time), SF_FIELD_ALL, &frame, &err), SF_OK);
    double expected = frame.field[field_of(field)][node];
    if (!(fabs(value - expected) <= 1.001 * error + 1e-8 * fabs(expected)) || !(within < 1e-5))
        fail_msg("%s is %.9g in results.h5, within %g: %s", field, expected, error, line);
    for (int d = 0; d < 3; d++)
        place[d] -= r->position[3 * node + d] + frame.field[SF_FRAME_DISPLACEMENT][3 * node + d];
    if (!(fmax(fmax(fabs(place[0]), fabs(place[1])), fabs(place[2])) <= 1.001 * within + 1e-9))
        fail_msg("the place is off by %g, %g, %g m: %s", place[0], place[1], place[2], line);
    sf_frame_free(&frame);
}

/* Uses the page of the folder in windows of these sizes; compares the nodes that clicks told. */
static void assert_works(const program_place *p, const char *folder, const char *results, const char *sizes) {
    sf_results r;
    sf_error err = SF_ERROR_INIT;
    check_programs("chromium");
    program_result told = program_shell(p, "python3 '%s' %s/view.html picks %s 2>&1",
                                        fixture_source("tests/check_view.py"), folder, sizes);
    if (told.code != 0)
        fail_msg("%s: %s", folder, told.out);
    assert_int_equal(sf_results_open(program_path(p, results), &r, &err), SF_OK);
    program_bytes picks = program_read_file(program_path(p, "picks"));
    int count = 0;
    char *rest = picks.data;
    for (char *line = strsep(&rest, "\n"); line && *line; line = strsep(&rest, "\n"), count++)
        assert_told(&r, line);
    assert_true(count > 3);
    sf_results_close(&r);
    free(picks.data);
}

static void a_quarter_works_on_a_desktop_and_a_phone(void **state) {
    assert_works(*state, "quarter", "quarter_results.h5", "800x560 390x844");
}

static void a_compression_test_works(void **state) {
    assert_works(*state, "pressed", "pressed_results.h5", "800x560");
}

static void a_skin_alone_works(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "post", "quarter_results.h5 -o skin --view 0.3");
    char *page = read_page(p, "skin");
    assert_null(strstr(r.err, "view.html"));
    assert_true(strlen(page) < 300000);
    assert_non_null(strstr(page, "its surface is shown"));
    assert_null(strstr(page, "\"cells\""));
    free(page);
    assert_works(p, "skin", "quarter_results.h5", "800x560");
}

/* A name that ends the script element, as a part of the path, and one frame. */
static void a_hostile_name_and_one_frame_work(void **state) {
    const program_place *p = *state;
    program_shell(p, "mkdir -p 'a<' && cp quarter_results.h5 'a</script><img src=x onerror=alert(1)>.h5'");
    hid_t file =
        H5Fopen(program_path(p, "a</script><img src=x onerror=alert(1)>.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    sf_results r;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_results_open(program_path(p, "quarter_results.h5"), &r, &err), SF_OK);
    for (int64_t k = 1; k < r.frame_count; k++)
        assert_true(H5Ldelete(file, r.frames[k].group, H5P_DEFAULT) >= 0);
    assert_true(H5Ldelete(file, "/peak", H5P_DEFAULT) >= 0);
    sf_results_close(&r);
    H5Fclose(file);
    assert_int_equal(sf_seal_add(program_path(p, "a</script><img src=x onerror=alert(1)>.h5"), &err), SF_OK);
    program_succeed(p, "post", "'a</script><img src=x onerror=alert(1)>.h5' -o one");
    char *page = read_page(p, "one");
    assert_int_equal(count_of(page, "</script>"), 2);
    assert_null(strstr(page, "<img"));
    assert_int_equal(count_of(page, "\"time\": "), 2); /* of the frame and of the curve */
    free(page);
    assert_works(p, "one", "quarter_results.h5", "390x844");
}

/* ---- what is written ---- */

static void the_page_keeps_to_its_size(void **state) {
    const program_place *p = *state;
    const double most[] = {5, 0.45, 0.4, 0.3, 0.25, 0.2};
    for (size_t k = 0; k < sizeof most / sizeof most[0]; k++) {
        program_succeed(p, "post", "quarter_results.h5 -o size --force --view %g", most[k]);
        char *page = read_page(p, "size");
        assert_true((double)strlen(page) <= 1e6 * most[k]);
        free(page);
    }
    program_result r = program_succeed(p, "post", "quarter_results.h5 -o size --force --view 0.15");
    assert_non_null(
        strstr(r.err, "nodes of the pad's surface do not fit into 0.15 MB (--view MB allows more)"));
    assert_int_equal(program_shell(p, "test -e size/view.html").code, 1);
    r = program_succeed(p, "post", "quarter_results.h5 -o size --force --view 0");
    assert_null(strstr(r.err, "view.html"));
    assert_int_equal(program_shell(p, "test -e size/view.html").code, 1);
}

static void a_size_that_is_none_is_refused(void **state) {
    const program_place *p = *state;
    const char *const bad[] = {"-1", "nan", "201", "much", "inf"};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        program_result r = program_run(p, "post", "results.h5 -o refused --view=%s", bad[k]);
        assert_int_equal(r.code, SF_ERR_INPUT);
        assert_non_null(strstr(r.err, "expected a size from 0 to 200 MB"));
        assert_int_equal(program_shell(p, "test -e refused").code, 1);
    }
}

/* The frames that are shown among too many have the peak and the last. */
static void fewer_frames_have_the_peak_and_the_ends(void **state) {
    const program_place *p = *state;
    sf_results r;
    sf_error err = SF_ERROR_INIT;
    char text[64];
    program_succeed(p, "post", "quarter_results.h5 -o few --view 0.2");
    char *page = read_page(p, "few");
    assert_int_equal(sf_results_open(program_path(p, "quarter_results.h5"), &r, &err), SF_OK);
    assert_non_null(strstr(page, "frames are shown"));
    const double times[] = {r.frames[0].time, r.has_peak ? r.peak.time : r.frames[0].time,
                            r.frames[r.frame_count - 1].time};
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text, "\"time\": %.9g,", times[k]);
        if (!strstr(page, text))
            fail_msg("no frame at %s", text);
    }
    sf_results_close(&r);
    free(page);
}

static void a_run_without_frames_has_no_page(void **state) {
    const program_place *p = *state;
    program_shell(p, "cp quarter_results.h5 none.h5");
    hid_t file = H5Fopen(program_path(p, "none.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(H5Ldelete(file, "/frames", H5P_DEFAULT) >= 0);
    assert_true(H5Ldelete(file, "/peak", H5P_DEFAULT) >= 0);
    hid_t group = H5Gcreate2(file, "/frames", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(group);
    H5Fclose(file);
    assert_int_equal(sf_seal_add(program_path(p, "none.h5"), SF_IGNORED), SF_OK);
    program_run(p, "post", "none.h5 -o none");
    assert_int_equal(program_shell(p, "test -e none/summary.json && ! test -e none/view.html").code, 0);
}

static void a_page_without_its_template_is_a_warning(void **state) {
    const program_place *p = *state;
    program_result r = program_shell(p, "SF_BIN_DIR=/nonexistent '%s/softfall-post' results.h5 -o bare",
                                     getenv("SF_BIN_DIR"));
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.err, "warning: there is no view.html: "));
}

/* ---- words of the case ---- */

static char *hash_of(const program_place *p, const char *results) {
    sf_error err = SF_ERROR_INIT;
    char *hash;
    sf_h5 *file = program_open_h5(p, results);
    assert_int_equal(sf_h5_read_text(file, "/provenance/model_hash", &hash, &err), SF_OK);
    sf_h5_close(&file, &err);
    return hash;
}

/* Words may be anything; they change no model. */
static void words_about_the_test_stand_in_the_summary(void **state) {
    const program_place *p = *state;
    program_succeed(
        p, "pre",
        "good.cfg -o words.h5 %s --set solver.end_time='1 ms' --set report.conditions='23 °C, 50 %%' "
        "--set report.sample='tile \"A\" {1} [x] \\ </script> & co'",
        program_coarse(25));
    program_succeed(p, "pre", "good.cfg -o plain.h5 %s --set solver.end_time='1 ms'", program_coarse(25));
    program_succeed(p, "solve", "words.h5 -o words_results.h5 -t 1");
    program_succeed(p, "solve", "plain.h5 -o plain_results.h5 -t 1");
    program_succeed(p, "post", "words_results.h5 -o words");
    program_result r =
        program_shell(p, "python3 -c \"import json; s = json.load(open('words/summary.json')); "
                         "print(s['sample'], s['laboratory'], s['conditions'])\"");
    assert_string_equal(r.out, "tile \"A\" {1} [x] \\ </script> & co None 23 °C, 50 %\n");
    char *with = hash_of(p, "words_results.h5"), *without = hash_of(p, "plain_results.h5");
    assert_string_equal(with, without);
    free(with);
    free(without);
}

static void words_that_break_a_line_are_refused(void **state) {
    const program_place *p = *state;
    program_write_text(p, "lines.cfg", "@include \"good.cfg\"\nreport: { sample = \"a\\nb\"; };\n");
    program_result r = program_run(p, "pre", "lines.cfg -o lines.h5");
    assert_int_equal(r.code, SF_ERR_INPUT);
    assert_non_null(strstr(r.err, "a line end or another control character"));
    r = program_run(p, "pre", "good.cfg -o lines.h5 --set report.samples=x");
    assert_int_equal(r.code, SF_ERR_INPUT);
    assert_non_null(strstr(r.err, "report.sample"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_keeps_to_its_size),
        cmocka_unit_test(a_size_that_is_none_is_refused),
        cmocka_unit_test(fewer_frames_have_the_peak_and_the_ends),
        cmocka_unit_test(a_run_without_frames_has_no_page),
        cmocka_unit_test(a_page_without_its_template_is_a_warning),
        cmocka_unit_test(words_about_the_test_stand_in_the_summary),
        cmocka_unit_test(words_that_break_a_line_are_refused),
        cmocka_unit_test(a_quarter_works_on_a_desktop_and_a_phone),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_hostile_name_and_one_frame_work),
        cmocka_unit_test(a_skin_alone_works),
        cmocka_unit_test(a_compression_test_works),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
