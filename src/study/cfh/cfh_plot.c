/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_report.h"

#include "report/chart.h"
#include <math.h>
#include <string.h>

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

/* Returns the end of the axis, a bit above the limit and the largest value. */
static double value_top(const sf_cfh_report *r, sf_cfh_criterion c) {
    double top = r->plan->limit[c];
    for (int k = 0; k < r->points->count; k++)
        if (!r->points->point[k].failed)
            top = fmax(top, r->points->point[k].value[c]);
    return 1.12 * top;
}

/* Both panels stand above each other; the x axis is below the lower one, the rig's above the upper one. */
static void put_axes(sf_panel *panel, const sf_cfh_report *r, sf_cfh_criterion c) {
    bool upper = c == SF_CFH_A_MAX, rig = r->rig->pairs > 0;
    double range[2], top = rig ? 0.855 : 0.93, middle = 0.5 * (0.155 + top);
    height_range(r, range);
    const double area[4] = {0.11, 0.97, upper ? middle + 0.025 : 0.155, upper ? top : middle - 0.025};
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "drop height, free fall (m)");
    sf_axis_range(&panel->x, range[0], range[1]);
    panel->x.hidden = upper;
    sf_axis_label(&panel->y, "%s", upper ? "a_max (g)" : "HIC");
    sf_axis_range(&panel->y, 0, value_top(r, c));
    if (upper && rig) {
        sf_axis_label(&panel->x2, "drop height on the rig (m)");
        sf_axis_range(&panel->x2, sf_cfh_rig_height(r->rig, range[0]), sf_cfh_rig_height(r->rig, range[1]));
    }
    panel->key = upper ? SF_KEY_NONE : SF_KEY_BELOW; /* one key, below both */
    panel->key_columns = 5;
}

/* 95 % of the draws at each height. */
static void put_band(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    if (!r->spread)
        return;
    sf_series_data *range = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_RANGE, .colour = "#6baed6", .opacity = 0.4},
        "95 %% of the draws");
    for (int k = 0; k < r->spread->grid; k++) {
        const sf_cfh_band *band = &r->spread->band[c][k];
        if (isfinite(band->low) && isfinite(band->high))
            sf_series_add(range, r->spread->height[k], band->median, band->low, band->high);
    }
}

/* The interval of the crossing as a band, where the draws give one, and the crossing as a line with its
 * height. */
static void put_crossing(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    const sf_cfh_crossing *crossing = &r->result->crossing[c];
    bool decides = r->result->verdict == SF_CFH_FOUND && r->result->deciding == c;
    const char *colour = decides ? "#cb181d" : "#606060";
    double limit = r->plan->limit[c], range[2];
    height_range(r, range);
    sf_chart_level(chart, limit, "#cb181d", "limit %g%s", limit, sf_cfh_unit(c));
    if (r->spread) {
        const sf_cfh_interval *interval = sf_cfh_spread_whole(r->spread, (int)c);
        const double x[2] = {fmax(interval->low, range[0]), fmin(interval->high, range[1])};
        if (x[0] < x[1])
            sf_chart_band(chart, x, (const double[2]){-INFINITY, limit}, colour, 0.25);
    }
    if (!isnan(crossing->height))
        sf_chart_drop(chart, crossing->height, limit, colour, "%.3f m%s", crossing->height,
                      decides ? ", decides" : "");
}

/* The fit between the lowest and the highest of its points. */
static void put_fit(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    enum { STEPS = 200 };
    const sf_cfh_fit *fit = &r->result->crossing[c].fit;
    double lowest = 0, highest = 0;
    if (fit->count == 0)
        return;
    for (int k = 0, n = 0; k < r->points->count; k++) {
        if (r->points->point[k].failed)
            continue;
        if (n == fit->first)
            lowest = r->points->point[k].height;
        if (n++ == fit->first + fit->count - 1)
            highest = r->points->point[k].height;
    }
    sf_series_data *line = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c", .width = 3.5}, "fit");
    for (int k = 0; k <= STEPS; k++) {
        double height = lowest + (highest - lowest) * k / STEPS;
        sf_series_point(line, height, sf_cfh_fit_at(fit, height));
    }
}

static void put_points(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    sf_series_data *simulated = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_POINTS, .colour = "#08519c", .size = 1.8}, "simulated");
    sf_series_data *failed = sf_chart_series(
        chart,
        (sf_series_style){
            .kind = SF_SERIES_POINTS, .colour = "#606060", .shape = SF_POINT_CROSS, .size = 2.2, .width = 3},
        "failed");
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        sf_series_point(p->failed ? failed : simulated, p->height, p->failed ? 0 : p->value[c]);
    }
}

/* The verdict in a few words. */
static void put_title(sf_chart *chart, const sf_cfh_report *r) {
    const sf_cfh_result *v = r->result;
    char height[96] = "not determined", rig[48] = "", interval[64], spread[96] = "";
    if (v->verdict == SF_CFH_FOUND)
        snprintf(height, sizeof height, "%.3f m of free fall", v->crossing[v->deciding].height);
    else if (v->verdict == SF_CFH_ABOVE)
        snprintf(height, sizeof height, "above %.3f m of free fall", v->highest);
    else if (v->verdict == SF_CFH_BELOW)
        snprintf(height, sizeof height, "below %.3f m of free fall", v->lowest);
    if (v->verdict == SF_CFH_FOUND && r->rig->pairs > 0)
        snprintf(rig, sizeof rig, ", %.3f m on the rig",
                 sf_cfh_rig_height(r->rig, v->crossing[v->deciding].height));
    if (r->spread)
        snprintf(
            spread, sizeof spread, "; 95 %% interval %s",
            sf_cfh_interval_text(sf_cfh_spread_whole(r->spread, SF_CFH_FIRST), interval, sizeof interval));
    sf_chart_title(chart, "Critical fall height %s%s%s (indicative)", height, rig, spread);
}

sf_status sf_cfh_plot(const sf_staging *output, const sf_cfh_report *r, char *warning, size_t size,
                      sf_error *err) {
    sf_chart *chart = sf_chart_new("cfh", 1600, 1300, err);
    put_title(chart, r);
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        sf_panel *panel = sf_chart_panel(chart);
        if (!panel)
            break;
        put_axes(panel, r, c);
        put_band(chart, r, c);
        put_crossing(chart, r, c);
        put_fit(chart, r, c);
        put_points(chart, r, c);
    }
    sf_chart_write(chart, output, warning, size, err);
    sf_chart_free(chart);
    return err->status;
}
