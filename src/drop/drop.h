/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop in memory: model, operators, state and history, without a file. */
#pragma once
#include "post/figures/figures.h"
#include "solver/run/recorder.h"
#include "solver/run/run.h"

typedef enum sf_drop_ending { SF_DROP_RUNS, SF_DROP_REBOUND, SF_DROP_FINISHED } sf_drop_ending;

typedef struct sf_drop {
    sf_model model;      /* arrays borrowed from the caller's model, but for the reference of a set */
    sf_model undeformed; /* borrowed altogether */
    sf_operators operators;
    sf_state state;
    sf_recorder recorder;
    sf_drop_ending ending;
    sf_error failure; /* of a step */
} sf_drop;

/* A drop at t = 0 before its first step. `before` and `pause`: as of sf_series_continue; NULL: on a new pad.
 * On failure, too, release with sf_drop_free. */
sf_status sf_drop_begin(const sf_model *model, const sf_drop *before, double pause, sf_drop *drop,
                        sf_error *err);
void sf_drop_free(sf_drop *drop);

/* Advances a drop that runs and has not failed by a step. */
void sf_drop_step(sf_drop *drop);

/* The drop as its results file would show it; the arrays stay the drop's. SF_ERR_INPUT: it has fewer than 3
 * steps. */
sf_status sf_drop_results(const sf_drop *drop, sf_results *results, sf_error *err);
