/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/sweep_report.h"

#include "base/text.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include "study/sweep/campaign.h"

/* ---- which ---- */

static sf_status add(sf_sweep_views *v, int64_t row, const char *reason, sf_error *err) {
    int k = 0;
    while (k < v->count && v->view[k].row != row)
        k++;
    if (row < 0)
        return SF_OK;
    if (k == SF_SWEEP_VIEWS)
        return SF_REFUSE(err, "--views: more than %d runs", SF_SWEEP_VIEWS);
    if (k == v->count)
        v->view[v->count++] = (sf_sweep_view){.row = row};
    sf_text_add(v->view[k].reason, sizeof v->view[k].reason, "%s%s", *v->view[k].reason ? ", " : "", reason);
    return SF_OK;
}

/* The usable row of the largest figure; with `limit` the one that is nearest to it. -1: there is none. */
static int64_t find_row(const sf_runs *r, int figure, double limit) {
    int64_t best = -1;
    double most = -INFINITY;
    for (int64_t row = 0; row < r->count; row++) {
        double value = sf_runs_value(r, row, figure), merit = isnan(limit) ? value : -fabs(value - limit);
        if (merit > most) {
            most = merit;
            best = row;
        }
    }
    return best;
}

/* For each figure of the plan; with `runs` NULL only counts those that have a limit. */
static int add_found(const sf_plan *p, const sf_runs *runs, bool by_limit, sf_sweep_views *v, sf_error *err) {
    char reason[80];
    int figures = 0;
    for (int k = 0; k < p->figure_count; k++) {
        const sf_sweep_limit *f = &p->figure[k];
        snprintf(reason, sizeof reason, by_limit ? "%s nearest to its limit" : "largest %s", f->figure);
        if (by_limit && isnan(f->limit))
            continue;
        figures++;
        if (runs)
            add(v, find_row(runs, k, by_limit ? f->limit : NAN), reason, err);
    }
    return figures;
}

static sf_status take_word(const char *word, const sf_plan *p, const sf_runs *runs, sf_sweep_views *v,
                           sf_error *err) {
    char *end = NULL;
    long long id = strtoll(word, &end, 10);
    if (strcmp(word, "all") == 0) {
        for (int64_t row = 0; row < p->rows && err->status == SF_OK; row++)
            add(v, row, "all", err);
    } else if (strcmp(word, "worst") == 0 || strcmp(word, "limit") == 0) {
        if (add_found(p, runs, *word == 'l', v, err) == 0)
            SF_REFUSE(err, "--views limit: no figure of the plan has a limit");
    } else if (end == word || *end || id < 1 || id > p->rows) {
        SF_REFUSE(err, "--views: \"%s\" is neither worst, limit, all nor the id of one of the %lld runs",
                  word, (long long)p->rows);
    } else {
        add(v, id - 1, "asked for", err);
    }
    return err->status;
}

sf_status sf_sweep_views_choose(const char *words, const sf_plan *p, const sf_runs *runs, sf_sweep_views *v,
                                sf_error *err) {
    SF_OWNED char *copy = strdup(words);
    char *rest = copy;
    *v = (sf_sweep_views){0};
    for (char *word = strsep(&rest, ","); word && err->status == SF_OK; word = strsep(&rest, ","))
        take_word(word, p, runs, v, err);
    return err->status;
}

/* ---- their reports ---- */

/* A drop that failed on its way has results, too. */
static sf_status make_view(const sf_plan *p, const char *parent, int threads, sf_sweep_view *v,
                           sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE], page[SF_RUN_PATH_SIZE + 32];
    const char *overrides[SF_RUNNER_OVERRIDES];
    sf_run_folder at;
    sf_error failure = SF_ERROR_INIT, unreported = SF_ERROR_INIT;
    int count = sf_plan_overrides(p, v->row, text, overrides);
    if (sf_run_folder_name(parent, SF_SWEEP_LABEL, p->case_path, count, overrides, &at, &failure) == SF_OK)
        sf_run_folder_simulate(&at, p->case_path, count, overrides, threads, &failure);
    if (failure.status == SF_OK || (failure.status == SF_ERR_NUMERIC && sf_replace_exists(at.results))) {
        sf_run_folder_report(&at, &unreported);
        snprintf(page, sizeof page, "%s/report/view.html", at.path);
        v->has_view = sf_replace_exists(page);
        snprintf(v->folder, sizeof v->folder, "%.40s/report", sf_path_name(at.path));
    }
    if (failure.status == SF_OK)
        failure = unreported;
    if (unreported.status != SF_OK)
        *v->folder = '\0';
    snprintf(v->problem, sizeof v->problem, "%.500s", failure.status != SF_OK ? failure.text : "");
    return failure.status == SF_INTERRUPTED ? sf_run_folder_interrupted(err) : SF_OK;
}

sf_status sf_sweep_views_make(const sf_plan *plan, const char *directory, int threads, sf_sweep_views *views,
                              sf_error *err) {
    char parent[PATH_MAX];
    SF_TRY(sf_path_print(parent, sizeof parent, err, "%s/views", directory));
    SF_TRY(sf_folder_own(parent, err));
    for (int k = 0; k < views->count && err->status == SF_OK; k++)
        make_view(plan, parent, threads, &views->view[k], err);
    return err->status;
}

static void put_view(FILE *page, const sf_runs *r, const sf_sweep_view *v) {
    char text[SF_FACTOR_KEY_SIZE + SF_SWEEP_OVERRIDE_SIZE],
        head[SF_FACTOR_KEY_SIZE + SF_FACTOR_UNIT_SIZE + 8];
    const sf_plan *p = r->plan;
    fprintf(page, "<p>Run %lld (", (long long)v->row + 1);
    sf_html_text(page, v->reason);
    fputs("): ", page);
    for (int f = 0; f < p->factor_count; f++) {
        sf_html_text(page, sf_factor_heading(&p->factor[f], head, sizeof head));
        fputs(" ", page);
        sf_html_text(page, sf_factor_text(&p->factor[f], sf_plan_value(p, f, v->row), text, sizeof text));
        fputs("; ", page);
    }
    for (int k = 0; k < p->figure_count; k++) {
        double value = sf_runs_place(r, v->row)[r->column[k]];
        if (isfinite(value))
            fprintf(page, "%s %.4g; ", p->figure[k].figure, value);
    }
    if (*v->folder)
        fprintf(page, "<a href=\"views/%s/report.html\">report</a> ", v->folder);
    if (*v->folder && v->has_view)
        fprintf(page, "<a href=\"views/%s/view.html\">view</a> ", v->folder);
    sf_html_text(page, v->problem);
    fputs("</p>\n", page);
}

void sf_sweep_views_put(FILE *page, const sf_runs *r, const sf_sweep_views *v) {
    if (v->count == 0)
        return;
    sf_html_heading(page, "Runs to look at");
    for (int k = 0; k < v->count; k++)
        put_view(page, r, &v->view[k]);
    sf_html_note(page, "These runs were simulated once more with all fields, for a report and a view in the "
                       "browser of each. The links are relative to this page.");
}

void sf_sweep_views_json(sf_json *j, const sf_sweep_views *v) {
    SF_JSON_ARRAY(j, "views");
    for (int k = 0; k < v->count; k++) {
        SF_JSON_OBJECT(j, NULL);
        sf_json_integer(j, "id", v->view[k].row + 1);
        sf_json_text(j, "reason", v->view[k].reason);
        sf_json_text(j, "folder", *v->view[k].folder ? v->view[k].folder : NULL);
        sf_json_text(j, "problem", *v->view[k].problem ? v->view[k].problem : NULL);
    }
}
