/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a drop or of a results file, by the one function that softfall-post calls. */
#include "api/drop.h"

#include "post/figures.h"

static sf_status check_filter(double filter, sf_error *err) {
    if (filter == 60 || filter == 180 || filter == 600 || filter == 1000)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "filter: %g; the channel frequency classes are 60, 180, 600 and 1000",
                   filter);
}

static softfall_figures show(const sf_figures *f) {
    return (softfall_figures){.touched = f->touched,
                              .rebounded = f->rebounded,
                              .a_max_g = f->injury.a_max_g,
                              .a_max_time = f->injury.a_max_time,
                              .hic = f->injury.hic.value,
                              .hic_t1 = f->injury.hic.t1,
                              .hic_t2 = f->injury.hic.t2,
                              .hic15 = f->injury.hic15.value,
                              .hic36 = f->injury.hic36.value,
                              .gadd = f->injury.gadd,
                              .clip_3ms_g = f->injury.clip_contiguous_g,
                              .a_max_raw_g = f->injury_raw.a_max_g,
                              .v0 = f->v0,
                              .v_rebound = f->v_rebound,
                              .absorbed_energy = f->absorbed_energy,
                              .max_indentation = f->max_indentation,
                              .max_mean_strain = f->max_mean_strain,
                              .max_local_strain = f->max_local_strain,
                              .energy_error = f->energy_error,
                              .stabilisation_energy_fraction = f->stabilisation_energy_fraction,
                              .contact_energy_fraction = f->contact_energy_fraction,
                              .peak_force = f->peak_force,
                              .peak_stress = f->peak_stress,
                              .work = f->work};
}

static sf_status compute(const sf_results *results, double filter, softfall_figures *out, sf_error *err) {
    sf_figures f = {0};
    if (check_filter(filter, err) == SF_OK && sf_figures_compute(results, filter, &f, err) == SF_OK)
        *out = show(&f);
    sf_figures_free(&f);
    return err->status;
}

/* The drop as its results file would show it; the arrays stay the drop's. */
static sf_status view(const softfall_drop *d, sf_results *r, sf_error *err) {
    const sf_model *m = &d->model;
    *r = (sf_results){.node_count = m->node_count,
                      .volume = m->volume,
                      .symmetry_factor = m->symmetry_factor,
                      .thickness = m->thickness,
                      .density = sf_material_density(&m->material[0]),
                      .missile_mass = m->missile.mass,
                      .missile_speed = m->missile.speed,
                      .driven = sf_missile_is_driven(m),
                      .history = d->recorder.history};
    if (r->history.rows < 3)
        return SF_FAIL(err, SF_ERR_INPUT, "the drop has %lld steps: figures need 3 at least",
                       (long long)r->history.rows);
    return SF_OK;
}

softfall_status softfall_drop_figures(const softfall_drop *drop, double filter, softfall_figures *figures,
                                      softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    *figures = (softfall_figures){0};
    if (view(drop, &r, &err) == SF_OK)
        compute(&r, filter, figures, &err);
    return softfall_return(&err, error);
}

static sf_status take_figure(const sf_figures *f, const char *key, double *value, sf_error *err) {
    const sf_figure *figure = sf_figure_find(key);
    if (!figure || figure->fact || figure->type != SF_FIGURE_DOUBLE)
        return SF_FAIL(err, SF_ERR_INPUT, "\"%.80s\" is no number of summary.json that a drop computes", key);
    *value = *(const double *)((const char *)f + figure->offset) * figure->factor;
    return SF_OK;
}

softfall_status softfall_drop_figure(const softfall_drop *drop, double filter, const char *key, double *value,
                                     softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    sf_figures f = {0};
    if (view(drop, &r, &err) == SF_OK && check_filter(filter, &err) == SF_OK &&
        sf_figures_compute(&r, filter, &f, &err) == SF_OK)
        take_figure(&f, key, value, &err);
    sf_figures_free(&f);
    return softfall_return(&err, error);
}

softfall_status softfall_results_figures(const char *path, double filter, softfall_figures *figures,
                                         softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_results r = {0};
    *figures = (softfall_figures){0};
    if (sf_results_open(path, &r, &err) == SF_OK)
        compute(&r, filter, figures, &err);
    sf_results_close(&r);
    return softfall_return(&err, error);
}
