/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The prescribed motion of a missile driven by a machine (model->motion_*): displacement along its direction,
 * linear between the points of the table, independent of the forces. Only for models whose missile is driven
 * (sf_missile_is_driven). */
#pragma once
#include "model/model.h"

/* Relative rounding of times that come from different units. */
#define SF_MOTION_SLACK 1e-12
#define SF_MOTION_MAX_SPEED 200.0 /* m s-1 */

/* Displacement (m) at `time` >= 0 (s). Extrapolates the last piece beyond the end of the table: the last step
 * of a run passes its end time by less than a step. */
double sf_motion_displacement(const sf_model *model, double time);
/* Velocity (m s-1) of the piece that begins at or before `time`. */
double sf_motion_velocity(const sf_model *model, double time);

typedef struct sf_motion_range {
    int64_t points;      /* of the table; 0 of a free missile, and all else 0 */
    double end_time;     /* s, of the table */
    double displacement; /* m, largest; at least 0 */
    double speed;        /* m s-1, largest of all pieces */
} sf_motion_range;

/* For free missiles too. */
sf_motion_range sf_motion_measure(const sf_model *model);
