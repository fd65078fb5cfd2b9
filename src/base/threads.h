/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Below these sizes a loop runs on one thread: waking a thread takes about 50 us on a virtual machine. They
 * apply to loops with little work per node, and to loops over rows or contact points. A build with
 * SOFTFALL_THREADS_ALWAYS uses threads in every loop, so that analyses and tests with small models cover
 * them. */
#ifndef SF_CORE_THREADS_H
#define SF_CORE_THREADS_H

#ifdef SF_THREADS_ALWAYS
enum { SF_FEW_NODES = 0, SF_FEW_POINTS = 0 };
#else
enum { SF_FEW_NODES = 50000, SF_FEW_POINTS = 3000 };
#endif

#endif
