/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engine of a sweep that simulates drops, by study/runner.h. */
#ifndef SF_SWEEP_DROPS_H
#define SF_SWEEP_DROPS_H

#include "study/sweep/campaign.h"

#define SF_SWEEP_LABEL "drop" /* begins the names of the drops' folders */

enum {
    SF_SWEEP_PIECE = 32,       /* rows at a time, for each drop that runs side by side */
    SF_SWEEP_ELSEWHERE = 20000 /* rows at a time by another engine, a thousand jobs of 20, which waits for the
                                  slowest job of a piece */
};

/* The context of the engine is the runner, borrowed. */
sf_sweep_engine sf_sweep_drops(sf_runner *runner, int jobs);

#endif
