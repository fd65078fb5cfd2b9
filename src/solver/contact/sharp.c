/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/sharp.h"

#include "base/grid.h"
#include "base/mat3.h"
#include "base/sets.h"

static const double ENTRY = 0.1; /* of the spacing: a deeper pair that is new is on the far side of a part */
static const double DEEPEST = 0.5;   /* of the spacing: no deeper does a pair go on */
static const double RETURN = 0.5;    /* m s-1: no faster is a depth taken back */
static const double BEYOND = 0.03;   /* of a face or an edge: it goes on so far beyond its end */
static const double CROSSING = 0.02; /* least sine of the angle between two edges */
static const double SLOPE = 0.1;     /* largest sine by which the faces at a line rise beside it */
static const double TILT = 0.3;      /* largest sine by which the body may lean beyond the normal */

/* ---- constants ---- */

/* The symmetry planes, NAN where there is none, and the places at rest of the pad's points. */
typedef struct rest_state {
    double plane[2], near;  /* m */
    const double *position; /* [..][3] m */
    const int32_t *point;   /* of each point of the pad in it; NULL: itself */
} rest_state;

/* 1 or 2 if both points lie in the symmetry plane normal to x or y, 0 if not. */
static int plane_of(const rest_state *rest, int32_t a, int32_t b) {
    const double *one = &rest->position[3 * (int64_t)(rest->point ? rest->point[a] : a)],
                 *other = &rest->position[3 * (int64_t)(rest->point ? rest->point[b] : b)];
    for (int r = 0; r < 2; r++)
        if (fabs(one[r] - rest->plane[r]) < rest->near && fabs(other[r] - rest->plane[r]) < rest->near)
            return r + 1;
    return 0;
}

/* Lists the edges of two faces; in a symmetry plane the second one is the mirror image of the first. */
static sf_status list_lines(const rest_state *rest, sf_sharp *e, sf_error *err) {
    SF_OWNED sf_half_edge *half = sf_half_edges(e->face_count, e->face, err);
    SF_TRY(SF_ALLOC_ALL(err, "edges of the pad", SF_ROOM(e->line, 12 * (unsigned long)e->face_count),
                        SF_ROOM(e->face_line, 3 * (unsigned long)e->face_count)));
    memset(e->face_line, -1, 3 * (size_t)e->face_count * sizeof *e->face_line);
    for (int64_t k = 0, end; k < 3 * e->face_count; k = end) {
        end = sf_half_edges_end(half, k, 3 * e->face_count);
        int plane = end == k + 1 ? plane_of(rest, half[k].low, half[k].high) : 0;
        if (end != k + 2 && plane == 0)
            continue;
        int64_t one = half[k].slot, other = half[end - 1].slot;
        int32_t *line = &e->line[4 * e->line_count];
        line[0] = e->face[one];
        line[1] = e->face[one - one % 3 + (one + 1) % 3];
        line[2] = e->face[one - one % 3 + (one + 2) % 3];
        line[3] = plane > 0 ? -plane : e->face[other - other % 3 + (other + 2) % 3];
        e->face_line[one] = (int32_t)e->line_count++;
    }
    return SF_OK;
}

static sf_status mark_planes(const rest_state *rest, sf_sharp *e, sf_error *err) {
    e->corner_plane = sf_alloc(err, e->ridges.corner_count, 1, "sharp edges");
    for (int64_t k = 0; e->corner_plane && k < e->ridges.corner_count; k++)
        for (int r = 0; r < 2; r++) {
            double x = e->position[3 * (int64_t)e->ridges.corner[k] + r];
            e->corner_plane[k] |= (uint8_t)((fabs(x - rest->plane[r]) < rest->near) << r);
        }
    return err->status;
}

enum { NO_FACES = -3 }; /* in place of the third points at a line */

/* Lists the sides of a section, and keeps the edges that go through y = 0 beside the axis. */
static sf_status list_sides(sf_sharp *e, sf_error *err) {
    sf_ridges *ridges = &e->ridges;
    int64_t kept = 0;
    for (int64_t k = 0; k < ridges->count; k++) {
        const double *a = &e->position[3 * (int64_t)ridges->ridge[k].node[0]],
                     *b = &e->position[3 * (int64_t)ridges->ridge[k].node[1]];
        if (a[1] * b[1] < 0 && a[0] + b[0] > 0)
            ridges->ridge[kept++] = ridges->ridge[k];
    }
    ridges->count = kept;
    ridges->corner_count = 0;
    if (kept == 0) {
        sf_sharp_free(e);
        return SF_OK;
    }
    SF_TRY(SF_ALLOC_ALL(err, "sides of the pad", SF_ROOM(e->line, 4 * (unsigned long)e->face_count),
                        SF_ROOM(e->face_line, 3 * (unsigned long)e->face_count)));
    e->line_count = e->face_count;
    for (int64_t k = 0; k < e->face_count; k++) {
        const int32_t line[4] = {e->face[3 * k], e->face[3 * k + 1], NO_FACES, NO_FACES};
        memcpy(&e->line[4 * k], line, sizeof line);
        e->face_line[3 * k] = (int32_t)k;
        e->face_line[3 * k + 1] = e->face_line[3 * k + 2] = -1;
    }
    return SF_OK;
}

/* Finds the sharp parts of a surface; without one the body has no faces. */
static sf_status build(const sf_model *m, bool missile, rest_state *rest, sf_sharp *e, sf_error *err) {
    static const double ON_PLANE = 1e-6; /* of the thickness */
    int64_t nodes = missile ? m->surface_node_count : m->support_node_count,
            triangles = missile ? m->surface_triangle_count : m->support_triangle_count;
    const int32_t *triangle = missile ? m->surface_triangle : m->support_triangle;
    rest->near = ON_PLANE * m->thickness;
    for (int r = 0; r < 2; r++)
        rest->plane[r] = sf_symmetry_plane(m, r, &rest->plane[r]) ? rest->plane[r] : NAN;
    sf_ridge_limits limits = {.spacing = e->spacing,
                              .depth = m->axisymmetric ? SF_SECTION_DEPTH : SF_SMOOTH_DEPTH};
    memcpy(limits.place, rest->plane, sizeof limits.place);
    SF_TRY(sf_ridges_find(nodes, e->position, triangles, triangle, &limits, &e->ridges, err));
    if (m->axisymmetric)
        return list_sides(e, err);
    if (e->ridges.corner_count == 0) {
        sf_sharp_free(e);
        return SF_OK;
    }
    SF_TRY(list_lines(rest, e, err));
    return mark_planes(rest, e, err);
}

sf_status sf_sharp_build_missile(const sf_model *m, double spacing, sf_sharp *e, sf_error *err) {
    rest_state rest = {.position = m->position, .point = m->contact_node};
    *e = (sf_sharp){.face_count = m->contact_face_count, .position = m->surface_position, .spacing = spacing};
    if (e->face_count == 0)
        return SF_OK;
    e->face = sf_alloc(err, 3 * (unsigned long)e->face_count, sizeof *e->face, "faces of the pad");
    for (int64_t k = 0; e->face && k < 3 * e->face_count; k++)
        e->face[k] = (int32_t)sf_list_find(m->contact_node, 0, m->contact_count, m->contact_face[k]);
    if (err->status != SF_OK || build(m, true, &rest, e, err) != SF_OK)
        sf_sharp_free(e);
    return err->status;
}

sf_status sf_sharp_build_supports(const sf_model *m, sf_skin *skin, sf_sharp *e, sf_error *err) {
    rest_state rest = {.position = skin->rest};
    *e = (sf_sharp){.face_count = m->skin_count, .position = m->support_position, .spacing = skin->spacing};
    if (m->skin_count == 0 || m->support_triangle_count == 0) {
        e->face_count = 0;
        return SF_OK;
    }
    e->face = sf_alloc(err, 3 * (unsigned long)e->face_count, sizeof *e->face, "faces of the pad");
    if (e->face)
        memcpy(e->face, skin->facet, 3 * (size_t)e->face_count * sizeof *e->face);
    if (err->status != SF_OK || build(m, false, &rest, e, err) != SF_OK)
        sf_sharp_free(e);
    for (int64_t k = 0; k < e->ridges.corner_count; k++) { /* whatever copy of a node is that of the corner */
        int64_t corner = skin->moving + e->ridges.corner[k];
        for (int64_t p = skin->moving; p < skin->nodes; p++)
            if (sf_distance3(&skin->rest[3 * p], &skin->rest[3 * corner]) == 0)
                skin->passive[p] = 1;
    }
    return err->status;
}

void sf_sharp_free(sf_sharp *e) {
    sf_ridges_free(&e->ridges);
    SF_CLEAR(e, e->face, e->face_line, e->line, e->corner_plane);
    e->face_count = 0;
}

/* ---- places ---- */

static const double *point_now(const sf_sharp_place *at, int32_t point) {
    return &at->position[3 * (int64_t)point];
}

static void body_node(const sf_sharp *e, const sf_sharp_place *at, int32_t node, double out[3]) {
    const double *rest = &e->position[3 * (int64_t)node];
    if (at->missile)
        sf_missile_place(at->model, at->missile, rest, out);
    else
        memcpy(out, rest, 3 * sizeof *out);
}

static void body_arm(const sf_sharp_place *at, const double rest[3], double out[3]) {
    if (at->missile)
        sf_missile_orient(at->model, at->missile, rest, out);
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

/* The list in the making, and the faces as they lie now, in a grid. */
typedef struct listing {
    double reach; /* m */
    int64_t count, room;
    sf_sharp_candidate *list;
    double *centre, *radius;
    int32_t *found;
    sf_grid grid;
} listing;

static sf_status find_faces(const sf_sharp *e, const sf_sharp_place *at, sf_sharp_state *s, listing *l,
                            sf_error *err) {
    static const char purpose[] = "candidates of sharp edges";
    int64_t count = e->face_count;
    l->room = 64 * (e->ridges.corner_count + e->ridges.count) + 8 * e->line_count;
    l->list = sf_workspace_take(&s->list, l->room, sizeof *l->list, purpose, err);
    l->centre = sf_workspace_take(&s->centre, 3 * count, sizeof *l->centre, purpose, err);
    l->radius = sf_workspace_take(&s->radius, count, sizeof *l->radius, purpose, err);
    l->found = sf_workspace_take(&s->found, count, sizeof *l->found, purpose, err);
    int64_t *start = sf_workspace_take(&s->start, SF_GRID_STARTS(count), sizeof *start, purpose, err);
    int32_t *node = sf_workspace_take(&s->node, count, sizeof *node, purpose, err);
    SF_TRY(err->status);
    for (int64_t k = 0; k < count; k++) {
        double *centre = &l->centre[3 * k];
        l->radius[k] = 0;
        for (int r = 0; r < 3; r++)
            centre[r] = (point_now(at, e->face[3 * k])[r] + point_now(at, e->face[3 * k + 1])[r] +
                         point_now(at, e->face[3 * k + 2])[r]) /
                        3;
        for (int c = 0; c < 3; c++)
            l->radius[k] = fmax(l->radius[k], sf_distance3(point_now(at, e->face[3 * k + c]), centre));
    }
    sf_grid_fill(&l->grid, count, l->centre, l->radius, start, node);
    return SF_OK;
}

/* Adds a candidate; counts on where there is no room. */
static void add(listing *l, int64_t part, int64_t slot) {
    if (l->count < l->room)
        l->list[l->count] = (sf_sharp_candidate){(int32_t)part, (int32_t)slot};
    l->count++;
}

static void list_corner(const sf_sharp *e, const sf_sharp_place *at, int64_t corner, listing *l) {
    double x[3], nearest[3];
    int feature;
    body_node(e, at, e->ridges.corner[corner], x);
    int64_t found = sf_grid_query(&l->grid, x, l->reach, e->face_count, l->found);
    for (int64_t k = 0; k < found; k++) {
        const int32_t *face = &e->face[3 * (int64_t)l->found[k]];
        sf_triangle_nearest(point_now(at, face[0]), point_now(at, face[1]), point_now(at, face[2]), x,
                            nearest, &feature);
        if (sf_distance3(x, nearest) < l->reach)
            add(l, corner, 3 * (int64_t)l->found[k]);
    }
}

static void list_ridge(const sf_sharp *e, const sf_sharp_place *at, int64_t ridge, listing *l) {
    double x[2][3], middle[3];
    for (int k = 0; k < 2; k++)
        body_node(e, at, e->ridges.ridge[ridge].node[k], x[k]);
    for (int r = 0; r < 3; r++)
        middle[r] = 0.5 * (x[0][r] + x[1][r]);
    int64_t found =
        sf_grid_query(&l->grid, middle, l->reach + sf_distance3(x[0], middle), e->face_count, l->found);
    for (int64_t k = 0; k < 3 * found; k++) {
        int64_t slot = 3 * (int64_t)l->found[k / 3] + k % 3, line = e->face_line[slot];
        if (line >= 0 && segment_distance(x[0], x[1], point_now(at, e->line[4 * line]),
                                          point_now(at, e->line[4 * line + 1])) < l->reach)
            add(l, e->ridges.corner_count + ridge, slot);
    }
}

/* The points of a candidate, and their number: of a corner's face, or of a line. */
static const int32_t *points_of(const sf_sharp *e, const sf_sharp_candidate *c, int *count) {
    *count = c->part < e->ridges.corner_count ? 3 : 2;
    return *count == 3 ? &e->face[c->slot] : &e->line[4 * (int64_t)e->face_line[c->slot]];
}

sf_status sf_sharp_list(const sf_sharp *e, const sf_sharp_place *at, double *reach, uint8_t *used,
                        sf_sharp_state *s, sf_error *err) {
    enum { HALVINGS = 6 };
    listing l = {.reach = *reach};
    SF_TRY(find_faces(e, at, s, &l, err));
    for (int of = 0; of == 0 || l.count > l.room; of++) {
        if (of > HALVINGS)
            return SF_FAIL(
                err, SF_ERR_NUMERIC,
                "sharp edges of a rigid body and faces of the pad are within %.3g mm of each other "
                "at %lld places, more than %lld: mesh the body coarser",
                1e3 * l.reach, (long long)l.count, (long long)l.room);
        l.reach = of > 0 ? 0.5 * l.reach : l.reach;
        l.count = 0;
        for (int64_t k = 0; k < e->ridges.corner_count; k++)
            list_corner(e, at, k, &l);
        for (int64_t k = 0; k < e->ridges.count; k++)
            list_ridge(e, at, k, &l);
    }
    s->count = l.count;
    *reach = l.reach;
    for (int64_t k = 0; k < l.count; k++) {
        int count, line = l.list[k].part < e->ridges.corner_count ? 0 : 2;
        const int32_t *point = points_of(e, &l.list[k], &count);
        for (int c = 0; c < count + line; c++) /* of a line the third points, too */
            if (point[c] >= 0)
                used[point[c]] = 1;
    }
    return SF_OK;
}

/* ---- pairs ---- */

/* Makes the parts of the pair these points with these weights. */
static void take_parts(const sf_sharp_place *at, int count, const int32_t *point, const double *weight,
                       sf_contact_pair *q) {
    q->parts = count;
    for (int k = 0; k < count; k++) {
        q->part[k] = point[k];
        q->share[k] = weight[k];
    }
    sf_pair_relative(q, at->position, q->place);
    sf_pair_relative(q, at->step, q->step);
}

/* The pair of a corner and a face, along the face's normal, without the part that a symmetry plane takes. */
static bool meet_face(const sf_sharp *e, const sf_sharp_place *at, const sf_sharp_candidate *c,
                      sf_contact_pair *q) {
    const int32_t *corners = &e->face[c->slot];
    const double *x[3];
    double tip[3], own[3], n[3], arm[3], point[3], weight[3];
    for (int k = 0; k < 3; k++)
        x[k] = point_now(at, corners[k]);
    body_node(e, at, e->ridges.corner[c->part], tip);
    sf_triangle_normal(x[0], x[1], x[2], own);
    double area = sqrt(sf_dot3(own, own));
    for (int r = 0; r < 3; r++)
        n[r] = e->corner_plane[c->part] >> r & 1 ? 0 : own[r];
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
    for (int64_t k = e->ridges.ptr[c->part]; k < e->ridges.ptr[c->part + 1]; k++) {
        body_arm(at, &e->ridges.arm[3 * k], arm);
        if (sf_dot3(arm, n) < -TILT)
            return false;
    }
    take_parts(at, 3, corners, weight, q);
    return true;
}

/* The pair of a line of the pad, or of a section's side, and a sharp edge that cross, along the normal of
 * both. The faces at the line may rise a little, as they may fall away in the next step. */
static bool meet_ridge(const sf_sharp *e, const sf_sharp_place *at, const sf_sharp_candidate *candidate,
                       sf_contact_pair *q) {
    const int32_t *point = &e->line[4 * (int64_t)e->face_line[candidate->slot]];
    const sf_ridge *ridge = &e->ridges.ridge[candidate->part - e->ridges.corner_count];
    const double *c = point_now(at, point[0]), *d = point_now(at, point[1]);
    double a[3], b[3], u[3], v[3], n[3], between[3], place[2], own[3], arm[3];
    body_node(e, at, ridge->node[0], a);
    body_node(e, at, ridge->node[1], b);
    sf_sub3(b, a, u);
    sf_sub3(d, c, v);
    sf_sub3(c, a, between);
    if (!sf_pair_cross(u, v, between, CROSSING, n, place))
        return false;
    double here = place[0], there = place[1];
    if (fabs(here - 0.5) > 0.5 + BEYOND || fabs(there - 0.5) > 0.5 + BEYOND)
        return false;
    double apart = sf_dot3(between, n);
    bool section = point[2] == NO_FACES;
    if (point[3] < 0 &&
        !section) { /* the edge goes on as its mirror image: the plane takes what is across it */
        memcpy(own, n, sizeof own);
        n[-1 - point[3]] = 0;
        sf_unit3(n);
        if (!(sf_dot3(own, n) > 0.5))
            return false;
        apart /= sf_dot3(own, n);
    }
    if (section)
        memcpy(own, (const double[3]){v[2], 0, -v[0]}, sizeof own);
    else
        sf_triangle_normal(c, d, point_now(at, point[2]), own);
    double side = sf_dot3(own, n) < 0 ? -1 : 1; /* n looks out of the pad */
    for (int k = 0; k < 2; k++) {
        body_arm(at, ridge->arm[k], arm);
        if (side * sf_dot3(arm, n) < -TILT)
            return false;
        if (section)
            continue;
        sf_sub3(point_now(at, point[2 + k] < 0 ? point[2] : point[2 + k]), c, arm);
        if (point[2 + k] < 0)
            arm[-1 - point[2 + k]] *= -1;
        if (!(side * sf_dot3(arm, n) < SLOPE * sqrt(sf_dot3(arm, arm))))
            return false;
    }
    const double weight[2] = {1 - there, there};
    q->gap = -side * apart;
    for (int r = 0; r < 3; r++)
        q->normal[r] = -side * n[r];
    take_parts(at, 2, point, weight, q);
    return true;
}

/* Who presses at a candidate, and with which coefficient of friction. */
static void take_partner(const sf_sharp *e, const sf_sharp_place *at, const sf_sharp_candidate *c,
                         sf_contact_pair *q) {
    const sf_model *m = at->model;
    q->missile = at->response;
    q->facet = -1;
    q->friction = m->missile.friction;
    if (at->response)
        return;
    q->facet = m->skin_count + (c->part < e->ridges.corner_count
                                    ? e->ridges.facet[c->part]
                                    : e->ridges.ridge[c->part - e->ridges.corner_count].facet);
    q->friction = m->support_friction[m->support_part[q->facet - m->skin_count]];
}

/* The force that a pair begins with: that of the last step, turned to the new normal. */
static void start_force(const sf_contact_pair *q, const double *old) {
    double p = old ? fmax(0, sf_dot3(old, q->normal)) : 0;
    for (int r = 0; r < 3; r++)
        q->force[r] = p > 0 && q->friction > 0 ? old[r] : p * q->normal[r];
}

/* True if the pair of a candidate closes in the next step. `old`: its force in the last one, or NULL. */
static bool closes(const sf_sharp *e, const sf_sharp_place *at, const sf_sharp_candidate *c,
                   const double *old, double dt, sf_contact_pair *q, double *deepest) {
    double away[3] = {0};
    *q = (sf_contact_pair){.force = q->force};
    if (!(c->part < e->ridges.corner_count ? meet_face(e, at, c, q) : meet_ridge(e, at, c, q)) ||
        q->gap < -(old ? DEEPEST : ENTRY) * e->spacing)
        return false;
    take_partner(e, at, c, q);
    if (q->missile)
        sf_missile_free_motion(q->missile, q->place, away);
    for (int r = 0; r < 3; r++)
        q->step[r] -= away[r];
    *deepest = fmax(*deepest, -q->gap);
    q->gap = fmax(q->gap, -RETURN * dt);
    return q->gap + sf_dot3(q->step, q->normal) < 0;
}

int64_t sf_sharp_room(const sf_sharp *e) {
    return e->face_count > 0 ? e->ridges.corner_count + e->line_count + SF_SHARP_MORE : 0;
}

sf_status sf_sharp_add(const sf_sharp *e, const sf_sharp_place *at, double dt, sf_sharp_state *s,
                       sf_contact_system *w, double *deepest, sf_error *err) {
    static const char purpose[] = "sharp edges in contact";
    int64_t room = sf_sharp_room(e), last = 0, count = 0;
    int32_t(*key)[2] = sf_workspace_take(&s->old_key, room, sizeof *key, purpose, err);
    double(*old)[3] = sf_workspace_take(&s->old_force, room, sizeof *old, purpose, err);
    const sf_sharp_candidate *list = s->list.data;
    SF_TRY(err->status);
    memcpy(key, s->key, (size_t)room * sizeof *key);
    memcpy(old, s->force, (size_t)room * sizeof *old);
    for (int64_t k = 0; k < s->count; k++) {
        int32_t own[2] = {list[k].part, list[k].slot + 1};
        while (last < room && key[last][1] > 0 && /* both lists have the same order */
               (key[last][0] < own[0] || (key[last][0] == own[0] && key[last][1] < own[1])))
            last++;
        bool on = last < room && key[last][0] == own[0] && key[last][1] == own[1];
        double beyond[3];
        sf_contact_pair spare, *q = count < room ? &w->pair[w->count] : &spare;
        q->force = count < room ? &s->force[3 * count] : beyond;
        if (!closes(e, at, &list[k], on ? old[last] : NULL, dt, q, deepest))
            continue;
        if (count == room)
            return SF_FAIL(err, SF_ERR_NUMERIC,
                           "more than %lld pairs of sharp edges touch: round the edges of the missile or "
                           "support, or take a finer mesh",
                           (long long)room);
        start_force(q, on ? old[last] : NULL);
        memcpy(&s->key[2 * count++], own, sizeof own);
        sf_contact_add(w);
    }
    for (int64_t k = count; k < room && s->key[2 * k + 1] > 0; k++)
        s->key[2 * k + 1] = 0;
    return SF_OK;
}
