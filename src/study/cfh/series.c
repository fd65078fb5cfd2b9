/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/spread.h"

#include "base/hash.h"
#include "base/text.h"
#include "case/read.h"
#include "study/material_file.h"
#include <unistd.h>

static const double STRAIN_MARGIN = 0.02; /* beyond the end of its data: worth a warning */
static const double HIC_POWER = 2.5;      /* of the deceleration */
_Static_assert((int)SF_CFH_CHECKS <= (int)SF_CFH_MAX_POINTS, "the checks are simulated as one batch");

/* Appends a sentence to the note of a point. */
#define ADD_NOTE(point, ...)                                                                                 \
    do {                                                                                                     \
        sf_text_add((point)->note, sizeof(point)->note, "%s", *(point)->note ? "; " : "");                   \
        sf_text_add((point)->note, sizeof(point)->note, __VA_ARGS__);                                        \
    } while (0)

/* Strains beyond the data of their foam, of each layer. */
static void note_extrapolation(const sf_runner_result *r, const sf_cfh_foams *foams, sf_cfh_point *p) {
    for (int k = 0; k < foams->count; k++) {
        const sf_cfh_foam *foam = &foams->foam[k];
        bool layer = foams->count > 1;
        double strain = layer && k < r->layer_count ? r->layer_strain[k] : layer ? NAN : r->max_local_strain;
        if (strain > foam->end + STRAIN_MARGIN)
            ADD_NOTE(p, "largest local strain%s%s%s %.3f, %s %.3f: extrapolated curve",
                     layer ? " of the layer \"" : "", layer ? foam->name : "", layer ? "\"" : "", strain,
                     foam->words, foam->end);
    }
}

/* A point without figures. */
static sf_cfh_point point_at(double height) {
    return (sf_cfh_point){.height = height,
                          .speed = sf_cfh_speed(height),
                          .value = {NAN, NAN},
                          .scatter = {NAN, NAN},
                          .v_rebound = NAN,
                          .max_indentation = NAN,
                          .max_local_strain = NAN,
                          .energy_error = NAN};
}

void sf_cfh_take_result(const sf_runner_result *r, const sf_cfh_foams *foams, sf_cfh_point *p) {
    p->grade = r->grade;
    if (r->grade == SF_GRADE_DO_NOT_USE) {
        p->failed = true;
        p->least[SF_CFH_A_MAX] = r->sure * r->a_max_g;
        p->least[SF_CFH_HIC] = pow(r->sure, HIC_POWER) * r->hic;
        ADD_NOTE(p, "%s", r->verdict);
        if (r->sure > 0)
            ADD_NOTE(p, "yet a_max is at least %.0f g and HIC %.0f", p->least[SF_CFH_A_MAX],
                     p->least[SF_CFH_HIC]);
        return;
    }
    p->value[SF_CFH_A_MAX] = r->a_max_g;
    p->value[SF_CFH_HIC] = r->hic;
    p->scatter[SF_CFH_A_MAX] = sf_runner_figure(r, "a_max_scatter");
    p->scatter[SF_CFH_HIC] = sf_runner_figure(r, "hic_scatter");
    p->v_rebound = r->v_rebound;
    p->max_indentation = r->max_indentation;
    p->max_local_strain = r->max_local_strain;
    p->energy_error = r->energy_error;
    if (isnan(r->v_rebound))
        ADD_NOTE(p, "contact had not ended at the end of the run: a_max and HIC may be too low");
    note_extrapolation(r, foams, p);
    if (r->grade == SF_GRADE_REMARKS)
        ADD_NOTE(p, "%s", r->verdict);
}

/* The pad below the missile, once. */
static sf_status learn_pad(const sf_runner_result *result, sf_cfh_pad *pad, sf_error *err) {
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    if (!pad || pad->columns.count > 0)
        return SF_OK;
    SF_TRY(sf_results_open(result->path, &r, err));
    pad->mesh_error = r.expected_mesh_error;
    return sf_columns_build(&r, &pad->columns, err);
}

/* Drops that run side by side. */
typedef struct drops {
    int count;
    char label[SF_CFH_MAX_POINTS][48], velocity[SF_CFH_MAX_POINTS][64];
    sf_runner_drop drop[SF_CFH_MAX_POINTS];
    sf_cfh_point point[SF_CFH_MAX_POINTS];
} drops;

/* The next one; its label is there. `material`: a file instead of the base's; NULL: none. */
static void add_drop(const sf_cfh_series *s, drops *d, const char *material, double height) {
    int k = d->count++;
    sf_runner_drop *drop = &d->drop[k];
    *drop = *s->base;
    d->point[k] = point_at(height);
    snprintf(d->velocity[k], sizeof d->velocity[k], "missile.velocity=%.12g m/s", d->point[k].speed);
    drop->label = d->label[k];
    drop->material = material ? material : drop->material;
    drop->overrides[drop->override_count++] = d->velocity[k];
}

static void take_failure(const sf_error *failure, sf_cfh_point *p) {
    p->failed = true;
    p->on_anvil = strstr(failure->text, SF_ENDED_ON_ANVIL) != NULL;
    p->grade = SF_GRADE_DO_NOT_USE;
    ADD_NOTE(p, "the simulation failed: %s", failure->text);
}

static sf_status take_drop(const sf_cfh_series *s, const sf_runner *runner, const char *label,
                           const sf_runner_result *result, const sf_error *failure, sf_cfh_point *p,
                           sf_error *err) {
    if (failure->status == SF_ERR_NUMERIC)
        take_failure(failure, p);
    else if (failure->status == SF_OK)
        sf_cfh_take_result(result, s->foams, p);
    else if (err->status == SF_OK)
        *err = *failure;
    if (p->failed && runner->log)
        fprintf(runner->log, "  %-24s %7.4g m/s  %s\n", label, p->speed, p->note);
    return err->status == SF_OK && failure->status == SF_OK ? learn_pad(result, s->pad, err) : err->status;
}

static sf_status run_drops(const sf_cfh_series *s, sf_runner *runner, drops *d, sf_error *err) {
    sf_runner_result result[SF_CFH_MAX_POINTS];
    sf_error failure[SF_CFH_MAX_POINTS];
    SF_TRY(sf_runner_run_each(runner, d->count, d->drop, result, failure, err));
    for (int k = 0; k < d->count; k++) {
        take_drop(s, runner, d->label[k], &result[k], &failure[k], &d->point[k], err);
        sf_runner_result_free(&result[k]);
    }
    return err->status;
}

sf_status sf_cfh_simulate(const sf_cfh_series *s, sf_runner *runner, sf_cfh_points *points,
                          sf_cfh_step *ending, sf_error *err) {
    sf_cfh_round round;
    *points = (sf_cfh_points){0};
    while ((*ending = sf_cfh_next(s->plan, points, &round)) == SF_CFH_SIMULATE) {
        drops d = {0};
        for (int k = 0; k < round.count; k++) {
            snprintf(d.label[k], sizeof d.label[k], "h%.4gm", sf_cfh_rig_height(s->rig, round.height[k]));
            add_drop(s, &d, NULL, round.height[k]);
        }
        SF_TRY(run_drops(s, runner, &d, err));
        for (int k = 0; k < d.count; k++)
            sf_cfh_points_add(points, &d.point[k]);
    }
    return SF_OK;
}

sf_status sf_cfh_simulate_checks(const sf_cfh_series *s, const sf_cfh_draws *draws, sf_runner *runner,
                                 sf_cfh_spread *spread, sf_error *err) {
    drops d = {0};
    for (int k = 0; k < spread->checks; k++) {
        const sf_cfh_check *check = &spread->check[k];
        snprintf(d.label[k], sizeof d.label[k], "draw-%03d-h%.4gm", check->draw + 1,
                 sf_cfh_rig_height(s->rig, check->height));
        add_drop(s, &d, draws->draw[check->draw].path, check->height);
    }
    if (d.count > 0 && run_drops(s, runner, &d, err) != SF_OK)
        return err->status;
    for (int k = 0; k < d.count; k++) {
        sf_cfh_check *check = &spread->check[k];
        check->failed = d.point[k].failed;
        memcpy(check->note, d.point[k].note, sizeof check->note);
        if (!check->failed)
            sf_cfh_check_take(d.point[k].value, check);
    }
    return SF_OK;
}

/* ---- the draws of a posterior ---- */

static const double SAME_DENSITY = 1e-6; /* relative */

/* The draws from 1 on, without a gap. */
static sf_status count_draws(const char *folder, int *count, sf_error *err) {
    char path[PATH_MAX];
    *count = sf_draws_count(folder, SF_CFH_MOST_DRAWS + 1);
    if (*count > SF_CFH_MOST_DRAWS)
        return SF_REFUSE(err, "--posterior %s: more than %d draws", folder, SF_CFH_MOST_DRAWS);
    for (int number = *count + 2; number <= SF_CFH_MOST_DRAWS; number++) {
        sf_draw_path(folder, number, path, sizeof path);
        if (access(path, F_OK) == 0)
            return SF_REFUSE(err, "--posterior %s: draw-%03d.cfg is there, but draw-%03d.cfg is not", folder,
                             number, *count + 1);
    }
    if (*count == 0)
        return SF_REFUSE(err, "--posterior %s: there is no draw-001.cfg", folder);
    if (*count < SF_CFH_LEAST_DRAWS)
        return SF_REFUSE(err, "--posterior %s: %d draws for an interval" SF_AT_LEAST("%d"), folder, *count,
                         SF_CFH_LEAST_DRAWS);
    return SF_OK;
}

static sf_status check_draw(const sf_cfh_draw *draw, const sf_material *own, sf_error *err) {
    double density = sf_material_density(&draw->material), expected = sf_material_density(own);
    if (draw->material.law != own->law)
        return SF_REFUSE(err, "--posterior: the law of %s is %s, that of the case's material %s", draw->path,
                         draw->material.law->name, own->law->name);
    if (fabs(density / expected - 1) > SAME_DENSITY)
        return SF_REFUSE(err,
                         "--posterior: the density of %s is %g kg/m3, that of the case's material %g kg/m3",
                         draw->path, density, expected);
    return SF_OK;
}

/* An override of the material would make it that of every draw. */
static sf_status check_overrides(int count, const char *const *overrides, sf_error *err) {
    static const char group[] = "material";
    for (int k = 0; k < count; k++) {
        const char *name = overrides[k] + strspn(overrides[k], " \t"), *end = name + strlen(group);
        if (strncmp(name, group, strlen(group)) == 0 && strchr(". \t=", *end) && *end)
            return SF_REFUSE(err,
                             "--set %s: with --posterior the draws are the material, and this would be the "
                             "same in every one of them",
                             overrides[k]);
    }
    return SF_OK;
}

static sf_status check_difference(const sf_cfh_draws *draws, sf_error *err) {
    uint64_t first = sf_material_hash(SF_HASH_START, &draws->draw[0].material);
    for (int k = 1; k < draws->count; k++)
        if (sf_material_hash(SF_HASH_START, &draws->draw[k].material) != first)
            return SF_OK;
    return SF_REFUSE(err, "--posterior %s: all %d draws are the same material", draws->folder, draws->count);
}

/* Both numbers of every draw, or none of any. */
static sf_status check_responses(sf_cfh_draws *draws, sf_error *err) {
    for (int k = 0; k < draws->count; k++) {
        const bool *given = draws->draw[k].response.given;
        bool stated = given[SF_FIT_A_MAX] || given[SF_FIT_HIC];
        if (stated && !(given[SF_FIT_A_MAX] && given[SF_FIT_HIC]))
            return SF_REFUSE(err, "--posterior: response_error of %s has no %s", draws->draw[k].path,
                             sf_drop_kind_get(given[SF_FIT_HIC] ? SF_FIT_A_MAX : SF_FIT_HIC)->error_key);
        if (k > 0 && stated != draws->with_response)
            return SF_REFUSE(err, "--posterior: %s has %s response_error, but %s has %s", draws->draw[k].path,
                             stated ? "a" : "no", draws->draw[0].path, stated ? "none" : "one");
        draws->with_response = stated;
    }
    return SF_OK;
}

/* list[0] is the place of the material. */
static sf_status read_draw(const char *case_path, int count, const char **list, const sf_material *own,
                           sf_cfh_draw *draw, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error reason = SF_ERROR_INIT;
    SF_PRINTED(material, PATH_MAX + 16, "material=@%s", draw->path);
    list[0] = material;
    if (sf_case_read(case_path, count, list, NULL, &c, &reason) != SF_OK)
        return SF_FAIL(err, reason.status, "--posterior: %.900s", reason.text);
    draw->material = c.material;
    draw->response = c.response_error;
    c.material = (sf_material){0};
    SF_TRY(check_draw(draw, own, err));
    return sf_material_law_build(&draw->material, &draw->law, err);
}

sf_status sf_cfh_draws_read(const char *folder, const char *case_path, int override_count,
                            const char *const *overrides, const sf_material *own, sf_cfh_draws *out,
                            sf_error *err) {
    const char *list[SF_RUNNER_OVERRIDES + 1];
    int count = 0;
    *out = (sf_cfh_draws){.folder = folder};
    SF_TRY(check_overrides(override_count, overrides, err));
    SF_TRY(count_draws(folder, &count, err));
    out->draw = sf_alloc(err, count, sizeof *out->draw, "draws");
    for (int k = 0; k < override_count; k++)
        list[k + 1] = overrides[k];
    while (err->status == SF_OK && out->count < count) {
        sf_cfh_draw *draw = &out->draw[out->count++];
        sf_draw_path(folder, out->count, draw->path, sizeof draw->path);
        read_draw(case_path, override_count + 1, list, own, draw, err);
    }
    if (err->status == SF_OK && check_responses(out, err) == SF_OK)
        check_difference(out, err);
    return err->status;
}

void sf_cfh_draws_free(sf_cfh_draws *draws) {
    for (int k = 0; k < draws->count; k++) {
        sf_material_law_free(&draws->draw[k].law);
        sf_material_free(&draws->draw[k].material);
    }
    SF_CLEAR(draws, draws->draw);
}
