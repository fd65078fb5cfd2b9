/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the tables, a spline with rate terms and a densification law: its files and words. */
#include "study/fit/compression/table_fit.h"

#include "build_info.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "material/low_density_foam.h"
#include "io/replace.h"
#include "study/material_file.h"
#include "study/setup.h"
#include <errno.h>

static const double CARD_STEP = 5e-4; /* strain, of the check by the solver's law */

/* ---- the fit against the data, and the card against the fit ---- */

static double counted(const sf_compression_fit *fit, int i) {
    const sf_compression_test *t = &fit->data.config->test[fit->data.test[i]];
    return fmax(fabs(fit->stress[i]), 0.01 * t->largest_stress);
}

static void compare_test(const sf_compression_fit *fit, int k, sf_table_test *out) {
    const sf_compression_data *d = &fit->data;
    const sf_compression_test *t = &d->config->test[k];
    *out = (sf_table_test){.test = *t, .name = sf_path_name(t->path), .unloading = t->count - t->loading};
    for (int side = 0; side < 2; side++) {
        int first, count;
        double sum = 0, relative = 0;
        sf_compression_branch(d, k, side == 1, &first, &count);
        for (int i = first; i < first + count; i++) {
            double deviation = d->stress[i] - fit->stress[i];
            sum += pow(deviation / d->sigma[i], 2);
            relative += pow(deviation / counted(fit, i), 2);
        }
        out->rms[side] = count ? sqrt(sum / count) : NAN;
        out->percent[side] = count ? 100 * sqrt(relative / count) : NAN;
    }
}

/* The card for test k: of several temperatures the curve of its own alone, whose ends go to `ptr`. */
static sf_foam_card card_of_test(const sf_table_result *r, int k, int64_t ptr[2]) {
    sf_foam_card card = r->card;
    if (!r->fit.data.config->thermal)
        return card;
    int64_t first = card.curve_ptr[k];
    ptr[0] = 0;
    ptr[1] = card.curve_points = card.curve_ptr[k + 1] - first;
    card.curve_count = 1;
    card.curve_ptr = ptr;
    card.curve_strain += first;
    card.curve_stress += first;
    return card;
}

static sf_status compare_card(sf_table_result *r, sf_error *err) {
    const sf_compression_data *d = &r->fit.data;
    SF_OWN(double, stress, d->count, "stresses of the card", err);
    for (int k = 0, first = 0; k < d->config->test_count; k++) {
        const sf_compression_test *t = &d->config->test[k];
        int64_t ptr[2];
        sf_foam_card card = card_of_test(r, k, ptr);
        const sf_material material = sf_foam_material(&card);
        SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
        SF_TRY(sf_material_law_build(&material, &law, err));
        sf_material_point_drive(&law, t->rate, CARD_STEP, t->count, &d->strain[first], &stress[first]);
        for (int i = first; i < first + t->count; i++)
            r->card_percent =
                fmax(r->card_percent, 100 * fabs(stress[i] - r->fit.stress[i]) / counted(&r->fit, i));
        first += t->count;
    }
    return SF_OK;
}

static const char *const outputs[] = {"simulation.csv", "fit.csv",        "loading_curve.csv",
                                      "fit.gp",         "fit.png",        "fit.json",
                                      "report.html",    "material.csv",   "material-1.csv",
                                      "material-2.csv", "material-3.csv", "material-4.csv",
                                      "material-5.csv", "material-6.csv", "material-7.csv",
                                      "material-8.csv", "material.cfg",   NULL};

static sf_material material_of(const void *place) {
    return sf_foam_material(&((const sf_table_result *)place)->card);
}

/* Fits, builds the card and compares. */
static sf_status run(const sf_compression_config *config, void *place, sf_error *err) {
    sf_table_result *r = place;
    SF_TRY(sf_compression_fit_run(config, &r->fit, err));
    r->test_count = config->test_count;
    for (int k = 0; k < r->test_count; k++)
        compare_test(&r->fit, k, &r->test[k]);
    SF_TRY(sf_compression_card(&r->fit, &r->card, err));
    return compare_card(r, err);
}

static void release(void *place) {
    sf_table_result *r = place;
    sf_compression_fit_free(&r->fit);
    sf_foam_card_free(&r->card);
}

/* ---- words ---- */

static void put_estimates(FILE *out, const sf_compression_fit *fit) {
    for (const sf_estimate *e = fit->estimate; e < fit->estimate + SF_ESTIMATES; e++) {
        sf_table_estimate shown = sf_table_estimate_of(e);
        if (!e->present)
            continue;
        fprintf(out, "  %-12s %-12s", e->name, shown.value);
        if (*shown.interval)
            fprintf(out, " %g %% interval %s", 100 * fit->data.config->confidence, shown.interval);
        fprintf(out, "%s%s\n", *e->note ? "  " : "", e->note);
    }
}

static void describe(FILE *out, const void *place, bool comments) {
    const sf_table_result *r = place;
    const sf_compression_fit *fit = &r->fit;
    bool thermal = fit->data.config->thermal;
    const char *rate = sf_table_rate_words(fit), *rule = sf_table_rules[fit->model.form.rule];
    char misfit[160];
    if (!comments) {
        fprintf(out, "%s: %d test%s, %d points, strain to %.4g\n", fit->data.config->name, r->test_count,
                r->test_count > 1 ? "s" : "", fit->data.count, fit->data.end);
        fprintf(out, "  rate dependence  %s\n  densification    %s, from strain %.4g\n", rate, rule,
                fit->data.start);
        put_estimates(out, fit);
        fprintf(out, "  scatter of the data: %.3g kPa and %.3g %% of the stress\n",
                1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative);
        for (int k = 0; k < 2; k++)
            if (fit->side[k].points > 0)
                fprintf(out, "  %s: %s\n", k ? "unloading, given the loading" : "loading",
                        sf_table_misfit(&fit->side[k], misfit));
        for (int k = 0; k < r->test_count && thermal; k++) {
            fprintf(out, "  %.4g degC (%s): deviation %.3g %% of the stress in loading",
                    r->test[k].test.temperature - SF_CELSIUS, r->test[k].name, r->test[k].percent[0]);
            if (isfinite(r->test[k].percent[1]))
                fprintf(out, ", %.3g %% in unloading", r->test[k].percent[1]);
            fputc('\n', out);
        }
        fprintf(out, "  card in the solver's law against the fit: largest difference %.2g %%\n",
                r->card_percent);
        return;
    }
    fputs(" from\n", out);
    for (int k = 0; k < r->test_count; k++) {
        const sf_compression_test *t = &r->test[k].test;
        fprintf(out, "  %s at %.6g 1/s", t->path, t->rate);
        if (thermal)
            fprintf(out, " and %.4g degC", t->temperature - SF_CELSIUS);
        fprintf(out, ", to a strain of %.4g\n", t->largest_strain);
    }
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
            sf_sink_tell(sink, SF_WARNING,
                         "the law misses the %s by %.3g times its scatter (fit.png, lower panel), %.3g %% of "
                         "the largest stress; the intervals are widened by as much",
                         sides[k], sqrt(fit->side[k].misfit), 100 * fit->side[k].of_largest);
}

/* ---- files ---- */

static void put_points(sf_csv *csv, const void *place) {
    const sf_compression_fit *fit = &((const sf_table_result *)place)->fit;
    const sf_compression_data *d = &fit->data;
    SF_CSV_PRINT_LINE(csv, "test,branch,strain,measured_kPa,fit_kPa,sigma_kPa,deviation_over_sigma");
    for (int i = 0; i < d->count; i++) {
        sf_csv_print(csv, "%d,%s", d->test[i] + 1, d->unloading[i] ? "unloading" : "loading");
        SF_CSV_NUMBERS(csv, d->strain[i], 1e-3 * d->stress[i], 1e-3 * fit->stress[i], 1e-3 * d->sigma[i]);
        SF_CSV_PRINT_LINE(csv, "%.6g", (d->stress[i] - fit->stress[i]) / d->sigma[i]);
    }
}

static sf_status write_curves(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    const sf_compression_test *test = fit->data.config->test;
    bool thermal = fit->data.config->thermal;
    SF_CSV_FILE(csv, output, "loading_curve.csv", err);
    SF_CSV_PRINT_LINE(&csv, "# Loading curves of the fit with their %g %% intervals%s",
                      100 * fit->data.config->confidence, thermal ? "" : "; rate 0: one curve for all rates");
    SF_CSV_PRINT_LINE(&csv, "%s,strain,stress_kPa,low_kPa,high_kPa", thermal ? "temperature_K" : "rate_1_s");
    for (int r = 0; r < fit->rate_count; r++)
        for (int k = 0; k < fit->table_count; k++) {
            double stress = fit->table_stress[r][k], width = fit->quantile * fit->table_error[r][k];
            double at = thermal ? test[r].temperature : fit->rate_count > 1 ? test[r].rate : 0;
            SF_CSV_LINE(&csv, at, fit->table_strain[k], 1e-3 * stress, 1e-3 * fmax(0, stress - width),
                        1e-3 * (stress + width));
        }
    return sf_csv_close(&csv, err);
}

/* ---- the simulated test: a foam cube between platens (softfall-pre, softfall-solve) against the material
 * point. A laboratory test of minutes is simulated faster by a factor k with everything that depends on the
 * rate scaled by k; the remaining inertia is small ---- */

static const double SIMULATED_RATE =
    2; /* s-1: inertia below a thousandth of the largest stress, seconds of CPU */
static const double SIMULATED_DAMP = 0.35; /* stills the vibrations of the start; adds less than inertia */
static const double POINT_STEP = 5e-4;     /* strain */

enum {
    TEXT = PATH_MAX + 64,
    CELLS = 6,
    BLOCKS = 160
}; /* cells along an edge: the law has no Poisson effect; blocks of a
       branch */

/* The same foam in a time that runs k times faster. The filter of the rate, which a test of seconds or
 * minutes does not notice, stays: without it every vibration of the cube would choose among the curves. */
static sf_foam_card quicken(const sf_foam_card *card, double k, double *rates) {
    sf_foam_card fast = *card;
    for (int64_t r = 0; r < card->curve_count; r++)
        rates[r] = k * card->curve_rate[r];
    fast.curve_rate = rates;
    fast.maxwell_rate = k * card->maxwell_rate;
    fast.kelvin_viscosity = card->kelvin_viscosity / k;
    fast.damp = fmax(card->damp, SIMULATED_DAMP);
    fast.informed_strain = 0;
    return fast;
}

static sf_status write_motion(const char *path, double displacement, double turn_time, sf_error *err) {
    sf_replacement out;
    FILE *file = sf_replace_open(path, &out, err);
    SF_TRY(err->status);
    fprintf(file, "time_s,displacement_m\n0,0\n%.12g,%.12g\n%.12g,0\n", turn_time, displacement,
            2 * turn_time);
    return sf_replace_close(&out, err);
}

static sf_status check_specimen(const sf_compression_config *c, sf_error *err) {
    bool square =
        !(c->specimen.width > 0) || fabs(c->specimen.width - c->specimen.side) <= 1e-9 * c->specimen.side;
    if (!(square && c->specimen.side > 0 &&
          fabs(c->specimen.side - c->specimen.thickness) <= 1e-9 * c->specimen.side))
        return SF_REFUSE(err,
                         "the simulated specimen is a cube: give specimen = { side = \"50 mm\"; thickness = "
                         "\"50 mm\"; } with equal lengths (they are %g mm and %g mm)",
                         1e3 * c->specimen.side, 1e3 * c->specimen.thickness);
    return SF_OK;
}

/* One simulated test, as means over blocks of equal time. */
typedef struct cube_test {
    int count;
    double strain[2 * BLOCKS]; /* - */
    double cube[2 * BLOCKS];   /* Pa, contact force over mean cross-section */
    double point[2 * BLOCKS];  /* Pa, material point at the same strains and the laboratory's rate */
} cube_test;

/* Means of strain and stress over blocks of equal time; blocks do not cross the turn. */
static void average_blocks(const sf_results *r, double area, double turn_time, cube_test *test) {
    const double *time = r->history.time;
    int64_t row = 1;
    test->count = 0;
    for (int b = 0; b < 2 * BLOCKS; b++) {
        double end = turn_time * (b + 1) / BLOCKS, strain = 0, stress = 0, weight = 0;
        for (; row < r->history.rows && time[row] <= end * (1 + 1e-9); row++) {
            double span = time[row] - time[row - 1];
            strain += span * r->history.indentation[row] / r->thickness;
            stress += span * r->history.contact_force[row] / area;
            weight += span;
        }
        if (!(weight > 0))
            continue;
        test->strain[test->count] = strain / weight;
        test->cube[test->count++] = stress / weight;
    }
}

/* The material point goes through the same strains, and through the turn between them. */
static sf_status compare_cube(const sf_foam_card *card, sf_table_test *out, cube_test *test, sf_error *err) {
    double strain[2 * BLOCKS + 1], stress[2 * BLOCKS + 1], largest = 0;
    int loading = test->count < BLOCKS ? test->count : BLOCKS;
    sf_foam_card point = *card;
    const sf_material material = sf_foam_material(&point);
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    point.damp = 0;
    SF_TRY(sf_material_law_build(&material, &law, err));
    memcpy(strain, test->strain, (size_t)loading * sizeof *strain);
    strain[loading] = out->test.largest_strain;
    memcpy(&strain[loading + 1], &test->strain[loading], (size_t)(test->count - loading) * sizeof *strain);
    sf_material_point_drive(&law, out->test.rate, POINT_STEP, test->count + 1, strain, stress);
    for (int i = 0; i < test->count; i++) {
        test->point[i] = stress[i < loading ? i : i + 1];
        largest = fmax(largest, test->point[i]);
    }
    for (int i = 0; i < test->count; i++) {
        double *percent = &out->difference[i >= loading];
        *percent =
            fmax(*percent, 100 * fabs(test->cube[i] - test->point[i]) / fmax(test->point[i], 0.01 * largest));
    }
    return SF_OK;
}

static sf_status simulate(sf_table_result *r, const sf_compression_job *job, const char *folder, int index,
                          cube_test *cube, sf_error *err) {
    static const sf_material_text text = {
        .title = "The fitted foam in a time that runs faster: for the simulated test only", .provenance = ""};
    const sf_compression_config *c = r->fit.data.config;
    sf_table_test *test = &r->test[index];
    const sf_compression_test *lab = &test->test;
    double rates[SF_COMPRESSION_TESTS], turn_time = lab->largest_strain / SIMULATED_RATE;
    char real[PATH_MAX], friction[64];
    test->speed_up = SIMULATED_RATE / lab->rate;
    const sf_foam_card fast = quicken(&r->card, test->speed_up, rates);
    const sf_material quick = sf_foam_material(&fast);
    if (!realpath(folder, real))
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be found: %s", folder, strerror(errno));
    SF_PRINTED(name, 32, "test-%d", index + 1);
    SF_PRINTED(motion, TEXT, "%s/%s-motion.csv", real, name);
    SF_PRINTED(material, TEXT, "%s/%s.cfg", real, name);
    SF_PRINTED(moved, TEXT + 32, "missile.motion=%s", motion);
    SF_PRINTED(side, 64, "geometry.parameters.side=%.12g", 1e3 * c->specimen.side);
    SF_PRINTED(spacing, 64, "geometry.parameters.spacing=%.12g", 1e3 * c->specimen.side / CELLS);
    SF_PRINTED(end, 64, "solver.end_time=%.12g s", 2 * turn_time);
    sf_runner runner = {.folder = real, .threads = 1};
    sf_runner_drop drop = {.label = name,
                           .case_path = job->case_path,
                           .material = material,
                           .override_count = 4,
                           .overrides = {moved, side, spacing, end}};
    if (job->friction) {
        snprintf(friction, sizeof friction, "missile.friction=%s", job->friction);
        drop.overrides[drop.override_count++] = friction;
    }
    SF_OWNED_BY(sf_runner_result_free) sf_runner_result result = {0};
    SF_TRY(write_motion(motion, lab->largest_strain * c->specimen.side, turn_time, err));
    SF_TRY(sf_material_write(real, name, &quick, &text, err));
    SF_TRY(sf_runner_run(&runner, &drop, &result, err));
    test->energy_error = result.energy_error;
    SF_OWNED_BY(sf_results_close) sf_results results = {0};
    SF_TRY(sf_results_open(result.path, &results, err));
    average_blocks(&results, sf_results_cross_section(&results), turn_time, cube);
    return compare_cube(&r->card, test, cube, err);
}

/* Simulates the tests in DIR/simulation, which stays, and writes the curves. */
static sf_status write_simulation(const sf_compression_job *job, sf_table_result *r, sf_error *err) {
    const sf_staging *output = &job->study->output;
    cube_test cube;
    if (!job->case_path)
        return SF_OK;
    SF_PRINTED(folder, PATH_MAX, "%s/simulation", output->directory);
    SF_TRY(sf_folder_own(folder, err));
    SF_TRY(check_specimen(r->fit.data.config, err));
    SF_CSV_FILE(csv, output, "simulation.csv", err);
    SF_CSV_PRINT_LINE(&csv, "test,strain,cube_kPa,point_kPa");
    for (int k = 0; k < r->test_count && simulate(r, job, folder, k, &cube, err) == SF_OK; k++) {
        const sf_table_test *test = &r->test[k];
        for (int i = 0; i < cube.count; i++)
            SF_CSV_LINE(&csv, k + 1, cube.strain[i], 1e-3 * cube.cube[i], 1e-3 * cube.point[i]);
        printf("simulated cube against material point, %.4g 1/s: largest difference %.2g %% loading, %.2g "
               "%% unloading\n",
               test->test.rate, test->difference[0], test->difference[1]);
        fflush(stdout);
    }
    r->simulated = true;
    sf_csv_close(&csv, err);
    return err->status;
}

static sf_status write_more(const sf_compression_job *job, void *place, char *warning, size_t size,
                            sf_error *err) {
    sf_table_result *r = place;
    SF_TRY(write_curves(&job->study->output, &r->fit, err));
    SF_TRY(write_simulation(job, r, err));
    return sf_table_report_write(job->study, r, warning, size, err);
}

/* ---- fit.json ---- */

static void json_candidate(sf_json *json, const char *name, const sf_candidate *c) {
    if (!c->tried)
        return;
    SF_JSON_OBJECT(json, name);
    SF_JSON_NUMBERS(json, {"parameters", c->parameters}, {"chi2", c->chi2}, {"bic", c->bic});
}

static void json_choice(sf_json *json, const sf_compression_fit *fit) {
    static const char *const rules[SF_RULES] = {"H1_automatic", "H1_free", "H2"};
    sf_json_text(json, "rate_model",
                 fit->data.config->thermal ? "none" : sf_rate_model_names[fit->model.form.rate]);
    sf_json_open(json, "rate_models_tried", '{');
    for (int k = 0; k < SF_RATE_MODELS; k++)
        json_candidate(json, sf_rate_model_names[k], &fit->rate[k]);
    sf_json_close(json);
    sf_json_text(json, "densification", rules[fit->model.form.rule]);
    sf_json_open(json, "densifications_tried", '{');
    for (int k = 0; k < SF_RULES; k++)
        json_candidate(json, rules[k], &fit->rule[k]);
    sf_json_close(json);
    sf_json_number(json, "densification_start", fit->data.start);
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

static void put_json(sf_json *json, const void *place, const char *path) {
    const sf_table_result *r = place;
    SF_JSON_TEXTS(json, {"program", "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")"},
                  {"input", path}, {"name", r->fit.data.config->name});
    sf_rows_json_array(json, "tests", sf_table_test_rows(r),
                       (sf_records){r->test, sizeof r->test[0], r->test_count});
    json_choice(json, &r->fit);
    json_estimates(json, &r->fit);
    const sf_compression_fit *fit = &r->fit;
    const sf_side *side = fit->side;
    SF_JSON_NUMBERS(
        json, {"confidence", fit->data.config->confidence}, {"points", fit->data.count},
        {"fitted_parameters", fit->model.parameter_count},
        {"spline_coefficients", fit->model.spline.count - 1},
        {"scatter_absolute_Pa", fit->data.scatter.absolute}, {"scatter_relative", fit->data.scatter.relative},
        {"chi2", fit->chi2}, {"misfit", fit->misfit}, {"misfit_loading", side[0].misfit},
        {"misfit_unloading", side[1].misfit}, {"loading_rms_of_largest", side[0].of_largest},
        {"unloading_rms_of_largest", side[1].of_largest}, {"neighbour_correlation", side[0].correlation},
        {"variance_factor_for_correlation", side[0].serial}, {"card_difference_percent", r->card_percent});
    sf_rows_json_array(json, "simulation", sf_table_simulation_rows,
                       (sf_records){r->test, sizeof r->test[0], r->simulated ? r->test_count : 0});
}

const sf_compression_kind sf_compression_tables = {
    .files = "material.cfg and its curves, report.html, fit.png, fit.json, fit.csv, loading_curve.csv",
    .size = sizeof(sf_table_result),
    .free = release,
    .more = write_more,
    SF_COMPRESSION_PARTS};
