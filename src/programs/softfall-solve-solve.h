/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-solve's run, from the model's file to the results. */
#ifndef SF_SOLVER_PROGRAM_SOLVE_H
#define SF_SOLVER_PROGRAM_SOLVE_H

#include "base/error.h"
#include "programs/softfall-solve-options.h"
#include <signal.h>

/* Solves the model of the options, or resumes a run; `command` is for the provenance. Non-zero `*stop`
 * ends the run after the present step. Progress and report go to stdout. */
sf_status sf_solve(const sf_solve_options *options, const char *command, const volatile sig_atomic_t *stop,
                   sf_error *err);

#endif
