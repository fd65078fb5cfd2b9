/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/analysis.h"

#include "study/fit/posterior/mixture.h"
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>

/* ---- Sobol' indices ---- */

enum { RESAMPLES = 1000, FEWER_RESAMPLES = 200, LARGE = 200000 };

typedef struct sample {
    int d;
    int64_t n, used;
    const double *y;
    int64_t *place; /* [used] of the samples that are whole */
} sample;

static double at(const sample *s, int block, int64_t k) {
    return s->y[block * s->n + s->place[k]];
}

static void list_whole(sample *s) {
    for (int64_t k = 0; k < s->n; k++) {
        bool whole = true;
        for (int block = 0; block < s->d + 2; block++)
            whole &= isfinite(s->y[block * s->n + k]) != 0;
        if (whole)
            s->place[s->used++] = k;
    }
}

/* Both indices of every coordinate from the samples `pick` (NULL: all); `out` [2 d]. */
static void estimate(const sample *s, const int64_t *pick, double *out) {
    double sum = 0, squares = 0, n = (double)s->used;
    for (int64_t k = 0; k < s->used; k++)
        sum += at(s, 0, pick ? pick[k] : k) + at(s, 1, pick ? pick[k] : k);
    double mean = sum / (2 * n);
    for (int i = 0; i < 2 * s->d; i++)
        out[i] = 0;
    for (int64_t k = 0; k < s->used; k++) {
        int64_t p = pick ? pick[k] : k;
        double a = at(s, 0, p) - mean, b = at(s, 1, p) - mean;
        squares += a * a + b * b;
        for (int i = 0; i < s->d; i++) {
            double mixed = at(s, 2 + i, p) - mean;
            out[i] += b * (mixed - a);
            out[s->d + i] += 0.5 * (mixed - a) * (mixed - a);
        }
    }
    for (int i = 0; i < 2 * s->d; i++)
        out[i] = squares > 0 ? out[i] / (0.5 * squares) : NAN;
}

/* value [resamples][2 d] */
static sf_status resample(const sample *s, uint64_t seed, int resamples, double *value, sf_error *err) {
    SF_RANDOM *rng = sf_random(seed, err);
    SF_OWNED int64_t *pick = sf_alloc(err, s->used, sizeof *pick, "bootstrap samples");
    for (int r = 0; r < resamples && err->status == SF_OK; r++) {
        for (int64_t k = 0; k < s->used; k++)
            pick[k] = (int64_t)gsl_rng_uniform_int(rng, (unsigned long)s->used);
        estimate(s, pick, value + r * 2 * s->d);
    }
    return err->status;
}

/* The interval of a column of the resamples, which it sorts. */
static void interval(double *column, int resamples, int columns, double *low, double *high) {
    size_t stride = (size_t)columns, n = (size_t)resamples;
    gsl_sort(column, stride, n);
    *low = gsl_stats_quantile_from_sorted_data(column, stride, n, 0.025);
    *high = gsl_stats_quantile_from_sorted_data(column, stride, n, 0.975);
}

static sf_status evaluate(const sample *s, uint64_t seed, sf_index *index, sf_error *err) {
    int columns = 2 * s->d, resamples = s->used * s->d > LARGE ? FEWER_RESAMPLES : RESAMPLES;
    SF_OWNED double *value =
                        sf_alloc(err, resamples, (unsigned long)columns * sizeof *value, "the bootstrap"),
                    *all = sf_alloc(err, columns, sizeof *all, "indices");
    if (err->status == SF_OK && resample(s, seed, resamples, value, err) == SF_OK) {
        estimate(s, NULL, all);
        for (int i = 0; i < s->d && isfinite(all[i]); i++) {
            index[i].first = all[i];
            index[i].total = all[s->d + i];
            interval(value + i, resamples, columns, &index[i].first_low, &index[i].first_high);
            interval(value + s->d + i, resamples, columns, &index[i].total_low, &index[i].total_high);
        }
    }
    return err->status;
}

sf_status sf_indices(int d, int64_t n, const double *y, uint64_t seed, sf_index *index, long long *used,
                     sf_error *err) {
    sample s = {.d = d, .n = n, .y = y, .place = sf_alloc(err, n, sizeof(int64_t), "samples")};
    for (int i = 0; i < d; i++)
        index[i] = (sf_index){NAN, NAN, NAN, NAN, NAN, NAN};
    if (s.place) {
        list_whole(&s);
        if (s.used >= SF_INDEX_LEAST && (double)s.used >= SF_INDEX_SHARE * (double)n)
            evaluate(&s, seed, index, err);
    }
    *used = s.used;
    free(s.place);
    return err->status;
}

/* ---- the runs ---- */

enum { SURFACE_SEED = 1 }; /* and that of pictures */

static void count(sf_analysis *a) {
    for (int64_t k = 0; k < a->runs->count; k++) {
        bool done = a->runs->state[k] == SF_SWEEP_DONE;
        a->done += done;
        a->failed += a->runs->state[k] == SF_SWEEP_FAILED;
        a->open += a->runs->state[k] == SF_SWEEP_OPEN;
        a->predicted += a->runs->state[k] == SF_SWEEP_PREDICTED;
        a->usable += sf_runs_usable(a->runs, k);
        for (int i = 0; i < a->plan->figure_count; i++)
            a->widest[i] = fmax(a->widest[i], expm1(sf_runs_half(a->runs, k, i)));
        a->unusable += done && a->runs->grade[k] == SF_GRADE_DO_NOT_USE;
        a->remarks += done && a->runs->grade[k] == SF_GRADE_REMARKS;
    }
}

/* ---- response surface ---- */

static bool varies(const sf_plan *p, int factor) {
    const double *value = p->factor[factor].value;
    for (int64_t k = 1; k < p->block[p->block_of[factor]].rows; k++)
        if (value[k] != value[0])
            return true;
    return false;
}

int sf_analysis_numbers(const sf_plan *p, int list[SF_SWEEP_FACTORS]) {
    int count = 0;
    for (int f = 0; f < p->factor_count; f++)
        if (!p->factor[f].words && varies(p, f))
            list[count++] = f;
    return count;
}

/* The levels of these words have constants of their own; draws of an unknown are scatter. */
static bool has_offsets(const sf_factor *f) {
    return f->words && !f->uncertain && f->count <= SF_OFFSET_LEVELS;
}

static int count_offsets(const sf_plan *p) {
    int count = 0;
    for (int f = 0; f < p->factor_count; f++)
        count += has_offsets(&p->factor[f]) ? (int)p->factor[f].count - 1 : 0;
    return count;
}

static void put_columns(const sf_plan *p, int d, const int *number, int64_t row, double *x) {
    for (int i = 0; i < d; i++)
        *x++ = sf_plan_value(p, number[i], row);
    for (int f = 0; f < p->factor_count; f++)
        for (int64_t k = 1; k < p->factor[f].count && has_offsets(&p->factor[f]); k++)
            *x++ = sf_plan_value(p, f, row) == (double)k;
}

static int64_t count_values(const sf_analysis *a, int figure) {
    int64_t number = 0;
    for (int64_t row = 0; row < a->runs->count; row++)
        number += !isnan(sf_runs_value(a->runs, row, figure));
    return number;
}

/* Draws `wanted` of the `left` values to come, each as likely as any other (Knuth's algorithm S): rows at
 * equal distances would meet the same levels of the factors that change fastest. */
static bool is_drawn(gsl_rng *random, int64_t wanted, int64_t left) {
    return left <= wanted || gsl_rng_uniform(random) * (double)left < (double)wanted;
}

bool *sf_analysis_pick(int64_t count, int64_t most, sf_error *err) {
    int64_t picked = 0;
    SF_RANDOM *random = sf_random(SURFACE_SEED, err);
    bool *pick = sf_alloc(err, count, sizeof *pick, "a picture");
    for (int64_t k = 0; k < count && err->status == SF_OK; k++) {
        pick[k] = picked < most && is_drawn(random, most - picked, count - k);
        picked += pick[k];
    }
    return sf_keep(pick, err);
}

static sf_status make_surface(sf_analysis *a, int figure, sf_error *err) {
    sf_sweep_surface *s = &a->surface[figure];
    int numbers[SF_SWEEP_FACTORS], d = sf_analysis_numbers(a->plan, numbers),
                                   offsets = count_offsets(a->plan);
    s->of = count_values(a, figure);
    int64_t most = s->of < SF_SURFACE_ROWS ? s->of : SF_SURFACE_ROWS, left = s->of;
    SF_RANDOM *random = sf_random(SURFACE_SEED, err);
    SF_OWNED double *x = sf_alloc(err, most, (unsigned long)(d + offsets + 1) * sizeof *x, "a surface");
    SF_ALLOC_ALL(err, "a surface", SF_ROOM(s->simulated, most), SF_ROOM(s->left_out, most));
    for (int64_t row = 0; row < a->runs->count && err->status == SF_OK; row++) {
        double value = sf_runs_value(a->runs, row, figure);
        if (isnan(value) || !is_drawn(random, most - s->rows, left--))
            continue;
        put_columns(a->plan, d, numbers, row, x + s->rows * (d + offsets));
        s->simulated[s->rows++] = value;
    }
    if (err->status == SF_OK)
        sf_quadratic_fit(d, offsets, s->rows, x, s->simulated, &s->fit, s->left_out, err);
    for (int i = 0; i < d && err->status == SF_OK; i++)
        if (sf_effect_is_by_surface(a->plan, numbers[i]))
            sf_effect_of_surface(&s->fit, i, s->rows, x, &a->effect[figure][numbers[i]]);
    return err->status;
}

static void offset_name(const sf_plan *p, int offset, char *text, size_t size) {
    for (int f = 0; f < p->factor_count; f++) {
        if (!has_offsets(&p->factor[f]))
            continue;
        if (offset < p->factor[f].count - 1) {
            snprintf(text, size, "%s = %s", p->factor[f].name, p->factor[f].label[offset + 1]);
            return;
        }
        offset -= (int)p->factor[f].count - 1;
    }
}

void sf_analysis_term(const sf_analysis *a, const sf_quadratic *s, int term, char *text, size_t size) {
    int list[SF_SWEEP_FACTORS];
    const sf_factor *f = a->plan->factor;
    sf_analysis_numbers(a->plan, list);
    snprintf(text, size, "1");
    if (term-- == 0)
        return;
    for (int i = 0; i < s->d; i++)
        if (term-- == 0)
            snprintf(text, size, "%s", f[list[i]].name);
    for (int i = 0; i < s->d; i++)
        if (s->curved[i] && term-- == 0)
            snprintf(text, size, "%s²", f[list[i]].name);
    for (int i = 0; i < s->d; i++)
        for (int j = i + 1; j < s->d; j++)
            if (term-- == 0)
                snprintf(text, size, "%s × %s", f[list[i]].name, f[list[j]].name);
    if (term >= 0)
        offset_name(a->plan, term, text, size);
}

static sf_status make_indices(sf_analysis *a, int figure, sf_error *err) {
    const sf_block *b = sf_plan_saltelli(a->plan);
    SF_OWNED double *y = sf_alloc(err, b->rows, sizeof *y, "indices");
    for (int64_t row = 0; row < b->rows && y; row++)
        y[row] = sf_runs_value(a->runs, row, figure);
    if (y)
        sf_indices(b->count, b->samples, y, b->seed, a->index[figure], &a->index_samples[figure], err);
    return err->status;
}

sf_status sf_analysis_make(const sf_runs *runs, sf_analysis *a, sf_error *err) {
    *a =
        (sf_analysis){.plan = runs->plan, .runs = runs, .with_indices = sf_plan_saltelli(runs->plan) != NULL};
    count(a);
    for (int k = 0; k < a->plan->figure_count && err->status == SF_OK; k++) {
        for (int f = 0; f < a->plan->factor_count && err->status == SF_OK; f++)
            sf_effect_measure(runs, f, k, &a->effect[k][f], err);
        if (err->status == SF_OK && make_surface(a, k, err) == SF_OK && a->with_indices)
            make_indices(a, k, err);
    }
    return err->status == SF_OK ? sf_probabilities_count(runs, &a->probability, err) : err->status;
}

void sf_analysis_free(sf_analysis *a) {
    for (int k = 0; k < SF_SWEEP_FIGURES; k++)
        SF_FREE(a->surface[k].simulated, a->surface[k].left_out);
    sf_probabilities_free(&a->probability);
    *a = (sf_analysis){0};
}
