/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/memory.h"

/* Decay of what has recovered, with each whole unloading: 5 % remain. */
static const double RENEWAL = 3;

static inline double factor_of(const sf_memory *m, double passes, double recovered) {
    double q = m->reload / (1 + m->drift * sf_larger(passes - 1, 0));
    return q + recovered * (1 - q);
}

double sf_memory_factor(const sf_memory *m, const sf_memory_point *p) {
    return factor_of(m, p->passes, p->recovered);
}

void sf_memory_rest(const sf_memory *m, double pause, sf_memory_point *p) {
    double most = 1 - m->permanent;
    if (!(m->recovery > 0) || p->recovered >= most)
        return;
    double before = pow(10, p->recovered / m->recovery), after = log10(before + pause / m->start);
    p->recovered = fmin(most, m->recovery * after);
}

/* One step of a point: `z` at the W of the step, `top` the largest Z before it, `risen` the new one if this W
 * is the largest, else -1. Returns p. At a W beyond all before, 1 - f is 0: the range begins anew, and what
 * its elastic part held is lost. */
static inline double step(const sf_memory *m, double z, double top, double risen, double *restrict back,
                          double *restrict loops, double *restrict passes, double *restrict recovered) {
    double length = sf_larger(SF_MEMORY_ELASTIC * top, 1e-300), q = factor_of(m, *passes, *recovered);
    double trial = (z - *back) / length, low = sf_larger(trial, 0), p = sf_smaller(low, q);
    bool virgin = risen >= 0;
    double rest, slid = SF_MEMORY_ELASTIC * sf_larger(-trial, 0),
                 younger = *passes * top / sf_larger(risen, 1e-300);
    *loops += q * length * (low - p) + (virgin ? 0.5 * length * p * p : 0);
    *passes = virgin ? younger : *passes + slid;
    *recovered = virgin ? 0 : *recovered * (1 + sf_lane_expm1(-RENEWAL * slid, &rest));
    *back = virgin ? risen : z - length * p;
    return virgin ? 0 : p;
}

SF_KERNEL void sf_memory_lanes(const sf_memory *m, const sf_unloading *u, const double energy[SF_LANES],
                               double peak[SF_LANES], double (*point)[SF_LANES], double factor[SF_LANES],
                               double softening[SF_LANES], double stored[SF_LANES], double lost[SF_LANES]) {
    double old[SF_LANES], share = (1 - u->hu) * u->whole;
    for (int l = 0; l < SF_LANES; l++)
        old[l] = peak[l];
    sf_unloading_lanes(u, energy, peak, factor, softening, stored, lost);
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
        bool below = energy[l] < old[l];
        double top = share * old[l], gap = 1 - factor[l], z = below ? energy[l] - stored[l] : top;
        double p = step(m, z, top, below ? -1 : share * peak[l], &point[0][l], &point[1][l], &point[2][l],
                        &point[3][l]);
        double length = sf_larger(SF_MEMORY_ELASTIC * top, 1e-300);
        factor[l] = 1 - gap * (1 - p);
        softening[l] = below ? softening[l] * (1 - p) + gap * gap / length : softening[l];
        stored[l] += 0.5 * length * p * p;
        lost[l] += point[1][l];
    }
}

double sf_memory_advance(const sf_memory *m, const sf_unloading *u, double energy, double *peak,
                         sf_memory_point *point) {
    double old = *peak, share = 1 - u->hu, top = share * u->whole * old;
    bool below = energy < old;
    double ratio = below ? energy / old : 1,
           z = share * old * (below ? sf_unloading_integral(u, ratio) : u->whole);
    double gap = below ? 1 - sf_unloading_factor(u->hu, u->shape, u->alpha, ratio) : 0;
    *peak = below ? old : energy;
    double p = step(m, z, top, below ? -1 : share * u->whole * energy, &point->back, &point->loops,
                    &point->passes, &point->recovered);
    return 1 - gap * (1 - p);
}
