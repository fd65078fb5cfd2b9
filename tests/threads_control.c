/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A loop with a race on vectors, as the kernels have them: the thread sanitizer must report it, or its
 * silence about the other tests would mean nothing. */
#include "base/lanes.h"

#include <stdio.h>

int main(void) {
    sf_vec sum = {0};
#pragma omp parallel for
    for (int i = 0; i < 1000; i++)
        sum += (sf_vec){i, 1, 2, 3};
    printf("%g\n", sum[0]);
    return 0;
}
