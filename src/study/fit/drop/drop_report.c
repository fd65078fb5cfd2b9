/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_report.h"

#include "base/text.h"
#include "build_info.h"
#include "report/chart.h"
#include "study/material_file.h"

static const double SIDES = 1.959963984540054; /* standard deviations on each side of a 95 % interval */

/* Standard deviation of the logarithm of a response by the parameters. */
static double response_sd(const sf_drop_fit *fit, int d, int kind) {
    return fit->response_sd[fit->row[d] + kind];
}

/* Half of the linearised 95 % interval of the logarithm of a predicted response: of a single pad and drop. */
static double half_width(const sf_drop_fit *fit, int d, int kind) {
    double by_drop = sf_drop_fit_scatter(fit, d, kind);
    return hypot(sf_drop_half_width(fit) * response_sd(fit, d, kind), isnan(by_drop) ? 0 : SIDES * by_drop);
}

/* Change in % from what was measured to a response, a logarithm. */
static double difference(double scaled, double measured) {
    return 100 * (exp(scaled) / measured - 1);
}

/* True if the test is too slow for the rate factor to have an effect. */
static bool is_below_reference(const sf_drop_fit *fit, const sf_joint_test *test) {
    const double *start = fit->input->start;
    return start[SF_PARAMETER_RATE_FACTOR] > 0 && test->rate < start[SF_PARAMETER_RATE_REFERENCE];
}

/* ---- report.html ---- */

static bool has_speeds(const sf_drop_fit *fit) {
    int count = 0;
    for (int d = 0; d < fit->measured_drops; d++)
        count += fit->speed[d] >= 0;
    return count > 0;
}

/* Why the fit has not converged. The marginal standard deviations of the last step can hide a fall of the
 * objective along correlated parameters: what is left of it is said. */
static void describe_end(const sf_drop_fit *fit, char *text, size_t size) {
    static const double LEAST = 0.1, ROUNDING = 1e-6;
    const sf_mapping_result *r = &fit->result;
    snprintf(text, size, "%s%s", r->reason ? "; " : "", r->reason ? r->reason : "");
    if (r->gain > LEAST)
        sf_text_add(text, size, "; the model of the last step expects the objective to fall by %.2g more",
                    r->gain);
    if (r->linear)
        sf_text_add(
            text, size,
            "; the last steps have derivatives of simulations, as those of the columns misled: posterior, "
            "sensitivities and predictions, which have columns, are less sure");
    if (has_speeds(fit))
        sf_text_add(text, size, "; the drops are told at %s speeds, the misfit is that at the fitted ones",
                    fit->speeds_fitted ? "the fitted" : "the given");
    for (int k = 0; k < fit->input->unknown_count; k++) {
        double low, high;
        sf_drop_fit_bounds(fit->input, k, &low, &high);
        if (r->u[k] - low < ROUNDING || high - r->u[k] < ROUNDING)
            sf_text_add(text, size, "; %s stands at its bound, where its interval means nothing",
                        sf_parameter_get(fit->input->unknown[k])->name);
    }
}

static void put_banner(FILE *f, const sf_drop_fit *fit) {
    double low, high;
    bool misses = fit->result.scale > 1;
    char coarse[64] = "", end[512];
    describe_end(fit, end, sizeof end);
    if (fit->coarse_iterations > 0)
        snprintf(coarse, sizeof coarse, " and %d with the coarse mesh of coarse_set", fit->coarse_iterations);
    sf_drop_informed_strains(fit, &low, &high);
    sf_html_banner(
        f,
        !fit->result.converged ? "bad"
        : misses               ? "fair"
                               : "good",
        fit->result.converged ? "converged" : "not converged",
        "After %d simulations of every measured drop%s; misfit %.2f with %.1f degrees of freedom%s%s. The drops "
        "inform the curve between strains of %.2f and %.2f.",
        fit->result.iterations, coarse, fit->result.misfit, fit->result.freedom,
        misses ? ", more than the stated standard deviations allow: the intervals are widened" : "", end, low,
        high);
}

/* Writes the numbers of the accelerometer's mount and high pass; nothing without them. */
static void put_chain(FILE *f, const sf_drop_fit *fit) {
    sf_chain_shown shown[SF_SIGNAL_CHAIN];
    int count = sf_drop_chain_list(fit, shown);
    if (count == 0)
        return;
    sf_html_paragraph(f,
                      "Every simulated number of the drops on this page is what the accelerometer reads on "
                      "its mount and behind its high pass, not what the missile does. The drops share both.");
    SF_HTML_TABLE table =
        sf_html_table_begin(f, "accelerometer|>given|>standard deviation (%)|>in the fit|>95 %");
    for (const sf_chain_shown *c = shown; c < shown + count; c++) {
        sf_html_line(&table, c->name, "%.4g%s%s|%.3g|%.4g%s%s", c->given, c->blank, c->unit, 100 * c->sd,
                     c->value, c->blank, c->unit);
        sf_html_cell(&table, c->sd > 0 ? "%.4g to %.4g" : "known", c->low, c->high);
    }
}

/* "a_max (g)" */
static void put_heading(char text[64], const sf_drop_kind_info *about) {
    snprintf(text, 64, *about->unit ? "%s (%s)" : "%s", about->name, about->unit);
}

static void put_drops(FILE *f, const sf_drop_fit *fit) {
    char heading[64];
    if (fit->measured_drops == 0)
        return;
    sf_html_heading(f, "Drops");
    sf_html_note(f,
                 "The simulation with the identified material against the measurement, as the accelerometer "
                 "reads (F/m), CFC 1000. \"From the others\": the same drop left out of the fit and "
                 "predicted by the rest (corrected surrogate).");
    SF_HTML_TABLE table =
        sf_html_table_begin(f, "drop|quantity|>measured|>± %|>simulated|>difference|>from the others");
    for (int d = 0; d < fit->measured_drops; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            const sf_drop_kind_info *about = sf_drop_kind_get(kind);
            const sf_fit_drop *drop = &fit->input->drop[d];
            double measured = drop->value[kind];
            int row = fit->row[d] + kind;
            if (!sf_drop_shows(fit, d, kind))
                continue;
            put_heading(heading, about);
            sf_html_line(&table, drop->name, "%s|%.*f|%.1f|%.*f|%+.1f %%|%+.1f %%", heading, about->digits,
                         measured, isnan(measured) ? NAN : 100 * drop->sd[kind], about->digits,
                         sf_drop_response(fit, d, kind), difference(fit->y[row], measured),
                         difference(fit->without[row], measured));
        }
    sf_html_table_end(&table);
    table = sf_html_table_begin(f, "drop|>curve RMSE (g)|>largest local strain|verdict");
    for (int d = 0; d < fit->measured_drops; d++)
        sf_html_line(&table, fit->input->drop[d].name, "%.2f|%.3f|%s", sf_drop_curve_rmse(fit, d),
                     fit->simulated[d].max_local_strain, sf_verdict_phrase(fit->simulated[d].grade));
}

/* Compression tests and cushion curves. */
static void put_joint(FILE *f, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    if (joint->rows == 0)
        return;
    sf_html_heading(f, "Compression tests and cushion curves");
    sf_html_note(f,
                 "The law at a material point, and as one column of foam under a flat mass. Deviations of a "
                 "test are root mean squares over its largest stress. Below rate_reference the law has no "
                 "effect of the rate.");
    SF_HTML_TABLE table = sf_html_table_begin(f, "test|>rate (1/s)|>± %|>loading|>unloading|>largest strain");
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        sf_html_line(&table, test->name, "%.3g%s|%.1f|%.1f %%|%.3f|%.3f", test->rate,
                     is_below_reference(fit, test) ? ", below rate_reference" : "", 100 * test->sd,
                     100 * sf_joint_rms(test, false, y), sf_joint_rms(test, true, y), test->turn);
    }
    sf_html_table_end(&table);
    table = sf_html_table_begin(
        f, "cushion|>static stress (kPa)|>peak measured (g)|>± %|>of the foam (g)|>difference");
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++, y++) {
            const sf_joint_cushion *cushion = &joint->cushion[c];
            sf_html_line(&table, cushion->name, "%.4g|%.1f|%.1f|%.1f|%+.1f %%",
                         1e-3 * cushion->static_stress[k], cushion->peak_g[k], 100 * cushion->sd, exp(*y),
                         difference(*y, cushion->peak_g[k]));
        }
}

static void put_misfit(FILE *f, const sf_drop_fit *fit) {
    sf_html_paragraph(f,
                      "Misfit: %.2f (sum of squared residuals over their standard deviations) with %.1f "
                      "degrees of freedom.",
                      fit->result.misfit, fit->result.freedom);
    if (fit->result.scale > 1)
        sf_html_paragraph(f,
                          "The model misses the data by more than their stated standard deviations, so "
                          "theirs are multiplied by %.2f in the intervals.",
                          fit->result.scale);
}

/* A number of a measured drop at its fitted speed, which is that of the misfit. */
static double fitted_response(const sf_drop_fit *fit, int d, int kind) {
    return exp(fit->result.y[fit->row[d] + kind]);
}

/* Fitted speeds, for drops whose speed is not known exactly. */
static void put_speeds(FILE *f, const sf_drop_fit *fit) {
    if (!has_speeds(fit))
        return;
    sf_html_paragraph(f,
                      "The speeds are known with a standard deviation only, and are unknowns of the fit; "
                      "the table above is simulated with %s ones.",
                      fit->speeds_fitted ? "the fitted" : "the given");
    SF_HTML_TABLE table = sf_html_table_begin(
        f, "drop|>given (m/s)|>standard deviation (%)|>in the fit (%)|>95 %|>a_max there (g)|>HIC there");
    for (int d = 0; d < fit->measured_drops; d++) {
        int k = fit->speed[d];
        if (k < 0)
            continue;
        double shift = fit->result.u[k], width = sf_drop_half_width(fit) * sqrt(fit->result.covariance[k][k]);
        sf_html_line(&table, fit->input->drop[d].name, "%.4g|%.2f|%+.2f|%+.2f to %+.2f|%.2f|%.1f",
                     fit->columns[d].speed, 100 * fit->input->drop[d].speed_sd, 100 * expm1(shift),
                     100 * expm1(shift - width), 100 * expm1(shift + width),
                     fitted_response(fit, d, SF_FIT_A_MAX), fitted_response(fit, d, SF_FIT_HIC));
    }
}

static void put_predictions(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    char heading[64];
    if (in->drop_count == fit->measured_drops)
        return;
    sf_html_heading(f, "Predictions by simulation with the written material");
    sf_html_note(
        f,
        "Drops that were not used. The 95 %% intervals are linearised and hold the uncertainty of this model's parameters and, of a_max and HIC, the scatter "
        "from drop to drop (missile.speed_scatter and pad.thickness_tolerance); that of the discretisation and of the model's form come on top.");
    sf_html_table table =
        sf_html_table_begin(f, "drop|quantity|>predicted|>95 %|>largest local strain|verdict");
    for (int d = fit->measured_drops; d < in->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            const sf_drop_kind_info *about = sf_drop_kind_get(kind);
            double value = sf_drop_response(fit, d, kind), width = half_width(fit, d, kind);
            if (!sf_drop_shows(fit, d, kind))
                continue;
            put_heading(heading, about);
            sf_html_line(&table, in->drop[d].name, "%s|%.*f|%.*f to %.*f|%.3f|%s", heading, about->digits,
                         value, about->digits, isfinite(value * width) ? value * exp(-width) : NAN,
                         about->digits, value * exp(width), fit->simulated[d].max_local_strain,
                         sf_verdict_phrase(fit->simulated[d].grade));
        }
    sf_html_table_end(&table);
    for (int d = fit->measured_drops; d < in->drop_count; d++)
        if (*fit->simulated[d].failure)
            sf_html_banner(f, "bad", "no prediction by simulation", "%s: %s.", in->drop[d].name,
                           fit->simulated[d].failure);
}

/* A heading for each unknown parameter after the first one, all of numbers. */
static sf_html_table begin_matrix(FILE *f, const sf_fit_input *in, const char *first) {
    SF_PRINTED(columns, 1024, "%s", first);
    for (int k = 0; k < in->unknown_count; k++)
        sf_text_add(columns, sizeof columns, "|>%s", sf_parameter_get(in->unknown[k])->name);
    return sf_html_table_begin(f, columns);
}

static void put_parameters(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    const sf_mapping_result *r = &fit->result;
    sf_html_heading(f, "Parameters");
    sf_html_note(f, "95 %% intervals (of the logarithm, linearised). A parameter that keeps 90 %% or more of "
                    "its prior's width was hardly seen by the drops.");
    SF_HTML_TABLE table = sf_html_table_begin(
        f, "parameter|>value|>95 %|>prior|>prior factor (1 sd)|>width left of the prior|meaning");
    for (int k = 0; k < in->unknown_count; k++) {
        sf_estimate_shown e = sf_drop_estimate(fit, k);
        SF_HTML_ROW(&table, "%s%s%s", e.about->name, *e.blank ? ", " : "", e.about->unit);
        sf_html_line(&table, NULL, "%.4g|%.4g to %.4g|%.4g|%.2f|%.0f %%|%s", e.value, e.low, e.high,
                     in->prior[k] / e.per_unit, exp(in->prior_sd[k]), 100 * e.shrinkage,
                     e.about->description);
    }
    sf_html_table_end(&table);
    sf_html_note(f, SF_MATERIAL_ELSEWHERE);
    sf_html_paragraph(f, "Correlation of their logarithms:");
    table = begin_matrix(f, in, "");
    for (int j = 0; j < in->unknown_count; j++) {
        SF_HTML_ROW(&table, "%s", sf_parameter_get(in->unknown[j])->name);
        for (int k = 0; k < in->unknown_count; k++)
            sf_html_cell(&table, "%+.2f",
                         r->covariance[j][k] / sqrt(r->covariance[j][j] * r->covariance[k][k]));
    }
}

static void put_sensitivities(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    sf_html_heading(f, "Sensitivity");
    sf_html_note(f, "Change of the response in %% for 1 %% more of the parameter.");
    SF_HTML_TABLE table = begin_matrix(f, in, "response");
    for (int d = 0; d < in->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            if (!sf_drop_shows(fit, d, kind))
                continue;
            SF_HTML_ROW(&table, "%s, %s", in->drop[d].name, sf_drop_kind_get(kind)->name);
            for (int k = 0; k < in->unknown_count; k++)
                sf_html_cell(&table, "%+.3f", fit->gradient[(fit->row[d] + kind) * fit->parameters + k]);
        }
}

static void put_curve(FILE *f, const sf_drop_fit *fit) {
    double low, high;
    sf_drop_informed_strains(fit, &low, &high);
    sf_html_heading(f, "Which strains the drops see");
    sf_html_note(f,
                 "Nine tenths of the information lie between strains of %.2f and %.2f. Outside, its form "
                 "and the priors determine the curve.",
                 low, high);
    SF_HTML_TABLE table = sf_html_table_begin(
        f, "strain|>part of the information|>standard deviation of the stress|>before the data");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        sf_html_row(&table);
        sf_html_line(&table, NULL, "%.2f to %.2f|%.1f %%|%.1f %%|%.0f %%", 0.05 * b, 0.05 * (b + 1),
                     100 * fit->information[b] / fmax(sf_drop_information(fit), 1e-300),
                     100 * expm1(fit->curve_sd[b]), 100 * expm1(fit->curve_prior_sd[b]));
    }
}

static sf_status write_report(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                              sf_error *err) {
    SF_PRINTED(title, 256, "Identification from drops: %s", fit->input->material_name);
    FILE *f = sf_html_begin(&study->output, title, study->input, err);
    SF_TRY(err->status);
    put_banner(f, fit);
    sf_chart_figure(f, &study->output, "fit", "softfall-fit",
                    "Identified curve with its 95 % band, information of the drops about it, and the drops");
    if (average)
        sf_inference_html(f, average, err);
    put_chain(f, fit);
    put_drops(f, fit);
    put_joint(f, fit);
    put_misfit(f, fit);
    put_speeds(f, fit);
    put_predictions(f, fit);
    put_parameters(f, fit);
    put_sensitivities(f, fit);
    put_curve(f, fit);
    return sf_html_end(f, study->command, "softfall-fit drop " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

/* ---- fit.json ---- */

/* A number of a drop under "STEMmiddleSUFFIX". */
static void json_stem(sf_json *j, const char *stem, const char *middle, const char *suffix, double value) {
    SF_PRINTED(key, 64, "%s%s%s", stem, middle, suffix);
    sf_json_number(j, key, value);
}

static void json_kind(sf_json *j, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const char *stem = about->stem, *suffix = about->suffix;
    double measured = fit->input->drop[d].value[kind], sd = fit->input->drop[d].sd[kind];
    json_stem(j, stem, "_measured", suffix, measured);
    json_stem(j, stem, "_measured_sd", "", isnan(measured) ? NAN : sd);
    json_stem(j, stem, "", suffix, sf_drop_response(fit, d, kind));
    json_stem(j, stem, "_sd_by_parameters", "", response_sd(fit, d, kind));
    if (kind == SF_FIT_A_MAX || kind == SF_FIT_HIC)
        json_stem(j, stem, "_scatter", "", sf_drop_fit_scatter(fit, d, kind));
    if (d < fit->measured_drops && fit->speed[d] >= 0)
        json_stem(j, stem, "_at_fitted_speed", suffix, fitted_response(fit, d, kind));
    json_stem(j, stem, "_from_others", suffix, exp(fit->without[fit->row[d] + kind]));
}

static void json_drops(sf_json *j, const sf_drop_fit *fit) {
    SF_JSON_ARRAY(j, "drops");
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        const sf_fit_simulated *simulated = &fit->simulated[d];
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "name", drop->name);
        sf_json_bool(j, "used", !drop->predicted);
        if (!drop->predicted && fit->speed[d] >= 0) {
            sf_json_number(j, "speed_fitted_m_s", drop->speed * exp(fit->result.u[fit->speed[d]]));
            sf_json_text(j, "figures_at", fit->speeds_fitted ? "fitted speed" : "given speed");
        }
        if (drop->number > 0)
            sf_json_number(j, "drop_of_series", drop->number);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            json_kind(j, fit, d, kind);
        SF_JSON_NUMBERS(j, {"curve_rmse_g", sf_drop_curve_rmse(fit, d)},
                        {"max_local_strain", simulated->max_local_strain},
                        {"energy_error", simulated->energy_error});
        SF_JSON_TEXTS(j, {"grade", sf_verdict_phrase(simulated->grade)}, {"verdict", simulated->verdict});
        if (*simulated->failure)
            sf_json_text(j, "failure", simulated->failure);
    }
}

static void json_joint(sf_json *j, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    sf_json_open(j, "compressions", '[');
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        SF_JSON_OBJECT(j, NULL);
        SF_JSON_TEXTS(j, {"name", test->name}, {"understood", test->interpretation});
        sf_json_number(j, "rate_1_s", test->rate);
        sf_json_bool(j, "below_rate_reference", is_below_reference(fit, test));
        SF_JSON_NUMBERS(j, {"points", test->count}, {"loading_rms", sf_joint_rms(test, false, y)},
                        {"unloading_rms", sf_joint_rms(test, true, y)});
    }
    sf_json_close(j);
    SF_JSON_ARRAY(j, "cushions");
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++) {
            SF_JSON_OBJECT(j, NULL);
            sf_json_text(j, "name", joint->cushion[c].name);
            SF_JSON_NUMBERS(j, {"static_stress_Pa", joint->cushion[c].static_stress[k]},
                            {"peak_measured_g", joint->cushion[c].peak_g[k]}, {"peak_g", exp(*y++)});
        }
}

static void json_parameters(sf_json *j, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    sf_json_open(j, "parameters", '[');
    for (int k = 0; k < in->unknown_count; k++) {
        sf_estimate_shown e = sf_drop_estimate(fit, k);
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "name", e.about->name);
        SF_JSON_NUMBERS(j, {"value_SI", e.value * e.per_unit}, {"low95_SI", e.low * e.per_unit},
                        {"high95_SI", e.high * e.per_unit}, {"prior_SI", in->prior[k]},
                        {"prior_sd_of_logarithm", in->prior_sd[k]},
                        {"sd_of_logarithm", sqrt(fit->result.covariance[k][k])});
    }
    sf_json_close(j);
    SF_JSON_ARRAY(j, "covariance_of_logarithms");
    for (int k = 0; k < in->unknown_count; k++) {
        SF_JSON_ARRAY(j, NULL);
        for (int i = 0; i < in->unknown_count; i++)
            sf_json_number(j, NULL, fit->result.covariance[k][i]);
    }
}

static sf_status write_json(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                            sf_error *err) {
    SF_JSON_FILE(j, &study->output, "fit.json", err);
    SF_JSON_TEXTS(&j, {"program", "softfall-fit drop " SF_VERSION " (" SF_GIT_REVISION ")"},
                  {"input", study->input}, {"input_text", fit->input->text});
    sf_json_bool(&j, "converged", fit->result.converged);
    if (fit->result.reason)
        sf_json_text(&j, "reason", fit->result.reason);
    SF_JSON_NUMBERS(&j, {"iterations", fit->result.iterations}, {"coarse_iterations", fit->coarse_iterations},
                    {"expected_gain", fit->result.gain}, {"misfit", fit->result.misfit},
                    {"degrees_of_freedom", fit->result.freedom}, {"sd_scale", fit->result.scale});
    json_parameters(&j, fit);
    json_joint(&j, fit);
    json_drops(&j, fit);
    if (average)
        sf_inference_json(&j, average, err);
    sf_json_close(&j);
    fputc('\n', j.file);
    return sf_staging_close(j.file, "fit.json", err);
}

sf_status sf_drop_report_write(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                               char *warning, size_t size, sf_error *err) {
    SF_TRY(sf_drop_files_write(fit, average, study, warning, size, err));
    SF_TRY(write_json(fit, average, study, err));
    if (average)
        SF_TRY(sf_inference_csv(average, &study->output, err));
    return write_report(fit, average, study, err);
}

/* ---- the terminal ---- */

static void print_response(FILE *f, const sf_drop_fit *fit, int d, int kind) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const sf_fit_drop *drop = &fit->input->drop[d];
    double value = sf_drop_response(fit, d, kind), width = 100 * half_width(fit, d, kind);
    if (isnan(value))
        fprintf(f, "  %s –", about->name);
    else
        fprintf(f, "  %s %.*f%s%s", about->name, about->digits + 1, value, *about->unit ? " " : "",
                about->unit);
    if (drop->predicted && isfinite(value * width))
        fprintf(f, " ± %.1f %% (95 %%, linearised)", width);
    if (!isnan(drop->value[kind]))
        fprintf(f, " (measured %.4g)", drop->value[kind]);
}

static void print_joint(FILE *f, const sf_drop_fit *fit) {
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

void sf_drop_report_print(const sf_drop_fit *fit, FILE *f) {
    double low, high;
    char end[512];
    sf_drop_informed_strains(fit, &low, &high);
    describe_end(fit, end, sizeof end);
    fprintf(f, "\n%s after %d iterations", fit->result.converged ? "Converged" : "NOT converged",
            fit->result.iterations);
    if (fit->coarse_iterations > 0)
        fprintf(f, " (and %d with coarse_set)", fit->coarse_iterations);
    fprintf(f, "; misfit %.2f with %.1f degrees of freedom%s\n", fit->result.misfit, fit->result.freedom,
            end);
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_drop_estimate(fit, k);
        fprintf(f, "  %-8s %10.4g %-5s 95 %% linearised: %.4g to %.4g  (%.0f %% of the prior's width)\n",
                e.about->name, e.value, e.about->unit, e.low, e.high, 100 * e.shrinkage);
    }
    sf_drop_chain_print(f, fit);
    for (int d = 0; d < fit->input->drop_count; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        fprintf(f, "  %-20s", drop->name);
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_drop_shows(fit, d, kind))
                print_response(f, fit, d, kind);
        fputs(drop->predicted ? "  predicted" : "", f);
        if (*fit->simulated[d].failure)
            fprintf(f, "  FAILED: %s", fit->simulated[d].failure);
        fputc('\n', f);
    }
    print_joint(f, fit);
    fprintf(f, "  the drops see the curve between strains of %.2f and %.2f\n", low, high);
}
