/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop in the host's own process, from a case file: prints its peak deceleration and HIC.
 *
 *     cc drop.c -o drop $(pkg-config --cflags --libs softfall-build)
 *     ./drop ../eva50-v4.5/case.cfg missile.velocity="5.2 m/s"
 *
 * or with CMake, see CMakeLists.txt. */
#include <softfall/softfall.h>
#include <stdio.h>

static void tell(void *user, softfall_severity severity, const char *sentence) {
    (void)user;
    fprintf(stderr, "%s: %s\n", severity == SOFTFALL_WARNING ? "warning" : "note", sentence);
}

/* Follows the drop: the host may look at anything here, or end it. */
static int observe(void *user, const softfall_drop *drop) {
    double *deepest = user, now = softfall_drop_latest(drop, "indentation");
    if (now > *deepest)
        *deepest = now;
    return 0;
}

int main(int argc, char **argv) {
    softfall_case *c = NULL;
    softfall_model *model = NULL;
    softfall_drop *drop = NULL;
    softfall_error error = {SOFTFALL_OK, ""};
    softfall_figures *figures = NULL;
    const softfall_sink sink = {tell, NULL};
    const softfall_drop_options options = {.threads = 2};
    double deepest = 0, a_max = 0, hic = 0;
    if (argc < 2) {
        fprintf(stderr, "usage: drop CASE [GROUP.KEY=VALUE]...\n");
        return SOFTFALL_INPUT;
    }
    if (softfall_case_read(argv[1], (const char *const *)&argv[2], argc - 2, &sink, &c, &error) ||
        softfall_model_build(c, &sink, &model, &error) ||
        softfall_drop_create(model, &options, &drop, &error) ||
        softfall_drop_run(drop, observe, &deepest, NULL, &error) ||
        softfall_drop_figures(drop, 1000, &figures, &error) ||
        softfall_figure(figures, "a_max_g", &a_max, &error) || softfall_figure(figures, "hic", &hic, &error))
        fprintf(stderr, "drop: %s\n", error.text);
    else
        printf("a_max %.9g g\nHIC %.9g\nindentation %.9g mm\n", a_max, hic, 1e3 * deepest);
    softfall_figures_free(figures);
    softfall_drop_free(drop);
    softfall_model_free(model);
    softfall_case_free(c);
    return error.status;
}
