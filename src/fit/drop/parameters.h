/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a foam that drops can identify, and their conversion to a foam card. */
#ifndef SF_FIT_DROP_PARAMETERS_H
#define SF_FIT_DROP_PARAMETERS_H

#include "core/foam_card.h"
#include "core/units.h"
#include <stdbool.h>

typedef enum sf_foam_parameter {
    SF_PARAMETER_E,
    SF_PARAMETER_S0, /* of the gas curve (gas_curve.h) */
    SF_PARAMETER_P0,
    SF_PARAMETER_B,
    SF_PARAMETER_M,
    SF_PARAMETER_STRESS_SCALE, /* of a tabulated curve */
    SF_PARAMETER_EXPONENT,     /* of densification beyond it */
    SF_PARAMETER_HU,
    SF_PARAMETER_SHAPE,
    SF_PARAMETER_DAMP,
    SF_PARAMETER_ED,
    SF_PARAMETER_BETA1,
    SF_PARAMETER_ETA,
    SF_PARAMETER_COUNT,
} sf_foam_parameter;

typedef struct sf_parameter_info {
    const char *name;
    sf_quantity quantity; /* SF_QUANTITY_COUNT: a number without unit */
    const char *unit;     /* for people, of `per_unit` SI */
    double per_unit;
    double low, high;        /* SI, bounds of a start value */
    double prior_sd;         /* default, of the logarithm */
    bool of_gas, of_table;   /* belongs to one form of the curve only */
    const char *description; /* one phrase */
} sf_parameter_info;

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter);
/* SF_PARAMETER_COUNT if there is none of that name. */
sf_foam_parameter sf_parameter_find(const char *name);

/* The form that a fit varies; all other values are the start material's. */
typedef struct sf_foam_form {
    sf_foam_card base; /* the start material; curves owned */
    bool gas;          /* the loading curve is a gas curve; else the base's table, scaled */
} sf_foam_form;

/* Start values (SI) of every parameter, from the base and, for the gas curve, from values usual for
 * closed-cell foams: s0 = 0.02 E, p0 = 101 kPa but at most E/2, B = p0/4, m = 3. */
void sf_foam_form_start(const sf_foam_form *form, double value[SF_PARAMETER_COUNT]);

/* A card with these values; its arrays are owned by the caller (sf_foam_card_free). SF_ERR_NUMERIC if the
 * values make no curve (p0 not below E, m not above 1). */
sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err);
sf_status sf_foam_card_copy(const sf_foam_card *from, sf_foam_card *to, sf_error *err);
/* Puts a fine table, up to 0.975 of the strain limit, in place of each curve and its densification. */
sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err);
void sf_foam_card_free(sf_foam_card *card);

#endif
