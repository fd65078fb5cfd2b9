/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenMP's variables of the environment. The OpenMP runtime reads them before main and prints lines of its
 * own about values that it does not know; some values end the program later by a signal. Therefore a program
 * that links this file looks at them first: it keeps a known variable with a possible value, leaves one with
 * another value out and warns, and takes away all other OMP_ and GOMP_ variables without a word, as their
 * defaults are right for softfall (stacks are small, loops are not nested). The list is in the .c file. */
#ifndef SF_CORE_OPENMP_ENVIRONMENT_H
#define SF_CORE_OPENMP_ENVIRONMENT_H

#include "base/error.h"
#include "base/sink.h"

enum { SF_MOST_THREADS = 1024 };

/* SF_ERR_INPUT if a number of threads was impossible; tells `sink` of another variable that was left out. */
sf_status sf_openmp_environment_check(const sf_sink *sink, sf_error *err);

#endif
