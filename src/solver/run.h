/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A whole run: steps until the end, with history, frames, the peak and the summary in results.h5. */
#ifndef SF_SOLVER_RUN_H
#define SF_SOLVER_RUN_H

#include "core/error.h"
#include "core/model.h"
#include "io/h5.h"
#include "solver/operators.h"
#include "solver/state.h"

#include <signal.h>
#include <stdio.h>

typedef struct sf_run {
    const volatile sig_atomic_t *stop; /* non-zero asks the run to end after the present step; borrowed */
    FILE *log;                         /* progress; borrowed */
    bool terminal;                     /* progress as one line rewritten in place */
    int threads;
    /* out */
    double wall_time;  /* s */
    double peak_value; /* m s-2, largest acceleration; of a driven missile N, largest contact force */
    double peak_time;  /* s */
    double largest_compression; /* - */
    double largest_indentation; /* m, along z */
    double largest_penetration; /* m */
    double largest_residual;    /* m s-1, |G v| */
    double largest_momentum;    /* - */
    double peak_internal;       /* J, whole pad, largest internal energy, and at that time: */
    double stabilisation_share; /* - */
    double contact_share;       /* - */
    const char *ending;         /* "finished", "rebound", "interrupted", "failed" */
} sf_run;

/* Runs `state` to the end. On a numerical failure or an interruption everything up to the last step is
 * written, with a last frame, and the status says so. `file` holds an open results file without history. */
sf_status sf_run_drop(const sf_model *model, const sf_operators *operators, sf_state *state, sf_run *run,
                      sf_h5 *file, sf_error *err);

#endif
