/* SPDX-License-Identifier: GPL-3.0-or-later */
/* variants CASE DROPS [KEY=VALUE]...: processor time of drops of one model in memory, each at a lower speed,
 * on one thread. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include <softfall/softfall.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double processor_time(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    static const char *const figures[2] = {"a_max_g", "hic"};
    const softfall_batch batch = {.threads = 1, .filter = 1000, .keys = 2, .key = figures};
    int count = argc > 2 ? atoi(argv[2]) : 0;
    softfall_error error = {0};
    softfall_case *c = NULL;
    softfall_model *model = NULL;
    if (count < 1) {
        fprintf(stderr, "usage: variants CASE DROPS [KEY=VALUE]...\n");
        return 64;
    }
    softfall_model **variant = calloc((size_t)count, sizeof *variant);
    softfall_error *errors = calloc((size_t)count, sizeof *errors);
    double *value = calloc(2 * (size_t)count, sizeof *value);
    softfall_status status =
        softfall_case_read(argv[1], (const char *const *)&argv[3], argc - 3, NULL, &c, &error);
    if (status == SOFTFALL_OK)
        status = softfall_model_build(c, NULL, &model, &error);
    double start = processor_time();
    for (int k = 0; k < count && status == SOFTFALL_OK; k++)
        status = softfall_model_vary(model, &(softfall_variant){.speed = 4.5 * (1 - 0.2 * k / count)},
                                     &variant[k], &error);
    if (status == SOFTFALL_OK)
        status =
            softfall_batch_run((const softfall_model *const *)variant, count, &batch, value, errors, &error);
    double time = processor_time() - start;
    if (status == SOFTFALL_OK)
        printf("%d drops, %.3g s of processor time each; %.2f g and HIC %.1f at 4.5 m/s\n", count,
               time / count, value[0], value[1]);
    else
        fprintf(stderr, "variants: %s\n", error.text);
    for (int k = 0; k < count; k++)
        softfall_model_free(variant[k]);
    softfall_model_free(model);
    softfall_case_free(c);
    free(variant);
    free(errors);
    free(value);
    return (int)status;
}
