/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/hyperfoam.h"

#include "base/lane_math.h"
#include <stdbool.h>
#include <string.h>

double sf_hyperfoam_beta(const sf_hyperfoam_term *term) {
    return term->beta + term->nu / (1 - 2 * term->nu);
}

sf_hyperfoam sf_hyperfoam_build(const sf_hyperfoam_card *card) {
    sf_hyperfoam foam = {.options = sf_foam_options_build(&card->shared)};
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++)
        if (card->term[k].mu != 0) {
            foam.mu[foam.count] = card->term[k].mu;
            foam.alpha[foam.count] = card->term[k].alpha;
            foam.beta[foam.count] = sf_hyperfoam_beta(&card->term[k]);
            foam.rest += 2 * foam.mu[foam.count] * (1 + foam.beta[foam.count]);
            foam.count++;
        }
    return foam;
}

/* ---- a batch ---- */

/* Adds one term: its stresses times the stretch, its energy, its slopes times the stretch squared, and the
 * coupling d2W / dli dlj = `coupling` / (li lj). */
static inline void add_term(double mu, double alpha, double beta, double logarithm[3][SF_LANES],
                            sf_foam_loading *law, double coupling[SF_LANES]) {
    double twice = 2 * mu / alpha, energy = twice / alpha, squash = beta != 0 ? energy / beta : 0;
    double volume[SF_LANES];
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
        double rest, sum = logarithm[0][l] + logarithm[1][l] + logarithm[2][l];
        volume[l] = sf_lane_expm1(-alpha * beta * sum, &rest);
        law->energy[l] += squash * rest;
        coupling[l] += 2 * mu * beta * (1 + volume[l]);
    }
    for (int i = 0; i < 3; i++)
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double rest, power = sf_lane_expm1(alpha * logarithm[i][l], &rest);
            law->energy[l] += energy * rest;
            law->t[i][l] += twice * (power - volume[l]);
            law->slope[i][l] +=
                twice * (alpha * (1 + beta) + (alpha - 1) * power + (1 + alpha * beta) * volume[l]);
        }
}

static SF_KERNEL void loading(const void *numbers, double stretch[3][SF_LANES], sf_foam_loading *law) {
    const sf_hyperfoam *foam = numbers;
    double logarithm[3][SF_LANES], inverse[3][SF_LANES], coupling[SF_LANES] = {0};
    memset(law, 0, sizeof *law);
    for (int i = 0; i < 3; i++)
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            logarithm[i][l] = sf_lane_log(stretch[i][l]);
            inverse[i][l] = 1 / stretch[i][l];
        }
    for (int k = 0; k < foam->count; k++)
        add_term(foam->mu[k], foam->alpha[k], foam->beta[k], logarithm, law, coupling);
    for (int i = 0; i < 3; i++) {
        const double *one = inverse[i], *two = inverse[(i + 1) % 3], *three = inverse[(i + 2) % 3];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            law->t[i][l] *= one[l];
            law->slope[i][l] *= one[l] * one[l];
            law->steepest[i][l] = law->slope[i][l] + fabs(coupling[l]) * one[l] * (two[l] + three[l]);
        }
    }
}

void sf_hyperfoam_update(const sf_hyperfoam *foam, double dt, sf_law_batch *b) {
    const sf_foam_kind kind = {.numbers = foam, .rest = foam->rest, .loading = loading};
    sf_foam_point_update(&foam->options, &kind, dt, b);
}

/* ---- one point ---- */

sf_hyperfoam_point sf_hyperfoam_evaluate(const sf_hyperfoam *foam, const double stretch[3]) {
    sf_hyperfoam_point out = {0};
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += log(stretch[i]);
    for (int k = 0; k < foam->count; k++) {
        double mu = foam->mu[k], alpha = foam->alpha[k], beta = foam->beta[k], z = -alpha * beta * sum;
        double volume = expm1(z), scale = 2 * mu / (alpha * alpha);
        out.energy += beta != 0 ? scale * (volume - z) / beta : 0;
        for (int i = 0; i < 3; i++) {
            double x = alpha * log(stretch[i]), power = expm1(x);
            out.energy += scale * (power - x);
            out.t[i] += scale * alpha * (power - volume) / stretch[i];
            out.slope[i][i] += scale * alpha *
                               (alpha * (1 + beta) + (alpha - 1) * power + (1 + alpha * beta) * volume) /
                               (stretch[i] * stretch[i]);
            for (int j = 0; j < 3; j++)
                out.slope[i][j] += i == j ? 0 : 2 * mu * beta * (1 + volume) / (stretch[i] * stretch[j]);
        }
    }
    return out;
}

double sf_hyperfoam_poisson(const sf_hyperfoam *foam, double strain) {
    double stretch[3] = {1 - strain, 1, 1};
    return sf_hyperfoam_release(foam, 1, stretch) ? -log(stretch[1]) / log(stretch[0]) : NAN;
}

bool sf_hyperfoam_release(const sf_hyperfoam *foam, int held, double stretch[3]) {
    enum { TURNS = 60 };
    const double largest = 0.2; /* of a change of the logarithm */
    for (int turn = 0; turn < TURNS; turn++) {
        for (int i = held; i < 3; i++)
            stretch[i] = stretch[held];
        sf_hyperfoam_point p = sf_hyperfoam_evaluate(foam, stretch);
        double x = stretch[held], slope = x * p.t[held]; /* of the Kirchhoff stress, by the logarithm */
        for (int j = held; j < 3; j++)
            slope += x * x * p.slope[held][j];
        double step = -x * p.t[held] / slope;
        if (!(slope > 0) || !isfinite(step))
            return false;
        step = fmax(-largest, fmin(largest, step));
        stretch[held] = x * exp(step);
        if (fabs(step) < 1e-15)
            break;
    }
    for (int i = held; i < 3; i++)
        stretch[i] = stretch[held];
    return true;
}
