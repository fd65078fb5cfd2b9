/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine.h"

#include "io/process.h"
#include <omp.h>
#include <stdint.h>
#include <stdlib.h>

enum { REPEATS = 7, TRIAD_LENGTH = 1 << 24, CHAINS = 12, ROUNDS = 2000000 };

typedef double register_of_8 __attribute__((vector_size(64)));

static double triad(double *a, const double *b, const double *c) {
    double start = sf_process_now();
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < TRIAD_LENGTH; i++)
        a[i] = b[i] + 3 * c[i];
    return sf_process_now() - start;
}

sf_status bench_bandwidth(double *bytes_per_second, sf_error *err) {
    double *array[3] = {0}, best = 0;
    for (int k = 0; k < 3; k++)
        array[k] = sf_alloc(err, TRIAD_LENGTH, sizeof *array[k], "triad");
    for (int turn = 0; turn < REPEATS && err->status == SF_OK; turn++) {
        double rate = 3.0 * TRIAD_LENGTH * sizeof(double) / triad(array[0], array[1], array[2]);
        best = rate > best ? rate : best;
    }
    for (int k = 0; k < 3; k++)
        free(array[k]);
    *bytes_per_second = best;
    return err->status;
}

/* Independent chains, so that the units are never idle; the sum keeps the compiler from dropping them. */
static double chains(void) {
    register_of_8 x[CHAINS], sum = {0};
    for (int k = 0; k < CHAINS; k++)
        x[k] = sum + k;
    for (int64_t round = 0; round < ROUNDS; round++)
#pragma GCC unroll 12
        for (int k = 0; k < CHAINS; k++)
            x[k] = x[k] * 0.999999 + 1e-6;
    for (int k = 0; k < CHAINS; k++)
        sum += x[k];
    return sum[0] + sum[7];
}

double bench_peak_flops(void) {
    double best = 0, sum = 0;
    for (int turn = 0; turn < REPEATS; turn++) {
        double start = sf_process_now();
#pragma omp parallel reduction(+ : sum)
        sum += chains();
        double rate = 2.0 * 8 * CHAINS * ROUNDS * omp_get_max_threads() / (sf_process_now() - start);
        best = rate > best ? rate : best;
    }
    return sum > 0 ? best : 0;
}
