/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a foam that drops can identify, and their conversion to a foam card. */
#ifndef SF_FIT_DROP_PARAMETERS_H
#define SF_FIT_DROP_PARAMETERS_H

#include "study/fit/form/form.h"

/* The form that a fit varies; all other values are the start material's. */
typedef struct sf_foam_form {
    sf_foam_card base;          /* the start material; curves owned */
    const sf_curve_form *curve; /* of the table of forms; borrowed */
    double solid_density;       /* kg m-3, of the solid in the cell walls; 0: not known */
} sf_foam_form;

/* SF_ERR_INPUT: solid_density is not plausible for this foam (the foam must be lighter than half of it, and a
 * solid has between 300 and 20,000 kg/m3). */
sf_status sf_foam_form_check_solid(const sf_foam_form *form, sf_error *err);

/* Start values (SI) of every parameter: medians of the form's priors, and the base's own values. The solid
 * fraction is density over solid_density, 0 if that is not known (gas_solid: then 0.05). */
void sf_foam_form_start(const sf_foam_form *form, double value[SF_PARAMETER_COUNT]);

/* Gives a foam without rate factor the median of its prior: 0.1 for a decade of the rate. */
void sf_foam_form_start_rate(double value[SF_PARAMETER_COUNT]);

/* Gives a foam without a lock-up of its own the median of its prior: dense at 1 - 1.4 Phi. */
void sf_foam_form_start_lock(double value[SF_PARAMETER_COUNT]);

/* Default width of the prior of a parameter, of the logarithm: the form's own; the solid fraction's is wide
 * where solid_density is not known. */
double sf_foam_form_prior_sd(const sf_foam_form *form, sf_foam_parameter parameter);

/* The parameters that are identified where the user does not say: the form's usual ones and ED. Returns their
 * number. */
int sf_foam_form_usual(const sf_foam_form *form, sf_foam_parameter usual[SF_PARAMETER_COUNT]);

/* A card with these values; its arrays are owned by the caller (sf_foam_card_free). SF_ERR_NUMERIC if the
 * values make no curve. */
sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err);
sf_status sf_foam_card_copy(const sf_foam_card *from, sf_foam_card *to, sf_error *err);
/* Puts a fine table, up to 0.975 of the strain limit or 1 GPa, in place of each curve and its densification.
 */
sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err);
void sf_foam_card_free(sf_foam_card *card);

#endif
