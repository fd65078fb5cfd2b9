/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simulated drops of a critical fall height, in ascending height, and the results read from them. Heights
 * are those of free fall unless a name says "rig". */
#ifndef SF_CFH_POINTS_H
#define SF_CFH_POINTS_H

#include "study/cfh/crossing.h"
#include "study/cfh/rig.h"
#include "post/figures/verdict.h"
#include <stdbool.h>

typedef enum sf_cfh_criterion { SF_CFH_A_MAX, SF_CFH_HIC, SF_CFH_CRITERIA } sf_cfh_criterion;

enum { SF_CFH_MAX_POINTS = 16, SF_CFH_NOTE_SIZE = 1100 };

typedef struct sf_cfh_point {
    double height;  /* m */
    double speed;   /* m s-1, at contact */
    bool failed;    /* no figures: the simulation failed, or its verdict is "do not use"; only height, speed,
                       grade and note are set */
    bool on_anvil;  /* it failed as the missile reached the anvil: worse than every limit */
    sf_grade grade; /* of the run; "do not use" if it failed */
    double value[SF_CFH_CRITERIA]; /* g, - */
    double v_rebound;              /* m s-1, NaN: contact had not ended */
    double max_indentation;        /* m */
    double max_local_strain;       /* - */
    double energy_error;           /* - */
    char note[SF_CFH_NOTE_SIZE];   /* sentence, or "" */
} sf_cfh_point;

typedef struct sf_cfh_points {
    int count;
    sf_cfh_point point[SF_CFH_MAX_POINTS];
} sf_cfh_points;

typedef enum sf_cfh_verdict {
    SF_CFH_FOUND,
    SF_CFH_ABOVE,   /* no limit was reached: the critical height is above the highest point, and below `anvil`
                     */
    SF_CFH_BELOW,   /* a limit was exceeded, or the anvil reached, at the lowest point: it is below that */
    SF_CFH_UNKNOWN, /* no simulation succeeded or reached the anvil, or no crossing could be read: `problem`
                       says why */
} sf_cfh_verdict;

typedef struct sf_cfh_result {
    sf_cfh_verdict verdict;
    sf_cfh_criterion deciding; /* of FOUND and BELOW; unless `lowest` is NaN */
    double lowest, highest;    /* m, of the simulations that succeeded, below `anvil`; NaN: none */
    double anvil;              /* m, lowest height from which the missile reached the anvil; NaN: none */
    sf_cfh_crossing crossing[SF_CFH_CRITERIA];
    sf_error problem; /* of UNKNOWN */
} sf_cfh_result;

/* Inserts a point in order of height; the caller ensures that there is room. */
void sf_cfh_points_add(sf_cfh_points *points, const sf_cfh_point *point);

/* The crossings with limit[SF_CFH_CRITERIA], and which of them decides: the lowest. */
void sf_cfh_evaluate(const sf_cfh_points *points, const double *limit, sf_cfh_result *result);

/* "a_max" and "HIC"; " g" and "" (units with a blank before them). Static storage. */
const char *sf_cfh_name(sf_cfh_criterion criterion);
const char *sf_cfh_unit(sf_cfh_criterion criterion);

/* Height on the rig (m) for one of free fall, and the half-width of the 95 % interval of its logarithm when
 * that of the height is `margin`. */
double sf_cfh_rig_height(const sf_cfh_rig *rig, double height);
double sf_cfh_rig_margin(const sf_cfh_rig *rig, double margin);

#endif
