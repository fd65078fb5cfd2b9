/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interval of the critical fall height from draws of the foam's posterior (docs/cfh.md). Of every draw
 * the columns below the missile (study/column.h) give a_max and HIC over the height; they are corrected
 * by the simulated drops,
 *
 *     ln y_draw(h) = ln columns_draw(h) + b(ln h, ln columns_draw(h)),
 *
 * where b is a Gaussian process (study/column.h) of ln y_simulated - ln columns at the drops of the case's
 * own material and of some draws, whose deviation is the columns' own error. Each draw is repeated
 * with random errors of the responses (study/fit/drop/inference.h), of the mesh, of the points about their
 * fit, of the corrected columns and of the rig. Heights are those of free fall (m) unless a name says "rig".
 * The same bits for any number of threads. */
#pragma once
#include "study/cfh/points.h"
#include "study/column.h"
#include "study/runner.h"

/* The draws of a foam's posterior: material files draw-001.cfg, draw-002.cfg, ... of a folder, each as
 * probable as any other, as softfall-fit drop writes them. */

enum { SF_CFH_LEAST_DRAWS = 100, SF_CFH_MOST_DRAWS = 2000 };

typedef struct sf_cfh_draw {
    char path[PATH_MAX];
    sf_material material; /* of the case with that file; owned, as the next */
    sf_material_law law;
    sf_response_error response; /* of its file; of other numbers than a_max and HIC none is used */
} sf_cfh_draw;

typedef struct sf_cfh_draws {
    const char *folder; /* borrowed */
    int count;
    bool with_response; /* every draw states the errors of a_max and HIC; else none of them does */
    sf_cfh_draw *draw;  /* [count] owned */
} sf_cfh_draws;

/* Reads every draw as the material of the case, with the case's overrides; `own` is the case's own material.
 * SF_ERR_INPUT: an override of the material, which would be the same in every draw; no draw, a gap in their
 * numbers, fewer than SF_CFH_LEAST_DRAWS, one that the case refuses, one with another law or density, one
 * with errors of the responses where another has none, or of a_max or HIC only; draws that are all the same.
 * Release with sf_cfh_draws_free, also on failure. */
sf_status sf_cfh_draws_read(const char *folder, const char *case_path, int override_count,
                            const char *const *overrides, const sf_material *own, sf_cfh_draws *draws,
                            sf_error *err);
void sf_cfh_draws_free(sf_cfh_draws *draws);

enum {
    SF_CFH_GRID = 80,    /* heights at which the columns drop, at most */
    SF_CFH_REPEATS = 64, /* of a draw with random errors */
    SF_CFH_CHECKS = 9,   /* simulated draws at most */
    SF_CFH_DROPS = SF_CFH_MAX_POINTS + SF_CFH_CHECKS,
    SF_CFH_FIRST = SF_CFH_CRITERIA, /* in place of a criterion: the one that is met first */
};

/* Root mean square of the mesh error of a_max over what softfall-pre expects; that of HIC is larger by a
 * factor (docs/cfh.md, from docs/theory.md section 11 and the mesh study). */
#define SF_CFH_MESH_SIZE 0.78
#define SF_CFH_MESH_HIC 1.3

/* The sources of uncertainty that an interval holds, one after another. */
typedef enum sf_cfh_part {
    SF_CFH_PART_FOAM,
    SF_CFH_PART_RESPONSE,
    SF_CFH_PART_MESH,
    SF_CFH_PART_FIT,
    SF_CFH_PART_COLUMNS,
    SF_CFH_PARTS
} sf_cfh_part;

typedef struct sf_cfh_interval {
    double low, median, high; /* 2.5, 50 and 97.5 %; of heights m, 0 or INFINITY: beyond those looked at */
    double end[2];            /* the lowest and the highest of these */
} sf_cfh_interval;

/* The pad that the drops had, for the columns. */
typedef struct sf_cfh_pad {
    sf_columns columns; /* of any speed; count 0: not known yet */
    double mesh_error;  /* -, expected of a_max; NaN: not estimated */
} sf_cfh_pad;

/* A simulated drop and its columns, as natural logarithms. */
typedef struct sf_cfh_drop {
    double height; /* m */
    double column[SF_CFH_CRITERIA], value[SF_CFH_CRITERIA];
} sf_cfh_drop;

/* A draw that was simulated at its critical height. */
typedef struct sf_cfh_check {
    int draw;     /* from 0 */
    double share; /* of all draws, those whose height is lower */
    double height;
    sf_cfh_criterion first;            /* which limit it meets first by the corrected columns */
    double columns[SF_CFH_CRITERIA];   /* g, -, corrected by the drops of the case's own material */
    bool failed;                       /* no figures: `note` says why */
    double simulated[SF_CFH_CRITERIA]; /* g, -; NaN if it failed, as the next */
    double error[SF_CFH_CRITERIA];     /* ln of that over the columns */
    sf_cfh_drop drop;                  /* unless it failed */
    char note[SF_CFH_NOTE_SIZE];
} sf_cfh_check;

/* A draw as columns. Its errors of ln(value) are zeros if it states none. */
typedef struct sf_cfh_curve {
    double column[SF_CFH_CRITERIA][SF_CFH_GRID]; /* ln */
    double value[SF_CFH_CRITERIA][SF_CFH_GRID];  /* corrected; INFINITY where the columns collapse */
    double sd[SF_CFH_CRITERIA][SF_CFH_GRID];     /* standard deviation of the correction */
    double columns_sd[SF_CFH_CRITERIA];          /* the same at its critical height; 0: not known */
    int reach;                                   /* heights before they do */
    double crossing[SF_CFH_FIRST + 1];           /* m, foam alone; 0 or INFINITY: beyond the grid */
    double shared[SF_CFH_CRITERIA];              /* error of the responses that all drops share */
    double own_sd[SF_CFH_CRITERIA];              /* standard deviation of a drop's own */
} sf_cfh_curve;

typedef struct sf_cfh_spread {
    int draws, grid;
    double height[SF_CFH_GRID];
    double simulated[2];            /* m, the heights between which the correction is known */
    int own;                        /* drops of the case's own material, ascending */
    sf_cfh_drop drop[SF_CFH_DROPS]; /* these, then the checks that have figures */
    int freedom;                    /* degrees of freedom of the columns' own error; 0: it is not known */
    sf_cfh_interval band[SF_CFH_CRITERIA][SF_CFH_GRID]; /* of the draws, foam alone: g, -, without ends;
                                                           INFINITY: of draws whose columns collapse */
    sf_cfh_curve *draw;                             /* [draws] owned */
    bool with_response;                             /* the draws state errors of the responses */
    double limit[SF_CFH_CRITERIA];
    double own_height;                   /* m, of the case's own material; NaN: none was found */
    double mesh_error;                   /* -, expected of a_max; NaN: not known */
    double fit_scatter[SF_CFH_CRITERIA]; /* of ln(value); NaN: not known */
    int checks;
    sf_cfh_check check[SF_CFH_CHECKS];
    int above, below, collapsed,
        beyond; /* draws: no limit reached; one exceeded at the lowest height; columns
                   collapse before a limit; crossing outside of `simulated` */
    double scatter[SF_CFH_CRITERIA]
                  [SF_CFH_GRID]; /* -, of single pads and drops, at the heights; NaN: not known */
    /* the last: that of a single pad and drop, which the whole interval does not hold */
    sf_cfh_interval part[SF_CFH_PARTS + 1][SF_CFH_FIRST + 1];
    sf_cfh_interval rig; /* of the first, on the rig, with g_eff; NaN without a rig */
} sf_cfh_spread;

/* Drops the columns of the case's own material and of every draw. `result` has the fits. Errors: no drop has
 * figures; the columns of the case's own material collapse at each of the simulated heights; SF_INTERRUPTED.
 * Release with sf_cfh_spread_free, also on failure. */
sf_status sf_cfh_spread_build(const sf_cfh_pad *pad, const sf_cfh_draws *draws, const sf_material_law *own,
                              const sf_cfh_points *points, const sf_cfh_result *result, const double *limit,
                              sf_cfh_spread *spread, sf_error *err);
void sf_cfh_spread_free(sf_cfh_spread *spread);

/* Chooses `count` draws, of 5 to 95 % of the heights (one: 50 %), that are to be simulated; their heights are
 * multiples of `grain` m. Fewer if fewer draws have a height. */
void sf_cfh_spread_choose(sf_cfh_spread *spread, int count, double grain);
/* Takes the simulated values of a check. */
void sf_cfh_check_take(const double *simulated, sf_cfh_check *check);

/* Corrects the draws by all drops, and finds bands and intervals. */
sf_status sf_cfh_spread_evaluate(sf_cfh_spread *spread, const sf_cfh_rig *rig, sf_error *err);

/* Root mean square over the draws of the columns' own error of ln(value), but for Student's t; NaN: not
 * known.
 */
double sf_cfh_columns_error(const sf_cfh_spread *spread, int criterion);

/* The share of a part in the squared length of the whole interval of ln(height); the shares sum to 1. NaN: an
 * end is open, or the interval has no length. */
double sf_cfh_spread_share(const sf_cfh_spread *spread, sf_cfh_part part);

/* The whole interval of a criterion, or of SF_CFH_FIRST. */
const sf_cfh_interval *sf_cfh_spread_whole(const sf_cfh_spread *spread, int criterion);

/* Simulates the drops of a search, round by round until it ends, and then draws of the foam. The drops of a
 * round run side by side, as many as the runner has jobs; the results do not depend on that. */

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
