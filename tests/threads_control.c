/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A loop with a race: the thread sanitizer must report it, or its silence about the other tests would mean
 * nothing. */
#include <stdio.h>

int main(void) {
    int sum = 0;
#pragma omp parallel for
    for (int i = 0; i < 1000; i++)
        sum += i;
    printf("%d\n", sum);
    return 0;
}
