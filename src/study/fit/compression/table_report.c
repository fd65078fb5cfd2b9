/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.html of the tables, and fit.png with data against fit over the whole range and at the foot,
 * deviations below. */
#include "study/fit/compression/table_fit.h"

#include "build_info.h"
#include "report/chart.h"
#include "study/material_file.h"
#include "study/setup.h"

static const char *const rates[SF_RATE_MODELS] = {
    "none: one curve for all rates",
    "log: curve times 1 + c ln(rate/slowest rate), written as a curve for each rate",
    "maxwell: one curve and a Maxwell branch ED, BETA1",
    "curves: a curve of its own for each rate",
};
const char *const sf_table_rules[SF_RULES] = {
    "H1, exponent by A = 0: B/(1 - strain)^m",
    "H1, exponent free: A + B/(1 - strain)^m",
    "H2: A + B/(limit - strain)^m",
};

const char *sf_table_rate_words(const sf_compression_fit *fit) {
    return fit->data.config->thermal ? "none: a curve of its own for each temperature, at one rate"
                                     : rates[fit->model.form.rate];
}

/* A value of the estimate with its unit; pressures in kPa. */
static void value_text(const sf_estimate *e, double value, char *out, size_t size) {
    bool pressure = strcmp(e->unit, "Pa") == 0;
    const char *unit = pressure ? "kPa" : e->unit;
    if (isfinite(value))
        snprintf(out, size, "%.5g%s%s", value * (pressure ? 1e-3 : 1), *unit ? " " : "", unit);
    else
        snprintf(out, size, "-");
}

sf_table_estimate sf_table_estimate_of(const sf_estimate *e) {
    sf_table_estimate out = {.interval = ""};
    char low[64], high[64];
    value_text(e, e->value, out.value, sizeof out.value);
    value_text(e, e->error, out.error, sizeof out.error);
    value_text(e, e->low, low, sizeof low);
    value_text(e, e->high, high, sizeof high);
    if (isfinite(e->low))
        snprintf(out.interval, sizeof out.interval, "%s to %s", low, high);
    return out;
}

const char *sf_table_misfit(const sf_side *side, char text[160]) {
    snprintf(text, 160,
             "rms deviation %.3g %% of the stress, %.3g %% of the largest; misfit (1 is scatter alone) %.3g",
             100 * side->relative, 100 * side->of_largest, side->misfit);
    return text;
}

#define OF_TEST(type, member) SF_ROW_OF(type, sf_table_test, member)
static const sf_row test_rows[] = {
    {.name = "file", OF_TEST(STRING, name)},
    {.key = "file", OF_TEST(STRING, test.path)},
    {.key = "understood", OF_TEST(TEXT, test.interpretation)},
    {.key = "toe_strain", OF_TEST(NUMBER, test.toe)},
    {.key = "rate_1_s", .name = "rate", .unit = "1/s", OF_TEST(NUMBER, test.rate)},
    {.key = "points_loading", .name = "points of loading", OF_TEST(INTEGER, test.loading)},
    {.key = "points_unloading", .name = "of unloading", OF_TEST(INTEGER, unloading)},
    {.key = "largest_strain", .name = "largest strain", OF_TEST(NUMBER, test.largest_strain)},
    {"largest_stress_Pa", "largest stress", "kPa", .shown = 1e-3, OF_TEST(NUMBER, test.largest_stress)},
    {"loading_rms_over_sigma", "deviation / scatter, loading", NULL, "%.3g", OF_TEST(NUMBER, rms[0])},
    {"unloading_rms_over_sigma", "unloading", NULL, "%.3g", OF_TEST(NUMBER, rms[1])},
    {"loading_rms_percent", "deviation, loading", "%", "%.3g", OF_TEST(NUMBER, percent[0])},
    {"unloading_rms_percent", "unloading", "%", "%.3g", OF_TEST(NUMBER, percent[1])},
    {.key = "temperature_K",
     .name = "temperature",
     .unit = "K",
     .format = "%.2f",
     OF_TEST(NUMBER, test.temperature)},
};

sf_rows sf_table_test_rows(const sf_table_result *r) {
    return (sf_rows){test_rows, sizeof test_rows / sizeof *test_rows - !r->fit.data.config->thermal};
}

static const sf_row simulation_rows[] = {
    {.key = "rate_1_s", .name = "rate", .unit = "1/s", OF_TEST(NUMBER, test.rate)},
    {.key = "speed_up", .name = "speed-up", OF_TEST(NUMBER, speed_up)},
    {"loading_difference_percent", "largest difference, loading", "%", "%.2g",
     OF_TEST(NUMBER, difference[0])},
    {"unloading_difference_percent", "unloading", "%", "%.2g", OF_TEST(NUMBER, difference[1])},
    {.key = "energy_error", .name = "energy error", .format = "%.1g", OF_TEST(NUMBER, energy_error)},
};
const sf_rows sf_table_simulation_rows = {simulation_rows, sizeof simulation_rows / sizeof *simulation_rows};

/* ---- the picture ---- */

/* Light to dark with the rate: points, lines. */
static const char *const POINT[SF_COMPRESSION_TESTS] = {"#9ecae1", "#fdae6b", "#a1d99b", "#bcbddc",
                                                        "#fa9fb5", "#bdbdbd", "#d8b365", "#80cdc1"};
static const char *const LINE[SF_COMPRESSION_TESTS] = {"#08519c", "#a63603", "#006d2c", "#54278f",
                                                       "#7a0177", "#252525", "#8c510a", "#01665e"};

static sf_panel *new_panel(sf_chart *chart, const char *title, double left, double right, double bottom,
                           double top) {
    sf_panel *panel =
        sf_chart_panel_at(chart, "compressive strain", "nominal stress (kPa)", left, right, bottom, top);
    snprintf(panel->title, sizeof panel->title, "%s", title);
    panel->x.step = 0.1;
    return panel;
}

/* Points and lines of every test. */
static void put_curves(sf_chart *chart, const sf_compression_fit *fit, bool titles) {
    const sf_compression_data *d = &fit->data;
    for (int k = 0; k < d->config->test_count; k++) {
        sf_series_data *points = sf_chart_series(
            chart, (sf_series_style){.kind = SF_SERIES_POINTS, .colour = POINT[k], .size = 0.9}, NULL);
        for (int i = 0; i < d->count; i++)
            if (d->test[i] == k)
                sf_series_point(points, d->strain[i], 1e-3 * d->stress[i]);
    }
    for (int k = 0; k < d->config->test_count; k++) {
        const sf_series_style style = {.kind = SF_SERIES_LINE, .colour = LINE[k], .width = 1.8};
        const sf_compression_test *t = &d->config->test[k];
        bool thermal = d->config->thermal;
        sf_series_data *line = sf_chart_series(chart, style,
                                               !titles   ? NULL
                                               : thermal ? "fit at %.3g degC"
                                                         : "fit at %.3g 1/s",
                                               thermal ? t->temperature - SF_CELSIUS : t->rate);
        for (int i = 0; i < d->count; i++)
            if (d->test[i] == k)
                sf_series_point(line, d->strain[i], 1e-3 * fit->stress[i]);
    }
}

static void put_deviations(sf_chart *chart, sf_panel *panel, const sf_compression_fit *fit) {
    const sf_compression_data *d = &fit->data;
    double largest = 3;
    for (int i = 0; i < d->count; i++)
        largest = fmax(largest, fabs(d->stress[i] - fit->stress[i]) / d->sigma[i]);
    sf_axis_label(&panel->y, "deviation / scatter");
    sf_axis_range(&panel->y, -1.08 * largest, 1.08 * largest);
    panel->key = SF_KEY_TOP;
    sf_chart_band(chart, (const double[2]){-INFINITY, INFINITY}, (const double[2]){-2, 2}, "#f0f0f0", 1);
    for (int k = 0; k < d->config->test_count; k++)
        for (int side = 0; side < 2; side++) {
            const sf_series_style style = {.kind = SF_SERIES_POINTS,
                                           .colour = side ? POINT[k] : LINE[k],
                                           .shape = side ? SF_POINT_CIRCLE : SF_POINT_DISC,
                                           .size = 0.7};
            sf_series_data *points = sf_chart_series(chart, style,
                                                     k > 0  ? NULL
                                                     : side ? "unloading"
                                                            : "loading");
            for (int i = 0; i < d->count; i++)
                if (d->test[i] == k && d->unloading[i] == (side == 1))
                    sf_series_point(points, d->strain[i], (d->stress[i] - fit->stress[i]) / d->sigma[i]);
        }
}

static sf_status write_picture(const sf_staging *output, const sf_compression_fit *fit, char *warning,
                               size_t size, sf_error *err) {
    sf_chart *chart = sf_chart_new("fit", 1700, 1350, err);
    double end = fit->data.end;
    sf_chart_title(chart, "%s: compression tests (points) and fit (lines)", fit->data.config->name);
    sf_panel *whole = new_panel(chart, "whole range", 0.08, 0.49, 0.47, 0.9);
    sf_axis_range(&whole->x, 0, 1.02 * end);
    sf_axis_range(&whole->y, 0, NAN);
    whole->key = SF_KEY_TOP_LEFT;
    put_curves(chart, fit, true);
    sf_panel *foot = new_panel(chart, "foot and plateau", 0.58, 0.98, 0.47, 0.9);
    sf_axis_range(&foot->x, 0, 0.6 * end);
    int half = 0; /* point of the loading curve at half the largest strain */
    while (half + 1 < fit->table_count && fit->table_strain[half] < 0.5 * end)
        half++;
    sf_axis_range(&foot->y, 0, 1.3e-3 * fit->table_stress[fit->rate_count - 1][half]);
    put_curves(chart, fit, false);
    sf_panel *below = new_panel(
        chart, "Deviation of the data from the fit, over the standard deviation of the scatter (band: ±2)",
        0.08, 0.98, 0.07, 0.34);
    sf_axis_range(&below->x, 0, 1.02 * end);
    put_deviations(chart, below, fit);
    return sf_chart_write(chart, output, warning, size, err);
}

/* ---- the page ---- */

/* The banner says whether the law leaves nothing but scatter. */
static void put_banner(FILE *out, const sf_compression_fit *fit) {
    bool misses = fit->misfit > 2;
    sf_html_banner(
        out, misses ? "fair" : "good", misses ? "the law misses the data" : "the law fits the data",
        "Misfit chi2/(n - p) = %.3g with n = %d points and p = %d parameters (%d coefficients for each "
        "loading curve). 1: the law leaves nothing but scatter; above it the law misses the data, and the "
        "standard errors are widened by its root.",
        fit->misfit, fit->data.count, fit->model.parameter_count, fit->model.spline.count - 1);
}

static void put_tests(FILE *out, const sf_table_result *r) {
    const sf_compression_config *c = r->fit.data.config;
    sf_html_heading(out, "Tests");
    if (c->specimen.area > 0 && c->specimen.thickness > 0)
        sf_html_paragraph(out, "Specimen of %.5g mm², %.4g mm thick, %.4g kg/m³.", 1e6 * c->specimen.area,
                          1e3 * c->specimen.thickness, c->density);
    sf_rows_html_table(out, sf_table_test_rows(r), (sf_records){r->test, sizeof r->test[0], r->test_count});
    sf_html_note(
        out, "Deviation: root mean square of data less fit, over the scatter (1: nothing but scatter) and in "
             "percent of the stress (counted as a hundredth of the largest at least).");
    for (int k = 0; k < r->test_count; k++)
        sf_html_note(out, "Read from %s: %s", r->test[k].test.path, r->test[k].test.interpretation);
}

static void put_parameters(FILE *out, const sf_compression_fit *fit) {
    SF_PRINTED(columns, 96, "parameter|value|standard error|%g %% interval|note",
               100 * fit->data.config->confidence);
    SF_HTML_BLOCK(out, "Parameters");
    sf_html_table table = sf_html_table_begin(out, columns);
    for (const sf_estimate *e = fit->estimate; e < fit->estimate + SF_ESTIMATES; e++) {
        sf_table_estimate shown = sf_table_estimate_of(e);
        if (e->present)
            sf_html_line(&table, e->name, "%s|%s|%s|%s", shown.value, shown.error, shown.interval, e->note);
    }
    sf_html_table_end(&table);
    sf_html_note(out, SF_MATERIAL_ELSEWHERE);
    sf_html_note(out,
                 "E is the slope of a straight line through the loading of the slowest test (of several "
                 "temperatures: of that nearest to 23 degC) below a strain of %g; where the curve bends "
                 "within that range the slope at rest is steeper. The loading curve with its interval is in "
                 "loading_curve.csv.",
                 fit->data.config->modulus_range);
}

/* A table of the forms that were tried; false: none was. */
static bool put_candidates(FILE *out, const sf_candidate *c, int count, int chosen,
                           const char *const *phrase) {
    double lowest = INFINITY;
    for (int k = 0; k < count; k++)
        lowest = c[k].tried ? fmin(lowest, c[k].bic) : lowest;
    if (isinf(lowest))
        return false;
    SF_HTML_TABLE table = sf_html_table_begin(out, "form|>parameters|>chi2|>BIC above the lowest|choice");
    for (int k = 0; k < count; k++)
        if (c[k].tried)
            sf_html_line(&table, phrase[k], "%d|%.6g|%.1f|%s", c[k].parameters, c[k].chi2, c[k].bic - lowest,
                         k == chosen ? "chosen" : "");
    return true;
}

static void put_choice(FILE *out, const sf_compression_fit *fit) {
    int rate = (int)fit->model.form.rate, rule = (int)fit->model.form.rule;
    SF_HTML_BLOCK(out, "Choice of the law");
    sf_html_paragraph(out, "Rate dependence: %s.", sf_table_rate_words(fit));
    if (!put_candidates(out, fit->rate, SF_RATE_MODELS, rate, rates) && !fit->data.config->thermal)
        sf_html_paragraph(out, fit->data.config->test_count > 1 ? "It was prescribed."
                                                                : "One test says nothing about it.");
    sf_html_paragraph(out, "Densification from the strain %.4g on: %s.", fit->data.start,
                      sf_table_rules[rule]);
    if (!put_candidates(out, fit->rule, SF_RULES, rule, sf_table_rules))
        sf_html_paragraph(out, "It was prescribed.");
    sf_html_note(out, "BIC = n ln(chi2/n) + p ln n; a form that is 10 above the lowest has the data clearly "
                      "against it, one within 2 is as good.");
}

static void put_quality(FILE *out, const sf_table_result *r) {
    const sf_compression_fit *fit = &r->fit;
    char misfit[160];
    SF_HTML_BLOCK(out, "How good it is");
    SF_HTML_TABLE table = sf_html_table_begin(out, NULL);
    sf_html_fact(&table, "scatter",
                 "%.3g kPa and %.3g %% of the stress, of the data about a free smooth curve",
                 1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
    for (int k = 0; k < 2; k++)
        if (fit->side[k].points > 0)
            sf_html_fact(&table, k ? "unloading, given the loading" : "loading", "%s",
                         sf_table_misfit(&fit->side[k], misfit));
    sf_html_fact(
        &table, "neighbours",
        "correlation of their deviations while loading %.3g; its variances are multiplied by %.3g for it",
        fit->side[0].correlation, fit->side[0].serial);
    sf_html_fact(&table, "written card", "in the solver's own law it differs from the fit by at most %.2g %%",
                 r->card_percent);
}

static void put_simulation(FILE *out, const sf_table_result *r) {
    if (!r->simulated)
        return;
    SF_HTML_BLOCK(out, "The simulated test");
    sf_rows_html_table(out, sf_table_simulation_rows,
                       (sf_records){r->test, sizeof r->test[0], r->test_count});
    sf_html_note(out,
                 "A cube of the fitted material between platens (softfall-solve), in a time that runs faster "
                 "with everything that depends on the rate, against the material point of the fit; means "
                 "over blocks of time. Differences in percent of the stress, counted as a hundredth of the "
                 "largest at least. simulation.csv holds the curves.");
}

static void put_limits(FILE *out, const sf_compression_fit *fit) {
    const sf_compression_config *c = fit->data.config;
    const sf_estimate *e = fit->estimate;
    double fastest = c->test[c->test_count - 1].rate;
    SF_HTML_BLOCK(out, "Extrapolation");
    sf_html_paragraph(out,
                      "Strains beyond %.4g: the densification law extrapolates the last part of the data. "
                      "Compare max_local_strain of a drop.",
                      fit->data.end);
    if (fit->model.form.rate == SF_RATE_MAXWELL)
        sf_html_paragraph(out,
                          "Rates beyond %.3g 1/s: a drop is faster by orders of magnitude, there the branch "
                          "is a spring of ED = %.4g kPa.",
                          fastest, 1e-3 * e[SF_ESTIMATE_ED].value);
    else if (fit->rate_count > 1 && !c->thermal)
        sf_html_paragraph(out,
                          "Rates beyond %.3g 1/s: the solver holds the fastest curve; a drop is faster by "
                          "orders of magnitude, and the foam may be stiffer there.",
                          fastest);
    else
        sf_html_paragraph(
            out, "Rates other than those of the tests (to %.3g 1/s): the law has no rate effect.", fastest);
    sf_html_paragraph(out,
                      "Unloading faster than in the tests, and reloading: the law unloads on %s, and its "
                      "hysteresis does not depend on the %s.",
                      c->thermal ? "the curve of the pad's temperature" : "the slowest curve",
                      c->thermal ? "rate or the temperature" : "rate");
    sf_html_paragraph(out, "Tension: it takes the modulus E, which compression does not show.");
    sf_html_paragraph(out, "DAMP is not identified; it is written as given.");
    if (!isfinite(e[SF_ESTIMATE_HU].error))
        sf_html_paragraph(out, "HU = %.4g and SHAPE = %.4g: %s.", e[SF_ESTIMATE_HU].value,
                          e[SF_ESTIMATE_SHAPE].value, e[SF_ESTIMATE_HU].note);
}

sf_status sf_table_report_write(const sf_study *study, const sf_table_result *r, char *warning, size_t size,
                                sf_error *err) {
    const sf_compression_fit *fit = &r->fit;
    const sf_staging *output = &study->output;
    SF_TRY(write_picture(output, fit, warning, size, err));
    SF_PRINTED(title, 256, "%s: identification from compression tests", fit->data.config->name);
    FILE *out = sf_html_begin(output, title, study->input, err);
    SF_TRY(err->status);
    put_banner(out, fit);
    sf_chart_figure(out, output, "fit", "softfall-fit",
                    "Data (points) and fit (lines), and the deviations over the scatter (band: ±2)");
    put_parameters(out, fit);
    put_tests(out, r);
    put_quality(out, r);
    put_choice(out, fit);
    put_simulation(out, r);
    put_limits(out, fit);
    return sf_html_end(out, study->command, "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")",
                       err);
}
