/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Charts. A program describes a picture as panels of axes, series, bands and marks; this layer alone writes
 * commands of gnuplot. The picture becomes NAME.gp (with its data in it: it runs from any folder), NAME.png
 * and, for a page, the same as an SVG element.
 *
 * The functions below add to a chart and never fail at once: a failure is kept in the sf_error of
 * sf_chart_new, and sf_chart_write returns it. Texts are copied. */
#pragma once
#include "io/staging.h"
#include <stdint.h>

enum { SF_CHART_TEXT = 192 };

typedef enum sf_series_kind {
    SF_SERIES_LINE,
    SF_SERIES_POINTS,
    SF_SERIES_AREA,   /* between y and 0 */
    SF_SERIES_RANGE,  /* between low and high */
    SF_SERIES_BOXES,  /* a bar from 0 to y */
    SF_SERIES_SPANS,  /* a horizontal bar from low to high, its middle at y */
    SF_SERIES_ERRORS, /* a point with a vertical bar from low to high */
    SF_SERIES_SIDES,  /* a point with a horizontal bar from low to high */
    SF_SERIES_CELLS,  /* a square at (x, y), coloured by `low` from 0 (red) to 1 (green) */
    SF_SERIES_LABELS, /* the text of each point */
} sf_series_kind;

typedef enum sf_point_shape {
    SF_POINT_DISC = 7,
    SF_POINT_CIRCLE = 6,
    SF_POINT_SQUARE = 5,
    SF_POINT_CROSS = 2
} sf_point_shape;

typedef struct sf_series_style {
    sf_series_kind kind;
    const char *colour; /* "#rrggbb"; static storage */
    double width;       /* of lines; 0: 1 */
    bool dashed;
    sf_point_shape shape; /* of points; 0: a disc */
    double size;          /* of points, of the font of labels; 0: 1 */
    double opacity;       /* of areas; 0: 1 */
} sf_series_style;

typedef struct sf_axis {
    char label[SF_CHART_TEXT];
    char page_label[SF_CHART_TEXT]; /* in a page, whose caption says the rest; "": `label` */
    double low, high;               /* NaN: automatic */
    bool logarithmic, hidden;       /* hidden: neither numbers nor label */
    double step;                    /* between tics; 0: automatic */
    int word_count;                 /* words stand at 0, 1, ... in place of numbers */
    char **word;                    /* owned by the chart; sf_axis_word adds one */
} sf_axis;

typedef enum sf_key_place {
    SF_KEY_NONE,
    SF_KEY_TOP_LEFT,
    SF_KEY_TOP_RIGHT,
    SF_KEY_TOP,
    SF_KEY_ABOVE,
    SF_KEY_RIGHT, /* beside the panel, half way up */
    SF_KEY_BELOW  /* below the axis, in even rows */
} sf_key_place;

typedef struct sf_panel {
    char title[SF_CHART_TEXT];
    sf_axis x, y;
    sf_axis x2; /* above; used if it has a label */
    sf_key_place key;
    int key_columns; /* of SF_KEY_BELOW at most; 0: 3 */
    double area[4];  /* left, right, bottom and top of the axes, parts of the picture; 0: automatic */
    bool padded;     /* room between data and axes */
    int left;        /* characters kept free at the left for words; 0: automatic */
} sf_panel;

typedef struct sf_chart sf_chart;
typedef struct sf_series_data sf_series_data;

/* A chart of width x height pixels with the file name NAME; NULL: no memory. sf_chart_write releases it,
 * or sf_chart_free. */
sf_chart *sf_chart_new(const char *name, int width, int height, sf_error *err);
void sf_chart_free(sf_chart *chart);

/* The title above all panels, in the PNG only: a page has it in its text. */
void sf_chart_title(sf_chart *chart, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Columns of a grid of panels without areas of their own; 1 unless it is called. */
void sf_chart_columns(sf_chart *chart, int columns);

/* A new panel with automatic axes; the chart's. After a failure one that is not drawn. */
sf_panel *sf_chart_panel(sf_chart *chart);
/* The same with labels of its axes, and `area`. */
sf_panel *sf_chart_panel_at(sf_chart *chart, const char *x, const char *y, double left, double right,
                            double bottom, double top);
void sf_axis_label(sf_axis *axis, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sf_axis_range(sf_axis *axis, double low, double high);
void sf_axis_word(sf_chart *chart, sf_axis *axis, const char *word);

/* A new series of the last panel with the title of the key (NULL: none); the chart's. */
sf_series_data *sf_chart_series(sf_chart *chart, sf_series_style style, const char *title, ...)
    __attribute__((format(printf, 3, 4)));
/* Adds a point; low and high as the kind says. A point that is not finite breaks a line. */
void sf_series_add(sf_series_data *series, double x, double y, double low, double high);
void sf_series_point(sf_series_data *series, double x, double y);
/* Adds the points of arrays, of more than `most` evenly chosen ones (0: all), times the factors. */
void sf_series_points(sf_series_data *series, int64_t count, const double *x, const double *y,
                      double x_factor, double y_factor, int64_t most);
/* Adds a point with a text, of SF_SERIES_LABELS. */
void sf_series_label(sf_series_data *series, double x, double y, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Marks of the last panel: a dashed horizontal line with its text above its left end; a vertical line from
 * the axis to `top` with a text beside its upper end; a disc with a text beside it; a rectangle behind the
 * data. NULL: no text. An infinite end of a rectangle is that of the panel. */
typedef enum sf_mark_kind { SF_MARK_LEVEL, SF_MARK_DROP, SF_MARK_SPOT, SF_MARK_BAND } sf_mark_kind;
void sf_chart_mark(sf_chart *chart, sf_mark_kind kind, double x, double y, const char *colour,
                   const char *text, ...) __attribute__((format(printf, 6, 7)));
#define sf_chart_level(chart, y, ...) sf_chart_mark(chart, SF_MARK_LEVEL, 0, y, __VA_ARGS__)
#define sf_chart_drop(chart, x, top, ...) sf_chart_mark(chart, SF_MARK_DROP, x, top, __VA_ARGS__)
#define sf_chart_spot(chart, x, y, ...) sf_chart_mark(chart, SF_MARK_SPOT, x, y, __VA_ARGS__)
void sf_chart_band(sf_chart *chart, const double x[2], const double y[2], const char *colour, double opacity);

/* Writes NAME.gp and draws NAME.png in the staging directory, and releases the chart. If gnuplot is absent or
 * fails, `warning` (size bytes) says so in a sentence; otherwise it is "". */
sf_status sf_chart_write(sf_chart *chart, const sf_staging *output, char *warning, size_t size,
                         sf_error *err);

/* NAME as an SVG element that can stand in a page, after sf_chart_write. From malloc, owned by the caller;
 * NULL if there is none, and a warning that asks to run `program`, which writes the page, again. No file
 * stays. */
char *sf_chart_svg(const sf_staging *output, const char *name, const char *program, char *warning,
                   size_t size);

/* The same as a figure of the page, with its caption, or the warning in its place. */
void sf_chart_figure(FILE *page, const sf_staging *output, const char *name, const char *program,
                     const char *caption);

/* The SVG element of a file of gnuplot's terminal: no prologue and no titles, every id with NAME before it;
 * NULL if the text holds none, or out of memory. */
char *sf_gnuplot_element(const char *text, const char *name);

/* The parts of a chart. Internal to src/report: chart_data.c collects and draws them, chart_script.c
 * writes them as commands of gnuplot. */

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
