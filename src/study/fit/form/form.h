/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms of the loading curve of a foam, for identification: nominal stress against compressive strain as a
 * function of a few parameters, with what is known of them beforehand (theory, section "Forms of the loading
 * curve"). Each is an entry of the table forms.def. Pure functions of a set of values [SF_PARAMETER_COUNT] in
 * SI (parameter.h). */
#ifndef SF_FIT_FORM_FORM_H
#define SF_FIT_FORM_FORM_H

#include "material/foam_card.h"
#include "study/fit/form/parameter.h"

/* A parameter of a form. */
typedef struct sf_form_entry {
    sf_foam_parameter parameter;
    double prior_sd; /* of the logarithm */
    bool usual;      /* identified unless the user lists the unknowns */
} sf_form_entry;

typedef struct sf_curve_form {
    const char *name;    /* of curve_form */
    const char *formula; /* for people; e is the strain; without full stop */
    int entry_count;
    const sf_form_entry *entry; /* [entry_count]; static storage */
    /* Medians of the form's priors into `value`, from E and the solid fraction that are there (0: not known).
     */
    void (*start)(double *value);
    /* SF_ERR_NUMERIC: the values make no curve, with the reason. */
    sf_status (*check)(const double *value, sf_error *err);
    /* Strain at which the stress becomes infinite, at most 1. */
    double (*pole)(const double *value);
    /* Stress (Pa) at `count` strains, 0 <= strain < pole. NULL, with check and pole: the curve is the start
     * material's (table). */
    void (*stress)(const double *value, int count, const double *strain, double *stress);
} sf_curve_form;

#define SF_CURVE_FORM(form) extern const sf_curve_form sf_form_##form;
#include "study/fit/form/forms.def"
#undef SF_CURVE_FORM

enum {
#define SF_CURVE_FORM(form) SF_CURVE_FORM_##form,
#include "study/fit/form/forms.def"
#undef SF_CURVE_FORM
    SF_CURVE_FORMS
};

/* Of the table, 0 <= index < SF_CURVE_FORMS. */
const sf_curve_form *sf_curve_form_get(int index);
/* NULL if there is none of that name. */
const sf_curve_form *sf_curve_form_find(const char *name);
/* "gas|gas_solid|...", all names; static storage. */
const char *sf_curve_form_words(void);

/* Of the form's parameters; NULL: it has none of that kind. */
const sf_form_entry *sf_curve_form_entry(const sf_curve_form *form, sf_foam_parameter parameter);
/* Does the form use it: its own parameter, or one of every foam (E, unloading, viscosity)? */
bool sf_curve_form_uses(const sf_curve_form *form, sf_foam_parameter parameter);

/* Stress (Pa) at one strain. Not for the form `table`. */
double sf_curve_form_stress(const sf_curve_form *form, const double *value, double strain);

/* Puts the curve, as a table to 0.975 of its pole (or 1 GPa) with the densification law beyond, in place of
 * every curve of the card. On failure the card is unchanged: SF_ERR_NUMERIC if the values make no curve or
 * one that falls. Not for the form `table`. */
sf_status sf_curve_form_tabulate(const sf_curve_form *form, const double *value, sf_foam_card *card,
                                 sf_error *err);

#endif
