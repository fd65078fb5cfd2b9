/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/state.h"

#include "base/hash.h"
#include "base/mat3.h"
#include "material/laws.h"
#include "model/flight.h"
#include "model/motion.h"
#include "solver/field/pairs.h"

static const double LEAST_WORK = 0.01; /* of the evenly compressed pad's energy, see start_driven */

/* One list of the arrays: allocation, release and checkpoints. */
static const sf_state_array arrays[] = {
#define KEPT(member, rows, columns)                                                                          \
    { #member, offsetof(sf_state, member), rows, (columns) * (int)sizeof(double), SF_H5_F64 }
#define KEPT_NUMBERS(member, rows, columns)                                                                  \
    { #member, offsetof(sf_state, member), rows, (columns) * (int)sizeof(int32_t), SF_H5_I32 }
#define SCRATCH(member, rows, bytes)                                                                         \
    { NULL, offsetof(sf_state, member), rows, (int)(bytes), SF_H5_F64 }
    KEPT(d, 'n', 3),
    KEPT(v, 'n', 3),
    KEPT(force, 'n', 3),
    KEPT(reaction, 'n', 3),
    KEPT(kick, 'n', 3),
    KEPT(f, 'n', 9),
    KEPT(stress, 'n', 9),
    KEPT(history, 'h', SF_LANES),
    KEPT(stiffness, 'n', 1),
    KEPT(tangent, 'n', 1),
    KEPT(pair_energy, 'n', 1),
    KEPT(pair_offset, 'p', 3),
    KEPT_NUMBERS(group_has_offsets, 'g', 1),
    KEPT(pair_stiffness, 'n', 1),
    KEPT(pair_work, 'n', 1),
    KEPT(viscous_work, 'n', 1),
    KEPT(compressed, 'l', 1),
    KEPT(lost_before, 'l', 1),
    KEPT(set, 'u', 4),
    KEPT(set_peak, 'u', 3),
    KEPT(mode, 'n', 1),
    SCRATCH(directional, 'n', 6 * sizeof(float)),
    KEPT(contact.position, 'c', 3),
    KEPT(contact.force, 'c', 3),
    KEPT(contact.normal, 'c', 3),
    KEPT(contact_rubbed, 'c', 1),
    KEPT(contact.load, 'w', 3),
    KEPT_NUMBERS(contact.sharp.key, 'q', 2),
    KEPT(contact.sharp.force, 'q', 3),
    SCRATCH(contact.motion, 'c', 3 * sizeof(double)),
    SCRATCH(contact.step, 'c', 3 * sizeof(double)),
    SCRATCH(contact.close, 'c', sizeof(int32_t)),
    SCRATCH(contact.near, 'c', sizeof(int32_t)),
    KEPT(skin.force, 's', 3),
    KEPT_NUMBERS(skin.partner, 's', 1),
    KEPT(skin.weight, 's', 4),
    KEPT_NUMBERS(skin.sharp.key, 'r', 2),
    KEPT(skin.sharp.force, 'r', 3),
    SCRATCH(skin.position, 's', 3 * sizeof(double)),
    SCRATCH(skin.motion, 's', 3 * sizeof(double)),
    SCRATCH(skin.step, 's', 3 * sizeof(double)),
    SCRATCH(skin.candidate, 's', SF_SELF_CANDIDATES * sizeof(int32_t)),
    SCRATCH(skin.side, 'f', 3 * sizeof(double)),
    SCRATCH(skin.close, 's', sizeof(int32_t)),
    SCRATCH(skin.near, 's', sizeof(int32_t)),
    SCRATCH(membrane.position, 'm', 3 * sizeof(double)),
    SCRATCH(membrane.force, 'm', 3 * sizeof(double)),
    SCRATCH(membrane.row, 't', SF_MEMBRANE_ROW * sizeof(double)),
    SCRATCH(contact_push, 'n', 3 * sizeof(double)),
    SCRATCH(partial, 'k', sizeof(sf_partial)),
#undef KEPT
#undef KEPT_NUMBERS
#undef SCRATCH
};

const sf_state_array *sf_state_arrays(size_t *count) {
    *count = sizeof arrays / sizeof arrays[0];
    return arrays;
}

/* Rows of history of a block, whatever its material. */
static int history_rows(const sf_model *model) {
    int most = 0;
    for (int64_t k = 0; k < model->material_count; k++) {
        int rows = sf_material_history_rows(&model->material[k]);
        most = rows > most ? rows : most;
    }
    return most;
}

int64_t sf_state_rows(const sf_model *model, char rows) {
    int64_t blocks = (model->node_count + SF_LANES - 1) / SF_LANES;
    switch (rows) {
    case 'n':
        return model->node_count;
    case 'l':
        return model->material_count > 1 ? model->node_count : 0;
    case 'u':
        return sf_model_set(model) > 0 ? model->node_count : 0;
    case 's': /* at most all of them */
        return model->skin_count > 0
                   ? model->node_count + model->support_node_count + sf_model_skin_centroids(model)
                   : 0;
    case 'f': /* at most one at each corner beside the points' own */
        return sf_state_rows(model, 's') + 3 * model->skin_count;
    case 'm': /* at most all of them */
        return model->membrane_count > 0 ? model->node_count : 0;
    case 't':
        return model->membrane_count;
    case 'p':
        return sf_pairs_count(model);
    case 'g':
        return (model->node_count + SF_GROUP - 1) / SF_GROUP;
    case 'h':
        return blocks * history_rows(model);
    case 'c':
        return sf_model_points(model);
    case 'w':
        return model->contact_face_count > 0 ? sf_model_points(model) : 0;
    case 'q': /* at most, if all corners are sharp */
        return model->contact_face_count > 0
                   ? model->surface_node_count + 3 * model->contact_face_count + SF_SHARP_MORE
                   : 0;
    case 'r':
        return model->support_triangle_count > 0
                   ? model->support_node_count + 3 * model->skin_count + SF_SHARP_MORE
                   : 0;
    default:
        return (model->node_count + SF_CHUNK - 1) / SF_CHUNK;
    }
}

static void start_free(const sf_model *m, sf_state *s) {
    double mass = sf_missile_mass(m);
    s->ledger.reference = sf_missile_kinetic(m, &s->missile, 0) + sf_flight_energy(&m->missile, mass);
    s->ledger.momentum_reference =
        sf_missile_momentum(m, &s->missile) + sf_flight_momentum(&m->missile, mass);
    sf_missile_momenta(m, &s->missile, s->ledger.impulse_linear, s->ledger.impulse_angular);
}

/* A driven missile brings no energy. Until it has done more work, its errors refer to the pad at the motion's
 * top speed, and to a part of the energy of a pad that is compressed evenly as far as the motion goes. */
static sf_status start_driven(const sf_model *m, sf_state *s, sf_error *err) {
    const sf_motion_range motion = sf_motion_measure(m);
    double mass = 0, work = 0, depth = fmax(0, sf_missile_card_depth(&m->missile, motion.displacement));
    for (int64_t i = 0; i < m->node_count; i++)
        mass += m->mass[i];
    for (int64_t k = 0; k < m->material_count; k++) {
        double part = 0;
        SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
        SF_TRY(sf_material_law_build(&m->material[k], &law, err));
        for (int64_t i = 0; i < m->node_count; i++)
            part += m->node_material[i] == k ? m->mass[i] : 0;
        work += LEAST_WORK * law.law->energy(law.numbers, depth / m->thickness) * part /
                sf_material_density(&m->material[k]);
    }
    s->ledger.reference = 0.5 * mass * motion.speed * motion.speed + work;
    s->ledger.momentum_reference = mass * motion.speed;
    return SF_OK;
}

sf_status sf_state_create(const sf_model *model, sf_state *s, sf_error *err) {
    memset(s, 0, sizeof *s);
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; k++)
        *(void **)((char *)s + arrays[k].offset) =
            sf_alloc(err, (unsigned long)sf_state_rows(model, arrays[k].rows), (unsigned long)arrays[k].bytes,
                     "state");
    if (err->status != SF_OK) {
        sf_state_free(s);
        return err->status;
    }
    s->chunk_count = sf_state_rows(model, 'k');
    s->history_rows = history_rows(model);
    for (int64_t i = 0; i < model->node_count; i++) {
        s->f[9 * i] = s->f[9 * i + 4] = s->f[9 * i + 8] = 1;
        s->pair_stiffness[i] = sf_material_rest_modulus(sf_model_material(model, i));
    }
    for (int64_t p = sf_state_rows(model, 's') - 1; p >= 0; p--)
        s->skin.partner[p] = SF_NO_PARTNER;
    for (int64_t c = 0; c < sf_model_points(model); c++)
        memcpy(&s->contact.position[3 * c], &model->position[3 * sf_model_point_node(model, c)],
               3 * sizeof(double));
    for (int64_t k = 0; k < model->rest_count; k++) /* settled */
        s->contact.force[3 * (model->contact_count + k) + 2] = model->rest_load[k];
    for (int64_t k = 0; k < 3 * sf_state_rows(model, 'w'); k++)
        s->contact.load[k] = s->contact.force[k];
    if (model->set)
        memcpy(s->set, model->set, 4 * (size_t)model->node_count * sizeof *s->set);
    s->tightness = 1;
    s->drop = 1;
    sf_missile_begin(model, &s->missile);
    if (!sf_missile_is_driven(model))
        start_free(model, s);
    else if (start_driven(model, s, err) != SF_OK)
        sf_state_free(s);
    return err->status;
}

int64_t sf_state_pad(const sf_model *model, double time, const double *history) {
    size_t bytes = (size_t)sf_state_rows(model, 'h') * SF_LANES * sizeof *history;
    uint64_t hash = sf_hash_identity(sf_hash_identity(SF_HASH_START, &time, sizeof time), history, bytes);
    return (int64_t)(hash >> 1); /* positive: HDF5 has it as a signed number */
}

static bool all_finite(const double *value, int64_t count) {
    bool finite = true;
    for (int64_t i = 0; i < count; i++)
        finite &= isfinite(value[i] * value[i]) != 0;
    return finite;
}

bool sf_state_is_finite(const sf_model *m, const sf_state *s) {
    return all_finite(s->d, 3 * m->node_count) && all_finite(s->v, 3 * m->node_count) &&
           all_finite(s->force, 3 * m->node_count) && all_finite(s->stress, 9 * m->node_count) &&
           all_finite(&s->missile.displacement, 1) && all_finite(s->missile.force, 3) &&
           all_finite(s->missile.spin, 3) && all_finite(s->missile.quaternion, 4);
}

static void release_work(sf_contact_work *of) {
    sf_workspace *work = (sf_workspace *)of;
    for (size_t k = 0; k < sizeof *of / sizeof *work; k++)
        sf_workspace_free(&work[k]);
}

void sf_state_free(sf_state *s) {
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; k++)
        free(*(void **)((char *)s + arrays[k].offset));
    release_work(&s->contact.work);
    release_work(&s->skin.work);
    memset(s, 0, sizeof *s);
}

/* ---- the ledger ---- */

double sf_ledger_internal(const sf_ledger *l) {
    return l->stored + l->hysteresis + l->viscous + l->stabilisation;
}

static double total_energy(const sf_ledger *l) {
    return l->kinetic_missile + l->kinetic_pad + sf_ledger_internal(l) + l->contact + l->friction;
}

/* Pad and missile along its direction, against gravity, constraints and anvil. `held` (N): the outside
 * force on the pad along the direction; `carried` (kg m s-1): the pad's momentum along it. */
static void balance_free(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    l->kinetic_missile = sf_missile_kinetic(m, &s->missile, dt_v);
    l->external = sf_missile_gravity_work(m, &s->missile);
    const sf_missile_card *card = &m->missile;
    double gain = sf_flight_energy(card, sf_missile_mass(m)),
           before = sf_flight_momentum(card, sf_missile_mass(m));
    l->error = (total_energy(l) - l->external - l->weight + gain) / l->reference - 1;

    l->impulse += dt_v * (sf_missile_weight(m) + held);
    double change = sf_missile_momentum(m, &s->missile) + carried - (l->momentum_reference - before);
    l->momentum_error = (change - l->impulse) / l->momentum_reference;
}

/* The pad alone, which starts at rest, against the missile and the constraints. There is no initial value, so
 * that the errors refer to the largest work and impulse so far, and at first to what state.c has set. */
static void balance_driven(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    double pressed = dt_v * sf_missile_contact_force(m, &s->missile);
    l->reference = fmax(l->reference, fabs(l->external));
    l->error = (total_energy(l) - l->external - l->weight) / l->reference;

    l->impulse += pressed + dt_v * held;
    l->momentum_reference += fabs(pressed);
    l->momentum_error = (carried - l->impulse) / l->momentum_reference;
}

void sf_wrench_add(sf_wrench *w, const double x[3], const double force[3]) {
    double moment[3];
    sf_cross3(x, force, moment);
    for (int r = 0; r < 3; r++) {
        w->force[r] += force[r];
        w->moment[r] += moment[r];
    }
}

/* |now - (at t = 0 + impulses)| of momentum or angular momentum. */
static double imbalance(double impulse[3], const double outside[3], const double of_missile[3], double dt_v,
                        const double pad[3], const double missile[3]) {
    double rest[3];
    for (int r = 0; r < 3; r++) {
        impulse[r] += dt_v * (outside[r] + of_missile[r]);
        rest[r] = pad[r] + missile[r] - impulse[r];
    }
    return sqrt(sf_dot3(rest, rest));
}

static void balance_in_space(const sf_model *m, sf_state *s, const sf_wrench *outside, double dt_v,
                             const double momentum[3], const double angular[3]) {
    sf_ledger *l = &s->ledger;
    double linear_part[3], angular_part[3], force[3], moment[3];
    sf_missile_momenta(m, &s->missile, linear_part, angular_part);
    sf_missile_outside(m, &s->missile, force, moment);
    if (m->axisymmetric) { /* rings balance along the axis; the rest is 0 by symmetry */
        const double pad[3] = {0, 0, momentum[2]}, own[3] = {0, 0, linear_part[2]},
                     of_missile[3] = {0, 0, force[2]}, held[3] = {0, 0, outside->force[2]};
        l->impulse_linear[0] = l->impulse_linear[1] = l->angular_error = 0;
        l->vector_error =
            imbalance(l->impulse_linear, held, of_missile, dt_v, pad, own) / fabs(l->momentum_reference);
        return;
    }
    double scale = fabs(l->momentum_reference);
    l->vector_error =
        imbalance(l->impulse_linear, outside->force, force, dt_v, momentum, linear_part) / scale;
    l->angular_error = imbalance(l->impulse_angular, outside->moment, moment, dt_v, angular, angular_part) /
                       (scale * m->thickness);
}

void sf_ledger_close(const sf_model *m, sf_state *s, const sf_wrench *outside, double dt_v) {
    sf_ledger *l = &s->ledger;
    double back = s->rubbed_back, momentum[3] = {0}, angular[3] = {0}, fastest = 0;
    s->smallest_jacobian = INFINITY;
    double shortest = INFINITY, vibration = 0;
    l->stored = s->membrane.energy;
    l->kinetic_pad = 0;
    l->hysteresis = -l->before;
    for (int64_t k = 0; k < s->chunk_count; k++) {
        const sf_partial *p = &s->partial[k];
        l->stored += p->stored;
        l->hysteresis += p->hysteresis;
        l->viscous += p->viscous;
        l->kinetic_pad += p->kinetic;
        l->stabilisation += p->stabilisation;
        back += p->given_back;
        vibration += p->vibration;
        shortest = fmin(shortest, p->shortest);
        fastest = fmax(fastest, p->fastest);
        if (p->jacobian < s->smallest_jacobian) {
            s->smallest_jacobian = p->jacobian;
            s->jacobian_node = p->jacobian_node;
        }
        for (int c = 0; c < 3; c++) {
            momentum[c] += p->momentum[c];
            angular[c] += p->angular[c];
        }
    }
    s->largest_compression = 1 - shortest;
    s->fastest = sqrt(fastest);
    s->given_back = fmax(s->given_back, back);
    if (sf_vibration_phase(s) == 1) {
        s->vibration = fmax(s->vibration, fmin(s->vibration_now, vibration));
        s->vibration_now = vibration;
    }

    double held = sf_missile_along(m, outside->force), carried = sf_missile_along(m, momentum);
    if (sf_missile_is_driven(m))
        balance_driven(m, s, held, carried, dt_v);
    else
        balance_free(m, s, held, carried, dt_v);
    balance_in_space(m, s, outside, dt_v, momentum, angular);
    l->largest_error = fmax(l->largest_error, fabs(l->error));
}
