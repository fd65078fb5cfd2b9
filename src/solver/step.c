/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/step.h"

#include "base/mat3.h"
#include "solver/contact/contact.h"
#include "solver/contact/ledger.h"
#include "solver/field/domain_stress.h"
#include "solver/field/stabilisation.h"
#include "solver/set.h"
#include "solver/time_step.h"

/* Steps between measurements of |G v|, and between looks for foam that passed through something. */
enum { RESIDUAL_INTERVAL = 16, PASSAGE_INTERVAL = 16 };

/* Fails on a domain with det F <= 0, or with det F or a stable step that is NaN or infinite. */
static sf_status check_domains(const sf_model *m, const sf_state *s, sf_error *err) {
    for (int64_t k = 0; k < s->chunk_count; k++) {
        const sf_partial *p = &s->partial[k];
        if (p->jacobian > 0 && isfinite(p->step) && p->step > 0)
            continue;
        const double *x = &m->position[3 * p->jacobian_node];
        bool finite = isfinite(p->jacobian);
        return SF_FAIL(
            err, SF_ERR_NUMERIC,
            "at t = %.6g s (step %lld) the foam at node %lld, X = (%.5g, %.5g, %.5g) m, %s: det F "
            "= %.3g. %s",
            s->time, (long long)s->step, (long long)p->jacobian_node, x[0], x[1], x[2],
            finite ? "has collapsed" : "holds a NaN or infinity", p->jacobian,
            finite
                ? "The curve is too soft for this impact there: give it data to larger strains, or check its "
                  "densification (material.densification: a larger exponent, a limit below 1)"
                : "The step before was unstable; try a smaller solver.step_safety");
    }
    return SF_OK;
}

static sf_status check_step(const sf_model *m, const sf_state *s, sf_error *err) {
    double floor = SF_SMALLEST_STEP * m->run.end_time;
    if (s->dt >= floor)
        return SF_OK;
    const double *x = &m->position[3 * s->jacobian_node];
    return SF_FAIL(err, SF_ERR_NUMERIC,
                   "at t = %.6g s the stable time step fell to %.3g s, below %.3g s; most compressed is node "
                   "%lld at (%.5g, %.5g, %.5g) m, det F = %.3g. The foam has densified beyond what the curve "
                   "can carry",
                   s->time, s->dt, floor, (long long)s->jacobian_node, x[0], x[1], x[2],
                   s->smallest_jacobian);
}

/* The first node whose force or velocity holds a NaN or infinity; -1: none. */
static int64_t find_lost(const sf_model *m, const sf_state *s) {
    const double *const fields[] = {s->force, s->v}; /* reactions spread a NaN to v of every held node */
    for (int k = 0; k < 2; k++)
        for (int64_t i = 0; i < m->node_count; i++)
            if (!isfinite(fields[k][3 * i] + fields[k][3 * i + 1] + fields[k][3 * i + 2]))
                return i;
    return -1;
}

static sf_status check_finite(const sf_model *m, const sf_state *s, sf_error *err) {
    if (isfinite(s->ledger.error))
        return SF_OK;
    int64_t node = find_lost(m, s);
    if (node < 0)
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "at t = %.6g s (step %lld) the missile holds a NaN or infinity: acceleration %g m/s2, "
                       "displacement %g m. The contact was unstable; try a smaller solver.step_safety",
                       s->time, (long long)s->step, s->missile.acceleration, s->missile.displacement);
    const double *x = &m->position[3 * node], *f = &s->force[3 * node];
    return SF_FAIL(err, SF_ERR_NUMERIC,
                   "at t = %.6g s (step %lld) node %lld, X = (%.5g, %.5g, %.5g) m, holds a NaN or infinity: "
                   "its force is (%g, %g, %g) N. The step before was unstable; try a smaller "
                   "solver.step_safety",
                   s->time, (long long)s->step, (long long)node, x[0], x[1], x[2], f[0], f[1], f[2]);
}

static int64_t find_fastest(const sf_model *m, const sf_state *s, double *speed) {
    int64_t fastest = 0;
    double largest = -1;
    for (int64_t i = 0; i < m->node_count; i++) {
        const double *v = &s->v[3 * i];
        double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        if (square > largest) {
            largest = square;
            fastest = i;
        }
    }
    *speed = sqrt(largest);
    return fastest;
}

/* Returns what the foam at node i has passed through by more than its spacing, NULL: nothing. Of the anvil,
 * which holds the base alone, a fifth of the thickness counts, as in the verdict. `plane`: the places (m) of
 * symmetry planes and anvil, NAN: none. */
static const char *find_passed(const sf_model *m, const sf_state *s, const double plane[3], int64_t i) {
    static const double SHARE = 0.2;
    double x[3], least = m->spacing[i];
    const double *rest = &m->position[3 * i];
    for (int r = 0; r < 3; r++)
        x[r] = rest[r] + s->d[3 * i + r];
    if (x[2] < plane[2] - fmax(least, SHARE * m->thickness))
        return "the anvil";
    for (int axis = 0; axis < 2; axis++)
        if (fabs(x[axis] - plane[axis]) > least && (x[axis] - plane[axis]) * (rest[axis] - plane[axis]) < 0)
            return "a symmetry plane";
    return NULL;
}

/* Fails where foam has passed through the anvil or a symmetry plane; faces of the foam and supports:
 * contact/contact.h. */
static sf_status check_passed(const sf_model *m, const sf_state *s, sf_error *err) {
    double low[3], high[3], plane[3];
    sf_box3(m->node_count, m->position, low, high);
    for (int axis = 0; axis < 2; axis++)
        plane[axis] = sf_symmetry_plane(m, axis, &plane[axis]) ? plane[axis] : NAN;
    plane[2] = m->anvil.depth > 0 ? sf_model_anvil_plane(m, high[2]) : NAN;
    for (int64_t i = 0; i < m->node_count; i++) {
        const char *through = find_passed(m, s, plane, i);
        const double *x = &m->position[3 * i], *d = &s->d[3 * i];
        if (through)
            return SF_FAIL(err, SF_ERR_NUMERIC,
                           "at t = %.6g s the foam has passed through %s, at (%.4g, %.4g, %.4g) mm "
                           "(undeformed (%.4g, %.4g, %.4g) mm): pad.self_contact = \"on\" keeps it from them",
                           s->time, through, 1e3 * (x[0] + d[0]), 1e3 * (x[1] + d[1]), 1e3 * (x[2] + d[2]),
                           1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    }
    return SF_OK;
}

/* Height (m) of the missile's touching surface, along its direction of motion. */
static double find_surface_height(const sf_model *m) {
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < m->surface_node_count; i++) {
        double along = sf_dot3(&m->surface_position[3 * i], m->missile.direction);
        low = fmin(low, along);
        high = fmax(high, along);
    }
    return high - low;
}

/* Returns the likely cause of energy that appears in the pad: what the run itself shows first. */
static const char *find_cause(const sf_model *m, const sf_state *s) {
    static const double CRUSHED = 0.95;
    if (m->skin_count > 0 && !m->skin_alone && m->run.stabilisation < SF_FOLD_STABILISATION)
        return "foam that folds needs a larger kernel.stabilisation, such as 0.3";
    if (s->smallest_jacobian <= 0)
        return "the foam has turned inside out, as where it folds onto itself or passes through the anvil";
    if (s->largest_compression > CRUSHED)
        return "the foam is crushed beyond a strain of 0.95, as by a motion beyond the limit of its law, or where it "
               "passes through the anvil or through itself";
    if (!sf_missile_is_driven(m) && s->missile.displacement > find_surface_height(m))
        return "the missile is pressed in beyond its touching surface, which ends at its rim: give it a surface that is "
               "higher than its way into the pad";
    return "the run is unstable or the limit too strict; try a smaller solver.step_safety";
}

/* The energy limit is a stop, not a tolerance: beyond it the run has become unstable. */
static sf_status check_energy(const sf_model *m, const sf_state *s, sf_error *err) {
    double least = fmin(s->ledger.contact, s->ledger.stabilisation), speed;
    bool fed = least < -m->run.energy_limit * s->ledger.reference;
    if (!fed && fabs(s->ledger.error) <= m->run.energy_limit)
        return SF_OK;
    int64_t node = find_fastest(m, s, &speed);
    const double *x = &m->position[3 * node];
    if (fed)
        return SF_FAIL(
            err, SF_ERR_NUMERIC,
            "at t = %.6g s (step %lld) the %s has put %.3g J into the pad (limit %.2f %% of the %s); "
            "fastest is node %lld at (%.5g, %.5g, %.5g) m, %.3g m/s: %s",
            s->time, (long long)s->step,
            s->ledger.contact <= s->ledger.stabilisation ? "contact" : "stabilisation", -least,
            100 * m->run.energy_limit,
            sf_missile_is_driven(m) ? "largest work of the motion" : "impact energy", (long long)node, x[0],
            x[1], x[2], speed, find_cause(m, s));
    return SF_FAIL(err, SF_ERR_NUMERIC,
                   "at t = %.6g s (step %lld) the energy balance is off by %.2f %% (limit %.2f %%, time step "
                   "%.3g s); fastest is node %lld at (%.5g, %.5g, %.5g) m, %.3g m/s: %s",
                   s->time, (long long)s->step, 100 * s->ledger.error, 100 * m->run.energy_limit, s->dt,
                   (long long)node, x[0], x[1], x[2], speed, find_cause(m, s));
}

/* Angular momentum and moment of the reaction of node i about the origin. */
static void add_moments(const sf_model *m, const sf_state *s, int64_t i, double angular[3],
                        double moment[3]) {
    double x[3], of_v[3], of_reaction[3];
    for (int c = 0; c < 3; c++)
        x[c] = sf_model_coefficients(m)[3 * i + c] + s->d[3 * i + c];
    sf_cross3(x, &s->v[3 * i], of_v);
    sf_cross3(x, &s->reaction[3 * i], of_reaction);
    for (int c = 0; c < 3; c++) {
        angular[c] += m->mass[i] * of_v[c];
        moment[c] -= of_reaction[c];
    }
}

/* v += dt_v (force - reaction) / m, with the kinetic energy at the present time, and momentum, angular
 * momentum and largest speed after it. Nothing moves out of a section: no stiffness would hold a rounding
 * error along y, which a smooth missile lets grow. */
static void accelerate(const sf_model *m, sf_state *s, double dt_v) {
    const double free[3] = {1, m->axisymmetric ? 0 : 1, 1};
    const int64_t phase = sf_vibration_phase(s);
#pragma omp for schedule(static)
    for (int64_t chunk = 0; chunk < s->chunk_count; chunk++) {
        double vibration = 0, kinetic = 0, momentum[3] = {0}, angular[3] = {0}, moment[3] = {0}, fastest = 0;
        for (int64_t i = chunk * SF_CHUNK; i < (chunk + 1) * SF_CHUNK && i < m->node_count; i++) {
            double mass = m->mass[i], factor = dt_v / mass, square = 0;
            for (int c = 0; c < 3; c++) {
                double old = s->v[3 * i + c];
                double v = old + free[c] * factor * (s->force[3 * i + c] - s->reaction[3 * i + c]);
                s->v[3 * i + c] = v;
                if (phase == 0)
                    s->kick[3 * i + c] = v - old;
                if (phase == 1)
                    vibration += mass / 32 * pow(v - old - s->kick[3 * i + c], 2);
                kinetic += 0.5 * mass * old * v;
                momentum[c] += mass * v;
                square += v * v;
            }
            fastest = sf_larger(square, fastest);
            add_moments(m, s, i, angular, moment);
        }
        s->partial[chunk].kinetic = kinetic;
        s->partial[chunk].vibration = vibration;
        s->partial[chunk].fastest = fastest;
        memcpy(s->partial[chunk].momentum, momentum, sizeof momentum);
        memcpy(s->partial[chunk].angular, angular, sizeof angular);
        memcpy(s->partial[chunk].moment, moment, sizeof moment);
    }
}

/* Force and moment of all constraints on the pad; after accelerate. */
static sf_wrench wrench_of_constraints(const sf_state *s, const sf_constraint_step *held) {
    sf_wrench w = {{0}, {0}};
    memcpy(w.force, held->all, sizeof w.force);
    for (int64_t k = 0; k < s->chunk_count; k++)
        for (int c = 0; c < 3; c++)
            w.moment[c] += s->partial[k].moment[c];
    return w;
}

/* Forces inside the pad. */
static void evaluate_pad(const sf_model *m, const sf_operators *op, sf_state *s) {
    sf_domain_stress(m, op, s); /* F, P, history */
#pragma omp master
    sf_lap(s->watch, SF_PHASE_STRESS);
    sf_stabilisation(m, op, s); /* pair forces, couples */
#pragma omp master
    sf_lap(s->watch, SF_PHASE_STABILISATION);
    sf_internal_force(m, op, s); /* f = pair forces - sum V P B */
#pragma omp master
    sf_lap(s->watch, SF_PHASE_FORCE);
}

sf_status sf_step_evaluate(const sf_model *m, const sf_operators *op, sf_state *s, sf_error *err) {
    SF_BY_ALL_THREADS(true, evaluate_pad(m, op, s));
    SF_TRY(check_domains(m, s, err));
    sf_membrane_force(m, &op->membrane, s->d, &s->membrane, s->force); /* f += phi^T f of the membrane */
    sf_time_step_choose(m, op, s);
    sf_lap(s->watch, SF_PHASE_TIME_STEP);
    double dt_v = 0.5 * (s->dt_old + s->dt);

    SF_TRY(sf_contact_solve(m, op, s, err)); /* f += phi^T q; missile's acceleration */
    sf_lap(s->watch, SF_PHASE_CONTACT);
    sf_constraint_step held = {.force = s->force, .v = s->v, .dt = dt_v, .reaction = s->reaction};
    sf_constraint_project(&op->constraint, &held);
    sf_ledger_supports(m, s, held.base);
    if (s->step % RESIDUAL_INTERVAL == 0)
        s->constraint_residual = sf_constraint_residual(m, &op->constraint, &held);
    sf_lap(s->watch, SF_PHASE_CONSTRAINT);

    SF_BY_ALL_THREADS(m->node_count > SF_FEW_NODES, accelerate(m, s, dt_v)); /* v at the next half step */
    sf_missile_kick(m, &s->missile, s->time, s->dt, s->dt_old);
    s->ledger.weight = sf_weight_work(&op->weight, s->d);
    sf_wrench outside = wrench_of_constraints(s, &held);
    sf_ledger_outside(m, &op->weight, s, &outside);
    sf_ledger_close(m, s, &outside, dt_v);
    sf_set_watch(m, s);
    sf_lap(s->watch, SF_PHASE_MOTION);
    if (check_finite(m, s, err) != SF_OK || check_step(m, s, err) != SF_OK)
        return err->status;
    if (s->step % PASSAGE_INTERVAL == 0)
        SF_TRY(check_passed(m, s, err));
    return check_energy(m, s, err);
}

static void move_nodes(const sf_model *m, sf_state *s, double dt) {
#pragma omp for schedule(static)
    for (int64_t k = 0; k < 3 * m->node_count; k++)
        s->d[k] += dt * s->v[k];
}

void sf_step_advance(const sf_model *m, sf_state *s) {
    double dt = s->dt;
    SF_BY_ALL_THREADS(m->node_count > SF_FEW_NODES, move_nodes(m, s, dt));
    s->time += dt;
    sf_missile_drift(m, &s->missile, s->time, dt);
    s->dt_old = dt;
    s->step++;
    sf_lap(s->watch, SF_PHASE_MOTION);
}
