/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_fit.h"

#include "study/material_file.h"
#include "io/process.h"
#include "material/low_density_foam.h"

enum { SPEED_TEXT = 64 };
enum { MAX_ITERATIONS = 60, EXACT_ITERATIONS = 100 /* of a fit without simulations */ };
static const double TOLERANCE = 0.1; /* of a standard deviation: the last step */
_Static_assert(SF_MAPPING_MAX_PARAMETERS >= SF_FIT_MAX_UNKNOWNS + SF_SIGNAL_CHAIN + SF_FIT_MAX_DROPS,
               "the unknown parameters, the chain and the speed of every drop");

static sf_status surrogate(void *context, const double *u, double *y, sf_error *err) {
    const sf_drop_fit *fit = context;
    return sf_drop_fit_columns(fit, 0, fit->measured_drops, SF_FIT_AS_GIVEN, u, y, err);
}

/* ---- simulation ---- */

static sf_status find_columns(const char *path, const sf_fit_drop *drop, sf_columns *columns, sf_error *err) {
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    SF_TRY(sf_results_open(path, &r, err));
    SF_TRY(sf_columns_build(&r, columns, err));
    columns->before = drop->number > 0 ? drop->number - 1 : 0;
    memcpy(columns->pause, drop->pause, sizeof columns->pause);
    return SF_OK;
}

/* Checks that a coarse drop is the same as the drop but for the mesh, since its result is used for the
 * drop. */
static sf_status check_coarse(const sf_fit_drop *drop, const sf_columns *a, const sf_columns *b,
                              sf_error *err) {
    static const double SLACK = 0.01; /* a coarse surface of the missile begins a little elsewhere */
    if (fabs(a->thickness / b->thickness - 1) < SLACK && fabs(a->mass / b->mass - 1) < SLACK &&
        fabs(a->speed / b->speed - 1) < SLACK)
        return SF_OK;
    return SF_REFUSE(
        err,
        "coarse_set makes another drop of %s: %.4g mm thick, %.4g kg and %.4g m/s, in place of %.4g "
        "mm, %.4g kg and %.4g m/s; it is for a coarser mesh of the same drop",
        drop->name, 1e3 * a->thickness, a->mass, a->speed, 1e3 * b->thickness, b->mass, b->speed);
}

/* Finds the columns of the first simulation; after coarse ones once more. */
static sf_status find_own_columns(sf_drop_fit *fit, int d, const char *path, sf_error *err) {
    const sf_columns before = fit->columns[d];
    bool replaced = fit->borrowed[d] && !fit->coarse;
    if (before.count > 0 && !replaced)
        return SF_OK;
    fit->borrowed[d] = fit->coarse;
    SF_TRY(find_columns(path, &fit->input->drop[d], &fit->columns[d], err));
    if (fit->speed_now[d] > 0)
        fit->columns[d].speed /= fit->speed_now[d];
    if (replaced)
        check_coarse(&fit->input->drop[d], &before, &fit->columns[d], err);
    return err->status;
}

/* Responses of a simulated drop; takes its curve. */
static sf_status take_drop(sf_drop_fit *fit, int d, sf_runner_result *result, double *y, sf_error *err) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    if (result->grade == SF_GRADE_DO_NOT_USE && !drop->predicted)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the fit does not go through the drop %s: %.800s", drop->name,
                       result->verdict);
    sf_fit_simulated *last = &fit->simulated[d];
    SF_TRY(find_own_columns(fit, d, result->path, err));
    const sf_columns_figures figures = {.a_max_g = result->a_max_g,
                                        .hic = result->hic,
                                        .hic_window = result->hic_window,
                                        .v_rebound = result->v_rebound,
                                        .contact_time = result->contact_time,
                                        .strain = result->max_indentation / fit->columns[d].thickness};
    sf_drop_fit_read(drop, &fit->chain_now, &figures, &result->curve, "its simulation ends",
                     "raise solver.end_time of its case", &y[fit->row[d]], err);
    sf_series_free(&last->curve);
    *last = (sf_fit_simulated){
        .max_local_strain = result->max_local_strain,
        .energy_error = result->energy_error,
        .scatter = {sf_runner_figure(result, "a_max_scatter"), sf_runner_figure(result, "hic_scatter")},
        .grade = result->grade,
        .figures = figures,
        .curve = result->curve};
    snprintf(last->verdict, sizeof last->verdict, "%s", result->verdict);
    result->curve = (sf_series){0};
    return err->status;
}

/* The columns of a drop whose simulation failed: of its first instants, as they are in every simulation. */
static void find_columns_early(sf_drop_fit *fit, int d, const char *material) {
    sf_runner_drop request = {.label = fit->input->drop[d].name,
                              .case_path = fit->input->drop[d].case_path,
                              .material = material,
                              .override_count = 2,
                              .overrides = {"solver.end_time=2 ms", "series.drops=1"}};
    sf_runner quiet = *fit->runner;
    SF_OWNED_BY(sf_runner_result_free) sf_runner_result result = {0};
    sf_error none = SF_ERROR_INIT;
    quiet.log = NULL;
    if (sf_runner_run(&quiet, &request, &result, &none) == SF_OK)
        find_columns(result.path, &fit->input->drop[d], &fit->columns[d], &none);
}

/* A predicted drop without a figure, and why. */
static void mark_failure(sf_drop_fit *fit, int d, const char *sentence, const char *material, double *y) {
    sf_fit_simulated *s = &fit->simulated[d];
    if (!sf_process_stopped() && fit->columns[d].count == 0)
        find_columns_early(fit, d, material);
    if (s->curve.count == 0) /* it did not end */
        *s = (sf_fit_simulated){.max_local_strain = NAN,
                                .energy_error = NAN,
                                .scatter = {NAN, NAN},
                                .grade = SF_GRADE_DO_NOT_USE};
    s->scatter[0] = s->scatter[1] = NAN;
    snprintf(s->failure, sizeof s->failure, "%s", sentence);
    if (!*s->verdict)
        snprintf(s->verdict, sizeof s->verdict, "%.400s", sentence);
    for (int k = fit->row[d]; k < fit->row[d + 1]; k++)
        y[k] = NAN;
    sf_log_print(fit->log, "  %-24s no prediction by simulation: %s\n", fit->input->drop[d].name, sentence);
}

/* The drops of a series are simulated once, in one folder: that of its first entry. */
static const char *label_of(const sf_fit_input *in, int d) {
    int k = 0;
    while (k < d && !(in->drop[k].number > 0 && strcmp(in->drop[k].case_path, in->drop[d].case_path) == 0))
        k++;
    return in->drop[k].name;
}

/* Fills the requests of drops; those of measured drops have the coarse keys where the fit is coarse, and
 * their speed now. */
static void fill_requests(const sf_drop_fit *fit, int first, int last, const char *material,
                          char speed[][SPEED_TEXT], sf_runner_drop *request) {
    for (int d = first; d < last; d++, request++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        *request = (sf_runner_drop){.label = label_of(fit->input, d),
                                    .case_path = drop->case_path,
                                    .material = material,
                                    .number = drop->number};
        if (fit->coarse && !drop->predicted) {
            request->override_count = fit->input->coarse_count;
            memcpy(request->overrides, fit->input->coarse, sizeof fit->input->coarse);
        }
        if (fit->speed_now[d] > 0) {
            snprintf(speed[d], SPEED_TEXT, "missile.velocity=%.17g m/s", drop->speed * fit->speed_now[d]);
            request->overrides[request->override_count++] = speed[d];
        }
    }
}

/* Predicted drops side by side with a material file: one that fails is marked, the others go on. */
static sf_status predict_with(sf_drop_fit *fit, int first, int last, const char *material, double *y,
                              sf_error *err) {
    sf_runner_drop request[SF_FIT_MAX_DROPS] = {{0}};
    sf_runner_result result[SF_FIT_MAX_DROPS];
    sf_error failure[SF_FIT_MAX_DROPS];
    fill_requests(fit, first, last, material, NULL, request);
    sf_runner_run_each(fit->runner, last - first, request, result, failure, err);
    for (int d = first; d < last; d++) {
        sf_error *own = &failure[d - first];
        if (err->status == SF_OK && own->status == SF_OK)
            take_drop(fit, d, &result[d - first], y, own);
        if (err->status == SF_OK && own->status == SF_OK && fit->simulated[d].grade == SF_GRADE_DO_NOT_USE)
            mark_failure(fit, d, fit->simulated[d].verdict, material, y);
        else if (err->status == SF_OK && (own->status == SF_ERR_NUMERIC || own->status == SF_ERR_MODEL))
            mark_failure(fit, d, own->text, material, y);
        else if (err->status == SF_OK)
            *err = *own;
        sf_runner_result_free(&result[d - first]);
    }
    return err->status;
}

/* Drops `first` to `last` - 1 side by side with a material file. */
static sf_status simulate_with(sf_drop_fit *fit, int first, int last, const char *material, double *y,
                               sf_error *err) {
    sf_runner_drop request[SF_FIT_MAX_DROPS] = {{0}};
    sf_runner_result result[SF_FIT_MAX_DROPS];
    char speed[SF_FIT_MAX_DROPS][SPEED_TEXT];
    fill_requests(fit, first, last, material, speed, request);
    sf_runner_run_batch(fit->runner, last - first, request, result, err);
    for (int d = first; d < last; d++) {
        if (err->status == SF_OK)
            take_drop(fit, d, &result[d - first], y, err);
        sf_runner_result_free(&result[d - first]);
    }
    return err->status;
}

void sf_drop_fit_bounds(const sf_fit_input *in, int k, double *low, double *high) {
    static const double ROOM = 2e-3; /* for differences */
    const sf_parameter_info *about = k < in->unknown_count ? sf_parameter_get(in->unknown[k]) : NULL;
    *low = about ? log(about->low) + ROOM : -INFINITY;
    *high = about && in->unknown[k] != SF_PARAMETER_HU ? log(about->high) - ROOM : INFINITY;
}

/* Checks the card as a case would: a step that leads to a refused material is too long. */
static sf_status check_card(const sf_foam_card *card, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    if (sf_foam_check_shared(card, &inner) != SF_OK)
        return SF_FAIL(err, SF_ERR_NUMERIC, "%s", inner.text);
    return SF_OK;
}

/* Drops `first` to `last` - 1 with the material of u, which is written beside the drops' folders. */
static sf_status simulate_drops(sf_drop_fit *fit, int first, int last, const char *name, const double *u,
                                double *y, sf_error *err) {
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    char path[PATH_MAX];
    const sf_material_text text = {.title = "An iterate of softfall-fit drop.", .provenance = ""};
    snprintf(path, sizeof path, "%s/%s.cfg", fit->folder, name);
    SF_TRY(sf_drop_fit_card(fit->input, u, &card, err));
    fit->chain_now = sf_drop_fit_chain(fit, u);
    card.informed_strain = 0; /* that of the start says nothing about an iterate */
    const sf_material material = sf_foam_material(&card);
    SF_TRY(check_card(&card, err));
    SF_TRY(sf_material_write(fit->folder, name, &material, &text, err));
    if (last > first)
        SF_TRY((fit->input->drop[first].predicted ? predict_with : simulate_with)(fit, first, last, path, y,
                                                                                  err));
    if (first > 0)
        return SF_OK;
    return sf_drop_fit_columns(fit, 0, 0, SF_FIT_AS_GIVEN, u, y, err); /* the joint data need no simulation */
}

/* Measured drops with the speeds in u, or as given (NULL). */
static void set_speeds(sf_drop_fit *fit, const double *u) {
    for (int d = 0; d < fit->measured_drops; d++)
        fit->speed_now[d] = u && fit->speed[d] >= 0 && u[fit->speed[d]] != 0 ? exp(u[fit->speed[d]]) : 0;
}

static sf_status simulate(void *context, const double *u, double *y, sf_error *err) {
    sf_drop_fit *fit = context;
    char name[SF_FIT_NAME_SIZE];
    snprintf(name, sizeof name, "%s-%02d", fit->coarse ? "coarse" : "iterate", fit->iteration++);
    set_speeds(fit, u);
    return simulate_drops(fit, 0, fit->measured_drops, name, u, y, err);
}

static void report_progress(void *context, int iteration, const double *u, const double *y,
                            double objective) {
    const sf_drop_fit *fit = context;
    (void)y;
    if (!fit->log)
        return;
    fprintf(fit->log, "%siteration %d: objective %.4g;", fit->coarse ? "coarse " : "", iteration, objective);
    for (int k = 0; k < fit->input->unknown_count; k++) {
        const sf_parameter_info *p = sf_parameter_get(fit->input->unknown[k]);
        fprintf(fit->log, " %s %.4g%s%s", p->name, exp(u[k]) / p->per_unit, *p->unit ? " " : "", p->unit);
    }
    fputc('\n', fit->log);
    fflush(fit->log);
}

/* ---- conclusions from the result ---- */

/* Each measured drop predicted from the others with the corrected surrogate. */
static sf_status leave_one_out(sf_drop_fit *fit, const sf_mapping_problem *problem, sf_error *err) {
    const sf_fit_input *in = fit->input;
    size_t n = (size_t)problem->responses;
    double u[SF_MAPPING_MAX_PARAMETERS];
    SF_OWNED double *sd = sf_alloc(err, n, sizeof *sd, "responses"),
                    *y = sf_alloc(err, n, sizeof *y, "responses");
    bool others = fit->measured_drops > 1 || in->joint.rows > 0;
    for (int k = 0; k < fit->row[in->drop_count]; k++)
        fit->without[k] = NAN;
    for (int d = 0; d < fit->measured_drops && others && err->status == SF_OK; d++) {
        memcpy(sd, fit->sd, n * sizeof *sd);
        for (int k = fit->row[d]; k < fit->row[d + 1]; k++)
            sd[k] = INFINITY;
        if (sf_mapping_refit(problem, &fit->result, sd, u, y, err) == SF_OK)
            memcpy(&fit->without[fit->row[d]], &y[fit->row[d]],
                   (size_t)(fit->row[d + 1] - fit->row[d]) * sizeof *y);
    }
    return err->status;
}

/* sqrt(g^T C g); NaN of a response whose columns fail. */
static double deviation(const sf_drop_fit *fit, const double *gradient) {
    double sum = 0;
    for (int j = 0; j < fit->parameters; j++)
        for (int k = 0; k < fit->parameters; k++)
            sum += gradient[j] * fit->result.covariance[j][k] * gradient[k];
    return isnan(sum) ? NAN : sqrt(fmax(0, sum));
}

static double stress_at(const sf_foam_card *card, double strain) {
    sf_error none = SF_ERROR_INIT;
    SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
    double stress = NAN, slope, energy;
    if (sf_curve_build(card, 0, &curve, &none) == SF_OK)
        sf_curve_evaluate(&curve, strain, &stress, &slope, &energy);
    return stress;
}

/* Standard deviations of the curve in the bins, from the parameters' after and before the data. */
static sf_status bound_curve(sf_drop_fit *fit, sf_error *err) {
    static const double step = 1e-3;
    const sf_fit_input *in = fit->input;
    double gradient[SF_FIT_STRAIN_BINS][SF_MAPPING_MAX_PARAMETERS] = {{0}}, u[SF_MAPPING_MAX_PARAMETERS];
    for (int j = 0; j < in->unknown_count; j++) {
        SF_OWNED_BY(sf_foam_card_free) sf_foam_card low = {0}, high = {0};
        memcpy(u, fit->result.u, sizeof u);
        u[j] += step;
        SF_TRY(sf_drop_fit_card(in, u, &high, err));
        u[j] -= 2 * step;
        SF_TRY(sf_drop_fit_card(in, u, &low, err));
        for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
            double strain = (b + 0.5) * SF_FIT_BIN_WIDTH;
            gradient[b][j] = log(stress_at(&high, strain) / stress_at(&low, strain)) / (2 * step);
        }
    }
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        double prior = 0;
        for (int j = 0; j < in->unknown_count; j++)
            prior += pow(gradient[b][j] * in->prior_sd[j], 2);
        fit->curve_sd[b] = deviation(fit, gradient[b]);
        fit->curve_prior_sd[b] = sqrt(prior);
    }
    return err->status;
}

/* Finds the change of the measured responses with the curve in each bin. */
static sf_status locate_information(sf_drop_fit *fit, sf_error *err) {
    size_t n = (size_t)fit->row[fit->measured_drops];
    SF_OWNED double *y = sf_alloc(err, n, sizeof *y, "responses"),
                    *base = sf_alloc(err, n, sizeof *base, "responses");
    if (err->status == SF_OK)
        sf_drop_fit_columns(fit, 0, fit->measured_drops, SF_FIT_NOWHERE, fit->result.u, base, err);
    for (int b = 0; b < SF_FIT_STRAIN_BINS && err->status == SF_OK; b++) {
        sf_drop_fit_columns(fit, 0, fit->measured_drops, b, fit->result.u, y, err);
        for (size_t k = 0; k < n; k++)
            fit->information[b] +=
                isinf(fit->sd[k]) ? 0 : pow((y[k] - base[k]) / (SF_FIT_RAISE * fit->sd[k]), 2);
    }
    return err->status;
}

/* Gradient of the predictions by central differences of the columns. */
static sf_status differentiate_predictions(sf_drop_fit *fit, sf_error *err) {
    static const double step = 1e-3;
    const sf_fit_input *in = fit->input;
    int first = fit->row[fit->measured_drops], last = fit->row[in->drop_count];
    double u[SF_MAPPING_MAX_PARAMETERS];
    SF_OWNED double *high = sf_alloc(err, last, sizeof *high, "responses"),
                    *low = sf_alloc(err, last, sizeof *low, "responses");
    for (int j = 0; j < in->unknown_count && err->status == SF_OK; j++) {
        memcpy(u, fit->result.u, sizeof u);
        u[j] += step;
        SF_TRY(sf_drop_fit_columns(fit, fit->measured_drops, in->drop_count, SF_FIT_AS_GIVEN, u, high, err));
        u[j] -= 2 * step;
        SF_TRY(sf_drop_fit_columns(fit, fit->measured_drops, in->drop_count, SF_FIT_AS_GIVEN, u, low, err));
        for (int k = first; k < last; k++)
            fit->gradient[k * fit->parameters + j] = (high[k] - low[k]) / (2 * step);
    }
    return err->status;
}

/* The measured drops with the best parameters, at the speeds as given; where a drop has no result there, at
 * those of the fit, which the runner still has. */
static sf_status finish_measured(sf_drop_fit *fit, sf_error *err) {
    sf_error failure = SF_ERROR_INIT;
    set_speeds(fit, NULL);
    simulate_drops(fit, 0, fit->measured_drops, "result", fit->result.u, fit->y, &failure);
    fit->speeds_fitted = failure.status == SF_ERR_NUMERIC;
    if (!fit->speeds_fitted)
        return failure.status == SF_OK ? SF_OK : SF_FAIL(err, failure.status, "%s", failure.text);
    set_speeds(fit, fit->result.u);
    return simulate_drops(fit, 0, fit->measured_drops, "result", fit->result.u, fit->y, err);
}

/* The measured drops and the predicted ones with the result. */
static sf_status finish(sf_drop_fit *fit, sf_error *err) {
    const sf_fit_input *in = fit->input;
    int n = fit->parameters;
    FILE *log = fit->runner->log;
    fit->runner->log = NULL;
    finish_measured(fit, err);
    fit->runner->log = log;
    SF_TRY(err->status);
    SF_TRY(simulate_drops(fit, fit->measured_drops, in->drop_count, "result", fit->result.u, fit->y, err));
    SF_TRY(differentiate_predictions(fit, err));
    memcpy(fit->gradient, fit->result.corrected,
           (size_t)(fit->row[fit->measured_drops] * n) * sizeof *fit->gradient);
    for (int k = 0; k < fit->row[in->drop_count]; k++)
        fit->response_sd[k] = deviation(fit, &fit->gradient[k * n]);
    return SF_OK;
}

/* ---- the search ---- */

/* Objective of the simulated drops, read through the mount of `u`; INFINITY where that has no figures.
 * `y` [responses] has those of the joint data. */
static double cost_of_mount(const sf_drop_fit *fit, const sf_mapping_problem *p, const double *u, double *y) {
    const sf_signal_chain chain = sf_drop_fit_chain(fit, u);
    sf_error failure = SF_ERROR_INIT;
    double sum = 0;
    for (int d = 0; d < fit->measured_drops; d++)
        if (sf_drop_fit_read(&fit->input->drop[d], &chain, &fit->simulated[d].figures,
                             &fit->simulated[d].curve, "", "", &y[fit->row[d]], &failure) != SF_OK)
            return INFINITY;
    for (int i = 0; i < p->responses; i++)
        sum += pow(sf_mapping_residual(p, p->sd, y, i), 2);
    for (int j = 0; j < p->parameters; j++)
        sum += pow((u[j] - p->prior[j]) / p->prior_sd[j], 2);
    return sum;
}

/* The mount of `u` becomes that of a grid over its prior through which the drops with the foam of `u` have
 * the lowest objective, `least`; INFINITY: through none they have figures. Only drops that the runner has not
 * kept are simulated. */
static sf_status choose_mount(sf_drop_fit *fit, const sf_mapping_problem *p, double *u, double *least,
                              sf_error *err) {
    static const double FREQUENCY = 0.1, DAMPING = 0.5; /* standard deviations */
    const int frequencies = fit->chain[0] >= 0 ? 25 : 0, dampings = fit->chain[1] >= 0 ? 4 : 0; /* a side */
    double place[SF_MAPPING_MAX_PARAMETERS];
    SF_OWN(double, y, p->responses, "responses", err);
    *least = INFINITY;
    fit->rigid = true; /* not through a mount that may give no figures */
    simulate(fit, u, y, err);
    fit->rigid = false;
    SF_TRY(err->status);
    memcpy(place, u, sizeof place);
    for (int k = -frequencies; k <= frequencies; k++)
        for (int l = -dampings; l <= dampings; l++) {
            const double at[] = {k * FREQUENCY, l * DAMPING};
            for (int part = 0; part < 2; part++)
                if (fit->chain[part] >= 0)
                    place[fit->chain[part]] = at[part] * fit->input->chain_sd[part];
            double cost = cost_of_mount(fit, p, place, y);
            if (cost < *least) {
                *least = cost;
                memcpy(u, place, sizeof place);
            }
        }
    return SF_OK;
}

/* The window of HIC and the objective jump with the frequency of a mount that rings, and a search along
 * slopes stays on its side. So the foam is first fitted without a mount that is unknown; then the mount is
 * chosen on a grid and both are fitted, again as long as the grid has a mount with a lower objective. */
static sf_status find_minimum(sf_drop_fit *fit, const sf_mapping_problem *problem, sf_mapping_result *result,
                              sf_error *err) {
    enum { ROUNDS = 6 };
    bool rings = fit->measured_drops > 0 && (fit->chain[0] >= 0 || fit->chain[1] >= 0);
    if (!rings || fit->earlier || problem->first_point)
        return sf_mapping_solve(problem, result, err);
    double start[SF_MAPPING_MAX_PARAMETERS], lowest = INFINITY, least;
    sf_mapping_problem nearer = *problem;
    sf_error failure = SF_ERROR_INIT;
    nearer.start = start;
    nearer.wide = false;
    fit->rigid = true;
    sf_mapping_solve(problem, result, err);
    fit->rigid = false;
    for (int round = 0; round < ROUNDS && err->status == SF_OK; round++) {
        sf_mapping_result next = {0};
        memcpy(start, result->u, sizeof start);
        if (choose_mount(fit, problem, start, &least, err) != SF_OK || !(least < lowest - TOLERANCE))
            break;
        const sf_signal_chain chain = sf_drop_fit_chain(fit, start);
        sf_log_print(fit->log, "from a mount of %.4g Hz with a damping of %.3g: objective %.4g\n",
                     chain.mount_frequency, chain.mount_damping, least);
        if (sf_mapping_solve(&nearer, &next, &failure) != SF_OK) {
            sf_mapping_free(&next);
            break;
        }
        next.iterations += result->iterations;
        lowest = next.objective;
        sf_mapping_free(result);
        *result = next;
    }
    if (err->status == SF_OK && failure.status != SF_OK &&
        (isinf(lowest) || failure.status != SF_ERR_NUMERIC)) /* else the last round has the result */
        return SF_FAIL(err, failure.status, "%s", failure.text);
    if (err->status == SF_OK && isinf(lowest))
        return SF_FAIL(err, SF_ERR_NUMERIC, "through no mount of its prior do the drops have their figures");
    return err->status;
}

/* The coarse drops cost little and differ from the drops by a correction that hardly changes with the foam:
 * the fit through them tells `problem` where to begin. If they cannot be used it begins at the start. */
static sf_status begin_coarse(sf_drop_fit *fit, sf_mapping_problem *problem, sf_mapping_result *coarse,
                              sf_error *err) {
    sf_error failure = SF_ERROR_INIT;
    fit->coarse = true;
    find_minimum(fit, problem, coarse, &failure);
    fit->coarse = false;
    fit->iteration = 0;
    if (failure.status == SF_OK) {
        fit->coarse_iterations = coarse->iterations;
        problem->first_linear = coarse->linear;
        problem->first_offset = coarse->linear ? coarse->y : coarse->offset;
        problem->first_point = coarse->u;
        problem->first_matrix = coarse->linear ? coarse->corrected : coarse->matrix;
        return SF_OK;
    }
    if (failure.status != SF_ERR_NUMERIC && failure.status != SF_ERR_MODEL)
        return SF_FAIL(err, failure.status, "coarse_set: %.800s", failure.text);
    sf_log_print(fit->log, "coarse_set is left out, its drops cannot be used: %s\n", failure.text);
    return SF_OK;
}

sf_status sf_drop_fit_run(sf_drop_fit *fit, sf_error *err) {
    const sf_fit_input *in = fit->input;
    double prior[SF_MAPPING_MAX_PARAMETERS] = {0}, start[SF_MAPPING_MAX_PARAMETERS],
           prior_sd[SF_MAPPING_MAX_PARAMETERS], low[SF_MAPPING_MAX_PARAMETERS],
           high[SF_MAPPING_MAX_PARAMETERS];
    SF_TRY(sf_drop_fit_list(fit, err));
    if (fit->earlier)
        memcpy(fit->columns, fit->earlier->columns, sizeof fit->columns);
    for (int k = 0; k < fit->parameters; k++)
        sf_drop_fit_bounds(in, k, &low[k], &high[k]);
    for (int k = 0; k < in->unknown_count; k++) {
        prior[k] = log(in->prior[k]);
        prior_sd[k] = in->prior_sd[k];
    }
    memcpy(start, prior, sizeof start);
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++)
        if (fit->chain[k] >= 0) {
            prior_sd[fit->chain[k]] = in->chain_sd[k];
            start[fit->chain[k]] = fit->earlier ? fit->earlier->result.u[fit->earlier->chain[k]] : 0;
        }
    for (int d = 0; d < in->drop_count; d++)
        if (fit->speed[d] >= 0)
            prior_sd[fit->speed[d]] = in->drop[d].speed_sd;
    const bool exact = fit->measured_drops == 0;
    SF_OWNED_BY(sf_mapping_free) sf_mapping_result coarse = {0};
    sf_mapping_problem problem = {.parameters = fit->parameters,
                                  .responses = fit->row[fit->measured_drops],
                                  .start = start,
                                  .prior = prior,
                                  .prior_sd = prior_sd,
                                  .low = low,
                                  .high = high,
                                  .first_offset = fit->earlier ? fit->earlier->result.offset : NULL,
                                  .measured = fit->measured,
                                  .sd = fit->sd,
                                  .bound_sd = fit->bound_sd,
                                  .surrogate = surrogate,
                                  .simulate = simulate,
                                  .context = fit,
                                  .max_iterations = exact ? EXACT_ITERATIONS : MAX_ITERATIONS,
                                  .wide = true,
                                  .tolerance = TOLERANCE,
                                  .progress = report_progress};
    if (in->coarse_count > 0 && !fit->earlier)
        begin_coarse(fit, &problem, &coarse, err);
    if (err->status == SF_OK && find_minimum(fit, &problem, &fit->result, err) == SF_OK &&
        finish(fit, err) == SF_OK && leave_one_out(fit, &problem, err) == SF_OK &&
        bound_curve(fit, err) == SF_OK && locate_information(fit, err) == SF_ERR_NUMERIC &&
        fit->result.linear)
        *err = (sf_error)SF_ERROR_INIT; /* the columns collapse where the drops do not */
    return err->status;
}

void sf_drop_fit_free(sf_drop_fit *fit) {
    for (int d = 0; d < SF_FIT_MAX_DROPS; d++)
        sf_series_free(&fit->simulated[d].curve);
    sf_mapping_free(&fit->result);
    free(fit->y); /* and all behind it */
    free(fit->gradient);
}
