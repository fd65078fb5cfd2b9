/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_report_parts.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build_info.h"
#include "material/low_density_foam.h"
#include "report/chart.h"
#include "study/fit/drop/inference_report.h"
#include "study/material_file.h"

void sf_report_curve_html(FILE *f, const sf_drop_fit *fit) {
    double low, high, sum = 0;
    sf_report_informed_strains(fit, &low, &high);
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    sf_html_heading(f, "Which strains the drops see");
    sf_html_note(
        f,
        "Nine tenths of the information lie between strains of %.2f and %.2f. Outside, its form and the priors "
        "determine the curve.",
        low, high);
    sf_html_table table = sf_html_table_begin(
        f, "dense", "strain|>part of the information|>standard deviation of the stress|>before the data");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%.2f to %.2f", 0.05 * b, 0.05 * (b + 1));
        sf_html_cell(&table, "%.1f %%", 100 * fit->information[b] / fmax(sum, 1e-300));
        sf_html_cell(&table, "%.1f %%", 100 * expm1(fit->curve_sd[b]));
        sf_html_cell(&table, "%.0f %%", 100 * expm1(fit->curve_prior_sd[b]));
    }
    sf_html_table_end(&table);
}

/* The loading curve in the middle of each strain bin. */
typedef struct sf_strain_bin {
    double strain, stress, low, high; /* -, kPa */
    double information;               /* share of the drops' */
} sf_strain_bin;

static sf_status list_strain_bins(const sf_drop_fit *fit, sf_strain_bin bin[SF_FIT_STRAIN_BINS],
                                  sf_error *err) {
    sf_foam_card card;
    sf_curve curve;
    double sum = 0;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    SF_TRY(sf_drop_fit_card(fit->input, fit->result.u, &card, err));
    if (sf_curve_build(&card, 0, &curve, err) == SF_OK)
        for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
            double slope, energy, band = exp(sf_report_half_width(fit) * fit->curve_sd[b]);
            bin[b].strain = 0.05 * (b + 0.5);
            sf_curve_evaluate(&curve, bin[b].strain, &bin[b].stress, &slope, &energy);
            bin[b].stress *= 1e-3;
            bin[b].low = bin[b].stress / band;
            bin[b].high = bin[b].stress * band;
            bin[b].information = fit->information[b] / fmax(sum, 1e-300);
        }
    sf_curve_free(&curve);
    sf_foam_card_free(&card);
    return err->status;
}

sf_status sf_report_curve_csv(const sf_drop_fit *fit, const sf_staging *output, sf_error *err) {
    sf_strain_bin bin[SF_FIT_STRAIN_BINS];
    SF_TRY(list_strain_bins(fit, bin, err));
    FILE *f = sf_staging_open(output, "fit-curve.csv", err);
    if (!f)
        return err->status;
    fputs("strain,stress_kPa,low95_kPa,high95_kPa,information\n", f);
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        fprintf(f, "%.3f,%.6g,%.6g,%.6g,%.6g\n", bin[b].strain, bin[b].stress, bin[b].low, bin[b].high,
                bin[b].information);
    return sf_staging_close(f, "fit-curve.csv", err);
}

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

/* A number of the accelerometer's chain, as it is shown. */
typedef struct chain_shown {
    const char *name, *unit;
    double given, sd, value, factor; /* the interval: value / factor to value * factor */
} chain_shown;

/* Fills `shown` with the numbers that the chain has; returns how many. */
static int list_chain(const sf_drop_fit *fit, chain_shown shown[SF_SIGNAL_CHAIN]) {
    static const char *const name[] = {"mount: frequency", "mount: damping", "coupling: time constant"},
                             *const unit[] = {"Hz", "", "s"};
    const sf_signal_chain found = sf_drop_fit_chain(fit, fit->result.u);
    double given[SF_SIGNAL_CHAIN], value[SF_SIGNAL_CHAIN];
    int count = 0;
    memcpy(given, &fit->input->chain, sizeof given);
    memcpy(value, &found, sizeof value);
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++) {
        int p = fit->chain[k];
        double width = p >= 0 ? sf_report_half_width(fit) * sqrt(fit->result.covariance[p][p]) : 0;
        if (given[k] > 0)
            shown[count++] =
                (chain_shown){name[k], unit[k], given[k], fit->input->chain_sd[k], value[k], exp(width)};
    }
    return count;
}

void sf_report_chain_html(FILE *f, const sf_drop_fit *fit) {
    chain_shown shown[SF_SIGNAL_CHAIN];
    int count = list_chain(fit, shown);
    if (count == 0)
        return;
    sf_html_paragraph(
        f,
        "Every simulated number of the drops on this page is what the accelerometer reads on its mount and "
        "behind its high pass, not what the missile does. The drops share both.");
    sf_html_table table =
        sf_html_table_begin(f, "dense", "accelerometer|>given|>standard deviation (%)|>in the fit|>95 %");
    for (int k = 0; k < count; k++) {
        const chain_shown *c = &shown[k];
        const char *blank = *c->unit ? " " : "";
        sf_html_row(&table);
        sf_html_cell(&table, "%s", c->name);
        sf_html_cell(&table, "%.4g%s%s", c->given, blank, c->unit);
        sf_html_cell(&table, "%.3g", 100 * c->sd);
        sf_html_cell(&table, "%.4g%s%s", c->value, blank, c->unit);
        sf_html_cell(&table, c->sd > 0 ? "%.4g to %.4g" : "known", c->value / c->factor,
                     c->value * c->factor);
    }
    sf_html_table_end(&table);
}

void sf_report_chain_print(FILE *f, const sf_drop_fit *fit) {
    chain_shown shown[SF_SIGNAL_CHAIN];
    int count = list_chain(fit, shown);
    for (int k = 0; k < count; k++) {
        fprintf(f, "Read through the accelerometer's %s %.4g%s%s", shown[k].name, shown[k].value,
                *shown[k].unit ? " " : "", shown[k].unit);
        if (shown[k].sd > 0)
            fprintf(f, " (95 %%, linearised: %.4g to %.4g; given %.4g)", shown[k].value / shown[k].factor,
                    shown[k].value * shown[k].factor, shown[k].given);
        fputs(".\n", f);
    }
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

/* True if the test is too slow for the rate factor to have an effect. */
static bool is_below_reference(const sf_drop_fit *fit, const sf_joint_test *test) {
    const double *start = fit->input->start;
    return start[SF_PARAMETER_RATE_FACTOR] > 0 && test->rate < start[SF_PARAMETER_RATE_REFERENCE];
}

/* Compression tests and cushion curves. */
void sf_report_joint_html(FILE *f, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    if (joint->rows == 0)
        return;
    sf_html_heading(f, "Compression tests and cushion curves");
    sf_html_note(
        f,
        "The law at a material point, and as one column of foam under a flat mass. Deviations of a "
        "test are root mean squares over its largest stress. Below rate_reference the law has no effect of "
        "the rate.");
    sf_html_table table =
        sf_html_table_begin(f, "dense", "test|>rate (1/s)|>± %|>loading|>unloading|>largest strain");
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        sf_html_row(&table);
        sf_html_cell(&table, "%s", test->name);
        sf_html_cell(&table, "%.3g%s", test->rate,
                     is_below_reference(fit, test) ? ", below rate_reference" : "");
        sf_html_number(&table, 1, 100 * test->sd);
        sf_html_cell(&table, "%.1f %%", 100 * sf_joint_rms(test, false, y));
        sf_html_number(&table, 3, sf_joint_rms(test, true, y));
        sf_html_number(&table, 3, test->turn);
    }
    sf_html_table_end(&table);
    table = sf_html_table_begin(
        f, "dense", "cushion|>static stress (kPa)|>peak measured (g)|>± %|>of the foam (g)|>difference");
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++, y++) {
            const sf_joint_cushion *cushion = &joint->cushion[c];
            sf_html_row(&table);
            sf_html_cell(&table, "%s", cushion->name);
            sf_html_cell(&table, "%.4g", 1e-3 * cushion->static_stress[k]);
            sf_html_number(&table, 1, cushion->peak_g[k]);
            sf_html_number(&table, 1, 100 * cushion->sd);
            sf_html_number(&table, 1, exp(*y));
            sf_report_put_difference(&table, *y, cushion->peak_g[k]);
        }
    sf_html_table_end(&table);
}

void sf_report_joint_json(sf_json *j, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    sf_json_open(j, "compressions", '[');
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        sf_json_open(j, NULL, '{');
        sf_json_text(j, "name", test->name);
        sf_json_text(j, "understood", test->interpretation);
        sf_json_number(j, "rate_1_s", test->rate);
        sf_json_bool(j, "below_rate_reference", is_below_reference(fit, test));
        sf_json_integer(j, "points", test->count);
        sf_json_number(j, "loading_rms", sf_joint_rms(test, false, y));
        sf_json_number(j, "unloading_rms", sf_joint_rms(test, true, y));
        sf_json_close(j, '}');
    }
    sf_json_close(j, ']');
    sf_json_open(j, "cushions", '[');
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++) {
            sf_json_open(j, NULL, '{');
            sf_json_text(j, "name", joint->cushion[c].name);
            sf_json_number(j, "static_stress_Pa", joint->cushion[c].static_stress[k]);
            sf_json_number(j, "peak_measured_g", joint->cushion[c].peak_g[k]);
            sf_json_number(j, "peak_g", exp(*y++));
            sf_json_close(j, '}');
        }
    sf_json_close(j, ']');
}

void sf_report_joint_print(FILE *f, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        fprintf(f, "  %-20s  deviation %.1f %% of the largest stress in loading", test->name,
                100 * sf_joint_rms(test, false, y));
        if (test->count > test->loading)
            fprintf(f, ", %.1f %% in unloading", 100 * sf_joint_rms(test, true, y));
        if (is_below_reference(fit, test))
            fputs(" (below rate_reference, where the law has no effect of the rate)", f);
        fputc('\n', f);
    }
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++)
            fprintf(f, "  %-20s  %.4g kPa: peak %.1f g (measured %.4g)\n", joint->cushion[c].name,
                    1e-3 * joint->cushion[c].static_stress[k], exp(*y++), joint->cushion[c].peak_g[k]);
}

/* " a_max 59.2 g measured, 58.9 simulated;" */
static void put_comment(FILE *f, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    fprintf(f, " %s %.4g%s%s measured, %.*f simulated;", about->name, fit->input->drop[d].value[kind],
            *about->unit ? " " : "", about->unit, about->digits, sf_report_response(fit, d, kind));
}

sf_status sf_report_material(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                             const sf_staging *output, sf_error *err) {
    char *provenance = NULL;
    size_t size = 0;
    sf_foam_card card;
    FILE *f = open_memstream(&provenance, &size);
    if (!f)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the material's comments");
    fprintf(f, "Identified by softfall-fit drop %s from %s; everything else is that of its start material.\n",
            SF_VERSION, input_path);
    if (average)
        sf_inference_comment(f, average);
    sf_report_chain_print(f, fit);
    for (int d = 0; d < fit->input->drop_count && !fit->input->drop[d].predicted; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(f, "%s:", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (!isnan(drop->value[kind]))
                put_comment(f, fit, d, kind);
        if (drop->samples > 0)
            fprintf(f, " measured curve, RMSE %.2f g;", sf_report_curve_rmse(fit, d));
        fputc('\n', f);
    }
    for (int t = 0; t < fit->input->joint.test_count; t++)
        fprintf(f, "Compression test %s, %.4g 1/s.\n", fit->input->joint.test[t].name,
                fit->input->joint.test[t].rate);
    for (int c = 0; c < fit->input->joint.cushion_count; c++)
        fprintf(f, "Cushion curve %s, %d points.\n", fit->input->joint.cushion[c].name,
                fit->input->joint.cushion[c].count);
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        fprintf(f, "%s = %.4g%s%s (95 %%, linearised: %.4g to %.4g; %s)\n", e.about->name, e.value / s,
                *e.about->unit ? " " : "", e.about->unit, e.low / s, e.high / s, e.about->description);
    }
    double low, high;
    sf_report_informed_strains(fit, &low, &high);
    fprintf(f,
            "The drops inform the curve between strains of %.2f and %.2f; beyond, its form "
            "determines it.\n",
            low, high);
    fprintf(f, "Curve: %s.\n", fit->input->form.curve->formula);
    if (fclose(f) != 0)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the material's comments");
    const sf_material_text text = {.title = fit->input->title, .provenance = provenance};
    if (err->status == SF_OK && sf_drop_fit_card(fit->input, fit->result.u, &card, err) == SF_OK) {
        card.informed_strain = high;
        const sf_material material = sf_foam_material(&card);
        sf_material_write_checked(output->aside, fit->input->material_name, &material, &text, err);
        sf_foam_card_free(&card);
    }
    free(provenance);
    return err->status;
}

double sf_report_half_width(const sf_drop_fit *fit) {
    return fit->result.scale > 1 ? gsl_cdf_tdist_Pinv(0.975, fit->result.freedom)
                                 : gsl_cdf_ugaussian_Pinv(0.975);
}

sf_estimate_shown sf_report_estimate(const sf_drop_fit *fit, int k) {
    const sf_mapping_result *r = &fit->result;
    double sd = sqrt(r->covariance[k][k]);
    return (sf_estimate_shown){.about = sf_parameter_get(fit->input->unknown[k]),
                               .value = exp(r->u[k]),
                               .low = exp(r->u[k] - sf_report_half_width(fit) * sd),
                               .high = exp(r->u[k] + sf_report_half_width(fit) * sd),
                               .prior = fit->input->prior[k],
                               .shrinkage = sd / fit->input->prior_sd[k]};
}

double sf_report_response(const sf_drop_fit *fit, int d, int which) {
    return exp(fit->y[fit->row[d] + which]);
}

double sf_report_response_sd(const sf_drop_fit *fit, int d, int which) {
    return fit->response_sd[fit->row[d] + which];
}

bool sf_report_shows(const sf_drop_fit *fit, int d, int kind) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    return sf_drop_kind_get(kind)->always || !isnan(drop->value[kind]);
}

const char *sf_report_heading(int kind, char *text, size_t size) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    snprintf(text, size, *about->unit ? "%s (%s)" : "%s", about->name, about->unit);
    return text;
}

double sf_report_curve_rmse(const sf_drop_fit *fit, int d) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    double sum = 0;
    for (int k = 0; k < drop->samples; k++) {
        int row = fit->row[d] + SF_FIT_SAMPLES + k;
        sum += pow(drop->sample_scale * (fit->y[row] - fit->measured[row]), 2);
    }
    return drop->samples > 0 ? sqrt(sum / drop->samples) : NAN;
}

void sf_report_informed_strains(const sf_drop_fit *fit, double *low, double *high) {
    double sum = 0, part = 0;
    *low = *high = 0;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        double before = part;
        part += fit->information[b];
        if (before < 0.05 * sum && part >= 0.05 * sum)
            *low = 0.05 * b;
        if (before < 0.95 * sum && part >= 0.95 * sum)
            *high = 0.05 * (b + 1);
    }
}

void sf_report_put_difference(sf_html_table *table, double scaled, double measured) {
    if (isnan(measured) || isnan(scaled))
        sf_html_cell(table, "–");
    else
        sf_html_cell(table, "%+.1f %%", 100 * (exp(scaled) / measured - 1));
}

/* A heading for each unknown parameter after the first one, all of numbers. */
static sf_html_table begin_matrix(FILE *f, const sf_fit_input *in, const char *first) {
    char columns[1024];
    size_t used = (size_t)snprintf(columns, sizeof columns, "%s", first);
    for (int k = 0; k < in->unknown_count && used < sizeof columns; k++)
        used += (size_t)snprintf(columns + used, sizeof columns - used, "|>%s",
                                 sf_parameter_get(in->unknown[k])->name);
    return sf_html_table_begin(f, "dense", columns);
}

static void put_correlations(FILE *f, const sf_drop_fit *fit) {
    sf_html_paragraph(f, "Correlation of their logarithms:");
    sf_html_table table = begin_matrix(f, fit->input, "");
    for (int j = 0; j < fit->input->unknown_count; j++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%s", sf_parameter_get(fit->input->unknown[j])->name);
        for (int k = 0; k < fit->input->unknown_count; k++)
            sf_html_cell(&table, "%+.2f",
                         fit->result.covariance[j][k] /
                             sqrt(fit->result.covariance[j][j] * fit->result.covariance[k][k]));
    }
    sf_html_table_end(&table);
}

void sf_report_parameters_html(FILE *f, const sf_drop_fit *fit) {
    sf_html_heading(f, "Parameters");
    sf_html_note(
        f,
        "95 %% intervals (of the logarithm, linearised). A parameter that keeps 90 %% or more of its prior's "
        "width was hardly seen by the drops.");
    sf_html_table table = sf_html_table_begin(
        f, "dense", "parameter|>value|>95 %|>prior|>prior factor (1 sd)|>width left of the prior|meaning");
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        sf_html_row(&table);
        sf_html_cell(&table, "%s%s%s", e.about->name, *e.about->unit ? ", " : "", e.about->unit);
        sf_html_cell(&table, "%.4g", e.value / s);
        sf_html_cell(&table, "%.4g to %.4g", e.low / s, e.high / s);
        sf_html_cell(&table, "%.4g", e.prior / s);
        sf_html_cell(&table, "%.2f", exp(fit->input->prior_sd[k]));
        sf_html_cell(&table, "%.0f %%", 100 * e.shrinkage);
        sf_html_cell(&table, "%s", e.about->description);
    }
    sf_html_table_end(&table);
    put_correlations(f, fit);
}

void sf_report_sensitivities_html(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    sf_html_heading(f, "Sensitivity");
    sf_html_note(f, "Change of the response in %% for 1 %% more of the parameter.");
    sf_html_table table = begin_matrix(f, in, "response");
    for (int d = 0; d < in->drop_count; d++)
        for (int which = 0; which < SF_FIT_SAMPLES; which++) {
            if (!sf_report_shows(fit, d, which))
                continue;
            sf_html_row(&table);
            sf_html_cell(&table, "%s, %s", in->drop[d].name, sf_drop_kind_get(which)->name);
            for (int k = 0; k < in->unknown_count; k++)
                sf_html_cell(&table, "%+.3f", fit->gradient[(fit->row[d] + which) * fit->parameters + k]);
        }
    sf_html_table_end(&table);
}

static void json_parameter(sf_json *j, const sf_drop_fit *fit, int k) {
    sf_estimate_shown e = sf_report_estimate(fit, k);
    sf_json_open(j, NULL, '{');
    sf_json_text(j, "name", e.about->name);
    sf_json_number(j, "value_SI", e.value);
    sf_json_number(j, "low95_SI", e.low);
    sf_json_number(j, "high95_SI", e.high);
    sf_json_number(j, "prior_SI", e.prior);
    sf_json_number(j, "prior_sd_of_logarithm", fit->input->prior_sd[k]);
    sf_json_number(j, "sd_of_logarithm", sqrt(fit->result.covariance[k][k]));
    sf_json_close(j, '}');
}

void sf_report_parameters_json(sf_json *j, const sf_drop_fit *fit) {
    sf_json_open(j, "parameters", '[');
    for (int k = 0; k < fit->input->unknown_count; k++)
        json_parameter(j, fit, k);
    sf_json_close(j, ']');
    sf_json_open(j, "covariance_of_logarithms", '[');
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_json_open(j, NULL, '[');
        for (int i = 0; i < fit->input->unknown_count; i++)
            sf_json_number(j, NULL, fit->result.covariance[k][i]);
        sf_json_close(j, ']');
    }
    sf_json_close(j, ']');
}

void sf_report_parameters_print(FILE *f, const sf_drop_fit *fit) {
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        fprintf(f, "  %-8s %10.4g %-5s 95 %% linearised: %.4g to %.4g  (%.0f %% of the prior's width)\n",
                e.about->name, e.value / s, e.about->unit, e.low / s, e.high / s, 100 * e.shrinkage);
    }
}

static double peak_time_ms(const sf_series *curve) {
    int64_t at = 0;
    for (int64_t k = 1; k < curve->count; k++)
        if (curve->value[k] > curve->value[at])
            at = k;
    return 1e3 * curve->time[at];
}

static sf_panel *new_panel(sf_chart *chart, const char *x, const char *y, double left, double right,
                           double bottom, double top) {
    const double area[4] = {left, right, bottom, top};
    sf_panel *panel = sf_chart_panel(chart);
    if (!panel)
        return NULL;
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "%s", x);
    sf_axis_label(&panel->y, "%s", y);
    return panel;
}

/* The loading curve with its interval, and which strains the drops see. */
static sf_status put_strain_panels(sf_chart *chart, const sf_drop_fit *fit, sf_error *err) {
    sf_strain_bin bin[SF_FIT_STRAIN_BINS];
    SF_TRY(list_strain_bins(fit, bin, err));
    sf_panel *panel = new_panel(chart, "engineering strain", "nominal stress (kPa)", 0.09, 0.49, 0.53, 0.92);
    if (panel) {
        sf_axis_range(&panel->x, 0, 0.95);
        panel->x.step = 0.2;
        panel->y.logarithmic = true;
        panel->key = SF_KEY_TOP_LEFT;
    }
    sf_series_data *range =
        sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_RANGE, .colour = "#c6dbef"}, "95 %%");
    sf_series_data *curve = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c", .width = 3}, "loading curve");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        sf_series_add(range, bin[b].strain, bin[b].stress, bin[b].low, bin[b].high);
        sf_series_point(curve, bin[b].strain, bin[b].stress);
    }
    panel =
        new_panel(chart, "engineering strain", "information of the drops (share)", 0.58, 0.98, 0.53, 0.92);
    if (panel) {
        sf_axis_range(&panel->x, 0, 0.95);
        panel->x.step = 0.2;
        sf_axis_range(&panel->y, 0, NAN);
    }
    sf_series_data *boxes = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_BOXES, .colour = "#fd8d3c", .size = 0.045, .opacity = 0.6},
        NULL);
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sf_series_point(boxes, bin[b].strain, bin[b].information);
    return err->status;
}

/* Simulated curves; a circle at each measured peak. */
static void put_drop_panel(sf_chart *chart, const sf_drop_fit *fit) {
    static const char *const colours[] = {"#9400d3", "#009e73", "#56b4e9", "#e69f00",
                                          "#f0e442", "#0072b2", "#e51e10", "#000000"};
    sf_panel *panel = new_panel(chart, "time after contact (ms)", "acceleration (g)", 0.09, 0.98, 0.14, 0.43);
    if (panel) {
        sf_axis_range(&panel->x, 0, NAN);
        sf_axis_range(&panel->y, 0, NAN);
        panel->key = SF_KEY_BELOW;
    }
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        const sf_series *s = &fit->simulated[d].curve;
        const sf_series_style style = {.kind = SF_SERIES_LINE,
                                       .colour = colours[d % (int)(sizeof colours / sizeof colours[0])],
                                       .width = 3,
                                       .dashed = drop->predicted};
        sf_series_points(
            sf_chart_series(chart, style, "%s%s", drop->name, drop->predicted ? " (predicted)" : ""),
            s->count, s->time, s->value, 1e3, 1, 0);
    }
    sf_series_data *peaks = sf_chart_series(
        chart,
        (sf_series_style){
            .kind = SF_SERIES_POINTS, .colour = "#404040", .shape = SF_POINT_CIRCLE, .size = 2, .width = 2},
        "measured peak");
    for (int d = 0; d < fit->measured_drops; d++)
        if (!isnan(fit->input->drop[d].value[SF_FIT_A_MAX]))
            sf_series_point(peaks, peak_time_ms(&fit->simulated[d].curve),
                            fit->input->drop[d].value[SF_FIT_A_MAX]);
}

sf_status sf_report_picture(const sf_drop_fit *fit, const sf_staging *output, char *warning, size_t size,
                            sf_error *err) {
    sf_chart *chart = sf_chart_new("fit", 1700, 1350, err);
    sf_chart_title(chart, "Identification from drops: %s", fit->input->material_name);
    if (chart && put_strain_panels(chart, fit, err) == SF_OK && fit->input->drop_count > 0)
        put_drop_panel(chart, fit);
    sf_chart_write(chart, output, warning, size, err);
    sf_chart_free(chart);
    return err->status;
}
