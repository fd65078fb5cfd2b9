/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/workspace.h"
#include "io/process.h"
#include "solver/field/membrane.h"
#include "solver/missile.h"

/* Wall time of the phases of a step, for the benchmark. */

typedef enum sf_phase {
    SF_PHASE_STRESS,        /* F, foam law */
    SF_PHASE_STABILISATION, /* pairs */
    SF_PHASE_FORCE,         /* internal forces */
    SF_PHASE_TIME_STEP,     /* bound and Lanczos products */
    SF_PHASE_CONTACT,
    SF_PHASE_CONSTRAINT,
    SF_PHASE_MOTION, /* accelerations, ledger, checks, displacements */
    SF_PHASES
} sf_phase;

typedef struct sf_stopwatch {
    double mark;               /* s, end of the last phase */
    double seconds[SF_PHASES]; /* of the present step */
} sf_stopwatch;

/* Adds the time since the last call to `phase`. Does nothing without a watch. */
static inline void sf_lap(sf_stopwatch *watch, sf_phase phase) {
    if (!watch)
        return;
    double now = sf_process_now();
    watch->seconds[phase] += now - watch->mark;
    watch->mark = now;
}

/* sf_state: everything that changes while a drop is solved. Allocated once; a step allocates nothing. The
 * modelled part only: a quarter model holds a quarter of the pad, and forces and energies of that quarter,
 * unless said otherwise. */

enum { SF_CHUNK = 64 }; /* nodes per partial sum: fixes the order of every sum, whatever the threads */

/* Partial results of a chunk of nodes. */
typedef struct sf_partial {
    double stored, hysteresis, viscous; /* J; viscous: of this step */
    double kinetic;                     /* J, 1/2 m v(n-1/2) . v(n+1/2) */
    double momentum[3];                 /* kg m s-1 */
    double angular[3];                  /* kg m2 s-1, angular momentum about the origin */
    double moment[3];                   /* N m, of the constraint reactions about the origin */
    double fastest;                     /* m2 s-2, largest v . v */
    double vibration;     /* J, energy of motion that alternates from step to step, where it is measured */
    double stabilisation; /* J, of this step */
    double given_back;    /* J, by the viscosity or the stabilisation of single nodes, to date */
    double step;          /* s, smallest stable step */
    double jacobian;      /* -, smallest */
    double shortest;      /* -, smallest principal stretch */
    double load;          /* s-2, largest c (a + 2 eta / dt) */
    int64_t jacobian_node;
} sf_partial;

/* The numbers of the state that a checkpoint keeps: X(type, name, array size, units, meaning). Each list
 * declares the members of a struct; the checkpoint writes and reads them by the list (run/checkpoint.c). To
 * add a number: a line here. */
/* clang-format off */

/* Energies at the current time and the momentum balance, of the modelled part. */
#define SF_LEDGER_NUMBERS(X)                                                                                           \
    X(double, kinetic_missile, , "J", "kinetic energy of the missile")                                                 \
    X(double, kinetic_pad, , "J", "kinetic energy of the pad")                                                         \
    X(double, stored, , "J", "recoverable energy of the foam")                                                         \
    X(double, hysteresis, , "J", "lost by the unloading rule")                                                         \
    X(double, before, , "J", "lost by the unloading rule in earlier drops on this pad: not in `hysteresis`")           \
    X(double, viscous, , "J", "viscous work")                                                                          \
    X(double, stabilisation, , "J", "work of the stabilisation")                                                       \
    X(double, contact, , "J", "lost in normal contact")                                                                \
    X(double, friction, , "J", "lost in friction")                                                                     \
    X(double, external, , "J", "work of gravity on the missile, or of its prescribed motion")                           \
    X(double, weight, , "J", "work of gravity on a resting pad")                                                       \
    X(double, anvil, , "J", "part of `contact` and `friction` that is lost at the anvil")                              \
    X(double, reference, , "J", "to which errors refer: total at first contact; see below")                                 \
    X(double, error, , "1", "of the balance, over `reference`")                                                        \
    X(double, largest_error, , "1", "largest |error| so far")                                                          \
    X(double, momentum_reference, , "kg m s-1", "along the missile's direction, to which the momentum error refers")   \
    X(double, impulse, , "N s", "of gravity and constraints, and of a driven missile, along it")                       \
    X(double, momentum_error, , "1", "over momentum_reference")                                                        \
    X(double, impulse_linear, [3], "N s", "of all that is outside, in space, with the momentum at t = 0")              \
    X(double, impulse_angular, [3], "N m s", "likewise of moments about the origin")                                   \
    X(double, vector_error, , "1", "of the momentum in space, over momentum_reference")                                \
    X(double, angular_error, , "1", "of the angular momentum, over momentum_reference x thickness")

/* All others. */
#define SF_STATE_NUMBERS(X)                                                                                            \
    X(int64_t, drop, , "1", "number of the drop on this pad, from 1")                                                  \
    X(double, pause, , "s", "rest of the pad before it; 0: it is new")                                                 \
    X(int64_t, pad_before, , "1", "sf_state_pad at the end of the drop before; 0: it is new")                          \
    X(double, deepest, , "m", "largest indentation so far, that of `set_peak`")                                        \
    X(int64_t, step, , "1", "number of the step")                                                                      \
    X(double, time, , "s", "now")                                                                                      \
    X(double, dt, , "s", "from time to the next")                                                                      \
    X(double, dt_old, , "s", "from the previous time")                                                                 \
    X(double, tightness, , "1", "highest frequency squared over its bound, from the power iteration")                  \
    X(int64_t, contact_count, , "1", "points with a force of the missile")                                             \
    X(int64_t, anvil_count, , "1", "points with a force of the anvil")                                                 \
    X(double, ahead, [3], "J", "work of sharp edges over the next step: lost in contact, in friction, done by a driven missile") \
    X(double, penetration, , "m", "deepest now")                                                                       \
    X(double, rubbed_back, , "J", "given back by the friction of single points, to date")                              \
    X(double, vibration, , "J", "largest energy so far of motion that alternates from step to step, in two measurements together") \
    X(double, vibration_now, , "J", "that of the last measurement")                                                    \
    X(double, given_back, , "J", "largest sum so far of what dissipation of single nodes has given back")             \
    X(int64_t, contact_unsettled, , "1", "steps whose sweeps did not reach their tolerance")                           \
    X(double, base_reaction, [3], "N", "of the base on the pad")                                                       \
    X(double, support_force, [SF_SUPPORTS], "N", "resultant of each support on the pad")                               \
    X(double, constraint_residual, , "m s-1", "largest |G v|, when last measured")                                     \
    X(double, largest_compression, , "1", "1 - smallest principal stretch of all domains")                             \
    X(double, smallest_jacobian, , "1", "smallest det F of all domains")                                               \
    X(int64_t, jacobian_node, , "1", "where it is")                                                                    \
    X(double, bound_step, , "s", "guaranteed by the partition bound now")                                              \
    X(double, bound_load, , "s-2", "the bound on omega^2 it came from")                                                \
    X(int64_t, measured_at, , "1", "step of the last power iteration")                                                 \
    X(double, measured_load, , "s-2", "bound_load then")                                                               \
    X(double, ceiling, , "s", "smallest bound_step since")                                                             \
    X(int64_t, power_iterations, , "1", "products spent so far")
/* clang-format on */

typedef struct sf_ledger {
    SF_LEDGER_NUMBERS(SF_DECLARE)
} sf_ledger;

/* Force (N) and moment (N m, about the origin) on the pad. */
typedef struct sf_wrench {
    double force[3], moment[3];
} sf_wrench;

enum { SF_SELF_CANDIDATES = 48 };

/* Sharp edges of missile or supports on the faces of the pad (contact/sharp.h). */
typedef struct sf_sharp_candidate {
    int32_t part; /* corner of the body, or corners + edge */
    int32_t slot; /* 3 x face + place of the point that the pad's line runs from; of a corner 3 x face */
} sf_sharp_candidate;

enum { SF_SHARP_MORE = 64 }; /* pairs of a step beyond one for each corner of the body and line of the pad */
typedef struct sf_sharp_state {
    int32_t *key;  /* [pairs][2] part and 1 + slot of the last step's pairs, as listed; 0 behind the last */
    double *force; /* [pairs][3] N, on the pad */
    int64_t count; /* of candidates */
} sf_sharp_state;

/* Memory of a solve, taken in the first step and used again in each. */
typedef struct sf_contact_work {
    sf_workspace pair, edge_force, old_key, old_force;                /* pairs */
    sf_workspace centre, radius, found, used, list;           /* candidates */
    sf_workspace grid_start[2], grid_node[2];                         /* of pad and supports */
} sf_contact_work;

/* The points of a solve of contact (contact/skin.h): those of missile and anvil, sf_model_points of the model, or
 * those of the skin, which only a pad that may touch itself or a support has. */
typedef struct sf_contact_points {
    double *position;   /* [points][3] m, physical, now; of those in `near`, as the next two */
    double *motion;     /* [points][3] m, its last step */
    double *step;       /* [points][3] m, its next step without these forces */
    double *force;      /* [points][3] N, on the point, of the last step */
    int32_t *close;     /* [points] those that may touch before `room` is used up, and the nodes of their facets */
    int32_t *near;      /* [points] these, and the nodes of all facets at them */
    int64_t close_count, near_count;
    double room;  /* m, approach of points and bodies until the lists are made anew */
    double depth; /* m, deepest now */
    /* Contact points alone. */
    double *normal; /* [points][3] outward from the missile or the anvil */
    double *load;   /* [points][3] N, by the point itself and by sharp edges; only if there may be some */
    /* The skin alone. */
    double travel;      /* m, largest motion of a point near in the next step without these forces */
    double *side;       /* [sides][3] outward normal now, unit; of the points in `close` */
    int32_t *partner;   /* [points] what it touches (contact/shape.h) */
    double *weight;     /* [points][4] of the facet's nodes, and of the fourth of its quadrangle */
    int32_t *candidate; /* [points][SF_SELF_CANDIDATES] facets near the node, -1 behind the last */
    sf_sharp_state sharp;
    sf_contact_work work;
} sf_contact_points;

typedef struct sf_state {
    SF_STATE_NUMBERS(SF_DECLARE)
    sf_missile missile;
    sf_ledger ledger;

    /* Nodes: coefficients of the approximation, not nodal values. */
    double *d;        /* [n][3] m */
    double *v;        /* [n][3] m s-1, at the half step */
    double *force;    /* [n][3] N, all but constraint reactions */
    double *kick;     /* [n][3] m s-1, change of v in the last step that began a measurement of vibration */
    double *reaction; /* [n][3] N, constraint reactions (G^T lambda) of the last step */

    /* Smoothing domains. */
    double *f;       /* [n][9] F */
    double *stress;  /* [n][9] J, V P plus the stabilisation's couple; of a section P_theta theta in the place
                        of P_xy, to which B's second column belongs, and 0 in its own */
    double *history; /* [blocks][history_rows][SF_LANES] SI, history variables declared by the laws that the
                        cards need (material/laws.h) */
    int64_t history_rows;
    double *stiffness; /* [n] Pa */
    double *tangent;   /* [n] Pa, effective: a + 2 eta / dt of the last step */

    double *viscous_work; /* [n] J, to date */

    /* Stabilisation: half the energy of a node's pairs, the stiffness it was last used with, and the work of
     * the node's share to date; offsets of the pairs' arms. */
    double *pair_energy;        /* [n] J */
    double *pair_stiffness;     /* [n] Pa */
    double *pair_work;          /* [n] J */
    double *pair_offset;        /* [pairs][3] m, of the inner pairs, then of the outer ones */
    int32_t *group_has_offsets; /* [groups] 0: the pairs of the group have none */

    double *compressed; /* [n] -, largest compression to date; only a pad of layers has it */

    double *lost_before; /* [n] J m-3, by the unloading rule in earlier drops; likewise */

    double *set;      /* [n][4], as in the model; only foam with a permanent set (set.h) has it */
    double *set_peak; /* [n][3] m, d at the largest indentation so far; likewise */

    /* Power iteration (sf_time_step_power). */
    double *mode;       /* [n] its vector */
    float *directional; /* [n][6] Pa, tangent by direction (material/laws.h), when sf_time_step_due */

    sf_contact_points contact, skin;
    double *contact_rubbed; /* [contacts] J, work of friction to date */
    double *contact_push;   /* [n][3] m s-2, acceleration by the forces of a solve; zero between them */
    sf_wrench of_body[SF_BODIES]; /* on the pad in this step, but for the missile */

    sf_membrane_state membrane;

    double fastest; /* m s-1, of the coefficients at the half step */

    int64_t chunk_count;
    sf_partial *partial; /* [chunks] */

    sf_stopwatch *watch; /* borrowed; NULL = no timing */
} sf_state;

/* One array of the state. */
typedef struct sf_state_array {
    const char *name; /* in a checkpoint; NULL: used within one step only */
    size_t offset;
    char rows; /* n nodes, l nodes of a pad of layers, u nodes of foam with a set, h rows of history of all
                  blocks of lanes, c contact points, w those of a pad with contact faces, q and r pairs of sharp edges of missile and supports, s points and f sides of the skin,
                  m and t nodes and triangles of the membrane, k chunks */
    int bytes; /* of a row */
    sf_h5_type type; /* of an item that has a name: SF_H5_F64 or SF_H5_I32 */
} sf_state_array;

/* The table of all arrays, and the number of rows of a kind. */
const sf_state_array *sf_state_arrays(size_t *count);
int64_t sf_state_rows(const sf_model *model, char rows);

sf_status sf_state_create(const sf_model *model, sf_state *state, sf_error *err);
/* Returns the hash of a time and of the foam's history at it, by which a drop knows the one before. */
int64_t sf_state_pad(const sf_model *model, double time, const double *history);
/* Can the state be shown: are displacements, velocities, forces and the squares of stresses finite? */
bool sf_state_is_finite(const sf_model *model, const sf_state *state);
void sf_state_free(sf_state *state);

/* Forces (N) of missile and anvil on the contact points [contacts][3]. */
static inline const double *sf_state_load(const sf_model *model, const sf_state *state) {
    return model->contact_face_count > 0 ? state->contact.load : state->contact.force;
}

/* The energy ledger and the momentum balance. Stored and hysteretic energy are state functions of W and its
 * maximum, not integrals of the forces: their agreement with the kinetic energy is a check, not an identity.
 *
 * Errors are relative to the energy and momentum at first contact of a free missile; with a prescribed
 * motion, to the largest work and the impulse of the motion so far. The balance in space counts the pad, and
 * a missile that turns (sf_missile_momenta); angular momentum is about the origin, its error refers to the
 * same momentum times the pad's thickness. Both hold to rounding, whatever the step: theory, section
 * "Ledger". */

/* A force (N) at the place x (m, present). */
void sf_wrench_add(sf_wrench *wrench, const double x[3], const double force[3]);

/* Completes the ledger of the present time from the partial sums of the domains, the stabilisation and the
 * integration; contact and friction have been added already. `outside`: for the balance of momentum, along
 * the missile's direction and, with that of angular momentum, in space. `dt_v` (s): the distance of the half
 * steps. */
void sf_ledger_close(const sf_model *model, sf_state *state, const sf_wrench *outside, double dt_v);

/* The vibration from step to step, by which a mild instability shows that no energy balance sees: every 16
 * steps, the energy of a quarter of the change from one kick of the nodes to the next. A mode of frequency
 * omega has sin^4(omega dt / 2) of its kinetic energy in it. 0: the kicks of this step are kept; 1: those of
 * the next are compared with them. */
enum { SF_VIBRATION_INTERVAL = 16 };
static inline int64_t sf_vibration_phase(const sf_state *state) {
    return state->step % SF_VIBRATION_INTERVAL;
}

/* Internal energy: stored + hysteresis + viscous + stabilisation, J. */
double sf_ledger_internal(const sf_ledger *ledger);
