/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a quantity that grows with the drop height reaches its limit: a quadratic of ln(value) in ln(height)
 * through the simulated points near the limit, its crossing, and the crossing's confidence interval. */
#ifndef SF_CFH_CROSSING_H
#define SF_CFH_CROSSING_H

#include "base/error.h"

enum { SF_CFH_MIN_POINTS = 4 }; /* of a fit: a quadratic and one degree of freedom */

/* ln(value) = c[0] + c[1] d + c[2] d^2, d = ln(height) - centre. */
typedef struct sf_cfh_fit {
    int count; /* points in the fit, 0: no fit */
    int first; /* index of the lowest of them */
    double centre;
    double c[3];
    double covariance[3][3];
    double rms; /* -, of the residuals of ln(value) */
} sf_cfh_fit;

typedef enum sf_cfh_side {
    SF_CFH_CROSSED,     /* the limit lies between two points */
    SF_CFH_NOT_REACHED, /* every point is below the limit */
    SF_CFH_EXCEEDED,    /* every point is at or above it */
} sf_cfh_side;

typedef struct sf_cfh_crossing {
    sf_cfh_side side;
    double height;    /* m, NaN unless crossed */
    double margin;    /* -, half-width of the 95 % interval of ln(height) */
    double low, high; /* m, that interval */
    sf_cfh_fit fit;   /* without a crossing: of the points nearest the limit, if they are enough */
} sf_cfh_crossing;

/* height: [count] m, ascending; value: [count] positive. `name` is the quantity, for sentences. The fit takes
 * the points within a factor of 1.6 of the crossing, and at least the nearest four. The interval is that of
 * the fit (Student's t, first order): it measures how well a quadratic fits the points, not the error of the
 * model. Errors: SF_ERR_INPUT for points that are not as described, or fewer than four with a crossing among
 * them; SF_ERR_NUMERIC for values that fall by more than 2 % from one height to a greater one, or a fit that
 * does not rise through the limit. */
sf_status sf_cfh_cross(const char *name, int count, const double *height, const double *value, double limit,
                       sf_cfh_crossing *crossing, sf_error *err);

/* Value of the fit at a height (m). */
double sf_cfh_fit_at(const sf_cfh_fit *fit, double height);

#endif
