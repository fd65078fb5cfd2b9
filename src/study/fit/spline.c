/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/spline.h"

#include <gsl/gsl_matrix.h>
#include <math.h>
#include <stdbool.h>

static const double STRENGTH = 0.85; /* width at the ends over width in the middle: (1 - .) / (1 + .) */
static const double FOOT = 0.02;     /* strain over which a foam leaves its linear range */
static const double DENSE = 3; /* intervals per e-fold of the room left, to those per e-fold of the strain */

/* Intervals up to a strain, but for a factor. */
static double foam_number(double strain) {
    double x = fmax(0, strain);
    return log1p(x / FOOT) - DENSE * log1p(-x);
}

static double foam_place(double low, double high, double part) {
    double from = foam_number(low), goal = from + part * (foam_number(high) - from), a = low, b = high;
    for (int k = 0; k < 50; k++) {
        double middle = 0.5 * (a + b);
        *(foam_number(middle) < goal ? &a : &b) = middle;
    }
    return 0.5 * (a + b);
}

double sf_spline_grade(sf_spline_grading grading, double low, double high, double part) {
    if (grading == SF_GRADING_FOAM)
        return part <= 0 ? low : part >= 1 ? high : foam_place(low, high, part);
    return low + (high - low) * (part - STRENGTH * sin(2 * M_PI * part) / (2 * M_PI));
}

double sf_spline_part(double high, double strain) {
    return foam_number(strain) / foam_number(high);
}

static bool enough(double low, double high, int set_count, const sf_spline_data *sets) {
    for (int k = 0; k < set_count; k++) {
        int inside = 0;
        for (int i = 0; i < sets[k].count; i++)
            inside += sets[k].x[i] >= low && sets[k].x[i] < high;
        if (inside < 2)
            return false;
    }
    return true;
}

int sf_spline_place(sf_spline_grading grading, int intervals, double low, double high, int set_count,
                    const sf_spline_data *sets, double breaks[SF_SPLINE_BREAKS]) {
    int count = 1;
    breaks[0] = low;
    for (int k = 1; k < intervals && count < SF_SPLINE_BREAKS - 1; k++) {
        double place = sf_spline_grade(grading, low, high, (double)k / intervals);
        if (enough(breaks[count - 1], place, set_count, sets))
            breaks[count++] = place;
    }
    while (count > 1 && !enough(breaks[count - 1], high, set_count, sets))
        count--;
    breaks[count++] = high;
    return count;
}

sf_status sf_spline_init(sf_spline *spline, int break_count, const double *breaks, sf_error *err) {
    *spline = (sf_spline){.count = break_count + SF_SPLINE_ORDER - 2};
    size_t n = (size_t)spline->count, b = (size_t)break_count;
    spline->base = gsl_bspline_alloc(SF_SPLINE_ORDER, b);
    spline->primary = gsl_bspline_alloc(SF_SPLINE_ORDER + 1, b);
    spline->value = gsl_vector_alloc(n);
    spline->higher = gsl_vector_alloc(n + 1);
    spline->slope = gsl_matrix_alloc(n, 2);
    if (!spline->base || !spline->primary || !spline->value || !spline->higher || !spline->slope) {
        sf_spline_free(spline);
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a spline of %d coefficients", spline->count);
    }
    gsl_vector_const_view places = gsl_vector_const_view_array(breaks, b);
    gsl_bspline_knots(&places.vector, spline->base);
    gsl_bspline_knots(&places.vector, spline->primary);
    return SF_OK;
}

void sf_spline_free(sf_spline *spline) {
    if (spline->base) /* from GSL 2.8 on, gsl_bspline_free takes no NULL */
        gsl_bspline_free(spline->base);
    if (spline->primary)
        gsl_bspline_free(spline->primary);
    gsl_vector_free(spline->value);
    gsl_vector_free(spline->higher);
    gsl_matrix_free(spline->slope);
    *spline = (sf_spline){0};
}

void sf_spline_value(sf_spline *spline, double x, double *row) {
    gsl_bspline_eval(x, spline->value, spline->base);
    for (int j = 0; j < spline->count; j++)
        row[j] = gsl_vector_get(spline->value, (size_t)j);
}

void sf_spline_slope(sf_spline *spline, double x, double *row) {
    gsl_bspline_deriv_eval(x, 1, spline->slope, spline->base);
    for (int j = 0; j < spline->count; j++)
        row[j] = gsl_matrix_get(spline->slope, (size_t)j, 1);
}

/* The integral of B_j is (t_{j+4} - t_j)/4 times the sum of the splines of order 5 after the j-th (de Boor, A
 * practical guide to splines, chapter X). */
void sf_spline_integral(sf_spline *spline, double x, double *row) {
    const gsl_vector *t = spline->base->knots;
    double sum = 0;
    gsl_bspline_eval(x, spline->higher, spline->primary);
    for (int j = spline->count - 1; j >= 0; j--) {
        sum += gsl_vector_get(spline->higher, (size_t)j + 1);
        row[j] = sum * (gsl_vector_get(t, (size_t)j + SF_SPLINE_ORDER) - gsl_vector_get(t, (size_t)j)) /
                 SF_SPLINE_ORDER;
    }
}

double sf_spline_abscissa(const sf_spline *spline, int j) {
    return gsl_bspline_greville_abscissa((size_t)j, spline->base);
}
