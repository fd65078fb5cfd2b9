/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_BASE_THREADS_H
#define SF_BASE_THREADS_H
#include "base/error.h"

/* Below these sizes a loop runs on one thread: waking a thread takes about 50 us on a virtual machine. They
 * apply to loops with little work per node, and to loops over rows or contact points. A build with
 * SOFTFALL_THREADS_ALWAYS uses threads in every loop, so that analyses and tests with small models cover
 * them. */

#ifdef SF_THREADS_ALWAYS
enum { SF_FEW_NODES = 0, SF_FEW_POINTS = 0 };
#else
enum { SF_FEW_NODES = 50000, SF_FEW_POINTS = 3000 };
#endif

/* OpenMP's variables of the environment. The OpenMP runtime reads them before main and prints lines of its
 * own about values that it does not know; some values end the program later by a signal. Therefore a program
 * that links this file looks at them first: it keeps a known variable with a possible value, leaves one with
 * another value out and warns, and takes away all other OMP_ and GOMP_ variables without a word, as their
 * defaults are right for softfall (stacks are small, loops are not nested). The list is in the .c file. */

enum { SF_MOST_THREADS = 1024 };

/* SF_ERR_INPUT if a number of threads was impossible; tells `sink` of another variable that was left out. */
sf_status sf_openmp_environment_check(const sf_sink *sink, sf_error *err);
#endif
