/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rigid missile: it alone holds its pose, velocity and mass, its prescribed motion, and the forces on it.
 * Contact, ledger, history, frames and run use these functions, with the point concerned, and do not depend
 * on its degrees of freedom.
 *
 * A guided missile has one: a translation along a fixed unit vector, the direction of the missile card. It is
 * pulled by gravity and braked by the pad. A driven missile (sf_missile_is_driven, model/model.h) follows its
 * prescribed motion along it: it has zero mobility (infinite mass). A missile that turns
 * (sf_missile_turns, docs/adr/0018) has six: its centre of mass moves in space, and it rotates about it
 * (base/mat3.h).
 *
 * Forces, masses, energies and momenta are those of the modelled part, 1/2 or 1/4 of the missile under
 * symmetry; sf_model_whole is the factor to the whole. Points and vectors are in the geometry's frame. A
 * scalar "along" is the component in the direction of the missile card. */
#pragma once
#include "io/members.h"
#include "solver/contact/shape.h"

/* The numbers of the missile in a checkpoint (io/members.h). */
/* clang-format off */
#define SF_MISSILE_NUMBERS(X)                                                                                          \
    X(double, displacement, , "m", "along, since t = 0")                                                               \
    X(double, displacement_old, , "m", "along, one step ago")                                                          \
    X(double, velocity, , "m s-1", "along, at the half step before `time` until the step ends")                        \
    X(double, velocity_now, , "m s-1", "along, at `time`")                                                             \
    X(double, acceleration, , "m s-2", "along: negative while it is braked; 0 of a driven missile")                    \
    X(double, force, [3], "N", "of the pad on the missile")                                                            \
    X(double, friction, , "N", "its tangential part against the direction")                                            \
    X(double, contact_time, , "s", "first contact; NaN before")                                                        \
    X(double, release_time, , "s", "last time with contact; NaN before")                                               \
    X(double, torque, [3], "N m", "of the pad on the missile, about its centre")                                       \
    X(double, translation, [3], "m", "of the centre, against the model; like the next ones of a missile that turns")          \
    X(double, translation_old, [3], "m", "one step ago")                                                               \
    X(double, rate, [3], "m s-1", "velocity of the centre at the half step, as `velocity`")                            \
    X(double, rate_now, [3], "m s-1", "at `time`")                                                                     \
    X(double, pull, [3], "m s-2", "acceleration of the centre")                                                        \
    X(double, quaternion, [4], "1", "orientation, base/mat3.h; 1, 0, 0, 0 at t = 0")                               \
    X(double, turn, [3], "1", "its change in the last step, sf_rotation_advance")                                      \
    X(double, spin, [3], "kg m2 s-1", "angular momentum about the centre at the half step")                            \
    X(double, spin_now, [3], "kg m2 s-1", "at `time`")                                                                 \
    X(double, rim_time, , "s", "first contact with the rim of its spherical cap lowest; NaN before") \
    X(double, radius, , "m", "largest distance of its surface from the centre")                                        \
    X(double, lowest, , "m", "height z of its lowest point where the model has it")
/* clang-format on */

typedef struct sf_missile {
    SF_MISSILE_NUMBERS(SF_DECLARE)
} sf_missile;

/* At t = 0. */
void sf_missile_begin(const sf_model *model, sf_missile *missile);

/* ---- pose and velocity ---- */

/* Unit vector [3] of its motion, owned by the model. */
const double *sf_missile_direction(const sf_model *model);

/* Translation (m) since t = 0, of the centre. */
void sf_missile_translation(const sf_model *model, const sf_missile *missile, double out[3]);
/* The quantities that instruments in the missile measure at the present time, after sf_missile_kick. */
typedef struct sf_missile_view {
    double translation[3];          /* m */
    double quaternion[4];           /* orientation, base/mat3.h */
    double velocity[3];             /* m s-1, of the centre */
    double specific_force[3];       /* m s-2: force of the pad, and of the guide, over the mass */
    double angular_velocity[3];     /* rad s-1 */
    double angular_acceleration[3]; /* rad s-2 */
} sf_missile_view;
sf_missile_view sf_missile_read(const sf_model *model, const sf_missile *missile);
/* Displacement (m), in the last step, of the missile's material point at x. */
void sf_missile_motion_at(const sf_model *model, const sf_missile *missile, const double x[3], double out[3]);
/* Place now (m) of its material point that was at `rest` at t = 0, and the present direction of a vector that
 * turns with it. */
void sf_missile_place(const sf_model *model, const sf_missile *missile, const double rest[3], double out[3]);
void sf_missile_orient(const sf_model *model, const sf_missile *missile, const double rest[3], double out[3]);
/* Bound (m s-1) on the speed of all its points at the half step. */
double sf_missile_fastest(const sf_model *model, const sf_missile *missile);
/* sf_body_is_near and sf_body_gap at the present pose; x and normal in the geometry's
 * frame. */
bool sf_missile_near(const sf_model *model, const sf_missile *missile, const sf_body *body, const double x[3],
                     double margin);
bool sf_missile_gap(const sf_model *model, const sf_missile *missile, const sf_body *body, const double x[3],
                    double *gap, double normal[3]);

/* ---- its part in one contact solve ---- */

/* The motion of the missile in the next step under the contact forces that are found so far. */
typedef struct sf_missile_response {
    const sf_missile *missile; /* before the step; borrowed */
    const double *direction;   /* [3], of the model */
    double mobility;           /* kg-1; 0 of a driven missile */
    double travel;             /* m, along, in the next step without contact */
    double load;               /* N, along, of the missile on the pad */
    /* of a missile that turns, in place of travel and load */
    bool turns;
    double centre[3];           /* m, now */
    double step[3], turn[3];    /* of centre and orientation in the next step without contact */
    double angular[6];          /* kg-1 m-2, sf_rigid_mobility */
    double force[3], moment[3]; /* N and N m about `centre`, of the missile on the pad */
} sf_missile_response;

/* The response without contact forces, in the step from `time` to time + dt (s); dt_old (s): of the step
 * before. */
sf_missile_response sf_missile_predict(const sf_model *model, const sf_missile *missile, double time,
                                       double dt, double dt_old);
/* Displacement (m), in the next step without contact forces, of the missile's material point at x. */
void sf_missile_free_motion(const sf_missile_response *response, const double x[3], double out[3]);
/* sf_body_gap, at the pose that ends the next step without contact forces, of a point that moves
 * by `step` (m) from x in it. */
bool sf_missile_gap_ahead(const sf_model *model, const sf_missile_response *response, const sf_body *body,
                          const double x[3], const double step[3], double *gap, double normal[3]);
/* Adds a force (N) of the missile on the pad at x to the response. */
void sf_missile_load(sf_missile_response *response, const double x[3], const double force[3]);
/* Acceleration (m s-2) that the forces taken so far give the missile's material point at x, against which
 * they act: positive along a force on the pad. */
void sf_missile_recoil(const sf_missile_response *response, const double x[3], double out[3]);
/* Acceleration along the unit vector n, of the point at x, for each newton along n there (kg-1). */
double sf_missile_mobility(const sf_missile_response *response, const double x[3], const double n[3]);
/* Returns a bound of that mobility in every direction across the normal, for friction; 0 unless the
 * missile turns: its guide holds it. */
double sf_missile_looseness(const sf_missile_response *response, const double x[3]);

/* ---- forces and the step ---- */

/* Sets the forces to zero. */
void sf_missile_clear(sf_missile *missile);
/* Adds a force (N) of the pad on the missile at x; n: the missile's unit normal there, to which friction is
 * tangential. */
void sf_missile_apply(const sf_model *model, sf_missile *missile, const double x[3], const double n[3],
                      const double force[3]);
/* Records contact at `time`. */
void sf_missile_touch(const sf_model *model, sf_missile *missile, double time);
/* Acceleration by gravity and the forces applied. */
void sf_missile_accelerate(const sf_model *model, sf_missile *missile);
/* The velocities at `time` and at the half step after it; dt and dt_old as above. */
void sf_missile_kick(const sf_model *model, sf_missile *missile, double time, double dt, double dt_old);
/* The pose at `time`, dt after the present one, with the velocity that sf_missile_kick has set. */
void sf_missile_drift(const sf_model *model, sf_missile *missile, double time, double dt);

/* ---- figures ---- */

double sf_missile_mass(const sf_model *model);   /* kg; 0 of a driven missile, whose mass is infinite */
double sf_missile_weight(const sf_model *model); /* N, along */
double sf_missile_along(const sf_model *model, const double vector[3]);
/* Momentum along (kg m s-1), at the half step. */
double sf_missile_momentum(const sf_model *model, const sf_missile *missile);
/* Kinetic energy (J) at the present time, after sf_missile_kick; dt_v (s): the distance of the half steps. */
double sf_missile_kinetic(const sf_model *model, const sf_missile *missile, double dt_v);
/* Returns the missile's part in the balance of momentum in space (solver/state.h): momentum (kg m s-1)
 * and angular momentum about the origin (kg m2 s-1) at the half step, 0 unless it turns. */
void sf_missile_momenta(const sf_model *model, const sf_missile *missile, double linear[3],
                        double angular[3]);
/* And what acts there from outside through the missile, force (N) and moment about the origin (N m): the
 * weight of a missile that turns; any other is outside itself, with its force on the pad. */
void sf_missile_outside(const sf_model *model, const sf_missile *missile, double force[3], double moment[3]);
/* Work (J) of gravity since t = 0. */
double sf_missile_gravity_work(const sf_model *model, const sf_missile *missile);
/* Specific force (m s-2) against the direction, the force of the pad over the mass: the reading of an
 * accelerometer in the missile, 0 in free flight. 0 of a driven missile. */
double sf_missile_reading(const sf_model *model, const sf_missile *missile);
/* Force of the pad (N) against the direction. */
double sf_missile_contact_force(const sf_model *model, const sf_missile *missile);
/* Depth (m) of its lowest point below the undeformed top; negative before contact. */
double sf_missile_depth(const sf_model *model, const sf_missile *missile);
/* True if the missile is not driven and on its way away from the pad. If it turns: its centre rises, and
 * either all of its points do or it is clear of the pad however it turns. */
bool sf_missile_is_leaving(const sf_model *model, const sf_missile *missile);
