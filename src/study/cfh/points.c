/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/points.h"

#include <assert.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_poly.h>
#include <string.h>

/* ---- rig, fits and crossings ---- */

static const double MAX_SPEED_RATIO = 1.03; /* to free fall: beyond it a pair is wrong, not merely measured */

double sf_cfh_speed(double free_fall_height) {
    return sqrt(2 * SF_STANDARD_GRAVITY * free_fall_height);
}

double sf_cfh_free_fall_height(double speed) {
    return speed * speed / (2 * SF_STANDARD_GRAVITY);
}

sf_cfh_rig sf_cfh_free_fall(void) {
    return (sf_cfh_rig){.gravity = SF_STANDARD_GRAVITY};
}

/* Least squares of speed^2 over 2 height through the origin. heights m, speeds m s-1. SF_ERR_INPUT: fewer
 * than two pairs, a number that is not positive, a speed above that of free fall (by more than 3 %). `name`
 * is where they come from, for the sentence. */
static sf_status fit_rig(const char *name, int pairs, const double *height, const double *speed,
                         sf_cfh_rig *rig, sf_error *err) {
    double x[SF_CFH_MAX_PAIRS], y[SF_CFH_MAX_PAIRS], variance = 0, residual = 0;
    if (pairs < 2 || pairs > SF_CFH_MAX_PAIRS)
        return SF_REFUSE(err, "%s has %d pairs of height and speed, 2 to %d are needed", name, pairs,
                         SF_CFH_MAX_PAIRS);
    for (int k = 0; k < pairs; k++) {
        if (!(height[k] > 0) || !(speed[k] > 0))
            return SF_REFUSE(err, "%s: pair %d, %g m and %g m/s, is not above 0", name, k + 1, height[k],
                             speed[k]);
        if (speed[k] > MAX_SPEED_RATIO * sf_cfh_speed(height[k]))
            return SF_REFUSE(err, "%s: pair %d, %g m/s from %g m, is faster than free fall (%.4g m/s)", name,
                             k + 1, speed[k], height[k], sf_cfh_speed(height[k]));
        x[k] = 2 * height[k];
        y[k] = speed[k] * speed[k];
    }
    gsl_fit_mul(x, 1, y, 1, (size_t)pairs, &rig->gravity, &variance, &residual);
    rig->pairs = pairs;
    rig->standard_error = sqrt(variance);
    rig->margin = gsl_cdf_tdist_Pinv(0.975, pairs - 1) * rig->standard_error / rig->gravity;
    return SF_OK;
}

static sf_status check_pair(const sf_table_point *p, sf_error *err) {
    if (p->index == SF_CFH_MAX_PAIRS)
        return SF_REFUSE(err, "%s:%d: more than %d pairs", p->path, p->line, SF_CFH_MAX_PAIRS);
    return SF_OK;
}

static const sf_table_layout layout = {.what = "rig",
                                       .kind = "rig",
                                       .column = {&sf_column_height, &sf_column_speed},
                                       .ragged = true,
                                       .check = check_pair};

sf_status sf_cfh_rig_read(const char *path, sf_cfh_rig *rig, sf_error *err) {
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    *rig = sf_cfh_free_fall();
    SF_TRY(sf_table_read(path, &layout, &table, err));
    fit_rig(path, (int)table.count, table.value[0], table.value[1], rig, err);
    memcpy(rig->interpretation, table.interpretation, sizeof rig->interpretation);
    return err->status;
}

static const double WINDOW = 0.47;      /* ln(1.6): how far from the crossing points belong to the fit */
static const double MAX_FALL = 0.02;    /* between two heights; less is the scatter of single runs */
static const double CONFIDENCE = 0.975; /* each side of the 95 % interval */

double sf_cfh_fit_at(const sf_cfh_fit *fit, double height) {
    return exp(gsl_poly_eval(fit->c, 3, log(height) - fit->centre));
}

static sf_status check_points(const char *name, int count, const double *height, const double *value,
                              sf_error *err) {
    double largest = 0, at = 0;
    for (int k = 0; k < count; k++) {
        if (!(value[k] > 0) || !isfinite(value[k]) || !(height[k] > (k ? height[k - 1] : 0)))
            return SF_REFUSE(err, "%s: point %d, %g at %g m, is not above 0 or out of order", name, k + 1,
                             value[k], height[k]);
        if (value[k] < (1 - MAX_FALL) * largest)
            return SF_FAIL(err, SF_ERR_NUMERIC,
                           "%s falls from %.4g at %.4g m to %.4g at %.4g m: it does not grow with the "
                           "height, so no critical height can be read",
                           name, largest, at, value[k], height[k]);
        if (value[k] > largest) {
            largest = value[k];
            at = height[k];
        }
    }
    return SF_OK;
}

/* The part of ln(height) between two points at which the chord of ln(value) reaches the limit. */
static double chord_share(double below, double above, double limit) {
    return log(limit / below) / log(above / below);
}

/* The run of points within the window, widened to the nearest four. */
static void choose_points(double centre, int count, const double *height, sf_cfh_fit *fit) {
    int first = 0, last = count - 1;
    while (last - first + 1 > SF_CFH_MIN_POINTS) {
        double below = centre - log(height[first]), above = log(height[last]) - centre;
        if (fmax(below, above) <= WINDOW)
            break;
        if (below > above)
            first++;
        else
            last--;
    }
    fit->first = first;
    fit->low = height[first];
    fit->high = height[last];
    fit->count = last - first + 1;
    fit->centre = centre;
}

static sf_status fit_quadratic(const double *height, const double *value, sf_cfh_fit *fit, sf_error *err) {
    size_t n = (size_t)fit->count;
    double square_sum = 0;
    SF_OWNED double *design = sf_alloc(err, n, 4 * sizeof *design, "a fit");
    SF_TRY(err->status);
    double *y = design + 3 * n;
    for (size_t k = 0; k < n; k++) {
        double d = log(height[fit->first + (int)k]) - fit->centre;
        memcpy(&design[3 * k], (const double[]){1, d, d * d}, 3 * sizeof *design);
        y[k] = log(value[fit->first + (int)k]);
    }
    gsl_matrix_view x = gsl_matrix_view_array(design, n, 3),
                    covariance = gsl_matrix_view_array(fit->covariance[0], 3, 3);
    gsl_vector_view values = gsl_vector_view_array(y, n), c = gsl_vector_view_array(fit->c, 3);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, 3);
    if (!work ||
        gsl_multifit_linear(&x.matrix, &values.vector, &c.vector, &covariance.matrix, &square_sum, work) != 0)
        SF_FAIL(err, SF_ERR_LIBRARY, "GSL cannot fit a quadratic to %zu points", n);
    fit->rms = sqrt(square_sum / (double)n);
    gsl_multifit_linear_free(work);
    return err->status;
}

/* Distance from the fit's centre at which it rises through ln(limit); NaN: there is none in its points. */
static double rising_root(const sf_cfh_fit *fit, double limit) {
    double low = log(fit->low) - fit->centre, high = log(fit->high) - fit->centre, root[2];
    int count = gsl_poly_solve_quadratic(fit->c[2], fit->c[1], fit->c[0] - log(limit), &root[0], &root[1]);
    for (int k = 0; k < count; k++)
        if (root[k] >= low && root[k] <= high && fit->c[1] + 2 * fit->c[2] * root[k] > 0)
            return root[k];
    return NAN;
}

static double half_width(const sf_cfh_fit *fit, double d) {
    const double row[3] = {1, d, d * d};
    double variance = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            variance += row[i] * fit->covariance[i][j] * row[j];
    double quantile = gsl_cdf_tdist_Pinv(CONFIDENCE, fit->count - 3);
    return quantile * sqrt(fmax(variance, 0)) / (fit->c[1] + 2 * fit->c[2] * d);
}

static const double MISSES =
    0.03; /* residual of ln(value) of a quadratic that does not describe the points */

/* `below`: the last point before the first that reaches the limit. */
static void find_crossing(const double *height, const double *value, int below, double limit,
                          sf_cfh_crossing *out) {
    double d = rising_root(&out->fit, limit), centre = out->fit.centre;
    out->low = height[below];
    out->high = height[below + 1];
    out->bracketed =
        !(out->fit.rms <= MISSES) || !(exp(centre + d) >= out->low && exp(centre + d) <= out->high);
    if (out->bracketed) {
        out->height =
            out->low * pow(out->high / out->low, chord_share(value[below], value[below + 1], limit));
        out->margin = fmax(log(out->high / out->height), log(out->height / out->low));
        return;
    }
    out->height = exp(centre + d);
    out->margin = half_width(&out->fit, d);
    out->low = out->height * exp(-out->margin);
    out->high = out->height * exp(out->margin);
}

sf_status sf_cfh_cross(const char *name, int count, const double *height, const double *value, double limit,
                       sf_cfh_crossing *out, sf_error *err) {
    *out = (sf_cfh_crossing){.height = NAN, .margin = NAN, .low = NAN, .high = NAN};
    if (count < 1)
        return SF_REFUSE(err, "%s has no points", name);
    SF_TRY(check_points(name, count, height, value, err));
    int above = 0; /* the first point that reaches the limit */
    while (above < count && value[above] < limit)
        above++;
    out->side = above == count ? SF_CFH_NOT_REACHED : above > 0 ? SF_CFH_CROSSED : SF_CFH_EXCEEDED;
    bool crossed = out->side == SF_CFH_CROSSED;
    if (count < SF_CFH_MIN_POINTS && crossed)
        return SF_REFUSE(err, "%s has %d points for a crossing" SF_AT_LEAST("%d"), name, count,
                         SF_CFH_MIN_POINTS);
    if (count < SF_CFH_MIN_POINTS)
        return SF_OK;
    double centre = log(height[above > 0 ? above - 1 : 0]); /* of the crossing, or the end nearest to it */
    if (crossed)
        centre += chord_share(value[above - 1], value[above], limit) * log(height[above] / height[above - 1]);
    choose_points(centre, count, height, &out->fit);
    if (fit_quadratic(height, value, &out->fit, err) == SF_OK && crossed)
        find_crossing(height, value, above - 1, limit, out);
    return err->status;
}

void sf_cfh_points_add(sf_cfh_points *points, const sf_cfh_point *point) {
    int k = points->count++;
    assert(points->count <= SF_CFH_MAX_POINTS);
    for (; k > 0 && points->point[k - 1].height > point->height; k--)
        points->point[k] = points->point[k - 1];
    points->point[k] = *point;
}

const char *sf_cfh_name(sf_cfh_criterion criterion) {
    return criterion == SF_CFH_A_MAX ? "a_max" : "HIC";
}

const char *sf_cfh_unit(sf_cfh_criterion criterion) {
    return criterion == SF_CFH_A_MAX ? " g" : "";
}

double sf_cfh_rig_height(const sf_cfh_rig *rig, double height) {
    return height * SF_STANDARD_GRAVITY / rig->gravity;
}

double sf_cfh_rig_margin(const sf_cfh_rig *rig, double margin) {
    return hypot(margin, rig->margin);
}

/* The criterion of which a drop that failed exceeds the limit all the same; SF_CFH_CRITERIA: of none. */
static sf_cfh_criterion exceeded_by(const sf_cfh_point *p, const double *limit) {
    sf_cfh_criterion c = SF_CFH_A_MAX;
    while (c < SF_CFH_CRITERIA && !(p->failed && (p->on_anvil || p->least[c] >= limit[c])))
        c++;
    return c;
}

/* The points that succeeded, of one criterion, below one that failed and yet exceeds a limit. */
static int list_points(const sf_cfh_points *points, sf_cfh_criterion criterion, const double *limit,
                       double *height, double *value, const sf_cfh_point **exceeding) {
    int count = 0;
    *exceeding = NULL;
    for (int k = 0; k < points->count && !*exceeding; k++) {
        const sf_cfh_point *p = &points->point[k];
        height[count] = p->height;
        value[count] = p->value[criterion];
        count += !p->failed;
        *exceeding = exceeded_by(p, limit) < SF_CFH_CRITERIA ? p : NULL;
    }
    return count;
}

static void decide(sf_cfh_result *r) {
    r->verdict = SF_CFH_ABOVE;
    double lowest = INFINITY;
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->crossing[c];
        /* Exceeded at the lowest point is lower than any crossing above it. */
        double height = crossing->side == SF_CFH_EXCEEDED ? 0 : crossing->height;
        if (crossing->side == SF_CFH_NOT_REACHED || height >= lowest)
            continue;
        lowest = height;
        r->deciding = (sf_cfh_criterion)c;
        r->verdict = crossing->side == SF_CFH_EXCEEDED ? SF_CFH_BELOW : SF_CFH_FOUND;
    }
}

void sf_cfh_evaluate(const sf_cfh_points *points, const double *limit, sf_cfh_result *result) {
    *result = (sf_cfh_result){.lowest = NAN, .highest = NAN, .problem = SF_ERROR_INIT};
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        double height[SF_CFH_MAX_POINTS], value[SF_CFH_MAX_POINTS];
        sf_error problem = SF_ERROR_INIT;
        int count = list_points(points, c, limit, height, value, &result->exceeding);
        if (count > 0) {
            result->lowest = height[0];
            result->highest = height[count - 1];
        }
        if (sf_cfh_cross(sf_cfh_name(c), count, height, value, limit[c], &result->crossing[c], &problem) !=
                SF_OK &&
            result->problem.status == SF_OK)
            result->problem = problem;
    }
    bool none = isnan(result->lowest);
    if (none)
        result->problem = (sf_error)SF_ERROR_INIT;
    if (none && !result->exceeding)
        SF_FAIL(&result->problem, SF_ERR_NUMERIC, "no simulation succeeded");
    else if (none)
        result->deciding = exceeded_by(result->exceeding, limit);
    result->verdict = none ? SF_CFH_BELOW : SF_CFH_UNKNOWN;
    if (result->problem.status != SF_OK)
        result->verdict = SF_CFH_UNKNOWN;
    else if (!none)
        decide(result);
}

/* ---- the heights to simulate next ---- */

static const double MIN_HEIGHT = 0.01;    /* m */
static const double GRAIN = 1e-3;         /* m, heights are multiples of it on the user's scale */
static const double FIRST_SLOPE = 1.2;    /* of ln(a_max) over ln(height), before two points tell */
static const double OVERSHOOT = 1.1;      /* so that a step to the limit goes a bit beyond it */
static const double LEAST_STEP = 0.1;     /* of ln(height) */
static const double LARGEST_STEP = 0.8;   /* likewise */
static const double CLOSEST = 0.04;       /* ln(height) between two points of the search */
static const double COLLAPSE_GAP = 0.1;   /* ln(height) between the last success and a failure */
static const double EXCEEDING_GAP = 0.02; /* likewise, where the failure exceeds a limit all the same */
static const double GOOD_MARGIN = 0.01;   /* of the interval of the crossing */
static const double NEAR = 0.15;          /* ln(height): a point beside the crossing */
static const double FIRST_GAP = 0.5;      /* of ln(height) between the first two drops */
static const double BESIDE = 0.08;        /* ln(height) of the first points beside the crossing */
static const double LEAST_GAP = 0.12;     /* of ln(height) between the two drops of a step */

/* The points nearest to the limits; NULL if there is none. */
typedef struct bracket {
    const sf_cfh_point *below, *above; /* highest without a limit reached below the lowest with one */
    const sf_cfh_point *beside;        /* the next one on the outer side of the only one of them */
    const sf_cfh_point *failed;        /* the lowest failure above `below` */
    bool exceeds;                      /* it exceeds a limit all the same */
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
            bool exceeds = !b.above && exceeded_by(p, plan->limit) < SF_CFH_CRITERIA;
            b.exceeds = exceeds && !b.failed;
            b.failed = b.failed ? b.failed : p;
            if (exceeds)
                break;
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

/* The heights from `low` to `high` in thirds of ln(height); none if they are too close for that. */
static void divide(const sf_cfh_plan *plan, double low, double high, sf_cfh_round *round) {
    double gap = log(high / low);
    for (int k = 1; k <= 2; k++) {
        double height = rounded(plan, low * exp(gap * k / 3)), last = round->count ? round->height[0] : low;
        if (height > last + 0.5 * plan->unit * GRAIN && height < high - 0.5 * plan->unit * GRAIN)
            round->height[round->count++] = height;
    }
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
    if (b->failed && log(b->failed->height / bottom) < (b->exceeds ? EXCEEDING_GAP : COLLAPSE_GAP))
        return SF_CFH_COLLAPSED;
    double length = step_length(plan, b->below, b->beside), height = bottom * exp(length);
    if (b->failed && height > sqrt(bottom * b->failed->height)) {
        divide(plan, bottom, b->failed->height, round);
        round->divides = b->exceeds;
        return round->count > 0 ? SF_CFH_SIMULATE : SF_CFH_COLLAPSED;
    }
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
            share = fmin(share, chord_share(b->below->value[c], b->above->value[c], plan->limit[c]));
    return log(b->below->height) + share * width;
}

static bool is_enough(const sf_cfh_result *now, double centre, const bracket *b) {
    const sf_cfh_crossing *first = &now->crossing[now->deciding];
    bool flanked = log(b->above->height) - centre <= NEAR && centre - log(b->below->height) <= NEAR;
    return now->verdict == SF_CFH_FOUND && flanked && first->margin <= GOOD_MARGIN;
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
        divide(plan, b->below->height, b->above->height, round);
        round->divides = true;
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
    int left = (round->divides ? SF_CFH_MAX_POINTS : plan->max_drops) - points->count;
    round->count = step != SF_CFH_SIMULATE ? 0 : round->count < left ? round->count : left;
    return step == SF_CFH_SIMULATE && left <= 0 ? SF_CFH_AT_CAP : step;
}

const char *sf_cfh_step_text(sf_cfh_step step) {
    static const char *const texts[] = {
        [SF_CFH_LIST_DONE] = "every height of the list was simulated",
        [SF_CFH_ENOUGH] = "there are enough points around the crossing",
        [SF_CFH_AT_MAX_HEIGHT] = "no limit is reached up to the greatest height allowed (--max-height)",
        [SF_CFH_AT_MIN_HEIGHT] = "a limit is exceeded down to 1 cm",
        [SF_CFH_COLLAPSED] =
            "no limit is reached up to the height at which the simulation fails, reaches the anvil or is not to be used",
        [SF_CFH_AT_CAP] = "the number of drops is at its cap"};
    return texts[step];
}
