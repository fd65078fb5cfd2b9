/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/session.h"
#include "io/h5_data.h"

#include "io/plain_file.h"
#include "model/model_io.h"
#include "pre/model_report.h"

/* ---- shape of a drop ---- */

static sf_status find_skin(const sf_cells *c, sf_shape *s, sf_error *err) {
    sf_skin_faces skin;
    if (sf_skin_faces_find(c, &skin, err) == SF_OK)
        s->pad.position = sf_alloc(err, 3 * skin.node_count, sizeof(double), "the pad's picture");
    for (int64_t k = 0; k < 3 * skin.node_count && s->pad.position; k++)
        s->pad.position[k] = c->position[3 * (int64_t)skin.node[k / 3] + k % 3] / s->unit;
    s->pad.node_count = skin.node_count;
    s->pad.face_count = skin.face_count;
    s->pad.face = (int32_t *)skin.face;
    s->pad_node = skin.node;
    return err->status;
}

/* The missile's triangles at t = 0, and the exact sphere that contact takes for them. */
typedef struct missile_surface {
    int64_t triangles;
    const double *position;
    const int32_t *triangle;
    double radius; /* m; 0 or NaN: the triangles are the missile */
    const double *centre;
    double plane[2]; /* m, of symmetry, normal to x and y; NaN: none */
    int64_t fixed;   /* triangles of the supports */
    const double *fixed_position;
    const int32_t *fixed_triangle;
} missile_surface;

/* The point `i` and `j` parts of `parts` from the first corner of a triangle to the others, on the sphere if
 * there is one. */
static void place_point(const missile_surface *m, int64_t triangle, int parts, int i, int j, double out[3]) {
    const int share[3] = {parts - i - j, i, j};
    double length = 0;
    for (int d = 0; d < 3; d++) {
        out[d] = 0;
        for (int c = 0; c < 3; c++)
            out[d] += share[c] * m->position[3 * (int64_t)m->triangle[3 * triangle + c] + d] / parts;
        length += m->radius > 0 ? (out[d] - m->centre[d]) * (out[d] - m->centre[d]) : 0;
    }
    for (int d = 0; d < 3 && length > 0; d++)
        out[d] = m->centre[d] + m->radius / sqrt(length) * (out[d] - m->centre[d]);
}

/* Closes the missile in its symmetry planes, by a triangle from each edge there to the middle of its top: the
 * foam behind a plane would be seen through the open half. Returns the number of triangles behind the `count`
 * at `corner`. */
static int64_t close_missile(const missile_surface *m, double *corner, int64_t count) {
    double low[3], high[3], middle[3];
    int64_t made = 0;
    sf_box3(3 * count, corner, low, high);
    for (int d = 0; d < 3; d++)
        middle[d] = d == 2 ? high[d] : isfinite(m->plane[d]) ? m->plane[d] : 0.5 * (low[d] + high[d]);
    for (int64_t k = 0; k < 3 * count; k++)
        for (int d = 0; d < 2; d++) {
            const double *a = &corner[3 * k], *b = &corner[3 * (k % 3 == 2 ? k - 2 : k + 1)];
            const double near = 1e-6 * (high[2] - low[2]);
            if (!(fabs(a[d] - m->plane[d]) < near && fabs(b[d] - m->plane[d]) < near) || made == count)
                continue;
            double *to = &corner[9 * (count + made++)];
            memcpy(to, a, sizeof middle);
            memcpy(to + 3, b, sizeof middle);
            memcpy(to + 6, middle, sizeof middle);
        }
    return made;
}

/* Puts the supports' triangles behind the `count` at `corner`; returns their number. A plane is left out, as
 * the anvil is: its triangles are many times as large as the pad. */
static int64_t add_supports(const missile_surface *m, double largest, double *corner, int64_t count) {
    int64_t made = 0;
    for (int64_t t = 0; t < m->fixed; t++) {
        double *to = &corner[9 * (count + made)];
        for (int k = 0; k < 9; k++)
            to[k] = m->fixed_position[3 * (int64_t)m->fixed_triangle[3 * t + k / 3] + k % 3];
        made += hypot(hypot(to[3] - to[0], to[4] - to[1]), to[5] - to[2]) < largest;
    }
    return made;
}

/* Each triangle of a sphere becomes `parts` x `parts` smaller ones: the foam would be seen through coarse
 * ones. */
static sf_status take_missile(const missile_surface *m, sf_shape *s, sf_error *err) {
    int parts = m->radius > 0 ? 4 : 1;
    int64_t pieces = m->triangles * parts * parts, most = 2 * pieces + m->fixed;
    double low[3], high[3];
    SF_TRY(SF_ALLOC_ALL(err, "the missile's picture", SF_ROOM(s->missile.position, 9 * most),
                        SF_ROOM(s->missile_position, 9 * most), SF_ROOM(s->missile.face, 4 * most)));
    double *to = s->missile_position;
    for (int64_t t = 0; t < m->triangles; t++)
        for (int i = 0; i < parts; i++)
            for (int j = 0; i + j < parts; j++)
                for (int turned = 0; turned < (i + j + 1 < parts ? 2 : 1); turned++, to += 9) {
                    place_point(m, t, parts, i + 1, j, to);
                    place_point(m, t, parts, i + turned, j + 1, to + 3);
                    place_point(m, t, parts, i, j + turned, to + 6);
                }
    pieces += close_missile(m, s->missile_position, pieces);
    s->missile_nodes = 3 * pieces;
    sf_box3(s->pad.node_count, s->pad.position, low, high);
    pieces +=
        add_supports(m, 2 * s->unit * hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]),
                     s->missile_position, pieces);
    s->missile.node_count = 3 * pieces;
    s->missile.face_count = pieces;
    for (int64_t k = 0; k < 9 * pieces; k++)
        s->missile.position[k] = s->missile_position[k] / s->unit;
    for (int64_t k = 0; k < 4 * pieces; k++)
        s->missile.face[k] = k % 4 == 3 ? -1 : (int32_t)(3 * (k / 4) + k % 4);
    return SF_OK;
}

/* The faces that belong to one cell only, in the length unit `unit`. Release with sf_shape_free. */
static sf_status make_shape(const sf_cells *cells, const missile_surface *missile, double unit, sf_shape *s,
                            sf_error *err) {
    *s = (sf_shape){.unit = unit};
    if (find_skin(cells, s, err) != SF_OK || take_missile(missile, s, err) != SF_OK)
        sf_shape_free(s);
    return err->status;
}

static sf_status shape_of_model(const sf_model *m, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = SF_CELLS_OF(m);
    double place;
    missile_surface missile = {
        m->surface_triangle_count, m->surface_position,
        m->surface_triangle,       m->missile.shape == SF_SHAPE_SPHERE ? m->missile.sphere_radius : 0,
        m->missile.sphere_centre,  {NAN, NAN},
        m->support_triangle_count, m->support_position,
        m->support_triangle};
    for (int d = 0; d < 2; d++)
        if (sf_symmetry_plane(m, d, &place))
            missile.plane[d] = place;
    return make_shape(&cells, &missile, unit, s, err);
}

sf_status sf_shape_of_results(const sf_results *r, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = SF_CELLS_OF(r);
    const missile_surface missile = {
        r->surface_triangle_count, r->surface_position, r->surface_triangle,
        r->sphere_radius,          r->sphere_centre,    {r->symmetry_place[0], r->symmetry_place[1]},
        r->support_triangle_count, r->support_position, r->support_triangle};
    return make_shape(&cells, &missile, unit, s, err);
}

void sf_shape_free(sf_shape *s) {
    SF_CLEAR(s, s->pad.position, s->pad.face, s->pad_node, s->missile.position, s->missile.face,
             s->missile_position);
}

static void gather(const sf_shape *s, const sf_frame *fields, sf_shape_frame *out) {
    const double *u = fields->field[SF_FRAME_DISPLACEMENT], *mises = fields->field[SF_FRAME_VON_MISES];
    for (int64_t k = 0; k < s->pad.node_count; k++) {
        for (int d = 0; d < 3 && u; d++)
            out->pad[3 * k + d] = u[3 * (int64_t)s->pad_node[k] + d] / s->unit;
        if (mises)
            out->stress[k] = 1e-3 * mises[s->pad_node[k]];
    }
}

static void free_shape_frame(sf_shape_frame *f) {
    SF_CLEAR(f, f->pad, f->stress, f->missile);
}

static sf_status read_shape_frame(const sf_shape *s, const sf_results *r, const sf_frame_head *head,
                                  sf_shape_frame *out, sf_error *err) {
    SF_OWNED_BY(sf_frame_free) sf_frame fields = {{0}};
    *out = (sf_shape_frame){0};
    SF_TRY(sf_frame_read(r, head, SF_FIELD_DISPLACEMENT | SF_FIELD_VON_MISES, &fields, err));
    SF_ALLOC_ALL(err, "a frame", SF_ROOM(out->pad, 3 * s->pad.node_count),
                 SF_ROOM(out->missile, 3 * s->missile.node_count));
    if (fields.field[SF_FRAME_VON_MISES])
        out->stress = sf_alloc(err, s->pad.node_count, sizeof(double), "a frame");
    if (err->status == SF_OK)
        gather(s, &fields, out);
    for (int64_t k = 0; k < s->missile_nodes && err->status == SF_OK; k++) {
        double place[3];
        sf_results_place(r, head, &s->missile_position[3 * k], place);
        for (int d = 0; d < 3; d++)
            out->missile[3 * k + d] = (place[d] - s->missile_position[3 * k + d]) / s->unit;
    }
    if (err->status != SF_OK)
        free_shape_frame(out);
    return err->status;
}

/* ---- figures and checks in the tree ---- */

/* Keys of the report of softfall-pre (pre/model_report.c) that the tree shows, in its order. */
static const char *const keys[SF_CHECK_ENTRIES] = {
    "nodes",      "cells",      "missile", "drop_height", "impact_point", "spacing_under_missile",
    "mesh_error", "first_step", "memory",  "run_time",
};

sf_status sf_checks_read(const char *model, sf_check_entries *out, sf_error *err) {
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    SF_OWNED char *text = NULL;
    out->count = 0;
    if (sf_h5_open(model, &file, err) == SF_OK)
        sf_h5_read_text(file, "/provenance/report", &text, err);
    for (int k = 0; text && k < SF_CHECK_ENTRIES; k++) {
        sf_check_entry *e = &out->entry[out->count];
        char name[SF_CHECK_NAME - 16];
        if (!sf_model_report_find(text, keys[k], name, sizeof name, e->value, sizeof e->value))
            continue; /* a prescribed motion has no drop height */
        snprintf(e->name, sizeof e->name, "3Checks/%02d%s", k, name);
        out->count++;
    }
    return err->status;
}

void sf_checks_show(const sf_check_entries *checks) {
    for (int k = 0; k < checks->count; k++) {
        const sf_check_entry *e = &checks->entry[k];
        sf_window_put(
            &(sf_entry){.name = e->name, .kind = SF_ENTRY_SHOWN, .text = e->value, .help = e->value});
    }
}

void sf_checks_clear(const sf_check_entries *checks) {
    for (int k = 0; k < checks->count; k++)
        sf_window_remove(checks->entry[k].name);
}

/* Returns the last line that begins with `prefix`, or NULL. */
static const char *last_line(const char *text, const char *prefix) {
    const char *last = NULL;
    for (const char *line = text; *line; line = strchrnul(line, '\n'), line += *line == '\n')
        last = strncmp(line, prefix, strlen(prefix)) == 0 ? line : last;
    return last;
}

void sf_checks_sentence(const char *text, char *out, size_t size) {
    const char *last = last_line(text, "softfall-");
    *out = '\0';
    const char *colon = last ? strstr(last, ": ") : NULL;
    if (colon)
        snprintf(out, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
}

void sf_checks_progress(const char *text, char *out, size_t size) {
    size_t used = 0;
    for (const char *last = last_line(text, "t "); last && *last && *last != '\n' && used + 1 < size; last++)
        if (*last != ' ' || (used > 0 && out[used - 1] != ' '))
            out[used++] = *last;
    out[used] = '\0';
}

static const char GOOD[] = "LightGreen", FAIR[] = "Khaki", BAD[] = "LightCoral";

/* Below the buttons, at all times: a tree that grows would move what the user is about to click. */
static const char *const names[] = {"1Drop/70verdict",
                                    "1Drop/71a_max",
                                    "1Drop/72HIC",
                                    "1Drop/73rebound",
                                    "1Drop/74largest indentation",
                                    "1Drop/75largest local strain"};
enum { VERDICT, A_MAX, HIC, REBOUND, INDENTATION, STRAIN, ENTRIES };
enum { FILTER = 1000 }; /* CFC of curve and figures */

/* `text` fits into the row; `help` has the rest. */
static void put(int which, const char *text, const char *help, const char *colour) {
    sf_window_put(&(sf_entry){
        .name = names[which], .kind = SF_ENTRY_SHOWN, .text = text, .help = help, .colour = colour});
}

/* Puts a dash into each row. */
static void clear_outcome(void) {
    for (int k = 0; k < ENTRIES; k++)
        put(k, "–", "not known yet", NULL);
}

static const char *limit_colour(const sf_limit *limit) {
    return !limit->judged ? NULL : limit->passed ? GOOD : BAD;
}

/* The digits are those that summary.json has, and more than a reader needs. */
static void show_limits(const sf_figures *f, const sf_verdict *v) {
    if (v->limit_count < SF_LIMITS)
        return;
    SF_PRINTED(text, 80, "%.9g g (limit %g g)", f->injury.a_max_g, v->limits[0].bound);
    put(A_MAX, text, sf_limit_phrase(&v->limits[0]), limit_colour(&v->limits[0]));
    snprintf(text, sizeof text, "%.9g (limit %g)", f->injury.hic.value, v->limits[1].bound);
    SF_PRINTED(help, 200, "%s; window %.2f to %.2f ms", sf_limit_phrase(&v->limits[1]),
               1e3 * f->injury.hic.t1, 1e3 * f->injury.hic.t2);
    put(HIC, text, help, limit_colour(&v->limits[1]));
}

static void show_motion(const sf_figures *f) {
    char text[80];
    if (f->rebounded)
        snprintf(text, sizeof text, "%.4g m/s at %.2f ms", f->v_rebound, 1e3 * f->rebound_time);
    else
        snprintf(text, sizeof text, "not reached");
    if (!f->driven)
        put(REBOUND, text, text, NULL);
    snprintf(text, sizeof text, "%.4g mm", 1e3 * f->max_indentation);
    put(INDENTATION, text, text, NULL);
    snprintf(text, sizeof text, "%.4g", f->max_local_strain);
    put(STRAIN, text, text, NULL);
}

/* Puts them into the rows below the buttons, coloured by pass and fail. A run that has not ended or never
 * touched has what is known. */
static sf_status show_outcome(const sf_results *r, sf_error *err) {
    char line[SF_VERDICT_LINE_SIZE];
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    sf_verdict verdict;
    const sf_limits limits = SF_DEFAULT_LIMITS;
    clear_outcome();
    SF_TRY(sf_figures_compute(r, FILTER, &f, err));
    sf_verdict_compute(r, &f, &limits, &verdict);
    sf_verdict_line(&verdict, line, sizeof line);
    put(VERDICT, sf_verdict_phrase(verdict.grade), line,
        verdict.grade == SF_GRADE_VALID     ? GOOD
        : verdict.grade == SF_GRADE_REMARKS ? FAIR
                                            : BAD);
    if (f.touched) {
        show_limits(&f, &verdict);
        show_motion(&f);
    }
    return err->status;
}

static void plot(const char *title, int64_t count, const double *time, const double *value, double scale) {
    SF_OWNED double *x = malloc(2 * (size_t)count * sizeof *x + 1);
    double *y = x ? x + count : NULL;
    for (int64_t k = 0; x && k < count; k++) {
        x[k] = 1e3 * time[k];
        y[k] = value[k] / scale;
    }
    if (x)
        sf_view_plot(title, "t [ms]", count, x, y);
}

/* The curve of the figures so far, filtered as they are; the raw one, and its title says so, of a run that
 * has no figures yet. */
static void plot_outcome(const sf_results *r) {
    const sf_history *h = &r->history;
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    char title[64];
    if (sf_figures_compute(r, FILTER, &f, SF_IGNORED) == SF_OK) {
        snprintf(title, sizeof title, "%s%sacceleration, CFC %d [g]", f.turns ? "resultant " : "",
                 f.kinematic ? "kinematic " : "", FILTER);
        plot(title, f.filtered.count, f.filtered.time, f.filtered.value, 1);
    } else {
        plot("raw, along the direction [g]", h->rows, h->time, h->acceleration, SF_STANDARD_GRAVITY);
    }
}

/* ---- frames ---- */

static const char FRAME[] = "1Drop/83frame";

/* Puts the missile above the pad as the case says; softfall-pre does it exactly. */
static void show_missile(sf_pictures *p, const sf_case *c, const sf_pictures_place *place,
                         const sf_triangles *t) {
    double low[3], high[3], shift[3] = {0};
    int64_t n = 3 * t->count;
    const double unit = c->length_unit;
    sf_body body = {.node_count = n, .position = t->corner, .face_count = t->count};
    sf_error none = SF_ERROR_INIT;
    body.face = sf_alloc(&none, 4 * t->count + 1, sizeof *body.face, "the missile's picture");
    SF_OWNED double *move = sf_alloc(&none, 3 * n + 1, sizeof *move, "the missile's picture");
    sf_geometry_box(low, high);
    shift[2] = high[2] - t->low[2] + place->gap / unit;
    for (int d = 0; d < 2 && place->given; d++)
        shift[d] = place->position[d] / unit;
    for (int64_t k = 0; k < 3 * n && none.status == SF_OK; k++)
        t->corner[k] += shift[k % 3];
    if (!p->fitted)
        sf_window_fit(low, high, fmin(low[0], t->low[0] + shift[0]), fmax(high[0], t->high[0] + shift[0]),
                      t->high[2] + shift[2]);
    p->fitted = true; /* from now on the user's */
    for (int64_t k = 0; k < 4 * t->count && none.status == SF_OK; k++)
        body.face[k] = k % 4 == 3 ? -1 : (int32_t)(3 * (k / 4) + k % 4);
    if (none.status == SF_OK && sf_view_begin(SF_PICTURE_MISSILE, "missile", &body, &none) == SF_OK)
        sf_view_add(SF_PICTURE_MISSILE, 0, 0, &body, move, NULL);
    free(body.face);
}

/* Removes the results from the window, and releases their shape. */
static void forget(sf_pictures *p) {
    sf_shape_free(&p->shape);
    p->seen = (sf_watch_stamp){0};
    p->frames = 0;
    p->frame = 0;
    sf_view_remove(SF_PICTURE_PAD);
    sf_view_remove(SF_PICTURE_MISSILE);
    sf_view_remove(SF_PICTURE_CURVE);
    sf_window_remove(FRAME);
    clear_outcome();
}

sf_status sf_pictures_show_geometry(sf_pictures *p, const sf_case *c, const sf_pictures_place *place,
                                    sf_fields *fields, sf_error *err) {
    sf_triangles missile = {0};
    forget(p);
    sf_geometry_clear();
    if (c->missile.path && sf_geometry_read_surface(c->missile.path, &missile, err) != SF_OK)
        return err->status;
    if (sf_geometry_show(c->pad.path, p->opened, err) == SF_OK) {
        sf_fields_take_defaults(fields);
        sf_fields_lock_unknown(fields);
        if (missile.count > 0)
            show_missile(p, c, place, &missile);
    }
    free(missile.corner);
    return err->status;
}

static void show_frame(sf_pictures *p, int frame) {
    p->frame = frame;
    sf_window_put(&(sf_entry){.name = FRAME,
                              .kind = SF_ENTRY_NUMBER,
                              .number = p->frame,
                              .low = 0,
                              .high = p->frames - 1,
                              .step = 1,
                              .help = "the frame that is shown; drag it, or play it with the buttons below"});
    sf_view_show_frame(p->frame);
}

/* Begins the pictures of a model in place of those before. */
static sf_status begin_pictures(sf_pictures *p, sf_error *err) {
    if (sf_view_begin(SF_PICTURE_PAD, "pad, von Mises stress [kPa]", &p->shape.pad, err) == SF_OK)
        sf_view_begin(SF_PICTURE_MISSILE, "missile", &p->shape.missile, err);
    p->frames = 0;
    return err->status;
}

void sf_pictures_show_model(sf_pictures *p, const char *path, double length_unit) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_model_free) sf_model m = {0};
    SF_OWNED double *zero = NULL;
    forget(p);
    if (sf_model_read(path, &m, NULL, &err) == SF_OK &&
        shape_of_model(&m, length_unit, &p->shape, &err) == SF_OK && begin_pictures(p, &err) == SF_OK) {
        int64_t most = p->shape.pad.node_count + p->shape.missile.node_count;
        zero = sf_alloc(&err, 3 * most, sizeof *zero, "a picture");
    }
    if (zero) {
        sf_view_add(SF_PICTURE_PAD, 0, 0, &p->shape.pad, zero, zero);
        sf_view_add(SF_PICTURE_MISSILE, 0, 0, &p->shape.missile, zero, NULL);
    }
    sf_shape_free(&p->shape);
}

static void add_frames(sf_pictures *p, const sf_results *r, sf_error *err) {
    for (; p->frames < r->frame_count && err->status == SF_OK; p->frames++) {
        const sf_frame_head *head = &r->frames[p->frames];
        sf_shape_frame f;
        if (read_shape_frame(&p->shape, r, head, &f, err) != SF_OK)
            return;
        sf_view_add(SF_PICTURE_PAD, p->frames, 1e3 * head->time, &p->shape.pad, f.pad, f.stress);
        sf_view_add(SF_PICTURE_MISSILE, p->frames, 1e3 * head->time, &p->shape.missile, f.missile, NULL);
        free_shape_frame(&f);
    }
}

/* results.h5 is complete at any instant, but its frames may have moved into a newer one meanwhile: then the
 * next look finds that. */
void sf_pictures_show_results(sf_pictures *p, const char *path, double length_unit, bool whole) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    sf_watch_stamp now = sf_watch_stamp_of(path);
    if (now.inode == 0 || (!whole && sf_watch_same(&now, &p->seen)))
        return;
    sf_plain_clear();
    if (sf_results_open(path, &r, &err) != SF_OK)
        return;
    if (p->shape.pad.node_count == 0 || p->frames > r.frame_count) {
        sf_shape_free(&p->shape);
        if (sf_shape_of_results(&r, length_unit, &p->shape, &err) == SF_OK)
            begin_pictures(p, &err);
    }
    add_frames(p, &r, &err);
    if (p->frames > 0)
        show_frame(p, whole && err.status == SF_OK ? (int)(sf_frame_of_peak(&r) - r.frames) : p->frames - 1);
    plot_outcome(&r);
    if (whole && err.status == SF_OK)
        show_outcome(&r, &err);
    if (err.status == SF_OK)
        p->seen = now;
    sf_window_refresh();
}

void sf_pictures_take_frame(sf_pictures *p) {
    double frame;
    if (p->frames == 0 || !sf_window_number(FRAME, &frame) || (int)lround(frame) == p->frame)
        return;
    p->frame = (int)lround(frame);
    sf_view_show_frame(p->frame);
    sf_window_refresh();
}
