/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `softfall-fit compression`: its files and its words. */
#include "study/fit/compression/compression_command.h"

#include "build_info.h"
#include "material/low_density_foam.h"
#include "report/row.h"
#include "study/material_file.h"

static const double CARD_STEP = 5e-4; /* strain, of the check by the solver's law */
static const char *const outputs[] = {"fit.csv",        "loading_curve.csv", "fit.json",       "material.csv",
                                      "material-1.csv", "material-2.csv",    "material-3.csv", "material-4.csv",
                                      "material-5.csv", "material-6.csv",    "material-7.csv", "material-8.csv",
                                      "material.cfg",   NULL};
static const char *const rates[SF_RATE_MODELS] = {
    "none: one curve for all rates",
    "log: curve times 1 + c ln(rate/slowest rate), written as a curve for each rate",
    "maxwell: one curve and a Maxwell branch ED, BETA1",
    "curves: a curve of its own for each rate",
};
static const char *const rules[SF_RULES] = {
    "H1, exponent by A = 0: B/(1 - strain)^m",
    "H1, exponent free: A + B/(1 - strain)^m",
    "H2: A + B/(limit - strain)^m",
};
static const char *const rule_names[SF_RULES] = {"H1_automatic", "H1_free", "H2"};
static const char *const side_names[2] = {"loading", "unloading"};

/* ---- the card against the fit ---- */

/* The stress of the fit that counts in percentages: at least a hundredth of the test's largest. */
static double counted(const sf_compression_fit *fit, int i) {
    return fmax(fabs(fit->stress[i]), 0.01 * fit->data.config->test[fit->data.test[i]].largest_stress);
}

/* Returns the largest difference (%) of the card in the solver's own law from the fit. Of several temperatures
 * a test has the curve of its own alone. */
static double compare_card(const sf_compression_fit *fit, const sf_foam_card *whole, sf_error *err) {
    const sf_compression_data *d = &fit->data;
    double percent = 0;
    SF_OWNED double *stress = sf_alloc(err, d->count, sizeof *stress, "stresses of the card");
    for (int k = 0, first = 0; k < d->config->test_count && err->status == SF_OK; k++) {
        const sf_compression_test *t = &d->config->test[k];
        int64_t ptr[2] = {0, fit->table_count};
        sf_foam_card card = *whole;
        if (d->config->thermal) {
            card.curves.curve_points = fit->table_count;
            card.curves.curve_count = 1;
            card.curves.curve_ptr = ptr;
            card.curves.curve_strain += whole->curves.curve_ptr[k];
            card.curves.curve_stress += whole->curves.curve_ptr[k];
        }
        const sf_material material = sf_foam_material(&card);
        SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
        if (sf_material_law_build(&material, &law, err) != SF_OK)
            break;
        sf_material_point_drive(&law, t->rate, CARD_STEP, t->count, &d->strain[first], &stress[first]);
        for (int i = first; i < first + t->count; i++)
            percent = fmax(percent, 100 * fabs(stress[i] - fit->stress[i]) / counted(fit, i));
        first += t->count;
    }
    return percent;
}

/* ---- words ---- */

static const char *rate_words(const sf_compression_fit *fit) {
    return fit->data.config->thermal ? "none: a curve of its own for each temperature, at one rate"
                                     : rates[fit->model.form.rate];
}

static void put_estimates(FILE *out, const sf_compression_fit *fit) {
    for (const sf_estimate *e = fit->estimate; e < fit->estimate + SF_ESTIMATES; e++) {
        bool pressure = strcmp(e->unit, "Pa") == 0;
        double scale = pressure ? 1e-3 : 1;
        if (!e->present)
            continue;
        fprintf(out, "  %-12s %.5g%s%s", e->name, scale * e->value, *e->unit ? " " : "", pressure ? "kPa" : e->unit);
        if (isfinite(e->low))
            fprintf(out, ", %g %% interval %.5g to %.5g", 100 * fit->data.config->confidence, scale * e->low,
                    scale * e->high);
        fprintf(out, "%s%s\n", *e->note ? ", " : "", e->note);
    }
}

/* The lines of the summary and of the comments of material.cfg. */
static void describe(FILE *out, const sf_compression_fit *fit, double card_percent) {
    const sf_compression_config *c = fit->data.config;
    for (int k = 0; k < c->test_count; k++) {
        const sf_compression_test *t = &c->test[k];
        fprintf(out, "  %s at %.6g 1/s", t->path, t->rate);
        if (c->thermal)
            fprintf(out, " and %.4g degC", t->temperature - SF_CELSIUS);
        fprintf(out, ", to a strain of %.4g\n", t->largest_strain);
    }
    fprintf(out, "Rate dependence %s.\nDensification from the strain %.4g on by %s.\n", rate_words(fit),
            fit->data.start, rules[fit->model.form.rule]);
    put_estimates(out, fit);
    fprintf(out, "Scatter of the data: %.3g kPa and %.3g %% of the stress.\n",
            1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
    for (int k = 0; k < 2; k++)
        if (fit->side[k].points > 0)
            fprintf(out,
                    "%s: rms deviation %.3g %% of the stress, %.3g %% of the largest; misfit (1 is scatter "
                    "alone) %.3g.\n",
                    k ? "Unloading, given the loading" : "Loading", 100 * fit->side[k].relative,
                    100 * fit->side[k].of_largest, fit->side[k].misfit);
    fprintf(out,
            "In the solver's law the card differs from the fit by at most %.2g %%. Beyond the strain %.4g and "
            "outside these rates it is extrapolation.\n",
            card_percent, fit->data.end);
}

/* ---- files ---- */

static sf_status write_points(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    const sf_compression_data *d = &fit->data;
    SF_CSV_FILE(csv, output, "fit.csv", err);
    SF_CSV_PRINT_LINE(&csv, "test,branch,strain,measured_kPa,fit_kPa,sigma_kPa,deviation_over_sigma");
    for (int i = 0; i < d->count; i++) {
        sf_csv_print(&csv, "%d,%s", d->test[i] + 1, side_names[d->unloading[i]]);
        SF_CSV_NUMBERS(&csv, d->strain[i], 1e-3 * d->stress[i], 1e-3 * fit->stress[i], 1e-3 * d->sigma[i]);
        SF_CSV_PRINT_LINE(&csv, "%.6g", (d->stress[i] - fit->stress[i]) / d->sigma[i]);
    }
    return sf_csv_close(&csv, err);
}

static sf_status write_curves(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    bool thermal = fit->data.config->thermal;
    SF_CSV_FILE(csv, output, "loading_curve.csv", err);
    SF_CSV_PRINT_LINE(&csv, "# Loading curves of the fit with their %g %% intervals%s",
                      100 * fit->data.config->confidence, thermal ? "" : "; rate 0: one curve for all rates");
    SF_CSV_PRINT_LINE(&csv, "%s,strain,stress_kPa,low_kPa,high_kPa", thermal ? "temperature_K" : "rate_1_s");
    for (int r = 0; r < fit->rate_count; r++)
        for (int k = 0; k < fit->table_count; k++) {
            double stress = fit->table_stress[r][k], width = fit->quantile * fit->table_error[r][k];
            SF_CSV_LINE(&csv, sf_compression_curve_rate(fit, r), fit->table_strain[k], 1e-3 * stress,
                        1e-3 * fmax(0, stress - width), 1e-3 * (stress + width));
        }
    return sf_csv_close(&csv, err);
}

static void json_test(sf_json *json, const sf_compression_fit *fit, int k) {
    static const char *const keys[2][2] = {{"loading_rms_over_sigma", "loading_rms_percent"},
                                           {"unloading_rms_over_sigma", "unloading_rms_percent"}};
    const sf_compression_data *d = &fit->data;
    const sf_compression_test *t = &d->config->test[k];
    SF_JSON_OBJECT(json, NULL);
    SF_JSON_TEXTS(json, {"file", t->path}, {"understood", t->interpretation});
    SF_JSON_NUMBERS(json, {"toe_strain", t->toe}, {"rate_1_s", t->rate}, {"points_loading", t->loading},
                    {"points_unloading", t->count - t->loading}, {"largest_strain", t->largest_strain},
                    {"largest_stress_Pa", t->largest_stress});
    for (int side = 0; side < 2; side++) {
        int first, count;
        double sum = 0, relative = 0;
        sf_compression_branch(d, k, side == 1, &first, &count);
        for (int i = first; i < first + count; i++) {
            sum += pow((d->stress[i] - fit->stress[i]) / d->sigma[i], 2);
            relative += pow((d->stress[i] - fit->stress[i]) / counted(fit, i), 2);
        }
        sf_json_number(json, keys[side][0], count ? sqrt(sum / count) : NAN);
        sf_json_number(json, keys[side][1], count ? 100 * sqrt(relative / count) : NAN);
    }
    if (d->config->thermal)
        sf_json_number(json, "temperature_K", t->temperature);
}

static void json_candidates(sf_json *json, const char *key, int count, const char *const *names,
                            const sf_candidate *c) {
    SF_JSON_OBJECT(json, key);
    for (int k = 0; k < count; k++)
        if (c[k].tried) {
            SF_JSON_OBJECT(json, names[k]);
            SF_JSON_NUMBERS(json, {"parameters", c[k].parameters}, {"chi2", c[k].chi2}, {"bic", c[k].bic});
        }
}

static void json_estimates(sf_json *json, const sf_compression_fit *fit) {
    SF_JSON_OBJECT(json, "parameters");
    for (const sf_estimate *e = fit->estimate; e < fit->estimate + SF_ESTIMATES; e++) {
        if (!e->present)
            continue;
        SF_JSON_OBJECT(json, e->key);
        SF_JSON_NUMBERS(json, {"value", e->value}, {"standard_error", e->error}, {"low", e->low},
                        {"high", e->high});
        sf_json_text(json, "note", *e->note ? e->note : NULL);
    }
}

static sf_status write_json(const sf_staging *output, const sf_compression_fit *fit, const char *path,
                            double card_percent, sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    const sf_side *side = fit->side;
    SF_JSON_FILE(file, output, "fit.json", err);
    sf_json *json = &file;
    SF_JSON_TEXTS(json, {"program", "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")"},
                  {"input", path}, {"name", c->name});
    sf_json_open(json, "tests", '[');
    for (int k = 0; k < c->test_count; k++)
        json_test(json, fit, k);
    sf_json_close(json);
    sf_json_text(json, "rate_model", c->thermal ? "none" : sf_rate_model_names[fit->model.form.rate]);
    json_candidates(json, "rate_models_tried", SF_RATE_MODELS, sf_rate_model_names, fit->rate);
    sf_json_text(json, "densification", rule_names[fit->model.form.rule]);
    json_candidates(json, "densifications_tried", SF_RULES, rule_names, fit->rule);
    sf_json_number(json, "densification_start", fit->data.start);
    json_estimates(json, fit);
    SF_JSON_NUMBERS(json, {"confidence", c->confidence}, {"points", fit->data.count},
                    {"fitted_parameters", fit->model.parameter_count},
                    {"spline_coefficients", fit->model.spline.count - 1},
                    {"scatter_absolute_Pa", fit->data.scatter.absolute},
                    {"scatter_relative", fit->data.scatter.relative}, {"chi2", fit->chi2},
                    {"misfit", fit->misfit}, {"misfit_loading", side[0].misfit},
                    {"misfit_unloading", side[1].misfit}, {"loading_rms_of_largest", side[0].of_largest},
                    {"unloading_rms_of_largest", side[1].of_largest},
                    {"neighbour_correlation", side[0].correlation},
                    {"variance_factor_for_correlation", side[0].serial},
                    {"card_difference_percent", card_percent});
    sf_json_close(json);
    return sf_staging_close(file.file, "fit.json", err);
}

static sf_status write_all(const sf_compression_fit *fit, const char *path, sf_staging *output, FILE *log,
                           sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    SF_TRY(sf_compression_card(fit, &card, err));
    double percent = compare_card(fit, &card, err);
    SF_OWNED SF_TEXT_STREAM(out, text, size);
    if (out) {
        fputs("Identified by softfall-fit compression from\n", out);
        describe(out, fit, percent);
    }
    if (!out || fclose(out) != 0)
        return SF_NO_MEMORY(err, "the comments of the material file");
    SF_TRY(err->status);
    SF_TRY(write_points(output, fit, err));
    SF_TRY(write_curves(output, fit, err));
    SF_TRY(write_json(output, fit, path, percent, err));
    const sf_material_text comments = {.title = c->name, .provenance = text, .temperatures = c->thermal};
    const sf_material material = sf_foam_material(&card);
    SF_TRY(sf_material_write_checked(output->aside, "material", &material, &comments, err));
    if (log)
        fprintf(log, "%s: %d test%s, %d points\n%s", c->name, c->test_count, c->test_count > 1 ? "s" : "",
                fit->data.count, strchr(text, '\n') + 1);
    return SF_OK;
}

sf_status sf_compression_command(const char *path, const char *directory, bool force, FILE *log,
                                 const sf_sink *sink, sf_error *err) {
    SF_OWNED_BY(sf_compression_config_free) sf_compression_config config = {0};
    SF_OWNED_BY(sf_compression_fit_free) sf_compression_fit fit = {0};
    sf_staging output = {0};
    SF_TRY(sf_compression_config_read(path, &config, err));
    SF_TRY(sf_staging_check(directory, outputs, force, err));
    for (int k = 0; k < config.test_count && log; k++)
        fprintf(log, "test %s: %s\n", config.test[k].path, config.test[k].interpretation);
    SF_TRY(sf_compression_fit_run(&config, &fit, err));
    if (sf_staging_begin(directory, outputs, force, &output, err) == SF_OK &&
        write_all(&fit, path, &output, log, err) == SF_OK)
        sf_staging_commit(&output, err);
    sf_staging_end(&output);
    for (int k = 0; k < 2 && sink && err->status == SF_OK; k++)
        if (fit.side[k].points > 0 && fit.side[k].misfit > 2)
            sf_sink_tell(sink, SF_WARNING,
                         "the law misses the %s by %.3g times its scatter, %.3g %% of the largest stress; the "
                         "intervals are widened by as much",
                         side_names[k], sqrt(fit.side[k].misfit), 100 * fit.side[k].of_largest);
    return err->status;
}
