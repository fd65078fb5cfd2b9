/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/plot.h"

#include "base/text.h"
#include "report/chart.h"

enum { WIDTH = 1600, HEIGHT = 830 };
static const double SEEN = 0.01; /* of the largest value: a curve this far from another is seen beside it */

/* The curves of a drop and their ranges. */
typedef struct picture {
    const sf_summary *drop;
    double limit;    /* g, of a_max; INFINITY: none */
    double time[2];  /* s */
    double value[2]; /* g */
    bool raw;        /* the raw curve is seen beside the filtered one */
    bool points;     /* the points of the measured file are seen beside the measured curve */
    bool limited;    /* the limit lies within the axis */
} picture;

/* Widens the range by the part of the curve that is above this fraction of its largest value. */
static void widen(const sf_series *s, double fraction, double shift, double range[2]) {
    double bound = fraction * fmax(0, s->value[sf_series_peak(s)]);
    int64_t first = 0, last = s->count - 1;
    while (first < last && s->value[first] <= bound)
        first++;
    while (last > first && s->value[last] <= bound)
        last--;
    if (last <= first)
        return;
    range[0] = fmin(range[0], s->time[first] + shift);
    range[1] = fmax(range[1], s->time[last] + shift);
}

void sf_plot_time_range(const sf_figures *f, const sf_comparison *c, double range[2]) {
    const sf_series *model = &f->filtered;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    widen(model, 0.02, 0, range);
    if (!(range[1] > range[0])) {
        range[0] = model->time[0];
        range[1] = model->time[model->count - 1];
        return;
    }
    double first = range[0], last = range[1], margin = 0.06 * (last - first);
    if (c) { /* noise before and after its pulse is not one */
        widen(&c->measured.curve, 0.05, c->shift, range);
        range[0] = fmax(range[0], first - 3 * margin);
        range[1] = fmin(range[1], last + 3 * margin);
    }
    range[0] -= margin;
    range[1] += margin;
    if (!c && range[0] < model->time[0] + margin)
        range[0] = model->time[0];
}

double sf_plot_difference(const sf_series *a, const sf_series *b, const double range[2]) {
    double difference = 0, top = 0;
    for (int64_t i = 0; i < a->count; i++) {
        if (a->time[i] < range[0] || a->time[i] > range[1])
            continue;
        difference = fmax(difference, fabs(a->value[i] - sf_series_at(b, a->time[i])));
        top = fmax(top, fabs(a->value[i]));
    }
    return top > 0 ? difference / top : 0;
}

/* The axis runs from 0, or below 0 if the curves really go there, to a bit above the highest of them and,
 * unless that is far above, the limit. */
static void find_values(picture *p) {
    const sf_series *curves[3] = {&p->drop->figures->filtered, p->raw ? &p->drop->figures->raw : NULL,
                                  !p->drop->comparison ? NULL
                                  : p->points          ? &p->drop->comparison->measured.raw
                                                       : &p->drop->comparison->measured.curve};
    double low = 0, high = 0;
    for (int k = 0; k < 3; k++) {
        double shift = k == 2 && p->drop->comparison ? p->drop->comparison->shift : 0;
        for (int64_t i = 0; curves[k] && i < curves[k]->count; i++) {
            double time = curves[k]->time[i] + shift;
            if (time < p->time[0] || time > p->time[1])
                continue;
            low = fmin(low, curves[k]->value[i]);
            high = fmax(high, curves[k]->value[i]);
        }
    }
    p->limited = high > 0.25 * p->limit;
    if (p->limited)
        high = fmax(high, p->limit);
    p->value[0] = low < -0.02 * high ? 1.1 * low : low < 0 ? -0.02 * high : 0; /* ripples of the filter */
    p->value[1] = high > 0 ? 1.12 * high : 1;
}

static bool points_are_seen(const picture *p) {
    const sf_comparison *c = p->drop->comparison;
    const double range[2] = {p->time[0] - c->shift, p->time[1] - c->shift};
    return sf_plot_difference(&c->measured.raw, &c->measured.curve, range) > SEEN;
}

/* The drop with its verdict, and both limits with pass or fail. */
static void put_title(sf_chart *chart, const picture *p) {
    const sf_results *r = p->drop->results;
    char limits[160] = "";
    for (int k = 0; k < p->drop->verdict->limit_count; k++) {
        const sf_limit *limit = &p->drop->verdict->limits[k];
        if (isfinite(limit->value))
            sf_text_add(limits, sizeof limits, "%s%s %.4g, limit %.4g: %s", *limits ? "; " : "\n",
                        limit->title, limit->value, limit->bound, sf_limit_phrase(limit));
    }
    sf_chart_title(chart, "Missile of %.3g kg at %.3g m/s on a foam pad of %.4g mm: %s%s", r->missile_mass,
                   r->missile_speed, r->thickness * 1e3, sf_verdict_phrase(p->drop->verdict->grade), limits);
}

/* The part of the filtered curve within the HIC window, shaded. */
static void put_hic(sf_chart *chart, const picture *p) {
    const sf_hic *hic = &p->drop->figures->injury.hic;
    const sf_series *curve = &p->drop->figures->filtered;
    sf_series_data *area =
        sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_AREA, .colour = "#c6dbef"},
                        "HIC %.1f: %.2f to %.2f ms", hic->value, hic->t1 * 1e3, hic->t2 * 1e3);
    for (int64_t k = 0; k < curve->count; k++)
        if (curve->time[k] >= hic->t1 && curve->time[k] <= hic->t2)
            sf_series_point(area, 1e3 * curve->time[k], curve->value[k]);
}

static void put_curve(sf_chart *chart, const sf_series *curve, double shift, double width, const char *colour,
                      const char *title) {
    sf_series_data *line = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = colour, .width = width}, "%s", title);
    for (int64_t k = 0; k < curve->count; k++)
        sf_series_point(line, 1e3 * (curve->time[k] + shift), curve->value[k]);
}

/* The measured points stand thin and pale behind the curves, as they may be noisy. */
static void put_curves(sf_chart *chart, const picture *p) {
    const sf_figures *f = p->drop->figures;
    const sf_comparison *c = p->drop->comparison;
    char title[224], class[32] = "";
    if (f->injury.hic.value > 0)
        put_hic(chart, p);
    if (p->points)
        put_curve(chart, &c->measured.raw, c->shift, 1.2, "#a0a0a0", "measured, as in its file");
    if (p->raw)
        put_curve(chart, &f->raw, 0, 1.2, "#fd8d3c", "raw");
    snprintf(title, sizeof title, "%sCFC %.0f%s", c ? "model, " : "", f->cfc, f->passed);
    put_curve(chart, &f->filtered, 0, 4, "#08519c", title);
    if (!c)
        return;
    if (c->cfc > 0)
        snprintf(class, sizeof class, ", CFC %.0f", c->cfc);
    snprintf(title, sizeof title, "measured%s: a_max %.1f g", class, c->injury.a_max_g);
    put_curve(chart, &c->measured.curve, c->shift, 2, "#202020", title);
}

static void put_drop(sf_chart *chart, sf_panel *panel, const picture *p) {
    const sf_injury *i = &p->drop->figures->injury;
    put_title(chart, p);
    sf_axis_label(&panel->x, "time (ms)");
    sf_axis_range(&panel->x, p->time[0] * 1e3, p->time[1] * 1e3);
    sf_axis_label(&panel->y, "%s (g)", p->drop->figures->acceleration);
    snprintf(panel->y.page_label, sizeof panel->y.page_label, "acceleration (g)");
    sf_axis_range(&panel->y, p->value[0], p->value[1]);
    panel->key = SF_KEY_BELOW;
    panel->key_columns = SF_PLOT_KEY_COLUMNS;
    if (p->limited)
        sf_chart_level(chart, p->limit, "#cb181d", "limit %g g", p->limit);
    if (p->drop->figures->touched && i->a_max_g > 0)
        sf_chart_spot(chart, i->a_max_time * 1e3, i->a_max_g, "#08306b", "a_max %.1f g", i->a_max_g);
    put_curves(chart, p);
}

/* Stress over strain of a compression test. */
static void put_compression(sf_chart *chart, sf_panel *panel, const picture *p) {
    const sf_results *r = p->drop->results;
    const sf_history *h = &r->history;
    double area = p->drop->figures->area;
    sf_chart_title(chart, "Compression of a foam specimen of %.4g mm, %.4g cm²: %s", r->thickness * 1e3,
                   area * 1e4, sf_verdict_phrase(p->drop->verdict->grade));
    sf_axis_label(&panel->x, "strain");
    sf_axis_label(&panel->y, "nominal stress (kPa)");
    sf_series_points(
        sf_chart_series(chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c", .width = 3},
                        NULL),
        h->rows, h->indentation, h->contact_force, 1 / r->thickness, 1e-3 / area, 0);
}

const char *sf_plot_name(const sf_figures *figures) {
    return figures->driven ? "compression" : "acceleration";
}

sf_status sf_plot_write(const sf_staging *output, const sf_summary *summary, char *warning, size_t size,
                        sf_error *err) {
    const sf_figures *figures = summary->figures;
    const sf_verdict *verdict = summary->verdict;
    picture p = {.drop = summary, .limit = verdict->limit_count ? verdict->limits[0].bound : INFINITY};
    sf_plot_time_range(figures, summary->comparison, p.time);
    p.raw = sf_plot_difference(&figures->raw, &figures->filtered, p.time) > SEEN;
    p.points = summary->comparison && points_are_seen(&p);
    find_values(&p);
    sf_chart *chart = sf_chart_new(sf_plot_name(figures), WIDTH, HEIGHT, err);
    sf_panel *panel = sf_chart_panel(chart);
    if (figures->driven)
        put_compression(chart, panel, &p);
    else
        put_drop(chart, panel, &p);
    return sf_chart_write(chart, output, warning, size, err);
}
