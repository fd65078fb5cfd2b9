/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/candidates.h"

#include "base/grid.h"
#include "base/mat3.h"

enum { CANDIDATES = SF_SELF_CANDIDATES };
static const double NEAR = 1.2;    /* spacings: reach of the candidates */
static const double FACING = -0.7; /* largest cosine, at rest, of neighbours that look at each other */

/* The neighbourhood of a node on the skin: the nodes within RINGS facets of it. Its facets are no candidates
 * but where they look at the node from rest on, as those beside the tip of a slit do: a crease of a smooth
 * surface or of a corner that is narrower lies below the resolution of the cloud, and the foam's own stress
 * keeps its sides apart. */
enum { RINGS = 1 };
typedef struct neighbourhood {
    uint8_t *is_near; /* [count] of the skin */
    int32_t *list;    /* [count] those with 1 in it */
    int64_t count;
} neighbourhood;

static void find_neighbourhood(const sf_skin *skin, int64_t p, neighbourhood *n) {
    while (n->count > 0)
        n->is_near[n->list[--n->count]] = 0;
    n->list[n->count++] = (int32_t)p;
    n->is_near[p] = 1;
    for (int64_t ring = 0, first = 0; ring < RINGS; ring++) {
        int64_t last = n->count;
        for (; first < last; first++)
            for (int64_t k = skin->ring_ptr[n->list[first]]; k < skin->ring_ptr[n->list[first] + 1]; k++)
                for (int c = 0; c < 3; c++) {
                    int32_t other = skin->facet[3 * (int64_t)skin->ring[k] + c];
                    if (!n->is_near[other])
                        n->list[n->count++] = other;
                    n->is_near[other] = 1;
                }
    }
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

/* The facets of pad and support as they lie now, each with its grid. */
typedef struct facets {
    double *centre, *radius; /* [facet_count] m, of a ball round each */
    sf_grid pad, support;    /* in memory of the state, as all of this */
    int64_t first_rigid;     /* the support's first facet */
    int32_t *found;          /* [facet_count] room */
} facets;

static void surround(const sf_skin *skin, const sf_state *s, int64_t f, double centre[3], double *radius) {
    double corner[3][3], square = 0;
    for (int k = 0; k < 3; k++)
        memcpy(corner[k], &s->self_position[3 * (int64_t)skin->facet[3 * f + k]], sizeof corner[k]);
    for (int r = 0; r < 3; r++)
        centre[r] = (corner[0][r] + corner[1][r] + corner[2][r]) / 3;
    for (int k = 0; k < 3; k++) {
        for (int r = 0; r < 3; r++)
            corner[k][r] -= centre[r];
        square = fmax(square, sf_dot3(corner[k], corner[k]));
    }
    *radius = sqrt(square);
}

static sf_status facets_find(const sf_skin *skin, sf_state *s, facets *f, sf_error *err) {
    static const char purpose[] = "candidates of contact";
    int64_t count = skin->facet_count, starts = SF_GRID_STARTS(count);
    sf_contact_work *work = &s->contact_work;
    f->centre = sf_workspace_take(&work->centre, 3 * count, sizeof *f->centre, purpose, err);
    f->radius = sf_workspace_take(&work->radius, count, sizeof *f->radius, purpose, err);
    f->found = sf_workspace_take(&work->found, count, sizeof *f->found, purpose, err);
    int64_t *start[2];
    int32_t *node[2];
    for (int k = 0; k < 2; k++) {
        start[k] = sf_workspace_take(&work->grid_start[k], starts, sizeof *start[k], purpose, err);
        node[k] = sf_workspace_take(&work->grid_node[k], count, sizeof *node[k], purpose, err);
    }
    SF_TRY(err->status);
    for (int64_t k = 0; k < count; k++) {
        surround(skin, s, k, &f->centre[3 * k], &f->radius[k]);
        f->first_rigid += !sf_skin_is_rigid(skin, skin->facet[3 * k]);
    }
    sf_grid_fill(&f->pad, f->first_rigid, f->centre, f->radius, start[0], node[0]);
    if (count > f->first_rigid)
        sf_grid_fill(&f->support, count - f->first_rigid, &f->centre[3 * f->first_rigid],
                     &f->radius[f->first_rigid], start[1], node[1]);
    return SF_OK;
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

/* Adds the facets across the gap between pad and support, those of a grid whose first is `first`, that node p
 * can reach; what has no place makes the lists due earlier. */
static int add_across(const sf_skin *skin, sf_state *s, int64_t p, double reach, const facets *f,
                      const sf_grid *grid, int64_t first, int count) {
    const double *x = &s->self_position[3 * p];
    nearest n = {.room = CANDIDATES - count, .left_out = INFINITY};
    int64_t found = sf_grid_query(grid, x, reach, skin->facet_count, f->found);
    for (int64_t k = 0; k < found; k++) {
        const int32_t *node = &skin->facet[3 * (first + f->found[k])];
        double point[3], square = 0;
        int feature;
        sf_triangle_nearest(&s->self_position[3 * (int64_t)node[0]], &s->self_position[3 * (int64_t)node[1]],
                            &s->self_position[3 * (int64_t)node[2]], x, point, &feature);
        for (int r = 0; r < 3; r++)
            square += (x[r] - point[r]) * (x[r] - point[r]);
        if (square < reach * reach)
            insert(&n, (int32_t)first + f->found[k], sqrt(square));
    }
    memcpy(&s->self_candidate[CANDIDATES * p + count], n.facet, (size_t)n.count * sizeof *n.facet);
    s->self_room = fmin(s->self_room, n.left_out);
    return count + n.count;
}

/* Keeps the candidates of node p: facets in reach but for those of its own neighbourhood; and lists the nodes
 * that have some, or can reach a plane, with the nodes of their facets, as 1 in `used`. */
static void choose_candidates(const sf_skin *skin, sf_state *s, int64_t p, double reach, const facets *f,
                              neighbourhood *n, uint8_t *used) {
    enum { MOST = 256, OF_PAD = CANDIDATES / 2 };
    int32_t *own = &s->self_candidate[CANDIDATES * p], near[MOST];
    bool across = skin->moving < skin->nodes, rigid = sf_skin_is_rigid(skin, p), stopped = false;
    int count = 0, most = across && p < skin->nodes ? OF_PAD : CANDIDATES;
    int64_t found = (skin->alone && !skin->watched) || rigid
                        ? 0
                        : sf_grid_query(&f->pad, &s->self_position[3 * p], reach, MOST, near);
    if (found > 0)
        find_neighbourhood(skin, p, n);
    for (int64_t k = 0; k < found && k < MOST && count < most; k++)
        if (is_candidate(skin, n, p, near[k]))
            own[count++] = near[k];
    if (across && !skin->passive[p])
        count = rigid ? add_across(skin, s, p, reach, f, &f->pad, 0, count)
                      : add_across(skin, s, p, reach, f, &f->support, f->first_rigid, count);
    for (int k = 0; k < count; k++)
        for (int a = 0; a < 3; a++)
            used[skin->facet[3 * (int64_t)own[k] + a]] = 1;
    for (int k = 0; k < SF_SKIN_PLANES; k++)
        stopped = stopped || (sf_skin_is_stopped(skin, p, k) &&
                              sf_skin_height(skin, &s->self_position[3 * p], k) < reach);
    used[p] |= count > 0 || stopped;
    for (int k = 0; k < sf_skin_members(skin, p) && count > 0; k++)
        used[sf_skin_member(skin, p, k)] = 1;
    for (int k = count; k < CANDIDATES; k++)
        own[k] = SF_SKIN_NOTHING;
}

/* The lists of nodes whose positions and normals a step needs, from those that are used. */
static void list_nodes(const sf_skin *skin, sf_state *s, uint8_t *used) {
    s->self_close_count = s->self_near_count = 0;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            s->self_close[s->self_close_count++] = (int32_t)p;
    for (int64_t k = 0; k < s->self_close_count; k++)
        for (int64_t e = skin->ring_ptr[s->self_close[k]]; e < skin->ring_ptr[s->self_close[k] + 1]; e++)
            for (int c = 0; c < 3; c++)
                used[skin->facet[3 * (int64_t)skin->ring[e] + c]] = 1;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            s->self_near[s->self_near_count++] = (int32_t)p;
}

sf_status sf_candidates_find(const sf_skin *skin, const sf_sharp *sharp, const sf_sharp_place *at,
                             sf_state *s, sf_error *err) {
    static const char purpose[] = "candidates of contact";
    facets f = {0};
    sf_contact_work *work = &s->contact_work;
    uint8_t *used = sf_workspace_take(&work->used, skin->count, 1, purpose, err);
    neighbourhood n = {sf_workspace_take(&work->is_near, skin->count, 1, purpose, err),
                       sf_workspace_take(&work->near_list, skin->count, sizeof *n.list, purpose, err), 0};
    double reach = s->self_room = NEAR * skin->spacing;
    SF_TRY(facets_find(skin, s, &f, err));
    memset(used, 0, (size_t)skin->count);
    memset(n.is_near, 0, (size_t)skin->count);
    for (int64_t p = 0; p < skin->count; p++)
        choose_candidates(skin, s, p, reach, &f, &n, used);
    if (sharp->face_count > 0)
        SF_TRY(sf_sharp_list(sharp, at, &reach, used, &s->self_sharp, err));
    s->self_room = fmin(s->self_room, reach);
    list_nodes(skin, s, used);
    return SF_OK;
}

/* Subtracts what node and facet travel towards each other in a step. */
bool sf_candidates_last(const sf_skin *skin, sf_state *s) {
    double travel = 2 * skin->rows.spread * s->fastest;
    s->self_room -= s->dt_old * travel;
    return s->step > 0 && s->self_room > fmax(0.3 * NEAR * skin->spacing, 2 * s->dt * travel);
}
