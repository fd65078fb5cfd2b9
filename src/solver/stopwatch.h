/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wall time of the phases of a step, for the benchmark. */
#ifndef SF_SOLVER_STOPWATCH_H
#define SF_SOLVER_STOPWATCH_H

#include <stddef.h>
#include <time.h>

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

static inline double sf_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Adds the time since the last call to `phase`. Does nothing without a watch. */
static inline void sf_lap(sf_stopwatch *watch, sf_phase phase) {
    if (!watch)
        return;
    double now = sf_clock();
    watch->seconds[phase] += now - watch->mark;
    watch->mark = now;
}

#endif
