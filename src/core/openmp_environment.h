/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenMP's variables of the environment. The OpenMP runtime reads them before main and prints lines of its
 * own about values that it does not know; some values end the program later by a signal. Therefore a program
 * that links this file looks at them first: it keeps a known variable with a possible value (OMP_NUM_THREADS,
 * OMP_THREAD_LIMIT, OMP_WAIT_POLICY, OMP_PROC_BIND, OMP_PLACES, OMP_DYNAMIC, GOMP_SPINCOUNT) and takes away
 * all other OMP_ and GOMP_ variables; none of these is of use to softfall. */
#ifndef SF_CORE_OPENMP_ENVIRONMENT_H
#define SF_CORE_OPENMP_ENVIRONMENT_H

#include "core/error.h"

enum { SF_MOST_THREADS = 1024 };

/* SF_ERR_INPUT if a known variable had an impossible value. */
sf_status sf_openmp_environment_check(sf_error *err);

#endif
