/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/spread.h"

#include "base/sets.h"
#include "io/process.h"
#include "study/fit/posterior/mixture.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>

static const double STEP = 0.035;        /* of ln(height) on the grid */
static const double OUTSIDE = 1.5;       /* factor by which it reaches beyond the simulated heights */
static const double TAIL = 0.025;        /* on each side of the interval */
static const double OUTERMOST = 0.05;    /* share of the outermost draws that are simulated */
enum { SEED = 1, RESPONSE_SEED = 1000 }; /* draw d (from 0) has RESPONSE_SEED + d for the responses */

/* ---- columns ---- */

/* ln of a_max and HIC of a drop. SF_ERR_NUMERIC: the columns collapse. */
static sf_status drop_columns(const sf_columns *pad, const sf_material_law *law, double height, double *value,
                              sf_error *err) {
    sf_columns columns = *pad;
    double y[SF_COLUMNS_LOGARITHMS];
    columns.speed = sf_cfh_speed(height);
    SF_TRY(sf_columns_expect(&columns, law, y, err));
    value[SF_CFH_A_MAX] = y[SF_FIT_A_MAX];
    value[SF_CFH_HIC] = y[SF_FIT_HIC];
    if (!isfinite(value[SF_CFH_A_MAX]) || !isfinite(value[SF_CFH_HIC]))
        return SF_FAIL(err, SF_ERR_NUMERIC, "the columns do not stop the missile");
    return SF_OK;
}

static sf_status drop_grid(const sf_cfh_spread *s, const sf_columns *pad, const sf_material_law *law,
                           sf_cfh_curve *draw, sf_error *err) {
    for (; draw->reach < s->grid; draw->reach++) {
        double y[SF_CFH_CRITERIA];
        if (sf_process_stopped())
            return sf_run_folder_interrupted(err);
        if (drop_columns(pad, law, s->height[draw->reach], y, err) != SF_OK)
            break;
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            draw->column[c][draw->reach] = y[c];
    }
    if (err->status == SF_ERR_NUMERIC)
        *err = (sf_error)SF_ERROR_INIT;
    return err->status;
}

static sf_status drop_draws(sf_cfh_spread *s, const sf_columns *pad, const sf_cfh_draws *draws,
                            sf_error *err) {
    SF_OWN(sf_error, errors, s->draws, "draws", err);
#pragma omp parallel for schedule(dynamic)
    for (int d = 0; d < s->draws; d++) {
        errors[d] = (sf_error)SF_ERROR_INIT;
        drop_grid(s, pad, &draws->draw[d].law, &s->draw[d], &errors[d]);
    }
    for (int d = 0; d < s->draws && err->status == SF_OK; d++)
        if (errors[d].status != SF_OK)
            *err = errors[d];
    return err->status;
}

/* ---- correction ---- */

/* Linear in ln h, constant outside. */
static double interpolate(int count, const double *height, const double *value, double at) {
    int k = 0;
    if (at <= height[0])
        return value[0];
    if (at >= height[count - 1])
        return value[count - 1];
    while (height[k + 1] < at)
        k++;
    return value[k] + (value[k + 1] - value[k]) * log(at / height[k]) / log(height[k + 1] / height[k]);
}

/* The heights of the grid: to a factor beyond the simulated ones. */
static void make_grid(sf_cfh_spread *s) {
    double low = s->drop[0].height / OUTSIDE, high = s->drop[s->own - 1].height, span;
    s->simulated[0] = s->drop[0].height;
    s->simulated[1] = high;
    span = log(OUTSIDE * high / low);
    s->grid = (int)fmin(SF_CFH_GRID, ceil(span / STEP) + 1);
    for (int k = 0; k < s->grid; k++)
        s->height[k] = low * exp(span * k / (s->grid - 1));
}

/* The drops of the case's own material that have figures, with their columns. */
static sf_status list_drops(sf_cfh_spread *s, const sf_columns *pad, const sf_material_law *own,
                            const sf_cfh_points *points, sf_error *err) {
    double height[SF_CFH_MAX_POINTS], scatter[SF_CFH_CRITERIA][SF_CFH_MAX_POINTS];
    for (int k = 0; k < points->count && !points->point[k].on_anvil; k++) {
        const sf_cfh_point *p = &points->point[k];
        sf_cfh_drop *drop = &s->drop[s->own];
        sf_error collapse = SF_ERROR_INIT;
        if (p->failed)
            continue;
        if (drop_columns(pad, own, p->height, drop->column, &collapse) != SF_OK) {
            if (collapse.status != SF_ERR_NUMERIC)
                *err = collapse;
            continue;
        }
        drop->height = height[s->own] = p->height;
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            drop->value[c] = log(p->value[c]);
            scatter[c][s->own] = p->scatter[c];
        }
        s->own++;
    }
    SF_TRY(err->status);
    if (s->own == 0)
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "there is no simulated height at which the columns of the case's material, "
                       "which stand for the draws, have figures");
    make_grid(s);
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        for (int k = 0; k < s->grid; k++)
            s->scatter[c][k] = interpolate(s->own, height, scatter[c], s->height[k]);
    return SF_OK;
}

/* The inputs of a process: ln(height) and, of several foams, the columns' figures, which tell them apart. */
static void put_inputs(double height, const double *column, double *x) {
    x[0] = log(height);
    memcpy(x + 1, column, SF_CFH_CRITERIA * sizeof *x);
}

static void correct_draw(const sf_cfh_spread *s, const sf_predictor *p, int criterion, sf_cfh_curve *draw) {
    double x[1 + SF_CFH_CRITERIA], room[SF_CFH_DROPS], mean;
    for (int k = 0; k < s->grid; k++) {
        const double column[] = {draw->column[SF_CFH_A_MAX][k], draw->column[SF_CFH_HIC][k]};
        put_inputs(s->height[k], column, x);
        draw->value[criterion][k] = draw->sd[criterion][k] = INFINITY;
        if (k >= draw->reach)
            continue;
        sf_predictor_at(p, x, room, &mean, &draw->sd[criterion][k]);
        draw->value[criterion][k] = column[criterion] + mean;
    }
}

/* Corrects the draws by a process of the simulated drops. A single drop, which has no process, counts twice.
 */
static sf_status correct_draws(sf_cfh_spread *s, sf_error *err) {
    static const bool words[1 + SF_CFH_CRITERIA] = {false};
    double x[SF_CFH_DROPS + 1][1 + SF_CFH_CRITERIA], at[SF_CFH_DROPS + 1], y[SF_CFH_DROPS + 1];
    int drops = s->own, inputs = 1, count;
    for (int k = 0; k < s->checks; k++)
        if (!s->check[k].failed && isfinite(s->check[k].simulated[0])) {
            s->drop[drops++] = s->check[k].drop;
            inputs = 1 + SF_CFH_CRITERIA;
        }
    s->freedom = inputs > 1 ? drops - 1 : 0;
    count = drops > 1 ? drops : 2;
    for (int c = 0; c < SF_CFH_CRITERIA && err->status == SF_OK; c++) {
        SF_OWNED_BY(sf_predictor_free) sf_predictor p = {0};
        for (int k = 0; k < count; k++) {
            const sf_cfh_drop *drop = &s->drop[k % drops];
            put_inputs(drop->height, drop->column, x[k]);
            at[k] = x[k][0];
            y[k] = drop->value[c] - drop->column[c];
        }
        if (sf_predictor_fit(inputs, words, count, inputs > 1 ? x[0] : at, y, &p, err) == SF_OK)
            for (int d = 0; d < s->draws; d++)
                correct_draw(s, &p, c, &s->draw[d]);
    }
    return err->status;
}

/* ---- crossings ---- */

/* Returns the height at which a draw first reaches ln(limit) less `raise`. Collapsed columns reach every
 * limit, at the last height before. */
static double cross(const sf_cfh_spread *s, const sf_cfh_curve *draw, int criterion, double raise) {
    const double *y = draw->value[criterion];
    double target = log(s->limit[criterion]) - raise;
    int k = 0;
    while (k < draw->reach && y[k] < target)
        k++;
    if (k == 0)
        return 0;
    if (k == draw->reach)
        return k < s->grid ? s->height[k - 1] : INFINITY;
    double share = (target - y[k - 1]) / (y[k] - y[k - 1]);
    return s->height[k - 1] * pow(s->height[k] / s->height[k - 1], share);
}

/* Value of a draw [grid] at a height within its reach. */
static double at_height(const sf_cfh_spread *s, const sf_cfh_curve *draw, const double *value,
                        double height) {
    return interpolate(draw->reach, s->height, value, height);
}

/* True if the draw has a limit reached before its columns collapse. */
static bool reaches_limit(const sf_cfh_spread *s, const sf_cfh_curve *draw) {
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        for (int k = 0; k < draw->reach; k++)
            if (draw->value[c][k] >= log(s->limit[c]))
                return true;
    return false;
}

static void find_crossings(sf_cfh_spread *s) {
    s->above = s->below = s->collapsed = s->beyond = 0;
    for (int d = 0; d < s->draws; d++) {
        sf_cfh_curve *draw = &s->draw[d];
        double first = INFINITY;
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            first = fmin(first, draw->crossing[c] = cross(s, draw, c, 0));
        draw->crossing[SF_CFH_FIRST] = first;
        s->above += isinf(first);
        s->below += first <= 0;
        s->collapsed += draw->reach < s->grid && !reaches_limit(s, draw);
        s->beyond += first > 0 && isfinite(first) && (first < s->simulated[0] || first > s->simulated[1]);
    }
}

/* The columns' own error of each draw, where it reaches a limit first; without a check it is not known. */
static void find_errors(sf_cfh_spread *s) {
    for (int d = 0; d < s->draws; d++)
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            sf_cfh_curve *draw = &s->draw[d];
            draw->columns_sd[c] = s->freedom > 0 && draw->reach > 0
                                      ? at_height(s, draw, draw->sd[c], draw->crossing[SF_CFH_FIRST])
                                      : 0;
        }
}

/* ---- quantiles ---- */

/* Returns a quantile of sorted values, of which the first may be 0 and the last infinite: between those
 * and a value nothing is interpolated. */
static double quantile(const double *sorted, int count, double share) {
    double at = share * (count - 1);
    int k = (int)floor(at);
    if (k >= count - 1 || isinf(sorted[k]) || sorted[k] <= 0 || sorted[k + 1] == sorted[k])
        return sorted[k];
    return isinf(sorted[k + 1]) ? INFINITY : sorted[k] + (at - k) * (sorted[k + 1] - sorted[k]);
}

static sf_cfh_interval interval_of(double *values, int count) {
    gsl_sort(values, 1, (size_t)count);
    return (sf_cfh_interval){.low = quantile(values, count, TAIL),
                             .median = quantile(values, count, 0.5),
                             .high = quantile(values, count, 1 - TAIL)};
}

static sf_status find_bands(sf_cfh_spread *s, sf_error *err) {
    SF_OWN(double, values, s->draws, "draws", err);
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        for (int k = 0; k < s->grid; k++) {
            for (int d = 0; d < s->draws; d++)
                values[d] = exp(s->draw[d].value[c][k]);
            s->band[c][k] = interval_of(values, s->draws);
        }
    return SF_OK;
}

/* ---- errors of the responses ---- */

static void take_responses(sf_cfh_spread *s, const sf_cfh_draws *draws) {
    static const int kind[SF_CFH_CRITERIA] = {[SF_CFH_A_MAX] = SF_FIT_A_MAX, [SF_CFH_HIC] = SF_FIT_HIC};
    s->with_response = draws->with_response;
    for (int d = 0; d < s->draws && s->with_response; d++)
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            s->draw[d].shared[c] = draws->draw[d].response.shared[kind[c]];
            s->draw[d].own_sd[c] = draws->draw[d].response.own_sd[kind[c]];
        }
}

/* ---- build ---- */

sf_status sf_cfh_spread_build(const sf_cfh_pad *pad, const sf_cfh_draws *draws, const sf_material_law *own,
                              const sf_cfh_points *points, const sf_cfh_result *result, const double *limit,
                              sf_cfh_spread *s, sf_error *err) {
    *s = (sf_cfh_spread){.draws = draws->count, .mesh_error = pad->mesh_error};
    s->own_height = result->verdict == SF_CFH_FOUND ? result->crossing[result->deciding].height : NAN;
    memcpy(s->limit, limit, sizeof s->limit);
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_fit *fit = &result->crossing[c].fit;
        s->fit_scatter[c] = fit->count > 3 ? fit->rms * sqrt(fit->count / (fit->count - 3.0)) : NAN;
    }
    s->draw = sf_alloc(err, s->draws, sizeof *s->draw, "draws");
    if (s->draw && list_drops(s, &pad->columns, own, points, err) == SF_OK &&
        drop_draws(s, &pad->columns, draws, err) == SF_OK && correct_draws(s, err) == SF_OK) {
        take_responses(s, draws);
        find_crossings(s);
    }
    return err->status;
}

void sf_cfh_spread_free(sf_cfh_spread *s) {
    SF_CLEAR(s, s->draw);
}

/* ---- checks ---- */

typedef struct place {
    double height;
    int draw;
} place;

SF_ORDER_BY(compare_places, place, height, draw)

void sf_cfh_spread_choose(sf_cfh_spread *s, int count, double grain) {
    place places[SF_CFH_MOST_DRAWS];
    int n = 0;
    for (int d = 0; d < s->draws; d++) {
        double height = s->draw[d].crossing[SF_CFH_FIRST];
        if (height > 0 && isfinite(height))
            places[n++] = (place){height, d};
    }
    qsort(places, (size_t)n, sizeof *places, compare_places);
    s->checks = count < n ? count : n;
    for (int k = 0; k < s->checks; k++) {
        double share = s->checks == 1 ? 0.5 : OUTERMOST + (1 - 2 * OUTERMOST) * k / (s->checks - 1);
        int rank = (int)lround(share * (n - 1));
        const sf_cfh_curve *draw = &s->draw[places[rank].draw];
        sf_cfh_check *check = &s->check[k];
        *check = (sf_cfh_check){
            .draw = places[rank].draw,
            .share = (double)(s->below + rank) / s->draws,
            .height = fmax(grain, grain * round(places[rank].height / grain)),
            .first = draw->crossing[SF_CFH_HIC] < draw->crossing[SF_CFH_A_MAX] ? SF_CFH_HIC : SF_CFH_A_MAX,
            .simulated = {NAN, NAN},
            .error = {NAN, NAN}};
        check->drop.height = check->height;
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            check->columns[c] = exp(at_height(s, draw, draw->value[c], check->height));
            check->drop.column[c] = at_height(s, draw, draw->column[c], check->height);
        }
    }
}

void sf_cfh_check_take(const double *simulated, sf_cfh_check *check) {
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        check->simulated[c] = simulated[c];
        check->drop.value[c] = log(simulated[c]);
        check->error[c] = log(simulated[c] / check->columns[c]);
    }
}

/* ---- the random errors ---- */

/* The errors of one repeat of a draw. */
typedef struct errors {
    double response[SF_CFH_CRITERIA];
    double mesh, fit[SF_CFH_CRITERIA];
    double columns; /* Student's t, over the standard deviation of a criterion */
    double rig;
    double drop; /* of a single pad and drop, over the scatter of a criterion */
} errors;

static double or_none(double scatter) {
    return isnan(scatter) ? 0 : scatter;
}

static errors random_errors(const sf_cfh_spread *s, const sf_cfh_rig *rig, gsl_rng *random) {
    errors e = {.mesh = SF_CFH_MESH_SIZE * or_none(s->mesh_error) * gsl_ran_ugaussian(random)};
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        e.fit[c] = or_none(s->fit_scatter[c]) * gsl_ran_ugaussian(random);
    double share = gsl_rng_uniform_pos(random);
    e.columns = s->freedom > 0 ? gsl_cdf_tdist_Pinv(share, s->freedom) : 0;
    if (rig->pairs > 1)
        e.rig = gsl_ran_tdist(random, rig->pairs - 1) * rig->standard_error / rig->gravity;
    return e;
}

/* Draws the errors of the repeat `at`, from a generator of the draw. */
static void respond(const sf_cfh_spread *s, int at, gsl_rng *random, errors *e) {
    const sf_cfh_curve *r = &s->draw[at / SF_CFH_REPEATS];
    if (at % SF_CFH_REPEATS == 0)
        gsl_rng_set(random, (unsigned long)(RESPONSE_SEED + at / SF_CFH_REPEATS));
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        e->response[c] = r->shared[c] + r->own_sd[c] * gsl_ran_ugaussian(random);
}

static double raise_of(const sf_cfh_curve *draw, const errors *e, sf_cfh_part part, int criterion) {
    double raise = 0;
    if (part >= SF_CFH_PART_RESPONSE)
        raise += e->response[criterion];
    if (part >= SF_CFH_PART_MESH)
        raise += criterion == SF_CFH_HIC ? SF_CFH_MESH_HIC * e->mesh : e->mesh;
    if (part >= SF_CFH_PART_FIT)
        raise += e->fit[criterion];
    if (part >= SF_CFH_PART_COLUMNS)
        raise += e->columns * draw->columns_sd[criterion];
    return raise;
}

/* One repeat of a draw, at `at` of values [SF_CFH_FIRST + 2][count], the last of them on the rig. */
static void repeat(const sf_cfh_spread *s, const errors *e, const sf_cfh_rig *rig, sf_cfh_part part,
                   int count, int at, double *values) {
    const sf_cfh_curve *draw = &s->draw[at / SF_CFH_REPEATS];
    double first = INFINITY, own = draw->crossing[SF_CFH_FIRST];
    for (int c = 0; c < SF_CFH_CRITERIA; c++, values += count) {
        double scatter = or_none(interpolate(s->grid, s->height, s->scatter[c], own)),
               drop = part == SF_CFH_PARTS ? e->drop * scatter : 0;
        values[at] = cross(s, draw, c, raise_of(draw, e, part, c) + drop);
        first = fmin(first, values[at]);
    }
    values[at] = first;
    values[at + count] = sf_cfh_rig_height(rig, first) * exp(-e->rig);
}

/* The interval of heights, on the rig or not, of those looked at. */
static sf_cfh_interval height_interval(const sf_cfh_spread *s, double *values, int count, double scale) {
    sf_cfh_interval i = interval_of(values, count);
    i.end[0] = scale * s->height[0];
    i.end[1] = scale * s->height[s->grid - 1];
    return i;
}

/* The intervals of one part. values [SF_CFH_FIRST + 2][count], the last of them on the rig. */
static void evaluate_part(sf_cfh_spread *s, const sf_cfh_rig *rig, sf_cfh_part part, int count,
                          double *values, gsl_rng *random, gsl_rng *of_draw) {
    gsl_rng_set(random, SEED);
    for (int at = 0; at < count; at++) {
        errors e = random_errors(s, rig, random);
        respond(s, at, of_draw, &e);
        e.drop = part == SF_CFH_PARTS ? gsl_ran_ugaussian(random) : 0;
        repeat(s, &e, rig, part, count, at, values);
    }
    for (int c = 0; c <= SF_CFH_FIRST; c++)
        s->part[part][c] = height_interval(s, &values[(size_t)c * (size_t)count], count, 1);
}

sf_status sf_cfh_spread_evaluate(sf_cfh_spread *s, const sf_cfh_rig *rig, sf_error *err) {
    int count = s->draws * SF_CFH_REPEATS;
    SF_OWNED double *values =
        sf_alloc(err, (unsigned long)count * (SF_CFH_FIRST + 2), sizeof *values, "repeats of the draws");
    SF_RANDOM *random = sf_random(SEED, err), *of_draw = sf_random(RESPONSE_SEED, err);
    if (err->status == SF_OK && correct_draws(s, err) == SF_OK) {
        find_crossings(s);
        find_errors(s);
        find_bands(s, err);
        evaluate_part(s, rig, SF_CFH_PARTS, count, values, random, of_draw);
        for (int part = 0; part < SF_CFH_PARTS; part++)
            evaluate_part(s, rig, (sf_cfh_part)part, count, values, random, of_draw);
        s->rig = rig->pairs ? height_interval(s, &values[(size_t)count * (SF_CFH_FIRST + 1)], count,
                                              sf_cfh_rig_height(rig, 1))
                            : (sf_cfh_interval){NAN, NAN, NAN, {NAN, NAN}};
    }
    return err->status;
}

double sf_cfh_columns_error(const sf_cfh_spread *s, int criterion) {
    double squares = 0;
    for (int d = 0; d < s->draws; d++)
        squares += pow(s->draw[d].columns_sd[criterion], 2) / s->draws;
    return s->freedom > 0 ? sqrt(squares) : NAN;
}

/* Squared length of ln(height). */
static double square_of(const sf_cfh_interval *i) {
    double length = log(i->high / i->low);
    return i->low > 0 && isfinite(length) ? length * length : NAN;
}

double sf_cfh_spread_share(const sf_cfh_spread *s, sf_cfh_part part) {
    double whole = square_of(sf_cfh_spread_whole(s, SF_CFH_FIRST));
    double before = part > 0 ? square_of(&s->part[part - 1][SF_CFH_FIRST]) : 0;
    return whole > 0 ? (square_of(&s->part[part][SF_CFH_FIRST]) - before) / whole : NAN;
}

const sf_cfh_interval *sf_cfh_spread_whole(const sf_cfh_spread *s, int criterion) {
    return &s->part[SF_CFH_PARTS - 1][criterion];
}
