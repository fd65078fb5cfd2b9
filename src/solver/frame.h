/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame: the fields at the nodes at one time, as docs/formats.md lists them. */
#ifndef SF_SOLVER_FRAME_H
#define SF_SOLVER_FRAME_H

#include "core/error.h"
#include "core/model.h"
#include "io/h5.h"
#include "solver/operators.h"
#include "solver/state.h"

enum { SF_FRAME_FIELDS = 8 };

/* What a frame holds beside its fields. */
typedef struct sf_frame {
    double time;             /* s */
    double acceleration;     /* m s-2, against the direction of motion */
    double displacement[3];  /* m, of the missile */
    double base_reaction[3]; /* N, whole pad */
} sf_frame;

/* A frame kept in memory with all its fields. */
typedef struct sf_snapshot {
    sf_frame frame;
    double *field[SF_FRAME_FIELDS]; /* [n][columns], SI, in the order of the SF_FIELD_ bits; owned */
} sf_snapshot;

sf_status sf_snapshot_create(const sf_model *model, sf_snapshot *snapshot, sf_error *err);
void sf_snapshot_free(sf_snapshot *snapshot);

/* Fills the snapshot from the state after sf_step_evaluate. */
void sf_snapshot_take(const sf_model *model, const sf_operators *operators, const sf_state *state,
                      sf_snapshot *snapshot);

/* Writes all its fields to the group `path`. */
sf_status sf_snapshot_write(const sf_model *model, const sf_snapshot *snapshot, const char *path, sf_h5 *file,
                            sf_error *err);

/* Reads back what sf_snapshot_write wrote into a created snapshot. */
sf_status sf_snapshot_read(const sf_model *model, sf_snapshot *snapshot, const char *path, const sf_h5 *file,
                           sf_error *err);

/* Writes the present state's run.output_fields to the group `path`, some thousand nodes of a field at a time.
 */
sf_status sf_frame_write(const sf_model *model, const sf_operators *operators, const sf_state *state,
                         const char *path, sf_h5 *file, sf_error *err);

#endif
