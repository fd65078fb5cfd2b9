/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

/* The fields of a frame: one value, vector or tensor per node. This list is the only one of them: the bits of
 * output_fields, the names of output.fields in a case, /frames and /peak in results.h5, reading and checking,
 * pad.xdmf and the table in docs/formats.md follow it.
 *
 * To add a field: a line at the end of the list, and its values in solver/run/frame.c. */

/* X(constant, name, components (1, 3 or 9), units, name in ParaView, description, remark), with BETWEEN
 * between two. The remark is for docs/formats.md. */
/* clang-format off */
#define SF_FRAME_FIELD_LIST(X, BETWEEN)                                                                                \
    X(DISPLACEMENT, displacement, 3, "m", "displacement_m", "u_h at the nodes", "") BETWEEN                            \
    X(VELOCITY, velocity, 3, "m s-1", "velocity_m_s", "time derivative of u_h, half a step later", "") BETWEEN         \
    X(CAUCHY_STRESS, cauchy_stress, 9, "Pa", "cauchy_stress_Pa",                                                       \
      "Cauchy stress xx xy xz yx yy yz zx zy zz of the smoothing domain", "") BETWEEN                                  \
    X(VON_MISES, von_mises, 1, "Pa", "von_mises_Pa", "von Mises stress", "") BETWEEN               \
    X(PRINCIPAL_STRETCHES, principal_stretches, 3, "1", "principal_stretches_1",                                       \
      "principal stretches, ascending", "") BETWEEN                                                                    \
    X(LARGEST_COMPRESSION, largest_compression, 1, "1", "largest_compression_1",                                       \
      "1 - smallest principal stretch", "") BETWEEN                                                                    \
    X(ENERGY_DENSITY, energy_density, 1, "J m-3", "energy_density_J_m3",                                               \
      "W of the loading curve per reference volume", "") BETWEEN                                                       \
    X(HYSTERESIS_FACTOR, hysteresis_factor, 1, "1", "hysteresis_factor_1", "factor on the curve's stress", "") BETWEEN \
    X(CONTACT_PRESSURE, contact_pressure, 1, "Pa", "contact_pressure_Pa",                                              \
      "normal force of the missile on the node over the undeformed surface that belongs to it", "0 without contact")   \
    BETWEEN X(SOFTENING, softening, 1, "J m-3", "softening_J_m3",                                                      \
              "energy by which loading up to the largest W so far takes up less than that of new foam",                \
              "from the second drop on a pad; after the rest, in the first frame, before the drop")
/* clang-format on */

#define SF_FRAME_CONSTANT(constant, ...) SF_FRAME_##constant,
typedef enum sf_frame_field { SF_FRAME_FIELD_LIST(SF_FRAME_CONSTANT, ) SF_FRAME_FIELDS } sf_frame_field;
#undef SF_FRAME_CONSTANT

/* Bits of output_fields. */
#define SF_FIELD_BIT(constant, ...) SF_FIELD_##constant = 1 << SF_FRAME_##constant,
enum { SF_FRAME_FIELD_LIST(SF_FIELD_BIT, ) SF_FIELD_ALL = (1 << SF_FRAME_FIELDS) - 1 };
#undef SF_FIELD_BIT

typedef struct sf_frame_field_info {
    const char *name; /* in a case and below /frames/NNNNNN */
    int components;   /* 1, 3 or 9 */
    const char *units;
    const char *array; /* in pad-HASH.h5 and ParaView: the name with its unit */
    const char *description, *remark;
} sf_frame_field_info;

/* Static storage. */
const sf_frame_field_info *sf_frame_field_get(sf_frame_field field);

/* The history of a run: one row per time step, also of step 0, of the whole pad and missile, SI. This list is
 * the only one of its columns: the solver's rows, /history in results.h5 and checkpoints, reading and
 * checking, history.csv and the table in docs/formats.md follow it.
 *
 * To add a column: a line here, and its value in solver/run/recorder.c. */

/* X(name, units, name in history.csv, factor from SI to the unit in that name, description, remark). The
 * column without a name in history.csv, the acceleration, stands there raw and filtered (post/view/csv.c).
 * The remark is for docs/formats.md. */
/* clang-format off */
#define SF_HISTORY_COLUMNS(X)                                                                                          \
    X(time, "s", "time_ms", 1e3, "end of the step", "")                                                                \
    X(acceleration, "m s-2", NULL, 1, "specific force on the missile, against its direction of motion",                \
      "as an accelerometer in it reads: force of the pad over the mass, 0 in free flight and with a prescribed motion") \
    X(velocity, "m s-1", "velocity_m_s", 1, "missile, along its direction of motion", "negative after rebound")        \
    X(displacement, "m", "displacement_mm", 1e3, "missile, along its direction of motion", "since t = 0")              \
    X(indentation, "m", "indentation_mm", 1e3,                                                                         \
      "depth of the missile's lowest point below the undeformed pad's top",                                          \
      "the top is the pad's highest point, from which the thickness is measured; 0 above it")                                      \
    X(contact_force, "N", "contact_force_N", 1, "on the missile, against its direction of motion", "")                 \
    X(friction_force, "N", "friction_force_N", 1, "tangential part of it", "along the same direction")                 \
    X(base_reaction, "N", "base_reaction_N", 1, "force of the base on the pad, z", "positive: the base pushes up")     \
    X(support_force_1, "N", "support_force_1_N", 1, "resultant of the forces of support 1 on the pad", "by the order of `supports`; 0 without it") \
    X(support_force_2, "N", "support_force_2_N", 1, "the same of support 2", "")                                       \
    X(support_force_3, "N", "support_force_3_N", 1, "the same of support 3", "")                                       \
    X(support_force_4, "N", "support_force_4_N", 1, "the same of support 4", "")                                       \
    X(energy_kinetic_missile, "J", "energy_kinetic_missile_J", 1, "kinetic energy of the missile", "")                 \
    X(energy_kinetic_pad, "J", "energy_kinetic_pad_J", 1, "kinetic energy of the pad", "")                             \
    X(energy_stored, "J", "energy_stored_J", 1, "recoverable energy of the foam", "")                                  \
    X(energy_hysteresis, "J", "energy_hysteresis_J", 1, "lost by the unloading rule", "")                              \
    X(energy_viscous, "J", "energy_viscous_J", 1, "work of DAMP, Maxwell, Kelvin and rate overstress", "")             \
    X(energy_stabilisation, "J", "energy_stabilisation_J", 1, "work of the stabilisation", "")                         \
    X(energy_contact, "J", "energy_contact_J", 1, "lost in normal contact", "or held there")                           \
    X(energy_friction, "J", "energy_friction_J", 1, "lost in friction", "")                                            \
    X(energy_external, "J", "energy_external_J", 1,                                                                    \
      "work of gravity on the missile, or of its prescribed motion", "")                                               \
    X(energy_weight, "J", "energy_weight_J", 1, "work of gravity on a resting pad", "0 of a pad that is held")           \
    X(energy_anvil, "J", "energy_anvil_J", 1, "lost at the anvil by a resting pad", "part of energy_contact and energy_friction") \
    X(energy_error, "1", "energy_error_1", 1,                                                                          \
      "error of the energy balance, over the initial energy or the largest external work",                             \
      "(kinetic + stored + hysteresis + viscous + stabilisation + contact + friction - external - weight) / initial - 1; with a prescribed motion theory.md (33a)") \
    X(momentum_error, "1", "momentum_error_1", 1,                                                                      \
      "momentum change minus impulses, over mass x speed or the impulse of contact",                                   \
      "the latter with a prescribed motion, so far")                                                                   \
    X(translation_x, "m", "translation_x_mm", 1e3, "missile's centre since t = 0, x", "its place then is /model/missile_centre") \
    X(translation_y, "m", "translation_y_mm", 1e3, "missile's centre since t = 0, y", "") \
    X(translation_z, "m", "translation_z_mm", 1e3, "missile's centre since t = 0, z", "") \
    X(quaternion_w, "1", "quaternion_w_1", 1, "orientation of the missile, w", "unit quaternion from its axes to space; 1, 0, 0, 0 of a guided missile") \
    X(quaternion_x, "1", "quaternion_x_1", 1, "orientation of the missile, x", "") \
    X(quaternion_y, "1", "quaternion_y_1", 1, "orientation of the missile, y", "") \
    X(quaternion_z, "1", "quaternion_z_1", 1, "orientation of the missile, z", "") \
    X(velocity_x, "m s-1", "velocity_x_m_s", 1, "missile's centre, x", "") \
    X(velocity_y, "m s-1", "velocity_y_m_s", 1, "missile's centre, y", "") \
    X(velocity_z, "m s-1", "velocity_z_m_s", 1, "missile's centre, z", "") \
    X(specific_force_x, "m s-2", "specific_force_x_m_s2", 1, "specific force on the missile's centre, x", "as a triaxial accelerometer there reads, in the axes of the geometry; `acceleration` is its part against the direction") \
    X(specific_force_y, "m s-2", "specific_force_y_m_s2", 1, "specific force on the missile's centre, y", "") \
    X(specific_force_z, "m s-2", "specific_force_z_m_s2", 1, "specific force on the missile's centre, z", "") \
    X(angular_velocity_x, "rad s-1", "angular_velocity_x_rad_s", 1, "missile, about x", "0 of a guided missile, like the next ones") \
    X(angular_velocity_y, "rad s-1", "angular_velocity_y_rad_s", 1, "missile, about y", "") \
    X(angular_velocity_z, "rad s-1", "angular_velocity_z_rad_s", 1, "missile, about z", "") \
    X(angular_acceleration_x, "rad s-2", "angular_acceleration_x_rad_s2", 1, "missile, about x", "") \
    X(angular_acceleration_y, "rad s-2", "angular_acceleration_y_rad_s2", 1, "missile, about y", "") \
    X(angular_acceleration_z, "rad s-2", "angular_acceleration_z_rad_s2", 1, "missile, about z", "") \
    X(momentum_error_space, "1", "momentum_error_space_1", 1, "error of the momentum in space, over that of `momentum_error`", "pad, and a free missile, against constraints, anvil and weight") \
    X(angular_momentum_error, "1", "angular_momentum_error_1", 1, "error of the angular momentum about the origin, over the same x thickness", "") \
    X(largest_compression, "1", "largest_compression_1", 1, "1 - smallest principal stretch of all domains", "")       \
    X(smallest_jacobian, "1", "smallest_jacobian_1", 1, "smallest det F", "of all domains")                            \
    X(contact_nodes, "1", "contact_nodes_1", 1, "points in contact with the missile, modelled part", "")               \
    X(anvil_nodes, "1", "anvil_nodes_1", 1, "points of a resting pad that the anvil presses, modelled part", "")        \
    X(contact_area, "m2", "contact_area_mm2", 1e6, "undeformed area of the surface that belongs to these points", "whole pad") \
    X(penetration, "m", "penetration_mm", 1e3, "deepest penetration of a point in a pair", "after the step")           \
    X(constraint_residual, "m s-1", "constraint_residual_m_s", 1, "largest |G v|, measured every 16 steps", "")        \
    X(time_step, "s", "time_step_us", 1e6, "step that follows", "")
/* clang-format on */

#define SF_HISTORY_ONE(...) +1
enum { SF_HISTORY_COUNT = 0 SF_HISTORY_COLUMNS(SF_HISTORY_ONE) };
#undef SF_HISTORY_ONE

/* Each column under its name, and all of them in the order of the list. */
#define SF_HISTORY_MEMBER(name, ...) double *name;
typedef struct sf_history {
    int64_t rows, room; /* rows held, and allocated (0 if no rows are added) */
    union {
        struct {
            SF_HISTORY_COLUMNS(SF_HISTORY_MEMBER) /* [rows] owned */
        };
        double *column[SF_HISTORY_COUNT];
    };
} sf_history;
#undef SF_HISTORY_MEMBER

typedef struct sf_history_column {
    const char *name;  /* below /history */
    const char *units; /* there */
    const char *csv;   /* name in history.csv, with its unit; NULL: see the list */
    double factor;     /* from SI to that unit */
    const char *description, *remark;
} sf_history_column;

/* Column k of the list, 0 <= k < SF_HISTORY_COUNT; static storage. */
const sf_history_column *sf_history_column_get(int k);

/* Releases the columns and leaves an empty history. */
void sf_history_free(sf_history *history);

/* Largest magnitude in a column of the history; 0 without rows. */
double sf_history_largest(const sf_history *history, const double *column);

/* The value that a column keeps up over three rows: the least of this row and the two before it, 0 before the
 * first row. An impulse of one or two time steps, as of a flat missile at first contact, does not show. */
double sf_history_sustained(const double *column, int64_t row);

/* |specific force| on the missile's centre in a row, m s-2. */
double sf_history_resultant(const sf_history *history, int64_t row);

/* First row of the largest value of a column; 0 without rows. */
int64_t sf_history_row_of_largest(const sf_history *history, const double *column);

/* The internal energy (stored + hysteresis + viscous + stabilisation) at its largest. */
typedef struct sf_internal_energy {
    double peak;          /* J */
    double time;          /* s */
    double stabilisation; /* -, its share in the peak; NaN unless the peak is positive */
    double contact;       /* -, energy lost in contact over the peak; likewise */
} sf_internal_energy;

/* Needs a history with at least one row. */
sf_internal_energy sf_history_internal_energy(const sf_history *history);
