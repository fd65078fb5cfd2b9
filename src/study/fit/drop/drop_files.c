/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of `softfall-fit drop` beside page and fit.json, and the numbers that all of them show. */
#include "study/fit/drop/drop_report.h"

#include <gsl/gsl_cdf.h>

#include "build_info.h"
#include "material/low_density_foam.h"
#include "report/chart.h"
#include "study/material_file.h"

double sf_drop_half_width(const sf_drop_fit *fit) {
    return fit->result.scale > 1 ? gsl_cdf_tdist_Pinv(0.975, fmax(1, fit->result.freedom))
                                 : gsl_cdf_ugaussian_Pinv(0.975);
}

sf_estimate_shown sf_drop_estimate(const sf_drop_fit *fit, int k) {
    const sf_mapping_result *r = &fit->result;
    const sf_parameter_info *about = sf_parameter_get(fit->input->unknown[k]);
    double sd = sqrt(r->covariance[k][k]), width = sf_drop_half_width(fit) * sd, s = about->per_unit, low,
           high;
    sf_drop_fit_bounds(fit->input, k, &low, &high);
    return (sf_estimate_shown){.about = about,
                               .blank = *about->unit ? " " : "",
                               .value = exp(r->u[k]) / s,
                               .low = exp(fmax(r->u[k] - width, low)) / s,
                               .high = exp(fmin(r->u[k] + width, high)) / s,
                               .per_unit = s,
                               .shrinkage = sd / fit->input->prior_sd[k]};
}

double sf_drop_response(const sf_drop_fit *fit, int d, int kind) {
    return exp(fit->y[fit->row[d] + kind]);
}

bool sf_drop_shows(const sf_drop_fit *fit, int d, int kind) {
    return sf_drop_kind_get(kind)->always || !isnan(fit->input->drop[d].value[kind]);
}

double sf_drop_curve_rmse(const sf_drop_fit *fit, int d) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    double sum = 0;
    for (int k = 0; k < drop->samples; k++) {
        int row = fit->row[d] + SF_FIT_SAMPLES + k;
        sum += pow(drop->sample_scale * (fit->y[row] - fit->measured[row]), 2);
    }
    return drop->samples > 0 ? sqrt(sum / drop->samples) : NAN;
}

double sf_drop_information(const sf_drop_fit *fit) {
    double sum = 0;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    return sum;
}

void sf_drop_informed_strains(const sf_drop_fit *fit, double *low, double *high) {
    double sum = sf_drop_information(fit), part = 0;
    *low = *high = 0;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        double before = part;
        part += fit->information[b];
        if (before < 0.05 * sum && part >= 0.05 * sum)
            *low = 0.05 * b;
        if (before < 0.95 * sum && part >= 0.95 * sum)
            *high = 0.05 * (b + 1);
    }
}

int sf_drop_chain_list(const sf_drop_fit *fit, sf_chain_shown shown[SF_SIGNAL_CHAIN]) {
    static const char *const name[] = {"mount: frequency", "mount: damping", "coupling: time constant"},
                             *const unit[] = {"Hz", "", "s"};
    const sf_signal_chain found = sf_drop_fit_chain(fit, fit->result.u);
    double given[SF_SIGNAL_CHAIN], value[SF_SIGNAL_CHAIN];
    int count = 0;
    memcpy(given, &fit->input->chain, sizeof given);
    memcpy(value, &found, sizeof value);
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++) {
        int p = fit->chain[k];
        double factor = exp(p >= 0 ? sf_drop_half_width(fit) * sqrt(fit->result.covariance[p][p]) : 0);
        if (given[k] > 0)
            shown[count++] = (sf_chain_shown){
                name[k],  unit[k],           *unit[k] ? " " : "", given[k], fit->input->chain_sd[k],
                value[k], value[k] / factor, value[k] * factor};
    }
    return count;
}

void sf_drop_chain_print(FILE *f, const sf_drop_fit *fit) {
    sf_chain_shown shown[SF_SIGNAL_CHAIN];
    int count = sf_drop_chain_list(fit, shown);
    for (const sf_chain_shown *c = shown; c < shown + count; c++) {
        fprintf(f, "Read through the accelerometer's %s %.4g%s%s", c->name, c->value, c->blank, c->unit);
        if (c->sd > 0)
            fprintf(f, " (95 %%, linearised: %.4g to %.4g; given %.4g)", c->low, c->high, c->given);
        fputs(".\n", f);
    }
}

/* ---- fit-curve.csv and fit-drops.csv ---- */

/* The loading curve in the middle of each strain bin. */
typedef struct strain_bin {
    double strain, stress, low, high; /* -, kPa */
    double information;               /* share of the drops' */
} strain_bin;

static sf_status list_strain_bins(const sf_drop_fit *fit, strain_bin bin[SF_FIT_STRAIN_BINS], sf_error *err) {
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
    SF_TRY(sf_drop_fit_card(fit->input, fit->result.u, &card, err));
    SF_TRY(sf_curve_build(&card, 0, &curve, err));
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        double slope, energy, band = exp(sf_drop_half_width(fit) * fit->curve_sd[b]);
        bin[b].strain = 0.05 * (b + 0.5);
        sf_curve_evaluate(&curve, bin[b].strain, &bin[b].stress, &slope, &energy);
        bin[b].stress *= 1e-3;
        bin[b].low = bin[b].stress / band;
        bin[b].high = bin[b].stress * band;
        bin[b].information = fit->information[b] / fmax(sf_drop_information(fit), 1e-300);
    }
    return SF_OK;
}

static sf_status write_curve(const strain_bin *bin, const sf_staging *output, sf_error *err) {
    SF_CSV_FILE(csv, output, "fit-curve.csv", err);
    SF_CSV_PRINT_LINE(&csv, "strain,stress_kPa,low95_kPa,high95_kPa,information");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        SF_CSV_PRINT_LINE(&csv, "%.3f,%.6g,%.6g,%.6g,%.6g", bin[b].strain, bin[b].stress, bin[b].low,
                          bin[b].high, bin[b].information);
    return sf_csv_close(&csv, err);
}

/* A block of gnuplot for each drop, which its comments begin. */
static sf_status write_drops(const sf_drop_fit *fit, const sf_staging *output, sf_error *err) {
    SF_CSV_FILE(csv, output, "fit-drops.csv", err);
    fputs("# one block per drop: time after the run's start (ms), acceleration (g)\n", csv.file);
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_series *s = &fit->simulated[d].curve;
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(csv.file, "\n\n# %s\n", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            if (!sf_drop_shows(fit, d, kind))
                continue;
            fprintf(csv.file, "# %s:", sf_drop_kind_get(kind)->key);
            if (!isnan(drop->value[kind]))
                fprintf(csv.file, " measured %.6g,", drop->value[kind]);
            fprintf(csv.file, " simulated %.6g\n", sf_drop_response(fit, d, kind));
        }
        for (int64_t k = 0; k < s->count; k += 10)
            SF_CSV_PRINT_LINE(&csv, "%.6g,%.6g", 1e3 * s->time[k], s->value[k]);
    }
    return sf_csv_close(&csv, err);
}

/* ---- the picture ---- */

/* The loading curve with its interval, and which strains the drops see. */
static void put_strain_panels(sf_chart *chart, const strain_bin *bin) {
    sf_panel *panel =
        sf_chart_panel_at(chart, "engineering strain", "nominal stress (kPa)", 0.09, 0.49, 0.53, 0.92);
    sf_axis_range(&panel->x, 0, 0.95);
    panel->x.step = 0.2;
    panel->y.logarithmic = true;
    panel->key = SF_KEY_TOP_LEFT;
    sf_series_data *range =
        sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_RANGE, .colour = "#c6dbef"}, "95 %%");
    sf_series_data *curve = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c", .width = 3}, "loading curve");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        sf_series_add(range, bin[b].strain, bin[b].stress, bin[b].low, bin[b].high);
        sf_series_point(curve, bin[b].strain, bin[b].stress);
    }
    panel = sf_chart_panel_at(chart, "engineering strain", "information of the drops (share)", 0.58, 0.98,
                              0.53, 0.92);
    sf_axis_range(&panel->x, 0, 0.95);
    panel->x.step = 0.2;
    sf_axis_range(&panel->y, 0, NAN);
    sf_series_data *boxes = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_BOXES, .colour = "#fd8d3c", .size = 0.045, .opacity = 0.6},
        NULL);
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sf_series_point(boxes, bin[b].strain, bin[b].information);
}

/* Simulated curves; a circle at each measured peak. */
static void put_drop_panel(sf_chart *chart, const sf_drop_fit *fit) {
    static const char *const colours[] = {"#9400d3", "#009e73", "#56b4e9", "#e69f00",
                                          "#f0e442", "#0072b2", "#e51e10", "#000000"};
    sf_panel *panel =
        sf_chart_panel_at(chart, "time after contact (ms)", "acceleration (g)", 0.09, 0.98, 0.14, 0.43);
    sf_axis_range(&panel->x, 0, NAN);
    sf_axis_range(&panel->y, 0, NAN);
    panel->key = SF_KEY_BELOW;
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
        if (!isnan(fit->input->drop[d].value[SF_FIT_A_MAX])) {
            const sf_series *curve = &fit->simulated[d].curve;
            sf_series_point(peaks, 1e3 * curve->time[sf_series_peak(curve)],
                            fit->input->drop[d].value[SF_FIT_A_MAX]);
        }
}

static sf_status write_picture(const sf_drop_fit *fit, const strain_bin *bin, const sf_staging *output,
                               char *warning, size_t size, sf_error *err) {
    sf_chart *chart = sf_chart_new("fit", 1700, 1350, err);
    sf_chart_title(chart, "Identification from drops: %s", fit->input->material_name);
    put_strain_panels(chart, bin);
    if (fit->input->drop_count > 0)
        put_drop_panel(chart, fit);
    return sf_chart_write(chart, output, warning, size, err);
}

/* ---- the material ---- */

/* Comment lines: weights, drops, tests and parameters. */
static void put_provenance(FILE *f, const sf_drop_fit *fit, const sf_drop_average *average,
                           const char *input_path) {
    const sf_fit_input *in = fit->input;
    double low, high;
    fprintf(f, "Identified by softfall-fit drop %s from %s; everything else is that of its start material.\n",
            SF_VERSION, input_path);
    if (!fit->result.converged)
        fprintf(f, "NOT CONVERGED: %s. These values are not to be used.\n", fit->result.reason);
    if (average)
        sf_inference_comment(f, average);
    sf_drop_chain_print(f, fit);
    for (int d = 0; d < fit->measured_drops; d++) {
        const sf_fit_drop *drop = &in->drop[d];
        fprintf(f, "%s:", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            const sf_drop_kind_info *about = sf_drop_kind_get(kind);
            if (!isnan(drop->value[kind]))
                fprintf(f, " %s %.4g%s%s measured, %.*f simulated;", about->name, drop->value[kind],
                        *about->unit ? " " : "", about->unit, about->digits, sf_drop_response(fit, d, kind));
        }
        if (drop->samples > 0)
            fprintf(f, " measured curve, RMSE %.2f g;", sf_drop_curve_rmse(fit, d));
        fputc('\n', f);
    }
    for (int t = 0; t < in->joint.test_count; t++)
        fprintf(f, "Compression test %s, %.4g 1/s.\n", in->joint.test[t].name, in->joint.test[t].rate);
    for (int c = 0; c < in->joint.cushion_count; c++)
        fprintf(f, "Cushion curve %s, %d points.\n", in->joint.cushion[c].name, in->joint.cushion[c].count);
    for (int k = 0; k < in->unknown_count; k++) {
        sf_estimate_shown e = sf_drop_estimate(fit, k);
        fprintf(f, "%s = %.4g%s%s (95 %%, linearised: %.4g to %.4g; %s)\n", e.about->name, e.value, e.blank,
                e.about->unit, e.low, e.high, e.about->description);
    }
    sf_drop_informed_strains(fit, &low, &high);
    fprintf(f,
            "The drops inform the curve between strains of %.2f and %.2f; beyond, its form determines it.\n"
            "Curve: %s.\n",
            low, high, in->form.curve->formula);
}

static sf_status write_material(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                                sf_error *err) {
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    double low;
    SF_OWNED SF_TEXT_STREAM(f, provenance, size);
    if (f)
        put_provenance(f, fit, average, study->input);
    if (!f || fclose(f) != 0)
        return SF_NO_MEMORY(err, "the material's comments");
    const sf_material_text text = {.title = fit->input->title, .provenance = provenance};
    SF_TRY(sf_drop_fit_card(fit->input, fit->result.u, &card, err));
    sf_drop_informed_strains(fit, &low, &card.informed_strain);
    const sf_material material = sf_foam_material(&card);
    return sf_material_write_checked(study->output.aside, fit->input->material_name, &material, &text, err);
}

sf_status sf_drop_files_write(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                              char *warning, size_t size, sf_error *err) {
    const sf_staging *output = &study->output;
    strain_bin bin[SF_FIT_STRAIN_BINS];
    SF_TRY(list_strain_bins(fit, bin, err));
    SF_TRY(write_curve(bin, output, err));
    SF_TRY(write_drops(fit, output, err));
    SF_TRY(write_picture(fit, bin, output, warning, size, err));
    return write_material(fit, average, study, err);
}
