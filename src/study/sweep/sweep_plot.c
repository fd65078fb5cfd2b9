/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/sweep_plot.h"

#include "report/gnuplot.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 4, SERIES = 8, POINTS = 3000, CURVES = 200, CURVE_POINTS = 300, BARS = SF_SWEEP_FACTORS };

static const sf_sweep_picture pictures[] = {
    {"factors",
     "Each figure against the factors that are numbers (the first four of them): a point is a run, lines join the means"},
    {"curves", "Deceleration over time of the runs (of more than 200 runs 200, drawn at random)"},
    {"effects",
     "Main effects, all else equal: the range of the means between the values of a factor, the greatest on top"},
    {"indices", "Sobol' indices, first order and total, with 95 % intervals"},
    {"surface", "Response surface: each run as the surface without the runs of its place predicts it"},
    {"probability",
     "Probability of staying below the limit; where a \"?\" stands, unknown runs (failed, or not to be "
     "used) are taken as above"},
    {NULL, NULL}};

static const char *const colours[SERIES] = {"#08519c", "#cb181d", "#238b45", "#6a51a3",
                                            "#d94801", "#17becf", "#8c6d31", "#525252"};

const sf_sweep_picture *sf_sweep_pictures(void) {
    return pictures;
}

/* A text between single quotes of gnuplot. */
static void put_text(FILE *g, const char *text) {
    fputc('\'', g);
    for (; *text; text++) {
        if (*text == '\'')
            fputc('\'', g);
        fputc(*text == '\n' ? ' ' : *text, g);
    }
    fputc('\'', g);
}

static void put_label(FILE *g, const char *command, const char *text) {
    fprintf(g, "%s ", command);
    put_text(g, text);
    fputc('\n', g);
}

static void put_factor_label(FILE *g, const char *command, const sf_factor *f) {
    char text[SF_FACTOR_KEY_SIZE + SF_FACTOR_UNIT_SIZE + 8];
    sf_factor_heading(f, text, sizeof text);
    put_label(g, command, text);
}

/* The last part of a level's name: a file without its folders. */
static const char *short_label(const char *label) {
    const char *slash = strrchr(label, '/');
    return slash ? slash + 1 : label;
}

static void level_text(const sf_factor *f, double value, char *text, size_t size) {
    char whole[SF_SWEEP_OVERRIDE_SIZE];
    if (f->words)
        snprintf(text, size, "%s", short_label(f->label[(int64_t)value]));
    else if (sf_factor_text(f, value, whole, sizeof whole), *f->unit)
        snprintf(text, size, "%.32s %s", whole, f->unit);
    else
        snprintf(text, size, "%.32s", whole);
}

/* ---- series: the levels of one chosen factor ---- */

typedef struct series {
    int factor; /* -1: one series */
    sf_groups groups;
} series;

static sf_status choose_series(const sf_plan *p, int other, series *s, sf_error *err) {
    *s = (series){.factor = -1};
    for (int f = 0; f < p->factor_count && s->factor < 0; f++) {
        if (f == other || p->factor[f].uncertain || (other >= 0 && p->block_of[f] == p->block_of[other]))
            continue;
        if (sf_groups_make(p, f, &s->groups, err) != SF_OK)
            return err->status;
        if (s->groups.count > 1 && s->groups.count <= SERIES)
            s->factor = f;
        else
            sf_groups_free(&s->groups);
    }
    return SF_OK;
}

static int series_count(const series *s) {
    return s->factor < 0 ? 1 : (int)s->groups.count;
}

static int series_of(const sf_plan *p, const series *s, int64_t row) {
    if (s->factor < 0)
        return 0;
    const sf_block *b = &p->block[p->block_of[s->factor]];
    return (int)s->groups.of_row[row / b->stride % b->rows];
}

static void put_series_title(FILE *g, const sf_plan *p, const series *s, int k) {
    char text[SF_FACTOR_KEY_SIZE + 160], level[128];
    if (s->factor < 0) {
        fputs("notitle", g);
        return;
    }
    level_text(&p->factor[s->factor], s->groups.middle[k], level, sizeof level);
    snprintf(text, sizeof text, "%.60s %.100s", p->factor[s->factor].name, level);
    fputs("title ", g);
    put_text(g, text);
}

/* ---- panels: gnuplot ends with an error where all numbers of one are NaN ---- */

static bool has_values(const sf_analysis *a, int figure) {
    for (int64_t row = 0; row < a->runs->count; row++)
        if (isfinite(sf_analysis_value(a, figure, row)))
            return true;
    return false;
}

static bool has_effects(const sf_analysis *a, int figure) {
    for (int f = 0; f < a->plan->factor_count; f++)
        if (isfinite(a->effect[figure][f].low))
            return true;
    return false;
}

static bool has_indices(const sf_analysis *a, int figure) {
    return a->with_indices && !isnan(a->index[figure][0].first);
}

static bool has_surface(const sf_analysis *a, int figure) {
    return isfinite(a->surface[figure].fit.left_out_rms);
}

/* The figures of the plan that have one. */
static int list_panels(const sf_analysis *a, bool (*has)(const sf_analysis *, int), int *list) {
    int count = 0;
    for (int k = 0; k < a->plan->figure_count; k++)
        if (has(a, k))
            list[count++] = k;
    return count;
}

/* ---- figures against factors ---- */

/* Points and means of one factor, series by series: $p<column>_<series> and $m... */
static sf_status put_factor_data(FILE *g, const sf_analysis *a, int column, int factor, const series *s,
                                 sf_error *err) {
    const sf_plan *p = a->plan;
    sf_groups g2 = {0};
    if (sf_groups_make(p, factor, &g2, err) != SF_OK)
        return err->status;
    int64_t groups = g2.count, cells = groups * p->figure_count;
    double *sum = sf_alloc(err, (unsigned long)cells, sizeof *sum, "a picture");
    double *number = sf_alloc(err, (unsigned long)cells, sizeof *number, "a picture");
    bool *shown = sf_analysis_pick(a->done - a->unusable, POINTS, err);
    const sf_block *b = &p->block[p->block_of[factor]];
    for (int k = 0; k < series_count(s) && err->status == SF_OK; k++) {
        memset(sum, 0, (size_t)cells * sizeof *sum);
        memset(number, 0, (size_t)cells * sizeof *number);
        fprintf(g, "$p%d_%d << EOD\nNaN,NaN\n", column, k);
        for (int64_t row = 0, at = -1; row < p->rows; row++) {
            if (!sf_runs_usable(a->runs, row) || (++at, series_of(p, s, row) != k))
                continue;
            int64_t group = g2.of_row[row / b->stride % b->rows];
            if (shown[at])
                fprintf(g, "%.9g", sf_plan_value(p, factor, row));
            for (int f = 0; f < p->figure_count; f++) {
                double value = sf_analysis_value(a, f, row);
                if (shown[at])
                    fprintf(g, ",%.6g", value);
                sum[f * groups + group] += isnan(value) ? 0 : value;
                number[f * groups + group] += !isnan(value);
            }
            if (shown[at])
                fputc('\n', g);
        }
        fprintf(g, "EOD\n$m%d_%d << EOD\nNaN,NaN\n", column, k);
        for (int64_t group = 0; group < groups; group++) {
            fprintf(g, "%.9g", g2.middle[group]);
            for (int f = 0; f < p->figure_count; f++)
                fprintf(g, ",%.6g", sum[f * groups + group] / number[f * groups + group]);
            fputc('\n', g);
        }
        fputs("EOD\n", g);
    }
    free(sum);
    free(number);
    free(shown);
    sf_groups_free(&g2);
    return err->status;
}

static void put_factor_panel(FILE *g, const sf_analysis *a, int figure, bool key, int column, int factor,
                             const series *s) {
    const sf_sweep_limit *limit = &a->plan->figure[figure];
    put_factor_label(g, "set xlabel", &a->plan->factor[factor]);
    put_label(g, "set ylabel", limit->figure);
    fputs(key && s->factor >= 0 ? "set key outside top center maxrows 3\n" : "unset key\n", g);
    fputs("plot ", g);
    if (!isnan(limit->limit))
        fprintf(g, "%.9g with lines lw 2 dt 2 lc rgb '#cb181d' notitle, \\\n     ", limit->limit);
    for (int k = 0; k < series_count(s); k++) {
        fprintf(g, "%s$p%d_%d using 1:%d with points pt 7 ps 0.8*dot lc rgb '%s' notitle, \\\n     ",
                k ? ", \\\n     " : "", column, k, figure + 2, colours[k]);
        fprintf(g, "$m%d_%d using 1:%d with lines lw 2.5 lc rgb '%s' ", column, k, figure + 2, colours[k]);
        put_series_title(g, a->plan, s, k);
    }
    fputc('\n', g);
}

static sf_status plot_factors(const sf_staging *output, const sf_analysis *a, sf_error *err) {
    int list[SF_SWEEP_FACTORS], columns = 0;
    int panel[SF_SWEEP_FIGURES], figures = list_panels(a, has_values, panel);
    series s[COLUMNS] = {{0}};
    for (int f = 0; f < a->plan->factor_count && columns < COLUMNS; f++)
        if (!a->plan->factor[f].words)
            list[columns++] = f;
    if (columns == 0 || figures == 0)
        return SF_OK;
    FILE *g = sf_gnuplot_begin(output, "factors", columns > 1 ? 900 * columns : 1300, 620 * figures, err);
    for (int c = 0; c < columns && g && err->status == SF_OK; c++)
        if (choose_series(a->plan, list[c], &s[c], err) == SF_OK)
            put_factor_data(g, a, c, list[c], &s[c], err);
    if (g)
        fprintf(g, "set multiplot layout %d,%d\nset offsets graph 0.04, graph 0.04, graph 0.05, graph 0.05\n",
                figures, columns);
    for (int k = 0; k < figures && g; k++)
        for (int c = 0; c < columns; c++)
            put_factor_panel(g, a, panel[k], k == 0, c, list[c], &s[c]);
    for (int c = 0; c < columns; c++)
        sf_groups_free(&s[c].groups);
    if (g)
        fputs("unset multiplot\n", g);
    return g ? sf_staging_close(g, "factors.gp", err) : err->status;
}

/* ---- curves ---- */

/* A curve as a block of lines; false if its results cannot be read any more. */
static bool put_curve(FILE *g, const char *folder, const char *name, int number) {
    char path[PATH_MAX];
    sf_results r;
    sf_figures f = {0};
    sf_error none = SF_ERROR_INIT;
    snprintf(path, sizeof path, "%s/%s/results.h5", folder, name);
    if (sf_results_open(path, &r, &none) != SF_OK)
        return false;
    bool good = sf_figures_compute(&r, 1000, &f, &none) == SF_OK;
    int64_t count = good ? f.filtered.count : 0, every = count / CURVE_POINTS + 1;
    if (good)
        fprintf(g, "$c%d << EOD\n", number);
    for (int64_t k = 0; k < count; k += every)
        fprintf(g, "%.6g,%.6g\n", 1e3 * f.filtered.time[k], f.filtered.value[k]);
    if (good)
        fputs("EOD\n", g);
    sf_figures_free(&f);
    sf_results_close(&r);
    return good;
}

static void put_curve_plot(FILE *g, const sf_plan *p, const series *s, int count, const int *of) {
    bool titled[SERIES] = {false};
    fputs("set xlabel 'time (ms)'\nset ylabel 'deceleration (g)'\nset key top right\nplot ", g);
    for (int k = 0; k < count; k++) {
        fprintf(g, "%s$c%d using 1:2 with lines lw 1.2 lc rgb '%s' ", k ? ", \\\n     " : "", k,
                colours[of[k]]);
        if (titled[of[k]])
            fputs("notitle", g);
        else
            put_series_title(g, p, s, of[k]);
        titled[of[k]] = true;
    }
    fputc('\n', g);
}

static sf_status plot_curves(const sf_staging *output, const sf_analysis *a, const char *folder,
                             sf_error *err) {
    int of[CURVES + 1], count = 0;
    int64_t at = -1;
    series s;
    if (choose_series(a->plan, -1, &s, err) != SF_OK)
        return err->status;
    bool *shown = sf_analysis_pick(a->done - a->unusable, CURVES, err);
    FILE *g = shown ? sf_gnuplot_begin(output, "curves", 1600, 900, err) : NULL;
    for (int64_t row = 0; row < a->runs->count && g; row++)
        if (sf_runs_usable(a->runs, row) && shown[++at] && a->runs->folder[row] &&
            put_curve(g, folder, a->runs->folder[row], count))
            of[count++] = series_of(a->plan, &s, row);
    free(shown);
    if (g && count > 0)
        put_curve_plot(g, a->plan, &s, count, of);
    sf_groups_free(&s.groups);
    if (!g || sf_staging_close(g, "curves.gp", err) != SF_OK)
        return err->status;
    if (count == 0)
        sf_staging_remove(output, "curves.gp");
    return SF_OK;
}

/* ---- effects and indices: horizontal bars ---- */

/* The factors, the greatest value on top: at the end. */
static void sort_factors(int count, const double *size, int *order) {
    for (int k = 0; k < count; k++)
        order[k] = k;
    for (int k = 1; k < count; k++)
        for (int j = k; j > 0 && !(size[order[j - 1]] <= size[order[j]]); j--) {
            int other = order[j];
            order[j] = order[j - 1];
            order[j - 1] = other;
        }
}

static void put_tics(FILE *g, const sf_plan *p, int count, const int *order) {
    fputs("set ytics (", g);
    for (int k = 0; k < count; k++) {
        put_text(g, p->factor[order[k]].name);
        fprintf(g, " %d%s", k, k + 1 < count ? ", " : ")\n");
    }
    fprintf(g, "set yrange [-0.6:%g]\n", count - 0.4);
}

static void put_effect_panel(FILE *g, const sf_analysis *a, int figure) {
    const sf_plan *p = a->plan;
    double size[BARS];
    int order[BARS];
    for (int f = 0; f < p->factor_count; f++) {
        const sf_effect *e = &a->effect[figure][f];
        size[f] = isnan(e->low) ? 0 : e->high - e->low;
    }
    sort_factors(p->factor_count, size, order);
    fprintf(g, "$e%d << EOD\nNaN,NaN,NaN,NaN\n", figure);
    for (int k = 0; k < p->factor_count; k++) {
        const sf_effect *e = &a->effect[figure][order[k]];
        fprintf(g, "%.9g,%d,%.9g,%.9g\n", 0.5 * (e->low + e->high), k, e->low, e->high);
    }
    fputs("EOD\n", g);
    put_tics(g, p, p->factor_count, order);
    put_label(g, "set xlabel", p->figure[figure].figure);
    fprintf(
        g,
        "plot $e%d using 1:2:3:4:($2-0.35):($2+0.35) with boxxyerror fs solid 0.7 noborder lc rgb '#6baed6' "
        "notitle\n",
        figure);
}

static sf_status plot_effects(const sf_staging *output, const sf_analysis *a, sf_error *err) {
    int panel[SF_SWEEP_FIGURES], figures = list_panels(a, has_effects, panel);
    int height = 160 + 70 * a->plan->factor_count;
    if (figures == 0)
        return SF_OK;
    FILE *g = sf_gnuplot_begin(output, "effects", 1600, (height < 400 ? 400 : height) * figures, err);
    if (!g)
        return err->status;
    fprintf(g, "set multiplot layout %d,1\nset lmargin 26\nunset key\n", figures);
    for (int k = 0; k < figures; k++)
        put_effect_panel(g, a, panel[k]);
    fputs("unset multiplot\n", g);
    return sf_staging_close(g, "effects.gp", err);
}

static void put_index_panel(FILE *g, const sf_analysis *a, int figure) {
    const sf_plan *p = a->plan;
    double size[BARS];
    int order[BARS];
    for (int f = 0; f < p->factor_count; f++)
        size[f] = a->index[figure][f].total;
    sort_factors(p->factor_count, size, order);
    fprintf(g, "$i%d << EOD\n", figure);
    for (int k = 0; k < p->factor_count; k++) {
        const sf_index *i = &a->index[figure][order[k]];
        fprintf(g, "%d,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", k, i->first, i->first_low, i->first_high, i->total,
                i->total_low, i->total_high);
    }
    fputs("EOD\n", g);
    put_tics(g, p, p->factor_count, order);
    fputs("set xlabel 'share of the variance of ", g);
    fprintf(g, "%s'\n", p->figure[figure].figure);
    fprintf(
        g,
        "plot $i%d using 2:($1+0.12):3:4 with xerrorbars pt 7 lw 2 lc rgb '#08519c' title 'first order', \\\n"
        "     $i%d using 5:($1-0.12):6:7 with xerrorbars pt 5 lw 2 lc rgb '#cb181d' title 'total'\n",
        figure, figure);
}

static sf_status plot_indices(const sf_staging *output, const sf_analysis *a, sf_error *err) {
    int panel[SF_SWEEP_FIGURES], figures = list_panels(a, has_indices, panel);
    if (figures == 0)
        return SF_OK;
    FILE *g = sf_gnuplot_begin(output, "indices", 1600, (240 + 70 * a->plan->factor_count) * figures, err);
    if (!g)
        return err->status;
    fprintf(g, "set multiplot layout %d,1\nset lmargin 26\nset key outside top right horizontal\n", figures);
    for (int k = 0; k < figures; k++)
        put_index_panel(g, a, panel[k]);
    fputs("unset multiplot\n", g);
    return sf_staging_close(g, "indices.gp", err);
}

/* ---- response surface ---- */

static void put_surface_panel(FILE *g, const sf_analysis *a, int figure, sf_error *err) {
    const sf_sweep_surface *s = &a->surface[figure];
    bool *shown = sf_analysis_pick(s->rows, POINTS, err);
    fprintf(g, "$s%d << EOD\n", figure);
    for (int64_t k = 0; k < s->rows && shown; k++)
        if (shown[k])
            fprintf(g, "%.6g,%.6g\n", s->simulated[k], s->left_out[k]);
    free(shown);
    fprintf(g, "EOD\nset xlabel '%s, simulated'\nset ylabel 'by the surface without its place'\n",
            a->plan->figure[figure].figure);
    fprintf(g,
            "plot $s%d using 1:2 with points pt 7 ps 1.2*dot lc rgb '#08519c' notitle, \\\n"
            "     '' using 1:1 with lines lw 1.5 lc rgb '#606060' notitle\n",
            figure);
}

static sf_status plot_surface(const sf_staging *output, const sf_analysis *a, sf_error *err) {
    int panel[SF_SWEEP_FIGURES], panels = list_panels(a, has_surface, panel);
    if (panels == 0)
        return SF_OK;
    FILE *g = sf_gnuplot_begin(output, "surface", 1600, panels > 1 ? 800 * ((panels + 1) / 2) : 1000, err);
    if (!g)
        return err->status;
    fprintf(g, "set multiplot layout %d,%d\n", panels > 1 ? (panels + 1) / 2 : 1, panels > 1 ? 2 : 1);
    for (int k = 0; k < panels; k++)
        put_surface_panel(g, a, panel[k], err);
    fputs("unset multiplot\n", g);
    sf_staging_close(g, "surface.gp", err);
    return err->status;
}

/* ---- probability ---- */

static int list_chosen(const sf_plan *p, int *block) {
    int count = 0;
    for (int k = 0; k < p->block_count; k++)
        if (sf_block_is_chosen(p, k))
            block[count++] = k;
    return count;
}

/* The levels of a block's first factor as tics at 0, 1, ... */
static void put_level_tics(FILE *g, const char *axis, const sf_plan *p, int block) {
    const sf_block *b = &p->block[block];
    const sf_factor *f = &p->factor[b->first];
    char text[512];
    fprintf(g, "set %stics (", axis);
    for (int64_t k = 0; k < b->rows; k++) {
        if (f->words)
            snprintf(text, sizeof text, "%s", short_label(f->label[(int64_t)f->value[k]]));
        else
            snprintf(text, sizeof text, "%.6g", f->value[k]);
        put_text(g, text);
        fprintf(g, " %lld%s", (long long)k, k + 1 < b->rows ? ", " : ")\n");
    }
    fprintf(g, "set %srange [-0.5:%g]\nset %slabel ", axis, (double)b->rows - 0.5, axis);
    sf_factor_heading(f, text, sizeof text);
    size_t used = strlen(text);
    for (int k = b->first + 1; k < b->first + b->count && used < sizeof text;
         k++) /* those of a zip go along */
        used += (size_t)snprintf(text + used, sizeof text - used, ", with %s", p->factor[k].name);
    put_text(g, text);
    fputc('\n', g);
}

enum { MAP_INTERVALS = 8 }; /* columns of a map in which there is room for them */

/* A cell with unknown runs, which its share takes as above, has a "?". */
static void put_map(FILE *g, const sf_analysis *a, int figure, const int *block) {
    const sf_plan *p = a->plan;
    int64_t nx = p->block[block[0]].rows, ny = p->block[block[1]].rows;
    put_level_tics(g, "x", p, block[0]);
    put_level_tics(g, "y", p, block[1]);
    fprintf(g, "$q%d << EOD\n", figure);
    for (int64_t k = 0; k < a->probability.cells; k++) {
        const sf_probability *c = &a->probability.cell[figure * a->probability.cells + k];
        fprintf(g, "%lld,%lld,%.6g,%.6g,%.6g,%lld\n", (long long)(k / ny), (long long)(k % ny), c->share,
                c->low, c->high, (long long)c->unknown);
    }
    fprintf(g,
            "EOD\nset cbrange [0:1]\nset palette defined (0 '#cb181d', 0.5 '#fee8a0', 1 '#238b45')\n"
            "set title 'P(%s < %g)%s'\n",
            p->figure[figure].figure, p->figure[figure].limit, nx <= MAP_INTERVALS ? ", 95 % interval" : "");
    fprintf(
        g,
        "plot $q%d using 1:2:(0.5):(0.5):3 with boxxyerror fs solid lc palette notitle, \\\n     '' using 1:2:",
        figure);
    if (nx <= MAP_INTERVALS)
        fprintf(
            g,
            "(sprintf(\"%%.2f%%s\\n%%.2f-%%.2f\", $3, $6 > 0 ? '?' : '', $4, $5)) with labels font ',%.3g' notitle\n",
            fmin(16, 64.0 / (double)nx));
    else
        fprintf(g, "(sprintf('%%.2f%%s', $3, $6 > 0 ? '?' : '')) with labels font ',%.3g' notitle\n",
                fmin(16, 150.0 / (double)nx));
}

static void put_line(FILE *g, const sf_analysis *a, int figure, const int *block) {
    const sf_probabilities *q = &a->probability;
    put_level_tics(g, "x", a->plan, block[0]);
    fprintf(g, "set yrange [-0.02:1.02]\nset ylabel 'probability'\n$q%d << EOD\n", figure);
    for (int64_t k = 0; k < q->cells; k++) {
        const sf_probability *c = &q->cell[figure * q->cells + k];
        fprintf(g, "%lld,%.6g,%.6g,%.6g,%s\n", (long long)k, c->share, c->low, c->high,
                c->unknown > 0 ? "?" : "");
    }
    fprintf(g, "EOD\nset title 'P(%s < %g), 95 %% interval'\n", a->plan->figure[figure].figure,
            a->plan->figure[figure].limit);
    fprintf(g,
            "plot $q%d using 1:2:3:4 with yerrorbars pt 7 lw 2 lc rgb '#08519c' notitle, \\\n"
            "     '' using 1:2:5 with labels offset 1.5,0 notitle\n",
            figure);
}

static sf_status plot_probability(const sf_staging *output, const sf_analysis *a, sf_error *err) {
    int block[SF_SWEEP_FACTORS], chosen = list_chosen(a->plan, block), panels = 0;
    for (int k = 0; k < a->plan->figure_count; k++)
        panels += !isnan(a->plan->figure[k].limit);
    if (a->probability.cells < 2 || a->probability.cells > 400 || chosen < 1 || chosen > 2 || panels == 0)
        return SF_OK;
    FILE *g =
        sf_gnuplot_begin(output, "probability", 1600, panels > 1 ? 760 * ((panels + 1) / 2) : 1000, err);
    if (!g)
        return err->status;
    fprintf(g, "set multiplot layout %d,%d\nunset key\n", panels > 1 ? (panels + 1) / 2 : 1,
            panels > 1 ? 2 : 1);
    for (int k = 0; k < a->plan->figure_count; k++)
        if (isnan(a->plan->figure[k].limit))
            continue;
        else if (chosen == 2)
            put_map(g, a, k, block);
        else
            put_line(g, a, k, block);
    fputs("unset multiplot\n", g);
    return sf_staging_close(g, "probability.gp", err);
}

/* ---- all ---- */

sf_status sf_sweep_plot(const sf_staging *output, const sf_analysis *a, const char *folder, char *warning,
                        size_t size, sf_error *err) {
    warning[0] = '\0';
    if (a->done - a->unusable < 1)
        return SF_OK;
    if (plot_factors(output, a, err) != SF_OK || plot_curves(output, a, folder, err) != SF_OK ||
        plot_effects(output, a, err) != SF_OK || plot_indices(output, a, err) != SF_OK ||
        plot_surface(output, a, err) != SF_OK || plot_probability(output, a, err) != SF_OK)
        return err->status;
    for (const sf_sweep_picture *p = pictures; p->name; p++) {
        char script[64], own[320] = "";
        snprintf(script, sizeof script, "%s.gp", p->name);
        if (sf_staging_has(output, script))
            sf_gnuplot_draw(output, p->name, own, sizeof own);
        if (!*warning)
            snprintf(warning, size, "%s", own);
    }
    return SF_OK;
}
