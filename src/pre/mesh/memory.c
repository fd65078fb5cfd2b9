/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

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

/* The sanitizers' shadow takes terabytes of addresses. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define UNLIMITED_ADDRESSES
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define UNLIMITED_ADDRESSES
#endif
#endif

void sf_memory_limit_process(void) {
#ifndef UNLIMITED_ADDRESSES
    double bytes = sf_memory_available();
    if (bytes < 1e15) {
        const struct rlimit limit = {(rlim_t)bytes, (rlim_t)bytes};
        setrlimit(RLIMIT_AS, &limit);
    }
#endif
}
