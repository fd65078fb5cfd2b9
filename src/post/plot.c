/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/plot.h"

#include "io/gnuplot.h"
#include <math.h>

/* Time axis (ms): the run, and of a longer measured curve at most a bit more. */
static void time_range(const sf_figures *f, const sf_comparison *c, double range[2]) {
    range[0] = f->raw.time[0] * 1e3;
    range[1] = f->raw.time[f->raw.count - 1] * 1e3;
    if (c) {
        double margin = 0.15 * (range[1] - range[0]);
        double first = (c->measured.time[0] + c->shift) * 1e3;
        double last = (c->measured.time[c->measured.count - 1] + c->shift) * 1e3;
        range[0] = fmin(range[0], fmax(first, range[0] - margin));
        range[1] = fmax(range[1], fmin(last, range[1] + margin));
    }
}

/* From 0, or below it if the curves really go there, to a tenth above the highest of them (g). */
static void value_range(const sf_figures *f, const sf_comparison *c, double range[2]) {
    const sf_series *curves[3] = {&f->raw, &f->filtered, c ? &c->measured : NULL};
    double low = 0, high = 0;
    for (int k = 0; k < 3 && curves[k]; k++) {
        for (int64_t i = 0; i < curves[k]->count; i++) {
            low = fmin(low, curves[k]->value[i]);
            high = fmax(high, curves[k]->value[i]);
        }
    }
    range[0] = low < -0.02 * high ? 1.1 * low : 0;
    range[1] = high > 0 ? 1.1 * high : 1;
}

/* Settings common to all pictures; `name` without its ending. */
static void put_style(FILE *g, const char *name) {
    fprintf(g,
            "set terminal pngcairo size 1600,1000 font 'DejaVu Sans,20' noenhanced background rgb 'white'\n"
            "set output '%s.png'\n"
            "set datafile separator ','\n"
            "set encoding utf8\n"
            "set grid back lt 1 lc rgb '#c8c8c8' lw 1\nset border 3 lw 1.5 lc rgb '#404040'\n"
            "set tics nomirror out scale 0.6\nset xzeroaxis lw 1 lc rgb '#808080'\n",
            name);
}

/* The limit of a_max as a line, if the axis reaches it, and both limits with pass or fail. */
static void put_limits(FILE *g, const sf_verdict *v, double highest) {
    for (int k = 0; k < v->limit_count; k++) {
        const sf_limit *limit = &v->limits[k];
        if (isfinite(limit->value))
            fprintf(g, "set label '%s %.4g, limit %.4g: %s' at graph 0.99, graph %.2f right tc rgb '%s'\n",
                    limit->title, limit->value, limit->bound, limit->passed ? "passed" : "failed",
                    0.96 - 0.05 * k, limit->passed ? "#404040" : "#cb181d");
    }
    if (v->limit_count > 0 && v->limits[0].bound < highest)
        fprintf(
            g,
            "set arrow from graph 0, first %.6g to graph 1, first %.6g nohead lw 2 dt 3 lc rgb '#cb181d'\n",
            v->limits[0].bound, v->limits[0].bound);
}

static void put_axes(FILE *g, const sf_results *r, const sf_figures *f, const sf_comparison *c,
                     const sf_verdict *v) {
    double time[2], value[2];
    time_range(f, c, time);
    value_range(f, c, value);
    fprintf(g, "set title 'Missile of %.3g kg at %.3g m/s on a foam pad of %.4g mm: %s' offset 0,-0.3\n",
            r->missile_mass, r->missile_speed, r->thickness * 1e3, sf_verdict_phrase(v->grade));
    fputs("set xlabel 'time (ms)'\nset ylabel 'deceleration (g)'\n", g);
    fprintf(g, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", time[0], time[1], value[0], value[1]);
    fputs("set key below center horizontal maxcols 3 Left reverse samplen 2 width 1 spacing 1.2\n", g);
    put_limits(g, v, value[1]);
}

static void put_curves(FILE *g, const sf_figures *f, const sf_comparison *c) {
    fputs("plot ", g);
    if (f->injury.hic.value > 0)
        fprintf(g,
                "'history.csv' skip 1 using 1:($1 >= %.9g && $1 <= %.9g ? $3 : NaN) with filledcurves y=0 fc "
                "rgb '#c6dbef' title 'HIC %.1f: %.2f to %.2f ms', \\\n     ",
                f->injury.hic.t1 * 1e3, f->injury.hic.t2 * 1e3, f->injury.hic.value, f->injury.hic.t1 * 1e3,
                f->injury.hic.t2 * 1e3);
    fputs("'history.csv' skip 1 using 1:2 with lines lw 1.2 lc rgb '#fd8d3c' title 'raw', \\\n     ", g);
    fprintf(g, "'history.csv' skip 1 using 1:3 with lines lw 4 lc rgb '#08519c' title 'CFC %.0f", f->cfc);
    if (f->touched)
        fprintf(g, ": a_max %.1f g", f->injury.a_max_g);
    fputc('\'', g);
    if (c)
        fprintf(g,
                ", \\\n     'reference.csv' skip 1 using 1:2 with lines lw 3 dt 2 lc rgb '#202020' title "
                "'measured: a_max %.1f g, HIC %.1f'",
                c->injury.a_max_g, c->injury.hic.value);
    fputc('\n', g);
}

/* Stress over strain of a compression test. */
static void put_compression(FILE *g, const sf_results *r, const sf_figures *f, const sf_verdict *v) {
    fprintf(g, "set title 'Compression of a foam specimen of %.4g mm, %.4g cm²: %s' offset 0,-0.3\n",
            r->thickness * 1e3, f->area * 1e4, sf_verdict_phrase(v->grade));
    fputs("set xlabel 'strain'\nset ylabel 'nominal stress (kPa)'\nunset key\n"
          "plot 'compression.csv' skip 1 using 2:3 with lines lw 3 lc rgb '#08519c'\n",
          g);
}

sf_status sf_plot_write(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                        const sf_comparison *comparison, const sf_verdict *verdict, char *warning,
                        size_t size, sf_error *err) {
    const char *name = figures->driven ? "compression" : "acceleration";
    char source[32], picture[32];
    snprintf(source, sizeof source, "%s.gp", name);
    snprintf(picture, sizeof picture, "%s.png", name);
    FILE *script = sf_staging_open(output, source, err);
    if (!script)
        return err->status;
    put_style(script, name);
    if (figures->driven) {
        put_compression(script, results, figures, verdict);
    } else {
        put_axes(script, results, figures, comparison, verdict);
        put_curves(script, figures, comparison);
    }
    if (sf_staging_close(script, source, err) != SF_OK)
        return err->status;
    sf_gnuplot_draw(output, source, picture, warning, size);
    return SF_OK;
}
