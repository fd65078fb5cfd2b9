/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.html and its pictures: what stands in them, and that nothing has to be loaded to read them. */
#include "check.h"
#include "post/results/origin.h"
#include "report/chart.h"
#include "post/view/cut.h"
#include "post/view/plot.h"
#include "post_fixture.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* ---- the template ---- */

static void texts_are_escaped_and_valid_utf8(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *page = open_memstream(&text, &size);
    assert_non_null(page);
    sf_html_text(page, "a<b> & \"c\" \xc3\xa4 \xff \x01");
    fclose(page);
    assert_string_equal(text, "a&lt;b&gt; &amp; &quot;c&quot; \xc3\xa4 \xef\xbf\xbd \xef\xbf\xbd");
    free(text);
}

static void a_picture_keeps_no_prologue_and_its_own_ids(void **state) {
    (void)state;
    char *svg = sf_gnuplot_element(
        "<?xml version=\"1.0\"?>\n<svg id=\"canvas\"><title>gnuplot_plot_1</title><circle id='p'/>"
        "<use xlink:href='#p'/><rect fill=\"url(#p)\"/><text>wid='1'</text></svg>",
        "force");
    assert_string_equal(svg, "<svg id=\"force-canvas\"><circle id='force-p'/><use xlink:href='#force-p'/>"
                             "<rect fill=\"url(#force-p)\"/><text>wid='1'</text></svg>");
    free(svg);
    assert_null(sf_gnuplot_element("no picture", "force"));
}

/* ---- what the case says ---- */

static void keys_of_the_case_are_read_with_all_kinds_of_values(void **state) {
    (void)state;
    static const char parameters[] =
        "geometry.parameters                { side = 400; name = \"a b\"; } -                        given\n"
        "pad.fixed                          [\"base\", \"side\"]       -                        default\n"
        "material.E                         \"0.4136 MPa\"           413600 Pa                given\n"
        "material.HU                        0.01                     0.01                     given\n"
        "broken\n";
    sf_origin_key key;
    assert_true(sf_origin_find(parameters, "geometry.parameters", &key));
    assert_string_equal(key.value, "{ side = 400; name = \"a b\"; }");
    assert_true(sf_origin_find(parameters, "pad.fixed", &key));
    assert_string_equal(key.value, "[\"base\", \"side\"]");
    assert_false(key.given);
    assert_true(sf_origin_find(parameters, "material.E", &key));
    assert_string_equal(key.value, "0.4136 MPa");
    assert_string_equal(key.si, "413600 Pa");
    assert_true(key.given);
    assert_false(sf_origin_find(parameters, "material.H", &key));
    assert_false(sf_origin_find("", "material.E", &key));
}

static void comments_give_the_origin_of_the_material(void **state) {
    (void)state;
    static const char text[] =
        "# EVA pad\n#  second line\n\n# not this\ngeometry: {\n# nor this\n};\n"
        "material: {\n# from ../foam.cfg:\n# from the supplier's data sheet\n# from 2024\n# Foam of 35 kg/m3\nE = \"1 MPa\";\n# informed to 0.8\n"
        "};\nmissile: { # nor this\n};\n";
    char *origin = sf_origin_material(text, NULL);
    assert_string_equal(origin,
                        "from the supplier's data sheet\nfrom 2024\nFoam of 35 kg/m3\ninformed to 0.8\n");
    free(origin);
    char replaced[600];
    snprintf(replaced, sizeof replaced,
             "%s# --set material=@other.cfg\n#     # Other foam\n#     E = \"2 MPa\";\n", text);
    origin = sf_origin_material(replaced, NULL);
    assert_string_equal(origin, "Other foam\n");
    free(origin);
}

/* ---- pictures ---- */

static double area_of(int count, const sf_corner *c) {
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += c[k].x * c[(k + 1) % count].y - c[(k + 1) % count].x * c[k].y;
    return fabs(sum) / 2;
}

/* The bands of a linear field fill the triangle, each with its own area: value = x over the unit triangle. */
static void bands_of_a_linear_field_have_their_areas(void **state) {
    (void)state;
    const sf_corner triangle[3] = {{0, 0, 0}, {1, 0, 1}, {0, 1, 0}};
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        sf_corner part[SF_CORNERS];
        double low = k / 4.0, high = (k + 1) / 4.0;
        double area = area_of(sf_picture_band(3, triangle, low, high, part), part);
        assert_close(area, ((1 - low) * (1 - low) - (1 - high) * (1 - high)) / 2, 1e-12);
        sum += area;
    }
    assert_close(sum, 0.5, 1e-12);
    sf_corner part[SF_CORNERS];
    assert_int_equal(sf_picture_band(3, triangle, 2, 3, part), 0);
}

static void the_cut_is_the_section_of_the_pad(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    const fixture_options sound = {0};
    sf_results results;
    sf_cut cut;
    double area = 0;
    assert_int_equal(fixture_write(program_path(p, "cut.h5"), &sound, &err), SF_OK);
    assert_int_equal(sf_results_open(program_path(p, "cut.h5"), &results, &err), SF_OK);
    assert_int_equal(sf_cut_make(&results, &cut, &err), SF_OK);
    for (int64_t k = 0; k < cut.polygon_count; k++) {
        sf_corner corner[4];
        for (int c = 0; c < cut.polygon[k].count; c++) {
            const sf_cut_point *point = &cut.polygon[k].point[c];
            corner[c] = (sf_corner){sf_cut_value(point, results.position, 3, 0),
                                    sf_cut_value(point, results.position, 3, 2), 0};
            assert_close(sf_cut_value(point, results.position, 3, 1), cut.plane, 1e-12);
        }
        area += area_of(cut.polygon[k].count, corner);
    }
    assert_relative(area, 0.2 * FIXTURE_THICKNESS, 1e-4);
    assert_close(cut.axis, 0, 1e-12);
    assert_false(cut.mirrored);
    assert_true(cut.outline_count >= 2); /* the pyramid's left and right face */
    assert_true(cut.missile[1] > 0.01);
    assert_close(cut.missile[0], -cut.missile[1], 1e-6);
    sf_cut_free(&cut);
    sf_results_close(&results);
}

/* A pulse of 20 ms in a run of 100 ms. */
static void the_time_axis_ends_with_the_pulse(void **state) {
    (void)state;
    enum { ROWS = 1001 };
    static double time[ROWS], value[ROWS];
    for (int i = 0; i < ROWS; i++) {
        time[i] = 1e-4 * i;
        value[i] = i < 200 ? 100 * sin(M_PI * i / 200) : 0;
    }
    double range[2];
    const sf_figures figures = {.filtered = {ROWS, time, value}, .raw = {ROWS, time, value}};
    sf_plot_time_range(&figures, NULL, range);
    assert_close(range[0], 0, 1e-12);
    assert_true(range[1] > 0.02 && range[1] < 0.0225);
    const sf_comparison measured = {.measured.curve = {ROWS, time, value}, .shift = 0.001};
    sf_plot_time_range(&figures, &measured, range);
    assert_true(range[0] < 0 && range[0] > -0.003 && range[1] > 0.021 && range[1] < 0.025);
}

/* ---- the page ---- */

static void post_fixture(const program_place *p, const fixture_options *options, const char *arguments) {
    sf_error err = SF_ERROR_INIT;
    if (fixture_write(program_path(p, "results.h5"), options, &err) != SF_OK)
        fail_msg("%s", err.text);
    program_succeed(p, "post", "results.h5 -o out --force %s", arguments);
}

/* The page is sound, and the words of Python hold. */
static void assert_python(const program_place *p, const char *code) {
    program_assert_page(p, "out/report.html", "softfall-post");
    program_write_text(p, "check.py", code);
    program_result result = program_shell(p, "python3 check.py");
    if (result.code != 0)
        fail_msg("%s", result.err);
}

static const char page_check[] = "import json, re, xml.etree.ElementTree as tree\n"
                                 "text = open('out/report.html', encoding='utf-8').read()\n"
                                 "shown = ' '.join(t.strip() for t in tree.fromstring(text).itertext())\n"
                                 "s = json.load(open('out/summary.json'))\n";

static void the_page_needs_nothing_and_shows_the_figures_of_the_summary(void **state) {
    const program_place *p = *state;
    char code[4096];
    post_fixture(p, &(fixture_options){0}, "");
    snprintf(code, sizeof code,
             "%s"
             "assert '%%.1f g' %% s['a_max_g'] in shown and '%%.1f' %% s['hic'] in shown\n"
             "assert 'limit 200 g: passed' in shown and 'limit 1000: failed' in shown\n"
             "assert s['verdict']['grade'] in shown and 'Indicative, not a certification' in shown\n"
             "for key in ('gadd', 'clip_3ms_g', 'max_indentation_mm'):\n"
             "    assert re.search(key + r'\\s+' + re.escape('%%.4g' %% s[key]), shown), key\n"
             "assert 'a third of the way' in shown and 'half the peak force' in shown\n"
             "assert shown.count('not recorded in this file') >= 4\n" /* the fixture has no provenance */
             "assert text.count('<svg') >= 5\n",
             page_check);
    assert_python(p, code);
}

static void a_picture_that_cannot_be_made_is_replaced_by_the_reason(void **state) {
    const program_place *p = *state;
    char code[4096];
    post_fixture(p, &(fixture_options){.no_stress = true}, "");
    snprintf(
        code, sizeof code,
        "%s"
        "assert 'No picture of the deformed pad' in shown and 'No picture of the mid-section' in shown\n",
        page_check);
    assert_python(p, code);
    post_fixture(p, &(fixture_options){.end_time = 0.025, .status = "interrupted"}, "");
    snprintf(code, sizeof code, "%sassert 'No frame near: half the peak force' in shown\n", page_check);
    assert_python(p, code);
    post_fixture(p, &(fixture_options){.untouched = true, .status = "finished"}, "");
    snprintf(code, sizeof code,
             "%sassert 'limit 200 g: not judged' in shown and 'limit 1000: not judged' in shown\n"
             "assert 'failed' not in shown\n",
             page_check);
    assert_python(p, code);
    const char *programs = getenv("SF_BIN_DIR");
    assert_non_null(programs);
    program_result bare =
        program_shell(p, "PATH=/nonexistent '%s/softfall-post' results.h5 -o out --force", programs);
    assert_int_equal(bare.code, 0);
    snprintf(code, sizeof code,
             "%sassert shown.count('install gnuplot and run softfall-post again') >= 2\n"
             "assert 'run \"gnuplot' not in shown\n",
             page_check);
    assert_python(p, code);
}

/* A case's words may be anything. */
static void words_of_the_reference_cannot_leave_their_place(void **state) {
    const program_place *p = *state;
    char code[4096], rows[4096] = "time_ms,acceleration_g\n";
    for (int k = 0; k <= 60; k++) {
        size_t used = strlen(rows);
        double x = (k - 10) / 40.0;
        snprintf(rows + used, sizeof rows - used, "%d,%.4f\n", k, x > 0 && x < 1 ? 90 * sin(M_PI * x) : 0);
    }
    program_write_text(p, "<b>&.csv", rows);
    post_fixture(p, &(fixture_options){0}, "--reference '<b>&.csv' --reference-filter none");
    snprintf(code, sizeof code, "%sassert '<b>&.csv: a_max 90.' in shown and 'R²' in shown\n", page_check);
    assert_python(p, code);
}

/* ---- the scripts of the pictures ---- */

static void a_script_runs_from_anywhere_and_writes_beside_itself(void **state) {
    const program_place *p = *state;
    check_programs("gnuplot");
    post_fixture(p, &(fixture_options){0}, "");
    program_result run = program_shell(
        p,
        "rm out/acceleration.png; mkdir -p elsewhere; cd elsewhere; gnuplot ../out/acceleration.gp; gnuplot -c "
        "\"$PWD/../out/acceleration.gp\" svg; ls; test -s ../out/acceleration.png && test -s ../out/acceleration.svg");
    assert_int_equal(run.code, 0);
    assert_string_equal(run.out, "");
    assert_int_equal(program_shell(p, "rm out/acceleration.svg; cd out && gnuplot acceleration.gp").code, 0);
}

/* As many entries as post draws; in both pictures the key needs no more rows than are kept free. */
static void the_key_lies_below_the_title_of_the_axis(void **state) {
    const program_place *p = *state;
    check_programs("gnuplot");
    for (int entries = 1; entries <= 5; entries++) {
        sf_error err = SF_ERROR_INIT;
        sf_staging output = {0};
        char warning[320];
        static const char *const only[] = {"key.gp", NULL};
        assert_int_equal(sf_staging_begin(program_path(p, "key"), only, true, &output, &err), SF_OK);
        sf_chart *chart = sf_chart_new("key", 1600, 830, &err);
        sf_panel *panel = sf_chart_panel(chart);
        assert_non_null(panel);
        sf_axis_label(&panel->x, "time (ms)");
        sf_axis_label(&panel->y, "deceleration (g)");
        panel->key = SF_KEY_BELOW;
        panel->key_columns = SF_PLOT_KEY_COLUMNS;
        static const char *const title[] = {"HIC 1253.4: 12.34 to 23.45 ms", "CFC 1000", "raw",
                                            "measured, as in its file", "measured, CFC 1000: a_max 123.4 g"};
        for (int k = 0; k < entries; k++) {
            sf_series_data *line = sf_chart_series(
                chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c"}, "%s", title[k]);
            sf_series_point(line, 0, 0);
            sf_series_point(line, 1, k + 1);
        }
        char *svg = sf_chart_page(chart, &output, "softfall-post", warning, sizeof warning, &err);
        sf_chart_free(chart);
        sf_staging_end(&output);
        assert_non_null(svg);
        program_write_text(p, "key.svg", svg);
        free(svg);
        program_write_text(
            p, "check.py",
            "import re\n"
            "texts = re.findall(r'translate\\([-0-9.]+,([-0-9.]+)\\)[^>]*>\\s*<text>(.*?)</text>',"
            " open('key.svg').read(), re.S)\n"
            "place = {re.sub('<.*?>', '', t).strip(): float(y) for y, t in texts}\n"
            "axis = place.pop('time (ms)')\n"
            "below = [y for t, y in place.items() if t in ('CFC 1000', 'raw') or t[:3] in ('HIC', 'mea')]\n"
            "assert below and min(below) > axis + 10, (axis, place)\n");
        program_result result = program_shell(p, "python3 check.py");
        if (result.code != 0)
            fail_msg("%d entries: %s", entries, result.err);
    }
}

/* The raw curve of the half sine lies below the filtered one. */
static void a_hidden_curve_has_no_entry(void **state) {
    const program_place *p = *state;
    post_fixture(p, &(fixture_options){0}, "");
    assert_int_equal(program_shell(p, "grep -q \"title 'raw'\" out/acceleration.gp").code, 1);
    assert_int_equal(program_shell(p, "grep -q \"a_max 100.0 g' at \" out/acceleration.gp").code, 0);
    double time[3] = {0, 0.01, 0.02}, seen[3] = {0, 100, 0}, other[3] = {0, 98, 0};
    const double range[2] = {0, 0.02}, part[2] = {0.015, 0.02};
    const sf_series a = {3, time, seen}, b = {3, time, other};
    assert_close(sf_plot_difference(&a, &b, range), 0.02, 1e-12);
    assert_close(sf_plot_difference(&a, &b, part), 0, 1e-12);
}

static void a_noisy_measured_curve_stands_thin_behind_what_the_filter_leaves(void **state) {
    const program_place *p = *state;
    static char rows[32768] = "time_ms,acceleration_g\n";
    for (int k = 0; k <= 1000; k++) {
        size_t used = strlen(rows);
        double t = 0.06 * k, x = (t - 10) / 40;
        snprintf(rows + used, sizeof rows - used, "%.3f,%.3f\n", t,
                 (x > 0 && x < 1 ? 90 * sin(M_PI * x) : 0) + (k % 2 ? 3 : -3));
    }
    program_write_text(p, "noisy.csv", rows);
    post_fixture(p, &(fixture_options){0}, "--reference noisy.csv");
    program_result script = program_shell(p, "sed -n '/^plot/,$p' out/acceleration.gp");
    const char *points = strstr(script.out, "title 'measured, as in its file'"),
               *model = strstr(script.out, "title 'model"),
               *measured = strstr(script.out, "title 'measured, CFC 1000: a_max 9");
    assert_true(points && model && measured && points < model && model < measured);
    post_fixture(p, &(fixture_options){0}, "--reference noisy.csv --reference-filter none");
    script = program_shell(p, "sed -n '/^plot/,$p' out/acceleration.gp");
    assert_null(strstr(script.out, "as in its file"));
    assert_non_null(strstr(script.out, "title 'measured: a_max 9"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_are_escaped_and_valid_utf8),
        cmocka_unit_test(a_picture_keeps_no_prologue_and_its_own_ids),
        cmocka_unit_test(keys_of_the_case_are_read_with_all_kinds_of_values),
        cmocka_unit_test(comments_give_the_origin_of_the_material),
        cmocka_unit_test(bands_of_a_linear_field_have_their_areas),
        cmocka_unit_test(the_cut_is_the_section_of_the_pad),
        cmocka_unit_test(the_time_axis_ends_with_the_pulse),
        cmocka_unit_test(the_page_needs_nothing_and_shows_the_figures_of_the_summary),
        cmocka_unit_test(a_picture_that_cannot_be_made_is_replaced_by_the_reason),
        cmocka_unit_test(words_of_the_reference_cannot_leave_their_place),
        cmocka_unit_test(a_script_runs_from_anywhere_and_writes_beside_itself),
        cmocka_unit_test(the_key_lies_below_the_title_of_the_axis),
        cmocka_unit_test(a_hidden_curve_has_no_entry),
        cmocka_unit_test(a_noisy_measured_curve_stands_thin_behind_what_the_filter_leaves),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
