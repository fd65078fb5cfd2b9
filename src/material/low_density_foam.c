/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/low_density_foam.h"

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err) {
    *foam = (sf_foam){
        .options = sf_foam_options_build(&card->shared),
        .modulus = card->modulus,
        .cutoff = card->tension_cutoff,
        .curve_count = card->curves.curve_count,
    };
    foam->curve = sf_alloc(err, card->curves.curve_count, sizeof *foam->curve, "curves");
    foam->curve_rate = sf_alloc(err, card->curves.curve_count, sizeof *foam->curve_rate, "curves");
    for (int64_t k = 0; k < card->curves.curve_count && err->status == SF_OK; k++) {
        foam->curve_rate[k] = card->curves.curve_rate[k];
        sf_curve_build(card, k, &foam->curve[k], err);
    }
    if (err->status != SF_OK)
        sf_foam_free(foam);
    return err->status;
}

void sf_foam_free(sf_foam *foam) {
    for (int64_t k = 0; foam->curve && k < foam->curve_count; k++)
        sf_curve_free(&foam->curve[k]);
    SF_CLEAR(foam, foam->curve, foam->curve_rate);
}

static const double REST = 1e-6; /* strain below which a direction counts as at rest */

/* The larger modulus of tension and of compression, Pa. */
static double rest_stiffness(const sf_foam *foam) {
    return fmax(foam->modulus, foam->curve[0].piece[0].c[1]);
}

static SF_KERNEL void base_law(const void *numbers, double stretch[3][SF_LANES], sf_foam_loading *law) {
    const sf_foam *foam = numbers;
    double modulus = foam->modulus, cutoff = foam->cutoff, yield = cutoff / modulus;
    double rest = rest_stiffness(foam);
    memset(law->energy, 0, sizeof law->energy);
    for (int i = 0; i < 3; i++) {
        double strain[SF_LANES], stress[SF_LANES], slope[SF_LANES], energy[SF_LANES];
        double *restrict t = law->t[i], *restrict tangent = law->slope[i],
                         *restrict steepest = law->steepest[i];
        SF_EACH_LANE (l)
            strain[l] = 1 - stretch[i][l];
        sf_curve_evaluate_lanes(&foam->curve[0], strain, stress, slope, energy);
        SF_EACH_LANE (l) {
            double pull = -strain[l] * modulus, work = 0.5 * strain[l] * strain[l] * modulus;
            bool squeezed = strain[l] > 0, elastic = pull <= cutoff, still = fabs(strain[l]) < REST;
            double drawn = elastic ? pull : cutoff, drawn_slope = elastic ? modulus : 0;
            double drawn_energy = elastic ? work : cutoff * (-strain[l] - 0.5 * yield);
            t[l] = squeezed ? -stress[l] : drawn;
            double own = squeezed ? slope[l] : drawn_slope;
            tangent[l] = own;
            steepest[l] = still ? rest : own;
            law->energy[l] += squeezed ? energy[l] : drawn_energy;
        }
    }
}

/* Part of the strain at which the curve's densification starts, from which a step may reach it. */
static const double NEAR_DENSE = 0.9;

static void slopes_ahead(const void *numbers, double next[3][SF_LANES], double steepest[3][SF_LANES]) {
    const sf_curve *curve = &((const sf_foam *)numbers)->curve[0];
    for (int i = 0; i < 3; i++)
        for (int l = 0; l < SF_LANES; l++) {
            double stress, slope, energy;
            if (1 - next[i][l] < curve->start)
                continue;
            sf_curve_evaluate(curve, 1 - next[i][l], &stress, &slope, &energy);
            steepest[i][l] = fmax(steepest[i][l], slope);
        }
}

double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope,
                          double *rate_slope) {
    const double *r = foam->curve_rate;
    int64_t k = foam->curve_count - 2;
    *slope = *rate_slope = 0;
    if (!(rate > r[0]) || !(strain > 0))
        return 0;
    while (k > 0 && rate < r[k])
        k--;
    double low, high, low_slope, high_slope, base, base_slope, energy;
    sf_curve_evaluate(&foam->curve[0], strain, &base, &base_slope, &energy);
    sf_curve_evaluate(&foam->curve[k], strain, &low, &low_slope, &energy);
    sf_curve_evaluate(&foam->curve[k + 1], strain, &high, &high_slope, &energy);
    low = fmax(low, base); /* curves that cross, as noise or beyond their data, create no energy */
    for (int64_t j = 1; j < k; j++) {
        double between, between_slope;
        sf_curve_evaluate(&foam->curve[j], strain, &between, &between_slope, &energy);
        low = fmax(low, between);
    }
    high = fmax(high, low);
    double span = log(r[k + 1] / r[k]), x = fmin(1, log(rate / r[k]) / span);
    *slope = fmax(0, low_slope + x * (high_slope - low_slope) - base_slope);
    *rate_slope = x < 1 ? fmax(0, (high - low) / (span * rate)) : 0;
    return low + x * (high - low) - base;
}

/* Adds the rate overstress of lane l to the principal second Piola-Kirchhoff stress; returns a bound on its
 * tangent: slopes, the shear moduli between directions, and what a change of the filtered rate does to all
 * three. */
static double add_overstress(const sf_foam *foam, const sf_law_batch *b, int l, sf_foam_rate *rate) {
    double bound = 0, rates = 0, extra[3];
    for (int i = 0; i < 3; i++) {
        double slope, rate_slope;
        extra[i] =
            sf_foam_overstress(foam, 1 - b->stretch[i][l], b->history[SF_FOAM_RATE][l], &slope, &rate_slope);
        rate->part[i][l] -= extra[i] / b->stretch[i][l];
        bound = fmax(bound, slope);
        rates += rate_slope * rate_slope;
    }
    for (int i = 0; i < 3; i++) {
        double gap = b->stretch[(i + 1) % 3][l] - b->stretch[i][l];
        if (fabs(gap) > 1e-7)
            bound = fmax(bound, (extra[i] - extra[(i + 1) % 3]) / gap);
    }
    return bound + sqrt(rates) / foam->options.filter_time;
}

static void overstress(const void *numbers, double dt, sf_law_batch *b, const sf_foam_loading *law,
                       sf_foam_rate *rate) {
    const sf_foam *foam = numbers;
    sf_foam_point_filter(&foam->options, true, dt, b, law, rate);
    for (int l = 0; l < SF_LANES; l++)
        rate->extra[l] = add_overstress(foam, b, l, rate);
}

void sf_foam_update(const void *numbers, double dt, sf_law_batch *b) {
    const sf_foam *foam = numbers;
    const sf_foam_kind kind = {.numbers = foam,
                               .rest = rest_stiffness(foam),
                               .compression = true,
                               .loading = base_law,
                               .dense = 1 - NEAR_DENSE * foam->curve[0].start,
                               .ahead = slopes_ahead,
                               .overstress = foam->curve_count > 1 ? overstress : NULL};
    sf_foam_point_update(&foam->options, &kind, dt, b);
}

double sf_foam_uniaxial(const void *numbers, double dt, double strain, sf_uniaxial *point) {
    const sf_foam *foam = numbers;
    double stress, slope, energy, rate_slope, stretch = 1 - strain;
    double green_rate = sf_foam_green_rate(dt, strain, point);
    if (strain > 0) {
        sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, &energy);
    } else {
        stress = fmax(foam->modulus * strain, -foam->cutoff);
        energy = 0.5 * stress * stress / foam->modulus - stress * (stress / foam->modulus - strain);
    }
    double working = strain > 0 ? -green_rate / stretch : 0;
    double factor = sf_foam_axial_factor(&foam->options, energy, point),
           gain = sf_foam_axial_gain(&foam->options, dt, working, point);
    stress *= strain > 0 ? factor + gain : factor;
    if (foam->curve_count > 1)
        stress += sf_foam_overstress(foam, strain, sf_foam_axial_filter(&foam->options, dt, working, point),
                                     &slope, &rate_slope);
    point->strain = strain;
    return stress - stretch * sf_foam_axial_viscous(&foam->options, dt, green_rate, point);
}

/* The entry of the low-density foam in the table of laws: its parameters, rules and uniaxial stress. */

/* A tensile strength that no foam reaches: finite, so that it can be stored and compared. */
static const double NO_CUTOFF = 1e30; /* Pa */

/* ---- parameters ---- */

static bool has_cutoff(const void *card) {
    return ((const sf_foam_card *)card)->tension_cutoff != NO_CUTOFF;
}
static bool has_rates(const void *card) {
    return ((const sf_foam_card *)card)->curves.curve_count > 1 || sf_foam_has_rate_factor(card);
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
     "instead of `curve`: curves at several strain rates, ascending: ( { rate = \"0.0017 1/s\"; file = \"slow.csv\"; }, ... ), or at several " \
     "temperatures, with `temperature` in place of `rate`, between which `pad.temperature` lies"},
    SF_FOAM_PARAMETERS,
    SF_FOAM_MEMORIES,
    {"material", "tension_cutoff", SF_PARAMETER_QUANTITY, "\"none\"", AT(tension_cutoff),
     "largest tensile nominal stress, or \"none\"", .quantity = SF_PRESSURE, SF_FOAM_POSITIVE, .high = 1e12,
     .words = "none", .word_value = NO_CUTOFF, SF_FOAM_IN("kPa", 1e3), .acts = has_cutoff},
    SF_FOAM_RATE_FACTOR("strain rate of `curve`"),
    SF_FOAM_RATE_FILTER("that chooses among `curves` or acts in `rate_factor`", has_rates),
    SF_FOAM_SHIFTS,
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
    return SF_REFUSE(err, "%s", sentence);
}

static sf_status check_densification(const sf_foam_card *foam, const sf_given *given, const char **place,
                                     sf_error *err) {
    double end = 1.0; /* the law takes over from every curve, so the shortest table bounds it */
    double largest = 0.0;
    for (int64_t k = 0; k < foam->curves.curve_count; k++) {
        end = fmin(end, foam->curves.curve_strain[foam->curves.curve_ptr[k + 1] - 1]);
        largest = fmax(largest, foam->curves.curve_strain[foam->curves.curve_ptr[k + 1] - 1]);
    }
    *place = "material.densification.start";
    if (foam->densification_start > end)
        return SF_REFUSE(err, "%s: %g lies beyond the end of the compression table (%g)", *place,
                         foam->densification_start, end);
    *place = "material.densification.limit";
    if (foam->densification_rule == SF_DENSIFICATION_H1) {
        if (foam->densification_limit != 1.0)
            return SF_REFUSE(err, "%s: %g belongs to rule H2; the limit of H1 is 1", *place,
                             foam->densification_limit);
        return SF_OK;
    }
    static const char *const needed[] = {"limit", "exponent"};
    for (int i = 0; i < 2; i++)
        if (!given->is(given->reader, "material.densification", needed[i])) {
            *place = "material.densification";
            return SF_REFUSE(err, "%s.%s is missing: rule H2 needs it", *place, needed[i]);
        }
    if (!(foam->densification_exponent > 0.0))
        return refuse(err, place, "material.densification.exponent",
                      "material.densification.exponent: rule H2 needs one above 0");
    double start = foam->densification_start > 0.0 ? foam->densification_start : largest;
    if (foam->densification_limit <= start)
        return SF_REFUSE(err, "%s: %g is not above the strain %g at which the law starts", *place,
                         foam->densification_limit, start);
    return SF_OK;
}

/* Both would act on the same stress. */
static sf_status check(const void *card, sf_error *err) {
    const sf_foam_card *foam = card;
    SF_TRY(sf_foam_check_shared(card, err));
    if (foam->shared.rate_factor > 0 && foam->curves.curve_count > 1)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "rate_factor is %g and there are %lld curves at several rates; a foam has one or the "
                       "other",
                       foam->shared.rate_factor, (long long)foam->curves.curve_count);
    return SF_OK;
}

static sf_status check_keys(const void *card, const sf_given *given, const char **place, sf_error *err) {
    const sf_foam_card *foam = card;
    if (foam->curves.curve_count == 0)
        return refuse(
            err, place, "material",
            "material.curve is missing: the compression curve's CSV file (or curves: several of them)");
    SF_TRY(sf_foam_check_shared_keys(&foam->shared, foam->curves.curve_count > 1, given, place, err));
    sf_error inner = SF_ERROR_INIT;
    *place = "material.rate_factor";
    if (check(foam, &inner) != SF_OK)
        return SF_REFUSE(err, "material.%s", inner.text);
    return check_densification(foam, given, place, err);
}

static double data_end(const void *card) {
    const sf_foam_card *foam = card;
    double end = 1;
    for (int64_t k = 0; k < foam->curves.curve_count; k++)
        end = fmin(end, foam->curves.curve_strain[foam->curves.curve_ptr[k + 1] - 1]);
    return foam->densification_start > 0 ? fmin(end, foam->densification_start) : end;
}

static double limit_strain(const void *card) {
    SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
    return sf_curve_build(card, 0, &curve, SF_IGNORED) == SF_OK ? curve.beyond.limit : 1;
}

static double rest_modulus(const void *card) {
    return ((const sf_foam_card *)card)->modulus;
}

/* The largest initial tangent of all curves plus the Maxwell branch. */
static void rest_bounds(const void *card, double length, double *tangent, double *viscosity) {
    const sf_foam_card *foam = card;
    double slope = foam->modulus;
    for (int64_t k = 0; k < foam->curves.curve_count; k++) {
        int64_t first = foam->curves.curve_ptr[k];
        slope = fmax(slope, foam->curves.curve_stress[first + 1] / foam->curves.curve_strain[first + 1]);
    }
    *tangent = slope + foam->shared.maxwell_modulus;
    *viscosity =
        foam->shared.kelvin_viscosity + foam->shared.damp * length * sqrt(foam->shared.density * slope);
}

/* ---- points ---- */

static const sf_history_variable history[] = SF_FOAM_HISTORY(has_rates);

static sf_status build(const void *card, void **numbers, sf_error *err) {
    sf_foam *foam = sf_alloc(err, 1, sizeof *foam, "foam");
    if (foam)
        sf_foam_build(card, foam, err);
    *numbers = sf_keep(foam, err);
    return err->status;
}

static void release(void *numbers) {
    sf_foam_free(numbers);
    free(numbers);
}

static double energy(const void *numbers, double strain) {
    const sf_foam *foam = numbers;
    double stress, slope, w;
    sf_curve_evaluate(&foam->curve[0], fmin(strain, foam->curve[0].start), &stress, &slope, &w);
    return w;
}

const sf_law sf_low_density_foam = {
    .name = "low_density_foam",
    .description = "uncoupled principal stresses from compression curves, hysteresis, Maxwell branch, rate",
    SF_FOAM_LAW(sf_foam_card),
    .curves = offsetof(sf_foam_card, curves),
    .limit_strain = limit_strain,
    .data_end_words = "the compression table ends at",
    .stiffness_keys = "E, curve",
    .release = release,
    .update = sf_foam_update,
    .uniaxial = sf_foam_uniaxial,
};
