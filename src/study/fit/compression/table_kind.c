/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the tables, a spline with rate terms and a densification law: its files and words,
 * report.html, and fit.png with data against fit over the whole range and at the foot, deviations below. */
#include "study/fit/compression/compression_kind.h"
#include "study/fit/compression/table_result.h"

#include "build_info.h"
#include "io/folder.h"
#include "material/low_density_foam.h"
#include "report/chart.h"
#include "report/html.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the picture ---- */

/* Light to dark with the rate: points, lines. */
static const char *const POINT[SF_COMPRESSION_TESTS] = {"#9ecae1", "#fdae6b", "#a1d99b", "#bcbddc",
                                                        "#fa9fb5", "#bdbdbd", "#d8b365", "#80cdc1"};
static const char *const LINE[SF_COMPRESSION_TESTS] = {"#08519c", "#a63603", "#006d2c", "#54278f",
                                                       "#7a0177", "#252525", "#8c510a", "#01665e"};

static sf_panel *new_panel(sf_chart *chart, const char *title, double left, double right, double bottom,
                           double top) {
    const double area[4] = {left, right, bottom, top};
    sf_panel *panel = sf_chart_panel(chart);
    if (!panel)
        return NULL;
    snprintf(panel->title, sizeof panel->title, "%s", title);
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "compressive strain");
    panel->x.step = 0.1;
    sf_axis_label(&panel->y, "nominal stress (kPa)");
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
        sf_series_data *line = titles
                                   ? sf_chart_series(chart, style, "fit at %.3g 1/s", d->config->test[k].rate)
                                   : sf_chart_series(chart, style, NULL);
        for (int i = 0; i < d->count; i++)
            if (d->test[i] == k)
                sf_series_point(line, d->strain[i], 1e-3 * fit->stress[i]);
    }
}

/* Returns the stress up to which the panel of the foot reaches: that of the loading curve at half the largest
 * strain, kPa. */
static double foot_stress(const sf_compression_fit *fit) {
    int k = 0, last = fit->rate_count - 1;
    while (k + 1 < fit->table_count && fit->table_strain[k] < 0.5 * fit->data.end)
        k++;
    return 1.3e-3 * fit->table_stress[last][k];
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
            sf_series_data *points = k == 0 ? sf_chart_series(chart, style, side ? "unloading" : "loading")
                                            : sf_chart_series(chart, style, NULL);
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
    if (whole) {
        sf_axis_range(&whole->x, 0, 1.02 * end);
        sf_axis_range(&whole->y, 0, NAN);
        whole->key = SF_KEY_TOP_LEFT;
        put_curves(chart, fit, true);
    }
    sf_panel *foot = new_panel(chart, "foot and plateau", 0.58, 0.98, 0.47, 0.9);
    if (foot) {
        sf_axis_range(&foot->x, 0, 0.6 * end);
        sf_axis_range(&foot->y, 0, foot_stress(fit));
        put_curves(chart, fit, false);
    }
    sf_panel *below = new_panel(
        chart, "Deviation of the data from the fit, over the standard deviation of the scatter (band: ±2)",
        0.08, 0.98, 0.07, 0.34);
    if (below) {
        sf_axis_range(&below->x, 0, 1.02 * end);
        put_deviations(chart, below, fit);
    }
    sf_chart_write(chart, output, warning, size, err);
    sf_chart_free(chart);
    return err->status;
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
    sf_rows_html_table(out, "dense", sf_table_test_rows(),
                       (sf_records){r->test, sizeof r->test[0], r->test_count});
    sf_html_note(
        out, "Deviation: root mean square of data less fit, over the scatter (1: nothing but scatter) and in "
             "percent of the stress (counted as a hundredth of the largest at least).");
    for (int k = 0; k < r->test_count; k++)
        sf_html_note(out, "Read from %s: %s", r->test[k].path, r->test[k].interpretation);
}

static void put_parameters(FILE *out, const sf_compression_fit *fit) {
    char interval[32];
    sf_table_estimate list[SF_ESTIMATES];
    int count = 0;
    snprintf(interval, sizeof interval, "%g %% interval", 100 * fit->data.config->confidence);
    const sf_row rows[] = {{.name = "parameter", SF_ROW_OF(STRING, sf_table_estimate, name)},
                           {.name = "value", SF_ROW_OF(TEXT, sf_table_estimate, value)},
                           {.name = "standard error", SF_ROW_OF(TEXT, sf_table_estimate, error)},
                           {.name = interval, SF_ROW_OF(TEXT, sf_table_estimate, interval)},
                           {.name = "note", SF_ROW_OF(STRING, sf_table_estimate, note)}};
    for (int k = 0; k < SF_ESTIMATES; k++)
        if (fit->estimate[k].present)
            list[count++] = sf_table_estimate_of(fit, k);
    sf_html_block_begin(out);
    sf_html_heading(out, "Parameters");
    sf_rows_html_table(out, "dense", SF_ROWS(rows), (sf_records){list, sizeof list[0], count});
    sf_html_note(
        out,
        "E is the slope of a straight line through the loading of the slowest test below a strain of %g; "
        "where the curve bends within that range the slope at rest is steeper. The loading curve with its "
        "interval is in loading_curve.csv.",
        fit->data.config->modulus_range);
    sf_html_block_end(out);
}

/* A table of the forms that were tried; false: none was. */
static bool put_candidates(FILE *out, const sf_candidate *c, int count, int chosen,
                           const char *(*phrase)(int)) {
    static const sf_row rows[] = {
        {.name = "form", SF_ROW_OF(STRING, sf_table_candidate, phrase)},
        {.name = "parameters", SF_ROW_OF(INTEGER, sf_table_candidate, parameters)},
        {.name = "chi2", .format = "%.6g", SF_ROW_OF(NUMBER, sf_table_candidate, chi2)},
        {.name = "BIC above the lowest", .format = "%.1f", SF_ROW_OF(NUMBER, sf_table_candidate, above)},
        {.name = "choice", SF_ROW_OF(STRING, sf_table_candidate, chosen)}};
    sf_table_candidate list[SF_RATE_MODELS + SF_RULES];
    double lowest = INFINITY;
    int used = 0;
    for (int k = 0; k < count; k++)
        lowest = c[k].tried ? fmin(lowest, c[k].bic) : lowest;
    for (int k = 0; k < count; k++)
        if (c[k].tried)
            list[used++] = (sf_table_candidate){phrase(k), c[k].parameters, c[k].chi2, c[k].bic - lowest,
                                                k == chosen ? "chosen" : NULL};
    if (used > 0)
        sf_rows_html_table(out, "dense", SF_ROWS(rows), (sf_records){list, sizeof list[0], used});
    return used > 0;
}

static const char *rate_phrase(int k) {
    return sf_table_rate_phrase((sf_rate_model)k);
}

static const char *rule_phrase(int k) {
    return sf_table_rule_phrase((sf_rule)k);
}

static void put_choice(FILE *out, const sf_compression_fit *fit) {
    int rate = (int)fit->model.form.rate, rule = (int)fit->model.form.rule;
    sf_html_block_begin(out);
    sf_html_heading(out, "Choice of the law");
    sf_html_paragraph(out, "Rate dependence: %s.", rate_phrase(rate));
    if (!put_candidates(out, fit->rate, SF_RATE_MODELS, rate, rate_phrase))
        sf_html_paragraph(out, fit->data.config->test_count > 1 ? "It was prescribed."
                                                                : "One test says nothing about it.");
    sf_html_paragraph(out, "Densification from the strain %.4g on: %s.", fit->data.start, rule_phrase(rule));
    if (!put_candidates(out, fit->rule, SF_RULES, rule, rule_phrase))
        sf_html_paragraph(out, "It was prescribed.");
    sf_html_note(
        out, "BIC = n ln(chi2/n) + p ln n; a form that is 10 above the lowest has the data clearly against "
             "it, one within 2 is as good.");
    sf_html_block_end(out);
}

static void put_quality(FILE *out, const sf_table_result *r) {
    const sf_compression_fit *fit = &r->fit;
    sf_html_block_begin(out);
    sf_html_heading(out, "How good it is");
    sf_html_table table = sf_html_table_begin(out, "dense", NULL);
    sf_html_fact(&table, "scatter",
                 "%.3g kPa and %.3g %% of the stress, of the data about a free smooth curve",
                 1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
    for (int k = 0; k < 2; k++)
        if (fit->side[k].points > 0)
            sf_html_fact(&table, k ? "unloading, given the loading" : "loading",
                         "rms deviation %.3g %% of the stress, %.3g %% of the largest; misfit (1 is scatter "
                         "alone) %.3g",
                         100 * fit->side[k].relative, 100 * fit->side[k].of_largest, fit->side[k].misfit);
    sf_html_fact(
        &table, "neighbours",
        "correlation of their deviations while loading %.3g; its variances are multiplied by %.3g for it",
        fit->side[0].correlation, fit->side[0].serial);
    sf_html_fact(&table, "written card", "in the solver's own law it differs from the fit by at most %.2g %%",
                 r->card_percent);
    sf_html_table_end(&table);
    sf_html_block_end(out);
}

static void put_picture(FILE *out, const sf_staging *output) {
    char warning[320];
    char *svg = sf_chart_svg(output, "fit", "softfall-fit", warning, sizeof warning);
    if (svg)
        sf_html_figure(out, svg,
                       "Data (points) and fit (lines), and the deviations over the scatter (band: ±2).");
    else
        sf_html_figure(out, NULL, "%s.", warning);
    free(svg);
}

static void put_simulation(FILE *out, const sf_table_result *r) {
    if (!r->simulated)
        return;
    sf_html_block_begin(out);
    sf_html_heading(out, "The simulated test");
    sf_rows_html_table(out, "dense", sf_table_simulation_rows(),
                       (sf_records){r->test, sizeof r->test[0], r->test_count});
    sf_html_note(
        out,
        "A cube of the fitted material between platens (softfall-solve), in a time that runs faster with "
        "everything that depends on the rate, against the material point of the fit; means over blocks "
        "of time. Differences in percent of the stress, counted as a hundredth of the largest at least. "
        "simulation.csv holds the curves.");
    sf_html_block_end(out);
}

static void put_limits(FILE *out, const sf_compression_fit *fit) {
    const sf_compression_config *c = fit->data.config;
    const sf_estimate *e = fit->estimate;
    double fastest = c->test[c->test_count - 1].rate;
    sf_html_block_begin(out);
    sf_html_heading(out, "Extrapolation");
    sf_html_paragraph(
        out,
        "Strains beyond %.4g: the densification law extrapolates the last part of the data. Compare "
        "max_local_strain of a drop.",
        fit->data.end);
    if (fit->model.form.rate == SF_RATE_MAXWELL)
        sf_html_paragraph(
            out,
            "Rates beyond %.3g 1/s: a drop is faster by orders of magnitude, there the branch is a "
            "spring of ED = %.4g kPa.",
            fastest, 1e-3 * e[SF_ESTIMATE_ED].value);
    else if (fit->rate_count > 1)
        sf_html_paragraph(
            out,
            "Rates beyond %.3g 1/s: the solver holds the fastest curve; a drop is faster by orders of "
            "magnitude, and the foam may be stiffer there.",
            fastest);
    else
        sf_html_paragraph(
            out, "Rates other than those of the tests (to %.3g 1/s): the law has no rate effect.", fastest);
    sf_html_paragraph(
        out,
        "Unloading faster than in the tests, and reloading: the law unloads on the slowest curve, and its "
        "hysteresis does not depend on the rate.");
    sf_html_paragraph(out, "Tension: it takes the modulus E, which compression does not show.");
    sf_html_paragraph(out, "DAMP is not identified; it is written as given.");
    if (!isfinite(e[SF_ESTIMATE_HU].error))
        sf_html_paragraph(out, "HU = %.4g and SHAPE = %.4g: %s.", e[SF_ESTIMATE_HU].value,
                          e[SF_ESTIMATE_SHAPE].value, e[SF_ESTIMATE_HU].note);
    sf_html_block_end(out);
}

static sf_status write_report(const sf_staging *output, const sf_table_result *r, const char *path,
                              const char *command, char *warning, size_t size, sf_error *err) {
    const sf_compression_fit *fit = &r->fit;
    char title[256];
    SF_TRY(write_picture(output, fit, warning, size, err));
    snprintf(title, sizeof title, "%s: identification from compression tests", fit->data.config->name);
    FILE *out = sf_html_begin(output, title, path, err);
    if (!out)
        return err->status;
    put_banner(out, fit);
    put_picture(out, output);
    put_parameters(out, fit);
    put_tests(out, r);
    put_quality(out, r);
    put_choice(out, fit);
    put_simulation(out, r);
    put_limits(out, fit);
    sf_html_heading(out, "The command that repeats this report");
    sf_html_pre(out, command);
    return sf_html_end(out, "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

/* ---- the entry ---- */

static const char *const outputs[] = {"simulation.csv", "fit.csv",        "loading_curve.csv",
                                      "fit.gp",         "fit.png",        "fit.json",
                                      "report.html",    "material.csv",   "material-1.csv",
                                      "material-2.csv", "material-3.csv", "material-4.csv",
                                      "material-5.csv", "material-6.csv", "material-7.csv",
                                      "material-8.csv", "material.cfg",   NULL};

static sf_material material_of(const void *place) {
    static _Thread_local sf_foam_card informed; /* its curves stay the card's */
    const sf_table_result *r = place;
    informed = r->card;
    informed.informed_strain = r->fit.data.end;
    return sf_foam_material(&informed);
}

static sf_status run(const sf_compression_config *config, void *result, sf_error *err) {
    return sf_table_result_make(config, result, err);
}

static void release(void *result) {
    sf_table_result_free(result);
}

/* ---- words ---- */

static void title(FILE *out, const void *place) {
    const sf_compression_fit *fit = &((const sf_table_result *)place)->fit;
    const sf_compression_config *c = fit->data.config;
    fprintf(out, "%s: %d test%s, %d points, strain to %.4g\n", c->name, c->test_count,
            c->test_count > 1 ? "s" : "", fit->data.count, fit->data.end);
}

static void put_estimates(FILE *out, const sf_compression_fit *fit) {
    for (int k = 0; k < SF_ESTIMATES; k++) {
        sf_table_estimate e = sf_table_estimate_of(fit, k);
        if (!fit->estimate[k].present)
            continue;
        fprintf(out, "  %-12s %-12s", e.name, e.value);
        if (*e.interval)
            fprintf(out, " %g %% interval %s", 100 * fit->data.config->confidence, e.interval);
        fprintf(out, "%s%s\n", *e.note ? "  " : "", e.note);
    }
}

static void put_misfits(FILE *out, const sf_compression_fit *fit) {
    static const char *const sides[2] = {"loading", "unloading, given the loading"};
    for (int k = 0; k < 2; k++)
        if (fit->side[k].points > 0)
            fprintf(out,
                    "  %s: rms deviation %.3g %% of the stress, %.3g %% of the largest; misfit (1 is scatter "
                    "alone) %.3g\n",
                    sides[k], 100 * fit->side[k].relative, 100 * fit->side[k].of_largest,
                    fit->side[k].misfit);
}

static void describe(FILE *out, const void *place, bool comments) {
    const sf_table_result *r = place;
    const sf_compression_fit *fit = &r->fit;
    const char *rate = sf_table_rate_phrase(fit->model.form.rate),
               *rule = sf_table_rule_phrase(fit->model.form.rule);
    if (!comments) {
        fprintf(out, "  rate dependence  %s\n  densification    %s, from strain %.4g\n", rate, rule,
                fit->data.start);
        put_estimates(out, fit);
        fprintf(out, "  scatter of the data: %.3g kPa and %.3g %% of the stress\n",
                1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
        put_misfits(out, fit);
        fprintf(out, "  card in the solver's law against the fit: largest difference %.2g %%\n",
                r->card_percent);
        return;
    }
    fputs(" from\n", out);
    for (int k = 0; k < r->test_count; k++)
        fprintf(out, "  %s at %.6g 1/s, to a strain of %.4g\n", r->test[k].path, r->test[k].rate,
                r->test[k].largest_strain);
    fprintf(out, "Rate dependence %s.\nDensification from the strain %.4g on by %s.\n", rate, fit->data.start,
            rule);
    put_estimates(out, fit);
    fprintf(out, "Beyond the strain %.4g and outside these rates it is extrapolation.\n", fit->data.end);
}

static void warn(const void *place, const sf_sink *sink) {
    const sf_compression_fit *fit = &((const sf_table_result *)place)->fit;
    static const char *const sides[2] = {"loading", "unloading"};
    for (int k = 0; k < 2; k++)
        if (fit->side[k].points > 0 && fit->side[k].misfit > 2)
            sf_sink_tell(
                sink, SF_WARNING,
                "the law misses the %s by %.3g times its scatter (fit.png, lower panel), %.3g %% of the "
                "largest stress; the intervals are widened by as much",
                sides[k], sqrt(fit->side[k].misfit), 100 * fit->side[k].of_largest);
}

/* ---- files ---- */

static void put_points(FILE *file, const void *place) {
    const sf_compression_fit *fit = &((const sf_table_result *)place)->fit;
    const sf_compression_data *d = &fit->data;
    fputs("test,branch,strain,measured_kPa,fit_kPa,sigma_kPa,deviation_over_sigma\n", file);
    for (int i = 0; i < d->count; i++)
        fprintf(file, "%d,%s,%.9g,%.9g,%.9g,%.9g,%.6g\n", d->test[i] + 1,
                d->unloading[i] ? "unloading" : "loading", d->strain[i], 1e-3 * d->stress[i],
                1e-3 * fit->stress[i], 1e-3 * d->sigma[i], (d->stress[i] - fit->stress[i]) / d->sigma[i]);
}

static sf_status write_curves(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    FILE *file = sf_staging_open(output, "loading_curve.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "# Loading curves of the fit with their %g %% intervals; rate 0: one curve for all rates\n",
            100 * fit->data.config->confidence);
    fputs("rate_1_s,strain,stress_kPa,low_kPa,high_kPa\n", file);
    for (int r = 0; r < fit->rate_count; r++)
        for (int k = 0; k < fit->table_count; k++) {
            double stress = fit->table_stress[r][k], width = fit->quantile * fit->table_error[r][k];
            fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g\n",
                    fit->rate_count > 1 ? fit->data.config->test[r].rate : 0, fit->table_strain[k],
                    1e-3 * stress, 1e-3 * fmax(0, stress - width), 1e-3 * (stress + width));
        }
    return sf_staging_close(file, "loading_curve.csv", err);
}

/* Simulates the tests in DIR/simulation, which stays, and writes the curves. */
static sf_status write_simulation(const sf_compression_job *job, const sf_staging *output, sf_table_result *r,
                                  sf_error *err) {
    char folder[PATH_MAX];
    if (!job->cube.case_path)
        return SF_OK;
    r->cube = sf_alloc(err, SF_COMPRESSION_TESTS, sizeof *r->cube, "the simulated tests");
    snprintf(folder, sizeof folder, "%s/simulation", output->directory);
    if (!r->cube || sf_folder_own(folder, err) != SF_OK ||
        sf_compression_simulate(&r->fit, &r->card, &job->cube, folder, r->cube, err) != SF_OK)
        return err->status;
    r->simulated = true;
    FILE *file = sf_staging_open(output, "simulation.csv", err);
    if (!file)
        return err->status;
    fputs("test,strain,cube_kPa,point_kPa\n", file);
    for (int k = 0; k < r->test_count; k++) {
        const sf_cube_test *cube = &r->cube[k];
        r->test[k].speed_up = cube->speed_up;
        memcpy(r->test[k].difference, cube->percent, sizeof cube->percent);
        r->test[k].energy_error = cube->energy_error;
        for (int i = 0; i < cube->count; i++)
            fprintf(file, "%d,%.9g,%.9g,%.9g\n", k + 1, cube->strain[i], 1e-3 * cube->cube[i],
                    1e-3 * cube->point[i]);
    }
    return sf_staging_close(file, "simulation.csv", err);
}

static sf_status write_more(const sf_compression_job *job, const sf_staging *output, void *place,
                            char *warning, size_t size, sf_error *err) {
    sf_table_result *r = place;
    SF_TRY(write_curves(output, &r->fit, err));
    SF_TRY(write_simulation(job, output, r, err));
    return write_report(output, r, job->path, job->command, warning, size, err);
}

/* ---- fit.json ---- */

static void json_candidate(sf_json *json, const char *name, const sf_candidate *c) {
    static const sf_row rows[] = {
        {.key = "parameters", SF_ROW_OF(INTEGER, sf_candidate, parameters)},
        {.key = "chi2", SF_ROW_OF(NUMBER, sf_candidate, chi2)},
        {.key = "bic", SF_ROW_OF(NUMBER, sf_candidate, bic)},
    };
    if (!c->tried)
        return;
    sf_json_open(json, name, '{');
    sf_rows_json(json, SF_ROWS(rows), c);
    sf_json_close(json, '}');
}

static void json_choice(sf_json *json, const sf_compression_fit *fit) {
    static const char *const rules[SF_RULES] = {"H1_automatic", "H1_free", "H2"};
    sf_json_text(json, "rate_model", sf_rate_model_name(fit->model.form.rate));
    sf_json_open(json, "rate_models_tried", '{');
    for (int k = 0; k < SF_RATE_MODELS; k++)
        json_candidate(json, sf_rate_model_name((sf_rate_model)k), &fit->rate[k]);
    sf_json_close(json, '}');
    sf_json_text(json, "densification", rules[fit->model.form.rule]);
    sf_json_open(json, "densifications_tried", '{');
    for (int k = 0; k < SF_RULES; k++)
        json_candidate(json, rules[k], &fit->rule[k]);
    sf_json_close(json, '}');
    sf_json_number(json, "densification_start", fit->data.start);
}

static void json_estimates(sf_json *json, const sf_compression_fit *fit) {
    static const char *const names[SF_ESTIMATES] = {"E_Pa",  "HU",        "SHAPE",    "ALPHA", "log_rate_c",
                                                    "ED_Pa", "BETA1_1_s", "exponent", "limit"};
    static const sf_row rows[] = {
        {.key = "value", SF_ROW_OF(NUMBER, sf_estimate, value)},
        {.key = "standard_error", SF_ROW_OF(NUMBER, sf_estimate, error)},
        {.key = "low", SF_ROW_OF(NUMBER, sf_estimate, low)},
        {.key = "high", SF_ROW_OF(NUMBER, sf_estimate, high)},
        {.key = "note", SF_ROW_OF(STRING, sf_estimate, note)},
    };
    sf_json_open(json, "parameters", '{');
    for (int k = 0; k < SF_ESTIMATES; k++) {
        if (!fit->estimate[k].present)
            continue;
        sf_json_open(json, names[k], '{');
        sf_rows_json(json, SF_ROWS(rows), &fit->estimate[k]);
        sf_json_close(json, '}');
    }
    sf_json_close(json, '}');
}

static sf_value confidence_of(const void *record) {
    return sf_value_real(((const sf_table_result *)record)->fit.data.config->confidence);
}

static sf_value coefficients_of(const void *record) {
    return sf_value_integer((int64_t)((const sf_table_result *)record)->fit.model.spline.count - 1);
}

/* NaN, which JSON shows as null, without any unloading. */
static double of_unloading(const void *record, double value) {
    return ((const sf_table_result *)record)->fit.side[1].points > 0 ? value : NAN;
}

static sf_value unloading_misfit(const void *record) {
    return sf_value_real(of_unloading(record, ((const sf_table_result *)record)->fit.side[1].misfit));
}

static sf_value unloading_rms(const void *record) {
    return sf_value_real(of_unloading(record, ((const sf_table_result *)record)->fit.side[1].of_largest));
}

static const sf_row quality_rows[] = {
    {.key = "confidence", .value = confidence_of},
    {.key = "points", SF_ROW_OF(INTEGER, sf_table_result, fit.data.count)},
    {.key = "fitted_parameters", SF_ROW_OF(INTEGER, sf_table_result, fit.model.parameter_count)},
    {.key = "spline_coefficients", .value = coefficients_of},
    {.key = "scatter_absolute_Pa", SF_ROW_OF(NUMBER, sf_table_result, fit.data.scatter.absolute)},
    {.key = "scatter_relative", SF_ROW_OF(NUMBER, sf_table_result, fit.data.scatter.relative)},
    {.key = "chi2", SF_ROW_OF(NUMBER, sf_table_result, fit.chi2)},
    {.key = "misfit", SF_ROW_OF(NUMBER, sf_table_result, fit.misfit)},
    {.key = "misfit_loading", SF_ROW_OF(NUMBER, sf_table_result, fit.side[0].misfit)},
    {.key = "misfit_unloading", .value = unloading_misfit},
    {.key = "loading_rms_of_largest", SF_ROW_OF(NUMBER, sf_table_result, fit.side[0].of_largest)},
    {.key = "unloading_rms_of_largest", .value = unloading_rms},
    {.key = "neighbour_correlation", SF_ROW_OF(NUMBER, sf_table_result, fit.side[0].correlation)},
    {.key = "variance_factor_for_correlation", SF_ROW_OF(NUMBER, sf_table_result, fit.side[0].serial)},
    {.key = "card_difference_percent", SF_ROW_OF(NUMBER, sf_table_result, card_percent)},
};

static void put_json(sf_json *json, const void *place, const char *path) {
    const sf_table_result *r = place;
    sf_json_text(json, "program", "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")");
    sf_json_text(json, "input", path);
    sf_json_text(json, "name", r->fit.data.config->name);
    sf_rows_json_array(json, "tests", sf_table_test_rows(),
                       (sf_records){r->test, sizeof r->test[0], r->test_count});
    json_choice(json, &r->fit);
    json_estimates(json, &r->fit);
    sf_rows_json(json, SF_ROWS(quality_rows), r);
    sf_rows_json_array(json, "simulation", sf_table_simulation_rows(),
                       (sf_records){r->test, sizeof r->test[0], r->simulated ? r->test_count : 0});
}

const sf_compression_kind sf_compression_tables = {
    .files = "material.cfg and its curves, report.html, fit.png, fit.json, fit.csv, loading_curve.csv",
    .outputs = outputs,
    .size = sizeof(sf_table_result),
    .run = run,
    .free = release,
    .material = material_of,
    .title = title,
    .describe = describe,
    .points = put_points,
    .json = put_json,
    .more = write_more,
    .warn = warn};
