/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/points.h"

#include "base/units.h"
#include <assert.h>
#include <math.h>

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

static double anvil_height(const sf_cfh_points *points) {
    for (int k = 0; k < points->count; k++)
        if (points->point[k].on_anvil)
            return points->point[k].height;
    return NAN;
}

/* The points that succeeded, of one criterion, below a drop that ended on the anvil. */
static int list_points(const sf_cfh_points *points, sf_cfh_criterion criterion, double *height,
                       double *value) {
    int count = 0;
    for (int k = 0; k < points->count && !points->point[k].on_anvil; k++) {
        if (points->point[k].failed)
            continue;
        height[count] = points->point[k].height;
        value[count++] = points->point[k].value[criterion];
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
    *result = (sf_cfh_result){
        .lowest = NAN, .highest = NAN, .anvil = anvil_height(points), .problem = SF_ERROR_INIT};
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        double height[SF_CFH_MAX_POINTS], value[SF_CFH_MAX_POINTS];
        sf_error problem = SF_ERROR_INIT;
        int count = list_points(points, c, height, value);
        if (count > 0) {
            result->lowest = height[0];
            result->highest = height[count - 1];
        }
        if (sf_cfh_cross(sf_cfh_name(c), count, height, value, limit[c], &result->crossing[c], &problem) !=
                SF_OK &&
            result->problem.status == SF_OK)
            result->problem = problem;
    }
    if (isnan(result->lowest)) {
        result->problem = (sf_error)SF_ERROR_INIT;
        if (!isnan(result->anvil)) {
            result->verdict = SF_CFH_BELOW;
            return;
        }
        SF_FAIL(&result->problem, SF_ERR_NUMERIC, "no simulation succeeded");
    }
    if (result->problem.status == SF_OK)
        decide(result);
    else
        result->verdict = SF_CFH_UNKNOWN;
}
