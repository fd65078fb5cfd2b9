/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulates the drops of a search, round by round until it ends, and then draws of the foam. The drops of a
 * round run side by side, as many as the runner has jobs; the results do not depend on that. */
#ifndef SF_CFH_SERIES_H
#define SF_CFH_SERIES_H

#include "case/case.h"
#include "study/cfh/points.h"
#include "study/cfh/spread.h"
#include "study/runner.h"

/* The foams of the pad, and the strains to which their curves are given. */
typedef struct sf_cfh_foam {
    char name[SF_MATERIAL_NAME_SIZE]; /* of a layer; "": the pad has one material */
    double end;                       /* -, sf_law.data_end */
    const char *words;                /* sf_law.data_end_words; static */
} sf_cfh_foam;

typedef struct sf_cfh_foams {
    int count; /* at least 1; 1: one material, whatever its name */
    sf_cfh_foam foam[SF_CASE_MAX_LAYERS];
} sf_cfh_foams;

typedef struct sf_cfh_series {
    const sf_cfh_plan *plan;
    const sf_cfh_rig *rig;
    const sf_runner_drop *base; /* case, material, overrides; the speed is added here */
    const sf_cfh_foams *foams;
    sf_cfh_pad *pad; /* filled from the first drop that has results; NULL: not wanted */
} sf_cfh_series;

/* A point without figures. */
sf_cfh_point sf_cfh_point_at(double height);

/* The point at height and speed of `point` with the result of its drop: figures and, for one with remarks,
 * the verdict as a note; or, with a verdict of "do not use", a point that failed, with the reason. */
void sf_cfh_take_result(const sf_runner_result *result, const sf_cfh_foams *foams, sf_cfh_point *point);

/* Runs the search. A drop whose simulation fails numerically becomes a point that failed, with a note; every
 * other failure ends the series. SF_INTERRUPTED: run the same command again to resume. */
sf_status sf_cfh_simulate(const sf_cfh_series *series, sf_runner *runner, sf_cfh_points *points,
                          sf_cfh_step *ending, sf_error *err);

/* Simulates the draws that were chosen to check the columns. A drop that fails numerically or is not to be
 * used becomes a check that failed. */
sf_status sf_cfh_simulate_checks(const sf_cfh_series *series, const sf_cfh_draws *draws, sf_runner *runner,
                                 sf_cfh_spread *spread, sf_error *err);

#endif
