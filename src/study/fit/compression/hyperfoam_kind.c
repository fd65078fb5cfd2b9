/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the hyperfoam, identified from one compression test with free sides: its terms from nominal
 * stress and lateral strain while loading, by least squares (GSL, Levenberg-Marquardt from several starts);
 * HU, SHAPE and ALPHA from unloading. Terms have mu > 0 and 0 <= nu < 0.45, so that the law is stable at any
 * strain. */
#include "study/fit/compression/compression_kind.h"

#include "base/text.h"
#include "io/table_csv.h"
#include "study/fit/least_squares.h"
#include <gsl/gsl_errno.h>

enum { STARTS = 6, MOST_TERMS = 3, MISFIT_SIZE = 256 };
static const char AT_BOUND_WORDS[] = " (at its bound)";
static const double LARGEST_NU = 0.45, LARGEST_ALPHA = 49, LEAST_ALPHA = 0.02;
static const double AT_BOUND = 1e-3;                          /* of the range */
static const double POOR = 0.1;                               /* rms over the largest value */
static const double starts[STARTS] = {40, 14, 4, -1, -3, -8}; /* of alpha: from yield to densification */

/* A test with its lateral strain, and what is fitted to it. */
typedef struct fitted {
    const sf_compression_config *config;
    const sf_compression_test *test;
    const sf_hyperfoam_request *request;  /* terms, and lateral strain of the test */
    sf_hyperfoam_card card;               /* terms and unloading; the rest as given */
    double error[SF_HYPERFOAM_TERMS][3];  /* standard errors: mu over mu, alpha, nu; NaN: not fitted, or at
                                             its bound */
    bool at_bound[SF_HYPERFOAM_TERMS][3]; /* mu (never), alpha, nu */
    double poisson[2];  /* -, -ln(lateral stretch)/ln(axial stretch), at 1 % strain and at the largest */
    double stress_rms;  /* -, of the deviations while loading, over the largest stress */
    double lateral_rms; /* -, the same of the lateral strain; NaN: none */
    sf_unloading_fit unloading; /* its rms is NaN: none */
    bool is_good;               /* no deviation exceeds a tenth of the largest value */
} fitted;

/* ---- the request: terms, nu and lateral strain ---- */

enum { LEAST_LATERAL = 6 };

static sf_status check_lateral(const sf_table_point *p, sf_error *err) {
    if (p->value[0] >= 1 || p->value[1] <= -1 || p->value[1] >= 1)
        return SF_REFUSE(err,
                         "%s:%d: strain %s and lateral strain %s: one is outside -1 to 1; columns in "
                         "percent are named strain_percent and lateral_strain_percent",
                         p->path, p->line, p->text[0], p->text[1]);
    return SF_OK;
}

/* Rows up to the largest strain: loading. Ascending afterwards. */
static sf_status read_lateral(const char *path, sf_hyperfoam_request *data, sf_error *err) {
    const sf_table_layout layout = {.what = "test",
                                    .kind = "lateral",
                                    .column = {&sf_column_strain, &sf_column_lateral_strain},
                                    .check = check_lateral};
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    SF_TRY(sf_table_read(path, &layout, &table, err));
    int64_t end = 0;
    for (int64_t i = 1; i < table.count; i++)
        end = table.value[0][i] > table.value[0][end] ? i : end;
    data->lateral_count = (int)(end + 1);
    data->lateral_at = table.value[0];
    data->lateral = table.value[1];
    table.value[0] = table.value[1] = NULL;
    for (int i = 1; i < data->lateral_count; i++)
        for (int k = i; k > 0 && data->lateral_at[k] < data->lateral_at[k - 1]; k--) {
            double at = data->lateral_at[k], side = data->lateral[k];
            data->lateral_at[k] = data->lateral_at[k - 1];
            data->lateral[k] = data->lateral[k - 1];
            data->lateral_at[k - 1] = at;
            data->lateral[k - 1] = side;
        }
    if (data->lateral_count < LEAST_LATERAL)
        return SF_REFUSE(err, "%s: %d points of lateral strain while loading; %d are needed", path,
                         data->lateral_count, LEAST_LATERAL);
    return SF_OK;
}

static sf_status read_test(const sf_config *file, sf_config_item *root, sf_hyperfoam_request *r,
                           sf_compression_test *test, sf_error *err) {
    sf_config_item *tests, *entry;
    sf_compression_source source = {0};
    SF_OWNED char *path = NULL, *lateral = NULL;
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_config_list(file, root, "tests", true, 8, &tests, err));
    entry = config_setting_get_elem(tests, 0);
    if (config_setting_length(tests) != 1)
        return sf_config_refuse(file, tests, err,
                                "the hyperfoam is fitted to one test, at one rate; fit the others in files "
                                "of their own, and compare nu and mu");
    SF_TRY(sf_config_names(file, entry, "file|rate|lateral", err));
    SF_TRY(sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, &source.rate, err));
    SF_TRY(sf_config_file(file, entry, "lateral", false, &lateral, err));
    SF_TRY(sf_config_file(file, entry, "file", true, &path, err));
    source.path = path;
    if (sf_compression_test_read(&source, test, &inner) == SF_OK && lateral)
        read_lateral(lateral, r, &inner);
    if (inner.status != SF_OK)
        SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                config_setting_source_line(entry));
    return err->status;
}

sf_status sf_hyperfoam_request_read(const sf_config *file, sf_config_item *root, sf_hyperfoam_request *r,
                                    sf_compression_test *test, sf_error *err) {
    double terms = 2;
    SF_TRY(sf_config_number(file, root, "terms", false, 1, MOST_TERMS, &terms, err));
    SF_TRY(sf_config_number(file, root, "nu", false, 0, 0.45, &r->nu, err));
    r->terms = (int)terms;
    if (r->terms != terms)
        return sf_config_refuse(file, config_setting_get_member(root, "terms"), err,
                                "terms is %g; it must be 1, 2 or 3", terms);
    SF_TRY(read_test(file, root, r, test, err));
    bool given = config_setting_get_member(root, "nu") != NULL, measured = r->lateral_count > 0;
    if (given == measured)
        return sf_config_refuse(file, root, err,
                                given ? "nu is given, and lateral strain is measured; one of them says it"
                                      : "give the test a table of lateral strain (lateral = \"FILE\", which "
                                        "may be its own file), or nu for all terms");
    return SF_OK;
}

void sf_hyperfoam_request_free(sf_hyperfoam_request *r) {
    SF_CLEAR(r, r->lateral_at, r->lateral);
}

/* ---- the fit ---- */

double sf_hyperfoam_free_stress(const sf_hyperfoam *foam, double strain, double *lateral, double *energy) {
    double stretch[3] = {1 - strain, 1 + *lateral, 1};
    if (!sf_hyperfoam_release(foam, 1, stretch))
        return NAN;
    sf_hyperfoam_point p = sf_hyperfoam_evaluate(foam, stretch);
    *lateral = stretch[1] - 1;
    *energy = p.energy;
    return -p.t[0];
}

/* Data of the least-squares problem. */
typedef struct problem {
    const sf_compression_test *test;
    const sf_hyperfoam_request *request;
    sf_hyperfoam_card card;
    int terms;
    int choice[SF_HYPERFOAM_TERMS]; /* indices of the present starts, descending */
    double largest_lateral;
} problem;

static int per_term(const problem *p) {
    return p->request->lateral_count > 0 ? 3 : 2;
}

/* Parameters of a term: ln mu, alpha (bounded smoothly), nu likewise. */
static void take_terms(const problem *p, const gsl_vector *x, sf_hyperfoam_card *card) {
    int each = per_term(p);
    for (int k = 0; k < p->terms; k++) {
        sf_hyperfoam_term *t = &card->term[k];
        double alpha = gsl_vector_get(x, (size_t)(each * k + 1));
        t->mu = exp(fmin(30, gsl_vector_get(x, (size_t)(each * k))));
        t->alpha = LARGEST_ALPHA * tanh(alpha / LARGEST_ALPHA);
        t->alpha = fabs(t->alpha) < LEAST_ALPHA ? copysign(LEAST_ALPHA, t->alpha) : t->alpha;
        if (each == 3)
            t->nu = LARGEST_NU * sf_logistic(gsl_vector_get(x, (size_t)(each * k + 2)));
    }
}

/* Deviations over the largest value, each quantity with the same weight in all. */
static int deviate(const gsl_vector *x, void *data, gsl_vector *out) {
    const problem *p = data;
    const sf_compression_test *t = p->test;
    sf_hyperfoam_card card = p->card;
    take_terms(p, x, &card);
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    double lateral = 0, energy, weight = 1 / (t->largest_stress * sqrt(t->loading));
    for (int i = 0; i < t->loading; i++) {
        double stress = sf_hyperfoam_free_stress(&foam, t->strain[i], &lateral, &energy);
        gsl_vector_set(out, (size_t)i, weight * (stress - t->stress[i]));
    }
    lateral = 0;
    weight = 1 / (p->largest_lateral * sqrt(p->request->lateral_count));
    for (int i = 0; i < p->request->lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, p->request->lateral_at[i], &lateral, &energy);
        gsl_vector_set(out, (size_t)(t->loading + i), weight * (lateral - p->request->lateral[i]));
    }
    for (size_t i = 0; i < out->size; i++)
        if (!isfinite(gsl_vector_get(out, i)))
            return GSL_EDOM;
    return GSL_SUCCESS;
}

/* The next choice of `terms` different starts, descending; false: there is none. */
static bool next_choice(int terms, int choice[SF_HYPERFOAM_TERMS]) {
    for (int k = terms - 1; k >= 0; k--)
        if (choice[k] < STARTS - terms + k) {
            choice[k]++;
            for (int j = k + 1; j < terms; j++)
                choice[j] = choice[j - 1] + 1;
            return true;
        }
    return false;
}

/* ln mu with which a term of this alpha alone has its part of the stress in the middle of the test. */
static double start_modulus(const problem *p, double alpha) {
    const sf_compression_test *t = p->test;
    sf_hyperfoam foam = {.count = 1, .mu = {1}, .alpha = {alpha}, .beta = {p->card.term[0].nu}};
    double lateral = 0, energy,
           stress = sf_hyperfoam_free_stress(&foam, t->strain[t->loading / 2], &lateral, &energy);
    return log(fmax(1, t->stress[t->loading / 2]) / (p->terms * fmax(stress, 1e-6)));
}

static bool start(void *data, int number, gsl_vector *x) {
    problem *p = data;
    int each = per_term(p);
    if (number > 0 && !next_choice(p->terms, p->choice))
        return false;
    for (int k = 0; k < p->terms; k++) {
        gsl_vector_set(x, (size_t)(each * k), start_modulus(p, starts[p->choice[k]]));
        gsl_vector_set(x, (size_t)(each * k + 1),
                       LARGEST_ALPHA * atanh(starts[p->choice[k]] / LARGEST_ALPHA));
        if (each == 3)
            gsl_vector_set(x, (size_t)(each * k + 2), -1);
    }
    return true;
}

static void find_bounds(const problem *p, const gsl_vector *x, fitted *fit) {
    int each = per_term(p);
    for (int k = 0; k < p->terms; k++) {
        double alpha = fabs(fit->card.term[k].alpha);
        fit->at_bound[k][1] = alpha <= LEAST_ALPHA || alpha > (1 - AT_BOUND) * LARGEST_ALPHA;
        fit->at_bound[k][2] =
            each == 3 && sf_is_at_end(sf_logistic(gsl_vector_get(x, (size_t)(each * k + 2))));
    }
}

static void take_errors(const problem *p, const gsl_vector *x, const gsl_matrix *covariance, double factor,
                        fitted *fit) {
    int each = per_term(p);
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++)
        for (int j = 0; j < 3; j++) {
            size_t at = (size_t)(each * k + j);
            bool is_fitted = k < p->terms && j < each;
            double part = is_fitted && j == 2 ? sf_logistic(gsl_vector_get(x, at)) : 0;
            double bend = fit->card.term[k].alpha / LARGEST_ALPHA; /* tanh, as take_terms() has it */
            double scale = j == 2 ? LARGEST_NU * part * (1 - part) : j == 1 ? 1 - bend * bend : 1;
            fit->error[k][j] = is_fitted && !fit->at_bound[k][j]
                                   ? scale * sqrt(factor * gsl_matrix_get(covariance, at, at))
                                   : NAN;
        }
}

static sf_status fit_terms(problem *p, fitted *fit, sf_error *err) {
    size_t size = (size_t)(per_term(p) * p->terms);
    size_t count = (size_t)(p->test->loading + p->request->lateral_count);
    SF_VECTOR *best = gsl_vector_alloc(size);
    SF_MATRIX *covariance = gsl_matrix_alloc(size, size);
    double least = sf_least_squares_from(start, deviate, p, count, best);
    if (isfinite(least))
        least = sf_least_squares(deviate, p, count, best, covariance);
    if (!isfinite(least))
        return SF_FAIL(err, SF_ERR_NUMERIC, "no search for %d terms of the hyperfoam converges", p->terms);
    take_terms(p, best, &fit->card);
    find_bounds(p, best, fit);
    take_errors(p, best, covariance, least / (double)(count > size ? count - size : 1), fit);
    return SF_OK;
}

static sf_status fit_unloading(const sf_compression_test *t, fitted *fit, sf_error *err) {
    sf_hyperfoam foam = sf_hyperfoam_build(&fit->card);
    int count = t->count - t->loading;
    double lateral = 0, peak = 0;
    SF_OWN(double, loading, 2 * count, "unloading", err);
    sf_unloading_points points = {count,           t->stress + t->loading, loading, NULL,
                                  loading + count, t->largest_stress,      false,   1};
    sf_hyperfoam_free_stress(&foam, t->largest_strain, &lateral, &peak);
    for (int k = 0; k < count; k++) {
        double *ratio = &points.ratio[k];
        loading[k] = sf_hyperfoam_free_stress(&foam, fmax(0, t->strain[t->loading + k]), &lateral, ratio);
        *ratio = fmin(1, *ratio / peak);
    }
    fit->unloading = sf_unloading_search(&points);
    if (isfinite(fit->unloading.rms)) {
        fit->card.hysteresis_hu = fit->unloading.value[0];
        fit->card.hysteresis_shape = fit->unloading.value[1];
        fit->card.hysteresis_alpha = fit->unloading.value[2];
    }
    return SF_OK;
}

static void measure(const problem *p, fitted *fit) {
    const sf_compression_test *t = p->test;
    sf_hyperfoam foam = sf_hyperfoam_build(&fit->card);
    double lateral = 0, energy, stress = 0, side = 0;
    for (int i = 0; i < t->loading; i++)
        stress += pow(sf_hyperfoam_free_stress(&foam, t->strain[i], &lateral, &energy) - t->stress[i], 2);
    lateral = 0;
    for (int i = 0; i < p->request->lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, p->request->lateral_at[i], &lateral, &energy);
        side += pow(lateral - p->request->lateral[i], 2);
    }
    fit->poisson[0] = sf_hyperfoam_poisson(&foam, 0.01);
    fit->poisson[1] = sf_hyperfoam_poisson(&foam, t->largest_strain);
    fit->stress_rms = sqrt(stress / t->loading) / t->largest_stress;
    fit->lateral_rms =
        p->request->lateral_count ? sqrt(side / p->request->lateral_count) / p->largest_lateral : NAN;
    fit->is_good = !(fit->stress_rms > POOR || fit->lateral_rms > POOR || fit->unloading.rms > POOR);
}

/* HU, SHAPE and ALPHA are fitted after the terms; nu is that of every term if no lateral strain was
 * measured. */
static sf_status run(const sf_compression_config *config, void *place, sf_error *err) {
    fitted *fit = place;
    const sf_hyperfoam_request *r = &config->hyperfoam;
    const sf_compression_test *t = &config->test[0];
    *fit = (fitted){.config = config,
                    .test = t,
                    .request = r,
                    .card = {.density = config->density,
                             .damp = config->damp,
                             .hysteresis_hu = 1,
                             .hysteresis_shape = 1,
                             .hysteresis_alpha = 1,
                             .maxwell_rate = 5000,
                             .rate_reference = 0.01,
                             .rate_filter_time = 1e-4,
                             .stable_to = 0.9,
                             .informed_strain = t->largest_strain},
                    .unloading.rms = NAN};
    for (int k = 0; k < r->terms; k++)
        fit->card.term[k].nu = r->nu;
    problem p = {.test = t, .request = r, .card = fit->card, .terms = r->terms, .choice = {0, 1, 2}};
    for (int i = 0; i < r->lateral_count; i++)
        p.largest_lateral = fmax(p.largest_lateral, fabs(r->lateral[i]));
    p.largest_lateral = fmax(p.largest_lateral, 0.01); /* a foam without lateral strain */
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    if (fit_terms(&p, fit, err) == SF_OK && t->count - t->loading > 3)
        fit_unloading(t, fit, err);
    if (err->status == SF_OK)
        measure(&p, fit);
    gsl_set_error_handler(handler);
    return err->status;
}

static sf_material material_of(const void *place) {
    return sf_hyperfoam_material(&((const fitted *)place)->card);
}

/* ---- words ---- */

static void put_error(FILE *out, double error, bool at_bound) {
    if (at_bound)
        fputs(AT_BOUND_WORDS, out);
    else if (isfinite(error))
        fprintf(out, " +- %.2g", error);
}

static void put_term(FILE *out, const fitted *fit, int k) {
    const sf_hyperfoam_term *t = &fit->card.term[k];
    fprintf(out, "  term %d: mu %.5g kPa +- %.2g %%, alpha %.4g", k + 1, 1e-3 * t->mu, 100 * fit->error[k][0],
            t->alpha);
    put_error(out, fit->error[k][1], fit->at_bound[k][1]);
    fprintf(out, ", nu %.4g", t->nu);
    put_error(out, fit->error[k][2], fit->at_bound[k][2]);
    fputs("\n", out);
}

/* Writes the deviations of a poor fit. */
static void describe_misfit(const fitted *fit, char text[MISFIT_SIZE]) {
    const struct {
        const char *name;
        double rms;
    } parts[] = {{"stress while loading", fit->stress_rms},
                 {"lateral strain", fit->lateral_rms},
                 {"stress of unloading", fit->unloading.rms}};
    snprintf(text, MISFIT_SIZE, "the fit does not describe this test, rms over the largest value:");
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        if (isfinite(parts[k].rms))
            sf_text_add(text, MISFIT_SIZE, "%s %s %.2g %%", k > 0 ? "," : "", parts[k].name,
                        100 * parts[k].rms);
}

static void describe(FILE *out, const void *place, bool comments) {
    const fitted *fit = place;
    const sf_compression_test *t = fit->test;
    const bool *at_bound = fit->unloading.at_bound;
    char misfit[MISFIT_SIZE];
    int terms = fit->request->terms;
    if (!comments)
        fprintf(out, "%s: hyperfoam of %d term%s\n", fit->config->name, terms, terms > 1 ? "s" : "");
    if (comments)
        fprintf(out, " from\n  %s at %.6g 1/s, to a strain of %.4g\n", t->path, t->rate, t->largest_strain);
    if (comments && !fit->is_good) {
        describe_misfit(fit, misfit);
        fprintf(out, "WARNING: %s\n", misfit);
    }
    for (int k = 0; k < terms; k++)
        put_term(out, fit, k);
    fprintf(out, "  -ln(lateral stretch)/ln(axial stretch): %.3g at 1 %% strain, %.3g at %.3g %%\n",
            fit->poisson[0], fit->poisson[1], 100 * t->largest_strain);
    fprintf(out, "  rms while loading: stress %.2g %% of the largest", 100 * fit->stress_rms);
    if (isfinite(fit->lateral_rms))
        fprintf(out, ", lateral strain %.2g %% of the largest", 100 * fit->lateral_rms);
    fputs("\n", out);
    if (isfinite(fit->unloading.rms))
        fprintf(out,
                "  unloading: HU %.4g%s, SHAPE %.4g%s, ALPHA %.4g%s; rms %.2g %% of the largest stress\n",
                fit->card.hysteresis_hu, at_bound[0] ? AT_BOUND_WORDS : "", fit->card.hysteresis_shape,
                at_bound[1] ? AT_BOUND_WORDS : "", fit->card.hysteresis_alpha,
                at_bound[2] ? AT_BOUND_WORDS : "", 100 * fit->unloading.rms);
    if (comments)
        fprintf(out, "Beyond that strain and at other rates it is extrapolation. +-: standard errors.\n");
}

static void warn(const void *place, const sf_sink *sink) {
    const fitted *f = place;
    char misfit[MISFIT_SIZE];
    describe_misfit(f, misfit);
    if (!f->is_good)
        sf_sink_tell(sink, SF_WARNING, "%s", misfit);
}

/* ---- files ---- */

static void put_points(sf_csv *csv, const void *place) {
    const fitted *f = place;
    const sf_compression_test *t = f->test;
    const sf_hyperfoam_request *r = f->request;
    const sf_hyperfoam_card *card = &f->card;
    sf_hyperfoam foam = sf_hyperfoam_build(card);
    double side = 0, energy = 0, peak = 0;
    SF_CSV_PRINT_LINE(csv, "quantity,branch,strain,measured,fit");
    sf_hyperfoam_free_stress(&foam, t->largest_strain, &side, &peak);
    side = 0;
    for (int i = 0; i < t->count; i++) {
        bool back = i >= t->loading;
        double stress = sf_hyperfoam_free_stress(&foam, t->strain[i], &side, &energy);
        if (back)
            stress *= sf_unloading_factor(card->hysteresis_hu, card->hysteresis_shape, card->hysteresis_alpha,
                                          fmin(1, energy / peak));
        sf_csv_print(csv, "stress_kPa,%s", back ? "unloading" : "loading");
        SF_CSV_LINE(csv, t->strain[i], 1e-3 * t->stress[i], 1e-3 * stress);
    }
    side = 0;
    for (int i = 0; i < r->lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, r->lateral_at[i], &side, &energy);
        sf_csv_print(csv, "lateral_strain,loading");
        SF_CSV_LINE(csv, r->lateral_at[i], r->lateral[i], side);
    }
}

static void put_json(sf_json *json, const void *place, const char *path) {
    const fitted *f = place;
    (void)path;
    SF_JSON_TEXTS(json, {"law", "hyperfoam"}, {"name", f->config->name}, {"test", f->test->path});
    SF_JSON_NUMBERS(json, {"rate_1_s", f->test->rate}, {"largest_strain", f->test->largest_strain});
    sf_json_open(json, "terms", '[');
    for (int k = 0; k < f->request->terms; k++) {
        const sf_hyperfoam_term *t = &f->card.term[k];
        SF_JSON_OBJECT(json, NULL);
        SF_JSON_NUMBERS(json, {"mu_Pa", t->mu}, {"mu_relative_error", f->error[k][0]}, {"alpha", t->alpha},
                        {"alpha_error", f->error[k][1]}, {"nu", t->nu}, {"nu_error", f->error[k][2]});
        sf_json_bool(json, "alpha_at_bound", f->at_bound[k][1]);
        sf_json_bool(json, "nu_at_bound", f->at_bound[k][2]);
    }
    sf_json_close(json);
    SF_JSON_NUMBERS(json, {"poisson_at_1_percent", f->poisson[0]},
                    {"poisson_at_largest_strain", f->poisson[1]}, {"stress_rms", f->stress_rms},
                    {"lateral_rms", f->lateral_rms});
    sf_json_bool(json, "describes_the_test", f->is_good);
    SF_JSON_NUMBERS(json, {"HU", f->card.hysteresis_hu}, {"SHAPE", f->card.hysteresis_shape},
                    {"ALPHA", f->card.hysteresis_alpha});
    sf_json_bool(json, "HU_at_bound", f->unloading.at_bound[0]);
    sf_json_bool(json, "SHAPE_at_bound", f->unloading.at_bound[1]);
    sf_json_bool(json, "ALPHA_at_bound", f->unloading.at_bound[2]);
    sf_json_number(json, "unloading_rms", f->unloading.rms);
}

static const char *const outputs[] = {"fit.csv", "fit.json", "material.cfg", NULL};
const sf_compression_kind sf_compression_hyperfoam = {.label = "hyperfoam",
                                                      .files = "material.cfg, fit.json, fit.csv",
                                                      .size = sizeof(fitted),
                                                      SF_COMPRESSION_PARTS};
