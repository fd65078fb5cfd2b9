/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures.h"

#include "core/units.h"
#include "post/results_check.h"
#include "post/strain_field.h"
#include <stdlib.h>
#include <math.h>
#include <string.h>

static const double FREE_FLIGHT = 5e-3; /* s, at least, before the first contact */

const sf_figure *sf_figure_list(size_t *count) {
#define IN_FIGURES(member) false, offsetof(sf_figures, member)
#define IN_RESULTS(member) true, offsetof(sf_results, member)
#define PLACE_NUMBER(member) SF_FIGURE_DOUBLE, IN_FIGURES(member)
#define PLACE_INNER(member) SF_FIGURE_DOUBLE, IN_FIGURES(member)
#define PLACE_COUNT(member) SF_FIGURE_INTEGER, IN_FIGURES(member)
#define PLACE_FLAG(member) SF_FIGURE_BOOL, IN_FIGURES(member)
#define PLACE_FACT(member) SF_FIGURE_DOUBLE, IN_RESULTS(member)
#define PLACE_FACT_COUNT(member) SF_FIGURE_INTEGER, IN_RESULTS(member)
#define PLACE_FACT_TEXT(member) SF_FIGURE_TEXT, IN_RESULTS(member)
#define FIGURE(kind, member, key, factor, meaning) {key, PLACE_##kind(member), factor, meaning},
    static const sf_figure list[] = {SF_FIGURES(FIGURE)};
    *count = sizeof list / sizeof list[0];
    return list;
}

const void *sf_figure_place(const sf_figure *figure, const sf_results *results, const sf_figures *figures) {
    return (figure->fact ? (const char *)results : (const char *)figures) + figure->offset;
}

const sf_figure *sf_figure_find(const char *key) {
    size_t count;
    const sf_figure *figure = sf_figure_list(&count);
    for (size_t k = 0; k < count; k++)
        if (strcmp(figure[k].key, key) == 0)
            return &figure[k];
    return NULL;
}

/* Time (s) of the first row with contact; INFINITY without. */
static double first_contact(const sf_history *h) {
    for (int64_t i = 0; i < h->rows; i++)
        if (h->contact_nodes[i] > 0)
            return h->time[i];
    return INFINITY;
}

/* The filtered curve begins with free flight, so that filter and HIC see the onset whole. */
static sf_status filter(const sf_results *r, double free_flight, sf_figures *f, sf_error *err) {
    double lead = FREE_FLIGHT - (first_contact(&r->history) - r->history.time[0]);
    sf_series before = {0}, uniform = {0};
    f->rate = sf_signal_rate(&f->raw);
    if (lead > 0 && sf_signal_lead_in(&f->raw, lead, free_flight, &before, err) != SF_OK)
        return err->status;
    if (sf_signal_resample(lead > 0 ? &before : &f->raw, f->rate, &uniform, err) == SF_OK)
        sf_signal_filter_cfc(&uniform, f->cfc, &f->filtered, err);
    sf_series_free(&before);
    sf_series_free(&uniform);
    return err->status;
}

static sf_status compute_curves(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    double free_flight = r->kinematic ? -r->gravity_along / SF_STANDARD_GRAVITY : 0;
    if (sf_series_create(h->rows, &f->raw, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < h->rows; i++) {
        f->raw.time[i] = h->time[i];
        f->raw.value[i] = h->acceleration[i] / SF_STANDARD_GRAVITY + free_flight;
    }
    return filter(r, free_flight, f, err);
}

/* Rows around the raw peak, without a gap, above half of it. */
static int64_t count_peak_rows(const sf_series *raw) {
    int64_t peak = 0;
    for (int64_t i = 1; i < raw->count; i++)
        if (raw->value[i] > raw->value[peak])
            peak = i;
    int64_t first = peak, last = peak;
    while (first > 0 && raw->value[first - 1] > 0.5 * raw->value[peak])
        first--;
    while (last < raw->count - 1 && raw->value[last + 1] > 0.5 * raw->value[peak])
        last++;
    return last - first + 1;
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
    double volume = sf_history_largest(h, h->contact_area) * r->thickness;
    if (volume > 0)
        f->absorbed_density = f->absorbed_energy / volume;
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
    f->local_strain_excess = f->max_local_strain - f->max_mean_strain;
    f->max_penetration = sf_history_largest(h, h->penetration);
    f->smallest_jacobian = h->smallest_jacobian[0];
    for (int64_t i = 1; i < h->rows; i++)
        f->smallest_jacobian = fmin(f->smallest_jacobian, h->smallest_jacobian[i]);
}

/* Of the fields at the peak, if the file has them. What a failed run left of them may be damaged. */
static sf_status compute_fields(const sf_results *r, sf_figures *f, sf_error *err) {
    sf_error problem = SF_ERROR_INIT;
    sf_frame peak;
    if (!r->has_peak) {
        f->layers = sf_layer_figures_compute(r, NULL, NULL, err);
        return err->status;
    }
    if (sf_frame_read_fields(r, &r->peak, SF_FIELD_LARGEST_COMPRESSION | SF_FIELD_ENERGY_DENSITY, &peak,
                             &problem) != SF_OK)
        return sf_results_ended_well(r) ? SF_FAIL(err, problem.status, "%s", problem.text) : SF_OK;
    const double *compression = peak.field[SF_FRAME_LARGEST_COMPRESSION],
                 *energy = peak.field[SF_FRAME_ENERGY_DENSITY];
    if (compression && energy && isfinite(r->informed_strain))
        f->energy_beyond_data = sf_strain_field_energy_beyond(r, compression, energy, r->informed_strain);
    f->layers = sf_layer_figures_compute(r, compression, energy, err);
    if (f->layers && compression && energy) {
        f->energy_beyond_data = 0;
        for (int k = 0; k < r->layer_count; k++)
            f->energy_beyond_data += f->layers[k].energy_share * f->layers[k].energy_beyond_data;
    }
    if (compression)
        sf_strain_field_collapse(r, compression, &f->local_collapse, err);
    sf_frame_free(&peak);
    return err->status;
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

/* Every figure that is not computed is undefined. */
static void set_undefined(sf_figures *f) {
    size_t count;
    const sf_figure *figure = sf_figure_list(&count);
    for (size_t k = 0; k < count; k++)
        if (!figure[k].fact && figure[k].type == SF_FIGURE_DOUBLE)
            *(double *)((char *)f + figure[k].offset) = NAN;
}

/* Figures of every run, free or driven. */
static void take_facts(const sf_results *r, double cfc, sf_figures *f) {
    f->cfc = cfc;
    f->touched = sf_results_touched(r);
    f->driven = r->driven;
    f->kinematic = r->kinematic;
    f->v0 = f->driven ? NAN : r->missile_speed;
    f->missile_mass = f->driven ? NAN : r->missile_mass;
    f->area = sf_results_cross_section(r);
    f->end_time = r->history.time[r->history.rows - 1];
    f->steps = r->has_summary ? r->steps : r->history.rows - 1;
}

sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *f, sf_error *err) {
    const sf_history *h = &results->history;
    *f = (sf_figures){0};
    set_undefined(f);
    take_facts(results, cfc, f);
    if (compute_curves(results, f, err) != SF_OK)
        goto done;
    f->energy_error = sf_history_largest(h, h->energy_error);
    f->momentum_error = sf_history_largest(h, h->momentum_error);
    f->constraint_residual = sf_history_largest(h, h->constraint_residual);
    if (!f->touched)
        goto done;
    compute_energies(results, f);
    compute_extremes(results, f);
    if (compute_fields(results, f, err) != SF_OK)
        goto done;
    if (f->driven) {
        compute_compression(results, f);
        goto done;
    }
    if (sf_injury_evaluate(&f->raw, &f->injury_raw, err) != SF_OK ||
        sf_injury_evaluate(&f->filtered, &f->injury, err) != SF_OK)
        goto done;
    f->raw_peak_rows = count_peak_rows(&f->raw);
    compute_rebound(results, f);
done:
    if (err->status != SF_OK)
        sf_figures_free(f);
    return err->status;
}

void sf_figures_free(sf_figures *figures) {
    sf_series_free(&figures->raw);
    sf_series_free(&figures->filtered);
    free(figures->layers);
    *figures = (sf_figures){0};
}

const char *sf_figures_acceleration(const sf_figures *figures) {
    return figures->kinematic ? "kinematic deceleration" : "acceleration as an accelerometer reads it";
}
