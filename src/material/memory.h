/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/lanes.h"
#include <math.h>
#include <stdbool.h>

/* Unloading of the foam laws (theory eq. 14 to 16): the factor f = 1 - (1 - HU) (1 - w^SHAPE)^ALPHA on the
 * stress, w = W / (its largest so far), and the energies that follow from its integral over w. With ALPHA
 * other than 1 the integral is a pair of power series, in w^SHAPE and in 1 - w^SHAPE, each for values up to
 * 1/2. */

enum { SF_UNLOADING_TERMS = 48 };

/* Below this SHAPE the second series does not converge: for ALPHA other than 1. */
#define SF_UNLOADING_LEAST_SHAPE 0.05
/* Part of the largest W over which the tangent of unloading is a mean (theory, "Hysteresis"). */
#define SF_UNLOADING_BAND 1e-3

typedef struct sf_unloading {
    double hu, shape, alpha; /* - */
    double whole;            /* -, integral of (1 - w^SHAPE)^ALPHA from 0 to 1 */
    double steepest;         /* -, bound on the derivative of f by w */
    double low[SF_UNLOADING_TERMS], high[SF_UNLOADING_TERMS]; /* of the series; ALPHA other than 1 */
} sf_unloading;

void sf_unloading_build(double hu, double shape, double alpha, sf_unloading *out);

/* The factor at w = `ratio`. */
static inline double sf_unloading_factor(double hu, double shape, double alpha, double ratio) {
    double rest = 1 - (shape == 1 ? ratio : pow(ratio, shape));
    return 1 - (1 - hu) * (alpha == 1 ? rest : pow(rest, alpha));
}

/* Integral of (1 - w^SHAPE)^ALPHA from 0 to `ratio`. */
double sf_unloading_integral(const sf_unloading *u, double ratio);

typedef struct sf_unloaded {
    double factor[SF_LANES];    /* -, on the stress */
    double softening[SF_LANES]; /* m3 J-1, its derivative by W, for the time step */
    double stored[SF_LANES];    /* J m-3, recoverable */
    double lost[SF_LANES];      /* J m-3 */
} sf_unloaded;

/* Evaluates a batch at W = energy (J m-3) and the largest W so far, `peak`, which it raises. */
void sf_unloading_lanes(const sf_unloading *u, const double energy[SF_LANES], double peak[SF_LANES],
                        sf_unloaded *out);

/* Memory of the foam laws (theory, section "Memory"): below the largest W so far a second loading follows the
 * factor f + q (1 - f), f that of unloading. Between the two lies an elastic range: with the energy gap
 * Z = integral of (1 - f) over W the factor is f + p (1 - f), dp = dZ / L within 0 <= p <= q. Where p stands
 * at q, what is loaded further is lost; hence no path creates energy, whatever q does. q falls with the
 * unloadings that a point has passed, and grows with time at rest. */

/* L over the largest Z so far. */
#define SF_MEMORY_ELASTIC 0.2

/* Parameters; a foam with `reload` and `recovery` 0 has no memory beyond the largest W: q = 0. */
typedef struct sf_memory {
    double reload;       /* -, q of the second loading, 0 .. 1 */
    double drift;        /* -, q of loading n + 1 is reload / (1 + drift (n - 1)) */
    double recovery;     /* -, part of the softening that a decade of time at rest takes back */
    double start;        /* s, time at rest from which decades count */
    double permanent;    /* -, part that stays for ever */
    double set;          /* -, part of a drop's largest displacement that is left at once (solver/set.h) */
    double set_recovery; /* -, part of the set that a decade of time at rest takes back */
} sf_memory;

static inline bool sf_memory_acts(const sf_memory *m) {
    return m->reload > 0 || m->recovery > 0;
}

/* The history of a point beside its largest W. */
typedef struct sf_memory_point {
    double back;      /* J m-3, Z - L p */
    double loops;     /* J m-3, lost in loading below the largest W */
    double passes;    /* -, unloadings since the largest W, 1: a whole one */
    double recovered; /* -, part of the softening that rests have taken back; it fades with unloading */
} sf_memory_point;

/* q of the point. */
double sf_memory_factor(const sf_memory *memory, const sf_memory_point *point);

/* A rest of `pause` (s) without load, in closed form: two rests give the same as one of their sum. Returns
 * the part of the largest W that it leaves: 0 once all has recovered, so that the foam is new again. */
double sf_memory_rest(const sf_memory *memory, double pause, sf_memory_point *point);

/* Evaluates a batch as sf_unloading_lanes does, with memory; rows of `point` are its members. `softening`
 * bounds the derivative of the factor on both sides of a reversal. */
void sf_memory_lanes(const sf_memory *memory, const sf_unloading *unloading, const double energy[SF_LANES],
                     double peak[SF_LANES], double (*point)[SF_LANES], sf_unloaded *out);

/* The factor at one point, which it advances. */
double sf_memory_advance(const sf_memory *memory, const sf_unloading *unloading, double energy, double *peak,
                         sf_memory_point *point);
