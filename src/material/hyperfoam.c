/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/hyperfoam.h"

/* The entry of the hyperfoam in the table of laws: its parameters, its rules and its loading law. The terms
 * that all foams share are in foam_point.c. */

/* ---- parameters ---- */

static const sf_hyperfoam_term *term(const void *card, int k) {
    return &((const sf_hyperfoam_card *)card)->term[k];
}

/* True if term k has the parameter: mu always acts, nu and beta exclude each other. */
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
ACTS(3)
ACTS(4)
ACTS(5)

#define AT(member) .offset = offsetof(sf_hyperfoam_card, member)
/* clang-format off */
#define TERM(k, group, no_mu, no_alpha, late) \
    {group, "mu", SF_PARAMETER_QUANTITY, no_mu, AT(term[k].mu), \
     "shear modulus of the term, at rest; those of all terms add up; may be negative", .quantity = SF_PRESSURE, \
     .low = -1e12, .high = 1e12, SF_FOAM_IN("kPa", 1e3), .acts = has_term_##k, .optional = late}, \
    {group, "alpha", SF_PARAMETER_NUMBER, no_alpha, AT(term[k].alpha), \
     "exponent of the stretches, not 0", .low = -50.0, .high = 50.0, .acts = has_term_##k, .optional = late}, \
    {group, "nu", SF_PARAMETER_NUMBER, "0.0", AT(term[k].nu), \
     "Poisson ratio of the term; beta = nu/(1 - 2 nu)", .low = -0.9, .high = 0.49, .acts = has_nu_##k, .optional = late}, \
    {group, "beta", SF_PARAMETER_NUMBER, "0.0", AT(term[k].beta), \
     "instead of nu", .low = -0.33, .high = 25.0, .acts = has_beta_##k, .optional = late}
#define NEXT_TERM(k, group, late) TERM(k, group, "\"0 kPa\"", "2.0", late)
static const sf_parameter parameters[] = {
    SF_FOAM_DENSITY,
    {"material", "stable_to", SF_PARAMETER_NUMBER, "0.9", AT(stable_to),
     "strain up to which the terms must be stable (Drucker), in compression, tension and shear", .low = 0.01, .high = 0.99},
    SF_FOAM_PARAMETERS,
    SF_FOAM_MEMORIES,
    SF_FOAM_RATE_FACTOR("strain rate of the terms"),
    SF_FOAM_RATE_FILTER("in `rate_factor`", sf_foam_has_rate_factor),
    SF_FOAM_SHIFTS,
    SF_FOAM_INFORMED,
    TERM(0, "material.term_1", NULL, NULL, false),
    NEXT_TERM(1, "material.term_2", false),
    NEXT_TERM(2, "material.term_3", false),
    NEXT_TERM(3, "material.term_4", true),
    NEXT_TERM(4, "material.term_5", true),
    NEXT_TERM(5, "material.term_6", true),
};
/* clang-format on */

/* ---- rules ---- */

/* Checks one term; `name` names the place. */
static sf_status check_term(const sf_hyperfoam_term *t, const char *name, sf_error *err) {
    if (t->mu != 0 && fabs(t->alpha) < 0.01)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: alpha is %g; its amount must be at least 0.01", name,
                       t->alpha);
    if (t->nu != 0 && t->beta != 0)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: both nu (%g) and beta (%g); a term has one of them", name,
                       t->nu, t->beta);
    return SF_OK;
}

static const char *const groups[SF_HYPERFOAM_TERMS] = {"material.term_1", "material.term_2",
                                                       "material.term_3", "material.term_4",
                                                       "material.term_5", "material.term_6"};

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
            return SF_REFUSE(err, "%s: both nu and beta are given; a term has one of them", groups[k]);
        if (k > 0 &&
            given->is(given->reader, groups[k], "mu") != given->is(given->reader, groups[k], "alpha"))
            return SF_REFUSE(err, "%s: mu and alpha are both needed", groups[k]);
        if (k > 0 && !given->is(given->reader, groups[k], "mu") &&
            (given->is(given->reader, groups[k], "nu") || given->is(given->reader, groups[k], "beta")))
            return SF_REFUSE(err, "%s.mu is missing", groups[k]);
    }
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_foam_check_shared_keys(&foam->shared, false, given, place, err));
    if (check_terms(foam, place, &inner) != SF_OK)
        return SF_REFUSE(err, "%s", inner.text);
    return SF_OK;
}

static double data_end(const void *card) {
    return ((const sf_hyperfoam_card *)card)->stable_to;
}

static double rest_modulus(const void *card) {
    return sf_hyperfoam_build(card).rest;
}

static const double LARGEST_POISSON = 0.35; /* that ran on every mesh tried (theory, section 4) */

/* Ratio of lateral to axial strain, as logarithms, in uniaxial compression with free sides to `strain`; NaN
 * if there is none. Of one term it is nu at any strain. */
static double poisson_ratio(const sf_hyperfoam *foam, double strain) {
    double stretch[3] = {1 - strain, 1, 1};
    return sf_hyperfoam_release(foam, 1, stretch) ? -log(stretch[1]) / log(stretch[0]) : NAN;
}

static bool caution(const void *card, char *text, size_t size) {
    sf_hyperfoam foam = sf_hyperfoam_build(card);
    double ratio = fmax(poisson_ratio(&foam, 0.01), poisson_ratio(&foam, 0.5));
    if (!(ratio > LARGEST_POISSON + 1e-6))
        return false;
    snprintf(text, size,
             "hyperfoam: the terms have a Poisson ratio of %.3g; above %g the stabilisation stiffens the pad "
             "on coarse meshes and may end the run (at a spacing of a fifth of the thickness 0.4 did): halve "
             "the spacing and compare",
             ratio, LARGEST_POISSON);
    return true;
}

/* The sum of a row of d2W, as in the update. */
static void rest_bounds(const void *card, double length, double *tangent, double *viscosity) {
    const sf_hyperfoam_card *foam = card;
    const double still[3] = {1, 1, 1};
    sf_hyperfoam law = sf_hyperfoam_build(card);
    sf_hyperfoam_point p = sf_hyperfoam_evaluate(&law, still);
    *tangent = p.slope[0][0] + 2 * fabs(p.slope[0][1]) + foam->shared.maxwell_modulus;
    *viscosity =
        foam->shared.kelvin_viscosity + foam->shared.damp * length * sqrt(foam->shared.density * law.rest);
}

/* ---- points ---- */

static const sf_history_variable history[] = SF_FOAM_HISTORY(sf_foam_has_rate_factor);

static sf_status build(const void *card, void **numbers, sf_error *err) {
    sf_hyperfoam *foam = sf_alloc(err, 1, sizeof *foam, "hyperfoam");
    if (foam)
        *foam = sf_hyperfoam_build(card);
    *numbers = foam;
    return err->status;
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
    double largest = fmax(fabs(p.t[0]), fmax(fabs(p.t[1]), fabs(p.t[2]))),
           working = largest > 0 ? p.t[0] * green_rate / stretch / largest : 0;
    double factor = sf_foam_axial_factor(&foam->options, p.energy, point) +
                    sf_foam_axial_gain(&foam->options, dt, working, point);
    point->strain = strain;
    return -factor * p.t[0] - stretch * sf_foam_axial_viscous(&foam->options, dt, green_rate, point);
}

static double lateral(const void *numbers, double strain) {
    double stretch[3] = {1 - strain, 1, 1};
    return sf_hyperfoam_release(numbers, 1, stretch) ? stretch[1] : NAN;
}

const sf_law sf_hyperfoam_law = {
    .name = "hyperfoam",
    .description =
        "Ogden-Storakers hyperfoam of 1 to 6 terms: lateral strain; hysteresis, Maxwell branch, rate",
    SF_FOAM_LAW(sf_hyperfoam_card),
    .curves = SIZE_MAX,
    .data_end_words = "the terms are known to be stable up to",
    .stiffness_keys = "term_1.mu, term_1.alpha ...",
    .caution = caution,
    .release = free,
    .update = sf_hyperfoam_update,
    .uniaxial = uniaxial,
    .lateral = lateral,
};

static double beta_of(const sf_hyperfoam_term *term) {
    return term->beta + term->nu / (1 - 2 * term->nu);
}

sf_hyperfoam sf_hyperfoam_build(const sf_hyperfoam_card *card) {
    sf_hyperfoam foam = {.options = sf_foam_options_build(&card->shared)};
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++)
        if (card->term[k].mu != 0) {
            foam.mu[foam.count] = card->term[k].mu;
            foam.alpha[foam.count] = card->term[k].alpha;
            foam.beta[foam.count] = beta_of(&card->term[k]);
            foam.rest += 2 * foam.mu[foam.count] * (1 + foam.beta[foam.count]);
            foam.count++;
        }
    return foam;
}

/* ---- a batch ---- */

/* Adds one term: its stresses times the stretch, its energy, its slopes times the stretch squared, and the
 * coupling d2W / dli dlj = `coupling` / (li lj). */
static inline void add_term(double mu, double alpha, double beta, double logarithm[3][SF_LANES],
                            sf_foam_loading *law, double coupling[SF_LANES]) {
    double twice = 2 * mu / alpha, energy = twice / alpha, squash = beta != 0 ? energy / beta : 0;
    double volume[SF_LANES];
    SF_EACH_LANE (l) {
        double rest, sum = logarithm[0][l] + logarithm[1][l] + logarithm[2][l];
        volume[l] = sf_lane_expm1(-alpha * beta * sum, &rest);
        law->energy[l] += squash * rest;
        coupling[l] += 2 * mu * beta * (1 + volume[l]);
    }
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l) {
            double rest, power = sf_lane_expm1(alpha * logarithm[i][l], &rest);
            law->energy[l] += energy * rest;
            law->t[i][l] += twice * (power - volume[l]);
            law->slope[i][l] +=
                twice * (alpha * (1 + beta) + (alpha - 1) * power + (1 + alpha * beta) * volume[l]);
        }
}

static SF_KERNEL void loading(const void *numbers, double stretch[3][SF_LANES], sf_foam_loading *law) {
    const sf_hyperfoam *foam = numbers;
    double logarithm[3][SF_LANES], inverse[3][SF_LANES], coupling[SF_LANES] = {0};
    memset(law, 0, sizeof *law);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l) {
            logarithm[i][l] = sf_lane_log(stretch[i][l]);
            inverse[i][l] = 1 / stretch[i][l];
        }
    for (int k = 0; k < foam->count; k++)
        add_term(foam->mu[k], foam->alpha[k], foam->beta[k], logarithm, law, coupling);
    for (int i = 0; i < 3; i++) {
        const double *one = inverse[i], *two = inverse[(i + 1) % 3], *three = inverse[(i + 2) % 3];
        SF_EACH_LANE (l) {
            law->t[i][l] *= one[l];
            law->slope[i][l] *= one[l] * one[l];
            law->steepest[i][l] = law->slope[i][l] + fabs(coupling[l]) * one[l] * (two[l] + three[l]);
        }
    }
}

void sf_hyperfoam_update(const void *numbers, double dt, sf_law_batch *b) {
    const sf_hyperfoam *foam = numbers;
    const sf_foam_kind kind = {.numbers = foam, .rest = foam->rest, .loading = loading};
    sf_foam_point_update(&foam->options, &kind, dt, b);
}

/* ---- one point ---- */

sf_hyperfoam_point sf_hyperfoam_evaluate(const sf_hyperfoam *foam, const double stretch[3]) {
    sf_hyperfoam_point out = {0};
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += log(stretch[i]);
    for (int k = 0; k < foam->count; k++) {
        double mu = foam->mu[k], alpha = foam->alpha[k], beta = foam->beta[k], z = -alpha * beta * sum;
        double volume = expm1(z), scale = 2 * mu / (alpha * alpha);
        out.energy += beta != 0 ? scale * (volume - z) / beta : 0;
        for (int i = 0; i < 3; i++) {
            double x = alpha * log(stretch[i]), power = expm1(x);
            out.energy += scale * (power - x);
            out.t[i] += scale * alpha * (power - volume) / stretch[i];
            out.slope[i][i] += scale * alpha *
                               (alpha * (1 + beta) + (alpha - 1) * power + (1 + alpha * beta) * volume) /
                               (stretch[i] * stretch[i]);
            for (int j = 0; j < 3; j++)
                out.slope[i][j] += i == j ? 0 : 2 * mu * beta * (1 + volume) / (stretch[i] * stretch[j]);
        }
    }
    return out;
}

bool sf_hyperfoam_release(const sf_hyperfoam *foam, int held, double stretch[3]) {
    enum { TURNS = 60 };
    const double largest = 0.2; /* of a change of the logarithm */
    for (int turn = 0; turn < TURNS; turn++) {
        for (int i = held; i < 3; i++)
            stretch[i] = stretch[held];
        sf_hyperfoam_point p = sf_hyperfoam_evaluate(foam, stretch);
        double x = stretch[held], slope = x * p.t[held]; /* of the Kirchhoff stress, by the logarithm */
        for (int j = held; j < 3; j++)
            slope += x * x * p.slope[held][j];
        double step = -x * p.t[held] / slope;
        if (!(slope > 0) || !isfinite(step))
            return false;
        step = fmax(-largest, fmin(largest, step));
        stretch[held] = x * exp(step);
        if (fabs(step) < 1e-15)
            break;
    }
    for (int i = held; i < 3; i++)
        stretch[i] = stretch[held];
    return true;
}

/* Drucker's condition: the derivatives of the Kirchhoff stresses by the logarithms of the stretches,
 *     D = sum over the terms of 2 mu (diag(l^alpha) + beta J^(-alpha beta) 1 1^T),
 * are positive definite. */

enum { STEPS = 200 };

/* A family of deformations with one parameter, the strain. */
typedef struct path {
    const char *name;
    int held; /* directions with a given stretch; the others are free of stress */
    int axes; /* of them, how many change by the strain */
    enum { PRESSED, PULLED, SHEARED } way; /* SHEARED: the second is stretched at constant volume */
} path;
static const path paths[] = {
    {"uniaxial compression", 1, 1, PRESSED},
    {"uniaxial tension", 1, 1, PULLED},
    {"biaxial compression", 2, 2, PRESSED},
    {"biaxial tension", 2, 2, PULLED},
    {"confined compression", 3, 1, PRESSED},
    {"confined tension", 3, 1, PULLED},
    {"volumetric compression", 3, 3, PRESSED},
    {"volumetric tension", 3, 3, PULLED},
    {"shear", 3, 1, SHEARED},
};

/* Contribution of term k to the form v . D v. */
static double share(const sf_hyperfoam *foam, int k, const double stretch[3], const double v[3]) {
    double sum = 0, along = 0, volume = log(stretch[0]) + log(stretch[1]) + log(stretch[2]);
    for (int i = 0; i < 3; i++) {
        sum += v[i];
        along += pow(stretch[i], foam->alpha[k]) * v[i] * v[i];
    }
    return 2 * foam->mu[k] *
           (along + foam->beta[k] * exp(-foam->alpha[k] * foam->beta[k] * volume) * sum * sum);
}

/* D = diag(d) + b 1 1^T. */
static double parts(const sf_hyperfoam *foam, const double stretch[3], double d[3]) {
    double b = 0, volume = log(stretch[0]) + log(stretch[1]) + log(stretch[2]);
    for (int i = 0; i < 3; i++) {
        d[i] = 0;
        for (int k = 0; k < foam->count; k++)
            d[i] += 2 * foam->mu[k] * pow(stretch[i], foam->alpha[k]);
    }
    for (int k = 0; k < foam->count; k++)
        b += 2 * foam->mu[k] * foam->beta[k] * exp(-foam->alpha[k] * foam->beta[k] * volume);
    return b;
}

/* True if the matrix is positive definite. With two d[i] at or below 0 it is not, whatever b: a change of
 * the two against each other shows it. Otherwise the sign of its determinant decides, and 1/d[i] is the
 * change of least work. */
static bool positive(double b, const double d[3], double v[3]) {
    int below[3], count = 0;
    double sum = 1;
    for (int i = 0; i < 3; i++) {
        v[i] = 0;
        if (!(d[i] > 0))
            below[count++] = i;
    }
    if (count >= 2) {
        v[below[0]] = 1;
        v[below[1]] = -1;
        return false;
    }
    for (int i = 0; i < 3; i++) {
        v[i] = d[i] != 0 ? 1 / d[i] : 1e100;
        sum += b * v[i];
    }
    return count == 0 ? sum > 0 : b > 0 && sum < 0;
}

/* True if the law is stable there; otherwise `term` is the one that takes most from the work of the
 * critical change. */
static bool stable(const sf_hyperfoam *foam, const double stretch[3], int *term) {
    double d[3], along[3], b = parts(foam, stretch, d);
    if (positive(b, d, along))
        return true;
    *term = 0;
    for (int k = 1; k < foam->count; k++)
        if (share(foam, k, stretch, along) < share(foam, *term, stretch, along))
            *term = k;
    return false;
}

static bool path_fails(const sf_hyperfoam *foam, const path *p, double limit, sf_hyperfoam_failure *out) {
    double stretch[3] = {1, 1, 1};
    for (int k = 0; k <= STEPS; k++) {
        double strain = limit * k / STEPS;
        for (int i = 0; i < p->axes; i++)
            stretch[i] = p->way == PULLED ? 1 + strain : 1 - strain;
        if (p->way == SHEARED)
            stretch[1] = 1 / stretch[0];
        bool found = p->held == 3 || sf_hyperfoam_release(foam, p->held, stretch);
        out->term = 0;
        if (stable(foam, stretch, &out->term) && found)
            continue;
        out->path = p->name;
        out->strain = strain;
        return true;
    }
    return false;
}

bool sf_hyperfoam_fails(const sf_hyperfoam *foam, double limit, sf_hyperfoam_failure *out) {
    for (size_t k = 0; k < sizeof paths / sizeof *paths; k++)
        if (path_fails(foam, &paths[k], limit, out))
            return true;
    return false;
}
