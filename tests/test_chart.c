/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Charts: gnuplot draws every kind of series and mark, the script runs alone from another folder, a series
 * without a number is left out, no text reaches gnuplot as a command, and without gnuplot there is a warning.
 */
#include "check.h"
#include "program_fixture.h"

#include "report/chart.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const names[] = {"all.gp", "all.png", NULL};

static sf_chart *make_chart(sf_error *err) {
    static const struct {
        sf_series_kind kind;
        const char *title;
    } kinds[] = {{SF_SERIES_LINE, "line"},     {SF_SERIES_POINTS, "points"}, {SF_SERIES_AREA, "area"},
                 {SF_SERIES_RANGE, "range"},   {SF_SERIES_BOXES, "boxes"},   {SF_SERIES_SPANS, "spans"},
                 {SF_SERIES_ERRORS, "errors"}, {SF_SERIES_SIDES, "sides"},   {SF_SERIES_CELLS, NULL}};
    sf_chart *chart = sf_chart_new("all", 1600, 900, err);
    sf_chart_title(chart, "two lines:\nit's `touch injected` \"quoted\"");
    sf_chart_columns(chart, 3);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        sf_panel *panel = sf_chart_panel(chart);
        assert_non_null(panel);
        sf_axis_label(&panel->x, "x of panel %zu", k);
        panel->key = (sf_key_place)(1 + k % SF_KEY_BELOW);
        const sf_series_style style = {.kind = kinds[k].kind, .colour = "#08519c", .size = 0.5};
        sf_series_data *series = kinds[k].title ? sf_chart_series(chart, style, "%s", kinds[k].title)
                                                : sf_chart_series(chart, style, NULL);
        for (int i = 0; i < 4; i++)
            sf_series_add(series, i, i * i, i * i - 0.5, i * i + 0.5);
        sf_series_point(sf_chart_series(chart, style, "no number"), NAN, NAN);
    }
    sf_panel *panel = sf_chart_panel(chart);
    assert_non_null(panel);
    sf_axis_word(chart, &panel->x, "one's");
    sf_axis_word(chart, &panel->x, "two");
    sf_axis_label(&panel->x2, "above");
    sf_axis_range(&panel->x2, 0, 1);
    sf_axis_range(&panel->y, -1, 3);
    sf_chart_level(chart, 1.5, "#cb181d", "limit %g", 1.5);
    sf_chart_drop(chart, 0.5, 1.5, "#606060", "drop");
    sf_chart_spot(chart, 0.5, 1, "#08306b", "spot");
    sf_chart_band(chart, (const double[2]){-INFINITY, 0.5}, (const double[2]){0, INFINITY}, "#f0f0f0", 1);
    sf_series_label(sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_LABELS}, NULL), 1, 2, "a\nb");
    return chart;
}

static void begin(const program_place *p, sf_staging *output, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_staging_begin(program_path(p, "chart"), names, true, output, err), SF_OK);
}

static void every_kind_is_drawn(void **state) {
    const program_place *p = *state;
    sf_error err;
    sf_staging output;
    char warning[320];
    check_programs("gnuplot");
    begin(p, &output, &err);
    sf_chart *chart = make_chart(&err);
    assert_int_equal(sf_chart_write(chart, &output, warning, sizeof warning, &err), SF_OK);
    assert_string_equal(warning, "");
    char *svg = sf_chart_svg(&output, "all", "softfall-test", warning, sizeof warning);
    assert_string_equal(warning, "");
    assert_non_null(svg);
    for (const char *const *text = (const char *const[]){"line", "sides", "x of panel 8", "limit 1.5",
                                                         "one's", "above", "drop", "spot", NULL};
         *text; text++)
        if (!strstr(svg, *text))
            fail_msg("the picture does not show \"%s\"", *text);
    assert_null(strstr(svg, "no number"));
    assert_null(strstr(svg, "two lines")); /* a page has the title in its text */
    free(svg);
    assert_int_equal(sf_staging_commit(&output, &err), SF_OK);
    sf_staging_end(&output);
    assert_int_equal(program_shell(p, "cd / && gnuplot \"$OLDPWD/chart/all.gp\" 2>&1 && test -s "
                                      "\"$OLDPWD/chart/all.png\"")
                         .code,
                     0);
    assert_int_equal(program_shell(p, "find . -name injected | grep .").code, 1);
}

static void without_gnuplot_the_script_stays_and_a_warning_says_so(void **state) {
    const program_place *p = *state;
    sf_error err;
    sf_staging output;
    char warning[320], *path = strdup(getenv("PATH"));
    begin(p, &output, &err);
    sf_chart *chart = make_chart(&err);
    setenv("PATH", "/nowhere", 1);
    assert_int_equal(sf_chart_write(chart, &output, warning, sizeof warning, &err), SF_OK);
    setenv("PATH", path, 1);
    free(path);
    assert_non_null(strstr(warning, "all.png was not drawn, as gnuplot cannot be run"));
    assert_true(sf_staging_has(&output, "all.gp"));
    sf_staging_end(&output);
}

static void a_failure_before_is_returned_by_the_last_call(void **state) {
    const program_place *p = *state;
    sf_error err;
    sf_staging output;
    char warning[320];
    begin(p, &output, &err);
    sf_chart *chart = make_chart(&err);
    SF_FAIL(&err, SF_ERR_MEMORY, "no memory");
    assert_non_null(sf_chart_panel(chart)); /* it is not drawn */
    sf_series_point(sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_LINE}, NULL), 0, 0);
    assert_int_equal(sf_chart_write(chart, &output, warning, sizeof warning, &err), SF_ERR_MEMORY);
    assert_false(sf_staging_has(&output, "all.gp"));
    sf_staging_end(&output);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_is_drawn),
        cmocka_unit_test(without_gnuplot_the_script_stays_and_a_warning_says_so),
        cmocka_unit_test(a_failure_before_is_returned_by_the_last_call),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
