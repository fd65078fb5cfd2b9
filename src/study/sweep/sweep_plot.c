/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/sweep_report.h"

#include "base/text.h"
#include "io/plain_file.h"
#include "report/chart.h"
#include <unistd.h>

enum { COLUMNS = 4, SERIES = 8, POINTS = 3000, CURVES = 200, CURVE_POINTS = 300, BARS = SF_SWEEP_FACTORS };

static const sf_sweep_picture pictures[] = {
    {"factors",
     "Each figure against the factors that are numbers (the first four of them): a point is a run, "
     "simulated or predicted, lines join the means"},
    {"curves",
     "Deceleration over time of the runs (of more than 200 runs 200, drawn at random; of a series the last drop)"},
    {"effects",
     "Main effects, all else equal: the range of the means between the values of a factor, the greatest on top"},
    {"indices", "Sobol' indices, first order and total, with 95 % intervals"},
    {"surface", "Response surface: each run as the surface without the runs of its place predicts it"},
    {"probability",
     "Probability of staying below the limit; where a \"?\" stands, unknown runs (failed, not to be "
     "used, or left open as they are expected to be so) are taken as above"},
    {NULL, NULL}};

static const char *const colours[SERIES] = {"#08519c", "#cb181d", "#238b45", "#6a51a3",
                                            "#d94801", "#17becf", "#8c6d31", "#525252"};

const sf_sweep_picture *sf_sweep_pictures(void) {
    return pictures;
}

/* Styles of the series; those of SERIES levels take the colour of the level. */
static const sf_series_style run_points = {.kind = SF_SERIES_POINTS, .colour = "#08519c", .size = 0.8},
                             mean_line = {.kind = SF_SERIES_LINE, .width = 2.5},
                             curve_line = {.kind = SF_SERIES_LINE, .width = 1.2},
                             effect_span = {.kind = SF_SERIES_SPANS, .colour = "#6baed6", .opacity = 0.7},
                             first_order = {.kind = SF_SERIES_SIDES, .colour = "#08519c", .width = 2},
                             total_order = {.kind = SF_SERIES_SIDES,
                                            .colour = "#cb181d",
                                            .width = 2,
                                            .shape = SF_POINT_SQUARE},
                             surface_points = {.kind = SF_SERIES_POINTS, .colour = "#08519c", .size = 1.2},
                             equal_line = {.kind = SF_SERIES_LINE, .colour = "#606060", .width = 1.5},
                             map_cells = {.kind = SF_SERIES_CELLS},
                             share_errors = {.kind = SF_SERIES_ERRORS, .colour = "#08519c", .width = 2},
                             labels = {.kind = SF_SERIES_LABELS};

static sf_series_style coloured(sf_series_style style, int level) {
    style.colour = colours[level];
    return style;
}

static void label_factor(sf_axis *axis, const sf_factor *f) {
    char text[SF_FACTOR_KEY_SIZE + SF_FACTOR_UNIT_SIZE + 8];
    sf_axis_label(axis, "%s", sf_factor_heading(f, text, sizeof text));
}

static void level_text(const sf_factor *f, double value, char *text, size_t size) {
    if (f->words)
        snprintf(text, size, "%s", sf_path_name(f->label[(int64_t)value])); /* a file without its folders */
    else
        snprintf(text, size, "%.12g%s%s", value, *f->unit ? " " : "", f->unit);
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
        SF_TRY(sf_groups_make(p, f, &s->groups, err));
        if (s->groups.count > 1 && s->groups.count <= SERIES)
            s->factor = f;
        else
            sf_groups_free(&s->groups);
    }
    return SF_OK;
}

static int series_of(const sf_plan *p, const series *s, int64_t row) {
    if (s->factor < 0)
        return 0;
    const sf_block *b = &p->block[p->block_of[s->factor]];
    return (int)s->groups.of_row[row / b->stride % b->rows];
}

/* Returns a series of the chart with the title of level `k`; without a factor it has none. */
static sf_series_data *level_series(sf_chart *chart, sf_series_style style, const sf_plan *p, const series *s,
                                    int k) {
    char level[128];
    style = coloured(style, k);
    if (s->factor < 0)
        return sf_chart_series(chart, style, NULL);
    level_text(&p->factor[s->factor], s->groups.middle[k], level, sizeof level);
    return sf_chart_series(chart, style, "%.60s %.100s", p->factor[s->factor].name, level);
}

/* ---- panels ---- */

static bool has_values(const sf_analysis *a, int figure) {
    for (int64_t row = 0; row < a->runs->count; row++)
        if (isfinite(sf_runs_value(a->runs, row, figure)))
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

/* The probabilities of a plan of one or two choices, if they are not too many. */
static bool has_probability(const sf_analysis *a, int figure) {
    const sf_plan *p = a->plan;
    int chosen = 0;
    for (int k = 0; k < p->block_count; k++)
        chosen += sf_block_is_chosen(p, k);
    return !isnan(p->figure[figure].limit) && a->probability.cells >= 2 && a->probability.cells <= 400 &&
           chosen >= 1 && chosen <= 2;
}

/* The figures of the plan that have a panel. */
static int list_panels(const sf_analysis *a, bool (*has)(const sf_analysis *, int), int *list) {
    int count = 0;
    for (int k = 0; k < a->plan->figure_count; k++)
        if (has(a, k))
            list[count++] = k;
    return count;
}

/* ---- figures against factors ---- */

/* One panel: a figure against a factor, points and means of each series. */
static sf_status put_factor_panel(sf_chart *chart, const sf_analysis *a, int figure, bool key, int factor,
                                  const series *s, const bool *shown, sf_error *err) {
    const sf_plan *p = a->plan;
    const sf_sweep_limit *limit = &p->figure[figure];
    const sf_block *b = &p->block[p->block_of[factor]];
    SF_OWNED_BY(sf_groups_free) sf_groups groups = {0};
    sf_panel *panel = sf_chart_panel(chart);
    SF_TRY(sf_groups_make(p, factor, &groups, err));
    SF_OWNED double *sum = sf_alloc(err, groups.count, sizeof *sum, "a picture");
    SF_OWNED double *number = sf_alloc(err, groups.count, sizeof *number, "a picture");
    label_factor(&panel->x, &p->factor[factor]);
    sf_axis_label(&panel->y, "%s", limit->figure);
    panel->key = key && s->factor >= 0 ? SF_KEY_ABOVE : SF_KEY_NONE;
    panel->padded = true;
    if (!isnan(limit->limit))
        sf_chart_level(chart, limit->limit, "#cb181d", NULL);
    for (int k = 0; k < (s->factor < 0 ? 1 : (int)s->groups.count) && err->status == SF_OK; k++) {
        sf_series_data *points = sf_chart_series(chart, coloured(run_points, k), NULL),
                       *means = level_series(chart, mean_line, p, s, k);
        memset(sum, 0, (size_t)groups.count * sizeof *sum);
        memset(number, 0, (size_t)groups.count * sizeof *number);
        for (int64_t row = 0, at = -1; row < p->rows; row++) {
            if (!sf_runs_usable(a->runs, row) || (++at, series_of(p, s, row) != k))
                continue;
            int64_t group = groups.of_row[row / b->stride % b->rows];
            double value = sf_runs_value(a->runs, row, figure);
            if (shown[at])
                sf_series_point(points, sf_plan_value(p, factor, row), value);
            sum[group] += isnan(value) ? 0 : value;
            number[group] += !isnan(value);
        }
        for (int64_t group = 0; group < groups.count; group++)
            sf_series_point(means, groups.middle[group], sum[group] / number[group]);
    }
    return err->status;
}

static sf_chart *draw_factors(const sf_analysis *a, const char *folder, sf_error *err) {
    int list[SF_SWEEP_FACTORS], columns = 0;
    int panel[SF_SWEEP_FIGURES], figures = list_panels(a, has_values, panel);
    series s[COLUMNS] = {{0}};
    (void)folder;
    for (int f = 0; f < a->plan->factor_count && columns < COLUMNS; f++)
        if (!a->plan->factor[f].words)
            list[columns++] = f;
    if (columns == 0 || figures == 0)
        return NULL;
    SF_OWNED bool *shown = sf_analysis_pick(a->usable, POINTS, err);
    sf_chart *chart = sf_chart_new("factors", columns > 1 ? 900 * columns : 1300, 620 * figures, err);
    sf_chart_columns(chart, columns);
    for (int c = 0; c < columns && err->status == SF_OK; c++)
        choose_series(a->plan, list[c], &s[c], err);
    for (int k = 0; k < figures * columns && err->status == SF_OK; k++)
        put_factor_panel(chart, a, panel[k / columns], k < columns, list[k % columns], &s[k % columns], shown,
                         err);
    for (int c = 0; c < columns; c++)
        sf_groups_free(&s[c].groups);
    return chart;
}

/* ---- curves ---- */

/* Adds the filtered curve of a run; false if its results cannot be read any more. */
static bool add_curve(sf_series_data *line, const char *folder, const char *name) {
    char first[PATH_MAX], path[PATH_MAX], next[PATH_MAX];
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    sf_error none = SF_ERROR_INIT;
    snprintf(first, sizeof first, "%s/%s/results.h5", folder, name);
    snprintf(next, sizeof next, "%s", first);
    for (int drop = 2; drop == 2 || access(next, F_OK) == 0; drop++) {
        memcpy(path, next, sizeof path);
        sf_model_series_file(first, drop, next, sizeof next);
    }
    if (sf_results_open(path, &r, &none) != SF_OK)
        return false;
    bool good = sf_figures_compute(&r, 1000, &f, &none) == SF_OK;
    if (good)
        sf_series_points(line, f.filtered.count, f.filtered.time, f.filtered.value, 1e3, 1, CURVE_POINTS);
    return good;
}

static sf_chart *draw_curves(const sf_analysis *a, const char *folder, sf_error *err) {
    int64_t at = -1, count = 0;
    series s;
    bool titled[SERIES] = {false}, *shown = sf_analysis_pick(a->usable, CURVES, err);
    sf_chart *chart = sf_chart_new("curves", 1600, 900, err);
    sf_panel *panel = sf_chart_panel(chart);
    choose_series(a->plan, -1, &s, err);
    sf_axis_label(&panel->x, "time (ms)");
    sf_axis_label(&panel->y, "deceleration (g)");
    panel->key = SF_KEY_TOP_RIGHT;
    for (int64_t row = 0; row < a->runs->count && err->status == SF_OK; row++) {
        if (!sf_runs_usable(a->runs, row) || !shown[++at] || !a->runs->folder[row])
            continue;
        int level = series_of(a->plan, &s, row);
        sf_series_data *line = titled[level] ? sf_chart_series(chart, coloured(curve_line, level), NULL)
                                             : level_series(chart, curve_line, a->plan, &s, level);
        if (add_curve(line, folder, a->runs->folder[row])) {
            titled[level] = true;
            count++;
        }
    }
    free(shown);
    sf_groups_free(&s.groups);
    if (count > 0)
        return chart;
    sf_chart_free(chart);
    return NULL;
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

/* A panel with a factor on each place of its y axis, in this order. */
static sf_panel *bar_panel(sf_chart *chart, const sf_plan *p, const int *order) {
    sf_panel *panel = sf_chart_panel(chart);
    for (int k = 0; k < p->factor_count; k++)
        sf_axis_word(chart, &panel->y, p->factor[order[k]].name);
    sf_axis_range(&panel->y, -0.6, p->factor_count - 0.4);
    panel->left = 26;
    return panel;
}

static void put_effect_panel(sf_chart *chart, const sf_analysis *a, int figure, sf_error *err) {
    const sf_plan *p = a->plan;
    double size[BARS];
    int order[BARS];
    (void)err;
    for (int f = 0; f < p->factor_count; f++) {
        const sf_effect *e = &a->effect[figure][f];
        size[f] = isnan(e->low) ? 0 : e->high - e->low;
    }
    sort_factors(p->factor_count, size, order);
    sf_panel *panel = bar_panel(chart, p, order);
    sf_axis_label(&panel->x, "%s", p->figure[figure].figure);
    sf_series_data *bars = sf_chart_series(chart, effect_span, NULL);
    for (int k = 0; k < p->factor_count; k++) {
        const sf_effect *e = &a->effect[figure][order[k]];
        if (!isnan(e->low))
            sf_series_add(bars, 0.5 * (e->low + e->high), k, e->low, e->high);
    }
}

static void put_index_panel(sf_chart *chart, const sf_analysis *a, int figure, sf_error *err) {
    const sf_plan *p = a->plan;
    double size[BARS];
    int order[BARS];
    (void)err;
    for (int f = 0; f < p->factor_count; f++)
        size[f] = a->index[figure][f].total;
    sort_factors(p->factor_count, size, order);
    sf_panel *panel = bar_panel(chart, p, order);
    sf_axis_label(&panel->x, "share of the variance of %s", p->figure[figure].figure);
    panel->key = SF_KEY_ABOVE;
    sf_series_data *first = sf_chart_series(chart, first_order, "first order"),
                   *total = sf_chart_series(chart, total_order, "total");
    for (int k = 0; k < p->factor_count; k++) {
        const sf_index *i = &a->index[figure][order[k]];
        sf_series_add(first, i->first, k + 0.12, i->first_low, i->first_high);
        sf_series_add(total, i->total, k - 0.12, i->total_low, i->total_high);
    }
}

/* ---- response surface ---- */

/* The runs by the surface against the simulations, and the line on which both are equal. */
static void put_surface_panel(sf_chart *chart, const sf_analysis *a, int figure, sf_error *err) {
    const sf_sweep_surface *s = &a->surface[figure];
    SF_OWNED bool *shown = sf_analysis_pick(s->rows, POINTS, err);
    sf_panel *panel = sf_chart_panel(chart);
    double low = INFINITY, high = -INFINITY;
    sf_axis_label(&panel->x, "%s of the run", a->plan->figure[figure].figure);
    sf_axis_label(&panel->y, "by the surface without that run");
    sf_series_data *points = sf_chart_series(chart, surface_points, NULL);
    for (int64_t k = 0; k < s->rows && shown; k++) {
        if (!shown[k])
            continue;
        sf_series_point(points, s->simulated[k], s->left_out[k]);
        low = fmin(low, s->simulated[k]);
        high = fmax(high, s->simulated[k]);
    }
    sf_series_data *equal = sf_chart_series(chart, equal_line, NULL);
    sf_series_point(equal, low, low);
    sf_series_point(equal, high, high);
}

/* ---- probability ---- */

/* The levels of a block's first factor as words at 0, 1, ... */
static void put_level_axis(sf_chart *chart, sf_axis *axis, const sf_plan *p, int block) {
    const sf_block *b = &p->block[block];
    const sf_factor *f = &p->factor[b->first];
    char text[512];
    for (int64_t k = 0; k < b->rows; k++) {
        snprintf(text, sizeof text, "%.6g", f->value[k]);
        sf_axis_word(chart, axis, f->words ? sf_path_name(f->label[(int64_t)f->value[k]]) : text);
    }
    sf_axis_range(axis, -0.5, (double)b->rows - 0.5);
    sf_factor_heading(f, text, sizeof text);
    for (int k = b->first + 1; k < b->first + b->count; k++) /* those of a zip go along */
        sf_text_add(text, sizeof text, ", with %s", p->factor[k].name);
    sf_axis_label(axis, "%s", text);
}

enum { MAP_INTERVALS = 8 }; /* columns of a map in which there is room for them */

/* The share of each cell, with its interval where there is room. A cell with unknown runs, which its share
 * takes as above, has a "?". */
static void put_map(sf_chart *chart, sf_panel *panel, const sf_analysis *a, int figure, const int *block) {
    const sf_plan *p = a->plan;
    int64_t nx = p->block[block[0]].rows, ny = p->block[block[1]].rows;
    bool intervals = nx <= MAP_INTERVALS;
    put_level_axis(chart, &panel->x, p, block[0]);
    put_level_axis(chart, &panel->y, p, block[1]);
    snprintf(panel->title, sizeof panel->title, "P(%s < %g)%s", p->figure[figure].figure,
             p->figure[figure].limit, intervals ? ", 95 % interval" : "");
    sf_series_style sized = labels;
    sized.size = fmin(16, (intervals ? 64.0 : 150.0) / (double)nx);
    sf_series_data *cells = sf_chart_series(chart, map_cells, NULL),
                   *texts = sf_chart_series(chart, sized, NULL);
    for (int64_t k = 0; k < a->probability.cells; k++) {
        const sf_probability *c = &a->probability.cell[figure * a->probability.cells + k];
        double x = (double)(k / ny), y = (double)(k % ny);
        const char *mark = c->unknown > 0 ? "?" : "";
        sf_series_add(cells, x, y, c->share, c->share);
        sf_series_label(texts, x, y, intervals ? "%.2f%s\n%.2f-%.2f" : "%.2f%s", c->share, mark, c->low,
                        c->high);
    }
}

static void put_line(sf_chart *chart, sf_panel *panel, const sf_analysis *a, int figure, const int *block) {
    const sf_probabilities *q = &a->probability;
    put_level_axis(chart, &panel->x, a->plan, block[0]);
    sf_axis_range(&panel->y, -0.02, 1.02);
    sf_axis_label(&panel->y, "probability");
    snprintf(panel->title, sizeof panel->title, "P(%s < %g), 95 %% interval", a->plan->figure[figure].figure,
             a->plan->figure[figure].limit);
    sf_series_data *shares = sf_chart_series(chart, share_errors, NULL),
                   *unknown = sf_chart_series(chart, labels, NULL);
    for (int64_t k = 0; k < q->cells; k++) {
        const sf_probability *c = &q->cell[figure * q->cells + k];
        sf_series_add(shares, (double)k, c->share, c->low, c->high);
        if (c->unknown > 0)
            sf_series_label(unknown, (double)k + 0.06, c->share, "?");
    }
}

static void put_probability_panel(sf_chart *chart, const sf_analysis *a, int figure, sf_error *err) {
    int block[SF_SWEEP_FACTORS], chosen = 0;
    sf_panel *panel = sf_chart_panel(chart);
    (void)err;
    for (int k = 0; k < a->plan->block_count; k++)
        if (sf_block_is_chosen(a->plan, k))
            block[chosen++] = k;
    if (chosen == 2)
        put_map(chart, panel, a, figure, block);
    else
        put_line(chart, panel, a, figure, block);
}

/* ---- all ---- */

/* A picture is drawn by a function of its own, which returns NULL if there is nothing to see, or panel by
 * panel for each figure that has one. */
typedef struct drawing {
    sf_chart *(*draw)(const sf_analysis *a, const char *folder, sf_error *err);
    bool (*has)(const sf_analysis *a, int figure);
    void (*put)(sf_chart *chart, const sf_analysis *a, int figure, sf_error *err);
    int grid; /* pixels, height of a panel where two stand side by side; 0: they stand in one column, */
    int base, least; /* with this height, and 70 for each factor, but at least the second */
} drawing;

/* In the order of `pictures`. */
static const drawing drawings[] = {{.draw = draw_factors},
                                   {.draw = draw_curves},
                                   {NULL, has_effects, put_effect_panel, .base = 160, .least = 400},
                                   {NULL, has_indices, put_index_panel, .base = 240},
                                   {NULL, has_surface, put_surface_panel, .grid = 800},
                                   {NULL, has_probability, put_probability_panel, .grid = 760}};

static sf_chart *draw_panels(const sf_analysis *a, const char *name, const drawing *d, sf_error *err) {
    int panel[SF_SWEEP_FIGURES], count = list_panels(a, d->has, panel),
                                 own = d->base + 70 * a->plan->factor_count;
    int height = !d->grid    ? (own < d->least ? d->least : own) * count
                 : count > 1 ? d->grid * ((count + 1) / 2)
                             : 1000;
    sf_chart *chart = count > 0 ? sf_chart_new(name, 1600, height, err) : NULL;
    sf_chart_columns(chart, d->grid && count > 1 ? 2 : 1);
    for (int k = 0; k < count; k++)
        d->put(chart, a, panel[k], err);
    return chart;
}

sf_status sf_sweep_plot(const sf_staging *output, const sf_analysis *a, const char *folder, char *warning,
                        size_t size, sf_error *err) {
    warning[0] = '\0';
    for (int k = 0; pictures[k].name && a->usable > 0 && err->status == SF_OK; k++) {
        const drawing *d = &drawings[k];
        char own[320] = "";
        sf_chart *chart = d->draw ? d->draw(a, folder, err) : draw_panels(a, pictures[k].name, d, err);
        sf_chart_write(chart, output, own, sizeof own, err);
        if (!*warning)
            snprintf(warning, size, "%s", own);
    }
    return err->status;
}
