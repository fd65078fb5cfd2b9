/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cfh/search.h"

#include <math.h>
#include <stddef.h>

static const double MIN_HEIGHT = 0.01;  /* m */
static const double GRAIN = 1e-3;       /* m, heights are multiples of it on the user's scale */
static const double FIRST_SLOPE = 1.2;  /* of ln(a_max) over ln(height), before two points tell */
static const double OVERSHOOT = 1.1;    /* so that a step to the limit goes a bit beyond it */
static const double LEAST_STEP = 0.1;   /* of ln(height) */
static const double LARGEST_STEP = 0.8; /* likewise */
static const double CLOSEST = 0.04;     /* ln(height) between two points of the search */
static const double COLLAPSE_GAP = 0.1; /* ln(height) between the last success and a failure */
static const double GOOD_MARGIN = 0.01; /* of the interval of the crossing */
static const double NEAR = 0.15;        /* ln(height): a point beside the crossing */
enum { GOOD_POINTS = 5 };               /* in the fit */

/* The points nearest to the limits; NULL if there is none. */
typedef struct bracket {
    const sf_cfh_point *below, *above; /* highest without a limit reached below the lowest with one */
    const sf_cfh_point *beside;        /* the next one on the outer side of the only one of them */
    const sf_cfh_point *failed;        /* the lowest failure above `below` */
} bracket;

/* How far in ln(a_max) the limits are exceeded; HIC counts half, as it grows about twice as fast. */
static double excess(const sf_cfh_plan *plan, const sf_cfh_point *p) {
    return fmax(log(p->value[SF_CFH_A_MAX] / plan->limit[SF_CFH_A_MAX]),
                log(p->value[SF_CFH_HIC] / plan->limit[SF_CFH_HIC]) / 2);
}

static bracket find_bracket(const sf_cfh_plan *plan, const sf_cfh_points *points) {
    bracket b = {0};
    const sf_cfh_point *after = NULL; /* the success after `above` */
    for (int k = 0; k < points->count; k++) {
        const sf_cfh_point *p = &points->point[k];
        if (p->failed) {
            b.failed = b.failed ? b.failed : p;
            continue;
        }
        if (b.above) {
            after = after ? after : p;
        } else if (excess(plan, p) >= 0) {
            b.above = p;
        } else {
            b.beside = b.below;
            b.below = p;
            b.failed = NULL;
        }
    }
    if (b.above)
        b.beside = b.below ? NULL : after;
    return b;
}

/* Distance in ln(height) from the only point to beyond the limit. */
static double step_length(const sf_cfh_plan *plan, const sf_cfh_point *from, const sf_cfh_point *beside) {
    double slope = FIRST_SLOPE;
    if (beside)
        slope = (excess(plan, from) - excess(plan, beside)) / log(from->height / beside->height);
    slope = fmin(fmax(slope, 0.5), 4);
    return fmin(fmax(OVERSHOOT * fabs(excess(plan, from)) / slope, LEAST_STEP), LARGEST_STEP);
}

static double rounded(const sf_cfh_plan *plan, double height) {
    return fmin(plan->unit * GRAIN * round(height / plan->unit / GRAIN), plan->max_height);
}

static sf_cfh_step go_up(const sf_cfh_plan *plan, const bracket *b, double *height) {
    if (!b->below) { /* nothing but failures */
        *height = rounded(plan, b->failed->height / 2);
        return *height < MIN_HEIGHT ? SF_CFH_COLLAPSED : SF_CFH_SIMULATE;
    }
    double bottom = b->below->height;
    if (bottom >= plan->max_height * (1 - 1e-9))
        return SF_CFH_AT_MAX_HEIGHT;
    *height = bottom * exp(step_length(plan, b->below, b->beside));
    if (b->failed && log(b->failed->height / bottom) < COLLAPSE_GAP)
        return SF_CFH_COLLAPSED;
    if (b->failed)
        *height = fmin(*height, sqrt(bottom * b->failed->height));
    *height = rounded(plan, *height);
    return SF_CFH_SIMULATE;
}

static sf_cfh_step go_down(const sf_cfh_plan *plan, const bracket *b, double *height) {
    if (b->above->height <= MIN_HEIGHT)
        return SF_CFH_AT_MIN_HEIGHT;
    *height = b->above->height * exp(-step_length(plan, b->above, b->beside));
    *height = rounded(plan, fmax(*height, MIN_HEIGHT));
    return SF_CFH_SIMULATE;
}

/* ln(height) at which the chord between the two points first meets a limit. */
static double chord_crossing(const sf_cfh_plan *plan, const bracket *b) {
    double share = 1, width = log(b->above->height / b->below->height);
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        if (b->above->value[c] >= plan->limit[c])
            share = fmin(share, log(plan->limit[c] / b->below->value[c]) /
                                    log(b->above->value[c] / b->below->value[c]));
    return log(b->below->height) + share * width;
}

static bool is_free(const sf_cfh_plan *plan, const sf_cfh_points *points, double height) {
    bool free = height <= plan->max_height && height >= MIN_HEIGHT;
    for (int k = 0; k < points->count; k++) {
        const sf_cfh_point *p = &points->point[k];
        free = free && fabs(log(p->height / height)) >= CLOSEST && !(p->failed && height > p->height);
    }
    return free;
}

/* The first free place around the crossing, from its middle outwards. */
static sf_cfh_step go_near(const sf_cfh_plan *plan, const sf_cfh_points *points, const bracket *b,
                           double *height) {
    static const double places[] = {0, 0.12, -0.12, 0.25, -0.25, 0.06, -0.06, 0.18, -0.18, 0.35, -0.35};
    sf_cfh_result now;
    sf_cfh_evaluate(points, plan->limit, &now);
    bool found = now.verdict == SF_CFH_FOUND;
    double centre = found ? log(now.crossing[now.deciding].height) : chord_crossing(plan, b);
    bool flanked = log(b->above->height) - centre <= NEAR && centre - log(b->below->height) <= NEAR;
    const sf_cfh_crossing *first = &now.crossing[now.deciding];
    if (found && flanked && first->fit.count >= GOOD_POINTS && first->margin <= GOOD_MARGIN)
        return SF_CFH_ENOUGH;
    for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
        *height = rounded(plan, exp(centre + places[k]));
        if (is_free(plan, points, *height))
            return SF_CFH_SIMULATE;
    }
    return SF_CFH_ENOUGH;
}

static sf_cfh_step next_of_list(const sf_cfh_plan *plan, const sf_cfh_points *points, double *height) {
    if (points->count == plan->list_count)
        return SF_CFH_LIST_DONE;
    *height = plan->list[points->count];
    return SF_CFH_SIMULATE;
}

sf_cfh_step sf_cfh_next(const sf_cfh_plan *plan, const sf_cfh_points *points, double *height) {
    if (plan->list_count > 0)
        return next_of_list(plan, points, height);
    if (points->count == 0) {
        *height = rounded(plan, plan->first);
        return SF_CFH_SIMULATE;
    }
    const bracket b = find_bracket(plan, points);
    sf_cfh_step step = !b.above   ? go_up(plan, &b, height)
                       : !b.below ? go_down(plan, &b, height)
                                  : go_near(plan, points, &b, height);
    return step == SF_CFH_SIMULATE && points->count >= plan->max_drops ? SF_CFH_AT_CAP : step;
}

const char *sf_cfh_step_text(sf_cfh_step step) {
    switch (step) {
    case SF_CFH_LIST_DONE:
        return "every height of the list was simulated";
    case SF_CFH_AT_MAX_HEIGHT:
        return "no limit is reached up to the greatest height allowed (--max-height)";
    case SF_CFH_AT_MIN_HEIGHT:
        return "a limit is exceeded down to 1 cm";
    case SF_CFH_COLLAPSED:
        return "no limit is reached up to the height at which the simulation fails, reaches the anvil or is not to be used";
    case SF_CFH_AT_CAP:
        return "the number of drops is at its cap";
    default:
        return "there are enough points around the crossing";
    }
}
