/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/foam_card.h"
#include "material/laws.h"

/* The common part of the foam laws at a material point: a law gives the loading energy W of the principal
 * stretches and its derivatives (sf_foam_kind); hysteresis, Maxwell branch, Kelvin and DAMP viscosity,
 * stress, work and bounds follow here (theory, section "Foam"). Pure functions on batches of SF_LANES
 * points; arrays are [component][lane]. Matrices are row-major (9) or symmetric (xx, yy, zz, xy, yz, xz). */

/* Numbers of hysteresis and viscosity. They are the first member of a law's numbers. */
typedef struct sf_foam_options {
    double density;                     /* kg m-3 */
    double hu, shape;                   /* - */
    double damp;                        /* - */
    double maxwell;                     /* Pa, ED */
    double maxwell_rate;                /* s-1, BETA1 */
    double kelvin;                      /* Pa s, eta */
    double rate_factor, rate_reference; /* -, s-1 */
    double filter_time;                 /* s */
    sf_unloading unloading;
    sf_memory memory;
} sf_foam_options;

sf_foam_options sf_foam_options_build(const sf_foam_shared *card);

/* Rows of sf_law_batch.history. */
enum {
    SF_FOAM_PEAK = 0,       /* J m-3, largest W so far */
    SF_FOAM_RATE = 1,       /* s-1, filtered rate of compression */
    SF_FOAM_MAXWELL = 2,    /* [6] Pa, second Piola-Kirchhoff stress of the Maxwell branch */
    SF_FOAM_OVERSTRESS = 8, /* [6] Pa, that of the rate factor or of the curves of several rates */
    SF_FOAM_MEMORY = 14,    /* [4] sf_memory_point */
};

/* sf_law.history of a foam law; `rates`: does the card depend on the rate? */
#define SF_FOAM_HISTORY(rates)                                                                               \
    {                                                                                                        \
        {"peak", "J m-3", SF_FOAM_PEAK, 1, NULL}, {"rate", "s-1", SF_FOAM_RATE, 1, rates},                   \
            {"maxwell", "Pa", SF_FOAM_MAXWELL, 6, sf_foam_has_maxwell},                                      \
            {"overstress", "Pa", SF_FOAM_OVERSTRESS, 6, rates},                                              \
            {"memory", "SI", SF_FOAM_MEMORY, 4, sf_foam_has_memory},                                         \
    }

/* The loading law at a batch. */
typedef struct sf_foam_loading {
    double t[3][SF_LANES];        /* Pa, nominal principal stress, dW by the stretch */
    double slope[3][SF_LANES];    /* Pa, its derivative by its own stretch */
    double steepest[3][SF_LANES]; /* Pa, bound on it with the coupling to the other two, by row sums; at
                                     rest, where a law has two slopes, the larger one */
    double energy[SF_LANES];      /* J m-3, W */
} sf_foam_loading;

/* The rate overstress of a batch; in and out. */
typedef struct sf_foam_rate {
    double part[3][SF_LANES];  /* Pa, principal second Piola-Kirchhoff stress, to which it adds */
    double factor[SF_LANES];   /* -, on the loading law's tangent; it may raise it */
    double extra[SF_LANES];    /* Pa, what else it adds to the bounds */
    double v[9][SF_LANES];     /* in: principal directions N, columns */
    double green[3][SF_LANES]; /* in: s-1, rate of the Green strain N . Ė N */
} sf_foam_rate;

/* The loading law of a foam law. */
typedef struct sf_foam_kind {
    const void *numbers;
    double rest;      /* Pa, the larger slope at rest */
    bool compression; /* the rate factor acts on compressed directions alone */
    void (*loading)(const void *numbers, double stretch[3][SF_LANES], sf_foam_loading *out);
    /* For a law that stiffens within a step: raises `steepest` to the slopes at the stretches of the next
     * step as the present rate has it; called where a stretch is below `dense`. NULL: none */
    double dense;
    void (*ahead)(const void *numbers, double next[3][SF_LANES], double steepest[3][SF_LANES]);
    /* Rate term of the law itself; NULL if the rate factor applies */
    void (*overstress)(const void *numbers, double dt, sf_law_batch *batch, const sf_foam_loading *law,
                       sf_foam_rate *rate);
} sf_foam_kind;

/* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. */
void sf_foam_point_update(const sf_foam_options *options, const sf_foam_kind *kind, double dt,
                          sf_law_batch *batch);

/* sf_law.rest of numbers that begin with sf_foam_options: memory, and what viscous stresses a rest of `pause`
 * (s) leaves. */
void sf_foam_point_rest(const void *numbers, double pause, double (*history)[SF_LANES]);

/* sf_law.softening of such numbers. */
double sf_foam_point_softening(const void *numbers, double (*history)[SF_LANES], int lane);

/* The members of sf_law that foam laws have in common; they name functions and lists of the law's file. */
#define SF_FOAM_LAW(card)                                                                                    \
    .card_size = sizeof(card), .parameter = parameters,                                                      \
    .parameter_count = sizeof parameters / sizeof parameters[0], .density = offsetof(card, shared.density),  \
    .length = offsetof(card, shared.damp_length), .rest_modulus = rest_modulus, .check = check,              \
    .check_keys = check_keys, .data_end = data_end, .informed = offsetof(card, shared.informed_strain),      \
    .rest_bounds = rest_bounds, .history = history, .history_count = sizeof history / sizeof history[0],     \
    .build = build, .energy = energy, .shift = sf_foam_shift, .rest = sf_foam_point_rest,                    \
    .softening = sf_foam_point_softening

/* For an overstress: advances the filtered rate of working, dW/dt over the sum of the compressive |T_i|
 * (`compression`), or of all directions over the largest |T_i|: in uniaxial compression the rate of nominal
 * strain (theory eq. 22). */
void sf_foam_point_filter(const sf_foam_options *options, bool compression, double dt, sf_law_batch *batch,
                          const sf_foam_loading *law, const sf_foam_rate *rate);

/* The parts of sf_law.uniaxial, `green_rate` (s-1) from sf_foam_green_rate. The factor of hysteresis at this
 * W (J m-3). */
double sf_foam_axial_factor(const sf_foam_options *options, double energy, sf_uniaxial *point);
/* The filtered rate (s-1) after the step, `working` (s-1) being the rate of working over the stress: that of
 * the strain in compression, of the stretch in tension, 0 where the rate does not act. */
double sf_foam_axial_filter(const sf_foam_options *options, double dt, double working, sf_uniaxial *point);
/* Returns the share that the rate factor adds to the factor on the stress of loading; 0 without one.
 * Advances the filtered rate. */
double sf_foam_axial_gain(const sf_foam_options *options, double dt, double working, sf_uniaxial *point);
/* Second Piola-Kirchhoff stress (Pa) of Maxwell branch and Kelvin viscosity. */
double sf_foam_axial_viscous(const sf_foam_options *options, double dt, double green_rate,
                             sf_uniaxial *point);
static inline double sf_foam_green_rate(double dt, double strain, const sf_uniaxial *point) {
    double stretch = 1 - strain, old = 1 - point->strain;
    return 0.5 * (stretch * stretch - old * old) / dt;
}

/* Stress (Pa, second Piola-Kirchhoff) of a Maxwell branch after a step of dt (s) at a constant rate of the
 * Green strain (s-1), from `held` before it: exact. */
static inline double sf_foam_maxwell(double modulus, double decay_rate, double dt, double green_rate,
                                     double held) {
    return exp(-decay_rate * dt) * held - modulus / decay_rate * expm1(-decay_rate * dt) * green_rate;
}

/* Eigenvalues of symmetric matrices by cyclic Jacobi: a [6][lane] in, its diagonal = eigenvalues out, v
 * [9][lane] eigenvectors as columns. */
void sf_foam_eigen(double a[6][SF_LANES], double v[9][SF_LANES]);
