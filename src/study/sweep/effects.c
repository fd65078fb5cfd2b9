/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/effects.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ranks of the numbers, equal numbers the same group as long as there are few. */
static sf_status group_numbers(const sf_factor *f, int64_t rows, sf_groups *g, sf_error *err) {
    size_t *order = sf_alloc(err, (unsigned long)rows, sizeof *order, "groups");
    if (!order)
        return err->status;
    gsl_sort_index(order, f->value, 1, (size_t)rows);
    int64_t distinct = 1;
    for (int64_t k = 1; k < rows; k++)
        distinct += f->value[order[k]] > f->value[order[k - 1]];
    g->count = distinct <= SF_EFFECT_LEVELS ? distinct : SF_EFFECT_BINS;
    for (int64_t k = 0, level = 0; k < rows; k++) {
        level += k > 0 && f->value[order[k]] > f->value[order[k - 1]];
        g->of_row[order[k]] = distinct <= SF_EFFECT_LEVELS ? level : k * SF_EFFECT_BINS / rows;
    }
    free(order);
    return SF_OK;
}

static sf_status find_middles(const sf_factor *f, int64_t rows, sf_groups *g, sf_error *err) {
    int64_t *number = sf_alloc(err, (unsigned long)g->count, sizeof *number, "groups");
    g->middle = sf_alloc(err, (unsigned long)g->count, sizeof *g->middle, "groups");
    for (int64_t k = 0; k < rows && err->status == SF_OK; k++) {
        g->middle[g->of_row[k]] += f->value[k];
        number[g->of_row[k]]++;
    }
    for (int64_t k = 0; k < g->count && err->status == SF_OK; k++)
        g->middle[k] /= (double)number[k];
    free(number);
    return err->status;
}

sf_status sf_groups_make(const sf_plan *p, int factor, sf_groups *g, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    int64_t rows = p->block[p->block_of[factor]].rows;
    *g = (sf_groups){.count = f->count,
                     .of_row = sf_alloc(err, (unsigned long)rows, sizeof(int64_t), "groups")};
    for (int64_t k = 0; k < rows && g->of_row && f->words; k++)
        g->of_row[k] = (int64_t)f->value[k];
    if (err->status == SF_OK && !f->words)
        group_numbers(f, rows, g, err);
    return err->status == SF_OK ? find_middles(f, rows, g, err) : err->status;
}

void sf_groups_free(sf_groups *g) {
    free(g->of_row);
    free(g->middle);
    *g = (sf_groups){0};
}

static double value_of(const sf_runs *r, int64_t row, size_t figure) {
    return sf_runs_usable(r, row) ? r->value[row * (int64_t)r->figures + (int64_t)figure] : NAN;
}

/* The combination of all other blocks. */
static int64_t combination(const sf_block *b, int64_t row) {
    return row / (b->stride * b->rows) * b->stride + row % b->stride;
}

/* [combinations] those of which a run does not count; of a plan of one block none. */
static bool *find_gaps(const sf_runs *r, const sf_block *b, size_t figure, sf_effect *e, sf_error *err) {
    int64_t count = r->count / b->rows;
    bool *gap = sf_alloc(err, (unsigned long)count, sizeof *gap, "combinations");
    if (!gap || count == 1)
        return gap;
    for (int64_t row = 0; row < r->count; row++)
        gap[combination(b, row)] |= isnan(value_of(r, row, figure));
    e->used = e->of = count;
    for (int64_t k = 0; k < count; k++)
        e->used -= gap[k];
    return gap;
}

/* mean [count] of the figure over the rows of each group that count; NaN: there is none. */
static void find_means(const sf_runs *r, const sf_block *b, const bool *gap, const sf_groups *g,
                       size_t figure, double *mean, int64_t *number) {
    for (int64_t row = 0; row < r->count; row++) {
        double value = value_of(r, row, figure);
        int64_t k = g->of_row[row / b->stride % b->rows];
        if (isnan(value) || gap[combination(b, row)])
            continue;
        mean[k] += value;
        number[k]++;
    }
    for (int64_t k = 0; k < g->count; k++)
        mean[k] = number[k] > 0 ? mean[k] / (double)number[k] : NAN;
}

/* The range of the means that are there; `mean` is sorted. */
static void find_range(double *mean, int64_t count, bool draws, sf_effect *e) {
    size_t n = 0;
    for (int64_t k = 0; k < count; k++)
        if (!isnan(mean[k]))
            mean[n++] = mean[k];
    if (n < 2)
        return;
    gsl_sort(mean, 1, n);
    e->low = draws ? gsl_stats_quantile_from_sorted_data(mean, 1, n, 0.05) : mean[0];
    e->high = draws ? gsl_stats_quantile_from_sorted_data(mean, 1, n, 0.95) : mean[n - 1];
}

bool sf_effect_is_scatter(const sf_plan *p, int factor) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    return b->kind == SF_BLOCK_SAMPLE && b->count > 1 && f->words &&
           (f->posterior || f->count > SF_EFFECT_LEVELS) && b->rows < SF_EFFECT_RUNS * f->count;
}

bool sf_effect_is_by_surface(const sf_plan *p, int factor) {
    const sf_block *b = &p->block[p->block_of[factor]];
    return b->kind == SF_BLOCK_SAMPLE && b->count > 1 && !p->factor[factor].words;
}

/* The mean of the surface where number `i` of all rows is x_i. */
static double mean_at(const sf_quadratic *s, int i, double x_i, int64_t n, double *x) {
    int stride = s->d + s->offsets;
    double sum = 0;
    for (int64_t k = 0; k < n; k++) {
        double kept = x[k * stride + i];
        x[k * stride + i] = x_i;
        sum += sf_quadratic_at(s, &x[k * stride]);
        x[k * stride + i] = kept;
    }
    return sum / (double)n;
}

void sf_effect_of_surface(const sf_quadratic *s, int i, int64_t n, double *x, sf_effect *e) {
    if (*s->problem || s->terms == 0 || !(s->q2 >= SF_EFFECT_Q2))
        return;
    double middle = mean_at(s, i, s->centre[i], n, x);
    e->first = mean_at(s, i, s->centre[i] - s->half[i], n, x);
    e->last = mean_at(s, i, s->centre[i] + s->half[i], n, x);
    e->low = fmin(e->first, e->last);
    e->high = fmax(e->first, e->last);
    double slope = 0.5 * (e->last - e->first), bend = 0.5 * (e->last + e->first) - middle;
    if (fabs(slope) < 2 * fabs(bend)) { /* the top of the parabola is between them */
        double top = middle - slope * slope / (4 * bend);
        e->low = fmin(e->low, top);
        e->high = fmax(e->high, top);
    }
}

sf_status sf_effect_measure(const sf_runs *r, int factor, size_t figure, sf_effect *e, sf_error *err) {
    sf_groups g = {0};
    const sf_factor *f = &r->plan->factor[factor];
    const sf_block *b = &r->plan->block[r->plan->block_of[factor]];
    *e = (sf_effect){.low = NAN, .high = NAN, .first = NAN, .last = NAN};
    if (sf_effect_is_scatter(r->plan, factor) || sf_effect_is_by_surface(r->plan, factor))
        return SF_OK;
    if (sf_groups_make(r->plan, factor, &g, err) == SF_OK) {
        double *mean = sf_alloc(err, (unsigned long)g.count, sizeof *mean, "means");
        int64_t *number = sf_alloc(err, (unsigned long)g.count, sizeof *number, "means");
        bool *gap = find_gaps(r, b, figure, e, err);
        if (mean && number && gap) {
            find_means(r, b, gap, &g, figure, mean, number);
            e->first = f->words ? NAN : mean[0];
            e->last = f->words ? NAN : mean[g.count - 1];
            find_range(mean, g.count, f->words && f->uncertain, e);
        }
        free(mean);
        free(number);
        free(gap);
    }
    sf_groups_free(&g);
    return err->status;
}

static const double TAIL = 0.025;

bool sf_block_is_chosen(const sf_plan *p, int block) {
    const sf_block *b = &p->block[block];
    for (int f = b->first; f < b->first + b->count; f++)
        if (p->factor[f].uncertain)
            return false;
    return true;
}

static int64_t count_cells(const sf_plan *p) {
    int64_t cells = 1;
    bool uncertain = false;
    for (int k = 0; k < p->block_count; k++)
        if (sf_block_is_chosen(p, k))
            cells *= p->block[k].rows;
        else
            uncertain = true;
    return uncertain && cells <= SF_PROBABILITY_CELLS ? cells : 0;
}

static int64_t cell_of(const sf_plan *p, int64_t row) {
    int64_t cell = 0;
    for (int k = 0; k < p->block_count; k++)
        if (sf_block_is_chosen(p, k))
            cell = cell * p->block[k].rows + row / p->block[k].stride % p->block[k].rows;
    return cell;
}

/* Rows of a cell that share no draw: of crossed blocks those of the smallest, of a sample for Sobol' indices
 * its two first matrices, and nowhere more than a posterior has draws. */
static double count_independent(const sf_plan *p) {
    double least = INFINITY;
    for (int k = 0; k < p->block_count; k++) {
        const sf_block *b = &p->block[k];
        double rows = (double)b->rows;
        if (b->kind == SF_BLOCK_SAMPLE && b->method == SF_SAMPLING_SALTELLI)
            rows *= 2. / (b->count + 2);
        for (int f = b->first; f < b->first + b->count; f++)
            if (p->factor[f].posterior)
                rows = fmin(rows, (double)p->factor[f].count);
        if (!sf_block_is_chosen(p, k))
            least = fmin(least, rows);
    }
    return least;
}

void sf_probability_judge(sf_probability *p, double independent) {
    double all = (double)(p->below + p->above + p->unknown), part = all > independent ? independent / all : 1,
           n = part * all, certain = part * (double)p->below,
           possible = part * (double)(p->below + p->unknown);
    p->share = all > 0 ? (double)p->below / all : NAN;
    p->low = certain > 0 ? gsl_cdf_beta_Pinv(TAIL, certain, n - certain + 1) : 0;
    p->high = possible < n ? gsl_cdf_beta_Pinv(1 - TAIL, possible + 1, n - possible) : 1;
}

/* A prediction whose interval holds the limit is unknown. */
static void count(const sf_runs *r, int64_t row, int figure, sf_probability *p) {
    const sf_sweep_limit *limit = &r->plan->figure[figure];
    double value =
        sf_runs_usable(r, row) ? sf_runs_place((sf_runs *)r, row)[sf_runs_figure(limit->figure)] : NAN;
    if (fabs(log(value / limit->limit)) < sf_runs_half(r, row, figure))
        value = NAN;
    bool anvil =
        r->state[row] == SF_SWEEP_FAILED && r->message[row] && strstr(r->message[row], SF_ENDED_ON_ANVIL);
    p->below += value < limit->limit;
    p->above += value >= limit->limit || anvil;
    p->unknown += isnan(value) && !anvil;
}

sf_status sf_probabilities_count(const sf_runs *r, sf_probabilities *p, sf_error *err) {
    const sf_plan *plan = r->plan;
    *p = (sf_probabilities){.cells = count_cells(plan)};
    if (p->cells == 0)
        return SF_OK;
    p->cell = sf_alloc(err, (unsigned long)p->cells, (unsigned long)plan->figure_count * sizeof *p->cell,
                       "probabilities");
    p->row = sf_alloc(err, (unsigned long)p->cells, sizeof *p->row, "probabilities");
    for (int64_t row = r->count - 1; row >= 0 && err->status == SF_OK; row--) {
        int64_t cell = cell_of(plan, row);
        p->row[cell] = row;
        p->open += r->state[row] == SF_SWEEP_OPEN;
        for (int k = 0; k < plan->figure_count && r->state[row] != SF_SWEEP_OPEN; k++)
            count(r, row, k, &p->cell[k * p->cells + cell]);
    }
    for (int64_t k = 0; k < plan->figure_count * p->cells && err->status == SF_OK; k++)
        sf_probability_judge(&p->cell[k], count_independent(plan));
    return err->status;
}

void sf_probabilities_free(sf_probabilities *p) {
    free(p->cell);
    free(p->row);
    *p = (sf_probabilities){0};
}
