/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "accuracy/section_drop.h"

#include "base/hash.h"
#include "base/mat3.h"
#include "drop/drop.h"
#include "io/folder.h"
#include "model/good_run.h"
#include "model/model_check.h"
#include "pre/drop_check.h"
#include "pre/vary.h"
#include <omp.h>

enum { FINE, EQUAL, FASTER, THINNER, DROPS };
enum { A_MAX, HIC, INDENTATION, FIGURES };

static const double CFC = 1000, PERCENT = 0.01;
static const double STEP_LIMIT = 50e-6, STEP_SAFETY = 0.97; /* s, -: of a case that gives none; shorter steps
                                                             * buy no accuracy */
enum { MOST_STEPS = 50000 };           /* a drop that has not ended then counts as one without rebound */
static const double ORDER_2 = 1.0 / 3; /* of the step to half the spacing: what is left with order 2 */
static const double DOUBT = 0.75;      /* of that step: orders from 0.95 on are covered */
static const double UNLIKE = 1.5;      /* on the error of a drop that is only like the one that is meant */
static const double LEAST[FIGURES] = {1.5e-3, 2e-4, 2e-4}; /* -: figures scatter as the mesh moves */

/* One drop on one thread; its figures are NaN if it fails or does not rebound. */
static void simulate(const sf_model *model, double figure[FIGURES]) {
    sf_drop drop;
    SF_OWNED_BY(sf_drop_results_free) sf_results results = {0};
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    sf_error err = SF_ERROR_INIT;
    figure[A_MAX] = figure[HIC] = figure[INDENTATION] = NAN;
    sf_drop_begin(model, NULL, 0, &drop, &err);
    for (int k = 0;
         k < MOST_STEPS && err.status == SF_OK && drop.failure.status == SF_OK && drop.ending == SF_DROP_RUNS;
         k++)
        sf_drop_step(&drop);
    if (err.status == SF_OK && drop.failure.status == SF_OK &&
        sf_drop_results(&drop, &results, &err) == SF_OK &&
        sf_figures_compute(&results, CFC, &f, &err) == SF_OK && f.rebounded) {
        figure[A_MAX] = f.injury.a_max_g;
        figure[HIC] = f.injury.hic.value;
        figure[INDENTATION] = f.max_indentation;
    }
    sf_drop_free(&drop);
}

/* The same from the store, which gets it if it is not there. */
static void run(const sf_model *model, const char *store, double figure[FIGURES]) {
    static const char KIND[] = "section";
    const size_t size = FIGURES * sizeof *figure;
    char hash[SF_MODEL_HASH_SIZE];
    uint64_t key;
    sf_stored found = {0};
    bool known = store && sf_store_begin_key(&key);
    if (known) {
        sf_model_hash(model, hash);
        key = sf_hash_bytes(key, hash, sizeof hash);
    }
    if (known && sf_store_find(store, KIND, key, &found) && found.size == size) {
        memcpy(figure, found.data, size);
    } else {
        simulate(model, figure);
        if (known)
            sf_store_keep(store, KIND, key, 1, &(sf_store_part){figure, size});
    }
    free(found.block);
}

/* The value for ever finer meshes, and its doubt over it. */
static void extrapolate(double figure[DROPS][FIGURES], int k, double *value, double *error) {
    double step = figure[FINE][k] - figure[EQUAL][k];
    *value = figure[FINE][k] + ORDER_2 * step;
    *error = DOUBT * fabs(step / *value) + LEAST[k];
}

static double change(double changed, double figure) {
    return isfinite(changed) ? changed / figure - 1 : 0;
}

static void take(double figure[DROPS][FIGURES], sf_section_drop *r) {
    const double *equal = figure[EQUAL], *fine = figure[FINE], *faster = figure[FASTER],
                 *thinner = figure[THINNER];
    *r = (sf_section_drop){0};
    if (!(equal[A_MAX] > 0 && fine[A_MAX] > 0))
        return;
    extrapolate(figure, A_MAX, &r->a_max_g, &r->a_max_error);
    extrapolate(figure, HIC, &r->hic, &r->hic_error);
    extrapolate(figure, INDENTATION, &r->indentation, &r->indentation_error);
    r->a_max_by_speed = change(faster[A_MAX], equal[A_MAX]);
    r->hic_by_speed = change(faster[HIC], equal[HIC]);
    r->a_max_by_thickness = change(thinner[A_MAX], equal[A_MAX]);
    r->hic_by_thickness = change(thinner[HIC], equal[HIC]);
}

/* Without one where the pad cannot be made thinner. */
static void make_thinner(const sf_kernel *kernel, sf_model *m) {
    if (sf_vary_thickness(m, kernel, m->thickness - SF_SECTION_DROP_THINNER, SF_IGNORED) != SF_OK)
        sf_model_free(m);
}

/* Side by side, each on one thread. */
static void run_all(sf_model *const model[DROPS], const char *store, double figure[DROPS][FIGURES]) {
    for (int k = 0; k < DROPS; k++)
        if (model[k]) {
            model[k]->run.step_limit = fmax(model[k]->run.step_limit, STEP_LIMIT);
            model[k]->run.step_safety = fmax(model[k]->run.step_safety, STEP_SAFETY);
        }
#pragma omp parallel for schedule(dynamic, 1) default(none) shared(model, store, figure)
    for (int k = 0; k < DROPS; k++) {
        omp_set_num_threads(1);
        if (model[k] && model[k]->node_count > 0)
            run(model[k], store, figure[k]);
        else
            figure[k][A_MAX] = figure[k][HIC] = NAN;
    }
}

/* Runs the drop of `section`, that of `fine`, the same with half the spacing, one that is 1 % faster and one
 * on a pad SF_SECTION_DROP_THINNER thinner, and fills `out` (docs/theory.md, section 14). Where the first two
 * do not rebound it is all 0; a change is 0 where its drop does not. `kernel`: of both; `a_max`: that of
 * `section`, g, 0 if it does not rebound. */
static sf_status run_section(const sf_model *section, sf_model *fine, const sf_kernel *kernel,
                             const char *store, sf_section_drop *out, double *a_max, sf_error *err) {
    SF_OWNED_BY(sf_model_free) sf_model equal = {0};
    SF_OWNED_BY(sf_model_free) sf_model faster = {0};
    SF_OWNED_BY(sf_model_free) sf_model thinner = {0};
    SF_TRY(sf_model_copy(section, &equal, err));
    SF_TRY(sf_model_copy(section, &faster, err));
    SF_TRY(sf_model_copy(section, &thinner, err));
    faster.missile.speed *= 1 + PERCENT;
    make_thinner(kernel, &thinner);
    sf_model *const model[DROPS] = {fine, &equal, &faster, &thinner};
    double figure[DROPS][FIGURES];
    run_all(model, store, figure);
    take(figure, out);
    *a_max = out->a_max_g > 0 ? figure[EQUAL][A_MAX] : 0;
    return SF_OK;
}

/* The error of a_max to expect in a drop that these are like; 0 where one of them fails or does not rebound.
 */
static double error_alike(sf_model *section, sf_model *fine, const char *store) {
    sf_model *const model[DROPS] = {[FINE] = fine, [EQUAL] = section};
    double figure[DROPS][FIGURES];
    sf_section_drop drop;
    run_all(model, store, figure);
    take(figure, &drop);
    return drop.a_max_g > 0 ? UNLIKE * (fabs(drop.a_max_g / figure[EQUAL][A_MAX] - 1) + drop.a_max_error) : 0;
}

/* The models of the section with the spacing of `model` and with half of it. */
static sf_status build_sections(const sf_case_input *input, const sf_model *model, sf_sections *sections,
                                sf_model built[SF_SECTIONS], sf_kernel *kernel, sf_error *err) {
    for (int k = model->axisymmetric ? SF_SECTION_FINE : 0; k < SF_SECTIONS; k++) {
        SF_OWNED_BY(sf_case_free) sf_case c = {0};
        SF_TRY(sf_case_read_values(input, NULL, NULL, &c, err));
        c.store = sections->store;
        *kernel = (sf_kernel){c.support_ratio, c.condition_limit};
        SF_TRY(sf_sections_build(sections, k, &c, &built[k], err));
    }
    return SF_OK;
}

/* Tells a coarse mesh; `error`: of a_max by the section's drops, with its sign; NaN: they do not tell it, and
 * the spacing does. */
static void warn(const sf_model *model, const sf_build_report *report, bool alike, double error,
                 const sf_sink *sink) {
    char how[64] = "by an axisymmetric drop on as thick a plate of this foam";
    if (isnan(error)) {
        sf_drop_warn_mesh(model, &report->zone, sink);
        return;
    }
    if (!alike)
        snprintf(how, sizeof how, "too %s, by drops of the section on finer meshes",
                 error < 0 ? "low" : "high");
    if (fabs(error) >= sf_good_run_limits()->mesh)
        sf_sink_tell(
            sink, SF_WARNING,
            "the nodal spacing under the missile is %.3g mm: expected error of a_max about %.2g %%, %s",
            1e3 * report->zone.spacing, 100 * fabs(error), how);
}

/* The error of a_max on the spacing of `equal`; NaN: the drops do not work. */
static double find_error(sf_sections *sections, const sf_kernel *kernel, sf_model *equal, sf_model *fine,
                         sf_model *model) {
    sf_error none = SF_ERROR_INIT;
    double a_max = 0;
    if (sections->alike) {
        double error = error_alike(equal, fine, sections->store);
        if (!(error > model->expected_mesh_error)) /* on few rows of cells it may be small by chance */
            return NAN;
        model->expected_mesh_error = error;
        return error;
    }
    run_section(model->axisymmetric ? model : equal, fine, kernel, sections->store, &model->section, &a_max,
                &none);
    return none.status == SF_OK && a_max > 0 ? a_max / model->section.a_max_g - 1 : NAN;
}

void sf_section_drop_refer(const sf_case_input *input, const sf_build_report *report, sf_sections *sections,
                           sf_model *model, const sf_sink *sink) {
    SF_OWNED_BY(sf_model_free) sf_model equal = {0};
    SF_OWNED_BY(sf_model_free) sf_model fine = {0};
    sf_model built[SF_SECTIONS] = {{0}};
    sf_kernel kernel;
    sf_error none = SF_ERROR_INIT;
    if (sections->mesh[SF_SECTION_FINE].node_count == 0)
        return;
    build_sections(input, model, sections, built, &kernel, &none);
    equal = built[SF_SECTION_EQUAL];
    fine = built[SF_SECTION_FINE];
    double error = none.status == SF_OK ? find_error(sections, &kernel, &equal, &fine, model) : NAN;
    warn(model, report, sections->alike, error, sink);
}
