/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inputs of the rows of a plan: cases that softfall-pre takes, or a sentence why not, before anything
 * is started. */
#ifndef SF_SWEEP_INPUTS_H
#define SF_SWEEP_INPUTS_H

#include "case/case.h"
#include "study/sweep/plan.h"

/* Reads the case of a row with each level of each factor (of many numbers the least and the greatest), the
 * other blocks at their first values. `hash`: of the contents of all files that these cases lead to and of
 * the programs. Errors: "file:line of the factor: the sentence of the case". */
sf_status sf_sweep_check_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err);

/* The case of a row; sf_case_free. */
sf_status sf_sweep_read_case(const sf_plan *plan, int64_t row, sf_case *c, sf_error *err);

#endif
