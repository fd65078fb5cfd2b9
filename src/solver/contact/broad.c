/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/broad.h"

#include "base/grid.h"

enum { CANDIDATES = SF_SELF_CANDIDATES };
/* Reach of the lists, and the part of it at which they are made anew if it is more than twice a step's
 * travel; spacings. Of contact points, and of the skin. */
static const double CONTACT_REACH = 2, CONTACT_REST = 1, SKIN_REACH = 1.2, SKIN_REST = 0.36;
static const double FACING = -0.7; /* largest cosine, at rest, of neighbours that look at each other */
static const char purpose[] = "candidates of contact";

bool sf_broad_is_due(const sf_scene *c) {
    const sf_state *s = c->state;
    double rest = (c->response ? CONTACT_REST : SKIN_REST) * c->skin->spacing,
           speed = c->skin->rows.spread * s->fastest;
    speed += c->response ? sf_missile_fastest(c->model, &s->missile) : speed;
    c->at->room -= s->dt_old * speed;
    if (s->step > 0 && c->at->room > fmax(rest, 2 * s->dt * speed))
        return false;
    for (int64_t p = 0; p < c->skin->count; p++)
        c->at->near[p] = (int32_t)p;
    c->at->near_count = c->skin->count;
    return true;
}

/* ---- facets near a place ---- */

/* The facets of pad and supports as they lie now, each in a ball, with their grids. */
typedef struct facets {
    double *centre, *radius; /* [facet_count] m; in memory of the state, as all of this */
    sf_grid pad, support;
    int32_t *found; /* [facet_count] room */
} facets;

static sf_status find_facets(const sf_scene *c, facets *f, sf_error *err) {
    int64_t count = c->skin->facet_count, first = c->skin->faces;
    sf_contact_work *work = &c->at->work;
    int64_t *start[2];
    int32_t *node[2];
    f->centre = sf_workspace_take(&work->centre, 3 * count, sizeof *f->centre, purpose, err);
    f->radius = sf_workspace_take(&work->radius, count, sizeof *f->radius, purpose, err);
    f->found = sf_workspace_take(&work->found, count, sizeof *f->found, purpose, err);
    for (int k = 0; k < 2; k++) {
        start[k] =
            sf_workspace_take(&work->grid_start[k], SF_GRID_STARTS(count), sizeof *start[k], purpose, err);
        node[k] = sf_workspace_take(&work->grid_node[k], count, sizeof *node[k], purpose, err);
    }
    SF_TRY(err->status);
    for (int64_t k = 0; k < count; k++)
        sf_grid_ball(c->at->position, &c->skin->facet[3 * k], &f->centre[3 * k], &f->radius[k]);
    sf_grid_fill(&f->pad, first, f->centre, f->radius, start[0], node[0]);
    if (count > first)
        sf_grid_fill(&f->support, count - first, &f->centre[3 * first], &f->radius[first], start[1], node[1]);
    return SF_OK;
}

/* Distance (m) of x and a facet. */
static double facet_distance(const sf_scene *c, const double x[3], int64_t facet) {
    const double *corner[3];
    double nearest[3];
    int feature;
    sf_corners(c->at->position, &c->skin->facet[3 * facet], corner);
    sf_triangle_nearest(corner[0], corner[1], corner[2], x, nearest, &feature);
    return sf_distance3(x, nearest);
}

/* ---- facets that a node may touch ---- */

/* The neighbourhood of a node on the skin: the nodes of its facets. Those facets are no candidates but where
 * they look at the node from rest on, as those beside the tip of a slit do: a crease of a smooth surface or
 * of a corner that is narrower lies below the resolution of the cloud, and the foam's own stress keeps its
 * sides apart. */
typedef struct neighbourhood {
    uint8_t *is_near; /* [count] of the skin */
    int32_t *list;    /* [count] those with 1 in it */
    int64_t count;
} neighbourhood;

static void find_neighbourhood(const sf_skin *skin, int64_t p, neighbourhood *n) {
    while (n->count > 0)
        n->is_near[n->list[--n->count]] = 0;
    for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1]; e++)
        for (int k = 0; k < 3; k++) {
            int32_t other = skin->facet[3 * (int64_t)skin->ring[e] + k];
            if (!n->is_near[other])
                n->list[n->count++] = other;
            n->is_near[other] = 1;
        }
    if (!n->is_near[p])
        n->list[n->count++] = (int32_t)p;
    n->is_near[p] = 1;
}

/* True if one of the sides of node p looks at the facet from rest on: at a corner of a slit the mean of their
 * normals looks past the wall beyond. */
static bool looks_at(const sf_skin *skin, int64_t p, int64_t f) {
    const double *facing = &skin->facet_normal[3 * f];
    bool looks = skin->next_side[p] < 0 && sf_dot3(&skin->normal[3 * p], facing) < FACING;
    for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1] && skin->next_side[p] >= 0; e++)
        looks = looks || sf_dot3(&skin->facet_normal[3 * (int64_t)skin->ring[e]], facing) < FACING;
    return looks;
}

static bool is_candidate(const sf_skin *skin, const neighbourhood *n, int64_t p, int64_t f) {
    const int32_t *facet = &skin->facet[3 * f];
    if (facet[0] == p || facet[1] == p || facet[2] == p)
        return false;
    if (!n->is_near[facet[0]] && !n->is_near[facet[1]] && !n->is_near[facet[2]])
        return true;
    return p < skin->nodes && looks_at(skin, p, f);
}

/* The nearest of facets, by distance (m). */
typedef struct nearest {
    int count, room;
    int32_t facet[CANDIDATES];
    double distance[CANDIDATES];
    double left_out; /* m, distance of the nearest that has no place */
} nearest;

static void insert(nearest *n, int32_t facet, double distance) {
    int k = n->count < n->room ? n->count++ : n->room;
    if (k == n->room)
        n->left_out = fmin(n->left_out, fmax(distance, n->distance[k - 1]));
    if (k == n->room && distance >= n->distance[--k])
        return;
    for (; k > 0 && n->distance[k - 1] > distance; k--) {
        n->distance[k] = n->distance[k - 1];
        n->facet[k] = n->facet[k - 1];
    }
    n->distance[k] = distance;
    n->facet[k] = facet;
}

/* Adds the facets across the gap between pad and support that node p can reach to its `count` candidates;
 * what has no place makes the lists due earlier. */
static int add_across(const sf_scene *c, int64_t p, double reach, const facets *f, int count) {
    bool rigid = sf_skin_is_rigid(c->skin, p);
    int32_t first = rigid ? 0 : (int32_t)c->skin->faces;
    nearest n = {.room = CANDIDATES - count, .left_out = INFINITY};
    const double *x = &c->at->position[3 * p];
    int64_t found = sf_grid_query(rigid ? &f->pad : &f->support, x, reach, c->skin->facet_count, f->found);
    for (int64_t k = 0; k < found; k++) {
        double distance = facet_distance(c, x, first + f->found[k]);
        if (distance < reach)
            insert(&n, first + f->found[k], distance);
    }
    memcpy(&c->at->candidate[CANDIDATES * p + count], n.facet, (size_t)n.count * sizeof *n.facet);
    c->at->room = fmin(c->at->room, n.left_out);
    return count + n.count;
}

/* Keeps the candidates of node p: facets in reach but for those of its own neighbourhood; and marks the nodes
 * that have some, or can reach a plane, with the nodes of their facets, by 1 in `used`. */
static void choose_candidates(const sf_scene *c, int64_t p, double reach, const facets *f, neighbourhood *n,
                              uint8_t *used) {
    enum { MOST = 256, OF_PAD = CANDIDATES / 2 };
    const sf_skin *skin = c->skin;
    const double *x = &c->at->position[3 * p];
    int32_t *own = &c->at->candidate[CANDIDATES * p], near[MOST];
    bool across = skin->moving < skin->nodes, rigid = sf_skin_is_rigid(skin, p);
    int count = 0, most = across && p < skin->nodes ? OF_PAD : CANDIDATES;
    int64_t found =
        (skin->alone && !skin->watched) || rigid ? 0 : sf_grid_query(&f->pad, x, reach, MOST, near);
    if (found > 0)
        find_neighbourhood(skin, p, n);
    for (int64_t k = 0; k < found && k < MOST && count < most; k++)
        if (is_candidate(skin, n, p, near[k]))
            own[count++] = near[k];
    if (across && !skin->passive[p])
        count = add_across(c, p, reach, f, count);
    for (int k = 0; k < 3 * count; k++)
        used[skin->facet[3 * (int64_t)own[k / 3] + k % 3]] = 1;
    for (int k = 0; k < SF_BODY_MISSILE; k++)
        used[p] |=
            c->body[k].shape && sf_skin_is_stopped(skin, p, k) && sf_body_is_near(&c->body[k], x, reach);
    used[p] |= count > 0;
    for (int k = 0; k < sf_skin_members(skin, p) && count > 0; k++)
        used[sf_skin_member(skin, p, k)] = 1;
    for (int k = count; k < CANDIDATES; k++)
        own[k] = SF_NO_PARTNER;
}

/* ---- faces that sharp edges may press ---- */

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
typedef struct listing {
    double reach; /* m */
    int64_t count, room;
    sf_sharp_candidate *list;
} listing;

/* Adds a candidate; counts on where there is no room. */
static void add(listing *l, int64_t part, int64_t slot) {
    if (l->count < l->room)
        l->list[l->count] = (sf_sharp_candidate){(int32_t)part, (int32_t)slot};
    l->count++;
}

static void list_corner(const sf_scene *c, int64_t corner, const facets *f, listing *l) {
    double x[3];
    sf_sharp_node(c, c->sharp->ridges.corner[corner], x);
    int64_t found = sf_grid_query(&f->pad, x, l->reach, c->skin->faces, f->found);
    for (int64_t k = 0; k < found; k++)
        if (facet_distance(c, x, f->found[k]) < l->reach)
            add(l, corner, 3 * (int64_t)f->found[k]);
}

static void list_ridge(const sf_scene *c, int64_t ridge, const facets *f, listing *l) {
    const sf_skin *skin = c->skin;
    const double *y = c->at->position;
    double x[2][3], middle[3];
    for (int k = 0; k < 2; k++)
        sf_sharp_node(c, c->sharp->ridges.ridge[ridge].node[k], x[k]);
    for (int r = 0; r < 3; r++)
        middle[r] = 0.5 * (x[0][r] + x[1][r]);
    int64_t found =
        sf_grid_query(&f->pad, middle, l->reach + sf_distance3(x[0], middle), skin->faces, f->found);
    for (int64_t k = 0; k < 3 * found; k++) {
        int64_t slot = 3 * (int64_t)f->found[k / 3] + k % 3, line = skin->line_of[slot];
        if (line >= 0 && segment_distance(x[0], x[1], &y[3 * (int64_t)skin->line[4 * line]],
                                          &y[3 * (int64_t)skin->line[4 * line + 1]]) < l->reach)
            add(l, c->sharp->ridges.corner_count + ridge, slot);
    }
}

/* Lists what sharp edges may meet within the room of the lists, which becomes less if there is no memory, and
 * marks the points that take part. */
static sf_status list_sharp(const sf_scene *c, double reach, const facets *f, uint8_t *used, sf_error *err) {
    enum { HALVINGS = 6 };
    const sf_ridges *ridges = &c->sharp->ridges;
    const sf_skin *skin = c->skin;
    listing l = {.reach = 2 * reach,
                 .room = 64 * (ridges->corner_count + ridges->count) + 8 * skin->line_count};
    l.list = sf_workspace_take(&c->at->work.list, l.room, sizeof *l.list, purpose, err);
    SF_TRY(err->status);
    for (int of = 0; of == 0 || l.count > l.room; of++) {
        if (of > HALVINGS)
            return SF_FAIL(
                err, SF_ERR_NUMERIC,
                "sharp edges of a rigid body and faces of the pad are within %.3g mm of each other "
                "at %lld places, more than %lld: mesh the body coarser",
                1e3 * l.reach, (long long)l.count, (long long)l.room);
        l.reach *= 0.5;
        l.count = 0;
        for (int64_t k = 0; k < ridges->corner_count; k++)
            list_corner(c, k, f, &l);
        for (int64_t k = 0; k < ridges->count; k++)
            list_ridge(c, k, f, &l);
    }
    c->at->sharp.count = l.count;
    c->at->room = fmin(c->at->room, l.reach);
    for (int64_t k = 0; k < l.count; k++) {
        bool corner = l.list[k].part < ridges->corner_count; /* of a line the third points, too */
        const int32_t *point =
            corner ? &skin->facet[l.list[k].slot] : &skin->line[4 * (int64_t)skin->line_of[l.list[k].slot]];
        for (int a = 0; a < (corner ? 3 : 4); a++)
            if (point[a] >= 0)
                used[point[a]] = 1;
    }
    return SF_OK;
}

/* ---- lists ---- */

/* Lists the nodes whose positions and normals a step needs, from those that are used. */
static void list_nodes(const sf_scene *c, uint8_t *used) {
    const sf_skin *skin = c->skin;
    sf_contact_points *at = c->at;
    at->close_count = at->near_count = 0;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            at->close[at->close_count++] = (int32_t)p;
    for (int64_t k = 0; k < at->close_count && !c->response; k++)
        for (int64_t e = skin->ring_ptr[at->close[k]]; e < skin->ring_ptr[at->close[k] + 1]; e++)
            for (int a = 0; a < 3; a++)
                used[skin->facet[3 * (int64_t)skin->ring[e] + a]] = 1;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            at->near[at->near_count++] = (int32_t)p;
}

sf_status sf_broad_list(const sf_scene *c, sf_error *err) {
    const sf_skin *skin = c->skin;
    sf_contact_points *at = c->at;
    facets f = {0};
    uint8_t *used = sf_workspace_take(&at->work.used, skin->count, 1, purpose, err);
    neighbourhood n = {sf_workspace_take(&at->work.is_near, skin->count, 1, purpose, err),
                       sf_workspace_take(&at->work.near_list, skin->count, sizeof *n.list, purpose, err), 0};
    double reach = at->room = (c->response ? CONTACT_REACH : SKIN_REACH) * skin->spacing;
    SF_TRY(err->status);
    memset(used, 0, (size_t)skin->count);
    memset(n.is_near, 0, (size_t)skin->count);
    if (!c->response || c->sharp->is_there)
        SF_TRY(find_facets(c, &f, err));
    for (int64_t p = 0; p < skin->count && !c->response; p++)
        choose_candidates(c, p, reach, &f, &n, used);
    if (c->sharp->is_there)
        SF_TRY(list_sharp(c, reach, &f, used, err));
    for (int64_t p = 0; p < skin->count && c->response; p++)
        used[p] |= skin->rests[p] || sf_missile_near(c->model, &c->state->missile, &c->body[SF_BODY_MISSILE],
                                                     &at->position[3 * p], at->room);
    list_nodes(c, used);
    return SF_OK;
}
