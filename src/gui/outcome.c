/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/outcome.h"

#include "base/units.h"
#include "gui/gmsh/view.h"
#include "gui/gmsh/window.h"
#include "post/figures/figures.h"
#include "post/figures/verdict.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char GOOD[] = "LightGreen", FAIR[] = "Khaki", BAD[] = "LightCoral";

static const char *const names[] = {"4Results/1verdict",
                                    "4Results/2a_max",
                                    "4Results/3HIC",
                                    "4Results/4rebound",
                                    "4Results/5largest indentation",
                                    "4Results/6largest local strain"};
enum { VERDICT, A_MAX, HIC, REBOUND, INDENTATION, STRAIN, ENTRIES };
enum { FILTER = 1000 }; /* CFC of curve and figures */

void sf_outcome_clear(void) {
    for (int k = 0; k < ENTRIES; k++)
        sf_window_remove(names[k]);
}

static void put(int which, const char *text, const char *colour) {
    sf_window_put(&(sf_entry){
        .name = names[which], .kind = SF_ENTRY_SHOWN, .text = text, .help = text, .colour = colour});
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
