/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The curve of a form with a lock-up of its own, as a table in a card; and the foam that a fit varies: a
 * start material with a form, whose card takes a set of values. */
#pragma once
#include "material/foam_card.h"
#include "study/fit/form/curve_forms.h"

/* A foam may lock up earlier than the form says: skins, glue layers and folded cell walls take room, too.
 * With locked_fraction above 0 every form has its pole at e_D = 1 - locked_fraction, if that lies below its
 * own. From 0.95 e_D on the densification law with that pole continues its stress and slope. The form `table`
 * has it in its card alone. */
double sf_curve_form_pole(const sf_curve_form *form, const double *value);
/* Stress (Pa) at `count` strains from 0 on, below the pole; INFINITY from a lock-up on. */
void sf_curve_form_stresses(const sf_curve_form *form, const double *value, int count, const double *strain,
                            double *stress);
double sf_curve_form_stress(const sf_curve_form *form, const double *value, double strain);

/* Zeroed curves, `points` in all, of equal lengths. Release with sf_law_curves_free. */
sf_status sf_form_curves_alloc(int64_t count, int64_t points, sf_law_curves *curves, sf_error *err);

/* Puts the curve, as a table to 0.975 of its pole (or 1 GPa) with the densification law beyond, in place of
 * every curve of the card. On failure the card is unchanged: SF_ERR_NUMERIC if the values make no curve or
 * one that falls. Not for the form `table`. */
sf_status sf_curve_form_tabulate(const sf_curve_form *form, const double *value, sf_foam_card *card,
                                 sf_error *err);

/* The form that a fit varies; all other values are the start material's. */
typedef struct sf_foam_form {
    sf_foam_card base;          /* the start material; curves owned */
    const sf_curve_form *curve; /* of the table of forms; borrowed */
    double solid_density;       /* kg m-3, of the solid in the cell walls; 0: not known */
} sf_foam_form;

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

/* A card with these values; its arrays are owned by the caller (sf_foam_card_free). SF_ERR_NUMERIC if the
 * values make no curve. */
sf_status sf_foam_form_card(const sf_foam_form *form, const double value[SF_PARAMETER_COUNT],
                            sf_foam_card *card, sf_error *err);
/* Puts a fine table, to 0.975 of the strain limit or 1 GPa, in place of each curve and its densification. */
sf_status sf_foam_card_resample(sf_foam_card *card, sf_error *err);
void sf_foam_card_free(sf_foam_card *card);
