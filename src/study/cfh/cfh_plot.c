/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_plot.h"

#include "study/cfh/spread_report.h"
#include "report/gnuplot.h"
#include <math.h>

/* Heights (m) of the picture: the successes, the failures not far above them, and a margin. */
static void height_range(const sf_cfh_report *r, double range[2]) {
    const sf_cfh_points *points = r->points;
    double low = points->point[0].height, high = points->point[points->count - 1].height;
    if (r->result->highest > 0)
        high = fmin(high, 1.3 * r->result->highest);
    double margin = fmax(0.06 * (high - low), 0.02 * high);
    range[0] = fmax(low - margin, 0);
    range[1] = high + margin;
}

/* From 0 to a bit above the limit and the largest value. */
static double value_top(const sf_cfh_report *r, sf_cfh_criterion c) {
    double top = r->plan->limit[c];
    for (int k = 0; k < r->points->count; k++)
        if (!r->points->point[k].failed)
            top = fmax(top, r->points->point[k].value[c]);
    return 1.12 * top;
}

static void put_style(FILE *g, const sf_cfh_report *r) {
    double range[2];
    height_range(r, range);
    fputs("set key at screen 0.54,0.025 center center horizontal maxcols 5 Left reverse samplen 2 width 2\n",
          g);
    fprintf(g, "set xrange [%.6g:%.6g]\n", range[0], range[1]);
}

/* The x axis below the lower panel, the rig's above the upper one. */
static void put_panel_axes(FILE *g, const sf_cfh_report *r, sf_cfh_criterion c) {
    bool upper = c == SF_CFH_A_MAX;
    double range[2];
    height_range(r, range);
    if (upper && r->rig->pairs > 0)
        fprintf(g,
                "set x2range [%.6g:%.6g]\nset x2tics nomirror out scale 0.6\nset border 7\n"
                "set x2label 'drop height on the rig (m)' offset 0,-0.4\n",
                sf_cfh_rig_height(r->rig, range[0]), sf_cfh_rig_height(r->rig, range[1]));
    else
        fputs("unset x2tics\nunset x2label\nset border 3\n", g);
    fputs(upper ? "set format x ''\nunset xlabel\n"
                : "set format x '%g'\nset xlabel 'drop height, free fall (m)'\n",
          g);
    fputs(upper ? "set key off\n" : "set key on\n", g); /* one key, below both */
    fprintf(g, "set ylabel '%s'\nset yrange [0:%.6g]\n", upper ? "a_max (g)" : "HIC", value_top(r, c));
}

/* The interval of the crossing as a band, where the draws give one. */
static void put_interval(FILE *g, const sf_cfh_report *r, sf_cfh_criterion c, const char *colour) {
    double range[2];
    if (!r->spread)
        return;
    height_range(r, range);
    const sf_cfh_interval *interval = sf_cfh_spread_whole(r->spread, (int)c);
    double low = fmax(interval->low, range[0]), high = fmin(interval->high, range[1]);
    if (low < high)
        fprintf(
            g,
            "set object 1 rectangle from first %.9g, graph 0 to first %.9g, first %.9g back fc rgb '%s' fs "
            "solid 0.25 noborder\n",
            low, high, r->plan->limit[c], colour);
}

/* The crossing as a line with its height beside it. */
static void put_crossing(FILE *g, const sf_cfh_report *r, sf_cfh_criterion c) {
    const sf_cfh_crossing *crossing = &r->result->crossing[c];
    bool decides = r->result->verdict == SF_CFH_FOUND && r->result->deciding == c;
    const char *colour = decides ? "#cb181d" : "#606060";
    fputs("unset object\nunset arrow\nunset label\n", g);
    fprintf(g,
            "set label 2 'limit %g%s' at graph 0.01, first %.9g left offset 0,0.7 front tc rgb '#cb181d'\n",
            r->plan->limit[c], sf_cfh_unit(c), r->plan->limit[c]);
    put_interval(g, r, c, colour);
    if (isnan(crossing->height))
        return;
    fprintf(g,
            "set arrow 1 from first %.9g, graph 0 to first %.9g, first %.9g nohead front lw 2 lc rgb '%s'\n",
            crossing->height, crossing->height, r->plan->limit[c], colour);
    fprintf(g, "set label 1 '%.3f m%s' at first %.9g, first %.9g right offset -0.6,0.8 front tc rgb '%s'\n",
            crossing->height, decides ? ", decides" : "", crossing->height, r->plan->limit[c], colour);
}

static bool any_failed(const sf_cfh_points *points) {
    for (int k = 0; k < points->count; k++)
        if (points->point[k].failed)
            return true;
    return false;
}

static void put_curves(FILE *g, const sf_cfh_report *r, sf_cfh_criterion c) {
    const sf_cfh_fit *fit = &r->result->crossing[c].fit;
    int column = c == SF_CFH_A_MAX ? 3 : 4;
    if (fit->count > 0)
        fprintf(g, "fit(h) = exp(%.12g + %.12g*(log(h) - %.12g) + %.12g*(log(h) - %.12g)**2)\n", fit->c[0],
                fit->c[1], fit->centre, fit->c[2], fit->centre);
    fputs("plot ", g);
    if (r->spread)
        fprintf(
            g,
            "'cfh_band.csv' skip 1 using 1:%d:%d with filledcurves fc rgb '#6baed6' fs solid 0.4 noborder title "
            "'95 %% of the draws', \\\n     ",
            c == SF_CFH_A_MAX ? 2 : 5, c == SF_CFH_A_MAX ? 4 : 7);
    fprintf(g, "%.9g with lines lw 2.5 dt 2 lc rgb '#cb181d' title 'limit', \\\n     ", r->plan->limit[c]);
    if (fit->count > 0) {
        double lowest = 0, highest = 0;
        for (int k = 0, n = 0; k < r->points->count; k++) {
            if (r->points->point[k].failed)
                continue;
            if (n == fit->first)
                lowest = r->points->point[k].height;
            if (n == fit->first + fit->count - 1)
                highest = r->points->point[k].height;
            n++;
        }
        fprintf(
            g,
            "[h=%.9g:%.9g] '+' using (h):(fit(h)) with lines lw 3.5 lc rgb '#08519c' title 'fit', \\\n     ",
            lowest, highest);
    }
    fprintf(g, "'cfh.csv' skip 1 using 1:%d with points pt 7 ps 1.8*dot lc rgb '#08519c' title 'simulated'",
            column);
    if (any_failed(r->points))
        fputs(
            ", \\\n     'cfh.csv' skip 1 using ($11 == 1 ? $1 : NaN):(0) with points pt 2 ps 2.2*dot lw 3 lc "
            "rgb '#606060' title 'failed'",
            g);
    fputc('\n', g);
}

/* The title says the verdict in a few words. */
static void put_title(FILE *g, const sf_cfh_report *r) {
    const sf_cfh_result *v = r->result;
    fprintf(
        g,
        "set multiplot layout 2,1 margins 0.11,0.97,0.155,%s spacing 0,0.05 title (svg ? '' : 'Critical fall height",
        r->rig->pairs > 0 ? "0.855" : "0.93");
    if (v->verdict == SF_CFH_FOUND)
        fprintf(g, " %.3f m of free fall", v->crossing[v->deciding].height);
    else if (v->verdict == SF_CFH_ABOVE)
        fprintf(g, " above %.3f m of free fall", v->highest);
    else if (v->verdict == SF_CFH_BELOW)
        fprintf(g, " below %.3f m of free fall", v->lowest);
    else
        fputs(" not determined", g);
    if (v->verdict == SF_CFH_FOUND && r->rig->pairs > 0)
        fprintf(g, ", %.3f m on the rig", sf_cfh_rig_height(r->rig, v->crossing[v->deciding].height));
    if (r->spread) {
        char text[64];
        fprintf(g, "; 95 %% interval %s",
                sf_cfh_interval_text(sf_cfh_spread_whole(r->spread, SF_CFH_FIRST), text, sizeof text));
    }
    fputs(" (indicative)')\n", g);
}

sf_status sf_cfh_plot(const sf_staging *output, const sf_cfh_report *r, char *warning, size_t size,
                      sf_error *err) {
    FILE *g = sf_gnuplot_begin(output, "cfh", 1600, 1300, err);
    if (!g)
        return err->status;
    put_style(g, r);
    put_title(g, r);
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        put_panel_axes(g, r, c);
        put_crossing(g, r, c);
        put_curves(g, r, c);
    }
    fputs("unset multiplot\n", g);
    if (sf_staging_close(g, "cfh.gp", err) != SF_OK)
        return err->status;
    sf_gnuplot_draw(output, "cfh", warning, size);
    return SF_OK;
}
