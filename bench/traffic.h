/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step moves and computes, counted from the arrays: every array once per pass that reads or writes it,
 * as if the caches held what a pass uses again. */
#ifndef SF_BENCH_TRAFFIC_H
#define SF_BENCH_TRAFFIC_H

#include "solver/operators.h"
#include "solver/state.h"

typedef struct bench_traffic {
    double bytes[SF_PHASES]; /* of one step without Lanczos products */
    double flops[SF_PHASES]; /* likewise; a division and a root count as one */
    double product_bytes;    /* of one Lanczos product */
    double product_flops;
} bench_traffic;

bench_traffic bench_count(const sf_model *model, const sf_operators *operators);

#endif
