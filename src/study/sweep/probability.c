/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/probability.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static void count(const sf_runs *r, int64_t row, const sf_sweep_limit *limit, sf_probability *p) {
    double value =
        sf_runs_usable(r, row) ? sf_runs_place((sf_runs *)r, row)[sf_runs_figure(limit->figure)] : NAN;
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
            count(r, row, &plan->figure[k], &p->cell[k * p->cells + cell]);
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
