/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign that simulates only the rows which it needs: every figure of the plan has a wish for its error,
 * and a row is predicted as soon as its 95 % intervals are within these wishes. It is predicted by Gaussian
 * processes (study/predictor.h) of the difference between the drops and their columns (study/sweep/trend.h).
 * Further processes watch whether the row's figures can be used: a row that may be near the anvil, beyond its
 * foam's data or failing is simulated; one that is sure to be so stays open. Random rows are simulated for
 * checks alone: the intervals are widened until they hold 95 % of these. */
#ifndef SF_SWEEP_ADAPTIVE_H
#define SF_SWEEP_ADAPTIVE_H

#include "study/sweep/campaign.h"

typedef struct sf_sweep_adaptive sf_sweep_adaptive;

/* `drops`: the folder of the runs' folders; NULL: there are no results, and no columns. `jobs`: drops side by
 * side. `log`: NULL: silent. All borrowed. Release with sf_sweep_adaptive_free. NULL on failure. */
sf_sweep_adaptive *sf_sweep_adaptive_new(const sf_plan *plan, const char *drops, int jobs, FILE *log,
                                         sf_error *err);
void sf_sweep_adaptive_free(sf_sweep_adaptive *adaptive);

/* The chooser of a campaign; its context is `adaptive`, borrowed. */
sf_sweep_chooser sf_sweep_adaptive_chooser(sf_sweep_adaptive *adaptive);

/* Rows of the first round, with the checks: simulated before anything is predicted. */
int64_t sf_sweep_adaptive_design(const sf_plan *plan);

#endif
