/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a run's history (model/columns.h), one per time step, kept in memory and written to /history as
 * a whole, scaled to the whole pad; and what else a run carries from step to step beside the state: the peak,
 * and the times at which the fields are due, as a frame or as the fields at the peak (sf_output writes them).
 */
#pragma once
#include "solver/state.h"

/* Adds the present state as a row of a history that began empty ({0}); release with sf_history_free. */
sf_status sf_history_add(sf_history *history, const sf_model *model, const sf_state *state, sf_error *err);

/* All rows to /history. */
sf_status sf_history_write(const sf_history *history, sf_h5 *file, sf_error *err);

/* The numbers of a recorder in a checkpoint, beside the history; a list as in solver/state.h. */
/* clang-format off */
#define SF_RECORDER_NUMBERS(X)                                                                                         \
    X(double, peak_value, , "1", "largest lasting acceleration (model/columns.h), m s-2; driven: contact force, N")     \
    X(double, peak_time, , "s", "of it")                                                                               \
    X(double, peak_kept, , "1", "the peak_value that the fields written last follow")                                  \
    X(int64_t, frames, , "1", "due so far")                                                                            \
    X(int64_t, frame_step, , "1", "step of the last of them, -1: none")                                                \
    X(double, next_frame, , "s", "time of the next one by the interval")                                               \
    X(int64_t, next_extra, , "1", "index in model->frame_time")                                                        \
    X(double, wall_time, , "s", "until the last checkpoint")                                                           \
    X(int64_t, restarts, , "1", "times that the run was resumed")                                                      \
    X(int64_t, past_rebound, , "1", "1: resumed after its rebound, which ends the run no more")
/* clang-format on */

typedef struct sf_recorder {
    sf_history history;
    SF_RECORDER_NUMBERS(SF_DECLARE)
} sf_recorder;

/* Extremes over the run. */
typedef struct sf_extremes {
    double peak_value;          /* as of the recorder */
    double peak_time;           /* s */
    double largest_compression; /* - */
    double largest_indentation; /* m, along z */
    bool bare_at_deepest;       /* no contact at the largest indentation */
    double largest_penetration; /* m */
    double largest_residual;    /* m s-1, |G v| */
    double largest_momentum;    /* - */
    double peak_internal;       /* J, whole pad, largest internal energy; at that time its shares: */
    double stabilisation_share; /* -, 0 without energy */
    double contact_share;       /* -, likewise */
} sf_extremes;

/* Computes the extremes from the history so far. */
sf_extremes sf_recorder_extremes(const sf_recorder *recorder);

/* An empty one; release with sf_recorder_free. */
void sf_recorder_begin(sf_recorder *recorder);
void sf_recorder_free(sf_recorder *recorder);

/* The quantity whose peak is recorded: deceleration, m s-2; of a missile that turns the resultant specific
 * force on its centre; or the contact force, N, on a missile whose motion is prescribed. */
double sf_recorder_measure(const sf_model *model, const sf_state *state);

/* Adds the state after sf_step_evaluate: a row of history, the peak. */
sf_status sf_recorder_add(sf_recorder *recorder, const sf_model *model, const sf_state *state, sf_error *err);

/* True if the fields of the state just added are due as those at the peak: one step past every maximum
 * that exceeds the one before by 0.1 %, which then counts as kept; and in the first step, so that a run
 * always has them. */
bool sf_recorder_peak_due(sf_recorder *recorder, const sf_state *state);

/* At the end of a run: is the curve still rising, or has the first step failed, so that the present state is
 * the peak? */
bool sf_recorder_peak_ahead(const sf_recorder *recorder);

/* True if a frame is due; it is then counted, and both schedules move past the present time. */
bool sf_recorder_frame_due(sf_recorder *recorder, const sf_model *model, const sf_state *state);

/* To and from a checkpoint; a recorder that is read must be new. SF_ERR_IO if the data read do not belong to
 * `state`. */
sf_status sf_recorder_write(const sf_recorder *recorder, sf_h5 *file, sf_error *err);
sf_status sf_recorder_read(sf_recorder *recorder, const sf_model *model, const sf_state *state,
                           const sf_h5 *file, sf_error *err);
