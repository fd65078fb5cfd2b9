/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/foam_card.h"

/* The parameters of a foam that measurements identify: those of every foam, and those of the forms of its
 * loading curve (form.h). A set of values is an array [SF_PARAMETER_COUNT] in SI. */

/* X(id, name, quantity, unit, per_unit, low, high, prior_sd, description): the quantity, or NONE of a number;
 * `unit` for people, of `per_unit` SI; bounds in SI of a start value; default width of the prior, of the
 * logarithm, which a form may replace by its own. */
/* clang-format off */
#define SF_FIT_PARAMETERS(X, NONE) \
    X(E, "E", SF_PRESSURE, "MPa", 1e6, 1e3, 1e10, 0.1, "modulus, and initial slope") \
    X(S0, "s0", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.7, "yield stress of the cell walls") \
    X(P0, "p0", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.3, "gas pressure") \
    X(B, "B", SF_PRESSURE, "kPa", 1e3, 1e-3, 1e9, 1, "densification stress") \
    X(M, "m", NONE, "", 1, 1.001, 10, 0.3, "densification exponent") \
    X(SOLID_FRACTION, "solid_fraction", NONE, "", 1, 1e-4, 0.5, 0.1, "part of the volume that is solid, Phi") \
    X(RUSCH_A, "rusch_A", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.7, "stress of the plateau, of A e^m") \
    X(RUSCH_M, "rusch_m", NONE, "", 1, 0.01, 0.999, 0.4, "exponent of the plateau, below 1") \
    X(RUSCH_B, "rusch_B", SF_PRESSURE, "kPa", 1e3, 1e-3, 1e10, 1, "stress of densification, of B e^n") \
    X(RUSCH_N, "rusch_n", NONE, "", 1, 1.001, 40, 0.3, "exponent of densification, above 1") \
    X(RUSCH_END, "rusch_end", NONE, "", 1, 0.1, 0.97, 0.1, "strain from which the densification law continues the two powers") \
    X(AVALLE_A, "avalle_A", SF_PRESSURE, "kPa", 1e3, 1, 1e9, 0.7, "stress of the plateau") \
    X(AVALLE_M, "avalle_m", NONE, "", 1, 0.01, 60, 0.7, "exponent of softening on the plateau") \
    X(AVALLE_B, "avalle_B", SF_PRESSURE, "kPa", 1e3, 1e-3, 1e9, 1, "stress of densification, of B x^n") \
    X(AVALLE_N, "avalle_n", NONE, "", 1, 1.001, 20, 0.3, "exponent of densification, above 1") \
    X(SPLINE_1, "spline_1", NONE, "", 1, 1e-3, 1e3, 0.4, "factor on the whole gas curve") \
    X(SPLINE_2, "spline_2", NONE, "", 1, 1e-2, 1e2, 0.1, "its growth from one knot to the next") \
    X(SPLINE_3, "spline_3", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0") \
    X(SPLINE_4, "spline_4", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.15") \
    X(SPLINE_5, "spline_5", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.30") \
    X(SPLINE_6, "spline_6", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.45") \
    X(SPLINE_7, "spline_7", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.60") \
    X(SPLINE_8, "spline_8", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.75") \
    X(SPLINE_9, "spline_9", NONE, "", 1, 1e-2, 1e2, 0.15, "bend of the logarithm at a strain of 0.90") \
    X(LOCKED, "locked_fraction", NONE, "", 1, 1e-3, 0.5, 0.7, "part of the thickness that is left where the foam locks up, 1 - e_D") \
    X(STRESS_SCALE, "stress_scale", NONE, "", 1, 1e-3, 1e3, 0.3, "factor on the tabulated curve") \
    X(EXPONENT, "exponent", NONE, "", 1, 0.1, 50, 0.3, "exponent of the densification law") \
    X(HU, "HU", NONE, "", 1, 1e-4, 1, 0.5, "hysteretic unloading factor") \
    X(SHAPE, "SHAPE", NONE, "", 1, 1e-2, 100, 0.5, "shape of unloading") \
    X(ALPHA, "ALPHA", NONE, "", 1, 0.1, 10, 0.5, "second exponent of unloading") \
    X(DAMP, "DAMP", NONE, "", 1, 1e-4, 10, 0.5, "viscous coefficient") \
    X(ED, "ED", SF_PRESSURE, "MPa", 1e6, 1, 1e10, 1, "modulus of the Maxwell branch") \
    X(BETA1, "BETA1", SF_RATE, "1/s", 1, 1e-6, 1e9, 1, "its decay rate") \
    X(ETA, "eta", SF_VISCOSITY, "Pa s", 1, 1e-3, 1e6, 1, "Kelvin viscosity") \
    X(RATE_FACTOR, "rate_factor", NONE, "", 1, 1e-4, 10, 0.7, "growth of the stress with each decade of the strain rate") \
    X(RATE_REFERENCE, "rate_reference", SF_RATE, "1/s", 1, 1e-9, 1e6, 0.7, "strain rate up to which the curve holds as it is") \
    X(RATE_FILTER_TIME, "rate_filter_time", SF_TIME, "ms", 1e-3, 1e-6, 1e-2, 0.7, "time constant by which the rate factor follows the strain rate") \
    X(RELOAD, "reload", NONE, "", 1, 1e-3, 1, 0.5, "part that a second loading has of what unloading took (material.memory)") \
    X(DRIFT, "drift", NONE, "", 1, 1e-4, 10, 1, "fall of reload from loading to loading") \
    X(RECOVERY, "recovery", NONE, "", 1, 1e-4, 1, 1, "part of the softening that a decade of time at rest takes back")
/* clang-format on */

typedef enum sf_foam_parameter {
#define SF_FIT_PARAMETER_ID(id, ...) SF_PARAMETER_##id,
    SF_FIT_PARAMETERS(SF_FIT_PARAMETER_ID, )
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

/* Forms of the loading curve of a foam, for identification: nominal stress against compressive strain as a
 * function of a few parameters, with what is known of them beforehand (theory, section "Forms of the loading
 * curve"). Each is an entry of SF_CURVE_FORM_LIST. Pure functions of a set of values [SF_PARAMETER_COUNT] in
 * SI, by sf_foam_parameter. */

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

/* A foam may lock up earlier than the form says: skins, glue layers and folded cell walls take room, too.
 * With locked_fraction above 0 every form has its pole at e_D = 1 - locked_fraction, if that lies below its
 * own. From 0.95 e_D on the densification law with that pole continues its stress and slope. The form `table`
 * has it in its card alone. */
double sf_curve_form_pole(const sf_curve_form *form, const double *value);
/* Stress (Pa) at `count` strains from 0 on, below the pole; INFINITY from a lock-up on. */
void sf_curve_form_stresses(const sf_curve_form *form, const double *value, int count, const double *strain,
                            double *stress);
double sf_curve_form_stress(const sf_curve_form *form, const double *value, double strain);

/* Strain at which a foam of this solid fraction is dense, 1 - 1.4 Phi (Gibson and Ashby). */
double sf_form_dense_strain(double solid);

/* A physically shaped compression curve of a closed-cell foam:
 *
 *     sigma(e) = s0 (1 - exp(-(E - p0/(1 - Phi)) e/s0)) + p0 e/(1 - e - Phi) + B (e/(e_D - e))^m,
 *
 * yield of the cell walls at s0; isothermal compression of the gas in the cells, which is beside the solid
 * fraction Phi (Gibson and Ashby); densification with its pole at e_D = 1 - 1.4 Phi. The initial slope is E.
 * With Phi = 0 both poles are at 1. */
typedef struct sf_gas_curve {
    double modulus;  /* Pa, E */
    double yield;    /* Pa, s0 > 0 */
    double pressure; /* Pa, p0 */
    double factor;   /* Pa, B >= 0 */
    double exponent; /* -, m > 1 */
    double solid;    /* -, Phi >= 0 */
} sf_gas_curve;

/* Nominal stress (Pa) at a compressive strain, 0 <= strain < e_D. */
double sf_gas_curve_stress(const sf_gas_curve *curve, double strain);

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
