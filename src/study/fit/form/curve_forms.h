/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms of the loading curve of a foam, for identification: nominal stress against compressive strain as a
 * function of a few parameters, with what is known of them beforehand (theory, section "Forms of the loading
 * curve"). Each is an entry of SF_CURVE_FORM_LIST. Pure functions of a set of values [SF_PARAMETER_COUNT] in
 * SI, by sf_foam_parameter. */
#pragma once
#include "base/error.h"
#include "study/fit/form/foam_parameters.h"

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
    /* Medians of the form's priors into `value`, from E and solid fraction that are there (0: unknown). */
    void (*start)(double *value);
    /* SF_ERR_NUMERIC: the values make no curve, with the reason. */
    sf_status (*check)(const double *value, sf_error *err);
    /* Strain at which the stress becomes infinite without an earlier lock-up, at most 1. */
    double (*pole)(const double *value);
    /* Stress (Pa) at `count` strains, 0 <= strain < pole. NULL, with check and pole: the curve is the start
     * material's (table). */
    void (*stress)(const double *value, int count, const double *strain, double *stress);
} sf_curve_form;

/* The forms, in the order of the documents; each is an entry sf_form_NAME of curve_forms.c. */
#define SF_CURVE_FORM_LIST(X) X(gas) X(gas_solid) X(rusch) X(avalle) X(spline) X(table)

#define SF_CURVE_FORM(form) extern const sf_curve_form sf_form_##form;
SF_CURVE_FORM_LIST(SF_CURVE_FORM)
#undef SF_CURVE_FORM

enum {
#define SF_CURVE_FORM(form) SF_CURVE_FORM_##form,
    SF_CURVE_FORM_LIST(SF_CURVE_FORM)
#undef SF_CURVE_FORM
        SF_CURVE_FORMS
};

/* Returns an entry of the table, 0 <= index < SF_CURVE_FORMS. */
const sf_curve_form *sf_curve_form_get(int index);
/* NULL if there is none of that name. */
const sf_curve_form *sf_curve_form_find(const char *name);
/* "gas|gas_solid|...", all names; static storage. */
const char *sf_curve_form_words(void);

/* Returns the entry of a parameter; NULL: the form has none of that kind. */
const sf_form_entry *sf_curve_form_entry(const sf_curve_form *form, sf_foam_parameter parameter);
/* True if the form uses the parameter: its own, or one of every foam (E, unloading, viscosity). */
bool sf_curve_form_uses(const sf_curve_form *form, sf_foam_parameter parameter);

/* Strain at which a foam of this solid fraction is dense, 1 - 1.4 Phi (Gibson and Ashby). */
double sf_form_dense_strain(double solid);
