/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a loop is worth a second thread: waking one takes about 50 us on a virtual machine, so that loops over
 * fewer nodes with little work for each, and over fewer rows or contact points, stay on one. The build can
 * ask for threads always (SOFTFALL_THREADS_ALWAYS), so that analyses and tests with small models see them. */
#ifndef SF_CORE_THREADS_H
#define SF_CORE_THREADS_H

#ifdef SF_THREADS_ALWAYS
enum { SF_FEW_NODES = 0, SF_FEW_POINTS = 0 };
#else
enum { SF_FEW_NODES = 50000, SF_FEW_POINTS = 3000 };
#endif

#endif
