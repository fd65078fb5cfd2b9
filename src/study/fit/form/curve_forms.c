/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/curve_forms.h"

#include "material/curve.h"

static const double ATMOSPHERE = 101325; /* Pa */
static const double DENSE = 1.4;         /* e_D = 1 - DENSE Phi (Gibson and Ashby) */
static const double MOST_SOLID = 0.6;    /* Phi, with which e_D is 0.16 */
static const double LEAST_PART = 1e-3;   /* of E that the cell walls have at least */

/* The entry of a form: its parameters are NAME_entries, its medians NAME_start. */
#define FORM(form, text, ...)                                                                                \
    const sf_curve_form sf_form_##form = {.name = #form,                                                     \
                                          .formula = text,                                                   \
                                          .entry = form##_entries,                                           \
                                          .entry_count = sizeof form##_entries / sizeof *form##_entries,     \
                                          .start = form##_start,                                             \
                                          __VA_ARGS__}

double sf_form_dense_strain(double solid) {
    return 1 - DENSE * solid;
}

static double pole_at_one(const double *value) {
    (void)value;
    return 1;
}

static double pole_of_solid(const double *value) {
    return sf_form_dense_strain(fmax(0, value[SF_PARAMETER_SOLID_FRACTION]));
}

/* Size of a foam's stresses, for medians: the atmosphere's pressure (Pa), at most half the modulus. */
static double pressure_of(const double *value) {
    return fmin(ATMOSPHERE, value[SF_PARAMETER_E] / 2);
}

/* ---- gas: cells full of gas, the solid fraction neglected ---- */

/* A physically shaped compression curve of a closed-cell foam:
 *
 *     sigma(e) = s0 (1 - exp(-(E - p0/(1 - Phi)) e/s0)) + p0 e/(1 - e - Phi) + B (e/(e_D - e))^m,
 *
 * yield of the cell walls at s0; isothermal compression of the gas in the cells, which is beside the solid
 * fraction Phi (Gibson and Ashby); densification with its pole at e_D = 1 - 1.4 Phi. The initial slope is E.
 * With Phi = 0 both poles are at 1. */
typedef struct gas_curve {
    double modulus;  /* Pa, E */
    double yield;    /* Pa, s0 > 0 */
    double pressure; /* Pa, p0 */
    double factor;   /* Pa, B >= 0 */
    double exponent; /* -, m > 1 */
    double solid;    /* -, Phi >= 0 */
} gas_curve;

/* Nominal stress (Pa) at a compressive strain, 0 <= strain < e_D. */
static double gas_curve_stress(const gas_curve *curve, double strain) {
    double gas = curve->pressure / (1 - curve->solid),
           slope = fmax(curve->modulus - gas, LEAST_PART * curve->modulus);
    return -curve->yield * expm1(-slope * strain / curve->yield) +
           curve->pressure * strain / (1 - strain - curve->solid) +
           curve->factor * pow(strain / (sf_form_dense_strain(curve->solid) - strain), curve->exponent);
}

static gas_curve gas_curve_of(const double *value, double solid) {
    return (gas_curve){.modulus = value[SF_PARAMETER_E],
                       .yield = value[SF_PARAMETER_S0],
                       .pressure = value[SF_PARAMETER_P0],
                       .factor = value[SF_PARAMETER_B],
                       .exponent = value[SF_PARAMETER_M],
                       .solid = solid};
}

/* SF_ERR_NUMERIC: no rising curve. Where the gas alone is stiffer than E the curve begins with its stiffness.
 */
static sf_status check_gas_curve(gas_curve c, sf_error *err) {
    if (!(c.solid >= 0 && c.solid < MOST_SOLID))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "the solid fraction" SF_OUTSIDE("%g", "0", "%g") ": that is no foam", c.solid,
                       MOST_SOLID);
    if (!(c.exponent > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC, "m = %g is not above 1: the initial slope is not E", c.exponent);
    return SF_OK;
}

static void fill_gas_stresses(gas_curve curve, int count, const double *strain, double *out) {
    for (int k = 0; k < count; k++)
        out[k] = gas_curve_stress(&curve, strain[k]);
}

/* Medians of s0, p0, B and m: B and m such that a foam with or without solid fraction densifies alike. */
static void start_gas_curve(double *value, double solid) {
    double pressure = pressure_of(value);
    value[SF_PARAMETER_S0] = 0.02 * value[SF_PARAMETER_E];
    value[SF_PARAMETER_P0] = pressure;
    value[SF_PARAMETER_B] = solid > 0 ? pressure / 5 : pressure / 4;
    value[SF_PARAMETER_M] = solid > 0 ? 2.5 : 3;
}

static const sf_form_entry gas_entries[] = {{SF_PARAMETER_S0, 0.7, true},
                                            {SF_PARAMETER_P0, 0.3, true},
                                            {SF_PARAMETER_B, 1, true},
                                            {SF_PARAMETER_M, 0.3, true}};

static void gas_start(double *value) {
    start_gas_curve(value, 0);
}

static sf_status gas_check(const double *value, sf_error *err) {
    return check_gas_curve(gas_curve_of(value, 0), err);
}

static void gas_stress(const double *value, int count, const double *strain, double *out) {
    fill_gas_stresses(gas_curve_of(value, 0), count, strain, out);
}

FORM(gas, "s0 (1 - exp(-(E - p0) e/s0)) + p0 x + B x^m with x = e/(1 - e)", .check = gas_check,
     .pole = pole_at_one, .stress = gas_stress);

/* ---- gas_solid: the gas has the room that the solid fraction Phi leaves, and the foam is dense at
 * 1 - 1.4 Phi. Phi is known from the densities of foam and solid; p0 is near the atmosphere's ---- */

static const double USUAL_SOLID_FRACTION = 0.05;

static const sf_form_entry gas_solid_entries[] = {{SF_PARAMETER_S0, 0.7, true},
                                                  {SF_PARAMETER_P0, 0.15, true},
                                                  {SF_PARAMETER_B, 1, true},
                                                  {SF_PARAMETER_M, 0.3, true},
                                                  {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

static void gas_solid_start(double *value) {
    if (!(value[SF_PARAMETER_SOLID_FRACTION] > 0))
        value[SF_PARAMETER_SOLID_FRACTION] = USUAL_SOLID_FRACTION;
    start_gas_curve(value, value[SF_PARAMETER_SOLID_FRACTION]);
}

static sf_status gas_solid_check(const double *value, sf_error *err) {
    return check_gas_curve(gas_curve_of(value, value[SF_PARAMETER_SOLID_FRACTION]), err);
}

static void gas_solid_stress(const double *value, int count, const double *strain, double *out) {
    fill_gas_stresses(gas_curve_of(value, value[SF_PARAMETER_SOLID_FRACTION]), count, strain, out);
}

FORM(gas_solid,
     "s0 (1 - exp(-(E - p0/(1 - Phi)) e/s0)) + p0 e/(1 - e - Phi) + B (e/(e_D - e))^m with Phi = "
     "solid_fraction, e_D = 1 - 1.4 Phi",
     .check = gas_solid_check, .pole = pole_of_solid, .stress = gas_solid_stress);

/* ---- rusch (Rusch 1969): two powers of the strain, for plateau and densification. A power below 1 has an
 * infinite slope at 0; the strain is shifted by e_0, so that the initial slope is E. Two powers are finite at
 * full compression: from rusch_end on, the densification law with its pole continues them ---- */

static const sf_form_entry rusch_entries[] = {
    {SF_PARAMETER_RUSCH_A, 0.7, true},    {SF_PARAMETER_RUSCH_M, 0.4, true},
    {SF_PARAMETER_RUSCH_B, 1, true},      {SF_PARAMETER_RUSCH_N, 0.3, true},
    {SF_PARAMETER_RUSCH_END, 0.1, false}, {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

/* Starts with a foam like that of the gas curve at its medians. */
static void rusch_start(double *value) {
    double size = pressure_of(value);
    value[SF_PARAMETER_RUSCH_A] = 0.6 * size;
    value[SF_PARAMETER_RUSCH_M] = 0.4;
    value[SF_PARAMETER_RUSCH_B] = 32 * size;
    value[SF_PARAMETER_RUSCH_N] = 5.2;
    value[SF_PARAMETER_RUSCH_END] = 0.8;
}

static sf_status rusch_check(const double *value, sf_error *err) {
    double m = value[SF_PARAMETER_RUSCH_M], n = value[SF_PARAMETER_RUSCH_N],
           end = value[SF_PARAMETER_RUSCH_END], limit = pole_of_solid(value);
    if (!(m > 0 && m < 1 && n > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "rusch_m is %g, outside 0 to 1, or rusch_n = %g is not above 1: no curve with a "
                       "plateau",
                       m, n);
    if (!(end > 0 && end < limit))
        return SF_FAIL(err, SF_ERR_NUMERIC, "rusch_end" SF_OUTSIDE("%g", "0", "the pole of the curve, %g"),
                       end, limit);
    return SF_OK;
}

static void rusch_stress(const double *value, int count, const double *strain, double *out) {
    double a = value[SF_PARAMETER_RUSCH_A], m = value[SF_PARAMETER_RUSCH_M], b = value[SF_PARAMETER_RUSCH_B],
           n = value[SF_PARAMETER_RUSCH_N], end = value[SF_PARAMETER_RUSCH_END], limit = pole_of_solid(value),
           shift = pow(a * m / value[SF_PARAMETER_E], 1 / (1 - m)), /* e_0, where A m e^(m - 1) = E */
        at_end = a * (pow(end + shift, m) - pow(shift, m)) + b * pow(end, n),
           slope = a * m * pow(end + shift, m - 1) + b * n * pow(end, n - 1), ignored[2];
    const sf_densification beyond = sf_densification_join(
        end, limit, sf_densification_steep_exponent(end, limit, at_end, slope), at_end, slope, 0);
    for (int k = 0; k < count; k++)
        if (strain[k] <= end)
            out[k] = a * (pow(strain[k] + shift, m) - pow(shift, m)) + b * pow(strain[k], n);
        else
            sf_densification_evaluate(&beyond, strain[k], &out[k], &ignored[0], &ignored[1]);
}

FORM(rusch,
     "A ((e + e0)^m - e0^m) + B e^n with e0 from the initial slope E, to the strain rusch_end; beyond it A' "
     "+ B'/(1 - 1.4 Phi - e)^n'",
     .check = rusch_check, .pole = pole_of_solid, .stress = rusch_stress);

/* ---- avalle (Avalle, Belingardi and Ibba 2007): a plateau that saturates, and a power of e/(1 - e) ---- */

static const sf_form_entry avalle_entries[] = {{SF_PARAMETER_AVALLE_A, 0.7, true},
                                               {SF_PARAMETER_AVALLE_M, 0.7, true},
                                               {SF_PARAMETER_AVALLE_B, 1, true},
                                               {SF_PARAMETER_AVALLE_N, 0.3, true}};

/* Starts with a foam like that of the gas curve at its medians. */
static void avalle_start(double *value) {
    double size = pressure_of(value);
    value[SF_PARAMETER_AVALLE_A] = 0.4 * size;
    value[SF_PARAMETER_AVALLE_M] = 1;
    value[SF_PARAMETER_AVALLE_B] = 0.75 * size;
    value[SF_PARAMETER_AVALLE_N] = 2.35;
}

static sf_status avalle_check(const double *value, sf_error *err) {
    if (!(value[SF_PARAMETER_AVALLE_N] > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC, "avalle_n = %g is not above 1: the initial slope is not E",
                       value[SF_PARAMETER_AVALLE_N]);
    return SF_OK;
}

static void avalle_stress(const double *value, int count, const double *strain, double *out) {
    double a = value[SF_PARAMETER_AVALLE_A], ratio = value[SF_PARAMETER_E] / a,
           m = value[SF_PARAMETER_AVALLE_M], b = value[SF_PARAMETER_AVALLE_B],
           n = value[SF_PARAMETER_AVALLE_N];
    for (int k = 0; k < count; k++) {
        double e = strain[k];
        out[k] = -a * expm1(-ratio * e * pow(1 - e, m)) + b * pow(e / (1 - e), n);
    }
}

FORM(avalle, "A (1 - exp(-(E/A) e (1 - e)^m)) + B (e/(1 - e))^n", .check = avalle_check, .pole = pole_at_one,
     .stress = avalle_stress);

/* ---- spline: the gas curve at its medians (with the solid fraction, if it is known) times the exponential
 * of a cubic B-spline d(e) with knots every 0.15 strain. Its coefficients have a level, a growth from one to
 * the next, and second differences; those are the parameters, as exp of them, so that independent priors
 * around 1 are a smoothness prior on the logarithm of the stress (P-spline, Eilers and Marx 1996). The gas
 * curve's modulus is E exp(-d(0)): the initial slope stays E ---- */

enum { COEFFICIENTS = 9, INTERVALS = COEFFICIENTS - 3, MIDDLE = COEFFICIENTS / 2 };
static const double KNOT_STEP = 0.15; /* strain */

static const sf_form_entry spline_entries[] = {
    {SF_PARAMETER_SPLINE_1, 0.4, true},  {SF_PARAMETER_SPLINE_2, 0.1, true},
    {SF_PARAMETER_SPLINE_3, 0.15, true}, {SF_PARAMETER_SPLINE_4, 0.15, true},
    {SF_PARAMETER_SPLINE_5, 0.15, true}, {SF_PARAMETER_SPLINE_6, 0.15, true},
    {SF_PARAMETER_SPLINE_7, 0.15, true}, {SF_PARAMETER_SPLINE_8, 0.15, true},
    {SF_PARAMETER_SPLINE_9, 0.15, true}, {SF_PARAMETER_S0, 0.7, true},
    {SF_PARAMETER_P0, 0.15, false},      {SF_PARAMETER_B, 1, false},
    {SF_PARAMETER_M, 0.3, false},        {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

static void spline_start(double *value) {
    start_gas_curve(value, value[SF_PARAMETER_SOLID_FRACTION]);
    for (int k = 0; k < COEFFICIENTS; k++)
        value[SF_PARAMETER_SPLINE_1 + k] = 1;
}

/* Level and growth about the middle coefficient; the bend at coefficient j adds to those on the side away
 * from the middle, so that the level stays. */
static void fill_coefficients(const double *value, double c[COEFFICIENTS]) {
    const double *z = &value[SF_PARAMETER_SPLINE_1];
    for (int k = 0; k < COEFFICIENTS; k++) {
        c[k] = log(z[0]) + (k - MIDDLE) * log(z[1]);
        for (int j = 1; j <= COEFFICIENTS - 2; j++) /* second difference at j: z[j + 1] */
            c[k] += log(z[j + 1]) * (j < MIDDLE ? fmax(0, j - k) : fmax(0, k - j));
    }
}

/* d; constant beyond the last knot. */
static double deviation(const double c[COEFFICIENTS], double strain) {
    double t = fmin(strain / KNOT_STEP, INTERVALS);
    int i = (int)fmin(t, INTERVALS - 1);
    double u = t - i, v = 1 - u;
    return (v * v * v * c[i] + (3 * u * u * u - 6 * u * u + 4) * c[i + 1] +
            (3 * v * v * v - 6 * v * v + 4) * c[i + 2] + u * u * u * c[i + 3]) /
           6;
}

/* The gas curve below the spline, whose coefficients go into `c`. */
static gas_curve curve_below(const double *value, double c[COEFFICIENTS]) {
    gas_curve curve = gas_curve_of(value, fmax(0, value[SF_PARAMETER_SOLID_FRACTION]));
    fill_coefficients(value, c);
    curve.modulus *= exp(-deviation(c, 0));
    return curve;
}

static sf_status spline_check(const double *value, sf_error *err) {
    double c[COEFFICIENTS];
    return check_gas_curve(curve_below(value, c), err);
}

static void spline_stress(const double *value, int count, const double *strain, double *out) {
    double c[COEFFICIENTS];
    fill_gas_stresses(curve_below(value, c), count, strain, out);
    for (int k = 0; k < count; k++)
        out[k] *= exp(deviation(c, strain[k]));
}

FORM(spline, "the gas curve at its medians times exp(d(e)), d a cubic spline with knots every 0.15",
     .check = spline_check, .pole = pole_of_solid, .stress = spline_stress);

/* ---- table: the start material's curve, scaled; its densification law stays ---- */

static const sf_form_entry table_entries[] = {{SF_PARAMETER_STRESS_SCALE, 0.3, true},
                                              {SF_PARAMETER_EXPONENT, 0.3, false}};

static void table_start(double *value) {
    value[SF_PARAMETER_STRESS_SCALE] = 1;
}

FORM(table, "the start material's curve times stress_scale", .stress = NULL);

/* ---- the table of the forms ---- */

static const sf_curve_form *const forms[SF_CURVE_FORMS] = {
#define SF_CURVE_FORM(form) &sf_form_##form,
    SF_CURVE_FORM_LIST(SF_CURVE_FORM)
#undef SF_CURVE_FORM
};

const sf_curve_form *sf_curve_form_get(int index) {
    return forms[index];
}

const sf_curve_form *sf_curve_form_find(const char *name) {
    for (int k = 0; k < SF_CURVE_FORMS; k++)
        if (strcmp(forms[k]->name, name) == 0)
            return forms[k];
    return NULL;
}

const char *sf_curve_form_words(void) {
#define SF_CURVE_FORM(form) "|" #form
    static const char words[] = SF_CURVE_FORM_LIST(SF_CURVE_FORM);
#undef SF_CURVE_FORM
    return words + 1;
}

const sf_form_entry *sf_curve_form_entry(const sf_curve_form *form, sf_foam_parameter parameter) {
    for (int k = 0; k < form->entry_count; k++)
        if (form->entry[k].parameter == parameter)
            return &form->entry[k];
    return NULL;
}

bool sf_curve_form_uses(const sf_curve_form *form, sf_foam_parameter parameter) {
    bool of_a_form = false;
    if (parameter == SF_PARAMETER_LOCKED)
        return true;
    for (int k = 0; k < SF_CURVE_FORMS; k++)
        of_a_form = of_a_form || sf_curve_form_entry(forms[k], parameter);
    return !of_a_form || sf_curve_form_entry(form, parameter);
}
