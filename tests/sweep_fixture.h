/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans of the example's case, and campaigns of which the drops are replaced by a formula. */
#ifndef SF_TESTS_SWEEP_FIXTURE_H
#define SF_TESTS_SWEEP_FIXTURE_H

#include "program_fixture.h"
#include "study/sweep/analysis.h"
#include "study/sweep/campaign.h"

/* Writes plan.cfg with the example as its case and these factors, and reads it; sf_plan_free in any case. */
sf_status sweep_try_plan(const program_place *p, const char *factors, bool huge, sf_plan *plan,
                         sf_error *err);
/* The same; the test fails if the plan is refused. */
void sweep_read_plan(const program_place *p, const char *factors, sf_plan *plan);
/* The folder ten with ten draws, each the material of the example. */
void sweep_make_posterior(const program_place *p);

typedef struct sweep_formula {
    int64_t calls;    /* rows so far */
    int64_t stop_at;  /* interrupted before that many; 0: not */
    int64_t fails;    /* this row fails; -1: none */
    bool changed;     /* what was there is of other files, until that was found out */
    int64_t other;    /* the same from this row on; 0: of none */
    int64_t dies_at;  /* the process ends after that many; 0: not */
    int64_t edits_at; /* the inputs change after that many; 0: not */
    int64_t stale;    /* this row is no longer what its geometry's files give; 0: none */
} sweep_formula;

/* The inputs of the campaign as they are now; a `look` of sf_sweep_campaign that finds them. */
extern uint64_t sweep_present_inputs;
sf_status sweep_look_at_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err);

/* Sixty rows. */
#define SWEEP_GRID                                                                                           \
    "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 10; },"                                                  \
    "{ key = \"a.y\"; uncertain = true; values = (1, 2, 3, 4, 5, 6); }"

/* Runs the campaign by the formula, in pieces of seven rows; sf_runs_free in any case. */
sf_status sweep_run_campaign(const sf_sweep_campaign *c, sweep_formula *f, sf_runs *runs, sf_error *err);
/* The same in the folder of the place, with inputs that it looks at. */
sf_status sweep_campaign(const program_place *p, const sf_plan *plan, sweep_formula *f, bool retry,
                         uint64_t inputs, sf_runs *runs, sf_error *err);
/* Reads a plan of which nothing is done. */
void sweep_begin_plan(const program_place *p, const char *factors, sf_plan *plan);

/* The rows of a plan by the formula, of which row `fails` fails (-1: none), and what is computed of them. */
typedef struct sweep_evaluated {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
} sweep_evaluated;

void sweep_evaluate_plan(const program_place *p, const char *factors, int64_t fails, sweep_evaluated *e);
void sweep_free_evaluated(sweep_evaluated *e);

#endif
