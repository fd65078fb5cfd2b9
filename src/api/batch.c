/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: many drops side by side. */
#include "api/api.h"
#include "post/figures/verdict.h"

/* One drop of a batch; its figures into `values`. */
static softfall_status run_one(const softfall_model *model, const softfall_batch *batch, double *values,
                               softfall_error *error) {
    const softfall_drop_options options = {.threads = 1};
    softfall_drop *drop = NULL;
    softfall_figures *figures = NULL;
    softfall_status status = softfall_drop_create(model, &options, &drop, error);
    for (int k = 0; k < batch->keys; k++)
        values[k] = NAN;
    if (status == SOFTFALL_OK)
        status = softfall_drop_run(drop, NULL, NULL, NULL, error);
    if (status == SOFTFALL_OK)
        status = softfall_drop_figures(drop, batch->filter, &figures, error);
    for (int k = 0; k < batch->keys && status == SOFTFALL_OK; k++)
        status = softfall_figure(figures, batch->key[k], &values[k], error);
    softfall_figures_free(figures);
    softfall_drop_free(drop);
    return status;
}

static sf_status check_batch(const softfall_batch *batch, sf_error *err) {
    SF_TRY(softfall_check_filter(batch->filter, err));
    SF_TRY(softfall_check_threads(batch->threads, err));
    for (int k = 0; k < batch->keys; k++) {
        bool known = false;
        for (size_t f = 0; f < SF_FIGURE_TOTAL; f++)
            known = known || (sf_figure_at[f].row.type != SF_ROW_TEXT &&
                              strcmp(sf_figure_at[f].row.key, batch->key[k]) == 0);
        if (!known)
            return SF_REFUSE(err, "unknown figure \"%.80s\"; softfall_figures_list has their keys",
                             batch->key[k]);
    }
    return SF_OK;
}

softfall_status softfall_batch_run(const softfall_model *const *models, int64_t count,
                                   const softfall_batch *batch, double *values, softfall_error *errors,
                                   softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int threads = batch->threads > 0 ? batch->threads : omp_get_max_threads();
    if (check_batch(batch, &err) != SF_OK)
        return softfall_return(&err, error);
#pragma omp parallel for schedule(dynamic) num_threads(threads) default(none)                                \
    shared(models, count, batch, values, errors)
    for (int64_t k = 0; k < count; k++)
        run_one(models[k], batch, &values[k * batch->keys], &errors[k]);
    return softfall_return(&err, error);
}
