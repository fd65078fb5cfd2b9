/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: figures of drops and of results in files, with their verdict. */
#include "api/api.h"
#include "post/figures/verdict.h"

#define ONE(...) +1
struct softfall_figures {
    int count;
    softfall_quantity figure[SF_FIGURES(ONE)];
    double value[SF_FIGURES(ONE)];
    int grade;
    double sure; /* -, sf_verdict.sure */
    char status[512], verdict[SF_VERDICT_LINE_SIZE];
};

/* Fills the list of the figures that are numbers. */
static void list_figures(softfall_quantity *list, int *count) {
    *count = 0;
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        if (sf_figure_at[k].row.type != SF_ROW_TEXT)
            list[(*count)++] =
                (softfall_quantity){sf_figure_at[k].row.key, "", sf_figure_at[k].row.meaning, 1};
}

/* Takes the numbers of the list of figures, and the verdict. */
static sf_status compute(const sf_results *results, double filter, softfall_figures **out, sf_error *err) {
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    const sf_limits limits = SF_DEFAULT_LIMITS; /* no part of the grade */
    sf_verdict verdict;
    SF_TRY(softfall_check_filter(filter, err));
    SF_TRY(sf_figures_compute(results, filter, &f, err));
    softfall_figures *made = *out = sf_alloc(err, 1, sizeof *made, "figures");
    SF_TRY(err->status);
    list_figures(made->figure, &made->count);
    for (size_t k = 0, n = 0; k < SF_FIGURE_TOTAL; k++)
        if (sf_figure_at[k].row.type != SF_ROW_TEXT)
            made->value[n++] = sf_figure_number(&sf_figure_at[k], results, &f);
    sf_verdict_compute(results, &f, &limits, &verdict);
    made->grade = (int)verdict.grade;
    made->sure = verdict.sure;
    sf_verdict_line(&verdict, made->verdict, sizeof made->verdict);
    snprintf(made->status, sizeof made->status, "%s", results->status);
    return SF_OK;
}

softfall_status softfall_drop_figures(const softfall_drop *drop, double filter, softfall_figures **out,
                                      softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_drop_results_free) sf_results r = {0};
    const int before = softfall_enter(drop);
    *out = NULL;
    if (sf_drop_results(&drop->drop, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    omp_set_num_threads(before);
    return softfall_return(&err, error);
}

softfall_status softfall_results_figures(const char *path, double filter, softfall_figures **out,
                                         softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    *out = NULL;
    if (sf_results_open(path, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    return softfall_return(&err, error);
}

int softfall_figures_grade(const softfall_figures *figures) {
    return figures->grade;
}

double softfall_figures_sure(const softfall_figures *figures) {
    return figures->sure;
}

const char *softfall_figures_verdict(const softfall_figures *figures) {
    return figures->verdict;
}

const char *softfall_figures_status(const softfall_figures *figures) {
    return figures->status;
}

void softfall_figures_free(softfall_figures *figures) {
    free(figures);
}

const softfall_quantity *softfall_figures_list(const softfall_figures *figures, int *count) {
    static softfall_quantity list[SF_FIGURES(ONE)];
    if (!figures) {
#pragma omp critical(softfall_figures_list)
        list_figures(list, count);
        return list;
    }
    *count = figures->count;
    return figures->figure;
}

softfall_status softfall_figure(const softfall_figures *figures, const char *key, double *value,
                                softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int k = 0;
    while (k < figures->count && strcmp(figures->figure[k].name, key) != 0)
        k++;
    if (k < figures->count)
        *value = figures->value[k];
    else
        SF_REFUSE(&err, "unknown figure \"%.80s\"; softfall_figures_list has their keys", key);
    return softfall_return(&err, error);
}

softfall_status softfall_refine(double fine, double coarse, double ratio, double cells, double refined[2],
                                softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_figure_refine(fine, coarse, ratio, cells, refined, &err);
    return softfall_return(&err, error);
}
