/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulates one drop after another until the search ends. */
#ifndef SF_CFH_SERIES_H
#define SF_CFH_SERIES_H

#include "campaign/runner.h"
#include "cfh/search.h"
#include <signal.h>

#define SF_CFH_STRAIN_MARGIN 0.02 /* -, how far beyond the compression table a strain is worth a warning */

typedef struct sf_cfh_series {
    const sf_cfh_plan *plan;
    const sf_cfh_rig *rig;
    const sf_runner_drop *base; /* case, material, overrides; the speed is added here */
    double table_end;           /* -, strain up to which the compression curve is given */
} sf_cfh_series;

/* The point at height and speed of `point` with the result of its drop: figures and, for one with remarks,
 * the verdict as a note; or, with a verdict of "do not use", a point that failed, with the reason. */
void sf_cfh_take_result(const sf_runner_result *result, double table_end, sf_cfh_point *point);

/* Runs the search. A drop whose simulation fails numerically becomes a point that failed, with a note; every
 * other failure ends the series. SF_INTERRUPTED: run the same command again to resume. */
sf_status sf_cfh_simulate(const sf_cfh_series *series, sf_runner *runner, sf_cfh_points *points,
                          sf_cfh_step *ending, sf_error *err);

#endif
