/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The script of a chart: the only commands of gnuplot in softfall. */
#include "report/chart.h"

#include <math.h>
#include <string.h>

/* A text as gnuplot's string: between single quotes, which gnuplot takes as they are; lines joined by "\n".
 */
static void put_text(FILE *g, const char *text) {
    fputc('\'', g);
    for (; *text; text++) {
        if (*text == '\n')
            fputs("'.\"\\n\".'", g);
        else
            fputs(*text == '\'' ? "''" : (char[]){*text, '\0'}, g);
    }
    fputc('\'', g);
}

static void put_between(FILE *g, const char *before, const char *text, const char *after) {
    fputs(before, g);
    put_text(g, text);
    fputs(after, g);
}

/* Writes a number, or `other` if it is not finite; "*" is an end of a range that gnuplot chooses. */
static void put_number(FILE *g, double value, const char *other) {
    if (isfinite(value))
        fprintf(g, "%.9g", value);
    else
        fputs(other, g);
}

static bool is_drawable(const sf_series_value *v) {
    return isfinite(v->x) && (isfinite(v->y) || (isfinite(v->low) && isfinite(v->high)));
}

/* gnuplot ends with an error at a series without any number. */
static bool has_points(const sf_series_data *s) {
    for (size_t k = 0; k < s->count; k++)
        if (is_drawable(&s->value[k]))
            return true;
    return false;
}

/* ---- the head of the script ---- */

static void put_head(FILE *g, const sf_chart *c) {
    fprintf(g,
            "# gnuplot %s.gp draws %s.png, gnuplot -c %s.gp svg draws %s.svg: from any folder, beside this "
            "file.\nset encoding utf8\nif (exists('ARG0')) {\n    folder = ''\n    do for [k = "
            "1:strlen(ARG0)] { if (substr(ARG0, k, k) eq '/') { folder = substr(ARG0, 1, k) } }\n    if "
            "(folder ne '') { cd folder }\n}\n",
            c->name, c->name, c->name, c->name);
    fprintf(g,
            "svg = exists('ARG1') && ARG1 eq 'svg'\ndot = svg ? 0.5 : 1 # size of points\n"
            "if (svg) {\n"
            "    set terminal svg size %d,%d font 'Arial,11' linewidth 0.5 dashlength 2 noenhanced\n"
            "    set output '%s.svg'\n"
            "} else {\n"
            "    set terminal pngcairo size %d,%d font 'DejaVu Sans,20' noenhanced background rgb 'white'\n"
            "    set output '%s.png'\n}\n",
            9 * c->width / 25, 9 * c->height / 25, c->name, c->width, c->height, c->name);
    fputs("set datafile separator ','\n"
          "set grid back lt 1 lc rgb '#d8d8d8' lw 1\nset border 3 lw 1.5 lc rgb '#404040'\n"
          "set tics nomirror out scale 0.6\nset xlabel offset 0,0.4\nset style fill noborder\n",
          g);
}

/* Data of the series k of panel p: $d<p>_<k> with x, y, low, high. */
static void put_data(FILE *g, const sf_chart *c) {
    for (size_t p = 0; p < c->panel_count; p++)
        for (size_t k = 0; k < c->panel[p]->series_count; k++) {
            const sf_series_data *s = c->panel[p]->series[k];
            fprintf(g, "$d%zu_%zu << EOD\n", p, k);
            for (size_t i = 0; i < s->count; i++) {
                const double cell[4] = {s->value[i].x, s->value[i].y, s->value[i].low, s->value[i].high};
                for (int j = 0; j < (isnan(cell[2]) ? 2 : 4); j++) {
                    fputs(j ? "," : "", g);
                    put_number(g, cell[j], "NaN");
                }
                fputc('\n', g);
            }
            fputs("EOD\n", g);
        }
}

/* ---- axes, key, marks of a panel ---- */

static void put_axis(FILE *g, const char *name, const sf_axis *a) {
    fprintf(g, "set %srange [", name);
    put_number(g, a->low, "*");
    fputc(':', g);
    put_number(g, a->high, "*");
    fprintf(g, "]\nset %slabel", name);
    put_between(g, " ", a->hidden ? "" : a->label, "\n");
    if (*a->page_label) {
        fprintf(g, "if (svg) { set %slabel", name);
        put_between(g, " ", a->page_label, " }\n");
    }
    fprintf(g, a->logarithmic ? "set logscale %s\n" : "unset logscale %s\n", name);
    fprintf(g, "set format %s '%s'\n", name, a->hidden ? "" : "%g");
    fprintf(g, "set %stics ", name);
    if (a->word_count > 0)
        fputc('(', g);
    else if (a->step > 0)
        fprintf(g, "autofreq %.9g", a->step);
    else
        fputs("autofreq", g);
    for (int k = 0; k < a->word_count; k++) {
        put_text(g, a->word[k]);
        fprintf(g, " %d%s", k, k + 1 < a->word_count ? ", " : ")");
    }
    fputc('\n', g);
}

/* A second axis above the panel, or none. */
static void put_upper_axis(FILE *g, const sf_axis *a) {
    fputs("unset x2tics\nunset x2label\nset border 3\n", g);
    if (!*a->label)
        return;
    fprintf(g, "set x2range [%.9g:%.9g]\nset x2tics nomirror out scale 0.6\nset border 7\n", a->low, a->high);
    put_between(g, "set x2label ", a->label, " offset 0,-0.4\n");
}

/* Entries of the key, and the characters of the longest. */
static int key_entries(const sf_chart_panel_data *p, int *longest) {
    int count = 0;
    *longest = 0;
    for (size_t k = 0; k < p->series_count; k++) {
        int length = (int)strlen(p->series[k]->title);
        if (length == 0 || !has_points(p->series[k]))
            continue;
        *longest = length > *longest ? length : *longest;
        count++;
    }
    return count;
}

/* The key below the axes has even rows of as many columns as fit into the width: gnuplot would break longer
 * ones, and the key would grow over the axis. */
static void put_key(FILE *g, const sf_chart_panel_data *p) {
    static const char *const places[] = {[SF_KEY_TOP_LEFT] = "top left Left reverse samplen 2",
                                         [SF_KEY_TOP_RIGHT] = "top right Right noreverse samplen 2",
                                         [SF_KEY_TOP] = "top center horizontal samplen 1",
                                         [SF_KEY_ABOVE] = "outside top center horizontal maxrows 3",
                                         [SF_KEY_RIGHT] =
                                             "outside right center vertical Left reverse samplen 1.5"};
    int longest, entries = key_entries(p, &longest);
    int columns = p->shown.key_columns > 0 ? p->shown.key_columns : 3;
    int rows = (entries + columns - 1) / columns;
    if (entries == 0 || p->shown.key == SF_KEY_NONE) {
        fputs("unset key\n", g);
    } else if (p->shown.key == SF_KEY_BELOW) {
        if (p->shown.area[1] <= 0)
            fprintf(g, "set bmargin %.1f\n", 3.4 + 1.2 * rows);
        fprintf(g,
                "set key at screen 0.5,0.015 center bottom horizontal maxcols %d Left reverse samplen 1.5 "
                "width (svg ? -4 : 1) spacing 1.1\n",
                (entries + rows - 1) / rows);
    } else {
        fprintf(g, "set key default\nset key %s\n", places[p->shown.key]);
    }
}

/* An end of a rectangle: the panel's where it is infinite. */
static void put_corner(FILE *g, const char *before, double end) {
    if (isfinite(end))
        fprintf(g, "%sfirst %.9g", before, end);
    else
        fprintf(g, "%sgraph %d", before, end > 0);
}

static void put_mark(FILE *g, const sf_chart_mark_data *m) {
    const char *colour = m->colour;
    double x = m->x[0], y = m->y[0];
    if (m->kind == SF_MARK_DROP)
        fprintf(
            g, "set arrow from first %.9g, graph 0 to first %.9g, first %.9g nohead front lw 2 lc rgb '%s'\n",
            x, x, y, colour);
    if (m->kind != SF_MARK_BAND)
        put_between(g, "set label ", m->text, "");
    switch (m->kind) {
    case SF_MARK_LEVEL: /* its line is plotted, so that the axis reaches it */
        fprintf(g, " at graph 0.01, first %.9g left offset 0,0.6 front tc rgb '%s'\n", y, colour);
        break;
    case SF_MARK_DROP:
        fprintf(g, " at first %.9g, first %.9g right offset -0.6,0.8 front tc rgb '%s'\n", x, y, colour);
        break;
    case SF_MARK_SPOT:
        fprintf(g, " at %.9g,%.9g left offset 1.2,0.5 tc rgb '%s' front point pt 7 ps 1.6*dot lc rgb '%s'\n",
                x, y, colour, colour);
        break;
    case SF_MARK_BAND:
        put_corner(g, "set object rectangle from ", x);
        put_corner(g, ", ", y);
        put_corner(g, " to ", m->x[1]);
        put_corner(g, ", ", m->y[1]);
        fprintf(g, " behind fc rgb '%s' fs solid %g noborder\n", colour, m->opacity);
        break;
    }
}

/* The texts of the labels of a series, in their middle at the points. */
static void put_labels(FILE *g, const sf_series_data *s) {
    double size = s->style.size > 0 ? s->style.size : 16;
    for (size_t k = 0; k < s->count; k++) {
        put_between(g, "set label ", s->text[k], "");
        fprintf(g, " at %.9g,%.9g center front font sprintf(',%%g', svg ? %g : %g)\n", s->value[k].x,
                s->value[k].y, 0.55 * size, size);
    }
}

/* ---- series ---- */

static double or_one(double value) {
    return value > 0 ? value : 1;
}

static void put_style(FILE *g, const sf_series_style *s) {
    double width = or_one(s->width), size = or_one(s->size), opacity = or_one(s->opacity);
    int shape = s->shape ? (int)s->shape : SF_POINT_DISC;
    switch (s->kind) {
    case SF_SERIES_LINE:
        fprintf(g, "using 1:2 with lines lw %g dt %d lc rgb '%s'", width, s->dashed ? 2 : 1, s->colour);
        break;
    case SF_SERIES_POINTS:
        fprintf(g, "using 1:2 with points pt %d ps %g*dot lw %g lc rgb '%s'", shape, size, width, s->colour);
        break;
    case SF_SERIES_AREA:
        fprintf(g, "using 1:2 with filledcurves y=0 fc rgb '%s' fs solid %g noborder", s->colour, opacity);
        break;
    case SF_SERIES_RANGE:
        fprintf(g, "using 1:3:4 with filledcurves fc rgb '%s' fs solid %g noborder", s->colour, opacity);
        break;
    case SF_SERIES_BOXES:
        fprintf(g, "using 1:2:(%g) with boxes fs solid %g noborder lc rgb '%s'", size, opacity, s->colour);
        break;
    case SF_SERIES_SPANS:
        fprintf(g,
                "using (0.5*($3+$4)):2:3:4:($2-0.35):($2+0.35) with boxxyerror fs solid %g noborder lc rgb "
                "'%s'",
                opacity, s->colour);
        break;
    case SF_SERIES_ERRORS:
        fprintf(g, "using 1:2:3:4 with yerrorbars pt %d lw %g lc rgb '%s'", shape, width, s->colour);
        break;
    case SF_SERIES_SIDES:
        fprintf(g, "using 1:2:3:4 with xerrorbars pt %d lw %g lc rgb '%s'", shape, width, s->colour);
        break;
    case SF_SERIES_CELLS:
        fputs("using 1:2:(0.5):(0.5):3 with boxxyerror fs solid lc palette", g);
        break;
    case SF_SERIES_LABELS:
        break;
    }
}

static void put_plot(FILE *g, size_t panel, const sf_chart_panel_data *p) {
    bool any = false;
    for (size_t k = 0; k < p->mark_count; k++)
        if (p->mark[k].kind == SF_MARK_LEVEL) {
            fprintf(g, "%s%.9g with lines lw 2.5 dt 2 lc rgb '%s' notitle", any ? ", \\\n     " : "plot ",
                    p->mark[k].y[0], p->mark[k].colour);
            any = true;
        }
    for (size_t k = 0; k < p->series_count; k++) {
        const sf_series_data *s = p->series[k];
        if (s->style.kind == SF_SERIES_LABELS || !has_points(s))
            continue;
        fprintf(g, "%s$d%zu_%zu ", any ? ", \\\n     " : "plot ", panel, k);
        put_style(g, &s->style);
        if (*s->title)
            put_between(g, " title ", s->title, "");
        else
            fputs(" notitle", g);
        any = true;
    }
    fputs(any ? "\n" : "plot 0 notitle\n", g);
}

static void put_margins(FILE *g, const sf_panel *p) {
    if (p->area[1] > 0)
        fprintf(g,
                "set lmargin at screen %g\nset rmargin at screen %g\nset bmargin at screen %g\nset tmargin "
                "at screen %g\n",
                p->area[0], p->area[1], p->area[2], p->area[3]);
    else if (p->left > 0)
        fprintf(g, "set lmargin %d\n", p->left);
    fputs(p->padded ? "set offsets graph 0.04, graph 0.04, graph 0.05, graph 0.05\n" : "unset offsets\n", g);
}

static void put_panel(FILE *g, const sf_chart *c, size_t k) {
    const sf_chart_panel_data *p = c->panel[k];
    if (k > 0)
        fputs("unset label\nunset arrow\nunset object\n", g);
    if (*p->shown.title)
        put_between(g, "set title ", p->shown.title, "\n");
    else if (k > 0)
        fputs("unset title\n", g);
    put_margins(g, &p->shown);
    put_axis(g, "x", &p->shown.x);
    put_axis(g, "y", &p->shown.y);
    put_upper_axis(g, &p->shown.x2);
    fputs(p->shown.y.low < 0 ? "set xzeroaxis lw 1 lc rgb '#808080'\n" : "unset xzeroaxis\n", g);
    put_key(g, p);
    for (size_t m = 0; m < p->mark_count; m++)
        put_mark(g, &p->mark[m]);
    for (size_t s = 0; s < p->series_count; s++) {
        if (p->series[s]->style.kind == SF_SERIES_LABELS)
            put_labels(g, p->series[s]);
        if (p->series[s]->style.kind == SF_SERIES_CELLS)
            fputs("set cbrange [0:1]\nset palette defined (0 '#cb181d', 0.5 '#fee8a0', 1 '#238b45')\n", g);
    }
    put_plot(g, k, p);
}

sf_status sf_chart_script(const sf_chart *c, const sf_staging *output, sf_error *err) {
    SF_TRY(err->status);
    SF_PRINTED(file, 64, "%s.gp", c->name);
    FILE *g = sf_staging_open(output, file, err);
    SF_TRY(err->status);
    put_head(g, c);
    put_data(g, c);
    bool many = c->panel_count > 1;
    int rows = ((int)c->panel_count + c->columns - 1) / c->columns;
    if (many)
        fprintf(g, "set multiplot layout %d,%d", rows, c->columns);
    if (*c->title)
        put_between(g, many ? " title (svg ? '' : " : "set title ", c->title,
                    many ? ")" : "\nif (svg) { unset title }");
    fputc('\n', g);
    for (size_t k = 0; k < c->panel_count; k++)
        put_panel(g, c, k);
    if (many)
        fputs("unset multiplot\n", g);
    return sf_staging_close(g, file, err);
}
