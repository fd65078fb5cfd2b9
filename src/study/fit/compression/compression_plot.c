/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fit.png: data against fit over the whole range and at the foot, deviations below. */
#include "study/fit/compression/compression_plot.h"

#include "report/chart.h"
#include <math.h>
#include <string.h>

/* Light to dark with the rate: points, lines. */
static const char *const POINT[SF_COMPRESSION_TESTS] = {"#9ecae1", "#fdae6b", "#a1d99b", "#bcbddc",
                                                        "#fa9fb5", "#bdbdbd", "#d8b365", "#80cdc1"};
static const char *const LINE[SF_COMPRESSION_TESTS] = {"#08519c", "#a63603", "#006d2c", "#54278f",
                                                       "#7a0177", "#252525", "#8c510a", "#01665e"};

static sf_panel *new_panel(sf_chart *chart, const char *title, double left, double right, double bottom,
                           double top) {
    const double area[4] = {left, right, bottom, top};
    sf_panel *panel = sf_chart_panel(chart);
    if (!panel)
        return NULL;
    snprintf(panel->title, sizeof panel->title, "%s", title);
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "compressive strain");
    panel->x.step = 0.1;
    sf_axis_label(&panel->y, "nominal stress (kPa)");
    return panel;
}

/* Points and lines of every test. */
static void put_tests(sf_chart *chart, const sf_compression_fit *fit, bool titles) {
    const sf_compression_data *d = &fit->data;
    for (int k = 0; k < d->config->test_count; k++) {
        sf_series_data *points = sf_chart_series(
            chart, (sf_series_style){.kind = SF_SERIES_POINTS, .colour = POINT[k], .size = 0.9}, NULL);
        for (int i = 0; i < d->count; i++)
            if (d->test[i] == k)
                sf_series_point(points, d->strain[i], 1e-3 * d->stress[i]);
    }
    for (int k = 0; k < d->config->test_count; k++) {
        const sf_series_style style = {.kind = SF_SERIES_LINE, .colour = LINE[k], .width = 1.8};
        sf_series_data *line = titles
                                   ? sf_chart_series(chart, style, "fit at %.3g 1/s", d->config->test[k].rate)
                                   : sf_chart_series(chart, style, NULL);
        for (int i = 0; i < d->count; i++)
            if (d->test[i] == k)
                sf_series_point(line, d->strain[i], 1e-3 * fit->stress[i]);
    }
}

/* Returns the stress up to which the panel of the foot reaches: that of the loading curve at half the largest
 * strain, kPa. */
static double foot_stress(const sf_compression_fit *fit) {
    int k = 0, last = fit->rate_count - 1;
    while (k + 1 < fit->table_count && fit->table_strain[k] < 0.5 * fit->data.end)
        k++;
    return 1.3e-3 * fit->table_stress[last][k];
}

static void put_deviations(sf_chart *chart, sf_panel *panel, const sf_compression_fit *fit) {
    const sf_compression_data *d = &fit->data;
    double largest = 3;
    for (int i = 0; i < d->count; i++)
        largest = fmax(largest, fabs(d->stress[i] - fit->stress[i]) / d->sigma[i]);
    sf_axis_label(&panel->y, "deviation / scatter");
    sf_axis_range(&panel->y, -1.08 * largest, 1.08 * largest);
    panel->key = SF_KEY_TOP;
    sf_chart_band(chart, (const double[2]){-INFINITY, INFINITY}, (const double[2]){-2, 2}, "#f0f0f0", 1);
    for (int k = 0; k < d->config->test_count; k++)
        for (int side = 0; side < 2; side++) {
            const sf_series_style style = {.kind = SF_SERIES_POINTS,
                                           .colour = side ? POINT[k] : LINE[k],
                                           .shape = side ? SF_POINT_CIRCLE : SF_POINT_DISC,
                                           .size = 0.7};
            sf_series_data *points = k == 0 ? sf_chart_series(chart, style, side ? "unloading" : "loading")
                                            : sf_chart_series(chart, style, NULL);
            for (int i = 0; i < d->count; i++)
                if (d->test[i] == k && d->unloading[i] == (side == 1))
                    sf_series_point(points, d->strain[i], (d->stress[i] - fit->stress[i]) / d->sigma[i]);
        }
}

sf_status sf_compression_write_plot(const sf_staging *output, const sf_compression_fit *fit, char *warning,
                                    size_t size, sf_error *err) {
    sf_chart *chart = sf_chart_new("fit", 1700, 1350, err);
    double end = fit->data.end;
    sf_chart_title(chart, "%s: compression tests (points) and fit (lines)", fit->data.config->name);
    sf_panel *whole = new_panel(chart, "whole range", 0.08, 0.49, 0.47, 0.9);
    if (whole) {
        sf_axis_range(&whole->x, 0, 1.02 * end);
        sf_axis_range(&whole->y, 0, NAN);
        whole->key = SF_KEY_TOP_LEFT;
        put_tests(chart, fit, true);
    }
    sf_panel *foot = new_panel(chart, "foot and plateau", 0.58, 0.98, 0.47, 0.9);
    if (foot) {
        sf_axis_range(&foot->x, 0, 0.6 * end);
        sf_axis_range(&foot->y, 0, foot_stress(fit));
        put_tests(chart, fit, false);
    }
    sf_panel *below = new_panel(
        chart, "Deviation of the data from the fit, over the standard deviation of the scatter (band: ±2)",
        0.08, 0.98, 0.07, 0.34);
    if (below) {
        sf_axis_range(&below->x, 0, 1.02 * end);
        put_deviations(chart, below, fit);
    }
    sf_chart_write(chart, output, warning, size, err);
    sf_chart_free(chart);
    return err->status;
}
