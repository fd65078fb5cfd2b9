/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/chart.h"

#include "base/text.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "report/html.h"

#include <math.h>
#include <string.h>

/* ---- panels, series and marks ---- */

/* Makes room for one more element behind `array`, the address of a pointer; returns false after a failure,
 * which stands in chart->err. */
static bool grow(sf_chart *chart, void *array, size_t count, size_t size) {
    if (chart->err->status == SF_OK && !sf_grow(array, count, size))
        SF_NO_MEMORY(chart->err, "the picture %s", chart->name);
    return chart->err->status == SF_OK;
}

sf_chart *sf_chart_new(const char *name, int width, int height, sf_error *err) {
    sf_chart *chart = sf_alloc(err, 1, sizeof *chart, "a picture");
    if (chart)
        *chart = (sf_chart){.name = name, .width = width, .height = height, .columns = 1, .err = err};
    return chart;
}

static void free_axis(sf_axis *axis) {
    sf_free_all((size_t)axis->word_count, axis->word);
    free(axis->word);
}

void sf_chart_free(sf_chart *chart) {
    if (!chart)
        return;
    for (size_t k = 0; k < chart->panel_count; k++) {
        sf_chart_panel_data *p = chart->panel[k];
        for (size_t s = 0; s < p->series_count; s++) {
            sf_free_all(p->series[s]->count, p->series[s]->text);
            SF_FREE(p->series[s]->text, p->series[s]->value, p->series[s]);
        }
        SF_FREE(p->series, p->mark);
        free_axis(&p->shown.x);
        free_axis(&p->shown.y);
        free_axis(&p->shown.x2);
        free(p);
    }
    SF_FREE(chart->panel, chart);
}

void sf_chart_title(sf_chart *chart, const char *format, ...) {
    if (chart)
        SF_PRINT_INTO(chart->title, format);
}

void sf_chart_columns(sf_chart *chart, int columns) {
    if (chart)
        chart->columns = columns;
}

sf_panel *sf_chart_panel(sf_chart *chart) {
    static const sf_axis automatic = {.low = NAN, .high = NAN};
    static sf_panel not_drawn;
    sf_chart_panel_data *panel = chart && grow(chart, &chart->panel, chart->panel_count, sizeof panel)
                                     ? sf_alloc(chart->err, 1, sizeof *panel, "a picture")
                                     : NULL;
    if (!panel)
        return &not_drawn;
    *panel = (sf_chart_panel_data){.shown = {.x = automatic, .y = automatic, .x2 = automatic}};
    chart->panel[chart->panel_count++] = panel;
    return &panel->shown;
}

sf_panel *sf_chart_panel_at(sf_chart *chart, const char *x, const char *y, double left, double right,
                            double bottom, double top) {
    const double area[4] = {left, right, bottom, top};
    sf_panel *panel = sf_chart_panel(chart);
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "%s", x);
    sf_axis_label(&panel->y, "%s", y);
    return panel;
}

void sf_axis_label(sf_axis *axis, const char *format, ...) {
    SF_PRINT_INTO(axis->label, format);
}

void sf_axis_range(sf_axis *axis, double low, double high) {
    axis->low = low;
    axis->high = high;
}

void sf_axis_word(sf_chart *chart, sf_axis *axis, const char *word) {
    if (chart && grow(chart, &axis->word, (size_t)axis->word_count, sizeof *axis->word) &&
        (axis->word[axis->word_count] = strdup(word)))
        axis->word_count++;
}

static sf_chart_panel_data *last_panel(const sf_chart *chart) {
    return chart && chart->err->status == SF_OK && chart->panel_count > 0
               ? chart->panel[chart->panel_count - 1]
               : NULL;
}

sf_series_data *sf_chart_series(sf_chart *chart, sf_series_style style, const char *title, ...) {
    sf_chart_panel_data *p = last_panel(chart);
    sf_series_data *series = p && grow(chart, &p->series, p->series_count, sizeof series)
                                 ? sf_alloc(chart->err, 1, sizeof *series, "a picture")
                                 : NULL;
    if (!series)
        return NULL;
    *series = (sf_series_data){.chart = chart, .style = style};
    if (title)
        SF_PRINT_INTO(series->title, title);
    p->series[p->series_count++] = series;
    return series;
}

void sf_series_add(sf_series_data *s, double x, double y, double low, double high) {
    if (s && grow(s->chart, &s->value, s->count, sizeof *s->value))
        s->value[s->count++] = (sf_series_value){x, y, low, high};
}

void sf_series_point(sf_series_data *s, double x, double y) {
    sf_series_add(s, x, y, NAN, NAN);
}

void sf_series_points(sf_series_data *s, int64_t count, const double *x, const double *y, double x_factor,
                      double y_factor, int64_t most) {
    int64_t every = most > 0 ? count / most + 1 : 1;
    for (int64_t k = 0; k < count; k += every)
        sf_series_point(s, x_factor * x[k], y_factor * y[k]);
}

void sf_series_label(sf_series_data *s, double x, double y, const char *format, ...) {
    char text[SF_CHART_TEXT];
    SF_PRINT_INTO(text, format);
    if (s && grow(s->chart, &s->text, s->count, sizeof *s->text) && (s->text[s->count] = strdup(text)))
        sf_series_point(s, x, y);
}

void sf_chart_mark(sf_chart *chart, sf_mark_kind kind, double x, double y, const char *colour,
                   const char *text, ...) {
    sf_chart_panel_data *p = last_panel(chart);
    if (!p || !grow(chart, &p->mark, p->mark_count, sizeof *p->mark))
        return;
    sf_chart_mark_data *m = &p->mark[p->mark_count++];
    *m = (sf_chart_mark_data){.kind = kind, .colour = colour, .x[0] = x, .y[0] = y};
    if (text)
        SF_PRINT_INTO(m->text, text);
}

void sf_chart_band(sf_chart *chart, const double x[2], const double y[2], const char *colour,
                   double opacity) {
    sf_chart_panel_data *p = last_panel(chart);
    sf_chart_mark(chart, SF_MARK_BAND, x[0], y[0], colour, NULL);
    if (!p || chart->err->status != SF_OK)
        return;
    sf_chart_mark_data *m = &p->mark[p->mark_count - 1];
    m->x[1] = x[1];
    m->y[1] = y[1];
    m->opacity = opacity;
}

/* ---- pictures by gnuplot ---- */

enum { NAME_SIZE = 64 };

/* Runs NAME.gp for a picture of that ending. `program`: that writes the page of the picture, or NULL if the
 * script stays and draws it later. */
static void run(const sf_staging *output, const char *name, const char *ending, const char *program,
                char *warning, size_t size) {
    SF_PRINTED(script, NAME_SIZE, "%s.gp", name);
    SF_PRINTED(picture, NAME_SIZE, "%s.%s", name, ending);
    SF_PRINTED(command, NAME_SIZE, "gnuplot %s.gp", name);
    warning[0] = '\0';
    const char *const arguments[] = {"gnuplot", "-c", script, ending, NULL};
    const sf_process gnuplot = {.arguments = arguments, .folder = output->aside};
    int code = 0, reason = sf_process_run(&gnuplot, &code);
    if (reason != 0)
        snprintf(warning, size,
                 program
                     ? "%s was not drawn, as gnuplot cannot be run (%s): install gnuplot and run %s again"
                     : "%s was not drawn, as gnuplot cannot be run (%s): install it and run \"%s\" in the "
                       "output directory",
                 picture, strerror(reason), program ? program : command);
    else if (code != 0 || !sf_staging_has(output, picture))
        snprintf(warning, size,
                 program
                     ? "%s was not drawn: gnuplot ended with code %d; try another gnuplot and run %s again"
                     : "%s was not drawn: gnuplot ended with code %d; run \"%s\" in the output directory "
                       "to see why",
                 picture, code, program ? program : command);
}

/* Reads a file of the staging directory and removes it; NULL on failure. */
static char *take_file(const sf_staging *output, const char *name) {
    sf_error ignored = SF_ERROR_INIT;
    char *text = NULL;
    SF_OWNED char *path = sf_staging_path(output, name, &ignored);
    if (path) {
        sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, &ignored);
        sf_staging_remove(output, name);
    }
    return text;
}

/* Returns the length of the beginning of an id, or of a reference to one; 0: there is none. */
static size_t id_prefix(const char *text) {
    static const char *const prefix[] = {" id=\"", " id='", "href=\"#", "href='#", "url(#"};
    for (size_t k = 0; k < sizeof prefix / sizeof prefix[0]; k++)
        if (strncmp(text, prefix[k], strlen(prefix[k])) == 0)
            return strlen(prefix[k]);
    return 0;
}

/* Returns the length of the element <title> that begins here, or 0. A browser would show gnuplot's names of
 * the curves. */
static size_t title_length(const char *text) {
    static const char end[] = "</title>";
    const char *behind = strncmp(text, "<title>", 7) == 0 ? strstr(text, end) : NULL;
    return behind ? (size_t)(behind - text) + strlen(end) : 0;
}

char *sf_gnuplot_element(const char *text, const char *name) {
    const char *at = strstr(text, "<svg");
    char *element = NULL;
    size_t size = 0;
    FILE *out = at ? open_memstream(&element, &size) : NULL;
    if (!out)
        return NULL;
    while (*at) {
        size_t title = title_length(at);
        if (title > 0) {
            at += title;
            continue;
        }
        size_t length = id_prefix(at);
        fwrite(at, 1, length > 0 ? length : 1, out);
        if (length > 0)
            fprintf(out, "%s-", name);
        at += length > 0 ? length : 1;
    }
    return sf_text_close(out, &element);
}

char *sf_chart_svg(const sf_staging *output, const char *name, const char *program, char *warning,
                   size_t size) {
    char picture[NAME_SIZE], *element = NULL;
    run(output, name, "svg", program, warning, size);
    snprintf(picture, sizeof picture, "%s.svg", name);
    SF_OWNED char *text = take_file(output, picture);
    if (text && !*warning)
        element = sf_gnuplot_element(text, name);
    if (!element && !*warning)
        snprintf(warning, size, "%s was drawn, but cannot be read", picture);
    return element;
}

void sf_chart_figure(FILE *page, const sf_staging *output, const char *name, const char *program,
                     const char *caption) {
    char warning[320];
    SF_OWNED char *svg = sf_chart_svg(output, name, program, warning, sizeof warning);
    sf_html_figure(page, svg, "%s.", svg ? caption : warning);
}

sf_status sf_chart_write(sf_chart *chart, const sf_staging *output, char *warning, size_t size,
                         sf_error *err) {
    warning[0] = '\0';
    if (chart && sf_chart_script(chart, output, err) == SF_OK)
        run(output, chart->name, "png", NULL, warning, size);
    sf_chart_free(chart);
    return err->status;
}
