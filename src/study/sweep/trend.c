/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/flight.h"
#include "study/sweep/adaptive.h"

#include <gsl/gsl_multifit.h>

enum { MOST_DROPS = 64, LEVELS = 8 };
static const double SAME_PROFILE = 0.02, NEAR_PROFILE = 0.05, SAME_THICKNESS = 0.01; /* relative */
static const double AREA = 1.35; /* of the columns, over that below the missile: the foam beside it carries */

int sf_sweep_trend_find(const char *figure) {
    static const char *const names[] = {[SF_TREND_A_MAX] = "a_max_g",
                                        [SF_TREND_HIC] = "hic",
                                        [SF_TREND_REBOUND] = "v_rebound_m_s",
                                        [SF_TREND_STRAIN] = "max_mean_strain",
                                        [SF_TREND_INDENTATION] = "max_indentation_mm"};
    for (int k = 0; k < SF_TREND_CONTACT; k++)
        if (names[k] && strcmp(names[k], figure) == 0)
            return k;
    return -1;
}

/* ---- the pad and the missile ---- */

/* A finished drop by which they are learnt. */
typedef struct drop {
    int64_t row;
    sf_columns columns;
} drop;

/* Lists up to MOST_DROPS; returns how many. */
static int read_drops(const sf_runs *runs, const char *folder, drop *list) {
    int count = 0;
    for (int64_t row = 0; row < runs->count && count < MOST_DROPS; row++) {
        if (runs->state[row] != SF_SWEEP_DONE || !runs->folder[row])
            continue;
        SF_OWNED_BY(sf_results_close) sf_results r = {0};
        SF_PRINTED(path, PATH_MAX, "%s/%s/results.h5", folder, runs->folder[row]);
        list[count].row = row;
        count += sf_results_open(path, &r, SF_IGNORED) == SF_OK &&
                 sf_columns_build(&r, &list[count].columns, SF_IGNORED) == SF_OK;
    }
    return count;
}

/* Area (m2) of the missile up to a height; each column ends in the middle between its gap and the next. */
static double area_up_to(const sf_columns *c, double height) {
    double area = 0, low = 0;
    for (int k = 0; k < c->count && low < height; k++) {
        double high = k + 1 < c->count ? 0.5 * (c->gap[k] + c->gap[k + 1]) : 2 * c->gap[k] - low;
        area += c->area[k] * fmin(1, (height - low) / (high - low));
        low = high;
    }
    return area;
}

static bool is_same_profile(const sf_columns *a, const sf_columns *b, double slack) {
    double least = fmin(a->thickness, b->thickness);
    for (int k = 1; k <= LEVELS; k++) {
        double p = area_up_to(a, least * k / LEVELS), q = area_up_to(b, least * k / LEVELS);
        if (fabs(p - q) > slack * fmax(p, q) + area_up_to(a, a->thickness) / SF_COLUMNS)
            return false;
    }
    return true;
}

static void list_numbers(sf_sweep_trend *t) {
    for (int f = 0; f < t->plan->factor_count; f++)
        if (!t->plan->factor[f].words && strncmp(t->plan->factor[f].key, "geometry", 8) == 0)
            t->number[t->numbers++] = f;
}

/* Least squares of a number [count] of the drops, NaN where one has none, in the factors of the geometry: the
 * terms c. False: so few drops have it that the fit has no use. */
static bool fit_linear(const sf_sweep_trend *t, const drop *list, int count, const double *value, double *c,
                       sf_error *err) {
    double design[MOST_DROPS * (SF_SWEEP_FACTORS + 1)], known[MOST_DROPS],
        square[(SF_SWEEP_FACTORS + 1) * (SF_SWEEP_FACTORS + 1)], squares;
    size_t terms = (size_t)t->numbers + 1, n = 0, rank = 0;
    for (int i = 0; i < count; i++) {
        if (isnan(value[i]))
            continue;
        known[n] = value[i];
        design[n * terms] = 1;
        for (size_t k = 1; k < terms; k++)
            design[n * terms + k] = sf_plan_value(t->plan, t->number[k - 1], list[i].row);
        n++;
    }
    if (n < terms)
        return false;
    gsl_matrix_view x = gsl_matrix_view_array(design, n, terms),
                    covariance = gsl_matrix_view_array(square, terms, terms);
    gsl_vector_view y = gsl_vector_view_array(known, n), terms_of = gsl_vector_view_array(c, terms);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(n, terms);
    if (!work)
        SF_NO_MEMORY(err, "the geometry of the drops");
    else
        gsl_multifit_linear_tsvd(&x.matrix, &y.vector, 1e-10, &terms_of.vector, &covariance.matrix, &squares,
                                 &rank, work);
    gsl_multifit_linear_free(work);
    return work != NULL;
}

/* The areas between heights, of each level from the drops whose columns, which end with the pad, reach it. Of
 * levels that hardly any pad has they are those below. */
static void fit_profile(sf_sweep_trend *t, const drop *list, int count, sf_error *err) {
    double area[MOST_DROPS], top = 0;
    for (int i = 0; i < count; i++)
        top = fmax(top, list[i].columns.thickness);
    t->step = top / SF_COLUMNS;
    for (int k = 0; k < SF_COLUMNS && err->status == SF_OK; k++) {
        int reach = 0;
        for (int i = 0; i < count; i++) {
            const sf_columns *c = &list[i].columns;
            bool reaches = c->thickness >= (k + 1) * t->step * (1 - 1e-9);
            area[i] = reaches ? area_up_to(c, (k + 1) * t->step) - area_up_to(c, k * t->step) : NAN;
            reach += reaches;
        }
        if (k > 0 && reach < t->numbers + 3)
            memcpy(t->profile[k], t->profile[k - 1], sizeof t->profile[k]);
        else
            fit_linear(t, list, count, area, t->profile[k], err);
    }
}

static double linear_at(const sf_sweep_trend *t, const double *c, int64_t row) {
    double sum = c[0];
    for (int k = 0; k < t->numbers; k++)
        sum += c[k + 1] * sf_plan_value(t->plan, t->number[k], row);
    return sum;
}

/* The columns of a row, with the mass and speed of the drop on the thickest pad. */
static sf_columns columns_at(const sf_sweep_trend *t, int64_t row) {
    sf_columns columns = t->columns;
    columns.thickness = linear_at(t, t->thickness, row);
    if (t->step > 0)
        columns.count = 0;
    for (int k = 0; k < SF_COLUMNS && t->step > 0; k++) {
        double area = linear_at(t, t->profile[k], row);
        if (!(area > 0))
            continue;
        columns.gap[columns.count] = (k + 0.5) * t->step;
        columns.area[columns.count++] = area;
    }
    return columns;
}

static const char *find_problem(const sf_sweep_trend *t, const drop *list, int count) {
    for (int k = 0; k < count; k++) {
        const sf_columns own = list[k].columns, told = columns_at(t, list[k].row);
        if (!is_same_profile(&told, &own, t->step > 0 ? NEAR_PROFILE : SAME_PROFILE))
            return "the missile's profile is not linear in the factors";
        if (fabs(told.thickness - own.thickness) > SAME_THICKNESS * own.thickness)
            return "the pad's thickness is not linear in the factors";
    }
    return NULL;
}

bool sf_sweep_is_beyond_columns(const sf_plan *plan) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    return sf_sweep_read_case(plan, 0, &c, SF_IGNORED) != SF_OK || c.layer_count > 0 || c.motion_count > 0;
}

sf_status sf_sweep_trend_learn(const sf_runs *runs, const char *folder, sf_sweep_trend *t, sf_error *err) {
    *t = (sf_sweep_trend){.plan = runs->plan, .problem = "no finished drop has columns"};
    if (sf_sweep_is_beyond_columns(runs->plan)) {
        t->problem = "columns have one material and a missile that falls";
        return SF_OK;
    }
    SF_OWNED drop *list = sf_alloc(err, MOST_DROPS, sizeof *list, "columns");
    int count = list && folder ? read_drops(runs, folder, list) : 0;
    list_numbers(t);
    if (count > t->numbers) {
        double thickness[MOST_DROPS] = {0};
        bool same = true;
        for (int k = 0; k < count; k++) {
            thickness[k] = list[k].columns.thickness;
            if (thickness[k] > t->columns.thickness) /* columns end with the pad */
                t->columns = list[k].columns;
            same = same && is_same_profile(&list[0].columns, &list[k].columns, SAME_PROFILE);
        }
        fit_linear(t, list, count, thickness, t->thickness, err);
        if (!same && err->status == SF_OK)
            fit_profile(t, list, count, err);
        t->problem = find_problem(t, list, count);
    }
    return err->status;
}

/* ---- a row ---- */

/* False: columns of `factor` times the area collapse. */
static bool respond_of_area(const sf_columns *columns, double factor, const sf_material_law *law, double *y) {
    sf_columns own = *columns;
    for (int k = 0; k < own.count; k++)
        own.area[k] *= factor;
    return sf_columns_expect(&own, law, y, SF_IGNORED) == SF_OK;
}

static void respond(const sf_sweep_trend *t, const sf_case *c, int64_t row, double *expected) {
    static const int place[] = {[SF_TREND_A_MAX] = SF_FIT_A_MAX,
                                [SF_TREND_HIC] = SF_FIT_HIC,
                                [SF_TREND_REBOUND] = SF_FIT_REBOUND,
                                [SF_TREND_STRAIN] = SF_COLUMNS_STRAIN,
                                [SF_TREND_INDENTATION] = SF_COLUMNS_STRAIN,
                                [SF_TREND_CONTACT] = SF_FIT_CONTACT,
                                [SF_TREND_BEYOND] = SF_COLUMNS_BEYOND};
    sf_columns columns = columns_at(t, row);
    double y[SF_COLUMNS_LOGARITHMS];
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    sf_error refused = SF_ERROR_INIT;
    columns.mass = c->missile_card.mass;
    columns.speed = -c->missile_card.speed * c->missile_card.direction[2];
    columns.informed = sf_material_informed(&c->material);
    if (columns.count == 0 || !(columns.thickness > 0) ||
        sf_material_law_build(&c->material, &law, &refused) != SF_OK)
        return;
    expected[SF_TREND_BEYOND] = 1;
    if (!respond_of_area(&columns, AREA, &law, y))
        return;
    for (int k = 0; k < SF_TREND_TIME; k++)
        if (k < SF_TREND_NARROWER || k >= SF_TREND_INDENTATION)
            expected[k] = y[place[k]] + (k == SF_TREND_INDENTATION ? log(columns.thickness) : 0);
    for (int wider = 0; wider < 2; wider++)
        if (respond_of_area(&columns, wider ? AREA * AREA : 1, &law, y))
            for (int k = 0; k < SF_TREND_NARROWER; k++)
                expected[(wider ? SF_TREND_WIDER : SF_TREND_NARROWER) + k] = y[place[k]] - expected[k];
}

sf_status sf_sweep_trend_at(const sf_sweep_trend *t, int64_t row, double *expected, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error refused = SF_ERROR_INIT;
    for (int k = 0; k < SF_TRENDS; k++)
        expected[k] = t->problem && k < SF_TREND_TIME ? 0 : NAN;
    if (sf_sweep_read_case(t->plan, row, &c, &refused) != SF_OK)
        return t->problem || refused.status == SF_ERR_INPUT ? SF_OK : (*err = refused, err->status);
    expected[SF_TREND_TIME] = log(1e3 * (c.run.end_time - sf_flight_time(&c.missile_card)));
    if (!t->problem)
        respond(t, &c, row, expected);
    return SF_OK;
}
