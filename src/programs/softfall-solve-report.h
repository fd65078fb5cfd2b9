/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts of softfall-solve before and after a run. */
#ifndef SF_SOLVER_PROGRAM_REPORT_H
#define SF_SOLVER_PROGRAM_REPORT_H

#include "solver/run/run.h"

/* The size of the model, on stdout. */
void sf_solve_print_model(const sf_model *model, int threads);

/* The ending, the energies and the errors of a run on stdout; warnings on stderr. */
void sf_solve_print_ledger(const sf_model *model, const sf_state *state, const sf_run *run);

#endif
