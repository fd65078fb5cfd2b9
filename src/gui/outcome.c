/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/outcome.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "gui/gmsh/view.h"
#include "gui/gmsh/window.h"
#include "io/h5.h"
#include "pre/model_report.h"
#include "post/figures/figures.h"
#include "post/figures/verdict.h"

/* Keys of the report of softfall-pre (pre/model_report.c) that the tree shows, in its order. */
static const char *const keys[SF_CHECK_ENTRIES] = {
    "nodes",      "cells",      "missile", "drop_height", "impact_point", "spacing_under_missile",
    "mesh_error", "first_step", "memory",  "run_time",
};

sf_status sf_checks_read(const char *model, sf_check_entries *out, sf_error *err) {
    sf_h5 *file = NULL;
    char *text = NULL;
    out->count = 0;
    if (sf_h5_open(model, &file, err) == SF_OK)
        sf_h5_read_text(file, "/provenance/report", &text, err);
    for (int k = 0; text && k < SF_CHECK_ENTRIES; k++) {
        sf_check_entry *e = &out->entry[out->count];
        char name[SF_CHECK_NAME - 16];
        if (!sf_model_report_find(text, keys[k], name, sizeof name, e->value, sizeof e->value))
            continue; /* a prescribed motion has no drop height */
        snprintf(e->name, sizeof e->name, "3Checks/%02d%s", k, name);
        out->count++;
    }
    free(text);
    sf_error ignored = SF_ERROR_INIT; /* nothing was written */
    sf_h5_close(&file, &ignored);
    return err->status;
}

void sf_checks_show(const sf_check_entries *checks) {
    for (int k = 0; k < checks->count; k++) {
        const sf_check_entry *e = &checks->entry[k];
        sf_window_put(
            &(sf_entry){.name = e->name, .kind = SF_ENTRY_SHOWN, .text = e->value, .help = e->value});
    }
}

void sf_checks_clear(const sf_check_entries *checks) {
    for (int k = 0; k < checks->count; k++)
        sf_window_remove(checks->entry[k].name);
}

void sf_checks_sentence(const char *text, char *out, size_t size) {
    const char *last = NULL, *line = text;
    *out = '\0';
    while (line && *line) {
        const char *end = strchr(line, '\n');
        if (*line != '\n' && strncmp(line, "softfall-", 9) == 0)
            last = line;
        line = end ? end + 1 : NULL;
    }
    const char *colon = last ? strstr(last, ": ") : NULL;
    if (colon)
        snprintf(out, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
}

void sf_checks_progress(const char *text, char *out, size_t size) {
    const char *last = NULL, *line = text;
    size_t used = 0;
    while (line && *line) {
        const char *end = strchr(line, '\n');
        if (strncmp(line, "t ", 2) == 0)
            last = line;
        line = end ? end + 1 : NULL;
    }
    for (; last && *last && *last != '\n' && used + 1 < size; last++)
        if (*last != ' ' || (used > 0 && out[used - 1] != ' '))
            out[used++] = *last;
    out[used] = '\0';
}

static const char GOOD[] = "LightGreen", FAIR[] = "Khaki", BAD[] = "LightCoral";

/* Below the buttons, at all times: a tree that grows would move what the user is about to click. */
static const char *const names[] = {"1Drop/70verdict",
                                    "1Drop/71a_max",
                                    "1Drop/72HIC",
                                    "1Drop/73rebound",
                                    "1Drop/74largest indentation",
                                    "1Drop/75largest local strain"};
enum { VERDICT, A_MAX, HIC, REBOUND, INDENTATION, STRAIN, ENTRIES };
enum { FILTER = 1000 }; /* CFC of curve and figures */

static void put(int which, const char *text, const char *colour) {
    sf_window_put(&(sf_entry){
        .name = names[which], .kind = SF_ENTRY_SHOWN, .text = text, .help = text, .colour = colour});
}

void sf_outcome_clear(void) {
    for (int k = 0; k < ENTRIES; k++)
        put(k, "–", NULL);
}

static const char *limit_colour(const sf_limit *limit) {
    return !limit->judged ? NULL : limit->passed ? GOOD : BAD;
}

/* The digits are those that summary.json has, and more than a reader needs. */
static void show_limits(const sf_figures *f, const sf_verdict *v) {
    char text[160];
    if (v->limit_count < SF_LIMITS)
        return;
    snprintf(text, sizeof text, "%.9g g (limit %g g: %s)", f->injury.a_max_g, v->limits[0].bound,
             sf_limit_phrase(&v->limits[0]));
    put(A_MAX, text, limit_colour(&v->limits[0]));
    snprintf(text, sizeof text, "%.9g, window %.2f to %.2f ms (limit %g: %s)", f->injury.hic.value,
             1e3 * f->injury.hic.t1, 1e3 * f->injury.hic.t2, v->limits[1].bound,
             sf_limit_phrase(&v->limits[1]));
    put(HIC, text, limit_colour(&v->limits[1]));
}

static void show_motion(const sf_figures *f) {
    char text[160];
    if (f->rebounded)
        snprintf(text, sizeof text, "%.9g m/s at %.2f ms", f->v_rebound, 1e3 * f->rebound_time);
    else
        snprintf(text, sizeof text, "not reached");
    if (!f->driven)
        put(REBOUND, text, NULL);
    snprintf(text, sizeof text, "%.4g mm", 1e3 * f->max_indentation);
    put(INDENTATION, text, NULL);
    snprintf(text, sizeof text, "%.4g", f->max_local_strain);
    put(STRAIN, text, NULL);
}

sf_status sf_outcome_show(const sf_results *r, char *line, size_t size, sf_error *err) {
    sf_figures f = {0};
    sf_verdict verdict;
    const sf_limits limits = SF_DEFAULT_LIMITS;
    sf_outcome_clear();
    if (sf_figures_compute(r, FILTER, &f, err) == SF_OK) {
        sf_verdict_compute(r, &f, &limits, &verdict);
        sf_verdict_line(&verdict, line, size);
        put(VERDICT, line,
            verdict.grade == SF_GRADE_VALID     ? GOOD
            : verdict.grade == SF_GRADE_REMARKS ? FAIR
                                                : BAD);
        if (f.touched) {
            show_limits(&f, &verdict);
            show_motion(&f);
        }
    }
    sf_figures_free(&f);
    return err->status;
}

static void plot(const char *title, int64_t count, const double *time, const double *value, double scale) {
    double *x = malloc(2 * (size_t)count * sizeof *x + 1), *y = x ? x + count : NULL;
    for (int64_t k = 0; x && k < count; k++) {
        x[k] = 1e3 * time[k];
        y[k] = value[k] / scale;
    }
    if (x)
        sf_view_plot(title, "t [ms]", count, x, y);
    free(x);
}

void sf_outcome_plot(const sf_results *r) {
    const sf_history *h = &r->history;
    sf_figures f = {0};
    sf_error none = SF_ERROR_INIT;
    char title[64];
    if (sf_figures_compute(r, FILTER, &f, &none) == SF_OK) {
        snprintf(title, sizeof title, "%s%sacceleration, CFC %d [g]", f.turns ? "resultant " : "",
                 f.kinematic ? "kinematic " : "", FILTER);
        plot(title, f.filtered.count, f.filtered.time, f.filtered.value, 1);
    } else {
        plot("raw, along the direction [g]", h->rows, h->time, h->acceleration, SF_STANDARD_GRAVITY);
    }
    sf_figures_free(&f);
}
