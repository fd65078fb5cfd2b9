/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/sharp.h"

#include "solver/contact/listing.h"
#include "solver/contact/solve.h"

static const double BEYOND = 0.03;   /* of a face or an edge: it goes on so far beyond its end */
static const double CROSSING = 0.02; /* least sine of the angle between two edges */
static const double SLOPE = 0.1;     /* largest sine by which the faces at a line rise beside it */
static const double TILT = 0.3;      /* largest sine by which the body may lean beyond the normal */
static const char purpose[] = "sharp edges in contact";

/* ---- constants ---- */

static sf_status mark_planes(const sf_skin *skin, sf_sharp *e, sf_error *err) {
    e->corner_plane = sf_alloc(err, e->ridges.corner_count, 1, purpose);
    for (int64_t k = 0; e->corner_plane && k < e->ridges.corner_count; k++)
        e->corner_plane[k] = (uint8_t)sf_skin_planes_at(skin, &e->position[3 * (int64_t)e->ridges.corner[k]]);
    return err->status;
}

/* Keeps the edges that go through y = 0 beside the axis: the corners of a section. */
static void keep_section(const double *position, sf_ridges *ridges) {
    int64_t kept = 0;
    for (int64_t k = 0; k < ridges->count; k++) {
        const double *a = &position[3 * (int64_t)ridges->ridge[k].node[0]],
                     *b = &position[3 * (int64_t)ridges->ridge[k].node[1]];
        if (a[1] * b[1] < 0 && a[0] + b[0] > 0)
            ridges->ridge[kept++] = ridges->ridge[k];
    }
    ridges->count = kept;
    ridges->corner_count = 0;
}

/* Lets no copy of a corner's node be pressed by faces: the corner's pair does that. */
static void leave_corners(const sf_sharp *e, const sf_skin *skin) {
    for (int64_t k = 0; k < e->ridges.corner_count && skin->moving < skin->nodes; k++) {
        const double *corner = &skin->rest[3 * (skin->moving + e->ridges.corner[k])];
        for (int64_t p = skin->moving; p < skin->nodes; p++)
            if (sf_distance3(&skin->rest[3 * p], corner) == 0)
                skin->passive[p] = 1;
    }
}

sf_status sf_sharp_build(const sf_model *m, const sf_shape_triangles *of, const sf_skin *skin, sf_sharp *e,
                         sf_error *err) {
    const sf_ridge_limits limits = {.place = {skin->plane[0], skin->plane[1]},
                                    .spacing = skin->spacing,
                                    .depth = m->axisymmetric ? SF_SECTION_DEPTH : SF_SMOOTH_DEPTH};
    *e = (sf_sharp){.position = of->position};
    if (skin->faces == 0 || of->count == 0)
        return SF_OK;
    sf_ridges_find(of->node_count, of->position, of->count, of->triangle, &limits, &e->ridges, err);
    if (err->status == SF_OK && m->axisymmetric)
        keep_section(e->position, &e->ridges);
    else if (err->status == SF_OK)
        mark_planes(skin, e, err);
    e->is_there = e->ridges.corner_count + (m->axisymmetric ? e->ridges.count : 0) > 0;
    if (err->status != SF_OK || !e->is_there)
        sf_sharp_free(e);
    leave_corners(e, skin);
    return err->status;
}

void sf_sharp_free(sf_sharp *e) {
    sf_ridges_free(&e->ridges);
    free(e->corner_plane);
    *e = (sf_sharp){0};
}

/* Place (m) now of a node of the body. */
static void place_node(const sf_scene *c, int32_t node, double out[3]) {
    const double *rest = &c->sharp->position[3 * (int64_t)node];
    if (c->response)
        sf_missile_place(c->model, &c->state->missile, rest, out);
    else
        memcpy(out, rest, 3 * sizeof *out);
}

/* ---- candidates ---- */

/* Distance (m) of two segments (Ericson 2005, section 5.1.9). */
static double segment_distance(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double u[3], v[3], w[3];
    sf_sub3(b, a, u);
    sf_sub3(d, c, v);
    sf_sub3(a, c, w);
    double uu = sf_dot3(u, u), vv = sf_dot3(v, v), uv = sf_dot3(u, v), uw = sf_dot3(u, w), vw = sf_dot3(v, w);
    double square = uu * vv - uv * uv;
    double at = square > 1e-12 * uu * vv ? fmin(1, fmax(0, (uv * vw - uw * vv) / square)) : 0;
    double there = (uv * at + vw) / vv;
    if (there < 0 || there > 1) {
        there = there < 0 ? 0 : 1;
        at = fmin(1, fmax(0, (uv * there - uw) / uu));
    }
    for (int r = 0; r < 3; r++)
        w[r] += at * u[r] - there * v[r];
    return sqrt(sf_dot3(w, w));
}

/* The list in the making. */
typedef struct sharp_list {
    double reach; /* m */
    int64_t count, room;
    sf_sharp_candidate *list;
} sharp_list;

/* Adds a candidate; counts on where there is no room. */
static void add(sharp_list *out, int64_t part, int64_t slot) {
    if (out->count < out->room)
        out->list[out->count] = (sf_sharp_candidate){(int32_t)part, (int32_t)slot};
    out->count++;
}

static void list_corner(const sf_scene *c, int64_t corner, const sf_listing *l, sharp_list *out) {
    double x[3];
    place_node(c, c->sharp->ridges.corner[corner], x);
    int64_t found = sf_grid_query(&l->pad, x, out->reach, c->skin->faces, l->found);
    for (int64_t k = 0; k < found; k++)
        if (sf_listing_distance(c, x, l->found[k]) < out->reach)
            add(out, corner, 3 * (int64_t)l->found[k]);
}

static void list_ridge(const sf_scene *c, int64_t ridge, const sf_listing *l, sharp_list *out) {
    const sf_skin *skin = c->skin;
    const double *y = c->at->position;
    double x[2][3], middle[3];
    for (int k = 0; k < 2; k++)
        place_node(c, c->sharp->ridges.ridge[ridge].node[k], x[k]);
    for (int r = 0; r < 3; r++)
        middle[r] = 0.5 * (x[0][r] + x[1][r]);
    int64_t found =
        sf_grid_query(&l->pad, middle, out->reach + sf_distance3(x[0], middle), skin->faces, l->found);
    for (int64_t k = 0; k < 3 * found; k++) {
        int64_t slot = 3 * (int64_t)l->found[k / 3] + k % 3, line = skin->line_of[slot];
        if (line >= 0 && segment_distance(x[0], x[1], &y[3 * (int64_t)skin->line[4 * line]],
                                          &y[3 * (int64_t)skin->line[4 * line + 1]]) < out->reach)
            add(out, c->sharp->ridges.corner_count + ridge, slot);
    }
}

/* Lists what sharp edges may meet within the room of the lists, which becomes less if there is no memory, and
 * marks the points that take part. */
static sf_status list(const sf_scene *c, sf_listing *l, sf_error *err) {
    enum { HALVINGS = 6 };
    if (!c->sharp->is_there)
        return SF_OK;
    SF_TRY(sf_listing_facets(c, l, err));
    const sf_ridges *ridges = &c->sharp->ridges;
    const sf_skin *skin = c->skin;
    sharp_list out = {.reach = 2 * l->reach,
                      .room = 64 * (ridges->corner_count + ridges->count) + 8 * skin->line_count};
    out.list = sf_workspace_take(&c->at->work.list, out.room, sizeof *out.list, purpose, err);
    SF_TRY(err->status);
    for (int of = 0; of == 0 || out.count > out.room; of++) {
        if (of > HALVINGS)
            return SF_FAIL(
                err, SF_ERR_NUMERIC,
                "sharp edges of a rigid body and faces of the pad are within %.3g mm of each other "
                "at %lld places, more than %lld: mesh the body coarser",
                1e3 * out.reach, (long long)out.count, (long long)out.room);
        out.reach *= 0.5;
        out.count = 0;
        for (int64_t k = 0; k < ridges->corner_count; k++)
            list_corner(c, k, l, &out);
        for (int64_t k = 0; k < ridges->count; k++)
            list_ridge(c, k, l, &out);
    }
    c->at->sharp.count = out.count;
    c->at->room = fmin(c->at->room, out.reach);
    for (int64_t k = 0; k < out.count; k++) {
        bool corner = out.list[k].part < ridges->corner_count; /* of a line the third points, too */
        const int32_t *point = corner ? &skin->facet[out.list[k].slot]
                                      : &skin->line[4 * (int64_t)skin->line_of[out.list[k].slot]];
        for (int a = 0; a < (corner ? 3 : 4); a++)
            if (point[a] >= 0)
                l->used[point[a]] = 1;
    }
    return SF_OK;
}

/* ---- pairs ---- */

static void body_arm(const sf_scene *c, const double rest[3], double out[3]) {
    if (c->response)
        sf_missile_orient(c->model, &c->state->missile, rest, out);
    else
        memcpy(out, rest, 3 * sizeof *out);
}

/* Makes the parts of the pair these points with these weights. */
static void take_parts(const sf_scene *c, int count, const int32_t *point, const double *weight,
                       sf_contact_pair *q) {
    q->parts = count;
    for (int k = 0; k < count; k++) {
        q->part[k] = point[k];
        q->share[k] = weight[k];
    }
    sf_pair_relative(q, c->at->position, q->place);
    sf_pair_relative(q, c->at->step, q->step);
}

/* The pair of a corner and a face, along the face's normal, without the part that a symmetry plane takes. */
static bool meet_face(const sf_scene *c, const sf_sharp_candidate *candidate, sf_contact_pair *q) {
    const sf_ridges *ridges = &c->sharp->ridges;
    const int32_t *corners = &c->skin->facet[candidate->slot];
    const double *x[3];
    double tip[3], own[3], n[3], arm[3], point[3], weight[3];
    sf_corners(c->at->position, corners, x);
    place_node(c, ridges->corner[candidate->part], tip);
    sf_triangle_normal(x[0], x[1], x[2], own);
    double area = sqrt(sf_dot3(own, own));
    for (int r = 0; r < 3; r++)
        n[r] = c->sharp->corner_plane[candidate->part] >> r & 1 ? 0 : own[r];
    sf_unit3(n);
    double across = sf_dot3(n, own);
    if (!(area > 0) || !(across > 0.5 * area))
        return false;
    sf_sub3(tip, x[0], arm);
    q->gap = sf_dot3(arm, own) / across;
    for (int r = 0; r < 3; r++) {
        point[r] = tip[r] - q->gap * n[r];
        q->normal[r] = -n[r];
    }
    sf_triangle_weights(x, point, own, weight);
    if (weight[0] < -BEYOND || weight[1] < -BEYOND || weight[2] < -BEYOND)
        return false;
    for (int64_t k = ridges->ptr[candidate->part]; k < ridges->ptr[candidate->part + 1]; k++) {
        body_arm(c, &ridges->arm[3 * k], arm);
        if (sf_dot3(arm, n) < -TILT)
            return false;
    }
    take_parts(c, 3, corners, weight, q);
    return true;
}

/* The pair of a line of the pad, or of a section's side, and a sharp edge that cross, along the normal of
 * both. The faces at the line may rise a little, as they may fall away in the next step. */
static bool meet_ridge(const sf_scene *c, const sf_sharp_candidate *candidate, sf_contact_pair *q) {
    const int32_t *line = &c->skin->line[4 * (int64_t)c->skin->line_of[candidate->slot]];
    const sf_ridge *ridge = &c->sharp->ridges.ridge[candidate->part - c->sharp->ridges.corner_count];
    const double *position = c->at->position, *from = &position[3 * (int64_t)line[0]],
                 *to = &position[3 * (int64_t)line[1]];
    bool section = line[2] == SF_NO_FACES;
    double a[3], b[3], u[3], v[3], n[3], between[3], place[2], own[3], arm[3];
    place_node(c, ridge->node[0], a);
    place_node(c, ridge->node[1], b);
    sf_sub3(b, a, u);
    sf_sub3(to, from, v);
    sf_sub3(from, a, between);
    if (!sf_pair_cross(u, v, between, CROSSING, n, place) || fabs(place[0] - 0.5) > 0.5 + BEYOND ||
        fabs(place[1] - 0.5) > 0.5 + BEYOND)
        return false;
    double apart = sf_dot3(between, n);
    if (line[3] < 0 &&
        !section) { /* the edge goes on as its mirror image: the plane takes what is across it */
        memcpy(own, n, sizeof own);
        n[-1 - line[3]] = 0;
        sf_unit3(n);
        if (!(sf_dot3(own, n) > 0.5))
            return false;
        apart /= sf_dot3(own, n);
    }
    if (section)
        memcpy(own, (const double[3]){v[2], 0, -v[0]}, sizeof own);
    else
        sf_face_normal(position, line, own);
    double side = sf_dot3(own, n) < 0 ? -1 : 1; /* n looks out of the pad */
    for (int k = 0; k < 2; k++) {
        body_arm(c, ridge->arm[k], arm);
        if (side * sf_dot3(arm, n) < -TILT)
            return false;
        if (section)
            continue;
        sf_skin_third(position, line, 2 + k, arm);
        if (!(side * sf_dot3(arm, n) < SLOPE * sqrt(sf_dot3(arm, arm))))
            return false;
    }
    q->gap = -side * apart;
    for (int r = 0; r < 3; r++)
        q->normal[r] = -side * n[r];
    take_parts(c, 2, line, (const double[2]){1 - place[1], place[1]}, q);
    return true;
}

/* True if the pair of a candidate closes in the next step; `on`: it had a force in the last one. */
static bool closes(const sf_scene *c, const sf_sharp_candidate *candidate, bool on, sf_contact_pair *q) {
    const sf_ridges *ridges = &c->sharp->ridges;
    bool corner = candidate->part < ridges->corner_count;
    double away[3] = {0};
    *q = (sf_contact_pair){.force = q->force,
                           .node = -1,
                           .facet = SF_NO_PARTNER,
                           .missile = c->response,
                           .body = SF_BODY_MISSILE};
    if (!(corner ? meet_face : meet_ridge)(c, candidate, q))
        return false;
    q->depth = -q->gap;
    if (q->depth > sf_shape_limit(&sf_shape_sharp, on, c->skin->spacing))
        return false;
    if (c->response)
        sf_missile_free_motion(c->response, q->place, away);
    else
        q->body =
            SF_BODY_SUPPORT +
            c->model->support_part[corner ? ridges->facet[candidate->part]
                                          : ridges->ridge[candidate->part - ridges->corner_count].facet];
    sf_sub3(q->step, away, q->step);
    q->friction = sf_pair_friction(c, q);
    c->at->depth = fmax(c->at->depth, q->depth);
    return sf_pair_closes(q, sf_shape_sharp.back * c->state->dt);
}

static int64_t most(const sf_scene *c) {
    const sf_sharp *e = c->sharp;
    return e->is_there ? e->ridges.corner_count + c->skin->line_count + SF_SHARP_MORE : 0;
}

static sf_status add_pairs(const sf_scene *c, sf_contact_system *w, sf_error *err) {
    sf_sharp_state *s = &c->at->sharp;
    int64_t room = most(c), last = 0, count = 0;
    int32_t(*key)[2] = sf_workspace_take(&c->at->work.old_key, room, sizeof *key, purpose, err);
    double(*old)[3] = sf_workspace_take(&c->at->work.old_force, room, sizeof *old, purpose, err);
    const sf_sharp_candidate *near = c->at->work.list.data;
    SF_TRY(err->status);
    memcpy(key, s->key, (size_t)room * sizeof *key);
    memcpy(old, s->force, (size_t)room * sizeof *old);
    for (int64_t k = 0; k < s->count; k++) {
        static const double none[3] = {0};
        int32_t own[2] = {near[k].part, near[k].slot + 1};
        while (last < room && key[last][1] > 0 && /* both lists have the same order */
               (key[last][0] < own[0] || (key[last][0] == own[0] && key[last][1] < own[1])))
            last++;
        bool on = last < room && key[last][0] == own[0] && key[last][1] == own[1];
        sf_contact_pair *q = &w->pair[w->count];
        if (count == room)
            return SF_FAIL(err, SF_ERR_NUMERIC,
                           "more than %lld pairs of sharp edges touch: round the edges of the missile or "
                           "support, or take a finer mesh",
                           (long long)room);
        q->force = &s->force[3 * count];
        if (!closes(c, &near[k], on, q))
            continue;
        sf_pair_warm(q, on ? old[last] : none);
        memcpy(&s->key[2 * count++], own, sizeof own);
        sf_contact_add(w);
        w->is_dependent = true;
    }
    for (int64_t k = count; k < room && s->key[2 * k + 1] > 0; k++)
        s->key[2 * k + 1] = 0;
    return SF_OK;
}

/* A deeper pair that is new is on the far side of a thin part. */
const sf_shape sf_shape_sharp = {
    .list = list, .add = add_pairs, .most = most, .entry = 0.1, .deepest = 0.5, .back = 0.5};
