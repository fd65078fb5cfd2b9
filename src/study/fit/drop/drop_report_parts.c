/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include <math.h>

static void put_response(sf_html_table *table, const sf_drop_fit *fit, int d, int kind) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    double measured = drop->value[kind];
    char text[64];
    sf_html_row(table);
    sf_html_cell(table, "%s", drop->name);
    sf_html_cell(table, "%s", sf_report_heading(kind, text, sizeof text));
    sf_html_number(table, about->digits, measured);
    sf_html_number(table, 1, isnan(measured) ? NAN : 100 * drop->sd[kind]);
    sf_html_number(table, about->digits, sf_report_response(fit, d, kind));
    sf_report_put_difference(table, fit->y[fit->row[d] + kind], measured);
    sf_report_put_difference(table, fit->without[fit->row[d] + kind], measured);
}

void sf_report_drops_html(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    if (fit->measured_drops == 0)
        return;
    sf_html_heading(f, "Drops");
    sf_html_note(
        f,
        "The simulation with the identified material against the measurement, as the accelerometer reads "
        "(F/m), CFC 1000. \"From the others\": the same drop left out of the fit and predicted by the rest "
        "(corrected surrogate).");
    sf_html_table table = sf_html_table_begin(
        f, "dense", "drop|quantity|>measured|>± %|>simulated|>difference|>from the others");
    for (int d = 0; d < fit->measured_drops; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_report_shows(fit, d, kind))
                put_response(&table, fit, d, kind);
    sf_html_table_end(&table);
    table = sf_html_table_begin(f, "dense", "drop|>curve RMSE (g)|>largest local strain|verdict");
    for (int d = 0; d < fit->measured_drops; d++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%s", in->drop[d].name);
        sf_html_number(&table, 2, sf_report_curve_rmse(fit, d));
        sf_html_number(&table, 3, fit->simulated[d].max_local_strain);
        sf_html_cell(&table, "%s", sf_verdict_phrase(fit->simulated[d].grade));
    }
    sf_html_table_end(&table);
}

/* Fitted speeds, for drops whose speed is not known exactly. */
void sf_report_speeds_html(FILE *f, const sf_drop_fit *fit) {
    bool any = false;
    for (int d = 0; d < fit->measured_drops; d++)
        any = any || fit->speed[d] >= 0;
    if (!any)
        return;
    sf_html_paragraph(
        f, "The speeds are known with a standard deviation only, and are unknowns of the fit; the table "
           "above is simulated with the given ones.");
    sf_html_table table =
        sf_html_table_begin(f, "dense", "drop|>given (m/s)|>standard deviation (%)|>in the fit (%)|>95 %");
    for (int d = 0; d < fit->measured_drops; d++) {
        int k = fit->speed[d];
        if (k < 0)
            continue;
        double shift = fit->result.u[k],
               width = sf_report_half_width(fit) * sqrt(fit->result.covariance[k][k]);
        sf_html_row(&table);
        sf_html_cell(&table, "%s", fit->input->drop[d].name);
        sf_html_cell(&table, "%.4g", fit->columns[d].speed);
        sf_html_cell(&table, "%.2f", 100 * fit->input->drop[d].speed_sd);
        sf_html_cell(&table, "%+.2f", 100 * expm1(shift));
        sf_html_cell(&table, "%+.2f to %+.2f", 100 * expm1(shift - width), 100 * expm1(shift + width));
    }
    sf_html_table_end(&table);
}

static void put_prediction(sf_html_table *table, const sf_drop_fit *fit, int d, int kind) {
    int digits = sf_drop_kind_get(kind)->digits;
    double value = sf_report_response(fit, d, kind),
           width = sf_report_half_width(fit) * sf_report_response_sd(fit, d, kind);
    char text[64];
    sf_html_row(table);
    sf_html_cell(table, "%s", fit->input->drop[d].name);
    sf_html_cell(table, "%s", sf_report_heading(kind, text, sizeof text));
    sf_html_number(table, digits, value);
    if (isfinite(value * width))
        sf_html_cell(table, "%.*f to %.*f", digits, value * exp(-width), digits, value * exp(width));
    else
        sf_html_cell(table, "–");
    sf_html_number(table, 3, fit->simulated[d].max_local_strain);
    sf_html_cell(table, "%s", sf_verdict_phrase(fit->simulated[d].grade));
}

static bool has_predictions(const sf_fit_input *in) {
    return in->drop_count > 0 && in->drop[in->drop_count - 1].predicted;
}

void sf_report_predictions_html(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    if (!has_predictions(in))
        return;
    sf_html_heading(f, "Predictions by simulation with the written material");
    sf_html_note(
        f,
        "Drops that were not used. The 95 %% intervals are linearised and hold the uncertainty of this model's parameters alone; that of the "
        "discretisation and of the model's form come on top.");
    sf_html_table table =
        sf_html_table_begin(f, "dense", "drop|quantity|>predicted|>95 %|>largest local strain|verdict");
    for (int d = fit->measured_drops; d < in->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_report_shows(fit, d, kind))
                put_prediction(&table, fit, d, kind);
    sf_html_table_end(&table);
    for (int d = fit->measured_drops; d < in->drop_count; d++)
        if (*fit->simulated[d].failure)
            sf_html_banner(f, "bad", "no prediction by simulation", "%s: %s.", in->drop[d].name,
                           fit->simulated[d].failure);
}

static void json_kind(sf_json *j, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const sf_fit_drop *drop = &fit->input->drop[d];
    char key[64];
    snprintf(key, sizeof key, "%s_measured%s", about->stem, about->suffix);
    sf_json_number(j, key, drop->value[kind]);
    snprintf(key, sizeof key, "%s_measured_sd", about->stem);
    sf_json_number(j, key, isnan(drop->value[kind]) ? NAN : drop->sd[kind]);
    snprintf(key, sizeof key, "%s%s", about->stem, about->suffix);
    sf_json_number(j, key, sf_report_response(fit, d, kind));
    snprintf(key, sizeof key, "%s_sd_by_parameters", about->stem);
    sf_json_number(j, key, sf_report_response_sd(fit, d, kind));
    snprintf(key, sizeof key, "%s_from_others%s", about->stem, about->suffix);
    sf_json_number(j, key, exp(fit->without[fit->row[d] + kind]));
}

static void json_drop(sf_json *j, const sf_drop_fit *fit, int d) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    sf_json_open(j, NULL, '{');
    sf_json_text(j, "name", drop->name);
    sf_json_bool(j, "used", !drop->predicted);
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        json_kind(j, fit, d, kind);
    sf_json_number(j, "curve_rmse_g", sf_report_curve_rmse(fit, d));
    sf_json_number(j, "max_local_strain", fit->simulated[d].max_local_strain);
    sf_json_number(j, "energy_error", fit->simulated[d].energy_error);
    sf_json_text(j, "grade", sf_verdict_phrase(fit->simulated[d].grade));
    sf_json_text(j, "verdict", fit->simulated[d].verdict);
    if (*fit->simulated[d].failure)
        sf_json_text(j, "failure", fit->simulated[d].failure);
    sf_json_close(j, '}');
}

void sf_report_drops_json(sf_json *j, const sf_drop_fit *fit) {
    sf_json_open(j, "drops", '[');
    for (int d = 0; d < fit->input->drop_count; d++)
        json_drop(j, fit, d);
    sf_json_close(j, ']');
}

/* A comment: "# a_max_g: measured 59.2, simulated 58.93" */
static void put_comparison(FILE *f, const sf_drop_fit *fit, int d, int kind) {
    double measured = fit->input->drop[d].value[kind];
    fprintf(f, "# %s:", sf_drop_kind_get(kind)->key);
    if (!isnan(measured))
        fprintf(f, " measured %.6g,", measured);
    fprintf(f, " simulated %.6g\n", sf_report_response(fit, d, kind));
}

sf_status sf_report_drops_csv(const sf_drop_fit *fit, const sf_staging *output, sf_error *err) {
    FILE *f = sf_staging_open(output, "fit-drops.csv", err);
    if (!f)
        return err->status;
    fputs("# one block per drop: time after the run's start (ms), acceleration (g)\n", f);
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_series *s = &fit->simulated[d].curve;
        fprintf(f, "\n\n# %s\n", fit->input->drop[d].name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_report_shows(fit, d, kind))
                put_comparison(f, fit, d, kind);
        for (int64_t k = 0; k < s->count; k += 10)
            fprintf(f, "%.6g,%.6g\n", 1e3 * s->time[k], s->value[k]);
    }
    return sf_staging_close(f, "fit-drops.csv", err);
}

static void print_response(FILE *f, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const sf_fit_drop *drop = &fit->input->drop[d];
    if (isnan(sf_report_response(fit, d, kind)))
        fprintf(f, "  %s –", about->name);
    else
        fprintf(f, "  %s %.*f%s%s", about->name, about->digits + 1, sf_report_response(fit, d, kind),
                *about->unit ? " " : "", about->unit);
    double width = 100 * sf_report_half_width(fit) * sf_report_response_sd(fit, d, kind);
    if (drop->predicted && isfinite(sf_report_response(fit, d, kind) * width))
        fprintf(f, " ± %.1f %% (95 %%, linearised)", width);
    if (!isnan(drop->value[kind]))
        fprintf(f, " (measured %.4g)", drop->value[kind]);
}

void sf_report_drops_print(FILE *f, const sf_drop_fit *fit) {
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(f, "  %-20s", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_report_shows(fit, d, kind))
                print_response(f, fit, d, kind);
        fputs(drop->predicted ? "  predicted" : "", f);
        if (*fit->simulated[d].failure)
            fprintf(f, "  FAILED: %s", fit->simulated[d].failure);
        fputc('\n', f);
    }
}
