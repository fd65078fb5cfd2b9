/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the low-density foam in the table of laws: its parameters, rules and uniaxial stress. The
 * update of a batch is in foam.c. */
#include "material/foam_card.h"
#include "material/foam.h"
#include "material/foam_parameters.h"

#include <math.h>
#include <stdlib.h>

/* A tensile strength that no foam reaches: finite, so that it can be stored and compared. */
static const double NO_CUTOFF = 1e30; /* Pa */

/* ---- parameters ---- */

static bool has_cutoff(const void *card) {
    return ((const sf_foam_card *)card)->tension_cutoff != NO_CUTOFF;
}
static bool has_rates(const void *card) {
    return ((const sf_foam_card *)card)->curve_count > 1 || sf_foam_has_rate_factor(card);
}
static bool has_limit(const void *card) {
    return ((const sf_foam_card *)card)->densification_limit < 1;
}

#define AT(member) .offset = offsetof(sf_foam_card, member)
/* clang-format off */
static const sf_parameter parameters[] = {
    SF_FOAM_DENSITY,
    {"material", "E", SF_PARAMETER_QUANTITY, NULL, AT(modulus),
     "modulus in tension, and the least stiffness of the stabilisation", .quantity = SF_PRESSURE, .low = 1.0, .high = 1e12,
     SF_FOAM_IN("MPa", 1e6)},
    {"material", "curve", SF_PARAMETER_CURVE, "", AT(curves),
     "compression curve, a CSV file (see below); relative to the file that names it"},
    {"material", "curves", SF_PARAMETER_CURVES, "", AT(curves),
     "instead of `curve`: curves at several strain rates, ascending: ( { rate = \"0.0017 1/s\"; file = \"slow.csv\"; }, ... )"},
    SF_FOAM_PARAMETERS,
    {"material", "tension_cutoff", SF_PARAMETER_QUANTITY, "\"none\"", AT(tension_cutoff),
     "largest tensile nominal stress, or \"none\"", .quantity = SF_PRESSURE, SF_FOAM_POSITIVE, .high = 1e12,
     .words = "none", .word_value = NO_CUTOFF, SF_FOAM_IN("kPa", 1e3), .acts = has_cutoff},
    SF_FOAM_RATE_FACTOR("strain rate of `curve`"),
    SF_FOAM_RATE_FILTER("that chooses among `curves` or acts in `rate_factor`", has_rates),
    SF_FOAM_INFORMED,
    {"material.densification", "rule", SF_PARAMETER_CHOICE, "\"H1\"", AT(densification_rule),
     "law beyond the table: H1: A + B/(1 - strain)^n; H2: A + B/(limit - strain)^m; value and slope continuous",
     .words = "H1|H2"},
    {"material.densification", "start", SF_PARAMETER_NUMBER, "0.0", AT(densification_start),
     "strain from which the law replaces the table; 0 = the table's end", .high = 0.999},
    {"material.densification", "exponent", SF_PARAMETER_NUMBER, "0.0", AT(densification_exponent),
     "n of H1 (0 = the one that makes A vanish) or m of H2 (required)", .high = 100.0},
    {"material.densification", "limit", SF_PARAMETER_NUMBER, "1.0", AT(densification_limit),
     "strain at which the stress of H2 becomes infinite (required); 1 for H1", .low = 0.01, .high = 1.0, .acts = has_limit},
};
/* clang-format on */

/* ---- rules ---- */

static sf_status refuse(sf_error *err, const char **place, const char *where, const char *sentence) {
    *place = where;
    return SF_FAIL(err, SF_ERR_INPUT, "%s", sentence);
}

static sf_status check_densification(const sf_foam_card *foam, const sf_given *given, const char **place,
                                     sf_error *err) {
    double end = 1.0; /* the law takes over from every curve, so the shortest table bounds it */
    double largest = 0.0;
    for (int64_t k = 0; k < foam->curve_count; k++) {
        end = fmin(end, foam->curve_strain[foam->curve_ptr[k + 1] - 1]);
        largest = fmax(largest, foam->curve_strain[foam->curve_ptr[k + 1] - 1]);
    }
    *place = "material.densification.start";
    if (foam->densification_start > end)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %g lies beyond the end of the compression table (%g)", *place,
                       foam->densification_start, end);
    *place = "material.densification.limit";
    if (foam->densification_rule == SF_DENSIFICATION_H1) {
        if (foam->densification_limit != 1.0)
            return SF_FAIL(err, SF_ERR_INPUT, "%s: %g belongs to rule H2; the limit of H1 is 1", *place,
                           foam->densification_limit);
        return SF_OK;
    }
    static const char *const needed[] = {"limit", "exponent"};
    for (int i = 0; i < 2; i++)
        if (!given->is(given->reader, "material.densification", needed[i])) {
            *place = "material.densification";
            return SF_FAIL(err, SF_ERR_INPUT, "%s.%s is missing: rule H2 needs it", *place, needed[i]);
        }
    if (!(foam->densification_exponent > 0.0))
        return refuse(err, place, "material.densification.exponent",
                      "material.densification.exponent: rule H2 needs one above 0");
    double start = foam->densification_start > 0.0 ? foam->densification_start : largest;
    if (foam->densification_limit <= start)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %g is not above the strain %g at which the law starts", *place,
                       foam->densification_limit, start);
    return SF_OK;
}

/* Both would act on the same stress. */
static sf_status check(const void *card, sf_error *err) {
    const sf_foam_card *foam = card;
    SF_TRY(sf_foam_check_shared(card, err));
    if (foam->rate_factor > 0 && foam->curve_count > 1)
        return SF_FAIL(
            err, SF_ERR_MODEL,
            "rate_factor is %g and there are %lld curves at several rates; a foam has one or the other",
            foam->rate_factor, (long long)foam->curve_count);
    return SF_OK;
}

static sf_status check_keys(const void *card, const sf_given *given, const char **place, sf_error *err) {
    const sf_foam_card *foam = card;
    if (foam->curve_count == 0)
        return refuse(
            err, place, "material",
            "material.curve is missing: the compression curve's CSV file (or curves: several of them)");
    SF_TRY(sf_foam_check_shared_keys(&foam->shared, given, place, err));
    sf_error inner = SF_ERROR_INIT;
    *place = "material.rate_factor";
    if (check(foam, &inner) != SF_OK)
        return SF_FAIL(err, SF_ERR_INPUT, "material.%s", inner.text);
    return check_densification(foam, given, place, err);
}

static double data_end(const void *card) {
    const sf_foam_card *foam = card;
    double end = 1;
    for (int64_t k = 0; k < foam->curve_count; k++)
        end = fmin(end, foam->curve_strain[foam->curve_ptr[k + 1] - 1]);
    return foam->densification_start > 0 ? fmin(end, foam->densification_start) : end;
}

static double informed_strain(const void *card) {
    double informed = ((const sf_foam_card *)card)->informed_strain;
    return informed > 0 ? informed : data_end(card);
}

static double rest_modulus(const void *card) {
    return ((const sf_foam_card *)card)->modulus;
}

/* The largest initial tangent of all curves plus the Maxwell branch. */
static void rest_bounds(const void *card, double length, double *tangent, double *viscosity) {
    const sf_foam_card *foam = card;
    double slope = foam->modulus;
    for (int64_t k = 0; k < foam->curve_count; k++) {
        int64_t first = foam->curve_ptr[k];
        slope = fmax(slope, foam->curve_stress[first + 1] / foam->curve_strain[first + 1]);
    }
    *tangent = slope + foam->maxwell_modulus;
    *viscosity = foam->kelvin_viscosity + foam->damp * length * sqrt(foam->density * slope);
}

/* ---- points ---- */

static const sf_history_variable history[] = {
    {"peak", "J m-3", SF_FOAM_PEAK, 1, NULL},
    {"rate", "s-1", SF_FOAM_RATE, 1, has_rates},
    {"maxwell", "Pa", SF_FOAM_MAXWELL, 6, sf_foam_has_maxwell},
    {"overstress", "Pa", SF_FOAM_OVERSTRESS, 6, has_rates},
};

static sf_status build(const void *card, void **numbers, sf_error *err) {
    sf_foam *foam = sf_alloc(err, 1, sizeof *foam, "foam");
    if (foam && sf_foam_build(card, foam, err) != SF_OK) {
        free(foam);
        foam = NULL;
    }
    *numbers = foam;
    return err->status;
}

static void release(void *numbers) {
    sf_foam_free(numbers);
    free(numbers);
}

static void update(const void *numbers, double dt, sf_law_batch *batch) {
    sf_foam_update(numbers, dt, batch);
}

static double energy(const void *numbers, double strain) {
    const sf_foam *foam = numbers;
    double stress, slope, w;
    sf_curve_evaluate(&foam->curve[0], fmin(strain, foam->curve[0].start), &stress, &slope, &w);
    return w;
}

static double uniaxial(const void *numbers, double dt, double strain, sf_uniaxial *point) {
    return sf_foam_uniaxial(numbers, dt, strain, point);
}

const sf_law sf_low_density_foam = {
    .name = "low_density_foam",
    .description = "uncoupled principal stresses from compression curves, hysteresis, Maxwell branch, rate",
    .card_size = sizeof(sf_foam_card),
    .parameter = parameters,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .density = offsetof(sf_foam_card, density),
    .rest_modulus = rest_modulus,
    .length = offsetof(sf_foam_card, damp_length),
    .curves = offsetof(sf_foam_card, curves),
    .check = check,
    .check_keys = check_keys,
    .data_end = data_end,
    .data_end_words = "the compression table ends at",
    .stiffness_keys = "E, curve",
    .informed_strain = informed_strain,
    .rest_bounds = rest_bounds,
    .history = history,
    .history_count = sizeof history / sizeof history[0],
    .build = build,
    .release = release,
    .update = update,
    .energy = energy,
    .uniaxial = uniaxial,
};
