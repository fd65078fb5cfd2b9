/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What this machine can do, measured: the two edges of the roofline. */
#ifndef SF_BENCH_MACHINE_H
#define SF_BENCH_MACHINE_H

#include "base/error.h"

/* Triad a = b + s c over arrays far larger than the caches, on the present number of threads: bytes per
 * second, best of several, three arrays counted. */
sf_status bench_bandwidth(double *bytes_per_second, sf_error *err);

/* Fused multiply-adds in registers on the present number of threads: operations per second (two each), best
 * of several. */
double bench_peak_flops(void);

#endif
