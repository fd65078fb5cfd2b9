/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/hyperfoam_fit.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3 * SF_HYPERFOAM_TERMS, STARTS = 6 };
static const double LARGEST_NU = 0.45, LARGEST_ALPHA = 49, LEAST_ALPHA = 0.02;
static const double AT_BOUND = 1e-3; /* of the range */
static const double POOR = 0.1;      /* rms over the largest value */
/* HU, SHAPE, ALPHA. */
static const double UNLOADING_LEAST[3] = {1e-4, 0.05, 0.1}, UNLOADING_RANGE[3] = {1 - 1e-4, 20, 4.9};
static const double starts[STARTS] = {40, 14, 4, -1, -3, -8}; /* of alpha: from yield to densification */

void sf_hyperfoam_data_free(sf_hyperfoam_data *data) {
    sf_compression_test_free(&data->test);
    free(data->lateral_at);
    free(data->lateral);
    *data = (sf_hyperfoam_data){0};
}

double sf_hyperfoam_free_stress(const sf_hyperfoam *foam, double strain, double *lateral, double *energy) {
    double stretch[3] = {1 - strain, 1 + *lateral, 1};
    if (!sf_hyperfoam_release(foam, 1, stretch))
        return NAN;
    sf_hyperfoam_point p = sf_hyperfoam_evaluate(foam, stretch);
    *lateral = stretch[1] - 1;
    *energy = p.energy;
    return -p.t[0];
}

/* A problem of least squares: the terms, or the numbers of unloading. */
typedef struct problem {
    const sf_hyperfoam_data *data;
    sf_hyperfoam_card card;
    int terms;
    double largest_lateral;
    const double *loading,
        *ratio; /* [count - loading] of unloading: stress of loading in Pa, W over largest */
} problem;

static int per_term(const problem *p) {
    return p->data->lateral_count > 0 ? 3 : 2;
}

static double logistic(double x) {
    return 1 / (1 + exp(-x));
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
            t->nu = LARGEST_NU * logistic(gsl_vector_get(x, (size_t)(each * k + 2)));
    }
}

/* Deviations over the largest value, each quantity with the same weight in all. */
static int deviate(const gsl_vector *x, void *data, gsl_vector *out) {
    const problem *p = data;
    const sf_compression_test *t = &p->data->test;
    sf_hyperfoam_card card = p->card;
    take_terms(p, x, &card);
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    double lateral = 0, energy, weight = 1 / (t->largest_stress * sqrt(t->loading));
    for (int i = 0; i < t->loading; i++) {
        double stress = sf_hyperfoam_free_stress(&foam, t->strain[i], &lateral, &energy);
        gsl_vector_set(out, (size_t)i, weight * (stress - t->stress[i]));
    }
    lateral = 0;
    weight = 1 / (p->largest_lateral * sqrt(p->data->lateral_count));
    for (int i = 0; i < p->data->lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, p->data->lateral_at[i], &lateral, &energy);
        gsl_vector_set(out, (size_t)(t->loading + i), weight * (lateral - p->data->lateral[i]));
    }
    for (size_t i = 0; i < out->size; i++)
        if (!isfinite(gsl_vector_get(out, i)))
            return GSL_EDOM;
    return GSL_SUCCESS;
}

static void take_unloading(const gsl_vector *x, sf_hyperfoam_card *card) {
    card->hysteresis_hu = UNLOADING_LEAST[0] + UNLOADING_RANGE[0] * logistic(gsl_vector_get(x, 0));
    card->hysteresis_shape = UNLOADING_LEAST[1] + UNLOADING_RANGE[1] * logistic(gsl_vector_get(x, 1));
    card->hysteresis_alpha = UNLOADING_LEAST[2] + UNLOADING_RANGE[2] * logistic(gsl_vector_get(x, 2));
}

static int deviate_unloading(const gsl_vector *x, void *data, gsl_vector *out) {
    const problem *p = data;
    const sf_compression_test *t = &p->data->test;
    sf_hyperfoam_card card;
    take_unloading(x, &card);
    for (int i = t->loading; i < t->count; i++) {
        int k = i - t->loading;
        double factor = sf_unloading_factor(card.hysteresis_hu, card.hysteresis_shape, card.hysteresis_alpha,
                                            p->ratio[k]);
        gsl_vector_set(out, (size_t)k, (factor * p->loading[k] - t->stress[i]) / t->largest_stress);
    }
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
    const sf_compression_test *t = &p->data->test;
    sf_hyperfoam foam = {.count = 1, .mu = {1}, .alpha = {alpha}, .beta = {p->card.term[0].nu}};
    double lateral = 0, energy,
           stress = sf_hyperfoam_free_stress(&foam, t->strain[t->loading / 2], &lateral, &energy);
    return log(fmax(1, t->stress[t->loading / 2]) / (p->terms * fmax(stress, 1e-6)));
}

static void start(const problem *p, const int choice[SF_HYPERFOAM_TERMS], gsl_vector *x) {
    int each = per_term(p);
    for (int k = 0; k < p->terms; k++) {
        gsl_vector_set(x, (size_t)(each * k), start_modulus(p, starts[choice[k]]));
        gsl_vector_set(x, (size_t)(each * k + 1), LARGEST_ALPHA * atanh(starts[choice[k]] / LARGEST_ALPHA));
        if (each == 3)
            gsl_vector_set(x, (size_t)(each * k + 2), -1);
    }
}

static bool is_at_end(double part) {
    return part < AT_BOUND || part > 1 - AT_BOUND;
}

static void find_bounds(const problem *p, const gsl_vector *x, sf_hyperfoam_fit *fit) {
    int each = per_term(p);
    for (int k = 0; k < p->terms; k++) {
        double alpha = fabs(fit->card.term[k].alpha);
        fit->at_bound[k][1] = alpha <= LEAST_ALPHA || alpha > (1 - AT_BOUND) * LARGEST_ALPHA;
        fit->at_bound[k][2] = each == 3 && is_at_end(logistic(gsl_vector_get(x, (size_t)(each * k + 2))));
    }
}

static void take_errors(const problem *p, const gsl_vector *x, const gsl_matrix *covariance, double factor,
                        sf_hyperfoam_fit *fit) {
    int each = per_term(p);
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++)
        for (int j = 0; j < 3; j++) {
            size_t at = (size_t)(each * k + j);
            bool fitted = k < p->terms && j < each;
            double part = fitted && j == 2 ? logistic(gsl_vector_get(x, at)) : 0;
            double bend = fit->card.term[k].alpha / LARGEST_ALPHA; /* tanh, as take_terms() has it */
            double scale = j == 2 ? LARGEST_NU * part * (1 - part) : j == 1 ? 1 - bend * bend : 1;
            fit->error[k][j] = fitted && !fit->at_bound[k][j]
                                   ? scale * sqrt(factor * gsl_matrix_get(covariance, at, at))
                                   : NAN;
        }
}

static sf_status fit_terms(problem *p, sf_hyperfoam_fit *fit, sf_error *err) {
    size_t size = (size_t)(per_term(p) * p->terms);
    size_t count = (size_t)(p->data->test.loading + p->data->lateral_count);
    gsl_vector *x = gsl_vector_alloc(size), *best = gsl_vector_alloc(size);
    gsl_matrix *covariance = gsl_matrix_alloc(size, size);
    int choice[SF_HYPERFOAM_TERMS] = {0, 1, 2};
    double least = INFINITY;
    do {
        start(p, choice, x);
        double sum = sf_least_squares(deviate, p, count, x, NULL);
        if (sum < least) {
            least = sum;
            gsl_vector_memcpy(best, x);
        }
    } while (next_choice(p->terms, choice));
    if (isfinite(least))
        least = sf_least_squares(deviate, p, count, best, covariance);
    if (isfinite(least)) {
        take_terms(p, best, &fit->card);
        find_bounds(p, best, fit);
        take_errors(p, best, covariance, least / (double)(count > size ? count - size : 1), fit);
    } else {
        SF_FAIL(err, SF_ERR_NUMERIC, "no search for %d terms of the hyperfoam converges", p->terms);
    }
    gsl_vector_free(x);
    gsl_vector_free(best);
    gsl_matrix_free(covariance);
    return err->status;
}

static sf_status fit_unloading(problem *p, sf_hyperfoam_fit *fit, sf_error *err) {
    const sf_compression_test *t = &p->data->test;
    sf_hyperfoam foam = sf_hyperfoam_build(&fit->card);
    size_t count = (size_t)(t->count - t->loading);
    double lateral = 0, peak = 0, *loading = sf_alloc(err, count, sizeof *loading, "unloading"),
           *ratio = sf_alloc(err, count, sizeof *ratio, "unloading");
    gsl_vector *x = gsl_vector_alloc(3);
    if (err->status == SF_OK) {
        sf_hyperfoam_free_stress(&foam, t->largest_strain, &lateral, &peak);
        for (size_t k = 0; k < count; k++) {
            loading[k] =
                sf_hyperfoam_free_stress(&foam, fmax(0, t->strain[t->loading + (int)k]), &lateral, &ratio[k]);
            ratio[k] = fmin(1, ratio[k] / peak);
        }
        p->loading = loading;
        p->ratio = ratio;
        gsl_vector_set(x, 0, -2);
        gsl_vector_set(x, 1, -3);
        gsl_vector_set(x, 2, -2);
        double sum = sf_least_squares(deviate_unloading, p, count, x, NULL);
        if (isfinite(sum)) {
            take_unloading(x, &fit->card);
            for (size_t k = 0; k < 3; k++)
                fit->unloading_at_bound[k] = is_at_end(logistic(gsl_vector_get(x, k)));
            fit->unloading_rms = sqrt(sum / (double)count);
        }
    }
    gsl_vector_free(x);
    free(loading);
    free(ratio);
    return err->status;
}

bool sf_hyperfoam_fit_is_poor(const sf_hyperfoam_fit *fit) {
    return fit->stress_rms > POOR || fit->lateral_rms > POOR || fit->unloading_rms > POOR;
}

static void measure(const problem *p, sf_hyperfoam_fit *fit) {
    const sf_compression_test *t = &p->data->test;
    sf_hyperfoam foam = sf_hyperfoam_build(&fit->card);
    double lateral = 0, energy, stress = 0, side = 0;
    for (int i = 0; i < t->loading; i++)
        stress += pow(sf_hyperfoam_free_stress(&foam, t->strain[i], &lateral, &energy) - t->stress[i], 2);
    lateral = 0;
    for (int i = 0; i < p->data->lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, p->data->lateral_at[i], &lateral, &energy);
        side += pow(lateral - p->data->lateral[i], 2);
    }
    fit->poisson[0] = sf_hyperfoam_poisson(&foam, 0.01);
    fit->poisson[1] = sf_hyperfoam_poisson(&foam, t->largest_strain);
    fit->stress_rms = sqrt(stress / t->loading) / t->largest_stress;
    fit->lateral_rms =
        p->data->lateral_count ? sqrt(side / p->data->lateral_count) / p->largest_lateral : NAN;
}

sf_status sf_hyperfoam_fit_run(const sf_hyperfoam_data *data, const sf_hyperfoam_card *card, int terms,
                               double nu, sf_hyperfoam_fit *fit, sf_error *err) {
    problem p = {.data = data, .card = *card, .terms = terms};
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    *fit = (sf_hyperfoam_fit){.card = *card, .unloading_rms = NAN};
    for (int i = 0; i < data->lateral_count; i++)
        p.largest_lateral = fmax(p.largest_lateral, fabs(data->lateral[i]));
    p.largest_lateral = fmax(p.largest_lateral, 0.01); /* a foam without lateral strain */
    for (int k = 0; k < terms; k++)
        p.card.term[k].nu = fit->card.term[k].nu = nu;
    if (fit_terms(&p, fit, err) == SF_OK && data->test.count - data->test.loading > 3)
        fit_unloading(&p, fit, err);
    if (err->status == SF_OK)
        measure(&p, fit);
    gsl_set_error_handler(handler);
    return err->status;
}
