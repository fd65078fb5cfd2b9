/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/foam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err) {
    *foam = (sf_foam){
        .options = sf_foam_options_build(&card->shared),
        .modulus = card->modulus,
        .cutoff = card->tension_cutoff,
        .curve_count = card->curve_count,
    };
    foam->curve = sf_alloc(err, (unsigned long)card->curve_count, sizeof *foam->curve, "curves");
    foam->curve_rate = sf_alloc(err, (unsigned long)card->curve_count, sizeof *foam->curve_rate, "curves");
    for (int64_t k = 0; k < card->curve_count && err->status == SF_OK; k++) {
        foam->curve_rate[k] = card->curve_rate[k];
        sf_curve_build(card, k, &foam->curve[k], err);
    }
    if (err->status != SF_OK)
        sf_foam_free(foam);
    return err->status;
}

void sf_foam_free(sf_foam *foam) {
    for (int64_t k = 0; foam->curve && k < foam->curve_count; k++)
        sf_curve_free(&foam->curve[k]);
    free(foam->curve);
    free(foam->curve_rate);
    *foam = (sf_foam){0};
}

static const double REST = 1e-6; /* strain below which a direction counts as at rest */

/* The larger modulus of tension and of compression, Pa. */
static double rest_stiffness(const sf_foam *foam) {
    return fmax(foam->modulus, foam->curve[0].piece[0].c[1]);
}

/* `slope`, which stabilisation and DAMP follow, stays that of the firm foam near the pole: their stiffness
 * has no energy of its own, and one that grows a thousandfold and falls back in a few steps would feed the
 * pad. */
static SF_KERNEL void base_law(const void *numbers, double stretch[3][SF_LANES], sf_foam_loading *law) {
    const sf_foam *foam = numbers;
    double modulus = foam->modulus, cutoff = foam->cutoff, yield = cutoff / modulus;
    double rest = rest_stiffness(foam), firm = foam->curve[0].firm_slope;
    memset(law->energy, 0, sizeof law->energy);
    for (int i = 0; i < 3; i++) {
        double strain[SF_LANES], stress[SF_LANES], slope[SF_LANES], energy[SF_LANES];
        double *restrict t = law->t[i], *restrict tangent = law->slope[i],
                         *restrict steepest = law->steepest[i];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            strain[l] = 1 - stretch[i][l];
        sf_curve_evaluate_lanes(&foam->curve[0], strain, stress, slope, energy);
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double pull = -strain[l] * modulus, work = 0.5 * strain[l] * strain[l] * modulus;
            bool squeezed = strain[l] > 0, elastic = pull <= cutoff, still = fabs(strain[l]) < REST;
            t[l] = squeezed ? -stress[l] : elastic ? pull : cutoff;
            double own = squeezed ? slope[l] : elastic ? modulus : 0;
            tangent[l] = squeezed ? sf_smaller(own, firm) : own;
            steepest[l] = still ? rest : own;
            law->energy[l] += squeezed ? energy[l] : elastic ? work : cutoff * (-strain[l] - 0.5 * yield);
        }
    }
}

/* Part of the strain at which the curve's densification starts, from which a step may reach it. */
static const double NEAR_DENSE = 0.9;

static void slopes_ahead(const void *numbers, double next[3][SF_LANES], double steepest[3][SF_LANES]) {
    const sf_curve *curve = &((const sf_foam *)numbers)->curve[0];
    for (int i = 0; i < 3; i++)
        for (int l = 0; l < SF_LANES; l++) {
            double stress, slope, energy;
            if (1 - next[i][l] < curve->start)
                continue;
            sf_curve_evaluate(curve, 1 - next[i][l], &stress, &slope, &energy);
            steepest[i][l] = fmax(steepest[i][l], slope);
        }
}

double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope,
                          double *rate_slope) {
    const double *r = foam->curve_rate;
    int64_t k = foam->curve_count - 2;
    *slope = *rate_slope = 0;
    if (!(rate > r[0]) || !(strain > 0))
        return 0;
    while (k > 0 && rate < r[k])
        k--;
    double low, high, low_slope, high_slope, base, base_slope, energy;
    sf_curve_evaluate(&foam->curve[0], strain, &base, &base_slope, &energy);
    sf_curve_evaluate(&foam->curve[k], strain, &low, &low_slope, &energy);
    sf_curve_evaluate(&foam->curve[k + 1], strain, &high, &high_slope, &energy);
    double span = log(r[k + 1] / r[k]), x = fmin(1, log(rate / r[k]) / span);
    *slope = fmax(0, low_slope + x * (high_slope - low_slope) - base_slope);
    *rate_slope = x < 1 ? fmax(0, (high - low) / (span * rate)) : 0;
    return low + x * (high - low) - base;
}

/* Adds the rate overstress of lane l to the principal second Piola-Kirchhoff stress; returns a bound on its
 * tangent: slopes, the shear moduli between directions, and what a change of the filtered rate does to all
 * three. */
static double add_overstress(const sf_foam *foam, const sf_law_batch *b, int l, sf_foam_rate *rate) {
    double bound = 0, rates = 0, extra[3];
    for (int i = 0; i < 3; i++) {
        double slope, rate_slope;
        extra[i] =
            sf_foam_overstress(foam, 1 - b->stretch[i][l], b->history[SF_FOAM_RATE][l], &slope, &rate_slope);
        rate->part[i][l] -= extra[i] / b->stretch[i][l];
        bound = fmax(bound, slope);
        rates += rate_slope * rate_slope;
    }
    for (int i = 0; i < 3; i++) {
        double gap = b->stretch[(i + 1) % 3][l] - b->stretch[i][l];
        if (fabs(gap) > 1e-7)
            bound = fmax(bound, (extra[i] - extra[(i + 1) % 3]) / gap);
    }
    return bound + sqrt(rates) / foam->filter_time;
}

static void overstress(const void *numbers, double dt, sf_law_batch *b, const sf_foam_loading *law,
                       sf_foam_rate *rate) {
    (void)law;
    const sf_foam *foam = numbers;
    sf_foam_point_filter(&foam->options, dt, b, rate);
    for (int l = 0; l < SF_LANES; l++)
        rate->extra[l] = add_overstress(foam, b, l, rate);
}

void sf_foam_update(const sf_foam *foam, double dt, sf_law_batch *b) {
    const sf_foam_kind kind = {.numbers = foam,
                               .rest = rest_stiffness(foam),
                               .compression = true,
                               .loading = base_law,
                               .dense = 1 - NEAR_DENSE * foam->curve[0].start,
                               .ahead = slopes_ahead,
                               .overstress = foam->curve_count > 1 ? overstress : NULL};
    sf_foam_point_update(&foam->options, &kind, dt, b);
}

double sf_foam_uniaxial(const sf_foam *foam, double dt, double strain, sf_uniaxial *point) {
    double stress, slope, energy, rate_slope, stretch = 1 - strain;
    double green_rate = sf_foam_green_rate(dt, strain, point);
    if (strain > 0) {
        sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, &energy);
    } else {
        stress = fmax(foam->modulus * strain, -foam->cutoff);
        energy = 0.5 * stress * stress / foam->modulus - stress * (stress / foam->modulus - strain);
    }
    double factor = sf_foam_axial_factor(&foam->options, energy, point),
           gain = sf_foam_axial_gain(&foam->options, dt, green_rate, stretch, point);
    stress *= strain > 0 ? factor + gain : factor;
    if (foam->curve_count > 1)
        stress += sf_foam_overstress(foam, strain,
                                     sf_foam_axial_filter(&foam->options, dt, green_rate, stretch, point),
                                     &slope, &rate_slope);
    point->strain = strain;
    return stress - stretch * sf_foam_axial_viscous(&foam->options, dt, green_rate, point);
}
