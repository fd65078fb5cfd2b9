/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/runner.h"

static void judge(const sf_results *r, const sf_figures *f, sf_runner_result *out) {
    sf_verdict verdict;
    const sf_limits limits = SF_DEFAULT_LIMITS; /* no part of the grade */
    sf_verdict_compute(r, f, &limits, &verdict);
    out->grade = verdict.grade;
    sf_verdict_line(&verdict, out->verdict, sizeof out->verdict);
}

static sf_status take_figures(const sf_results *r, const sf_figures *f, sf_runner_result *out,
                              sf_error *err) {
    out->figure = sf_alloc(err, SF_FIGURE_TOTAL, sizeof *out->figure, "figures");
    for (size_t k = 0; out->figure && k < SF_FIGURE_TOTAL; k++)
        out->figure[k] = sf_figure_number(&sf_figure_at[k], r, f);
    snprintf(out->status, sizeof out->status, "%.*s", (int)sizeof out->status - 1, r->status);
    return err->status;
}

double sf_runner_figure(const sf_runner_result *result, const char *key) {
    return result->figure ? result->figure[sf_figure_find(key) - sf_figure_at] : NAN;
}

/* Sets the numbers that are figures; what has no figure is NaN. */
static void take_numbers(sf_runner_result *out) {
    out->a_max_g = sf_runner_figure(out, "a_max_g");
    out->hic = sf_runner_figure(out, "hic");
    out->v0 = sf_runner_figure(out, "v0_m_s");
    out->v_rebound = sf_runner_figure(out, "v_rebound_m_s");
    out->max_indentation = 1e-3 * sf_runner_figure(out, "max_indentation_mm");
    out->energy_error = sf_runner_figure(out, "energy_error");
}

/* The end of every reading: the path, or nothing if anything failed. */
static sf_status finish_result(const char *path, sf_runner_result *out, sf_error *err) {
    out->path = strdup(path);
    if (!out->path)
        SF_NO_MEMORY(err, "the path %s", path);
    if (err->status != SF_OK)
        sf_runner_result_free(out);
    return err->status;
}

/* For the next time, if it is the results of a drop that ran to its end. */
static void write_record(const sf_run_folder *at, const sf_results *r, const sf_figures *f,
                         const sf_runner_result *result) {
    bool finished = strcmp(r->status, "finished") == 0 || strcmp(r->status, "rebound") == 0;
    SF_OWNED char *geometry =
        finished ? sf_campaign_geometry_list(at->results, "/provenance/model/geometry_files") : NULL;
    if (geometry)
        sf_run_record_write(at->figures, at->results, r, f, result->grade, result->verdict, geometry);
}

/* Writes the record of the figures, too. */
static sf_status read_result(const sf_run_folder *at, sf_runner_result *out, sf_error *err) {
    const char *path = at->results;
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    SF_TRY(sf_results_open(path, &r, err));
    if (sf_figures_compute(&r, 1000, &f, err) == SF_OK && !f.touched)
        SF_REFUSE(err, "the missile of %s never touched the pad", path);
    SF_TRY(err->status);
    *out = (sf_runner_result){.hic_window = f.injury.hic.t2 - f.injury.hic.t1,
                              .contact_time = f.rebound_time - r.contact_time,
                              .max_local_strain = f.max_local_strain,
                              .curve = f.filtered};
    judge(&r, &f, out);
    write_record(at, &r, &f, out);
    f.filtered = (sf_series){0};
    if (take_figures(&r, &f, out, err) == SF_OK)
        take_numbers(out);
    return finish_result(path, out, err);
}

/* Adds the figures of a drop of a series, from 1, to those of the drops before it. */
static void add_figures(const sf_run_folder *at, int drop, const double *figure, double *sum) {
    int counted = __builtin_popcountll((unsigned long long)at->counted);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++) {
        bool whole =
            strcmp(sf_figure_at[k].row.key, "steps") == 0 || strcmp(sf_figure_at[k].row.key, "wall_s") == 0;
        sum[k] += whole || at->counted >> (drop - 1) & 1 ? figure[k] : 0;
        sum[k] /= drop == at->drops && !whole ? counted : 1;
    }
}

/* Adds a drop of a series to the result, which holds those before it: the worst of both. Moves its curve. */
static void add_drop(int drop, sf_runner_result *one, sf_runner_result *all) {
    if (drop == 1 || one->grade > all->grade) {
        all->grade = one->grade;
        snprintf(all->verdict, sizeof all->verdict, "drop %d: %.*s", drop, SF_VERDICT_LINE_SIZE - 20,
                 one->verdict);
    }
    all->max_local_strain = fmax(all->max_local_strain, one->max_local_strain);
    sf_series_free(&all->curve);
    all->curve = one->curve;
    one->curve = (sf_series){0};
    all->hic_window = one->hic_window;
    all->contact_time = one->contact_time;
    memcpy(all->status, one->status, sizeof all->status);
}

sf_status sf_runner_read(const sf_run_folder *at, sf_runner_result *out, sf_error *err) {
    sf_runner_result all = {0};
    if (at->drops == 1)
        return read_result(at, out, err);
    all.figure = sf_alloc(err, SF_FIGURE_TOTAL, sizeof *all.figure, "figures");
    for (int k = 1; k <= at->drops && err->status == SF_OK; k++) {
        const sf_run_folder drop = sf_run_folder_of_drop(at, k);
        SF_OWNED_BY(sf_runner_result_free) sf_runner_result one = {0};
        if (read_result(&drop, &one, err) != SF_OK)
            break;
        add_figures(at, k, one.figure, all.figure);
        add_drop(k, &one, &all);
    }
    take_numbers(&all);
    *out = all;
    return finish_result(at->results, out, err);
}

void sf_runner_result_free(sf_runner_result *result) {
    sf_series_free(&result->curve);
    SF_CLEAR(result, result->path, result->figure);
}
