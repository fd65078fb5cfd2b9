/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/search.h"

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
static const double FIRST_GAP = 0.5;    /* of ln(height) between the first two drops */
static const double BESIDE = 0.08;      /* ln(height) of the first points beside the crossing */
static const double LEAST_GAP = 0.12;   /* of ln(height) between the two drops of a step */

/* The points nearest to the limits; NULL if there is none. */
typedef struct bracket {
    const sf_cfh_point *below, *above; /* highest without a limit reached below the lowest with one */
    const sf_cfh_point *beside;        /* the next one on the outer side of the only one of them */
    const sf_cfh_point *failed;        /* the lowest failure above `below` */
} bracket;

/* Returns by how much in ln(a_max) the limits are exceeded; HIC counts half, as it grows about twice as
 * fast. */
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

static bool is_free(const sf_cfh_plan *plan, const sf_cfh_points *points, const sf_cfh_round *round,
                    double height) {
    bool free = height <= plan->max_height && height >= MIN_HEIGHT;
    for (int k = 0; k < points->count; k++) {
        const sf_cfh_point *p = &points->point[k];
        free = free && fabs(log(p->height / height)) >= CLOSEST && !(p->failed && height > p->height);
    }
    for (int k = 0; k < round->count; k++)
        free = free && fabs(log(round->height[k] / height)) >= CLOSEST;
    return free;
}

/* Adds the first free one of `count` heights at distances of ln(height) from `from`. */
static bool add_free(const sf_cfh_plan *plan, const sf_cfh_points *points, double from, int count,
                     const double *distance, sf_cfh_round *round) {
    for (int k = 0; k < count; k++) {
        double height = rounded(plan, from * exp(distance[k]));
        if (!is_free(plan, points, round, height))
            continue;
        round->height[round->count++] = height;
        return true;
    }
    return false;
}

/* The first drop, and one above it; below if there is no room. */
static sf_cfh_step begin(const sf_cfh_plan *plan, const sf_cfh_points *points, sf_cfh_round *round) {
    const double distance[] = {FIRST_GAP, FIRST_GAP / 2, -FIRST_GAP};
    round->height[round->count++] = rounded(plan, plan->first);
    add_free(plan, points, round->height[0], 3, distance, round);
    return SF_CFH_SIMULATE;
}

/* A step up (`sign` 1) or down (-1) by `length` of ln(height), which leads a bit beyond the limit, and a
 * height on the way. The largest step may not reach it: then a height as far again ahead. */
static sf_cfh_step step_to(const sf_cfh_plan *plan, const sf_cfh_points *points, double to, int sign,
                           double length, sf_cfh_round *round) {
    double second = length < LARGEST_STEP ? -sign * fmax(LEAST_GAP, length / 2) : sign * LARGEST_STEP;
    const double distance[] = {second, -second};
    round->height[round->count++] = to;
    add_free(plan, points, to, 2, distance, round);
    return SF_CFH_SIMULATE;
}

/* Two thirds of ln(height) on the way to where simulations fail, and one third. */
static sf_cfh_step divide(const sf_cfh_plan *plan, double bottom, double failed, sf_cfh_round *round) {
    double gap = log(failed / bottom);
    for (int k = 1; k <= 2; k++)
        round->height[round->count++] = rounded(plan, bottom * exp(gap * k / 3));
    return SF_CFH_SIMULATE;
}

static sf_cfh_step go_up(const sf_cfh_plan *plan, const sf_cfh_points *points, const bracket *b,
                         sf_cfh_round *round) {
    if (!b->below) { /* nothing but failures */
        double height = rounded(plan, b->failed->height / 2);
        return height < MIN_HEIGHT ? SF_CFH_COLLAPSED
                                   : step_to(plan, points, height, -1, LARGEST_STEP, round);
    }
    double bottom = b->below->height;
    if (bottom >= plan->max_height * (1 - 1e-9))
        return SF_CFH_AT_MAX_HEIGHT;
    if (b->failed && log(b->failed->height / bottom) < COLLAPSE_GAP)
        return SF_CFH_COLLAPSED;
    double length = step_length(plan, b->below, b->beside), height = bottom * exp(length);
    if (b->failed && height > sqrt(bottom * b->failed->height))
        return divide(plan, bottom, b->failed->height, round);
    return step_to(plan, points, rounded(plan, height), 1, length, round);
}

static sf_cfh_step go_down(const sf_cfh_plan *plan, const sf_cfh_points *points, const bracket *b,
                           sf_cfh_round *round) {
    if (b->above->height <= MIN_HEIGHT)
        return SF_CFH_AT_MIN_HEIGHT;
    double length = step_length(plan, b->above, b->beside), height = b->above->height * exp(-length);
    return step_to(plan, points, rounded(plan, fmax(height, MIN_HEIGHT)), -1, length, round);
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

static bool is_enough(const sf_cfh_result *now, double centre, const bracket *b) {
    const sf_cfh_crossing *first = &now->crossing[now->deciding];
    bool flanked = log(b->above->height) - centre <= NEAR && centre - log(b->below->height) <= NEAR;
    return now->verdict == SF_CFH_FOUND && flanked && first->margin <= GOOD_MARGIN;
}

/* The bracket in thirds, where a quadratic does not describe the points; none if it is too narrow for that.
 */
static void divide_bracket(const sf_cfh_plan *plan, const bracket *b, sf_cfh_round *round) {
    double low = b->below->height, high = b->above->height, gap = log(high / low);
    for (int k = 1; k <= 2; k++) {
        double height = rounded(plan, low * exp(gap * k / 3)), last = round->count ? round->height[0] : low;
        if (height > last + 0.5 * plan->unit * GRAIN && height < high - 0.5 * plan->unit * GRAIN)
            round->height[round->count++] = height;
    }
}

/* Two free places around the crossing: one on each side, then from its middle outwards. */
static sf_cfh_step go_near(const sf_cfh_plan *plan, const sf_cfh_points *points, const bracket *b,
                           sf_cfh_round *round) {
    const double below = -BESIDE, above = BESIDE;
    static const double places[] = {0, 0.12, -0.12, 0.25, -0.25, 0.06, -0.06, 0.18, -0.18, 0.35, -0.35};
    enum { PLACES = sizeof places / sizeof places[0] };
    sf_cfh_result now;
    sf_cfh_evaluate(points, plan->limit, &now);
    bool found = now.verdict == SF_CFH_FOUND;
    double centre = found ? log(now.crossing[now.deciding].height) : chord_crossing(plan, b);
    if (is_enough(&now, centre, b))
        return SF_CFH_ENOUGH;
    if (found && now.crossing[now.deciding].bracketed) {
        divide_bracket(plan, b, round);
        return round->count > 0 ? SF_CFH_SIMULATE : SF_CFH_ENOUGH;
    }
    add_free(plan, points, exp(centre), 1, &below, round);
    add_free(plan, points, exp(centre), 1, &above, round);
    while (round->count < 2 && add_free(plan, points, exp(centre), PLACES, places, round))
        ;
    return round->count > 0 ? SF_CFH_SIMULATE : SF_CFH_ENOUGH;
}

static sf_cfh_step next_of_list(const sf_cfh_plan *plan, const sf_cfh_points *points, sf_cfh_round *round) {
    if (points->count == plan->list_count)
        return SF_CFH_LIST_DONE;
    for (int k = points->count; k < plan->list_count; k++)
        round->height[round->count++] = plan->list[k];
    return SF_CFH_SIMULATE;
}

sf_cfh_step sf_cfh_next(const sf_cfh_plan *plan, const sf_cfh_points *points, sf_cfh_round *round) {
    *round = (sf_cfh_round){0};
    if (plan->list_count > 0)
        return next_of_list(plan, points, round);
    const bracket b = find_bracket(plan, points);
    sf_cfh_step step = points->count == 0 ? begin(plan, points, round)
                       : !b.above         ? go_up(plan, points, &b, round)
                       : !b.below         ? go_down(plan, points, &b, round)
                                          : go_near(plan, points, &b, round);
    int left = plan->max_drops - points->count;
    round->count = step != SF_CFH_SIMULATE ? 0 : round->count < left ? round->count : left;
    return step == SF_CFH_SIMULATE && left <= 0 ? SF_CFH_AT_CAP : step;
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
