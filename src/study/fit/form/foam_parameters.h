/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a foam that measurements identify: those of every foam, and those of the forms of its
 * loading curve (curve_forms.h). A set of values is an array [SF_PARAMETER_COUNT] in SI. */
#pragma once
#include "base/units.h"

/* X(id, name, unit, bounds, width, description): the unit for people, IN(quantity, unit, its size in SI), or
 * NUMBER; bounds of a start value in SI, FROM(low, high); default width of the prior, of the logarithm, which a
 * form may replace by its own. */
/* clang-format off */
#define SF_FIT_PARAMETERS(X, IN, NUMBER, FROM) \
    X(E, "E", IN(SF_PRESSURE, "MPa", 1e6), FROM(1e3, 1e10), 0.1, "modulus, and initial slope") \
    X(S0, "s0", IN(SF_PRESSURE, "kPa", 1e3), FROM(1, 1e9), 0.7, "yield stress of the cell walls") \
    X(P0, "p0", IN(SF_PRESSURE, "kPa", 1e3), FROM(1, 1e9), 0.3, "gas pressure") \
    X(B, "B", IN(SF_PRESSURE, "kPa", 1e3), FROM(1e-3, 1e9), 1, "densification stress") \
    X(M, "m", NUMBER, FROM(1.001, 10), 0.3, "densification exponent") \
    X(SOLID_FRACTION, "solid_fraction", NUMBER, FROM(1e-4, 0.5), 0.1, "part of the volume that is solid, Phi") \
    X(RUSCH_A, "rusch_A", IN(SF_PRESSURE, "kPa", 1e3), FROM(1, 1e9), 0.7, "stress of the plateau, of A e^m") \
    X(RUSCH_M, "rusch_m", NUMBER, FROM(0.01, 0.999), 0.4, "exponent of the plateau, below 1") \
    X(RUSCH_B, "rusch_B", IN(SF_PRESSURE, "kPa", 1e3), FROM(1e-3, 1e10), 1, "stress of densification, of B e^n") \
    X(RUSCH_N, "rusch_n", NUMBER, FROM(1.001, 40), 0.3, "exponent of densification, above 1") \
    X(RUSCH_END, "rusch_end", NUMBER, FROM(0.1, 0.97), 0.1, "strain from which the densification law continues the two powers") \
    X(AVALLE_A, "avalle_A", IN(SF_PRESSURE, "kPa", 1e3), FROM(1, 1e9), 0.7, "stress of the plateau") \
    X(AVALLE_M, "avalle_m", NUMBER, FROM(0.01, 60), 0.7, "exponent of softening on the plateau") \
    X(AVALLE_B, "avalle_B", IN(SF_PRESSURE, "kPa", 1e3), FROM(1e-3, 1e9), 1, "stress of densification, of B x^n") \
    X(AVALLE_N, "avalle_n", NUMBER, FROM(1.001, 20), 0.3, "exponent of densification, above 1") \
    X(SPLINE_1, "spline_1", NUMBER, FROM(1e-3, 1e3), 0.4, "factor on the whole gas curve") \
    X(SPLINE_2, "spline_2", NUMBER, FROM(1e-2, 1e2), 0.1, "its growth from one knot to the next") \
    X(SPLINE_3, "spline_3", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0") \
    X(SPLINE_4, "spline_4", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.15") \
    X(SPLINE_5, "spline_5", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.30") \
    X(SPLINE_6, "spline_6", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.45") \
    X(SPLINE_7, "spline_7", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.60") \
    X(SPLINE_8, "spline_8", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.75") \
    X(SPLINE_9, "spline_9", NUMBER, FROM(1e-2, 1e2), 0.15, "bend of the logarithm at a strain of 0.90") \
    X(LOCKED, "locked_fraction", NUMBER, FROM(1e-3, 0.5), 0.7, "part of the thickness that is left where the foam locks up, 1 - e_D") \
    X(STRESS_SCALE, "stress_scale", NUMBER, FROM(1e-3, 1e3), 0.3, "factor on the tabulated curve") \
    X(EXPONENT, "exponent", NUMBER, FROM(0.1, 50), 0.3, "exponent of the densification law") \
    X(HU, "HU", NUMBER, FROM(1e-4, 1), 0.5, "hysteretic unloading factor") \
    X(SHAPE, "SHAPE", NUMBER, FROM(1e-2, 100), 0.5, "shape of unloading") \
    X(ALPHA, "ALPHA", NUMBER, FROM(0.1, 10), 0.5, "second exponent of unloading") \
    X(DAMP, "DAMP", NUMBER, FROM(1e-4, 10), 0.5, "viscous coefficient") \
    X(ED, "ED", IN(SF_PRESSURE, "MPa", 1e6), FROM(1, 1e10), 1, "modulus of the Maxwell branch") \
    X(BETA1, "BETA1", IN(SF_RATE, "1/s", 1), FROM(1e-6, 1e9), 1, "its decay rate") \
    X(ETA, "eta", IN(SF_VISCOSITY, "Pa s", 1), FROM(1e-3, 1e6), 1, "Kelvin viscosity") \
    X(RATE_FACTOR, "rate_factor", NUMBER, FROM(1e-4, 10), 0.7, "growth of the stress with each decade of the strain rate") \
    X(RATE_REFERENCE, "rate_reference", IN(SF_RATE, "1/s", 1), FROM(1e-9, 1e6), 0.7, "strain rate up to which the curve holds as it is") \
    X(RATE_FILTER_TIME, "rate_filter_time", IN(SF_TIME, "ms", 1e-3), FROM(1e-6, 1e-2), 0.7, "time constant by which the rate factor follows the strain rate") \
    X(RELOAD, "reload", NUMBER, FROM(1e-3, 1), 0.5, "part that a second loading has of what unloading took (material.memory)") \
    X(DRIFT, "drift", NUMBER, FROM(1e-4, 10), 1, "fall of reload from loading to loading") \
    X(RECOVERY, "recovery", NUMBER, FROM(1e-4, 1), 1, "part of the softening that a decade of time at rest takes back")
/* clang-format on */

typedef enum sf_foam_parameter {
#define SF_FIT_PARAMETER_ID(id, ...) SF_PARAMETER_##id,
    SF_FIT_PARAMETERS(SF_FIT_PARAMETER_ID, , , )
#undef SF_FIT_PARAMETER_ID
        SF_PARAMETER_COUNT,
} sf_foam_parameter;

typedef struct sf_parameter_info {
    const char *name;
    sf_quantity quantity; /* SF_QUANTITY_COUNT: a number without unit */
    const char *unit;     /* for people, of `per_unit` SI */
    double per_unit;
    double low, high;        /* SI, bounds of a start value */
    double prior_sd;         /* default, of the logarithm */
    const char *description; /* one phrase */
} sf_parameter_info;

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter);

/* Bits: the law has a factor on the curve, a Maxwell branch. */
typedef enum sf_form_rate {
    SF_FORM_RATE_NONE,
    SF_FORM_RATE_FACTOR,
    SF_FORM_RATE_MAXWELL,
    SF_FORM_RATE_BOTH
} sf_form_rate;

/* Their names, and these as a list. */
extern const char *const sf_form_rate_names[];
#define SF_FORM_RATE_WORDS "none|factor|maxwell|both"

/* The bit of the parameter. */
sf_form_rate sf_form_rate_of(sf_foam_parameter parameter);
