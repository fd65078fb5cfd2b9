/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthetic laboratory for identification from drops: foams drawn from the prior, their drops measured with
 * noise, identified by space mapping, and the intervals counted. The "simulation" is a stiffer and thinner
 * set of columns than the surrogate, so that the correction has to work; hundreds of drops then cost seconds.
 * The whole chain with three-dimensional drops is in tests/test_fit_drop.c. */
#include "material/low_density_foam.h"
#include "study.h"

#include "study/column.h"
#include "study/fit/form/form.h"
#include "study/fit/space_mapping.h"
#include "point_fixture.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <string.h>

enum { REPEATS = 40, UNKNOWNS = 5, DROPS = 3, RESPONSES = 2 * DROPS };

static const sf_foam_parameter unknown[UNKNOWNS] = {SF_PARAMETER_S0, SF_PARAMETER_P0, SF_PARAMETER_B,
                                                    SF_PARAMETER_M, SF_PARAMETER_ED};
static const double median[UNKNOWNS] = {8e3, 120e3, 30e3, 2.7, 3e6};
static const double width[UNKNOWNS] = {0.4, 0.2, 0.5, 0.12, 0.4};
static const double speed[DROPS + 1] = {4.5, 5.2, 6.2, 4.5}; /* the last is predicted: another thickness */
static const double A_MAX_SD = 0.01, HIC_SD = 0.02;

typedef struct laboratory {
    sf_foam_form form;
    int simulations;
} laboratory;

/* The hemisphere of 160 mm on a pad; `area` and `thickness` make the simulation differ from the surrogate. */
static sf_columns columns_of(double v, double thickness, double area) {
    sf_columns c = {.mass = 4.6, .speed = v, .thickness = thickness, .count = SF_COLUMNS};
    double height = fmin(0.08, thickness);
    for (int k = 0; k < c.count; k++) {
        c.gap[k] = height * (k + 0.5) / c.count;
        c.area[k] = area * 2 * M_PI * (0.08 - c.gap[k]) * height / c.count;
    }
    return c;
}

static sf_status respond(const laboratory *lab, const double *u, int first, int last, double area,
                         double thickness, double *y, sf_error *err) {
    double value[SF_PARAMETER_COUNT];
    sf_foam_card card;
    sf_foam foam;
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    sf_foam_form_start(&lab->form, value);
    value[SF_PARAMETER_BETA1] = 5000;
    for (int k = 0; k < UNKNOWNS; k++)
        value[unknown[k]] = exp(u[k]);
    if (sf_foam_form_card(&lab->form, value, &card, err) != SF_OK)
        return err->status;
    if (sf_foam_build(&card, &foam, err) == SF_OK)
        for (int d = first; d < last && err->status == SF_OK; d++) {
            sf_columns c = columns_of(speed[d], (d < DROPS ? 0.07 : 0.05) * thickness, area);
            sf_columns_figures figures = {.a_max_g = 0};
            sf_columns_respond(&c, &law, &figures, NULL, err);
            y[2 * (d - first)] = log(figures.a_max_g);
            y[2 * (d - first) + 1] = log(figures.hic);
        }
    sf_foam_free(&foam);
    sf_foam_card_free(&card);
    return err->status;
}

static sf_status surrogate(void *context, const double *u, double *y, sf_error *err) {
    return respond(context, u, 0, DROPS, 1, 1, y, err);
}

static sf_status simulate(void *context, const double *u, double *y, sf_error *err) {
    laboratory *lab = context;
    lab->simulations++;
    return respond(context, u, 0, DROPS, 1.15, 0.97, y, err);
}

/* How often the truth lies in its interval, and how far it lies from the estimate in standard deviations. */
typedef struct tally {
    int inside[UNKNOWNS], predicted;
    double squares, shrinkage[UNKNOWNS];
    int converged, simulations;
} tally;

static double deviation(const sf_mapping_result *r, const double *gradient) {
    double sum = 0;
    for (int j = 0; j < UNKNOWNS; j++)
        for (int k = 0; k < UNKNOWNS; k++)
            sum += gradient[j] * r->covariance[j][k] * gradient[k];
    return sqrt(sum);
}

/* The drop on the thinner pad: predicted with the estimate, its interval by the surrogate's gradient. */
static sf_status predict(laboratory *lab, const sf_mapping_result *r, const double *truth, tally *t,
                         sf_error *err) {
    double real[2] = {0}, best[2] = {0}, high[2] = {0}, low[2] = {0}, gradient[UNKNOWNS], u[UNKNOWNS];
    if (respond(lab, truth, DROPS, DROPS + 1, 1.15, 0.97, real, err) != SF_OK ||
        respond(lab, r->u, DROPS, DROPS + 1, 1.15, 0.97, best, err) != SF_OK)
        return err->status;
    for (int j = 0; j < UNKNOWNS; j++) {
        memcpy(u, r->u, sizeof u);
        u[j] += 1e-3;
        respond(lab, u, DROPS, DROPS + 1, 1, 1, high, err);
        u[j] -= 2e-3;
        respond(lab, u, DROPS, DROPS + 1, 1, 1, low, err);
        gradient[j] = (high[0] - low[0]) / 2e-3;
    }
    t->predicted += fabs(real[0] - best[0]) < 1.96 * deviation(r, gradient);
    return err->status;
}

static sf_status repeat(laboratory *lab, gsl_rng *random, tally *t, sf_error *err) {
    double truth[UNKNOWNS], prior[UNKNOWNS], measured[RESPONSES], sd[RESPONSES];
    for (int k = 0; k < UNKNOWNS; k++) {
        prior[k] = log(median[k]);
        truth[k] = prior[k] + gsl_ran_gaussian(random, width[k]);
    }
    if (simulate(lab, truth, measured, err) != SF_OK)
        return err->status;
    for (int i = 0; i < RESPONSES; i++) {
        sd[i] = i % 2 ? HIC_SD : A_MAX_SD;
        measured[i] += gsl_ran_gaussian(random, sd[i]);
    }
    lab->simulations = 0;
    const sf_mapping_problem p = {.parameters = UNKNOWNS,
                                  .responses = RESPONSES,
                                  .start = prior,
                                  .prior = prior,
                                  .prior_sd = width,
                                  .measured = measured,
                                  .sd = sd,
                                  .surrogate = surrogate,
                                  .simulate = simulate,
                                  .context = lab,
                                  .max_iterations = 8,
                                  .tolerance = 0.1};
    sf_mapping_result r;
    if (sf_mapping_solve(&p, &r, err) == SF_OK) {
        for (int k = 0; k < UNKNOWNS; k++) {
            double z = (r.u[k] - truth[k]) / sqrt(r.covariance[k][k]);
            t->inside[k] += fabs(z) < 1.96;
            t->squares += z * z;
            t->shrinkage[k] += sqrt(r.covariance[k][k]) / width[k];
        }
        t->converged += r.converged;
        t->simulations += lab->simulations;
        predict(lab, &r, truth, t, err);
    }
    sf_mapping_free(&r);
    return err->status;
}

int main(int argc, char **argv) {
    sf_study study;
    sf_error err = SF_ERROR_INIT;
    static const double strain[] = {0, 0.02, 0.5, 0.9}, stress[] = {0, 8e3, 80e3, 2e6};
    point_card card;
    point_card_init(&card);
    point_card_add(&card, 0, 4, strain, stress);
    laboratory lab = {.form = {.curve = &sf_form_gas, .base = card.card}};
    lab.form.base.modulus = 0.4136e6;
    lab.form.base.hysteresis_hu = 0.01;
    tally t = {.converged = 0};
    gsl_set_error_handler_off();
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937); /* its default seed: the same numbers in every run */
    sf_study_begin(&study, "identification_drop", "Identification from drops: a synthetic laboratory", argc,
                   argv);
    for (int k = 0; k < REPEATS && err.status == SF_OK; k++)
        repeat(&lab, random, &t, &err);
    gsl_rng_free(random);
    if (err.status != SF_OK) {
        sf_study_fail(&study, &err);
        return sf_study_end(&study);
    }
    sf_study_text(
        &study,
        "The study draws %d foams from the prior. Each has drops at 4.5, 5.2 and 6.2 m/s on 70 mm, with a "
        "noise of %.0f %% in the measured a_max and %.0f %% in HIC. The simulation has 15 %% more "
        "area and 3 %% less thickness than the surrogate. A fit takes %.1f simulations of each drop "
        "on average.\n\n"
        "| parameter | truth inside its 95 %% interval | width left of the prior |\n|---|---|---|\n",
        REPEATS, 100 * A_MAX_SD, 100 * HIC_SD, (double)t.simulations / REPEATS);
    int inside = 0;
    int least = REPEATS;
    for (int k = 0; k < UNKNOWNS; k++) {
        inside += t.inside[k];
        least = t.inside[k] < least ? t.inside[k] : least;
        sf_study_text(&study, "| %s | %.0f %% | %.0f %% |\n", sf_parameter_get(unknown[k])->name,
                      100. * t.inside[k] / REPEATS, 100 * t.shrinkage[k] / REPEATS);
    }
    sf_study_text(&study, "\n");
    sf_study_check(&study, (double)t.converged / REPEATS, 0.95, 1, "fits that converged");
    sf_study_check(&study, (double)t.simulations / REPEATS, 2, 6, "simulations of each drop");
    /* 95 % of 40 foams, five parameters of a foam being almost one observation: three binomial deviations */
    sf_study_check(&study, (double)inside / (UNKNOWNS * REPEATS), 0.90, 1,
                   "true value inside the 95 %% interval");
    sf_study_check(&study, (double)least / REPEATS, 0.825, 1, /* less has a probability of 0.001 */
                   "the same, for the parameter with the fewest");
    sf_study_check(&study, t.squares / (UNKNOWNS * REPEATS), 0.6, 1.3,
                   "mean square of (estimate - truth) / deviation");
    sf_study_check(&study, (double)t.predicted / REPEATS, 0.87, 1,
                   "a_max of the unmeasured drop on 50 mm inside its interval");
    return sf_study_end(&study);
}
