/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the tables: a spline with rate terms and a densification law; its files and words. */
#include "study/fit/compression/compression_kind.h"
#include "study/fit/compression/table_report.h"

#include "build_info.h"
#include "io/folder.h"
#include "material/low_density_foam.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static void describe(FILE *out, const void *place, bool comments) {
    const sf_table_result *r = place;
    const sf_compression_fit *fit = &r->fit;
    const char *rate = sf_table_rate_phrase(fit->model.form.rate),
               *rule = sf_table_rule_phrase(fit->model.form.rule);
    if (!comments) {
        fprintf(out, "  rate dependence  %s\n  densification    %s, from strain %.4g\n", rate, rule,
                fit->data.start);
        put_estimates(out, fit);
        fprintf(
            out,
            "  scatter of the data: %.3g kPa and %.3g %% of the stress; misfit (1 is scatter alone) %.3g\n"
            "  card in the solver's law against the fit: largest difference %.2g %%\n",
            1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative, fit->misfit,
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
    if (fit->misfit > 2)
        sf_sink_tell(
            sink, SF_WARNING,
            "the law misses the data by %.3g times their scatter (fit.png, lower panel); the intervals "
            "are widened by as much",
            sqrt(fit->misfit));
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
    return sf_table_report_write(output, r, job->path, job->command, warning, size, err);
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
    static const char *const names[SF_ESTIMATES] = {"E_Pa",  "HU",        "SHAPE",    "log_rate_c",
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

static const sf_row quality_rows[] = {
    {.key = "confidence", .value = confidence_of},
    {.key = "points", SF_ROW_OF(INTEGER, sf_table_result, fit.data.count)},
    {.key = "fitted_parameters", SF_ROW_OF(INTEGER, sf_table_result, fit.model.parameter_count)},
    {.key = "spline_coefficients", .value = coefficients_of},
    {.key = "scatter_absolute_Pa", SF_ROW_OF(NUMBER, sf_table_result, fit.data.scatter.absolute)},
    {.key = "scatter_relative", SF_ROW_OF(NUMBER, sf_table_result, fit.data.scatter.relative)},
    {.key = "chi2", SF_ROW_OF(NUMBER, sf_table_result, fit.chi2)},
    {.key = "misfit", SF_ROW_OF(NUMBER, sf_table_result, fit.misfit)},
    {.key = "neighbour_correlation", SF_ROW_OF(NUMBER, sf_table_result, fit.correlation)},
    {.key = "variance_factor_for_correlation", SF_ROW_OF(NUMBER, sf_table_result, fit.serial)},
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
