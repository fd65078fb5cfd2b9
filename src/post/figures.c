/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures.h"

#include "core/units.h"
#include <math.h>
#include <string.h>

static double largest_magnitude(const sf_results *r, sf_history_column column) {
    double largest = 0;
    for (int64_t i = 0; i < r->history_rows; i++)
        largest = fmax(largest, fabs(r->history[column][i]));
    return largest;
}

static int64_t row_of_largest(const sf_results *r, sf_history_column column) {
    int64_t row = 0;
    for (int64_t i = 1; i < r->history_rows; i++)
        if (r->history[column][i] > r->history[column][row])
            row = i;
    return row;
}

static double internal_energy(const sf_results *r, int64_t i) {
    return r->history[SF_HISTORY_ENERGY_STORED][i] + r->history[SF_HISTORY_ENERGY_HYSTERESIS][i] +
           r->history[SF_HISTORY_ENERGY_VISCOUS][i] + r->history[SF_HISTORY_ENERGY_STABILISATION][i];
}

static sf_status compute_curves(const sf_results *r, sf_figures *f, sf_error *err) {
    sf_series uniform = {0};
    if (sf_series_create(r->history_rows, &f->raw, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < r->history_rows; i++) {
        f->raw.time[i] = r->history[SF_HISTORY_TIME][i];
        f->raw.value[i] = r->history[SF_HISTORY_ACCELERATION][i] / SF_STANDARD_GRAVITY;
    }
    f->rate = sf_signal_rate(&f->raw);
    if (sf_signal_resample(&f->raw, f->rate, &uniform, err) == SF_OK)
        sf_signal_filter_cfc(&uniform, f->cfc, &f->filtered, err);
    sf_series_free(&uniform);
    return err->status;
}

static void compute_energies(const sf_results *r, sf_figures *f) {
    int64_t peak = 0;
    for (int64_t i = 1; i < r->history_rows; i++)
        if (internal_energy(r, i) > internal_energy(r, peak))
            peak = i;
    f->internal_energy_peak = internal_energy(r, peak);
    f->internal_energy_peak_time = r->history[SF_HISTORY_TIME][peak];
    if (f->internal_energy_peak > 0) {
        f->stabilisation_energy_fraction =
            r->history[SF_HISTORY_ENERGY_STABILISATION][peak] / f->internal_energy_peak;
        f->contact_energy_fraction = r->history[SF_HISTORY_ENERGY_CONTACT][peak] / f->internal_energy_peak;
    }
}

/* Contact has ended if a row without contact follows the last row with it; the speed there is the rebound's.
 */
static void compute_rebound(const sf_results *r, sf_figures *f) {
    int64_t last = r->history_rows - 1;
    while (last > 0 && !(r->history[SF_HISTORY_CONTACT_NODES][last] > 0))
        last--;
    if (last == r->history_rows - 1 || !(r->history[SF_HISTORY_VELOCITY][last + 1] < 0))
        return;
    f->rebounded = true;
    f->v_rebound = -r->history[SF_HISTORY_VELOCITY][last + 1];
    f->rebound_time = r->history[SF_HISTORY_TIME][last + 1];
    double initial = r->missile_mass * f->v0 * f->v0 / 2;
    f->absorbed_energy = initial - r->missile_mass * f->v_rebound * f->v_rebound / 2;
    f->absorbed_energy_fraction = f->absorbed_energy / initial;
}

static void compute_extremes(const sf_results *r, sf_figures *f) {
    int64_t deepest = row_of_largest(r, SF_HISTORY_INDENTATION);
    int64_t strained = row_of_largest(r, SF_HISTORY_LARGEST_COMPRESSION);
    f->max_indentation = r->history[SF_HISTORY_INDENTATION][deepest];
    f->max_indentation_time = r->history[SF_HISTORY_TIME][deepest];
    f->max_mean_strain = f->max_indentation / r->thickness;
    f->max_local_strain = r->history[SF_HISTORY_LARGEST_COMPRESSION][strained];
    f->max_local_strain_time = r->history[SF_HISTORY_TIME][strained];
    f->max_penetration = largest_magnitude(r, SF_HISTORY_PENETRATION);
    f->smallest_jacobian = r->history[SF_HISTORY_SMALLEST_JACOBIAN][0];
    for (int64_t i = 1; i < r->history_rows; i++)
        f->smallest_jacobian = fmin(f->smallest_jacobian, r->history[SF_HISTORY_SMALLEST_JACOBIAN][i]);
}

static void compute_compression(const sf_results *r, sf_figures *f) {
    const double *work = r->history[SF_HISTORY_ENERGY_EXTERNAL];
    int64_t peak = row_of_largest(r, SF_HISTORY_CONTACT_FORCE), last = r->history_rows - 1;
    f->peak_force = r->history[SF_HISTORY_CONTACT_FORCE][peak];
    f->peak_force_time = r->history[SF_HISTORY_TIME][peak];
    f->peak_stress = f->peak_force / f->area;
    f->work = work[row_of_largest(r, SF_HISTORY_ENERGY_EXTERNAL)];
    if (r->history[SF_HISTORY_CONTACT_NODES][last] == 0)
        f->returned_energy_fraction = (f->work - work[last]) / f->work;
}

static void set_undefined(sf_figures *f) {
    const sf_hic no_hic = {NAN, NAN, NAN};
    f->injury = (sf_injury){NAN, NAN, no_hic, no_hic, no_hic, NAN, NAN, NAN};
    f->injury_raw = f->injury;
    f->v_rebound = f->rebound_time = f->absorbed_energy = f->absorbed_energy_fraction = NAN;
    f->max_indentation = f->max_indentation_time = f->max_mean_strain = NAN;
    f->max_local_strain = f->max_local_strain_time = f->smallest_jacobian = f->max_penetration = NAN;
    f->internal_energy_peak = f->internal_energy_peak_time = NAN;
    f->stabilisation_energy_fraction = f->contact_energy_fraction = NAN;
    f->peak_force = f->peak_force_time = f->peak_stress = f->work = f->returned_energy_fraction = NAN;
}

sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *f, sf_error *err) {
    *f = (sf_figures){.cfc = cfc, .touched = sf_results_touched(results), .v0 = results->missile_speed};
    f->driven = results->driven;
    f->area = sf_results_cross_section(results);
    set_undefined(f);
    if (compute_curves(results, f, err) != SF_OK)
        goto done;
    f->energy_error = largest_magnitude(results, SF_HISTORY_ENERGY_ERROR);
    f->momentum_error = largest_magnitude(results, SF_HISTORY_MOMENTUM_ERROR);
    f->constraint_residual = largest_magnitude(results, SF_HISTORY_CONSTRAINT_RESIDUAL);
    if (!f->touched)
        goto done;
    compute_energies(results, f);
    compute_extremes(results, f);
    if (f->driven) {
        compute_compression(results, f);
        goto done;
    }
    if (sf_injury_evaluate(&f->raw, &f->injury_raw, err) != SF_OK ||
        sf_injury_evaluate(&f->filtered, &f->injury, err) != SF_OK)
        goto done;
    compute_rebound(results, f);
done:
    if (err->status != SF_OK)
        sf_figures_free(f);
    return err->status;
}

void sf_figures_free(sf_figures *figures) {
    sf_series_free(&figures->raw);
    sf_series_free(&figures->filtered);
    *figures = (sf_figures){0};
}
