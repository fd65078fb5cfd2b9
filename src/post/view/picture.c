/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* In units of the element, of which its width has WIDTH: a tenth of a millimetre and a bit on the page. */
enum { WIDTH = 1000, BANDS = 16, GAP = 24, TITLE = 22, SCALE = 46, SCALE_WIDTH = 420, BAR = 9, FONT = 15 };
const double sf_picture_decades = 2.5;
const unsigned char sf_picture_colours[SF_PICTURE_COLOURS][3] = {
    {238, 240, 236}, {176, 208, 228}, {84, 150, 200}, {62, 165, 140},
    {236, 212, 84},  {240, 138, 52},  {196, 36, 40},  {96, 0, 30}};

/* The range of the scale, and where the panels lie. */
typedef struct layout {
    const sf_cut *cut;
    const sf_picture_style *style;
    double low, high;     /* of the scale, in the field's unit */
    double x[2], z[2];    /* m, shown */
    double size;          /* units per m */
    double width, height; /* of a panel */
    FILE *svg;
} layout;

static void put_colour(FILE *svg, double at) {
    const unsigned char(*stop)[3] = sf_picture_colours;
    double place = at * (SF_PICTURE_COLOURS - 1);
    int k = (int)fmin(place, SF_PICTURE_COLOURS - 2.0);
    fputc('#', svg);
    for (int c = 0; c < 3; c++)
        fprintf(svg, "%02x", (unsigned)lround(stop[k][c] + (place - k) * (stop[k + 1][c] - stop[k][c])));
}

/* Lower bound of band k of the scale; the lowest and the highest are open. */
static double bound_of(const layout *l, int k) {
    double part = (double)k / BANDS;
    return l->style->logarithmic ? l->low * pow(l->high / l->low, part) : l->low + part * (l->high - l->low);
}

/* The part on one side of the bound. */
static int clip(int count, const sf_corner *corner, double bound, bool above, sf_corner *part) {
    int kept = 0;
    for (int k = 0; k < count; k++) {
        const sf_corner *a = &corner[k], *b = &corner[(k + 1) % count];
        bool a_in = above ? a->value >= bound : a->value <= bound;
        bool b_in = above ? b->value >= bound : b->value <= bound;
        if (a_in)
            part[kept++] = *a;
        if (a_in != b_in) {
            double w = (bound - a->value) / (b->value - a->value);
            part[kept++] = (sf_corner){a->x + w * (b->x - a->x), a->y + w * (b->y - a->y), bound};
        }
    }
    return kept;
}

int sf_picture_band(int count, const sf_corner *corner, double low, double high, sf_corner part[SF_CORNERS]) {
    sf_corner above[SF_CORNERS];
    int kept = clip(count, corner, low, true, above);
    kept = kept ? clip(kept, above, high, false, part) : 0;
    return kept > 2 ? kept : 0;
}

/* In the panel, which has its origin at the top left. */
static sf_corner place(const layout *l, double x, double z, double value) {
    return (sf_corner){(x - l->x[0]) * l->size, (l->z[1] - z) * l->size, value};
}

static sf_corner corner_of(const layout *l, const sf_frame *frame, const sf_cut_point *point, bool mirror) {
    const double *position = l->cut->results->position, *moved = frame->field[SF_FRAME_DISPLACEMENT];
    double x = sf_cut_value(point, position, 3, 0) + sf_cut_value(point, moved, 3, 0);
    double z = sf_cut_value(point, position, 3, 2) + sf_cut_value(point, moved, 3, 2);
    return place(l, mirror ? 2 * l->cut->axis - x : x, z,
                 sf_cut_value(point, frame->field[l->style->field], 1, 0));
}

static bool is_shown(const layout *l, int count, const sf_corner *corner) {
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < count; k++) {
        low = fmin(low, corner[k].x);
        high = fmax(high, corner[k].x);
    }
    return high >= 0 && low <= l->width;
}

static void put_path(FILE *svg, int count, const sf_corner *corner, bool closed) {
    for (int k = 0; k < count; k++)
        fprintf(svg, "%c%.1f %.1f", k ? 'L' : 'M', corner[k].x, corner[k].y);
    if (closed)
        fputc('Z', svg);
}

static void put_band(const layout *l, const sf_frame *frame, int band) {
    double low = band > 0 ? bound_of(l, band) : -INFINITY;
    double high = band < BANDS - 1 ? bound_of(l, band + 1) : INFINITY;
    fputs("<path fill=\"", l->svg);
    put_colour(l->svg, (band + 0.5) / BANDS);
    fputs("\" stroke=\"", l->svg);
    put_colour(l->svg, (band + 0.5) / BANDS);
    fputs("\" stroke-width=\"0.4\" d=\"M0 0", l->svg); /* never an empty path */
    for (int side = 0; side <= (int)l->cut->mirrored; side++)
        for (int64_t p = 0; p < l->cut->polygon_count; p++) {
            const sf_cut_polygon *polygon = &l->cut->polygon[p];
            sf_corner corner[4], part[SF_CORNERS];
            for (int k = 0; k < polygon->count; k++)
                corner[k] = corner_of(l, frame, &polygon->point[k], side == 1);
            int count = sf_picture_band(polygon->count, corner, low, high, part);
            if (count > 0 && is_shown(l, count, part))
                put_path(l->svg, count, part, true);
        }
    fputs("\"/>\n", l->svg);
}

static void put_lines(const layout *l, const sf_frame *frame) {
    fputs("<path fill=\"none\" stroke=\"#30404f\" stroke-opacity=\"0.35\" stroke-width=\"0.35\" d=\"M0 0",
          l->svg);
    for (int side = 0; side <= (int)l->cut->mirrored; side++)
        for (int64_t k = 0; k < l->cut->line_count; k++) {
            sf_corner end[2];
            for (int e = 0; e < 2; e++)
                end[e] = corner_of(l, frame, &l->cut->line[k][e], side == 1);
            if (is_shown(l, 2, end))
                put_path(l->svg, 2, end, false);
        }
    fputs("\"/>\n", l->svg);
}

static int64_t outline_count(const layout *l) {
    const sf_results *r = l->cut->results;
    return r->turns ? r->surface_triangle_count : l->cut->outline_count;
}

/* Piece k of the missile's outline in that frame; x and z of both ends. */
static bool find_outline(const layout *l, const sf_frame_head *head, int64_t k, double end[2][2]) {
    if (l->cut->results->turns)
        return sf_cut_triangle(l->cut, head, k, end);
    for (int e = 0; e < 2; e++)
        for (int c = 0; c < 2; c++)
            end[e][c] = l->cut->outline[k][e][c] + head->missile_displacement[2 * c];
    return true;
}

static void put_missile(const layout *l, const sf_frame_head *head) {
    fputs("<path fill=\"none\" stroke=\"#101820\" stroke-width=\"1.8\" stroke-linecap=\"round\" d=\"M0 0",
          l->svg);
    for (int side = 0; side <= (int)l->cut->mirrored; side++)
        for (int64_t k = 0; k < outline_count(l); k++) {
            sf_corner end[2];
            double x[2][2];
            if (!find_outline(l, head, k, x))
                continue;
            for (int e = 0; e < 2; e++)
                end[e] = place(l, side ? 2 * l->cut->axis - x[e][0] : x[e][0], x[e][1], 0);
            put_path(l->svg, 2, end, false);
        }
    fputs("\"/>\n", l->svg);
}

static void put_text(FILE *svg, double x, double y, const char *anchor, const char *text) {
    fprintf(svg,
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"%d\" fill=\"#1b2430\">%s</text>\n", x,
            y, anchor, FONT, text);
}

static void put_panel(const layout *l, const sf_picture *picture, int k) {
    put_text(l->svg, k * (l->width + GAP) + l->width / 2, FONT, "middle", picture->title);
    fprintf(l->svg, "<svg x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%.1f\">\n", k * (l->width + GAP), TITLE,
            l->width, l->height);
    for (int band = 0; band < BANDS; band++)
        put_band(l, picture->frame, band);
    if (l->style->lines)
        put_lines(l, picture->frame);
    put_missile(l, picture->head);
    fputs("</svg>\n", l->svg);
}

/* The bar of colours with its ticks, and a length beside it. */
static void put_scale(const layout *l) {
    double left = (WIDTH - SCALE_WIDTH) / 2.0, top = TITLE + l->height + 8;
    for (int band = 0; band < BANDS; band++) {
        fprintf(l->svg, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"",
                left + band * (double)SCALE_WIDTH / BANDS, top, (double)SCALE_WIDTH / BANDS + 0.5, BAR);
        put_colour(l->svg, (band + 0.5) / BANDS);
        fputs("\"/>\n", l->svg);
    }
    for (int k = 0; k <= 4; k++) {
        char text[32];
        double value = bound_of(l, k * BANDS / 4) * l->style->factor;
        snprintf(text, sizeof text, value < 1000 ? "%.3g" : "%.0f", value);
        put_text(l->svg, left + k * SCALE_WIDTH / 4.0, top + BAR + FONT, "middle", text);
    }
    put_text(l->svg, left - 24, top + BAR, "end", l->style->label);
    double length = 0.05 * l->size; /* 50 mm */
    fprintf(l->svg, "<path stroke=\"#1b2430\" stroke-width=\"1.2\" d=\"M%.1f %.1fh%.1f\"/>\n",
            WIDTH - length - 4.0, top + BAR / 2.0, length);
    put_text(l->svg, WIDTH - length / 2 - 4, top + BAR + FONT, "middle", "50 mm");
}

/* The largest value of the field in the cut. */
static double find_largest(const sf_cut *cut, const sf_picture *pictures, int count, sf_frame_field field) {
    double largest = 0;
    for (int p = 0; p < count; p++)
        for (int64_t k = 0; k < cut->polygon_count; k++)
            for (int c = 0; c < cut->polygon[k].count; c++)
                largest = fmax(
                    largest, sf_cut_value(&cut->polygon[k].point[c], pictures[p].frame->field[field], 1, 0));
    return largest > 0 ? largest : 1;
}

/* Above the pad so much of the missile as of its thickness in the first picture. */
static void lay_out(layout *l, const sf_picture *pictures, int count) {
    const sf_cut *cut = l->cut;
    double half = fmin(l->style->half_width, fmax(cut->axis - cut->x[0], cut->x[1] - cut->axis));
    double thickness = cut->z[1] - cut->z[0], top = cut->z[1];
    for (int p = 0; p < count; p++)
        for (int64_t k = 0; k < outline_count(l); k++) {
            double x[2][2];
            if (find_outline(l, pictures[p].head, k, x))
                top = fmax(top, fmax(x[0][1], x[1][1]));
        }
    l->x[0] = cut->mirrored ? cut->axis - half : fmax(cut->axis - half, cut->x[0] - 0.02 * half);
    l->x[1] = cut->mirrored ? cut->axis + half : fmin(cut->axis + half, cut->x[1] + 0.02 * half);
    l->z[0] = cut->z[0] - 0.01 * thickness;
    l->z[1] =
        fmin(top, cut->z[1] + (isfinite(l->style->half_width) ? 0.35 : 0.75) * thickness) + 0.02 * thickness;
    l->high = find_largest(cut, pictures, count, l->style->field);
    l->low = l->style->logarithmic ? l->high / pow(10, sf_picture_decades) : 0;
    l->width = (WIDTH - (count - 1) * GAP) / (double)count;
    l->size = l->width / (l->x[1] - l->x[0]);
    l->height = (l->z[1] - l->z[0]) * l->size;
}

char *sf_picture_draw(const sf_cut *cut, const sf_picture *pictures, int count, const sf_picture_style *style,
                      sf_error *err) {
    char *text = NULL;
    size_t size = 0;
    layout l = {.cut = cut, .style = style, .svg = open_memstream(&text, &size)};
    if (!l.svg) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a picture of the report");
        return NULL;
    }
    lay_out(&l, pictures, count);
    fprintf(l.svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %.0f\">\n", WIDTH,
            TITLE + l.height + SCALE);
    for (int k = 0; k < count; k++)
        put_panel(&l, &pictures[k], k);
    put_scale(&l);
    fputs("</svg>\n", l.svg);
    if (fclose(l.svg) == 0)
        return text;
    SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a picture of the report");
    free(text);
    return NULL;
}
