/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/figures.h"

#include "base/mat3.h"
#include "base/units.h"
#include "post/figures/edge.h"
#include "post/results/results_check.h"
#include "post/figures/strain_field.h"
#include <stdio.h>
#include <stdlib.h>
#include <math.h>
#include <string.h>

static const double FREE_FLIGHT = 5e-3; /* s, at least, before the first contact */

const sf_figure *sf_figure_list(size_t *count) {
#define PLACE_NUMBER(member) false, SF_ROW_OF(NUMBER, sf_figures, member)
#define PLACE_INNER(member) false, SF_ROW_OF(NUMBER, sf_figures, member)
#define PLACE_COUNT(member) false, SF_ROW_OF(COUNT, sf_figures, member)
#define PLACE_FLAG(member) false, SF_ROW_OF(FLAG, sf_figures, member)
#define PLACE_FACT(member) true, SF_ROW_OF(NUMBER, sf_results, member)
#define PLACE_FACT_COUNT(member) true, SF_ROW_OF(COUNT, sf_results, member)
#define PLACE_FACT_TEXT(member) true, SF_ROW_OF(TEXT, sf_results, member)
#define ROW(is_fact, place_type, place_offset, row_key, row_factor, ...)                                     \
    {{.key = row_key, place_type, place_offset, .factor = row_factor, .meaning = __VA_ARGS__}, is_fact},
#define EXPAND(...) ROW(__VA_ARGS__)
#define FIGURE(kind, member, key, factor, ...) EXPAND(PLACE_##kind(member), key, factor, __VA_ARGS__)
    static const sf_figure list[] = {SF_FIGURES(FIGURE)};
    *count = sizeof list / sizeof list[0];
    return list;
}

const void *sf_figure_record(const sf_figure *figure, const sf_results *results, const sf_figures *figures) {
    return figure->fact ? (const void *)results : (const void *)figures;
}

double sf_figure_number(const sf_figure *figure, const sf_results *results, const sf_figures *figures) {
    return sf_row_number(&figure->row, sf_figure_record(figure, results, figures));
}

const sf_figure *sf_figure_find(const char *key) {
    size_t count;
    const sf_figure *figure = sf_figure_list(&count);
    for (size_t k = 0; k < count; k++)
        if (strcmp(figure[k].row.key, key) == 0)
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

/* The filtered curve begins with free flight, at that level, so that filter and HIC see the onset whole. */
static sf_status filter(const sf_results *r, const sf_series *raw, double free_flight, const sf_figures *f,
                        sf_series *filtered, sf_error *err) {
    double lead = FREE_FLIGHT - (first_contact(&r->history) - r->history.time[0]);
    sf_series before = {0}, uniform = {0};
    if (lead > 0 && sf_signal_lead_in(raw, lead, free_flight, &before, err) != SF_OK)
        return err->status;
    if (sf_signal_resample(lead > 0 ? &before : raw, f->rate, &uniform, err) == SF_OK) {
        sf_signal_pass(&f->chain, &uniform);
        sf_signal_filter_cfc(&uniform, f->cfc, filtered, err);
    }
    sf_series_free(&before);
    sf_series_free(&uniform);
    return err->status;
}

/* Three channels, filtered one by one, and their resultant; `flight`: the channels' values in free flight. */
static sf_status filter_resultant(const sf_results *r, const double *const channel[3], const double flight[3],
                                  const double shift[3], double unit, const sf_figures *f, sf_series *out,
                                  sf_error *err) {
    const sf_history *h = &r->history;
    sf_series raw = {0};
    if (sf_series_create(h->rows, &raw, err) != SF_OK)
        return err->status;
    memcpy(raw.time, h->time, (size_t)h->rows * sizeof *raw.time);
    for (int c = 0; c < 3 && err->status == SF_OK; c++) {
        sf_series one = {0};
        for (int64_t i = 0; i < h->rows; i++)
            raw.value[i] = (channel[c][i] + shift[c]) / unit;
        if (filter(r, &raw, (flight[c] + shift[c]) / unit, f, &one, err) != SF_OK)
            break;
        if (c == 0) {
            *out = one;
            for (int64_t i = 0; i < out->count; i++)
                out->value[i] *= out->value[i];
            continue;
        }
        for (int64_t i = 0; i < out->count; i++)
            out->value[i] += one.value[i] * one.value[i];
        sf_series_free(&one);
    }
    for (int64_t i = 0; i < out->count && err->status == SF_OK; i++)
        out->value[i] = sqrt(out->value[i]);
    sf_series_free(&raw);
    return err->status;
}

/* Returns the acceleration that is added to the specific force along an axis, and against the direction of a
 * guided missile. */
static double shift_of(const sf_results *r, int axis) {
    return r->kinematic ? r->gravity[axis] : 0;
}

static double shift_along(const sf_results *r) {
    return r->kinematic ? -r->gravity_along / SF_STANDARD_GRAVITY : 0;
}

double sf_figures_reading(const sf_results *r, int64_t row) {
    const sf_history *h = &r->history;
    if (!r->turns)
        return h->acceleration[row] / SF_STANDARD_GRAVITY + shift_along(r);
    double x = h->specific_force_x[row] + shift_of(r, 0), y = h->specific_force_y[row] + shift_of(r, 1),
           z = h->specific_force_z[row] + shift_of(r, 2);
    return sqrt(x * x + y * y + z * z) / SF_STANDARD_GRAVITY;
}

static sf_status compute_resultant(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    const double *const channel[3] = {h->specific_force_x, h->specific_force_y, h->specific_force_z};
    static const double none[3] = {0};
    const double shift[3] = {shift_of(r, 0), shift_of(r, 1), shift_of(r, 2)};
    f->free_flight = sqrt(sf_dot3(shift, shift)) / SF_STANDARD_GRAVITY;
    f->rate = sf_signal_rate(&f->raw);
    return filter_resultant(r, channel, none, shift, SF_STANDARD_GRAVITY, f, &f->filtered, err);
}

static sf_status compute_curves(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    if (sf_series_create(h->rows, &f->raw, err) != SF_OK)
        return err->status;
    memcpy(f->raw.time, h->time, (size_t)h->rows * sizeof *f->raw.time);
    for (int64_t i = 0; i < h->rows; i++)
        f->raw.value[i] = sf_figures_reading(r, i);
    if (r->turns)
        return compute_resultant(r, f, err);
    f->free_flight = shift_along(r);
    f->rate = sf_signal_rate(&f->raw);
    return filter(r, &f->raw, f->free_flight, f, &f->filtered, err);
}

/* `known`: the first row is still that of free flight. */
static sf_status find_peak(const sf_results *r, const double *const channel[3], bool known,
                           const sf_figures *f, double *peak, double *time, sf_error *err) {
    static const double none[3] = {0};
    const double first[3] = {channel[0][0], channel[1][0], channel[2][0]};
    sf_series curve = {0};
    if (filter_resultant(r, channel, known ? first : none, none, 1, f, &curve, err) == SF_OK) {
        int64_t row = 0;
        for (int64_t i = 1; i < curve.count; i++)
            row = curve.value[i] > curve.value[row] ? i : row;
        *peak = curve.value[row];
        *time = curve.time[row];
    }
    sf_series_free(&curve);
    return err->status;
}

static sf_status compute_rotation(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    const double *const acceleration[3] = {h->angular_acceleration_x, h->angular_acceleration_y,
                                           h->angular_acceleration_z},
                        *const velocity[3] = {h->angular_velocity_x, h->angular_velocity_y,
                                              h->angular_velocity_z};
    f->peak_resultant = f->injury.a_max_g;
    if (find_peak(r, acceleration, first_contact(h) > h->time[0], f, &f->peak_angular_acceleration,
                  &f->peak_angular_acceleration_time, err))
        return err->status;
    return find_peak(r, velocity, true, f, &f->peak_angular_velocity, &f->peak_angular_velocity_time, err);
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

/* Returns the energy that dissipation has given back, over `scale`: the whole of a kind at one time, or the
 * sum over single nodes, whose gains the whole hides. None may give any. */
static double negative_dissipation(const sf_results *r, double scale) {
    const sf_history *h = &r->history;
    const double *const dissipated[] = {h->energy_hysteresis, h->energy_viscous, h->energy_friction,
                                        h->energy_stabilisation};
    double least = fmin(0, -r->given_back);
    for (size_t k = 0; k < sizeof dissipated / sizeof dissipated[0]; k++)
        for (int64_t i = 0; i < h->rows; i++)
            least = fmin(least, dissipated[k][i]);
    return scale > 0 ? 0 - least / scale : NAN;
}

static void compute_energies(const sf_results *r, sf_figures *f) {
    sf_internal_energy e = sf_history_internal_energy(&r->history);
    f->internal_energy_peak = e.peak;
    f->internal_energy_peak_time = e.time;
    f->stabilisation_energy_fraction = e.stabilisation;
    f->contact_energy_fraction = e.contact;
    f->negative_dissipation = negative_dissipation(r, e.peak);
}

/* Contact has ended if a row without contact follows the last row with it; the speed there is the rebound's.
 */
static void compute_rebound(const sf_results *r, sf_figures *f) {
    const sf_history *h = &r->history;
    int64_t last = h->rows - 1;
    while (last > 0 && !(h->contact_nodes[last] > 0))
        last--;
    if (last == h->rows - 1)
        return;
    double upwards = r->turns ? h->velocity_z[last + 1] : -h->velocity[last + 1];
    if (!(upwards > 0))
        return;
    f->rebounded = true;
    f->v_rebound = upwards;
    f->rebound_time = h->time[last + 1];
    double initial = r->missile_mass * f->v0 * f->v0 / 2;
    f->absorbed_energy = initial - r->missile_mass * f->v_rebound * f->v_rebound / 2;
    if (r->turns) {
        int64_t before = 0; /* the last row before contact */
        while (before + 1 < last && !(h->contact_nodes[before + 1] > 0))
            before++;
        initial = h->energy_kinetic_missile[before];
        f->absorbed_energy = initial - h->energy_kinetic_missile[last + 1];
    }
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
    f->max_mean_strain = fmax(0, f->max_indentation - (r->air > 0 ? r->air : 0)) / r->thickness;
    f->max_local_strain = h->largest_compression[strained];
    f->max_local_strain_time = h->time[strained];
    f->local_strain_excess = f->max_local_strain - f->max_mean_strain;
    f->max_penetration = sf_history_largest(h, h->penetration);
    f->smallest_jacobian = h->smallest_jacobian[0];
    for (int64_t i = 1; i < h->rows; i++)
        f->smallest_jacobian = fmin(f->smallest_jacobian, h->smallest_jacobian[i]);
}

/* Computes figures of the fields at the peak, if the file has them; those of a failed run may be damaged. */
static sf_status compute_fields(const sf_results *r, sf_figures *f, sf_error *err) {
    sf_error problem = SF_ERROR_INIT;
    sf_frame peak;
    if (!r->has_peak) {
        f->layers = sf_layer_figures_compute(r, NULL, NULL, err);
        return err->status;
    }
    int fields = SF_FIELD_LARGEST_COMPRESSION | SF_FIELD_ENERGY_DENSITY |
                 (r->layer_count > 1 ? SF_FIELD_DISPLACEMENT : 0);
    if (sf_frame_read_fields(r, &r->peak, fields, &peak, &problem) != SF_OK)
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
        sf_strain_field_collapse(r, compression, peak.field[SF_FRAME_DISPLACEMENT], &f->local_collapse, err);
    sf_frame_free(&peak);
    return err->status;
}

/* Raises *depth (m) to that of the deepest node of the frame below z = plane. */
static sf_status add_depth(const sf_results *r, const sf_frame_head *head, double plane, double *depth,
                           sf_error *err) {
    sf_frame frame;
    if (sf_frame_read_fields(r, head, SF_FIELD_DISPLACEMENT, &frame, err) != SF_OK)
        return err->status;
    const double *u = frame.field[SF_FRAME_DISPLACEMENT];
    for (int64_t i = 0; u && i < r->node_count; i++)
        *depth = fmax(*depth, plane - (r->position[3 * i + 2] + u[3 * i + 2]));
    sf_frame_free(&frame);
    return SF_OK;
}

/* Computes the depth below the anvil; frames of a failed run may be damaged. */
static sf_status compute_below_anvil(const sf_results *r, sf_figures *f, sf_error *err) {
    double high = -INFINITY, depth = 0;
    sf_error problem = SF_ERROR_INIT;
    if (!(r->anvil_depth > 0) || r->frame_count + r->has_peak == 0)
        return SF_OK;
    for (int64_t i = 0; i < r->node_count; i++)
        high = fmax(high, r->position[3 * i + 2]);
    double plane = high - r->anvil_depth;
    for (int64_t k = 0; k < r->frame_count && problem.status == SF_OK; k++)
        add_depth(r, &r->frames[k], plane, &depth, &problem);
    if (problem.status == SF_OK && r->has_peak)
        add_depth(r, &r->peak, plane, &depth, &problem);
    if (problem.status == SF_OK)
        f->below_anvil = depth;
    else if (sf_results_ended_well(r))
        SF_FAIL(err, problem.status, "%s", problem.text);
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
        if (!figure[k].fact && figure[k].row.type == SF_ROW_NUMBER)
            *(double *)((char *)f + figure[k].row.offset) = NAN;
}

/* Figures of every run, free or driven. */
static void take_facts(const sf_results *r, double cfc, sf_figures *f) {
    f->cfc = cfc;
    f->touched = sf_results_touched(r);
    f->driven = r->driven;
    f->turns = r->turns;
    f->kinematic = r->kinematic;
    f->v0 = f->driven ? NAN : r->missile_speed;
    f->missile_mass = f->driven ? NAN : r->missile_mass;
    f->area = sf_results_cross_section(r);
    f->end_time = r->history.time[r->history.rows - 1];
    f->steps = r->has_summary ? r->steps : r->history.rows - 1;
}

static void take_edge(const sf_results *results, sf_figures *f) {
    sf_edge edge;
    sf_edge_estimate(results, f->injury.hic.t2 - f->injury.hic.t1, &edge);
    f->a_max_by_speed = edge.a_max_by_speed;
    f->a_max_by_thickness = edge.a_max_by_thickness;
    f->a_max_by_stress = edge.a_max_by_stress;
    f->a_max_by_lock_up = edge.a_max_by_lock_up;
    f->hic_by_lock_up = edge.hic_by_lock_up;
    f->hic_by_speed = edge.hic_by_speed;
    f->hic_by_thickness = edge.hic_by_thickness;
    f->hic_by_stress = edge.hic_by_stress;
    f->a_max_scatter = edge.a_max_scatter;
    f->hic_scatter = edge.hic_scatter;
}

/* Names the acceleration that the curves show, and what it has passed. */
static void name_acceleration(sf_figures *f) {
    f->acceleration =
        f->turns       ? f->kinematic ? "resultant kinematic acceleration of the centre of mass"
                                      : "resultant acceleration of the centre of mass as an accelerometer reads it"
        : f->kinematic ? "kinematic deceleration"
                       : "acceleration as an accelerometer reads it";
    size_t size = sizeof f->passed, used = 0;
    if (f->chain.mount_frequency > 0)
        used = (size_t)snprintf(f->passed, size, ", on a mount of %.4g Hz (damping %.3g)",
                                f->chain.mount_frequency, f->chain.mount_damping);
    if (f->chain.coupling > 0)
        snprintf(f->passed + used, size - used, ", with a coupling of %.4g s", f->chain.coupling);
}

sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *f, sf_error *err) {
    return sf_figures_compute_through(results, cfc, NULL, f, err);
}

sf_status sf_figures_compute_through(const sf_results *results, double cfc, const sf_signal_chain *chain,
                                     sf_figures *f, sf_error *err) {
    const sf_history *h = &results->history;
    *f = (sf_figures){0};
    set_undefined(f);
    f->chain = chain ? *chain : (sf_signal_chain){0};
    take_facts(results, cfc, f);
    name_acceleration(f);
    if (compute_curves(results, f, err) != SF_OK)
        goto done;
    f->energy_error = sf_history_largest(h, h->energy_error);
    f->momentum_error = sf_history_largest(h, h->momentum_error);
    f->momentum_error_space = sf_history_largest(h, h->momentum_error_space);
    f->angular_momentum_error = sf_history_largest(h, h->angular_momentum_error);
    f->constraint_residual = sf_history_largest(h, h->constraint_residual);
    if (!f->touched)
        goto done;
    compute_energies(results, f);
    compute_extremes(results, f);
    if (compute_fields(results, f, err) != SF_OK || compute_below_anvil(results, f, err) != SF_OK)
        goto done;
    if (f->driven) {
        compute_compression(results, f);
        goto done;
    }
    if (sf_injury_evaluate_peak(&f->raw, &f->injury_raw, err) != SF_OK ||
        sf_injury_evaluate(&f->filtered, &f->injury, err) != SF_OK)
        goto done;
    if (f->turns && compute_rotation(results, f, err) != SF_OK)
        goto done;
    f->raw_peak_rows = count_peak_rows(&f->raw);
    compute_rebound(results, f);
    if (f->rebounded)
        take_edge(results, f);
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
