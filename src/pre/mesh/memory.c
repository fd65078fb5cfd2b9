/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

double sf_memory_available(void) {
    const char *given = getenv("SOFTFALL_MEMORY_MB");
    char *end = NULL, line[128];
    double megabytes = given ? strtod(given, &end) : 0;
    if (given && end != given && *end == '\0' && megabytes > 0)
        return 1e6 * megabytes;
    long long kilobytes = -1;
    FILE *file = fopen("/proc/meminfo", "r");
    while (file && kilobytes < 0 && fgets(line, sizeof line, file))
        if (sscanf(line, "MemAvailable: %lld kB", &kilobytes) != 1)
            kilobytes = -1;
    if (file)
        fclose(file);
    return kilobytes < 0 ? INFINITY : 1024.0 * (double)kilobytes;
}
