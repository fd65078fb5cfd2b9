/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/series.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static const double STRAIN_MARGIN = 0.02; /* beyond the end of its data: worth a warning */
_Static_assert((int)SF_CFH_CHECKS <= (int)SF_CFH_MAX_POINTS, "the checks are simulated as one batch");

__attribute__((format(printf, 2, 3))) static void add_note(sf_cfh_point *point, const char *format, ...) {
    size_t used = strlen(point->note);
    va_list args;
    if (used > 0)
        used += (size_t)snprintf(point->note + used, sizeof point->note - used, "; ");
    if (used >= sizeof point->note)
        return;
    va_start(args, format);
    vsnprintf(point->note + used, sizeof point->note - used, format, args);
    va_end(args);
}

/* Strains beyond the data of their foam, of each layer. */
static void note_extrapolation(const sf_runner_result *r, const sf_cfh_foams *foams, sf_cfh_point *p) {
    for (int k = 0; k < foams->count; k++) {
        const sf_cfh_foam *foam = &foams->foam[k];
        bool layer = foams->count > 1;
        double strain = layer && k < r->layer_count ? r->layer_strain[k] : layer ? NAN : r->max_local_strain;
        if (strain > foam->end + STRAIN_MARGIN)
            add_note(p, "largest local strain%s%s%s %.3f, %s %.3f: extrapolated curve",
                     layer ? " of the layer \"" : "", layer ? foam->name : "", layer ? "\"" : "", strain,
                     foam->words, foam->end);
    }
}

sf_cfh_point sf_cfh_point_at(double height) {
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
        add_note(p, "%s", r->verdict);
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
        add_note(p, "contact had not ended at the end of the run: a_max and HIC may be too low");
    note_extrapolation(r, foams, p);
    if (r->grade == SF_GRADE_REMARKS)
        add_note(p, "%s", r->verdict);
}

/* The pad below the missile, once. */
static sf_status learn_pad(const sf_runner_result *result, sf_cfh_pad *pad, sf_error *err) {
    sf_results r;
    if (!pad || pad->columns.count > 0)
        return SF_OK;
    SF_TRY(sf_results_open(result->path, &r, err));
    pad->mesh_error = r.expected_mesh_error;
    sf_columns_build(&r, &pad->columns, err);
    sf_results_close(&r);
    return err->status;
}

static void report_failure(const sf_runner *runner, const char *label, const sf_cfh_point *p) {
    if (runner->log)
        fprintf(runner->log, "  %-24s %7.4g m/s  %s\n", label, p->speed, p->note);
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
    d->point[k] = sf_cfh_point_at(height);
    snprintf(d->velocity[k], sizeof d->velocity[k], "missile.velocity=%.12g m/s", d->point[k].speed);
    drop->label = d->label[k];
    drop->material = material ? material : drop->material;
    drop->overrides[drop->override_count++] = d->velocity[k];
}

static void take_failure(const sf_error *failure, sf_cfh_point *p) {
    p->failed = true;
    p->on_anvil = strstr(failure->text, SF_ENDED_ON_ANVIL) != NULL;
    p->grade = SF_GRADE_DO_NOT_USE;
    add_note(p, "the simulation failed: %s", failure->text);
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
    if (p->failed)
        report_failure(runner, label, p);
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

static void take_check(sf_cfh_spread *spread, const sf_cfh_point *point, sf_cfh_check *check) {
    check->failed = point->failed;
    memcpy(check->note, point->note, sizeof check->note);
    memcpy(check->simulated, point->value, sizeof check->simulated);
    if (!check->failed)
        sf_cfh_check_compare(spread, check);
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
    for (int k = 0; k < d.count; k++)
        take_check(spread, &d.point[k], &spread->check[k]);
    return SF_OK;
}
