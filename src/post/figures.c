/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures.h"

#include <math.h>
#include <string.h>

static sf_status compute_curves(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    sf_series uniform = {0};
    if (sf_series_create(h->rows, &f->raw, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < h->rows; i++) {
        f->raw.time[i] = h->time[i];
        f->raw.value[i] = h->acceleration[i] / SF_STANDARD_GRAVITY;
    }
    f->rate = sf_signal_rate(&f->raw);
    if (sf_signal_resample(&f->raw, f->rate, &uniform, err) == SF_OK)
        sf_signal_filter_cfc(&uniform, f->cfc, &f->filtered, err);
    sf_series_free(&uniform);
    return err->status;
}

static void compute_energies(const sf_results *r, sf_figures *f) {
    sf_internal_energy e = sf_history_internal_energy(&r->history);
    f->internal_energy_peak = e.peak;
    f->internal_energy_peak_time = e.time;
    f->stabilisation_energy_fraction = e.stabilisation;
    f->contact_energy_fraction = e.contact;
}

/* Contact has ended if a row without contact follows the last row with it; the speed there is the rebound's.
 */
static void compute_rebound(const sf_results *r, sf_figures *f) {
    const sf_history *h = &r->history;
    int64_t last = h->rows - 1;
    while (last > 0 && !(h->contact_nodes[last] > 0))
        last--;
    if (last == h->rows - 1 || !(h->velocity[last + 1] < 0))
        return;
    f->rebounded = true;
    f->v_rebound = -h->velocity[last + 1];
    f->rebound_time = h->time[last + 1];
    double initial = r->missile_mass * f->v0 * f->v0 / 2;
    f->absorbed_energy = initial - r->missile_mass * f->v_rebound * f->v_rebound / 2;
    f->absorbed_energy_fraction = f->absorbed_energy / initial;
}

static void compute_extremes(const sf_results *r, sf_figures *f) {
    const sf_history *h = &r->history;
    int64_t deepest = sf_history_row_of_largest(h, h->indentation);
    int64_t strained = sf_history_row_of_largest(h, h->largest_compression);
    f->max_indentation = h->indentation[deepest];
    f->max_indentation_time = h->time[deepest];
    f->max_mean_strain = f->max_indentation / r->thickness;
    f->max_local_strain = h->largest_compression[strained];
    f->max_local_strain_time = h->time[strained];
    f->max_penetration = sf_history_largest(h, h->penetration);
    f->smallest_jacobian = h->smallest_jacobian[0];
    for (int64_t i = 1; i < h->rows; i++)
        f->smallest_jacobian = fmin(f->smallest_jacobian, h->smallest_jacobian[i]);
}

static double mean_section(const sf_results *r) {
    double volume = 0;
    for (int64_t i = 0; i < r->node_count; i++)
        volume += r->volume[i];
    return (double)r->symmetry_factor * volume / r->thickness;
}

static void compute_compression(const sf_results *r, sf_figures *f) {
    const sf_history *h = &r->history;
    const double *work = h->energy_external;
    int64_t peak = sf_history_row_of_largest(h, h->contact_force), last = h->rows - 1;
    f->peak_force = h->contact_force[peak];
    f->peak_force_time = h->time[peak];
    f->peak_stress = f->peak_force / f->area;
    f->work = work[sf_history_row_of_largest(h, h->energy_external)];
    if (h->contact_nodes[last] == 0)
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
    const sf_history *h = &results->history;
    f->driven = results->motion_count > 0;
    f->area = mean_section(results);
    set_undefined(f);
    if (compute_curves(results, f, err) != SF_OK)
        goto done;
    f->energy_error = sf_history_largest(h, h->energy_error);
    f->momentum_error = sf_history_largest(h, h->momentum_error);
    f->constraint_residual = sf_history_largest(h, h->constraint_residual);
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
