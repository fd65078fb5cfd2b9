/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "io/replace.h"
#include "solver/operators.h"
#include "solver/state.h"

/* A frame: the fields at the nodes at one time, as docs/formats.md lists them. */

/* Writes the state after sf_step_evaluate to the group `path`: time, missile and the fields whose SF_FIELD_
 * bits are set, some nodes at a time. */
sf_status sf_frame_write(const sf_model *model, const sf_operators *operators, const sf_state *state,
                         int64_t fields, const char *path, sf_h5 *file, sf_error *err);

/* One field of all nodes into values [node_count][components]. */
void sf_frame_take(const sf_model *model, const sf_operators *operators, const sf_state *state,
                   sf_frame_field field, double *values);

/* The rows of a run's history (model/columns.h): one per time step, kept in memory and written to /history as
 * a whole, scaled to the whole pad. */

/* Adds the present state as a row of a history that began empty ({0}); release with sf_history_free. */
sf_status sf_history_add(sf_history *history, const sf_model *model, const sf_state *state, sf_error *err);

/* All rows to /history. */
sf_status sf_history_write(const sf_history *history, sf_h5 *file, sf_error *err);

/* Data that a run carries from step to step beside the state: the history, the peak, and the times at which
 * the fields are due, as a frame or as the fields at the peak (sf_output writes them). */

/* The numbers of a recorder in a checkpoint, beside the history; a list as in state.h. */
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

/* results.h5 while it grows (docs/formats.md, section "While a run goes on"). Every file is written under
 * another name and renamed, so that results.h5 is complete at any instant. During the run, results.h5 holds
 * the history and links to the model and the frames, which are files of their own in the folder
 * results.h5.run, like the fields at the peak; in the end everything is copied into results.h5 and the folder
 * removed. The files of the folder are sealed (io/replace.h) and checked before use. */

typedef struct sf_output {
    char results[SF_PATH_SIZE];
    char checkpoint[SF_PATH_SIZE]; /* results.h5.restart */
    char folder[SF_PATH_SIZE];     /* results.h5.run */
    char partial[SF_PATH_SIZE];    /* of results.h5, between sf_output_begin and sf_output_commit */
    int lock;                      /* the open folder; -1: closed */
    int64_t fresh;                 /* bytes of the frames written since results.h5 was replaced last */
    int64_t size;                  /* bytes of that results.h5; 0: none yet */
} sf_output;

/* Closes a file, seals it and gives it its name; removes it if it failed. */
sf_status sf_output_seal(sf_h5 **file, const char *partial, const char *path, sf_error *err);

/* The names only. */
sf_status sf_output_name(sf_output *output, const char *results, sf_error *err);

/* Makes the folder and locks it: SF_ERR_INPUT if another run writes there. Release with sf_output_close. */
sf_status sf_output_open(sf_output *output, sf_error *err);
void sf_output_close(sf_output *output);

/* Provenance and model, from which every results.h5 starts (results_file.h): written under another name,
 * without change to the files of an earlier run. sf_output_start renames it, and keeps or removes the frames
 * of the earlier run. sf_output_abandon undoes everything since sf_output_open. */
sf_status sf_output_base(const sf_output *output, const sf_model *model, const sf_h5 *model_file,
                         const sf_provenance *provenance, sf_error *err);
sf_status sf_output_start(const sf_output *output, bool keep, sf_error *err);
void sf_output_abandon(const sf_output *output);

/* The present state as frame `index`. */
sf_status sf_output_frame(sf_output *output, const sf_model *model, const sf_operators *operators,
                          const sf_state *state, int64_t index, sf_error *err);

/* The present state as that at the peak, with all fields, in place of an earlier one. */
sf_status sf_output_peak(const sf_output *output, const sf_model *model, const sf_operators *operators,
                         const sf_state *state, sf_error *err);
/* Adds it as /peak to a results.h5 or a checkpoint, and takes it back from a checkpoint: a folder that is
 * there may hold a later one. */
sf_status sf_output_copy_peak(const sf_output *output, sf_h5 *file, sf_error *err);
sf_status sf_output_recover_peak(const sf_output *output, const sf_h5 *checkpoint, sf_error *err);

/* Frames 0 to count - 1 of the run so far: those that are not in the folder, or damaged there, come back from
 * results.h5, which has those of an ended run. `*lost`: the first that is nowhere whole, or -1. Fails if a
 * file cannot be read or written: then nothing is known to be lost. */
sf_status sf_output_recover(const sf_output *output, int64_t count, int64_t *lost, sf_error *err);

/* May results.h5 be replaced with `rows` new rows of history? A new file takes somewhat more bytes than the
 * last one, and four times as many must be new: then all of them together take a part of the data only. */
bool sf_output_is_due(const sf_output *output, int64_t rows);

/* A new results.h5 with model and frames 0 to count - 1, as links or copied. The caller adds the rest and
 * commits; on failure it closes the file. */
sf_status sf_output_begin(sf_output *output, bool copied, int64_t count, sf_h5 **file, sf_error *err);
sf_status sf_output_commit(sf_output *output, sf_h5 **file, sf_error *err);

/* Removes the folder with its files. */
void sf_output_clear(const sf_output *output);

/* Checkpoints (docs/formats.md): a sealed HDF5 file. With the model it resumes a run bit for bit as if
 * uninterrupted. It holds the state after sf_step_evaluate. */

/* An open checkpoint and the identity of its run. */
typedef struct sf_checkpoint {
    sf_h5 *file; /* open for sf_checkpoint_read */
    char *path;
    char *model_path, *model_hash, *git_revision, *compiler_flags;
    double end_time;    /* s */
    double time_before; /* s, of the step before the one that it holds */
} sf_checkpoint;

/* Replaces the checkpoint of `output`, whole or not at all; /peak comes from the folder. The provenance names
 * the model. */
sf_status sf_checkpoint_write(const sf_output *output, const sf_provenance *provenance, const sf_model *model,
                              const sf_state *state, const sf_recorder *recorder, sf_error *err);

/* Opens and checks a checkpoint. On success release with sf_checkpoint_close. */
sf_status sf_checkpoint_open(const char *path, sf_checkpoint *checkpoint, sf_error *err);
void sf_checkpoint_close(sf_checkpoint *checkpoint);

/* State and recorder, both new, of the same model; /peak goes back into the folder of `output`. */
sf_status sf_checkpoint_read(const sf_checkpoint *checkpoint, const sf_model *model, const sf_output *output,
                             sf_state *state, sf_recorder *recorder, sf_error *err);

/* A drop on a pad that has been hit before: its foam's history goes on from the end of an earlier run,
 * unloaded to rest, and its permanent set (solver/state.h) is the reference. Nothing else of it remains. */

/* The pad from which a run begins. */
typedef struct sf_earlier {
    const char
        *results; /* of the earlier run, with its checkpoint beside it; NULL: the pad is new; borrowed */
    double pause; /* s, of the pad between them */
} sf_earlier;

/* Before the operators are built: gives the model of the file the reference of the drop; if the checkpoint
 * `from` is open, that of the run that is resumed. SF_ERR_INPUT if the earlier run has not ended with the
 * missile away from the pad, or if its pad is another one: nodes, volumes, layers or a set. */
sf_status sf_series_shape(const sf_earlier *earlier, const sf_checkpoint *from, sf_model *model,
                          sf_error *err);

/* A new state (sf_state_create) on that pad. SF_ERR_INPUT if its foam remembers other things. */
sf_status sf_series_begin(const sf_earlier *earlier, const sf_model *model, const sf_operators *operators,
                          sf_state *state, sf_error *err);

/* The same, but by the last state of the earlier drop, on the same pad; NULL: the pad is new. */
sf_status sf_series_continue(const sf_state *before, double pause, const sf_model *model,
                             const sf_operators *operators, sf_state *state, sf_error *err);

/* When a run is over. */

/* The missile has left the pad for good, and the run shall end then. A driven missile may come back. */
bool sf_ending_rebounded(const sf_model *model, const sf_state *state);

/* The missile is on the anvil or the support: what follows is the impact of two rigid bodies, of which the
 * model says nothing. */
bool sf_ending_on_anvil(const sf_model *model, const sf_state *state);
/* Records SF_ERR_NUMERIC with a sentence for that. */
sf_status sf_ending_fail_on_anvil(const sf_model *model, const sf_state *state, sf_error *err);

/* The end time is reached. */
bool sf_ending_finished(const sf_model *model, const sf_state *state);

/* The notes of a run: facts for the user of its figures that no check of model/good_run.h covers, for the
 * terminal and for /summary/notes in results.h5. */

/* Tells the sink; `state` is that of the last step. */
void sf_run_tell(const sf_model *model, const sf_state *state, const sf_extremes *extremes,
                 const sf_sink *sink);

/* A whole run: steps until the end, with history, frames, the peak and the summary in results.h5, and
 * checkpoints from which it can be resumed. */

typedef struct sf_run {
    const volatile sig_atomic_t *stop; /* non-zero asks the run to end after the present step; borrowed */
    FILE *log;                         /* progress; borrowed */
    const sf_sink *sink;               /* warnings; borrowed; NULL: none */
    bool terminal;                     /* progress as one line rewritten in place */
    int threads;
    bool checkpoints;                /* write them? */
    double checkpoint_wall;          /* s of wall time between two, at most */
    double checkpoint_time;          /* s of simulated time between two */
    const sf_provenance *provenance; /* of the checkpoints; borrowed */
    sf_earlier earlier;              /* the pad from which it begins */
    bool to_end_time;                /* resumed after its rebound, a run goes on to the end time */
    char note[1024];                 /* a sentence of the program for /summary/notes, or "" */
    /* out */
    double wall_time; /* s, with the time before a restart */
    sf_extremes extremes;
    bool shown;         /* the last frame is of the last step, and not of one before it that was finite */
    const char *ending; /* "finished", "rebound", "interrupted", "anvil", "failed" */
} sf_run;

/* Runs `state` to the end, from the beginning or from `checkpoint` (NULL: none) with a `state` freshly
 * created. `output` is open and has its base. If a frame of the run so far is lost, the run starts from the
 * beginning with a warning. On a numerical failure or an interruption everything up to the
 * last step is written, with a last frame, and the status says so. After a failure `state` and the checkpoint
 * are those of the last valid step. A missile that has reached the anvil ends the run likewise, with
 * SF_ERR_NUMERIC, and its last step is valid. When a file cannot be written the folder of `output` stays, and
 * the last checkpoint with it. */
sf_status sf_run_drop(const sf_model *model, const sf_operators *operators, sf_state *state, sf_run *run,
                      sf_output *output, const sf_checkpoint *checkpoint, sf_error *err);
