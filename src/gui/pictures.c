/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/pictures.h"

#include "gui/gmsh/window.h"
#include "gui/outcome.h"
#include "io/plain_file.h"
#include "model/model_io.h"
#include "post/figures/verdict.h"
#include <math.h>
#include <stdlib.h>

static const char FRAME[] = "1Drop/83frame";

/* Puts the missile above the pad as the case says; softfall-pre does it exactly. */
static void show_missile(sf_pictures *p, const sf_case *c, const sf_pictures_place *place,
                         const sf_triangles *t) {
    double low[3], high[3], shift[3] = {0};
    int64_t n = 3 * t->count;
    const double unit = c->length_unit;
    sf_body body = {.node_count = n, .position = t->corner, .face_count = t->count};
    sf_error none = SF_ERROR_INIT;
    body.face = sf_alloc(&none, 4 * (unsigned long)t->count + 1, sizeof *body.face, "the missile's picture");
    double *move = sf_alloc(&none, 3 * (unsigned long)n + 1, sizeof *move, "the missile's picture");
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
    free(move);
}

void sf_pictures_forget(sf_pictures *p) {
    sf_shape_free(&p->shape);
    p->seen = (sf_watch_stamp){0};
    p->frames = 0;
    p->frame = 0;
    sf_view_remove(SF_PICTURE_PAD);
    sf_view_remove(SF_PICTURE_MISSILE);
    sf_view_remove(SF_PICTURE_CURVE);
    sf_window_remove(FRAME);
    sf_outcome_clear();
}

/* Shows the geometries with the parameters of the tree. gmsh shows one model only: the missile is a picture.
 */
sf_status sf_pictures_show_geometry(sf_pictures *p, const sf_case *c, const sf_pictures_place *place,
                                    sf_fields *fields, sf_error *err) {
    sf_triangles missile = {0};
    sf_pictures_forget(p);
    sf_geometry_clear();
    if (c->missile.path && sf_geometry_read_surface(c->missile.path, &missile, err) != SF_OK)
        return err->status;
    if (sf_geometry_show(c->pad.path, err) == SF_OK) {
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

/* Pad and missile as softfall-pre has made them. */
void sf_pictures_show_model(sf_pictures *p, const char *path, double length_unit) {
    sf_error err = SF_ERROR_INIT;
    sf_model m = {0};
    double *zero = NULL;
    sf_pictures_forget(p);
    if (sf_model_read(path, &m, NULL, &err) == SF_OK &&
        sf_shape_of_model(&m, length_unit, &p->shape, &err) == SF_OK && begin_pictures(p, &err) == SF_OK) {
        int64_t most = p->shape.pad.node_count + p->shape.missile.node_count;
        zero = sf_alloc(&err, 3 * (unsigned long)most, sizeof *zero, "a picture");
    }
    if (zero) {
        sf_view_add(SF_PICTURE_PAD, 0, 0, &p->shape.pad, zero, zero);
        sf_view_add(SF_PICTURE_MISSILE, 0, 0, &p->shape.missile, zero, NULL);
    }
    free(zero);
    sf_model_free(&m);
    sf_shape_free(&p->shape);
}

/* The frame of the largest acceleration. */
static int find_peak(const sf_results *r) {
    int best = 0;
    for (int k = 1; k < r->frame_count; k++)
        if (r->frames[k].acceleration > r->frames[best].acceleration)
            best = k;
    return best;
}

static void add_frames(sf_pictures *p, const sf_results *r, sf_error *err) {
    for (; p->frames < r->frame_count && err->status == SF_OK; p->frames++) {
        const sf_frame_head *head = &r->frames[p->frames];
        sf_shape_frame f;
        if (sf_shape_read_frame(&p->shape, r, head, &f, err) != SF_OK)
            return;
        sf_view_add(SF_PICTURE_PAD, p->frames, 1e3 * head->time, &p->shape.pad, f.pad, f.stress);
        sf_view_add(SF_PICTURE_MISSILE, p->frames, 1e3 * head->time, &p->shape.missile, f.missile, NULL);
        sf_shape_frame_free(&f);
    }
}

/* results.h5 is complete at any instant, but its frames may have moved into a newer one meanwhile: then the
 * next look finds that. */
void sf_pictures_show_results(sf_pictures *p, const char *path, double length_unit, bool whole) {
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    char line[SF_VERDICT_LINE_SIZE] = "";
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
        show_frame(p, whole && err.status == SF_OK ? find_peak(&r) : p->frames - 1);
    sf_outcome_plot(&r);
    if (whole && err.status == SF_OK)
        sf_outcome_show(&r, line, sizeof line, &err);
    if (err.status == SF_OK)
        p->seen = now;
    sf_results_close(&r);
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
