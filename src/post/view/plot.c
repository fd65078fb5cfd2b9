/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/plot.h"

#include "report/gnuplot.h"
#include <math.h>

enum { WIDTH = 1600, HEIGHT = 830 };
static const double SEEN = 0.01; /* of the largest value: a curve this far from another is seen beside it */

/* What the picture of a drop shows. */
typedef struct picture {
    const sf_results *results;
    const sf_figures *figures;
    const sf_comparison *comparison; /* NULL: nothing was measured */
    const sf_verdict *verdict;
    double limit;    /* g, of a_max; INFINITY: none */
    double time[2];  /* s */
    double value[2]; /* g */
    bool raw;        /* the raw curve is seen beside the filtered one */
    bool points;     /* the points of the measured file are seen beside the measured curve */
    bool limited;    /* the limit lies within the axis */
} picture;

static double largest(const sf_series *s) {
    double value = 0;
    for (int64_t i = 0; i < s->count; i++)
        value = fmax(value, s->value[i]);
    return value;
}

/* Widens the range by the part of the curve that is above this fraction of its largest value. */
static void widen(const sf_series *s, double fraction, double shift, double range[2]) {
    double bound = fraction * largest(s);
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
        widen(&c->measured, 0.05, c->shift, range);
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

/* From 0, or below it if the curves really go there, to a bit above the highest of them and, unless that is
 * far above, the limit. */
static void find_values(picture *p) {
    const sf_series *curves[3] = {&p->figures->filtered, p->raw ? &p->figures->raw : NULL,
                                  !p->comparison ? NULL
                                  : p->points    ? &p->comparison->raw
                                                 : &p->comparison->measured};
    double low = 0, high = 0;
    for (int k = 0; k < 3; k++) {
        double shift = k == 2 && p->comparison ? p->comparison->shift : 0;
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
    const sf_comparison *c = p->comparison;
    const double range[2] = {p->time[0] - c->shift, p->time[1] - c->shift};
    return sf_plot_difference(&c->raw, &c->measured, range) > SEEN;
}

/* The title: the drop with its verdict, and both limits with pass or fail. A report has both in its text. */
static void put_title(FILE *g, const picture *p) {
    const sf_results *r = p->results;
    fprintf(g, "set title \"Missile of %.3g kg at %.3g m/s on a foam pad of %.4g mm: %s", r->missile_mass,
            r->missile_speed, r->thickness * 1e3, sf_verdict_phrase(p->verdict->grade));
    for (int k = 0; k < p->verdict->limit_count; k++) {
        const sf_limit *limit = &p->verdict->limits[k];
        if (isfinite(limit->value))
            fprintf(g, "%s%s %.4g, limit %.4g: %s", k ? "; " : "\\n", limit->title, limit->value,
                    limit->bound, sf_limit_phrase(limit));
    }
    fputs("\"\nif (svg) { unset title }\n", g);
}

/* The limit of a_max as a line. */
static void put_limit(FILE *g, const picture *p) {
    if (p->limited)
        fprintf(
            g,
            "set arrow from graph 0, first %.9g to graph 1, first %.9g nohead lw 2.5 dt 2 lc rgb '#cb181d'\n"
            "set label 'limit %g g' at graph 0.01, first %.9g left offset 0,0.6 tc rgb '#cb181d'\n",
            p->limit, p->limit, p->limit, p->limit);
}

static void put_axes(FILE *g, const picture *p) {
    put_title(g, p);
    fprintf(g,
            "set xlabel 'time (ms)'\nset ylabel '%s (g)'\nset xzeroaxis lw 1 lc rgb '#808080'\n"
            "if (svg) { set ylabel 'acceleration (g)' } # its caption says which\n",
            sf_figures_acceleration(p->figures));
    fprintf(g, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", p->time[0] * 1e3, p->time[1] * 1e3,
            p->value[0], p->value[1]);
    put_limit(g, p);
}

/* A disc at the filtered peak, and its value beside it. */
static void put_peak(FILE *g, const picture *p) {
    const sf_injury *i = &p->figures->injury;
    if (!p->figures->touched || !(i->a_max_g > 0))
        return;
    fprintf(
        g,
        "set label 'a_max %.1f g' at %.9g,%.9g left offset 1.2,0.5 tc rgb '#08306b' front point pt 7 ps 1.6*dot "
        "lc rgb '#08306b'\n",
        i->a_max_g, i->a_max_time * 1e3, i->a_max_g);
}

static void put_hic(FILE *g, const sf_hic *hic) {
    fprintf(
        g,
        "'acceleration.csv' skip 1 using 1:($1 >= %.9g && $1 <= %.9g ? $2 : NaN) with filledcurves y=0 fc "
        "rgb '#c6dbef' title 'HIC %.1f: %.2f to %.2f ms', \\\n     ",
        hic->t1 * 1e3, hic->t2 * 1e3, hic->value, hic->t1 * 1e3, hic->t2 * 1e3);
}

/* Thin and pale behind the curves, as they may be noisy. */
static void put_points(FILE *g) {
    fputs(
        "'reference.csv' skip 1 using 1:4 with lines lw 1.2 lc rgb '#a0a0a0' title 'measured, as in its file', "
        "\\\n     ",
        g);
}

static void put_measured(FILE *g, const sf_comparison *c) {
    fprintf(g,
            ", \\\n     'reference.csv' skip 1 using 1:2 with lines lw 2 lc rgb '#202020' title 'measured");
    if (c->cfc > 0)
        fprintf(g, ", CFC %.0f", c->cfc);
    fprintf(g, ": a_max %.1f g'", c->injury.a_max_g);
}

static void put_curves(FILE *g, const picture *p) {
    const sf_figures *f = p->figures;
    bool hic = f->injury.hic.value > 0;
    sf_gnuplot_key(g, 1 + hic + p->raw + (p->comparison != NULL) + p->points, SF_PLOT_KEY_COLUMNS);
    fputs("plot ", g);
    if (hic)
        put_hic(g, &f->injury.hic);
    if (p->points)
        put_points(g);
    if (p->raw)
        fputs("'history.csv' skip 1 using 1:2 with lines lw 1.2 lc rgb '#fd8d3c' title 'raw', \\\n     ", g);
    fprintf(g, "'acceleration.csv' skip 1 using 1:2 with lines lw 4 lc rgb '#08519c' title '%sCFC %.0f'",
            p->comparison ? "model, " : "", f->cfc);
    if (p->comparison)
        put_measured(g, p->comparison);
    fputc('\n', g);
}

/* Stress over strain of a compression test. */
static void put_compression(FILE *g, const sf_results *r, const sf_figures *f, const sf_verdict *v) {
    fprintf(g,
            "set title 'Compression of a foam specimen of %.4g mm, %.4g cm²: %s'\nif (svg) { unset title }\n",
            r->thickness * 1e3, f->area * 1e4, sf_verdict_phrase(v->grade));
    fputs("set xlabel 'strain'\nset ylabel 'nominal stress (kPa)'\nunset key\n"
          "plot 'compression.csv' skip 1 using 2:3 with lines lw 3 lc rgb '#08519c'\n",
          g);
}

const char *sf_plot_name(const sf_figures *figures) {
    return figures->driven ? "compression" : "acceleration";
}

sf_status sf_plot_write(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                        const sf_comparison *comparison, const sf_verdict *verdict, char *warning,
                        size_t size, sf_error *err) {
    const char *name = sf_plot_name(figures);
    picture p = {.results = results,
                 .figures = figures,
                 .comparison = comparison,
                 .verdict = verdict,
                 .limit = verdict->limit_count ? verdict->limits[0].bound : INFINITY};
    sf_plot_time_range(figures, comparison, p.time);
    p.raw = sf_plot_difference(&figures->raw, &figures->filtered, p.time) > SEEN;
    p.points = comparison && points_are_seen(&p);
    find_values(&p);
    FILE *script = sf_gnuplot_begin(output, name, WIDTH, HEIGHT, err);
    if (!script)
        return err->status;
    if (figures->driven) {
        put_compression(script, results, figures, verdict);
    } else {
        put_axes(script, &p);
        put_peak(script, &p);
        put_curves(script, &p);
    }
    if (sf_staging_close(script, name, err) != SF_OK)
        return err->status;
    sf_gnuplot_draw(output, name, warning, size);
    return SF_OK;
}
