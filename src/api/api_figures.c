/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a drop, of a results file or of a curve, by the functions that softfall-post calls. */
#include "model/flight.h"
#include "api/api_drop.h"

#include "post/figures/figures.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ONE(...) +1
struct softfall_figures {
    int count;
    softfall_quantity figure[SF_FIGURES(ONE)];
    double value[SF_FIGURES(ONE)];
};

static sf_status check_filter(double filter, sf_error *err) {
    if (filter == 60 || filter == 180 || filter == 600 || filter == 1000)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "filter: %g; the channel frequency classes are 60, 180, 600 and 1000",
                   filter);
}

/* True if the library offers the figure: a number of sf_figures. */
static bool is_offered(const sf_figure *figure) {
    return !figure->fact && figure->row.type != SF_ROW_TEXT;
}

static sf_status compute(const sf_results *results, double filter, softfall_figures **out, sf_error *err) {
    size_t count;
    const sf_figure *list = sf_figure_list(&count);
    sf_figures f = {0};
    if (check_filter(filter, err) != SF_OK || sf_figures_compute(results, filter, &f, err) != SF_OK)
        return err->status;
    softfall_figures *made = *out = sf_alloc(err, 1, sizeof *made, "figures");
    for (size_t k = 0; made && k < count; k++)
        if (is_offered(&list[k])) {
            made->figure[made->count] = (softfall_quantity){list[k].row.key, "", list[k].row.meaning, 1};
            made->value[made->count++] = sf_row_number(&list[k].row, &f);
        }
    sf_figures_free(&f);
    return err->status;
}

/* The drop as its results file would show it; the arrays stay the drop's. */
static sf_status view(const softfall_drop *d, sf_results *r, sf_error *err) {
    const sf_model *m = &d->model;
    *r = (sf_results){.node_count = m->node_count,
                      .position = m->position,
                      .volume = m->volume,
                      .symmetry_factor = m->symmetry_factor,
                      .thickness = m->thickness,
                      .informed_strain = sf_model_informed_strain(m),
                      .expected_mesh_error = m->expected_mesh_error > 0 ? m->expected_mesh_error : NAN,
                      .slit_fraction = m->slit_fraction,
                      .anvil_depth = m->anvil.depth,
                      .density = sf_model_density(m),
                      .given_back = sf_model_whole(m) * d->state.given_back,
                      .air = m->air,
                      .speed_scatter = m->run.speed_scatter,
                      .thickness_tolerance = m->run.thickness_tolerance,
                      .impact_x = m->missile.impact_known ? m->missile.impact[0] : NAN,
                      .impact_y = m->missile.impact_known ? m->missile.impact[1] : NAN,
                      .missile_mass = m->missile.mass,
                      .missile_speed = m->missile.speed,
                      .gravity_along = sf_missile_free_fall(m),
                      .kinematic = m->run.kinematic != 0,
                      .driven = sf_missile_is_driven(m),
                      .history = d->recorder.history};
    sf_flight_gravity(&m->missile, r->gravity);
    if (r->history.rows < 3)
        return SF_FAIL(err, SF_ERR_INPUT, "the drop has %lld steps: figures need 3 at least",
                       (long long)r->history.rows);
    return SF_OK;
}

softfall_status softfall_drop_figures(const softfall_drop *drop, double filter, softfall_figures **out,
                                      softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    *out = NULL;
    if (view(drop, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    return softfall_return(&err, error);
}

softfall_status softfall_results_figures(const char *path, double filter, softfall_figures **out,
                                         softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_results r = {0};
    *out = NULL;
    if (sf_results_open(path, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    sf_results_close(&r);
    return softfall_return(&err, error);
}

void softfall_figures_free(softfall_figures *figures) {
    free(figures);
}

const softfall_quantity *softfall_figures_list(const softfall_figures *figures, int *count) {
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
        SF_FAIL(&err, SF_ERR_INPUT, "there is no figure \"%.80s\"; softfall_figures_list has their keys",
                key);
    return softfall_return(&err, error);
}

/* Curves of the host. The arrays are read only. */

static sf_series borrow(const double *time, const double *value, int64_t count) {
    return (sf_series){.count = count, .time = (double *)time, .value = (double *)value};
}

softfall_status softfall_hic(const double *time, const double *deceleration, int64_t count, double window,
                             double *hic, double *t1, double *t2, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, deceleration, count);
    sf_hic found = {0};
    if (!(window > 0))
        SF_FAIL(&err, SF_ERR_INPUT, "window: %g s is not above 0", window);
    else if (sf_series_check(&curve, "the deceleration", &err) == SF_OK)
        sf_hic_evaluate(&curve, window, &found, &err);
    *hic = err.status == SF_OK ? found.value : NAN;
    if (t1)
        *t1 = found.t1;
    if (t2)
        *t2 = found.t2;
    return softfall_return(&err, error);
}

softfall_status softfall_cfc(const double *time, const double *value, int64_t count, double filter,
                             double *filtered, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, value, count);
    sf_series made = {0};
    if (check_filter(filter, &err) == SF_OK &&
        sf_series_check(&curve, "the curve to filter", &err) == SF_OK &&
        sf_signal_filter(&curve, filter, &made, &err) == SF_OK)
        for (int64_t i = 0; i < count; i++)
            filtered[i] = sf_series_at(&made, time[i]);
    sf_series_free(&made);
    return softfall_return(&err, error);
}
