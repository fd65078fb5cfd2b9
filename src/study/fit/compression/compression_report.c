/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.html */
#include "study/fit/compression/compression_report.h"

#include "build_info.h"
#include "study/fit/compression/phrase.h"
#include "report/chart.h"
#include "report/html.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put_number(sf_html_table *table, const char *format, double value) {
    char text[48];
    snprintf(text, sizeof text, format, value);
    sf_html_cell(table, "%s", isfinite(value) ? text : "–");
}

/* The banner: does the law leave nothing but scatter? */
static void put_banner(FILE *out, const sf_compression_fit *fit) {
    bool misses = fit->misfit > 2;
    sf_html_banner(
        out, misses ? "fair" : "good", misses ? "the law misses the data" : "the law fits the data",
        "Misfit chi2/(n - p) = %.3g with n = %d points and p = %d parameters (%d coefficients for each "
        "loading curve). 1: the law leaves nothing but scatter; above it the law misses the data, and the "
        "standard errors are widened by its root.",
        fit->misfit, fit->data.count, fit->model.parameter_count, fit->model.spline.count - 1);
}

static void put_tests(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    const sf_compression_config *c = fit->data.config;
    sf_html_heading(out, "Tests");
    if (c->specimen.area > 0 && c->specimen.thickness > 0)
        sf_html_paragraph(out, "Specimen of %.5g mm², %.4g mm thick, %.4g kg/m³.", 1e6 * c->specimen.area,
                          1e3 * c->specimen.thickness, c->density);
    sf_html_table table = sf_html_table_begin(
        out, "dense",
        "file|>rate (1/s)|>points, loading + unloading|>largest strain|>largest stress (kPa)|>deviation / scatter, "
        "loading|>unloading|>deviation, loading (%)|>unloading (%)");
    for (int k = 0; k < c->test_count; k++) {
        const sf_compression_test *t = &c->test[k];
        const double *numbers[2] = {check->rms[k], check->percent[k]};
        const char *slash = strrchr(t->path, '/');
        sf_html_row(&table);
        sf_html_cell(&table, "%s", slash ? slash + 1 : t->path);
        sf_html_cell(&table, "%.4g", t->rate);
        sf_html_cell(&table, "%d + %d", t->loading, t->count - t->loading);
        sf_html_cell(&table, "%.4g", t->largest_strain);
        sf_html_cell(&table, "%.4g", 1e-3 * t->largest_stress);
        for (int n = 0; n < 2; n++)
            for (int side = 0; side < 2; side++)
                put_number(&table, "%.3g", numbers[n][side]);
    }
    sf_html_table_end(&table);
    sf_html_note(
        out, "Deviation: root mean square of data less fit, over the scatter (1: nothing but scatter) and in "
             "percent of the stress (counted as a hundredth of the largest at least).");
    for (int k = 0; k < c->test_count; k++)
        sf_html_note(out, "Read from %s: %s", c->test[k].path, c->test[k].interpretation);
}

static void put_parameters(FILE *out, const sf_compression_fit *fit) {
    char columns[96];
    snprintf(columns, sizeof columns, "parameter|>value|>standard error|>%g %% interval|note",
             100 * fit->data.config->confidence);
    sf_html_block_begin(out);
    sf_html_heading(out, "Parameters");
    sf_html_table table = sf_html_table_begin(out, "dense", columns);
    for (int k = 0; k < SF_ESTIMATES; k++) {
        const sf_estimate *e = &fit->estimate[k];
        char value[64], error[64], low[64], high[64];
        if (!e->present)
            continue;
        sf_compression_text(e, e->value, value, sizeof value);
        sf_compression_text(e, e->error, error, sizeof error);
        sf_compression_text(e, e->low, low, sizeof low);
        sf_compression_text(e, e->high, high, sizeof high);
        sf_html_row(&table);
        sf_html_cell(&table, "%s", e->name);
        sf_html_cell(&table, "%s", value);
        sf_html_cell(&table, "%s", error);
        if (isfinite(e->low))
            sf_html_cell(&table, "%s to %s", low, high);
        else
            sf_html_cell(&table, "–");
        sf_html_cell(&table, "%s", e->note);
    }
    sf_html_table_end(&table);
    sf_html_note(
        out,
        "E is the slope of a straight line through the loading of the slowest test below a strain of %g; "
        "where the curve bends within that range the slope at rest is steeper. The loading curve with its "
        "interval is in loading_curve.csv.",
        fit->data.config->modulus_range);
    sf_html_block_end(out);
}

static void put_row(sf_html_table *table, const char *phrase, const sf_candidate *c, double lowest,
                    bool chosen) {
    if (!c->tried)
        return;
    sf_html_row(table);
    sf_html_cell(table, "%s", phrase);
    sf_html_cell(table, "%d", c->parameters);
    sf_html_cell(table, "%.6g", c->chi2);
    sf_html_cell(table, "%.1f", c->bic - lowest);
    sf_html_cell(table, "%s", chosen ? "chosen" : "");
}

static double lowest_bic(const sf_candidate *c, int count) {
    double lowest = INFINITY;
    for (int k = 0; k < count; k++)
        lowest = c[k].tried ? fmin(lowest, c[k].bic) : lowest;
    return lowest;
}

static const char choice_columns[] = "form|>parameters|>chi2|>BIC above the lowest|";

static void put_rate_choice(FILE *out, const sf_compression_fit *fit) {
    double lowest = lowest_bic(fit->rate, SF_RATE_MODELS);
    sf_html_paragraph(out, "Rate dependence: %s.%s", sf_compression_rate_phrase(fit->model.form.rate),
                      isfinite(lowest)                   ? ""
                      : fit->data.config->test_count > 1 ? " It was prescribed."
                                                         : " One test says nothing about it.");
    if (!isfinite(lowest))
        return;
    sf_html_table table = sf_html_table_begin(out, "dense", choice_columns);
    for (int k = 0; k < SF_RATE_MODELS; k++)
        put_row(&table, sf_compression_rate_phrase((sf_rate_model)k), &fit->rate[k], lowest,
                k == (int)fit->model.form.rate);
    sf_html_table_end(&table);
}

static void put_rule_choice(FILE *out, const sf_compression_fit *fit) {
    double lowest = lowest_bic(fit->rule, SF_RULES);
    sf_html_paragraph(out, "Densification from the strain %.4g on: %s.%s", fit->data.start,
                      sf_compression_rule_phrase(fit->model.form.rule),
                      isfinite(lowest) ? "" : " It was prescribed.");
    if (!isfinite(lowest))
        return;
    sf_html_table table = sf_html_table_begin(out, "dense", choice_columns);
    for (int k = 0; k < SF_RULES; k++)
        put_row(&table, sf_compression_rule_phrase((sf_rule)k), &fit->rule[k], lowest,
                k == (int)fit->model.form.rule);
    sf_html_table_end(&table);
}

static void put_choice(FILE *out, const sf_compression_fit *fit) {
    sf_html_block_begin(out);
    sf_html_heading(out, "Choice of the law");
    put_rate_choice(out, fit);
    put_rule_choice(out, fit);
    sf_html_note(
        out, "BIC = n ln(chi2/n) + p ln n; a form that is 10 above the lowest has the data clearly against "
             "it, one within 2 is as good.");
    sf_html_block_end(out);
}

static void put_quality(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    sf_html_block_begin(out);
    sf_html_heading(out, "How good it is");
    sf_html_table table = sf_html_table_begin(out, "dense", NULL);
    sf_html_fact(&table, "scatter",
                 "%.3g kPa and %.3g %% of the stress, of the data about a free smooth curve",
                 1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
    sf_html_fact(&table, "neighbours",
                 "correlation of their deviations %.3g; the variances are multiplied by %.3g for it",
                 fit->correlation, fit->serial);
    sf_html_fact(&table, "written card", "in the solver's own law it differs from the fit by at most %.2g %%",
                 check->card_percent);
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

static void put_simulation(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    if (!check->simulated)
        return;
    sf_html_block_begin(out);
    sf_html_heading(out, "The simulated test");
    sf_html_table table = sf_html_table_begin(
        out, "dense", ">rate (1/s)|>speed-up|>largest difference, loading (%)|>unloading (%)|>energy error");
    for (int k = 0; k < fit->data.config->test_count; k++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%.4g", fit->data.config->test[k].rate);
        sf_html_cell(&table, "%.4g", check->cube[k].speed_up);
        sf_html_cell(&table, "%.2g", check->cube[k].percent[0]);
        sf_html_cell(&table, "%.2g", check->cube[k].percent[1]);
        sf_html_cell(&table, "%.1g", check->cube[k].energy_error);
    }
    sf_html_table_end(&table);
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

sf_status sf_compression_write_report(const sf_staging *output, const sf_compression_fit *fit,
                                      const sf_compression_check *check, const char *path,
                                      const char *command, sf_error *err) {
    char title[256];
    snprintf(title, sizeof title, "%s: identification from compression tests", fit->data.config->name);
    FILE *out = sf_html_begin(output, title, path, err);
    if (!out)
        return err->status;
    put_banner(out, fit);
    put_picture(out, output);
    put_parameters(out, fit);
    put_tests(out, fit, check);
    put_quality(out, fit, check);
    put_choice(out, fit);
    put_simulation(out, fit, check);
    put_limits(out, fit);
    sf_html_heading(out, "The command that repeats this report");
    sf_html_pre(out, command);
    return sf_html_end(out, "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")", err);
}
