/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop in memory: model, operators, state and history, without a file. */
#pragma once
#include "post/figures/figures.h"
#include "solver/run/recorder.h"
#include "solver/run/run.h"

typedef enum sf_drop_ending { SF_DROP_RUNS, SF_DROP_REBOUND, SF_DROP_FINISHED } sf_drop_ending;

/* A state whose fields are kept, as results.h5 has those of a frame. */
typedef struct sf_kept {
    sf_frame_head head;             /* its `field` is that of this struct */
    double *field[SF_FRAME_FIELDS]; /* owned; NULL: not kept */
} sf_kept;

typedef struct sf_drop {
    sf_model model;      /* arrays borrowed from the caller's model, but for the reference of a set */
    sf_model undeformed; /* borrowed altogether */
    sf_operators operators;
    sf_state state;
    sf_recorder recorder;
    sf_kept first, peak, last; /* after sf_drop_keep: the state at t = 0, that at the peak so far, and room */
    bool keeps;                /* sf_drop_keep was called */
    double wall_time;          /* s, spent in steps */
    sf_drop_ending ending;
    sf_error failure; /* of a step */
} sf_drop;

/* A drop at t = 0 before its first step. `before` and `pause`: as of sf_series_continue; NULL: on a new pad.
 * On failure, too, release with sf_drop_free. */
sf_status sf_drop_begin(const sf_model *model, const sf_drop *before, double pause, sf_drop *drop,
                        sf_error *err);
void sf_drop_free(sf_drop *drop);

/* Before the first step: keeps the fields from which all figures of summary.json are computed; without it
 * those of the fields, local_collapse and others, are NaN. */
sf_status sf_drop_keep(sf_drop *drop, sf_error *err);

/* Advances a drop that runs and has not failed by a step. */
void sf_drop_step(sf_drop *drop);

/* The drop as its results file would show it, without its frames in between; the history stays the drop's.
 * Release with sf_drop_results_free, also on failure. SF_ERR_INPUT: it has fewer than 3 steps; the error of
 * the drop if it failed before. */
sf_status sf_drop_results(const sf_drop *drop, sf_results *results, sf_error *err);
void sf_drop_results_free(sf_results *results);
