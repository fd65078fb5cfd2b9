/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/table_result.h"

#include "material/low_density_foam.h"
#include "material/point.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double CARD_STEP = 5e-4; /* strain, of the check by the solver's law */

/* ---- the fit against the data, and the card against the fit ---- */

static double counted(const sf_compression_fit *fit, int i) {
    const sf_compression_test *t = &fit->data.config->test[fit->data.test[i]];
    return fmax(fabs(fit->stress[i]), 0.01 * t->largest_stress);
}

static void compare_test(const sf_compression_fit *fit, int k, sf_table_test *out) {
    const sf_compression_data *d = &fit->data;
    const sf_compression_test *t = &d->config->test[k];
    const char *slash = strrchr(t->path, '/');
    *out = (sf_table_test){.path = t->path,
                           .name = slash ? slash + 1 : t->path,
                           .interpretation = t->interpretation,
                           .toe = t->toe,
                           .rate = t->rate,
                           .largest_strain = t->largest_strain,
                           .largest_stress = t->largest_stress,
                           .loading = t->loading,
                           .unloading = t->count - t->loading};
    for (int side = 0; side < 2; side++) {
        int first, count;
        double sum = 0, relative = 0;
        sf_compression_branch(d, k, side == 1, &first, &count);
        for (int i = first; i < first + count; i++) {
            double deviation = d->stress[i] - fit->stress[i];
            sum += pow(deviation / d->sigma[i], 2);
            relative += pow(deviation / counted(fit, i), 2);
        }
        out->rms[side] = count ? sqrt(sum / count) : NAN;
        out->percent[side] = count ? 100 * sqrt(relative / count) : NAN;
    }
}

static sf_status compare_card(sf_table_result *r, sf_error *err) {
    const sf_compression_data *d = &r->fit.data;
    const sf_material material = sf_foam_material(&r->card);
    sf_material_law law;
    SF_TRY(sf_material_law_build(&material, &law, err));
    double *stress = sf_alloc(err, (unsigned long)d->count, sizeof *stress, "stresses of the card");
    for (int k = 0, first = 0; stress && k < d->config->test_count; k++) {
        const sf_compression_test *t = &d->config->test[k];
        sf_material_point_drive(&law, t->rate, CARD_STEP, t->count, &d->strain[first], &stress[first]);
        for (int i = first; i < first + t->count; i++)
            r->card_percent =
                fmax(r->card_percent, 100 * fabs(stress[i] - r->fit.stress[i]) / counted(&r->fit, i));
        first += t->count;
    }
    free(stress);
    sf_material_law_free(&law);
    return err->status;
}

sf_status sf_table_result_make(const sf_compression_config *config, sf_table_result *r, sf_error *err) {
    SF_TRY(sf_compression_fit_run(config, &r->fit, err));
    r->test_count = config->test_count;
    for (int k = 0; k < r->test_count; k++)
        compare_test(&r->fit, k, &r->test[k]);
    SF_TRY(sf_compression_card(&r->fit, &r->card, err));
    return compare_card(r, err);
}

void sf_table_result_free(sf_table_result *r) {
    sf_compression_fit_free(&r->fit);
    sf_foam_card_free(&r->card);
    free(r->cube);
}

/* ---- words ---- */

const char *sf_table_rate_phrase(sf_rate_model model) {
    static const char *const phrases[SF_RATE_MODELS] = {
        "none: one curve for all rates",
        "log: curve times 1 + c ln(rate/slowest rate), written as a curve for each rate",
        "maxwell: one curve and a Maxwell branch ED, BETA1",
        "curves: a curve of its own for each rate",
    };
    return phrases[model];
}

const char *sf_table_rule_phrase(sf_rule rule) {
    static const char *const phrases[SF_RULES] = {
        "H1, exponent by A = 0: B/(1 - strain)^m",
        "H1, exponent free: A + B/(1 - strain)^m",
        "H2: A + B/(limit - strain)^m",
    };
    return phrases[rule];
}

/* A value of the estimate with its unit; pressures in kPa. */
static void value_text(const sf_estimate *e, double value, char *out, size_t size) {
    bool pressure = strcmp(e->unit, "Pa") == 0;
    const char *unit = pressure ? "kPa" : e->unit;
    if (isfinite(value))
        snprintf(out, size, "%.5g%s%s", value * (pressure ? 1e-3 : 1), *unit ? " " : "", unit);
    else
        snprintf(out, size, "-");
}

sf_table_estimate sf_table_estimate_of(const sf_compression_fit *fit, int k) {
    const sf_estimate *e = &fit->estimate[k];
    sf_table_estimate out = {.name = e->name, .note = e->note};
    char low[64], high[64];
    value_text(e, e->value, out.value, sizeof out.value);
    value_text(e, e->error, out.error, sizeof out.error);
    value_text(e, e->low, low, sizeof low);
    value_text(e, e->high, high, sizeof high);
    if (isfinite(e->low))
        snprintf(out.interval, sizeof out.interval, "%s to %s", low, high);
    return out;
}

/* ---- rows ---- */

sf_rows sf_table_test_rows(void) {
    static const sf_row rows[] = {
        {.name = "file", SF_ROW_OF(STRING, sf_table_test, name)},
        {.key = "file", SF_ROW_OF(STRING, sf_table_test, path)},
        {.key = "understood", SF_ROW_OF(STRING, sf_table_test, interpretation)},
        {.key = "toe_strain", SF_ROW_OF(NUMBER, sf_table_test, toe)},
        {.key = "rate_1_s", .name = "rate", .unit = "1/s", SF_ROW_OF(NUMBER, sf_table_test, rate)},
        {.key = "points_loading", .name = "points of loading", SF_ROW_OF(INTEGER, sf_table_test, loading)},
        {.key = "points_unloading", .name = "of unloading", SF_ROW_OF(INTEGER, sf_table_test, unloading)},
        {.key = "largest_strain", .name = "largest strain", SF_ROW_OF(NUMBER, sf_table_test, largest_strain)},
        {.key = "largest_stress_Pa",
         .name = "largest stress",
         .unit = "kPa",
         .shown = 1e-3,
         SF_ROW_OF(NUMBER, sf_table_test, largest_stress)},
        {.key = "loading_rms_over_sigma",
         .name = "deviation / scatter, loading",
         .format = "%.3g",
         SF_ROW_OF(NUMBER, sf_table_test, rms[0])},
        {.key = "unloading_rms_over_sigma",
         .name = "unloading",
         .format = "%.3g",
         SF_ROW_OF(NUMBER, sf_table_test, rms[1])},
        {.key = "loading_rms_percent",
         .name = "deviation, loading",
         .unit = "%",
         .format = "%.3g",
         SF_ROW_OF(NUMBER, sf_table_test, percent[0])},
        {.key = "unloading_rms_percent",
         .name = "unloading",
         .unit = "%",
         .format = "%.3g",
         SF_ROW_OF(NUMBER, sf_table_test, percent[1])},
    };
    return SF_ROWS(rows);
}

sf_rows sf_table_simulation_rows(void) {
    static const sf_row rows[] = {
        {.key = "rate_1_s", .name = "rate", .unit = "1/s", SF_ROW_OF(NUMBER, sf_table_test, rate)},
        {.key = "speed_up", .name = "speed-up", SF_ROW_OF(NUMBER, sf_table_test, speed_up)},
        {.key = "loading_difference_percent",
         .name = "largest difference, loading",
         .unit = "%",
         .format = "%.2g",
         SF_ROW_OF(NUMBER, sf_table_test, difference[0])},
        {.key = "unloading_difference_percent",
         .name = "unloading",
         .unit = "%",
         .format = "%.2g",
         SF_ROW_OF(NUMBER, sf_table_test, difference[1])},
        {.key = "energy_error",
         .name = "energy error",
         .format = "%.1g",
         SF_ROW_OF(NUMBER, sf_table_test, energy_error)},
    };
    return SF_ROWS(rows);
}
