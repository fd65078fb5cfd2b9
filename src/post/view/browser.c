/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/browser.h"

#include "post/view/paraview.h"

#include <float.h>

#include "build_info.h"
#include "model/model.h"
#include "model/cells.h"
#include "post/view/axis.h"

static const char PAGE[] = "view.html", FACTS[] = "id=\"drop\">{}";

enum {
    OVERHEAD = 128000,  /* bytes of the page beside the arrays: its script, curve and texts */
    FEW_FRAMES = 12,    /* with fewer the inside of the pad is left out */
    CURVE_POINTS = 800, /* at most, of the curve */
    HIGHEST_CODE = 65535
};

/* The fields that a frame may be coloured by. */
static const struct {
    sf_frame_field field;
    double factor;
    const char *name, *unit;
    bool logarithmic;
} colourings[] = {{SF_FRAME_VON_MISES, 1e-3, "von Mises stress", "kPa", true},
                  {SF_FRAME_LARGEST_COMPRESSION, 100, "compression", "%", false},
                  {SF_FRAME_CONTACT_PRESSURE, 1e-3, "contact pressure", "kPa", false}};
enum { COLOURINGS = sizeof colourings / sizeof colourings[0] };

/* The colours of the scale, red, green and blue, from its low to its high end; those between are linear. */
enum { COLOURS = 8 };
static const unsigned char scale_colours[COLOURS][3] = {{238, 240, 236}, {176, 208, 228}, {84, 150, 200},
                                                        {62, 165, 140},  {236, 212, 84},  {240, 138, 52},
                                                        {196, 36, 40},   {96, 0, 30}};
static const double DECADES = 2.5; /* of the logarithmic scale */

/* The page, and what is shown on it. */
typedef struct page {
    const sf_summary *summary;
    const sf_results *results;
    const sf_xdmf *made;
    double bytes; /* that it may have */
    sf_shown shown;
    sf_skin_faces skin;
    bool inside;          /* the cells and all nodes stand on the page; else those of the skin */
    bool wide;            /* indices have 32 bits; else 16 */
    int64_t node_count;   /* shown */
    int64_t frame_count;  /* shown */
    double *value;        /* [3 node_count] room for an array; owned */
    unsigned char *coded; /* room for its codes or for indices; owned */
    sf_json json;
} page;

/* ---- what fits ---- */

static int count_fields(const page *p) {
    int count = 0;
    for (int k = 0; k < COLOURINGS; k++)
        count += p->made->fields >> colourings[k].field & 1;
    return count;
}

/* Returns how many frames fit beside the topology. */
static int64_t count_fitting(const page *p, int64_t nodes, bool inside) {
    const sf_results *r = p->results;
    int64_t index = nodes > HIGHEST_CODE ? 4 : 2;
    int64_t fixed = index * (4 * p->skin.face_count + 3 * r->surface_triangle_count) +
                    6 * r->surface_node_count + 6 * r->support_node_count +
                    4 * 3 * r->support_triangle_count +
                    (inside ? index * r->cell_nnz + r->cell_count : 4 * nodes);
    double frame = 6.0 + 2.0 * count_fields(p), room = (p->bytes - OVERHEAD) * 3 / 4 - (double)fixed;
    return room > 0 ? (int64_t)(room / (frame * (double)nodes + 256)) : 0;
}

/* Chooses nodes and frames; false: not even two frames of the skin fit, or the only one. */
static bool choose(page *p) {
    const sf_results *r = p->results;
    int64_t all = p->made->frames, fitting = count_fitting(p, r->node_count, true);
    p->inside = fitting >= (all < FEW_FRAMES ? all : FEW_FRAMES);
    p->node_count = p->inside ? r->node_count : p->skin.node_count;
    if (!p->inside)
        fitting = count_fitting(p, p->node_count, false);
    p->wide = p->node_count > HIGHEST_CODE || r->surface_node_count > HIGHEST_CODE ||
              r->support_node_count > HIGHEST_CODE;
    p->frame_count = fitting < all ? fitting : all;
    return p->frame_count >= (all < 2 ? all : 2);
}

/* Returns the place of the shown frame k among those that are there: they are evenly spread, but the one next
 * to the peak, not the first, is the peak; *peak is set if it is. */
static int64_t frame_at(const page *p, int64_t k, bool *is_peak) {
    int64_t all = p->made->frames, gaps = p->frame_count - 1, peak = p->shown.peak < all ? p->shown.peak : -1;
    int64_t nearest = peak > 0 && gaps > 0 ? (2 * peak * gaps + all - 1) / (2 * (all - 1)) : 0;
    if (peak > 0 && nearest == 0 && gaps > 0)
        nearest = 1;
    *is_peak = peak >= 0 && k == nearest;
    if (*is_peak)
        return peak;
    return gaps > 0 ? k * (all - 1) / gaps : 0;
}

/* ---- arrays ---- */

static int64_t node_of(const page *p, int64_t i) {
    return p->inside ? i : p->skin.node[i];
}

/* Writes numbers as bytes, the lowest first. */
static void encode(unsigned char *to, uint32_t value, int bytes) {
    for (int b = 0; b < bytes; b++)
        to[b] = (unsigned char)(value >> 8 * b);
}

/* Writes every `step`-th of the numbers as an array. */
static void put_numbers(page *p, const char *key, const double *value, int64_t count, int64_t step) {
    SF_JSON_ARRAY(&p->json, key);
    for (int64_t i = 0; i < count; i += step)
        sf_json_number(&p->json, NULL, value[i]);
}

/* Writes value[count][components] with the least value and the step of each component. */
static void put_quantised(page *p, const char *key, const double *value, int64_t count, int components) {
    double low[3], step[3];
    for (int c = 0; c < components; c++) {
        double high = -DBL_MAX;
        low[c] = DBL_MAX;
        for (int64_t i = 0; i < count; i++) {
            low[c] = fmin(low[c], value[components * i + c]);
            high = fmax(high, value[components * i + c]);
        }
        step[c] = count > 0 ? high / HIGHEST_CODE - low[c] / HIGHEST_CODE : 0;
        low[c] = count > 0 ? low[c] : 0;
    }
    for (int64_t i = 0; i < count * components; i++) {
        int c = (int)(i % components);
        double code = step[c] > 0 ? rint((value[i] - low[c]) / step[c]) : 0;
        encode(&p->coded[2 * i], (uint32_t)fmin(code, HIGHEST_CODE), 2);
    }
    SF_JSON_OBJECT(&p->json, key);
    put_numbers(p, "low", low, components, 1);
    put_numbers(p, "step", step, components, 1);
    sf_json_base64(&p->json, "data", p->coded, 2 * (size_t)(count * components));
}

/* Writes indices; -1 becomes the largest number. */
static void put_indices(page *p, const char *key, const int32_t *index, int64_t count) {
    int bytes = p->wide ? 4 : 2;
    for (int64_t k = 0; k < count; k++)
        encode(&p->coded[bytes * k], (uint32_t)index[k], bytes);
    sf_json_base64(&p->json, key, p->coded, (size_t)(bytes * count));
}

/* ---- the parts of the facts ---- */

static void name_drop(const sf_results *r, char *title, size_t size) {
    if (r->driven)
        snprintf(title, size, "Compression of a foam specimen of %.4g mm", r->thickness * 1e3);
    else
        snprintf(title, size, "Drop of %.4g kg at %.4g m/s on a foam pad of %.4g mm", r->missile_mass,
                 r->missile_speed, r->thickness * 1e3);
}

/* Says why the verdict is not "valid". `line` has SF_VERDICT_LINE_SIZE bytes. */
static const char *find_findings(const sf_verdict *verdict, char *line, size_t size) {
    sf_verdict_line(verdict, line, size);
    const char *findings = strstr(line, ": ");
    return findings ? findings + 2 : "Every check of the run is within its bounds";
}

static void put_texts(page *p) {
    static const char *const kinds[] = {"good", "fair", "bad"}; /* by grade */
    const sf_verdict *verdict = p->summary->verdict;
    char title[160], line[SF_VERDICT_LINE_SIZE], foot[320];
    name_drop(p->results, title, sizeof title);
    snprintf(foot, sizeof foot, "softfall-post %s (%s), from %.160s; drawn by WebGL 2, without a library",
             SF_VERSION, SF_GIT_REVISION, p->summary->results_path);
    SF_JSON_TEXTS(&p->json, {"title", title}, {"verdict", sf_verdict_phrase(verdict->grade)},
                  {"kind", kinds[verdict->grade]}, {"findings", find_findings(verdict, line, sizeof line)},
                  {"foot", foot});
}

static void put_notes(page *p, bool planes_known) {
    const sf_results *r = p->results;
    char few[160], skin[160];
    snprintf(few, sizeof few,
             "%lld of %lld frames are shown, so that the page has at most %.3g MB (softfall-post --view).",
             (long long)p->frame_count, (long long)p->made->frames, p->bytes * 1e-6);
    snprintf(skin, sizeof skin,
             "Of the pad its surface is shown, so that the page has at most %.3g MB: a cut shows no inside.",
             p->bytes * 1e-6);
    const struct {
        bool holds;
        const char *text;
    } notes[] = {{p->frame_count < p->made->frames, few},
                 {!p->inside, skin},
                 {!(p->made->fields & SF_FIELD_DISPLACEMENT),
                  "The frames hold no displacement: the pad is shown undeformed."},
                 {!planes_known,
                  "Only the modelled part is shown: results.h5 does not say where the symmetry planes lie."}};
    SF_JSON_ARRAY(&p->json, "notes");
    for (size_t k = 0; k < sizeof notes / sizeof notes[0]; k++)
        if (notes[k].holds)
            sf_json_text(&p->json, NULL, notes[k].text);
    for (int k = 0; k < r->note_count; k++)
        sf_json_text(&p->json, NULL, r->notes[k]);
}

static void put_scale(page *p) {
    double colours[3 * COLOURS];
    for (int k = 0; k < 3 * COLOURS; k++)
        colours[k] = scale_colours[k / 3][k % 3];
    put_numbers(p, "colours", colours, 3 * COLOURS, 1);
    sf_json_number(&p->json, "decades", DECADES);
    SF_JSON_ARRAY(&p->json, "fields");
    for (int k = 0; k < COLOURINGS; k++) {
        if (!(p->made->fields >> colourings[k].field & 1))
            continue;
        SF_JSON_OBJECT(&p->json, NULL);
        SF_JSON_TEXTS(&p->json, {"name", colourings[k].name}, {"unit", colourings[k].unit});
        sf_json_number(&p->json, "factor", colourings[k].factor);
        sf_json_bool(&p->json, "logarithmic", colourings[k].logarithmic);
    }
}

/* Faces in the numbers of the shown nodes; of the skin alone also its nodes in those of the model. */
static void put_skin(page *p) {
    int32_t *face = (int32_t *)p->skin.face;
    sf_json_bool(&p->json, "wide", p->wide);
    for (int64_t k = 0; p->inside && k < 4 * p->skin.face_count; k++)
        face[k] = face[k] < 0 ? -1 : p->skin.node[face[k]];
    put_indices(p, "skin", face, 4 * p->skin.face_count);
    if (p->inside)
        return;
    for (int64_t i = 0; i < p->node_count; i++)
        encode(&p->coded[4 * i], (uint32_t)p->skin.node[i], 4);
    sf_json_base64(&p->json, "node", p->coded, 4 * (size_t)p->node_count);
}

static void put_cells(page *p) {
    const sf_results *r = p->results;
    if (!p->inside)
        return;
    sf_json_open(&p->json, "cells", '{');
    sf_json_base64(&p->json, "type", r->cell_type, (size_t)r->cell_count);
    put_indices(p, "node", r->cell_node, r->cell_nnz);
    sf_json_close(&p->json);
    SF_JSON_OBJECT(&p->json, "tetrahedra");
    for (int type = SF_CELL_TETRAHEDRON; type <= SF_CELL_HEXAHEDRON; type++) {
        const sf_cell_shape *shape = sf_cell_shape_of(type);
        SF_PRINTED(key, 8, "%d", type);
        SF_JSON_ARRAY(&p->json, key);
        for (int k = 0; k < 4 * shape->tetrahedra; k++)
            sf_json_integer(&p->json, NULL, shape->tetrahedron[k / 4][k % 4]);
    }
}

/* Writes a surface of triangles, and the exact sphere of the missile if it has one; nothing without
 * triangles.
 */
static void put_surface(page *p, const char *key, int64_t nodes, const double *position, int64_t triangles,
                        const int32_t *triangle, double radius) {
    const double *c = p->results->sphere_centre, sphere[4] = {c[0], c[1], c[2], radius};
    if (triangles == 0)
        return;
    SF_JSON_OBJECT(&p->json, key);
    put_quantised(p, "position", position, nodes, 3);
    put_indices(p, "triangle", triangle, 3 * triangles);
    if (radius > 0)
        put_numbers(p, "sphere", sphere, 4, 1);
}

/* The curve that the time runs along, with few enough of its points. */
static void put_curve(page *p) {
    const sf_figures *f = p->summary->figures;
    const sf_history *h = &p->results->history;
    bool force = f->driven || f->filtered.count < 2;
    const double *x = force ? h->time : f->filtered.time, *y = force ? h->contact_force : f->filtered.value;
    int64_t count = force ? h->rows : f->filtered.count, step = count / CURVE_POINTS + 1;
    char label[256];
    if (force)
        snprintf(label, sizeof label, "contact force (N)");
    else
        snprintf(label, sizeof label, "%s (g), CFC %.0f%s", f->acceleration, f->cfc, f->passed);
    SF_JSON_OBJECT(&p->json, "curve");
    sf_json_text(&p->json, "label", label);
    put_numbers(p, "time", x, count, step);
    put_numbers(p, "value", y, count, step);
}

/* ---- frames ---- */

/* Writes the places of the origin and of the unit points of the missile at rest. */
static void put_motion(page *p, const sf_frame_head *head) {
    double place[4][3];
    for (int k = 0; k < 4; k++)
        sf_results_place(p->results, head, (const double[3]){k == 1, k == 2, k == 3}, place[k]);
    put_numbers(p, "missile", place[0], 12, 1);
}

static sf_status put_frame(page *p, const sf_frame_head *head, sf_error *err) {
    const sf_results *r = p->results;
    SF_OWNED_BY(sf_frame_free) sf_frame frame = {0};
    int fields = p->made->fields & SF_FIELD_DISPLACEMENT;
    for (int k = 0; k < COLOURINGS; k++)
        fields |= p->made->fields & 1 << colourings[k].field;
    SF_TRY(sf_frame_read(r, head, fields, &frame, err));
    SF_JSON_OBJECT(&p->json, NULL);
    sf_json_number(&p->json, "time", head->time);
    put_motion(p, head);
    const double *moved = frame.field[SF_FRAME_DISPLACEMENT];
    for (int64_t i = 0; i < 3 * p->node_count; i++) {
        int64_t from = 3 * node_of(p, i / 3) + i % 3;
        p->value[i] = r->position[from] + (moved ? moved[from] : 0);
    }
    put_quantised(p, "position", p->value, p->node_count, 3);
    SF_JSON_ARRAY(&p->json, "fields");
    for (int k = 0; k < COLOURINGS; k++) {
        const double *field = frame.field[colourings[k].field];
        for (int64_t i = 0; field && i < p->node_count; i++)
            p->value[i] = field[node_of(p, i)];
        if (field)
            put_quantised(p, NULL, p->value, p->node_count, 1);
    }
    return SF_OK;
}

static sf_status put_frames(page *p, sf_error *err) {
    int64_t shown_peak = -1;
    sf_json_open(&p->json, "frames", '[');
    for (int64_t k = 0; k < p->frame_count && err->status == SF_OK; k++) {
        bool is_peak;
        put_frame(p, p->shown.head[frame_at(p, k, &is_peak)], err);
        if (is_peak)
            shown_peak = k;
    }
    sf_json_close(&p->json);
    sf_json_integer(&p->json, "peak", shown_peak);
    return err->status;
}

/* ---- the page ---- */

static sf_status write_facts(page *p, sf_error *err) {
    const sf_results *r = p->results;
    double place[2], axis[2];
    bool known = sf_axis_planes(r, place);
    int64_t numbers = 3 * (p->node_count + r->surface_node_count + r->surface_triangle_count +
                           r->support_node_count + r->support_triangle_count) +
                      4 * p->skin.face_count + r->cell_nnz; /* more than the longest array has */
    p->value = sf_alloc(err, 3 * p->node_count, sizeof *p->value, "view.html");
    p->coded = sf_alloc(err, numbers, 4, "view.html");
    SF_TRY(err->status);
    sf_axis_find(r, axis);
    SF_JSON_OBJECT(&p->json, NULL);
    put_texts(p);
    put_notes(p, known);
    put_scale(p);
    put_numbers(p, "planes", place, 2, 1);
    put_numbers(p, "axis", axis, 2, 1);
    put_skin(p);
    put_cells(p);
    put_surface(p, "missile", r->surface_node_count, r->surface_position, r->surface_triangle_count,
                r->surface_triangle, r->sphere_radius);
    put_surface(p, "support", r->support_node_count, r->support_position, r->support_triangle_count,
                r->support_triangle, 0);
    put_curve(p);
    put_frames(p, err);
    return err->status;
}

static sf_status write_page(page *p, const sf_staging *output, const char *text, sf_error *err) {
    const char *mark = strstr(text, FACTS) + strlen(FACTS) - 2;
    if (!(p->json.file = sf_staging_open(output, PAGE, err)))
        return err->status;
    fwrite(text, 1, (size_t)(mark - text), p->json.file);
    write_facts(p, err);
    fputs(mark + 2, p->json.file);
    sf_staging_close(p->json.file, PAGE, err);
    return err->status;
}

sf_status sf_browser_write(const sf_staging *output, const sf_summary *summary, const sf_xdmf *made,
                           double megabytes, char *warning, size_t size, sf_error *err) {
    const sf_results *r = summary->results;
    const sf_cells cells = SF_CELLS_OF(r);
    page p = {.summary = summary, .results = r, .made = made, .bytes = megabytes * 1e6};
    sf_error problem = SF_ERROR_INIT;
    SF_OWNED char *text = NULL;
    *warning = '\0';
    if (made->frames == 0 || megabytes == 0)
        return SF_OK;
    if (sf_template_read(PAGE, FACTS, &text, &problem) != SF_OK)
        snprintf(warning, size, "there is no %s: %s", PAGE, problem.text);
    else if (sf_shown_find(r, &p.shown, err) != SF_OK || sf_skin_faces_find(&cells, &p.skin, err) != SF_OK)
        ; /* err says it */
    else if (!choose(&p))
        snprintf(warning, size,
                 "there is no %s: the %lld nodes of the pad's surface do not fit into %.3g MB (--view MB "
                 "allows more)",
                 PAGE, (long long)p.skin.node_count, megabytes);
    else
        write_page(&p, output, text, err);
    sf_skin_faces_free(&p.skin);
    sf_shown_free(&p.shown);
    SF_FREE(p.value, p.coded);
    return err->status;
}
