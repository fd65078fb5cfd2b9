/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/figures.h"

#include "base/text.h"
#include "base/units.h"
#include <string.h>

static const double FREE_FLIGHT = 5e-3; /* s, at least, before the first contact */

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
const sf_figure sf_figure_at[] = {SF_FIGURES(FIGURE)};

const void *sf_figure_record(const sf_figure *figure, const sf_results *results, const sf_figures *figures) {
    return figure->fact ? (const void *)results : (const void *)figures;
}

double sf_figure_number(const sf_figure *figure, const sf_results *results, const sf_figures *figures) {
    return sf_row_number(&figure->row, sf_figure_record(figure, results, figures));
}

const sf_figure *sf_figure_find(const char *key) {
    for (int k = 0; k < SF_FIGURE_TOTAL; k++)
        if (strcmp(sf_figure_at[k].row.key, key) == 0)
            return &sf_figure_at[k];
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
    SF_OWNED_BY(sf_series_free) sf_series before = {0}, uniform = {0};
    if (lead > 0 && sf_signal_lead_in(raw, lead, free_flight, &before, err) != SF_OK)
        return err->status;
    if (sf_signal_resample(lead > 0 ? &before : raw, f->rate, &uniform, err) == SF_OK) {
        sf_signal_pass(&f->chain, &uniform);
        sf_signal_filter_cfc(&uniform, f->cfc, filtered, err);
    }
    return err->status;
}

/* The readings (value + shift) / unit of three axes. */
typedef struct axes {
    const double *value[3]; /* [rows] */
    double flight[3];       /* values in free flight */
    double shift[3], unit;
} axes;

/* The axes, filtered one by one, and their resultant. */
static sf_status filter_resultant(const sf_results *r, const axes *a, const sf_figures *f, sf_series *out,
                                  sf_error *err) {
    const sf_history *h = &r->history;
    SF_OWNED_BY(sf_series_free) sf_series raw = {0};
    SF_TRY(sf_series_create(h->rows, &raw, err));
    memcpy(raw.time, h->time, (size_t)h->rows * sizeof *raw.time);
    for (int c = 0; c < 3 && err->status == SF_OK; c++) {
        sf_series one = {0};
        for (int64_t i = 0; i < h->rows; i++)
            raw.value[i] = (a->value[c][i] + a->shift[c]) / a->unit;
        if (filter(r, &raw, (a->flight[c] + a->shift[c]) / a->unit, f, &one, err) != SF_OK)
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
    const axes a = {.value = {h->specific_force_x, h->specific_force_y, h->specific_force_z},
                    .shift = {shift_of(r, 0), shift_of(r, 1), shift_of(r, 2)},
                    .unit = SF_STANDARD_GRAVITY};
    f->free_flight = sqrt(sf_dot3(a.shift, a.shift)) / SF_STANDARD_GRAVITY;
    f->rate = sf_signal_rate(&f->raw);
    return filter_resultant(r, &a, f, &f->filtered, err);
}

static sf_status compute_curves(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    SF_TRY(sf_series_create(h->rows, &f->raw, err));
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
    axes a = {.value = {channel[0], channel[1], channel[2]}, .unit = 1};
    for (int c = 0; known && c < 3; c++)
        a.flight[c] = channel[c][0];
    SF_OWNED_BY(sf_series_free) sf_series curve = {0};
    SF_TRY(filter_resultant(r, &a, f, &curve, err));
    int64_t row = sf_series_peak(&curve);
    *peak = curve.value[row];
    *time = curve.time[row];
    return err->status;
}

/* rad s-1 about the axes x, y and z of the head, by the strain of the brain (Takhounts et al., Stapp Car
 * Crash J. 57, 2013). */
static const double CRITICAL[3] = {66.25, 56.45, 42.87};

static sf_status compute_bric(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    SF_OWNED double *own =
        sf_alloc(err, (unsigned long)(3 * h->rows), sizeof *own, "angular velocity of the missile");
    f->bric = own ? 0 : NAN;
    for (int64_t k = 0; k < h->rows && own; k++) {
        const double q[4] = {h->quaternion_w[k], h->quaternion_x[k], h->quaternion_y[k], h->quaternion_z[k]},
                     omega[3] = {h->angular_velocity_x[k], h->angular_velocity_y[k],
                                 h->angular_velocity_z[k]};
        double turned[3];
        sf_rotate_back(q, omega, turned);
        for (int axis = 0; axis < 3; axis++)
            own[axis * h->rows + k] = turned[axis];
    }
    for (int axis = 0; axis < 3 && err->status == SF_OK; axis++) {
        const double *one = &own[axis * h->rows], *const same[3] = {one, one, one}; /* sqrt(3) of one */
        double peak = 0, time;
        find_peak(r, same, true, f, &peak, &time, err);
        f->bric = hypot(f->bric, peak / sqrt(3) / CRITICAL[axis]);
    }
    return err->status;
}

/* A force plate has the class of the accelerometer, but not its mount. A prescribed motion has no class. */
static sf_status compute_base_force(const sf_results *r, sf_figures *f, sf_error *err) {
    const double *one = r->history.base_reaction, *const same[3] = {one, one, one}; /* sqrt(3) of one */
    const sf_figures plate = {.cfc = f->cfc, .rate = f->rate};
    double time;
    f->base_force = sf_history_largest(&r->history, one);
    if (!r->driven && find_peak(r, same, true, &plate, &f->base_force, &time, err) == SF_OK)
        f->base_force /= sqrt(3);
    return err->status;
}

static sf_status compute_rotation(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_history *h = &r->history;
    const double *const acceleration[3] = {h->angular_acceleration_x, h->angular_acceleration_y,
                                           h->angular_acceleration_z},
                        *const velocity[3] = {h->angular_velocity_x, h->angular_velocity_y,
                                              h->angular_velocity_z};
    f->peak_resultant = f->injury.a_max_g;
    SF_TRY(find_peak(r, acceleration, first_contact(h) > h->time[0], f, &f->peak_angular_acceleration,
                     &f->peak_angular_acceleration_time, err));
    SF_TRY(find_peak(r, velocity, true, f, &f->peak_angular_velocity, &f->peak_angular_velocity_time, err));
    return compute_bric(r, f, err);
}

/* Rows around the raw peak, without a gap, above half of it. */
static int64_t count_peak_rows(const sf_series *raw) {
    int64_t peak = sf_series_peak(raw), first = peak, last = peak;
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
    f->vibration_energy_fraction = e.peak > 0 ? r->vibration / e.peak : NAN;
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
    double set = isfinite(r->set) ? r->set : 0; /* local strains count from it */
    f->local_strain_excess =
        f->max_local_strain -
        fmax(0, f->max_indentation - (r->air > 0 ? r->air : 0) - set) / (r->thickness - set);
    f->max_penetration = sf_history_largest(h, h->penetration);
    f->smallest_jacobian = h->smallest_jacobian[0];
    for (int64_t i = 1; i < h->rows; i++)
        f->smallest_jacobian = fmin(f->smallest_jacobian, h->smallest_jacobian[i]);
}

/* Computes figures of the fields at the peak, if the file has them; those of a failed run may be damaged. */
static sf_status compute_fields(const sf_results *r, sf_figures *f, sf_error *err) {
    sf_error problem = SF_ERROR_INIT;
    SF_OWNED_BY(sf_frame_free) sf_frame peak = {0};
    if (!r->has_peak) {
        f->layers = sf_layer_figures_compute(r, NULL, NULL, err);
        return err->status;
    }
    int fields = SF_FIELD_LARGEST_COMPRESSION | SF_FIELD_ENERGY_DENSITY | SF_FIELD_DISPLACEMENT |
                 SF_FIELD_CONTACT_PRESSURE;
    if (sf_frame_read(r, &r->peak, fields, &peak, &problem) != SF_OK)
        return sf_results_ended_well(r) ? SF_FAIL(err, problem.status, "%s", problem.text) : SF_OK;
    const double *compression = peak.field[SF_FRAME_LARGEST_COMPRESSION],
                 *energy = peak.field[SF_FRAME_ENERGY_DENSITY], *moved = peak.field[SF_FRAME_DISPLACEMENT];
    if (compression && energy && isfinite(r->informed_strain))
        f->energy_beyond_data = sf_strain_field_energy_beyond(r, compression, energy, r->informed_strain);
    f->layers = sf_layer_figures_compute(r, compression, energy, err);
    if (f->layers && compression && energy) {
        f->energy_beyond_data = 0;
        for (int k = 0; k < r->layer_count; k++)
            f->energy_beyond_data += f->layers[k].energy_share * f->layers[k].energy_beyond_data;
    }
    const sf_peak_fields at = {compression, moved, peak.field[SF_FRAME_CONTACT_PRESSURE], energy};
    if (compression)
        sf_strain_field_collapse(r, &at, &f->local_collapse, err);
    if (moved && err->status == SF_OK)
        sf_rim_cut_measure(r, &r->peak, moved, &f->cut, err);
    return err->status;
}

/* Raises *depth (m) to that of the deepest node of the frame below z = plane. */
static sf_status add_depth(const sf_results *r, const sf_frame_head *head, double plane, double *depth,
                           sf_error *err) {
    SF_OWNED_BY(sf_frame_free) sf_frame frame = {0};
    SF_TRY(sf_frame_read(r, head, SF_FIELD_DISPLACEMENT, &frame, err));
    const double *u = frame.field[SF_FRAME_DISPLACEMENT];
    for (int64_t i = 0; u && i < r->node_count; i++)
        *depth = fmax(*depth, plane - (r->position[3 * i + 2] + u[3 * i + 2]));
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
    for (int64_t k = 0; k < r->frame_count + r->has_peak && problem.status == SF_OK; k++)
        add_depth(r, k < r->frame_count ? &r->frames[k] : &r->peak, plane, &depth, &problem);
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
    for (const sf_figure *figure = sf_figure_at; figure < sf_figure_at + SF_FIGURE_TOTAL; figure++)
        if (!figure->fact && figure->row.type == SF_ROW_NUMBER)
            *(double *)((char *)f + figure->row.offset) = NAN;
}

/* Figures of every run, free or driven. */
static void take_facts(const sf_results *r, double cfc, sf_figures *f) {
    f->cfc = cfc;
    f->touched = isfinite(first_contact(&r->history));
    f->driven = r->driven;
    f->turns = r->turns;
    f->kinematic = r->kinematic;
    f->v0 = f->driven ? NAN : r->missile_speed;
    f->missile_mass = f->driven ? NAN : r->missile_mass;
    f->area = sf_results_cross_section(r);
    f->end_time = r->history.time[r->history.rows - 1];
    f->steps = r->has_summary ? r->steps : r->history.rows - 1;
}

/* ---- the edge ---- */

/* The edge on which a figure may stand: how a_max and HIC change with the speed, the pad's thickness and the
 * foam's stress, estimated from the run's own force over indentation (docs/theory.md, section 12).
 *
 * Near the turn F = C h^(p - n) d^n, with the thickness h, the indentation d, the contact area ~ d^p and the
 * energy E = F d / (n + 1), so that with e = (dF/dd) E / F^2 = n / (n + 1)
 *
 *     d ln a_max = 2 e d ln v,  (p - (1 + p) e) d ln h,  (1 - e) d ln C;
 *     d ln HIC = 1.5 d ln a_max, and d ln v in addition.
 *
 * A lock-up strain eps_D later by 0.005 shifts the locked part of the stress, from eps_s on, by that times
 * w = ((eps - eps_s) / (eps_D - eps_s))^2 (which is the law's own change for the exponent 1). With eps = d /
 * h the force loses h 0.005 (w F' - q int F' dw), where q is 0 below a flat missile; then d ln a_max = dF / F
 * - (dF/dd) dE / F^2 with the energy dE that the force no longer takes. The impulse of the locked part is
 * that of the speed with which it begins, so that only its duration changes, and HIC with it.
 *
 * The slope is that of the steepest of five secants before the turn, the first where the missile slows down
 * from a half to a quarter of its speed: later ones are bent by the rate of a smooth foam, but see a lock-up.
 * It lags behind the slope at the turn: e is 1.24 times that of the secant, calibrated to seven drops. While
 * a foam locks up the estimate is an upper one: up to three times the change beyond the lock-up, where the
 * force no longer grows as steeply (tests/test_edge.c).
 */

/* Secants of the force, by the speed where they begin and end over that at contact. */
static const double secants[][2] = {{0.5, 0.25}, {0.35, 0.2}, {0.25, 0.12}, {0.2, 0.08}, {0.15, 0.04}};
static const double LAG = 1.24; /* of e over that of the steepest */
static const double PERCENT = 0.01;
static const double LATER = 0.005; /* of the lock-up strain */
static const double SHARPER = 0.8; /* of the mean's change over the peak's, as the top grows sharper */
static const double ROUND = 0.5;   /* q over p: the middle of a pad is compressed more evenly than columns */

/* The first row from `first` on in which a column has risen (`sign` 1) or fallen (-1) to this value; -1:
 * none. */
static int64_t row_of(const sf_history *h, const double *column, double sign, int64_t first, double value) {
    for (int64_t i = first; i < h->rows; i++)
        if (sign * column[i] >= sign * value)
            return i;
    return -1;
}

/* The steepest secant: (dF/dd) / F, m-1; NaN: there is none. */
static double steepest(const sf_history *h, int64_t first) {
    double growth = NAN;
    for (size_t k = 0; k < sizeof secants / sizeof *secants; k++) {
        int64_t from = row_of(h, h->velocity, -1, first, secants[k][0] * h->velocity[first]),
                to = row_of(h, h->velocity, -1, first, secants[k][1] * h->velocity[first]);
        if (from < 0 || to <= from || !(h->contact_force[from] > 0) ||
            !(h->indentation[to] > h->indentation[from]))
            continue;
        growth = fmax(growth, log(h->contact_force[to] / h->contact_force[from]) /
                                  (h->indentation[to] - h->indentation[from]));
    }
    return growth;
}

/* Part of the peak's change that HIC has: by the duration of the force above that of row `from`, over the
 * window of HIC. */
static double share_of_hic(const sf_history *h, int64_t from, double largest, double window) {
    double begin = h->contact_force[from], duration = 0, impulse = 0;
    for (int64_t i = from + 1; i < h->rows && h->contact_force[i] > begin; i++) {
        duration += h->time[i] - h->time[i - 1];
        impulse += h->contact_force[i] * (h->time[i] - h->time[i - 1]);
    }
    double mean = impulse / duration;
    return duration > 0
               ? 1.5 * SHARPER * duration / window * (mean - begin) / (largest - begin) * largest / mean
               : 0;
}

/* The changes by a later lock-up: `slope` (m-1) is (dF/dd) / F at the turn, `q` as above. */
static void estimate_lock_up(const sf_results *r, int64_t first, int64_t deepest, double slope, double q,
                             sf_figures *f) {
    const sf_history *h = &r->history;
    double room = r->lock_up - r->lock_begin, shift = LATER * r->thickness, bend = 0, energy = 0, w = 0,
           largest = h->contact_force[sf_history_row_of_largest(h, h->contact_force)];
    int64_t begin = row_of(h, h->indentation, 1, first, r->lock_begin * r->thickness);
    f->a_max_by_lock_up = f->hic_by_lock_up = isfinite(room) ? 0 : NAN;
    if (begin < 0 || !(room > 0))
        return;
    for (int64_t i = begin + 1; i <= deepest; i++) {
        double x = fmin(1, (h->indentation[i] / r->thickness - r->lock_begin) / room),
               gain = fmax(0, h->contact_force[i] - h->contact_force[i - 1]);
        w = x * x;
        bend += x < 1 ? gain * 2 * x / (room * r->thickness) : 0; /* of the integral of F' dw */
        energy -= shift * (w * gain - q * bend * (h->indentation[i] - h->indentation[i - 1]));
    }
    f->a_max_by_lock_up = -shift * (w * slope - q * bend / largest) - slope * energy / largest;
    f->hic_by_lock_up =
        f->a_max_by_lock_up * share_of_hic(h, begin, largest, f->injury.hic.t2 - f->injury.hic.t1);
}

/* The run has rebounded. Sets nothing of a driven or free missile, or where the force tells nothing. */
static void estimate_edge(const sf_results *r, sf_figures *f) {
    const sf_history *h = &r->history;
    if (r->driven || r->turns)
        return;
    int64_t first = 0;
    while (first + 1 < h->rows && !(h->contact_nodes[first + 1] > 0))
        first++;
    int64_t deepest = sf_history_row_of_largest(h, h->indentation),
            half = row_of(h, h->indentation, 1, first, 0.5 * h->indentation[deepest]);
    double growth = steepest(h, first);
    if (half < 0 || isnan(growth) || !(h->contact_area[half] > 0))
        return;
    double force = h->contact_force[sf_history_row_of_largest(h, h->contact_force)],
           e = LAG * growth * h->energy_kinetic_missile[first] / force,
           p = fmin(1, fmax(0, log(h->contact_area[deepest] / h->contact_area[half]) / log(2)));
    f->a_max_by_speed = PERCENT * 2 * e;
    f->a_max_by_thickness = PERCENT * (p - (1 + p) * e);
    f->a_max_by_stress = PERCENT * (1 - e);
    f->hic_by_speed = 1.5 * f->a_max_by_speed + PERCENT;
    f->hic_by_thickness = 1.5 * f->a_max_by_thickness;
    f->hic_by_stress = 1.5 * f->a_max_by_stress;
    estimate_lock_up(r, first, deepest, LAG * growth, ROUND * p, f);
}

/* In place of the estimates, what drops of the section showed; 0 of one that failed. A drop on a pad 1 mm
 * thinner gives the secant of the thickness. */
static void take_edge(const sf_results *r, sf_figures *f) {
    const sf_section_drop *s = &r->section;
    double part = -PERCENT * r->thickness / SF_SECTION_DROP_THINNER;
    if (!(s->a_max_g > 0))
        return;
    if (s->a_max_by_speed != 0) {
        f->a_max_by_speed = s->a_max_by_speed;
        f->hic_by_speed = s->hic_by_speed;
    }
    if (s->a_max_by_thickness != 0) {
        f->a_max_by_thickness = part * s->a_max_by_thickness;
        f->hic_by_thickness = part * s->hic_by_thickness;
    }
}

static void estimate_scatter(const sf_results *r, sf_figures *f) {
    double speed = r->speed_scatter / PERCENT, thickness = r->thickness_tolerance / r->thickness / PERCENT;
    f->a_max_scatter = hypot(f->a_max_by_speed * speed, f->a_max_by_thickness * thickness);
    f->hic_scatter = hypot(f->hic_by_speed * speed, f->hic_by_thickness * thickness);
}

/* ---- the mesh ---- */

/* The distance from the value that the section's drops on finer meshes tend to, and the doubt of that. It has
 * filter class 1000, so that the drop's figures are compared with that, too. */
static sf_status compare_meshes(const sf_results *r, sf_figures *f, sf_error *err) {
    const sf_section_drop *s = &r->section;
    const sf_figures plain = {.cfc = 1000, .rate = f->rate};
    SF_OWNED_BY(sf_series_free) sf_series curve = {0};
    sf_injury own;
    f->a_max_mesh_error = r->expected_mesh_error;
    if (!(s->a_max_g > 0) || !f->rebounded)
        return SF_OK;
    SF_TRY(filter(r, &f->raw, f->free_flight, &plain, &curve, err));
    SF_TRY(sf_injury_evaluate(&curve, &own, err));
    f->a_max_mesh_error = fabs(s->a_max_g / own.a_max_g - 1) + s->a_max_error;
    f->hic_mesh_error = fabs(s->hic / own.hic.value - 1) + s->hic_error;
    f->indentation_mesh_error = fabs(s->indentation / f->max_indentation - 1) + s->indentation_error;
    return SF_OK;
}

/* ---- all figures ---- */

/* Names the acceleration that the curves show, and what it has passed. */
static void name_acceleration(sf_figures *f) {
    static const char *const names[2][2] = {
        {"acceleration as an accelerometer reads it", "kinematic deceleration"},
        {"resultant acceleration of the centre of mass as an accelerometer reads it",
         "resultant kinematic acceleration of the centre of mass"}};
    f->acceleration = names[f->turns][f->kinematic];
    if (f->chain.mount_frequency > 0)
        sf_text_add(f->passed, sizeof f->passed, ", on a mount of %.4g Hz (damping %.3g)",
                    f->chain.mount_frequency, f->chain.mount_damping);
    if (f->chain.coupling > 0)
        sf_text_add(f->passed, sizeof f->passed, ", with a coupling of %.4g s", f->chain.coupling);
}

sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *f, sf_error *err) {
    return sf_figures_compute_through(results, cfc, NULL, f, err);
}

/* The figures behind the curves. */
static sf_status compute(const sf_results *results, sf_figures *f, sf_error *err) {
    const sf_history *h = &results->history;
    SF_TRY(compute_curves(results, f, err));
    f->energy_error = sf_history_largest(h, h->energy_error);
    f->momentum_error = sf_history_largest(h, h->momentum_error);
    f->momentum_error_space = sf_history_largest(h, h->momentum_error_space);
    f->angular_momentum_error = sf_history_largest(h, h->angular_momentum_error);
    f->constraint_residual = sf_history_largest(h, h->constraint_residual);
    SF_TRY(compute_base_force(results, f, err));
    if (!f->touched)
        return SF_OK;
    compute_energies(results, f);
    compute_extremes(results, f);
    SF_TRY(compute_fields(results, f, err));
    SF_TRY(compute_below_anvil(results, f, err));
    if (f->driven) {
        compute_compression(results, f);
        return SF_OK;
    }
    SF_TRY(sf_injury_evaluate_peak(&f->raw, &f->injury_raw, err));
    SF_TRY(sf_injury_evaluate(&f->filtered, &f->injury, err));
    if (f->turns)
        SF_TRY(compute_rotation(results, f, err));
    f->raw_peak_rows = count_peak_rows(&f->raw);
    compute_rebound(results, f);
    if (f->rebounded) {
        estimate_edge(results, f);
        take_edge(results, f);
        estimate_scatter(results, f);
    }
    return compare_meshes(results, f, err);
}

sf_status sf_figures_compute_through(const sf_results *results, double cfc, const sf_signal_chain *chain,
                                     sf_figures *f, sf_error *err) {
    *f = (sf_figures){0};
    set_undefined(f);
    f->chain = chain ? *chain : (sf_signal_chain){0};
    take_facts(results, cfc, f);
    name_acceleration(f);
    if (compute(results, f, err) != SF_OK)
        sf_figures_free(f);
    return err->status;
}

void sf_figures_free(sf_figures *figures) {
    sf_series_free(&figures->raw);
    sf_series_free(&figures->filtered);
    SF_CLEAR(figures, figures->layers);
}

/* Orders over five spacings of the paper's drops are 1.1 to 1.9 (docs/verification.md, "Mesh study"). Two
 * meshes may agree by chance: a_max of a honeycomb differs by 0.5 % between meshes that seem to agree. */
static const double ORDER = 1.3, LEAST_ERROR = 0.005, MOST_CORRECTION = 0.1;

sf_status sf_figure_refine(double fine, double coarse, double ratio, double cells, double refined[2],
                           sf_error *err) {
    double correction = (fine - coarse) / (pow(ratio, ORDER) - 1);
    const char *cause = NULL;
    if (!isfinite(correction))
        cause = "no number";
    else if (!(cells > ratio * ratio))
        cause = "parts of the mesh are no coarser";
    else if (fabs(correction) > MOST_CORRECTION * fabs(fine))
        cause = "too far apart: take a finer mesh";
    refined[0] = refined[1] = NAN;
    if (cause)
        return SF_REFUSE(err, "%.4g, and %.4g with %g times the spacing: %s", fine, coarse, ratio, cause);
    refined[0] = fine + correction;
    refined[1] = fmax(fabs(correction), LEAST_ERROR * fabs(fine));
    return SF_OK;
}
