/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans of the example's case. */
#ifndef SF_TESTS_SWEEP_FIXTURE_H
#define SF_TESTS_SWEEP_FIXTURE_H

#include "program_fixture.h"
#include "study/sweep/plan.h"

/* Writes plan.cfg with the example as its case and these factors, and reads it; sf_plan_free in any case. */
sf_status sweep_try_plan(const program_place *p, const char *factors, bool huge, sf_plan *plan,
                         sf_error *err);
/* The same; the test fails if the plan is refused. */
void sweep_read_plan(const program_place *p, const char *factors, sf_plan *plan);
/* The folder ten with ten draws, each the material of the example. */
void sweep_make_posterior(const program_place *p);

#endif
