/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a chart. Internal to src/report: chart_data.c collects and draws them, chart_script.c
 * writes them as commands of gnuplot. */
#pragma once
#include "report/chart.h"

typedef struct sf_series_value {
    double x, y, low, high;
} sf_series_value;

struct sf_series_data {
    sf_chart *chart;
    sf_series_style style;
    char title[SF_CHART_TEXT]; /* "": not in the key */
    size_t count;
    sf_series_value *value; /* [count] owned */
    char **text;            /* [count] of labels, owned; else NULL */
};

typedef struct sf_chart_mark_data {
    sf_mark_kind kind;
    const char *colour;
    double x[2], y[2], opacity;
    char text[SF_CHART_TEXT];
} sf_chart_mark_data;

typedef struct sf_chart_panel_data {
    sf_panel shown;
    size_t series_count, mark_count;
    sf_series_data **series;  /* owned */
    sf_chart_mark_data *mark; /* owned */
} sf_chart_panel_data;

struct sf_chart {
    const char *name; /* borrowed */
    char title[2 * SF_CHART_TEXT];
    int width, height, columns;
    size_t panel_count;
    sf_chart_panel_data **panel; /* owned */
    sf_error *err;
};

/* Writes NAME.gp into the staging directory (chart_script.c). */
sf_status sf_chart_script(const sf_chart *chart, const sf_staging *output, sf_error *err);
