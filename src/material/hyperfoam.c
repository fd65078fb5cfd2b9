/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the hyperfoam in the table of laws: its parameters and rules. The update of a batch is in
 * hyperfoam_point.c. */
#include "material/hyperfoam.h"
#include "material/foam_parameters.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- parameters ---- */

static const sf_hyperfoam_term *term(const void *card, int k) {
    return &((const sf_hyperfoam_card *)card)->term[k];
}

/* What of term k acts. */
#define ACTS(k)                                                                                              \
    static bool has_term_##k(const void *card) {                                                             \
        return term(card, k)->mu != 0;                                                                       \
    }                                                                                                        \
    static bool has_nu_##k(const void *card) {                                                               \
        return term(card, k)->mu != 0 && term(card, k)->beta == 0;                                           \
    }                                                                                                        \
    static bool has_beta_##k(const void *card) {                                                             \
        return term(card, k)->mu != 0 && term(card, k)->beta != 0;                                           \
    }
ACTS(0)
ACTS(1)
ACTS(2)

#define AT(member) .offset = offsetof(sf_hyperfoam_card, member)
/* clang-format off */
#define TERM(k, group, no_mu, no_alpha) \
    {group, "mu", SF_PARAMETER_QUANTITY, no_mu, AT(term[k].mu), \
     "shear modulus of the term, at rest; those of all terms add up; may be negative", .quantity = SF_PRESSURE, \
     .low = -1e12, .high = 1e12, SF_FOAM_IN("kPa", 1e3), .acts = has_term_##k}, \
    {group, "alpha", SF_PARAMETER_NUMBER, no_alpha, AT(term[k].alpha), \
     "exponent of the stretches, not 0", .low = -50.0, .high = 50.0, .acts = has_term_##k}, \
    {group, "nu", SF_PARAMETER_NUMBER, "0.0", AT(term[k].nu), \
     "Poisson ratio of the term; beta = nu/(1 - 2 nu)", .low = -0.9, .high = 0.49, .acts = has_nu_##k}, \
    {group, "beta", SF_PARAMETER_NUMBER, "0.0", AT(term[k].beta), \
     "instead of nu", .low = -0.33, .high = 25.0, .acts = has_beta_##k}
static const sf_parameter parameters[] = {
    SF_FOAM_DENSITY,
    {"material", "stable_to", SF_PARAMETER_NUMBER, "0.9", AT(stable_to),
     "strain up to which the terms must be stable (Drucker), in compression, tension and shear", .low = 0.01, .high = 0.99},
    SF_FOAM_PARAMETERS,
    SF_FOAM_RATE_FACTOR("strain rate of the terms"),
    SF_FOAM_RATE_FILTER("in `rate_factor`", sf_foam_has_rate_factor),
    SF_FOAM_INFORMED,
    TERM(0, "material.term_1", NULL, NULL),
    TERM(1, "material.term_2", "\"0 kPa\"", "2.0"),
    TERM(2, "material.term_3", "\"0 kPa\"", "2.0"),
};
/* clang-format on */

/* ---- rules ---- */

/* Of one term; `name` names the place. */
static sf_status check_term(const sf_hyperfoam_term *t, const char *name, sf_error *err) {
    if (t->mu != 0 && fabs(t->alpha) < 0.01)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: alpha is %g; its amount must be 0.01 at least", name,
                       t->alpha);
    if (t->nu != 0 && t->beta != 0)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: both nu (%g) and beta (%g); a term has one of them", name,
                       t->nu, t->beta);
    return SF_OK;
}

static const char *const groups[SF_HYPERFOAM_TERMS] = {"material.term_1", "material.term_2",
                                                       "material.term_3"};

/* Terms and stability; `*place` is the key or group that is wrong. */
static sf_status check_terms(const sf_hyperfoam_card *card, const char **place, sf_error *err) {
    int number[SF_HYPERFOAM_TERMS], count = 0;
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++) {
        *place = groups[k];
        SF_TRY(check_term(&card->term[k], groups[k], err));
        if (card->term[k].mu != 0)
            number[count++] = k;
    }
    *place = groups[0];
    if (count == 0)
        return SF_FAIL(err, SF_ERR_MODEL, "%s.mu is 0 in every term: the law has no stress", groups[0]);
    sf_hyperfoam foam = sf_hyperfoam_build(card);
    sf_hyperfoam_failure failure;
    if (!sf_hyperfoam_fails(&foam, card->stable_to, &failure))
        return SF_OK;
    int bad = number[failure.term];
    *place = groups[bad];
    return SF_FAIL(err, SF_ERR_MODEL,
                   "%s (mu = %g kPa, alpha = %g) makes the law unstable in %s from a strain of %.3g on "
                   "(Drucker's condition); stable_to asks for %g",
                   groups[bad], 1e-3 * card->term[bad].mu, card->term[bad].alpha, failure.path,
                   failure.strain, card->stable_to);
}

static sf_status check(const void *card, sf_error *err) {
    const char *place;
    SF_TRY(sf_foam_check_shared(card, err));
    return check_terms(card, &place, err);
}

static sf_status check_keys(const void *card, const sf_given *given, const char **place, sf_error *err) {
    const sf_hyperfoam_card *foam = card;
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++) {
        *place = groups[k];
        if (given->is(given->reader, groups[k], "nu") && given->is(given->reader, groups[k], "beta"))
            return SF_FAIL(err, SF_ERR_INPUT, "%s: both nu and beta are given; a term has one of them",
                           groups[k]);
        if (k > 0 &&
            given->is(given->reader, groups[k], "mu") != given->is(given->reader, groups[k], "alpha"))
            return SF_FAIL(err, SF_ERR_INPUT, "%s: mu and alpha are both needed", groups[k]);
        if (k > 0 && !given->is(given->reader, groups[k], "mu") &&
            (given->is(given->reader, groups[k], "nu") || given->is(given->reader, groups[k], "beta")))
            return SF_FAIL(err, SF_ERR_INPUT, "%s.mu is missing", groups[k]);
    }
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_foam_check_shared_keys(&foam->shared, given, place, err));
    if (check_terms(foam, place, &inner) != SF_OK)
        return SF_FAIL(err, SF_ERR_INPUT, "%s", inner.text);
    return SF_OK;
}

static double data_end(const void *card) {
    return ((const sf_hyperfoam_card *)card)->stable_to;
}

static double informed_strain(const void *card) {
    double informed = ((const sf_hyperfoam_card *)card)->informed_strain;
    return informed > 0 ? informed : data_end(card);
}

static double rest_modulus(const void *card) {
    return sf_hyperfoam_build(card).rest;
}

static const double LARGEST_POISSON = 0.35; /* that ran on every mesh tried (theory, section 4) */

static bool caution(const void *card, char *text, size_t size) {
    sf_hyperfoam foam = sf_hyperfoam_build(card);
    double ratio = fmax(sf_hyperfoam_poisson(&foam, 0.01), sf_hyperfoam_poisson(&foam, 0.5));
    if (!(ratio > LARGEST_POISSON + 1e-6))
        return false;
    snprintf(
        text, size,
        "hyperfoam: the terms have a Poisson ratio of %.3g; above %g the stabilisation stiffens the pad on "
        "coarse meshes and may end the run (at a spacing of a fifth of the thickness 0.4 did): halve the spacing "
        "and compare",
        ratio, LARGEST_POISSON);
    return true;
}

/* The sum of a row of d2W, as in the update. */
static void rest_bounds(const void *card, double length, double *tangent, double *viscosity) {
    const sf_hyperfoam_card *foam = card;
    const double still[3] = {1, 1, 1};
    sf_hyperfoam law = sf_hyperfoam_build(card);
    sf_hyperfoam_point p = sf_hyperfoam_evaluate(&law, still);
    *tangent = p.slope[0][0] + 2 * fabs(p.slope[0][1]) + foam->maxwell_modulus;
    *viscosity = foam->kelvin_viscosity + foam->damp * length * sqrt(foam->density * law.rest);
}

/* ---- points ---- */

static const sf_history_variable history[] = {
    {"peak", "J m-3", SF_FOAM_PEAK, 1, NULL},
    {"rate", "s-1", SF_FOAM_RATE, 1, sf_foam_has_rate_factor},
    {"maxwell", "Pa", SF_FOAM_MAXWELL, 6, sf_foam_has_maxwell},
    {"overstress", "Pa", SF_FOAM_OVERSTRESS, 6, sf_foam_has_rate_factor},
};

static sf_status build(const void *card, void **numbers, sf_error *err) {
    sf_hyperfoam *foam = sf_alloc(err, 1, sizeof *foam, "hyperfoam");
    if (foam)
        *foam = sf_hyperfoam_build(card);
    *numbers = foam;
    return err->status;
}

static void update(const void *numbers, double dt, sf_law_batch *batch) {
    sf_hyperfoam_update(numbers, dt, batch);
}

static sf_hyperfoam_point confined(const sf_hyperfoam *foam, double strain) {
    const double stretch[3] = {1 - fmin(strain, 1 - 1e-6), 1, 1};
    return sf_hyperfoam_evaluate(foam, stretch);
}

static double energy(const void *numbers, double strain) {
    return confined(numbers, strain).energy;
}

static double uniaxial(const void *numbers, double dt, double strain, sf_uniaxial *point) {
    const sf_hyperfoam *foam = numbers;
    sf_hyperfoam_point p = confined(foam, strain);
    double stretch = 1 - strain, green_rate = sf_foam_green_rate(dt, strain, point);
    double factor = sf_foam_axial_factor(&foam->options, p.energy, point) +
                    sf_foam_axial_gain(&foam->options, dt, green_rate, stretch, point);
    point->strain = strain;
    return -factor * p.t[0] - stretch * sf_foam_axial_viscous(&foam->options, dt, green_rate, point);
}

const sf_law sf_hyperfoam_law = {
    .name = "hyperfoam",
    .description =
        "Ogden-Storakers hyperfoam of 1 to 3 terms: lateral strain; hysteresis, Maxwell branch, rate",
    .card_size = sizeof(sf_hyperfoam_card),
    .parameter = parameters,
    .parameter_count = sizeof parameters / sizeof parameters[0],
    .density = offsetof(sf_hyperfoam_card, density),
    .rest_modulus = rest_modulus,
    .length = offsetof(sf_hyperfoam_card, damp_length),
    .curves = SIZE_MAX,
    .check = check,
    .check_keys = check_keys,
    .data_end = data_end,
    .data_end_words = "the terms are known to be stable up to",
    .stiffness_keys = "term_1.mu, term_1.alpha ...",
    .informed_strain = informed_strain,
    .rest_bounds = rest_bounds,
    .caution = caution,
    .history = history,
    .history_count = sizeof history / sizeof history[0],
    .build = build,
    .release = free,
    .update = update,
    .energy = energy,
    .uniaxial = uniaxial,
};
