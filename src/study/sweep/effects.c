/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/analysis.h"

#include "study/fit/least_squares.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>

/* ---- response surface ---- */

static const double TOLERANCE = 1e-9; /* of singular values: what is below is not determined */

static int count_terms(const sf_quadratic *s) {
    int terms = 1 + s->d + s->d * (s->d - 1) / 2 + s->offsets;
    for (int i = 0; i < s->d; i++)
        terms += s->curved[i];
    return terms;
}

/* The terms at x. */
static void put_terms(const sf_quadratic *s, const double *x, double *term) {
    double z[SF_QUADRATIC_NUMBERS];
    int t = 0;
    term[t++] = 1;
    for (int i = 0; i < s->d; i++)
        term[t++] = z[i] = (x[i] - s->centre[i]) / s->half[i];
    for (int i = 0; i < s->d; i++)
        if (s->curved[i])
            term[t++] = z[i] * z[i];
    for (int i = 0; i < s->d; i++)
        for (int j = i + 1; j < s->d; j++)
            term[t++] = z[i] * z[j];
    for (int k = 0; k < s->offsets; k++)
        term[t++] = x[s->d + k];
}

/* Range of a number, and whether it has three values. */
static void measure(sf_quadratic *s, int i, int64_t n, const double *x) {
    int stride = s->d + s->offsets;
    double low, high;
    gsl_stats_minmax(&low, &high, x + i, (size_t)stride, (size_t)n);
    s->centre[i] = 0.5 * (low + high);
    s->half[i] = high > low ? 0.5 * (high - low) : 1;
    for (int64_t k = 0; k < n; k++)
        s->curved[i] |=
            fabs(fabs(x[k * stride + i] - s->centre[i]) - s->half[i]) > 1e-6 * s->half[i] && high > low;
}

typedef struct fit {
    gsl_matrix *terms, *covariance;
    gsl_vector *y, *weight, *c;
} fit;

/* The leverage of a row, by (X^T X)^-1. */
static double leverage(const fit *f, size_t row, gsl_vector *scratch) {
    double h = 0;
    const gsl_vector_const_view x = gsl_matrix_const_row(f->terms, row);
    gsl_blas_dgemv(CblasNoTrans, 1, f->covariance, &x.vector, 0, scratch);
    gsl_blas_ddot(&x.vector, scratch, &h);
    return h;
}

static double residual(const fit *f, size_t row) {
    double value = 0;
    const gsl_vector_const_view x = gsl_matrix_const_row(f->terms, row);
    gsl_blas_ddot(&x.vector, f->c, &value);
    return gsl_vector_get(f->y, row) - value;
}

static int compare_rows(const void *p, const void *q, void *context) {
    const fit *f = context;
    size_t j = *(const size_t *)p, k = *(const size_t *)q;
    const double *a = gsl_matrix_const_ptr(f->terms, j, 0), *b = gsl_matrix_const_ptr(f->terms, k, 0);
    for (size_t t = 0; t < f->terms->size2; t++)
        if (a[t] != b[t])
            return a[t] > b[t] ? 1 : -1;
    return (j > k) - (j < k);
}

static bool is_same_site(const fit *f, size_t j, size_t k) {
    const size_t bytes = f->terms->size2 * sizeof(double);
    return memcmp(gsl_matrix_const_ptr(f->terms, j, 0), gsl_matrix_const_ptr(f->terms, k, 0), bytes) == 0;
}

/* Errors of the surface without each site: the rows of one place in the factors that it has, as runs with
 * other draws of the foam, would otherwise tell of each other. Of m rows with leverage h and the sum S of
 * their residuals r the error is r + h S / (1 - m h). `order` [n]. */
static void judge(sf_quadratic *s, const fit *f, size_t n, size_t *order, double *left_out,
                  gsl_vector *scratch) {
    double squares = 0, press = 0, mean = 0, spread = 0;
    for (size_t k = 0; k < n; k++) {
        order[k] = k;
        mean += gsl_vector_get(f->y, k) / (double)n;
    }
    qsort_r(order, n, sizeof *order, compare_rows, (void *)f);
    for (size_t first = 0, end; first < n; first = end) {
        double sum = 0, h = leverage(f, order[first], scratch);
        for (end = first; end < n && is_same_site(f, order[first], order[end]); end++)
            sum += residual(f, order[end]);
        double rest = 1 - (double)(end - first) * h;
        for (size_t i = first; i < end; i++) {
            double r = residual(f, order[i]), y = gsl_vector_get(f->y, order[i]),
                   error = rest > 1e-9 ? r + h * sum / rest : NAN;
            squares += r * r;
            press += error * error;
            spread += (y - mean) * (y - mean);
            if (left_out)
                left_out[order[i]] = y - error;
        }
    }
    s->rms = sqrt(squares / (double)(n - (size_t)s->terms));
    s->left_out_rms = sqrt(press / (double)n);
    if (isnan(s->left_out_rms))
        snprintf(s->problem, sizeof s->problem,
                 "without one place in the factors the terms are not determined: its error at runs left out "
                 "is not known");
    s->q2 = spread > 0 ? 1 - press / spread : NAN;
}

static void solve(sf_quadratic *s, fit *f, int64_t n, const double *x, const double *y, size_t *order,
                  double *left_out, gsl_vector *scratch, gsl_multifit_linear_workspace *work) {
    double chisq = 0;
    size_t rank = 0;
    for (size_t k = 0; k < (size_t)n; k++) {
        put_terms(s, x + k * (size_t)(s->d + s->offsets), gsl_matrix_ptr(f->terms, k, 0));
        gsl_vector_set(f->y, k, y[k]);
        gsl_vector_set(f->weight, k, 1);
    }
    int failed = gsl_multifit_wlinear_tsvd(f->terms, f->weight, f->y, TOLERANCE, f->c, f->covariance, &chisq,
                                           &rank, work);
    if (failed || rank < (size_t)s->terms) {
        snprintf(s->problem, sizeof s->problem,
                 "the rows do not determine all terms: two factors vary together, or values are missing");
        s->terms = 0;
        return;
    }
    for (int t = 0; t < s->terms; t++)
        s->c[t] = gsl_vector_get(f->c, (size_t)t);
    judge(s, f, (size_t)n, order, left_out, scratch);
}

sf_status sf_quadratic_fit(int d, int offsets, int64_t n, const double *x, const double *y, sf_quadratic *s,
                           double *left_out, sf_error *err) {
    *s = (sf_quadratic){.d = d, .offsets = offsets, .rms = NAN, .left_out_rms = NAN, .q2 = NAN};
    for (int i = 0; i < d && n > 0; i++)
        measure(s, i, n, x);
    int terms = count_terms(s);
    if (d == 0 || terms > SF_QUADRATIC_TERMS || n < terms + 2) {
        snprintf(s->problem, sizeof s->problem,
                 d == 0 ? "no factor is a number with more than one value"
                        : "%d terms need at least %d runs, there are %lld",
                 terms, terms + 2, (long long)n);
        return SF_OK;
    }
    const size_t rows = (size_t)n, columns = (size_t)terms;
    SF_MATRIX *matrix = sf_matrix(rows, columns, err), *covariance = sf_matrix(columns, columns, err);
    SF_VECTOR *right = sf_vector(rows, err), *weight = sf_vector(rows, err);
    SF_VECTOR *c = sf_vector(columns, err), *scratch = sf_vector(columns, err);
    fit f = {matrix, covariance, right, weight, c};
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(rows, columns);
    SF_OWNED size_t *order = sf_alloc(err, rows, sizeof *order, "the response surface");
    s->terms = terms;
    if (err->status == SF_OK && work)
        solve(s, &f, n, x, y, order, left_out, scratch, work);
    else if (err->status == SF_OK)
        SF_NO_MEMORY(err, "the response surface");
    gsl_multifit_linear_free(work);
    return err->status;
}

double sf_quadratic_at(const sf_quadratic *s, const double *x) {
    double term[SF_QUADRATIC_TERMS], value = 0;
    put_terms(s, x, term);
    for (int t = 0; t < s->terms; t++)
        value += s->c[t] * term[t];
    return value;
}

/* ---- main effects and probabilities ---- */

/* Ranks of the numbers, equal numbers the same group as long as there are few. */
static sf_status group_numbers(const sf_factor *f, int64_t rows, sf_groups *g, sf_error *err) {
    SF_OWN(size_t, order, rows, "groups", err);
    gsl_sort_index(order, f->value, 1, (size_t)rows);
    int64_t distinct = 1;
    for (int64_t k = 1; k < rows; k++)
        distinct += f->value[order[k]] > f->value[order[k - 1]];
    g->count = distinct <= SF_EFFECT_LEVELS ? distinct : SF_EFFECT_BINS;
    for (int64_t k = 0, level = 0; k < rows; k++) {
        level += k > 0 && f->value[order[k]] > f->value[order[k - 1]];
        g->of_row[order[k]] = distinct <= SF_EFFECT_LEVELS ? level : k * SF_EFFECT_BINS / rows;
    }
    return SF_OK;
}

static sf_status find_middles(const sf_factor *f, int64_t rows, sf_groups *g, sf_error *err) {
    SF_OWNED int64_t *number = sf_alloc(err, g->count, sizeof *number, "groups");
    g->middle = sf_alloc(err, g->count, sizeof *g->middle, "groups");
    for (int64_t k = 0; k < rows && err->status == SF_OK; k++) {
        g->middle[g->of_row[k]] += f->value[k];
        number[g->of_row[k]]++;
    }
    for (int64_t k = 0; k < g->count && err->status == SF_OK; k++)
        g->middle[k] /= (double)number[k];
    return err->status;
}

sf_status sf_groups_make(const sf_plan *p, int factor, sf_groups *g, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    int64_t rows = p->block[p->block_of[factor]].rows;
    *g = (sf_groups){.count = f->count, .of_row = sf_alloc(err, rows, sizeof(int64_t), "groups")};
    for (int64_t k = 0; k < rows && g->of_row && f->words; k++)
        g->of_row[k] = (int64_t)f->value[k];
    if (err->status == SF_OK && !f->words)
        group_numbers(f, rows, g, err);
    return err->status == SF_OK ? find_middles(f, rows, g, err) : err->status;
}

void sf_groups_free(sf_groups *g) {
    SF_CLEAR(g, g->of_row, g->middle);
}

/* The combination of all other blocks. */
static int64_t combination(const sf_block *b, int64_t row) {
    return row / (b->stride * b->rows) * b->stride + row % b->stride;
}

/* [combinations] those of which a run does not count; of a plan of one block none. */
static bool *find_gaps(const sf_runs *r, const sf_block *b, int figure, sf_effect *e, sf_error *err) {
    int64_t count = r->count / b->rows;
    bool *gap = sf_alloc(err, count, sizeof *gap, "combinations");
    if (!gap || count == 1)
        return gap;
    for (int64_t row = 0; row < r->count; row++)
        gap[combination(b, row)] |= isnan(sf_runs_value(r, row, figure));
    e->used = e->of = count;
    for (int64_t k = 0; k < count; k++)
        e->used -= gap[k];
    return gap;
}

/* mean [count] of the figure over the rows of each group that count; NaN: there is none. */
static void find_means(const sf_runs *r, const sf_block *b, const bool *gap, const sf_groups *g, int figure,
                       double *mean, int64_t *number) {
    for (int64_t row = 0; row < r->count; row++) {
        double value = sf_runs_value(r, row, figure);
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

sf_status sf_effect_measure(const sf_runs *r, int factor, int figure, sf_effect *e, sf_error *err) {
    SF_OWNED_BY(sf_groups_free) sf_groups g = {0};
    const sf_factor *f = &r->plan->factor[factor];
    const sf_block *b = &r->plan->block[r->plan->block_of[factor]];
    *e = (sf_effect){.low = NAN, .high = NAN, .first = NAN, .last = NAN};
    if (sf_effect_is_scatter(r->plan, factor) || sf_effect_is_by_surface(r->plan, factor))
        return SF_OK;
    SF_TRY(sf_groups_make(r->plan, factor, &g, err));
    SF_OWNED double *mean = sf_alloc(err, g.count, sizeof *mean, "means");
    SF_OWNED int64_t *number = sf_alloc(err, g.count, sizeof *number, "means");
    SF_OWNED bool *gap = find_gaps(r, b, figure, e, err);
    SF_TRY(err->status);
    find_means(r, b, gap, &g, figure, mean, number);
    e->first = f->words ? NAN : mean[0];
    e->last = f->words ? NAN : mean[g.count - 1];
    find_range(mean, g.count, f->words && f->uncertain, e);
    return SF_OK;
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

/* 95 % scatter of a figure of a run from drop to drop, over it; 0: of another figure, or not estimated. */
static double scatter_of(const sf_runs *r, int64_t row, const char *figure) {
    const char *key = strcmp(figure, "a_max_g") == 0 ? "a_max_scatter"
                      : strcmp(figure, "hic") == 0   ? "hic_scatter"
                                                     : NULL;
    double sd = key ? sf_runs_place(r, row)[sf_runs_figure(key)] : 0;
    return isnan(sd) ? 0 : gsl_cdf_ugaussian_Pinv(1 - TAIL) * sd;
}

/* A prediction whose interval holds the limit is unknown, and so is a row that is left open because it is
 * expected to have no figures. */
static void count(const sf_runs *r, int64_t row, int figure, sf_probability *p) {
    const sf_sweep_limit *limit = &r->plan->figure[figure];
    double value = sf_runs_value(r, row, figure);
    if (fabs(log(value / limit->limit)) < sf_runs_half(r, row, figure))
        value = NAN;
    bool anvil =
        r->state[row] == SF_SWEEP_FAILED && r->message[row] && strstr(r->message[row], SF_ENDED_ON_ANVIL);
    p->below += value < limit->limit;
    p->above += value >= limit->limit || anvil;
    p->unknown += isnan(value) && !anvil;
    p->within += fabs(log(limit->limit / value)) < scatter_of(r, row, limit->figure);
}

sf_status sf_probabilities_count(const sf_runs *r, sf_probabilities *p, sf_error *err) {
    const sf_plan *plan = r->plan;
    *p = (sf_probabilities){.cells = count_cells(plan)};
    if (p->cells == 0)
        return SF_OK;
    p->cell = sf_alloc(err, p->cells, (unsigned long)plan->figure_count * sizeof *p->cell, "probabilities");
    p->row = sf_alloc(err, p->cells, sizeof *p->row, "probabilities");
    for (int64_t row = r->count - 1; row >= 0 && err->status == SF_OK; row--) {
        int64_t cell = cell_of(plan, row);
        p->row[cell] = row;
        bool unheard = r->state[row] == SF_SWEEP_OPEN && !r->message[row];
        p->open += unheard;
        for (int k = 0; k < plan->figure_count && !unheard; k++)
            count(r, row, k, &p->cell[k * p->cells + cell]);
    }
    for (int64_t k = 0; k < plan->figure_count * p->cells && err->status == SF_OK; k++)
        sf_probability_judge(&p->cell[k], count_independent(plan));
    return err->status;
}

void sf_probabilities_free(sf_probabilities *p) {
    SF_CLEAR(p, p->cell, p->row);
}
