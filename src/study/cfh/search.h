/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which heights to simulate next: up or down in ln(height) until the limit that is met first lies between two
 * points, then on both sides of its crossing, where the quadratic needs them. Two heights at a time, which
 * may be simulated side by side. Depends on the points alone, so a search that is repeated, with whatever
 * number of drops at once, takes the same way. */
#ifndef SF_CFH_SEARCH_H
#define SF_CFH_SEARCH_H

#include "study/cfh/points.h"

typedef enum sf_cfh_step {
    SF_CFH_SIMULATE,      /* the heights given */
    SF_CFH_LIST_DONE,     /* every height of the list */
    SF_CFH_ENOUGH,        /* points on both sides, the crossing known to 1 % or no place left */
    SF_CFH_AT_MAX_HEIGHT, /* no limit reached up to the greatest height allowed */
    SF_CFH_AT_MIN_HEIGHT, /* a limit exceeded down to 1 cm */
    SF_CFH_COLLAPSED,     /* no limit reached up to where simulations fail */
    SF_CFH_AT_CAP,        /* as many drops as allowed */
} sf_cfh_step;

typedef struct sf_cfh_plan {
    double limit[SF_CFH_CRITERIA]; /* g, - */
    double first;                  /* m, height of the first drop */
    double max_height;             /* m */
    int max_drops;
    int list_count;                 /* a list instead of a search, 0: none */
    double list[SF_CFH_MAX_POINTS]; /* m, ascending */
    double unit; /* m of free fall for 1 m on the user's scale; heights are rounded there */
} sf_cfh_plan;

/* Heights that are simulated before the next are chosen. */
typedef struct sf_cfh_round {
    int count; /* 1 or 2 of a search; of a list all of it */
    double height[SF_CFH_MAX_POINTS];
} sf_cfh_round;

/* `round` is set for SF_CFH_SIMULATE. */
sf_cfh_step sf_cfh_next(const sf_cfh_plan *plan, const sf_cfh_points *points, sf_cfh_round *round);

/* Why the search ended, in words; static storage. */
const char *sf_cfh_step_text(sf_cfh_step step);

#endif
