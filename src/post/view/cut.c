/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/cut.h"

#include "base/text.h"
#include <string.h>

/* A point closer to an end than this part of the thickness is at the end. */
static const double AT_END = 1e-6;

/* Files of earlier versions do not say where the planes are, nor do those where all nodes of a plane are of
 * the base too. A symmetry plane is an end of the modelled pad, where a whole missile has its middle, or one
 * that is modelled in part ends too: how many of the pad's two ends are such; *place (m) of the last. */
static int count_common_ends(const sf_results *r, int k, double *place) {
    double low[3], high[3], first[3], last[3];
    int count = 0;
    sf_box3(r->node_count, r->position, low, high);
    sf_box3(r->surface_node_count, r->surface_position, first, last);
    const double pad[2] = {low[k], high[k]}, marks[3] = {0.5 * (first[k] + last[k]), first[k], last[k]};
    for (int end = 0; end < 2; end++) {
        double off = INFINITY;
        for (int mark = 0; mark < 3; mark++)
            off = fmin(off, fabs(marks[mark] - pad[end]));
        if (off > AT_END * r->thickness)
            continue;
        *place = pad[end];
        count++;
    }
    return count;
}

bool sf_axis_planes(const sf_results *r, double place[2]) {
    place[0] = r->symmetry_place[0];
    place[1] = r->symmetry_place[1];
    if (r->symmetry_factor == 1 << (isfinite(place[0]) + isfinite(place[1])))
        return true;
    double end[2];
    const int count[2] = {count_common_ends(r, 0, &end[0]), count_common_ends(r, 1, &end[1])};
    bool known = r->symmetry_factor == 4 ? count[0] == 1 && count[1] == 1 : count[0] + count[1] == 1;
    for (int k = 0; k < 2; k++)
        place[k] = known && count[k] ? end[k] : NAN;
    return known;
}

void sf_axis_find(const sf_results *r, double axis[2]) {
    double place[2], low[3], high[3];
    sf_axis_planes(r, place);
    sf_box3(r->surface_node_count, r->surface_position, low, high);
    for (int k = 0; k < 2; k++)
        axis[k] = isfinite(place[k]) ? place[k] : 0.5 * (low[k] + high[k]);
}

static char *no_memory(sf_error *err) {
    SF_NO_MEMORY(err, "the pictures of the report");
    return NULL;
}

/* Appends an item to an array, the address of a pointer. */
static sf_status append(void *array, int64_t *count, const void *item, size_t size, sf_error *err) {
    char *items;
    if (!sf_grow(array, (size_t)*count, size))
        no_memory(err);
    SF_TRY(err->status);
    memcpy(&items, array, sizeof items);
    memcpy(items + (size_t)(*count)++ * size, item, size);
    return SF_OK;
}

double sf_cut_value(const sf_cut_point *p, const double *field, int components, int component) {
    double a = field[components * (int64_t)p->node[0] + component];
    double b = field[components * (int64_t)p->node[1] + component];
    return a + p->weight * (b - a);
}

static double height_over(const sf_cut *cut, const double *position) {
    return position[1] - cut->plane;
}

/* The point where the edge between the nodes crosses the plane; false if it does not. */
static bool cross_edge(const sf_cut *cut, int32_t a, int32_t b, sf_cut_point *point) {
    double from = height_over(cut, &cut->results->position[3 * (int64_t)a]);
    double to = height_over(cut, &cut->results->position[3 * (int64_t)b]);
    if ((from < 0) == (to < 0))
        return false;
    *point = (sf_cut_point){{a, b}, from / (from - to)};
    return true;
}

/* A tetrahedron has a triangle or a quadrangle in the plane. The edges of the list follow each other around
 * it: of the four that a quadrangle crosses, those opposite in the tetrahedron are never neighbours. */
static sf_status cut_tetrahedron(sf_cut *cut, const int32_t *cell, const int corner[4], sf_error *err) {
    static const int edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    sf_cut_polygon polygon = {0};
    for (int k = 0; k < 6 && polygon.count < 4; k++)
        polygon.count += cross_edge(cut, cell[corner[edge[k][0]]], cell[corner[edge[k][1]]],
                                    &polygon.point[polygon.count]);
    if (polygon.count < 3)
        return SF_OK;
    if (polygon.count ==
        4) { /* two of the points are on opposite edges: they become the first and the third */
        sf_cut_point first = polygon.point[0];
        for (int k = 1; k < 4; k++) {
            const sf_cut_point *p = &polygon.point[k];
            bool shared = p->node[0] == first.node[0] || p->node[0] == first.node[1] ||
                          p->node[1] == first.node[0] || p->node[1] == first.node[1];
            if (!shared && k != 2) {
                sf_cut_point other = polygon.point[2];
                polygon.point[2] = *p;
                polygon.point[k] = other;
            }
        }
    }
    return append(&cut->polygon, &cut->polygon_count, &polygon, sizeof polygon, err);
}

static sf_status cut_face(sf_cut *cut, const int32_t *cell, const int corner[4], sf_error *err) {
    sf_cut_point point[4];
    int sides = corner[3] < 0 ? 3 : 4, count = 0;
    for (int k = 0; k < sides; k++)
        count += cross_edge(cut, cell[corner[k]], cell[corner[(k + 1) % sides]], &point[count]);
    if (count != 2)
        return SF_OK;
    return append(&cut->line, &cut->line_count, point, sizeof *cut->line, err);
}

static sf_status cut_cells(sf_cut *cut, sf_error *err) {
    const sf_results *r = cut->results;
    for (int64_t c = 0; c < r->cell_count && err->status == SF_OK; c++) {
        const int32_t *cell = &r->cell_node[r->cell_ptr[c]];
        const sf_cell_shape *shape = sf_cell_shape_of(r->cell_type[c]);
        int64_t vertices = r->cell_ptr[c + 1] - r->cell_ptr[c], below = 0;
        for (int64_t v = 0; v < vertices; v++)
            below += height_over(cut, &r->position[3 * (int64_t)cell[v]]) < 0;
        if (below == 0 || below == vertices)
            continue;
        for (int k = 0; k < shape->tetrahedra && err->status == SF_OK; k++)
            cut_tetrahedron(cut, cell, shape->tetrahedron[k], err);
        for (int k = 0; k < shape->faces && err->status == SF_OK; k++)
            cut_face(cut, cell, shape->face[k], err);
    }
    return err->status;
}

/* The part of a triangle in the plane. */
static bool cross_triangle(const sf_cut *cut, const double *const corner[3], double segment[2][2]) {
    int count = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        double from = height_over(cut, a), to = height_over(cut, b);
        if ((from < 0) == (to < 0))
            continue;
        double weight = from / (from - to);
        segment[count][0] = a[0] + weight * (b[0] - a[0]);
        segment[count++][1] = a[2] + weight * (b[2] - a[2]);
    }
    return count == 2;
}

/* The missile's triangle where it is in that frame: x and z of both ends of its part of the plane; false: it
 * is not in the plane. */
static bool cut_triangle(const sf_cut *cut, const sf_frame_head *head, int64_t t, double end[2][2]) {
    const sf_results *r = cut->results;
    double x[3][3];
    for (int k = 0; k < 3; k++)
        sf_results_place(r, head, &r->surface_position[3 * (int64_t)r->surface_triangle[3 * t + k]], x[k]);
    return cross_triangle(cut, (const double *const[3]){x[0], x[1], x[2]}, end);
}

/* Appends the parts of the triangles in the plane to the outline. */
static sf_status cut_surface(sf_cut *cut, int64_t count, const double *position, const int32_t *triangle,
                             sf_error *err) {
    for (int64_t t = 0; t < count; t++) {
        double segment[2][2];
        const double *corner[3];
        sf_corners(position, &triangle[3 * t], corner);
        if (cross_triangle(cut, corner, segment))
            SF_TRY(append(&cut->outline, &cut->outline_count, segment, sizeof *cut->outline, err));
    }
    return SF_OK;
}

static sf_status cut_bodies(sf_cut *cut, sf_error *err) {
    const sf_results *r = cut->results;
    cut->missile[0] = INFINITY;
    cut->missile[1] = -INFINITY;
    SF_TRY(cut_surface(cut, r->surface_triangle_count, r->surface_position, r->surface_triangle, err));
    cut->support_first = cut->outline_count;
    for (int64_t k = 0; k < 2 * cut->outline_count; k++) {
        cut->missile[0] = fmin(cut->missile[0], cut->outline[k / 2][k % 2][0]);
        cut->missile[1] = fmax(cut->missile[1], cut->outline[k / 2][k % 2][0]);
    }
    return cut_surface(cut, r->support_triangle_count, r->support_position, r->support_triangle, err);
}

/* The plane, and whether the pad goes on beyond the missile's axis as its mirror image. */
static void find_plane(sf_cut *cut) {
    const sf_results *r = cut->results;
    double axis[2], place[2], low[3], high[3];
    sf_box3(r->node_count, r->position, low, high);
    sf_axis_find(r, axis);
    sf_axis_planes(r, place);
    double near = 1e-6 * fmax(high[0] - low[0], high[1] - low[1]);
    cut->axis = axis[0];
    cut->mirrored = isfinite(place[0]);
    cut->plane = axis[1] + (axis[1] + near < high[1] ? near : -near);
    cut->x[0] = low[0];
    cut->x[1] = high[0];
    cut->z[0] = low[2];
    cut->z[1] = high[2];
}

sf_status sf_cut_make(const sf_results *results, sf_cut *cut, sf_error *err) {
    *cut = (sf_cut){.results = results};
    find_plane(cut);
    SF_TRY(cut_cells(cut, err));
    return cut_bodies(cut, err);
}

void sf_cut_free(sf_cut *cut) {
    SF_CLEAR(cut, cut->polygon, cut->line, cut->outline);
}

/* ---- pictures of the cut ---- */

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
    return r->turns ? r->surface_triangle_count : l->cut->support_first;
}

/* Piece k of the missile's outline in that frame; x and z of both ends. */
static bool find_outline(const layout *l, const sf_frame_head *head, int64_t k, double end[2][2]) {
    if (l->cut->results->turns)
        return cut_triangle(l->cut, head, k, end);
    for (int e = 0; e < 2; e++)
        for (int c = 0; c < 2; c++)
            end[e][c] = l->cut->outline[k][e][c] + head->missile_displacement[2 * c];
    return true;
}

/* Draws the missile in that frame; NULL: the supports. */
static void put_body(const layout *l, const sf_frame_head *head) {
    fprintf(l->svg,
            "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.8\" stroke-linecap=\"round\" d=\"M0 0",
            head ? "#101820" : "#7a5c3a");
    for (int side = 0; side <= (int)l->cut->mirrored; side++)
        for (int64_t k = head ? 0 : l->cut->support_first;
             k < (head ? outline_count(l) : l->cut->outline_count); k++) {
            sf_corner end[2];
            double x[2][2];
            if (!head)
                memcpy(x, l->cut->outline[k], sizeof x);
            else if (!find_outline(l, head, k, x))
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
    put_body(l, NULL);
    put_body(l, picture->head);
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
        double value = bound_of(l, k * BANDS / 4) * l->style->factor;
        SF_PRINTED(text, 32, value < 1000 ? "%.3g" : "%.0f", value);
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
    l->z[0] = cut->z[0] - (cut->results->support_triangle_count > 0 ? 0.15 : 0.01) * thickness;
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
    SF_TEXT_STREAM(svg, text, size);
    layout l = {.cut = cut, .style = style, .svg = svg};
    if (!l.svg)
        return no_memory(err);
    lay_out(&l, pictures, count);
    fprintf(l.svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %.0f\">\n", WIDTH,
            TITLE + l.height + SCALE);
    for (int k = 0; k < count; k++)
        put_panel(&l, &pictures[k], k);
    put_scale(&l);
    fputs("</svg>\n", l.svg);
    return sf_text_close(l.svg, &text) ? text : no_memory(err);
}
