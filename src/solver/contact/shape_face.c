/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_face.h"

#include "base/sets.h"
#include "solver/contact/listing.h"

static const double OPPOSED = -0.5; /* largest cosine of the normals of a node and the face that it touches */
static const double EDGE = 0.05;    /* of a face, in its barycentric coordinates: it reaches so far beyond */
/* Faces are too far for this step beyond SPREAD times the largest motion of a point, as weights may be below
 * zero by EDGE, and for quadrangles WARP spacings more, by which both cuts may differ. */
static const double SPREAD = 3, WARP = 0.5;

static const double FACING = -0.7; /* largest cosine, at rest, of neighbours that look at each other */

/* ---- candidates ---- */

/* True if one of the sides of node p looks at the facet from rest on: at a corner of a slit the mean of their
 * normals looks past the wall beyond. */
static bool looks_at(const sf_skin *skin, int64_t p, int64_t f) {
    const double *facing = &skin->facet_normal[3 * f];
    bool looks = skin->next_side[p] < 0 && sf_dot3(&skin->normal[3 * p], facing) < FACING;
    for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1] && skin->next_side[p] >= 0; e++)
        looks = looks || sf_dot3(&skin->facet_normal[3 * (int64_t)skin->ring[e]], facing) < FACING;
    return looks;
}

/* A facet of the pad is no candidate of a point on one that meets it, but where it looks at the node from
 * rest on, as those beside the tip of a slit do: a crease of a smooth surface or of a corner that is narrower
 * lies below the resolution of the cloud, and the foam's own stress keeps its sides apart. */
static bool is_candidate(const sf_skin *skin, int64_t p, int64_t f) {
    bool beside = false;
    for (int k = 0; k < 3; k++)
        if (skin->facet[3 * f + k] == p)
            return false;
    for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1] && !beside; e++)
        beside = sf_skin_facets_meet(skin, skin->ring[e], f);
    return !beside || (p < skin->nodes && looks_at(skin, p, f));
}

/* The nearest of facets, by distance (m). */
typedef struct nearest {
    int count;
    int32_t facet[SF_SELF_CANDIDATES];
    double distance[SF_SELF_CANDIDATES];
    double left_out; /* m, distance of the nearest that has no place */
} nearest;

static void insert(nearest *n, int64_t facet, double distance) {
    int k = n->count < SF_SELF_CANDIDATES ? n->count++ : SF_SELF_CANDIDATES;
    if (k == SF_SELF_CANDIDATES)
        n->left_out = fmin(n->left_out, fmax(distance, n->distance[k - 1]));
    if (k == SF_SELF_CANDIDATES && distance >= n->distance[--k])
        return;
    for (; k > 0 && n->distance[k - 1] > distance; k--) {
        n->distance[k] = n->distance[k - 1];
        n->facet[k] = n->facet[k - 1];
    }
    n->distance[k] = distance;
    n->facet[k] = (int32_t)facet;
}

/* Keeps the candidates of a point, the nearest facets in reach of pad and supports, and marks it and the
 * nodes of these if there are some; facets that have no place make the lists due earlier. The reach is not
 * less than the depth at which a pair is known to have passed through, of a coarse point beside fine ones.
 * Faces of the pad that touch each other are in the order of their numbers, so that pairs do not depend on
 * when the lists were made; those across the gap to a support are by distance, as of two supports side by
 * side the nearer one is touched. */
static void choose_candidates(const sf_scene *c, int64_t p, const sf_listing *l) {
    const sf_skin *skin = c->skin;
    const double *x = &c->at->position[3 * p];
    int32_t *own = &c->at->candidate[SF_SELF_CANDIDATES * p];
    bool rigid = sf_skin_is_rigid(skin, p), across = skin->moving < skin->nodes && !skin->passive[p];
    const bool sees[2] = {rigid ? across : !skin->alone || skin->watched, !rigid && across};
    nearest n = {.left_out = INFINITY};
    double reach = fmax(l->reach, 2 * sf_shape_limit(&sf_shape_face, true, skin->size[p]));
    for (int k = 0; k < 2; k++) {
        const sf_grid *grid = k ? &l->support : &l->pad;
        int64_t first = k ? skin->faces : 0,
                found = sees[k] ? sf_grid_query(grid, x, reach, skin->facet_count, l->found) : 0;
        for (int64_t i = 0; i < found; i++) {
            int64_t f = first + l->found[i];
            double distance = is_candidate(skin, p, f) ? sf_listing_distance(c, x, f) : INFINITY;
            if (distance < reach)
                insert(&n, f, distance);
        }
    }
    c->at->room = fmin(c->at->room, n.left_out);
    int count = 0;
    for (int k = 0; k < n.count; k++)
        if (n.facet[k] < skin->faces)
            own[count++] = n.facet[k];
    if (!rigid)
        qsort(own, (size_t)count, sizeof *own, sf_by_number);
    for (int k = 0; k < n.count; k++)
        if (n.facet[k] >= skin->faces)
            own[count++] = n.facet[k];
    for (; count < SF_SELF_CANDIDATES; count++)
        own[count] = SF_NO_PARTNER;
    for (int k = 0; k < 3 * n.count; k++)
        l->used[skin->facet[3 * (int64_t)own[k / 3] + k % 3]] = 1;
    l->used[p] |= n.count > 0;
    for (int k = 0; k < sf_skin_members(skin, p) && n.count > 0; k++)
        l->used[sf_skin_member(skin, p, k)] = 1;
}

static sf_status list(const sf_scene *c, sf_listing *l, sf_error *err) {
    if (c->response)
        return SF_OK;
    SF_TRY(sf_listing_facets(c, l, err));
    for (int64_t p = 0; p < c->skin->count; p++)
        choose_candidates(c, p, l);
    return SF_OK;
}

/* ---- pairs ---- */

static double *side_normal(const sf_scene *c, int64_t f, int corner) {
    return &c->at->side[3 * (int64_t)c->skin->side[3 * f + corner]];
}

/* Finds the outward normals of the sides of the points that may touch, weighted by the areas of their facets;
 * of a centroid the mean of its nodes'. */
static void turn(const sf_scene *c) {
    const sf_skin *skin = c->skin;
    double *normal = c->at->side;
    for (int64_t k = 0; k < c->at->close_count; k++) {
        int64_t p = c->at->close[k];
        bool node = p < skin->nodes; /* centroids come behind their nodes */
        for (int64_t side = p; side >= 0; side = skin->next_side[side])
            memset(&normal[3 * side], 0, 3 * sizeof *normal);
        for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1]; e++) {
            int64_t f = skin->ring[e];
            double one[3];
            sf_face_normal(c->at->position, &skin->facet[3 * f], one);
            for (int corner = 0; corner < 3; corner++) {
                double *of = side_normal(c, f, corner), *sum = node ? of : &normal[3 * p];
                for (int r = 0; r < 3 && (!node || skin->facet[3 * f + corner] == p); r++)
                    sum[r] += node ? one[r] : of[r];
            }
        }
        for (int64_t side = p; side >= 0; side = skin->next_side[side]) {
            for (int r = 0; r < 3; r++) /* the other half lies beyond a symmetry plane */
                normal[3 * side + r] *= !((skin->held[p] >> r) & 1);
            sf_unit3(&normal[3 * side]);
        }
    }
}

/* The normal of point p as seen from a facet of the unit normal `facing`: that of its only side, or the mean
 * of its sides, each by how far it looks against the facet. False if none does. */
static bool normal_against(const sf_scene *c, int64_t p, const double facing[3], double out[3]) {
    const int32_t *next = c->skin->next_side;
    memset(out, 0, 3 * sizeof *out);
    for (int64_t side = p; side >= 0; side = next[side]) {
        const double *normal = &c->at->side[3 * side];
        double against = OPPOSED - sf_dot3(normal, facing);
        for (int r = 0; r < 3 && against > 0; r++)
            out[r] += next[p] < 0 ? normal[r] : against * normal[r];
    }
    if (next[p] >= 0)
        sf_unit3(out);
    return sf_dot3(out, out) > 0;
}

/* Finds the gap at x along the pair's normal of the plane through the nodes n, with its `own` normal of twice
 * its area, and the weights of the nodes there. False: the plane is tilted against the normal. */
static bool project(const sf_scene *c, const sf_contact_pair *q, const int32_t n[3], const double own[3],
                    double *gap, double weight[3]) {
    const double *x = &c->at->position[3 * q->node], *corner[3];
    double arm[3], point[3], across = sf_dot3(q->normal, own);
    if (!(across > 0.5 * sqrt(sf_dot3(own, own))))
        return false;
    sf_corners(c->at->position, n, corner);
    sf_sub3(x, corner[0], arm);
    *gap = sf_dot3(arm, own) / across;
    for (int r = 0; r < 3; r++)
        point[r] = x[r] - *gap * q->normal[r];
    sf_triangle_weights(corner, point, own, weight);
    return true;
}

/* Takes the mean of both ways to cut a quadrangle into halves, of gap and weights. One way alone passes no
 * uniform pressure on between faces that do not match: no forces that press are in equilibrium with it. */
static void take_both_diagonals(const sf_scene *c, sf_contact_pair *q) {
    int tip = c->skin->half[q->facet], next = (tip + 1) % 3, last = (tip + 2) % 3;
    const int32_t *n = &c->skin->facet[3 * q->facet];
    int32_t fourth = (int32_t)sf_skin_corner(c->skin, q->facet, 3);
    for (int side = 0; side < 2; side++) {
        const int32_t half[3] = {n[tip], side ? fourth : n[next], side ? n[last] : fourth};
        double own[3], weight[3], gap;
        sf_face_normal(c->at->position, half, own);
        if (!project(c, q, half, own, &gap, weight))
            return;
        if (side == 0 && weight[1] < 0)
            continue;
        for (int k = 0; k < 3; k++)
            q->weight[k] *= 0.5;
        q->weight[tip] += 0.5 * weight[0];
        q->weight[side ? 3 : next] += 0.5 * weight[1];
        q->weight[side ? last : 3] += 0.5 * weight[2];
        q->gap = 0.5 * (q->gap + gap);
        return;
    }
}

/* Weights that are rounding cost as much as others: they become zero, and the sum stays one. */
static void drop_traces(double weight[4]) {
    static const double TRACE = 1e-12;
    int largest = weight[1] > weight[0] ? 1 : 0;
    double rest = 1;
    for (int k = 2; k < 4; k++)
        largest = weight[k] > weight[largest] ? k : largest;
    for (int k = 1; k < 4; k++) {
        double *own = &weight[(largest + k) % 4];
        *own = fabs(*own) < TRACE ? 0 : *own;
        rest -= *own;
    }
    weight[largest] = rest;
}

/* True if a centroid lies on that of a triangle: the nodes of the two carry its part. */
static bool matches(const sf_skin *skin, const sf_contact_pair *q) {
    static const double SLIGHTLY = 0.01;
    double off = fmax(fabs(q->weight[0] - 1.0 / 3), fabs(q->weight[1] - 1.0 / 3));
    return !skin->half[q->facet] && off < SLIGHTLY;
}

/* A node lies before or behind the facet, and its own surface looks against it. The normal is the mean of
 * both surfaces: smooth over the facets, and the same seen from either side, where facets that are tilted
 * against each other would interlock; of a rigid facet it is that of the support, and for a node of an edge,
 * which has no normal of its own, that of the facet. The gap is along it, so that the forces on node and
 * facet lie on one line. */
static bool meet(const sf_scene *c, int64_t p, int64_t f, sf_contact_pair *q) {
    const sf_skin *skin = c->skin;
    const int32_t *n = &skin->facet[3 * f];
    const double *x = &c->at->position[3 * p], *corner[3];
    double own[3], facing[3], against[3], arm[3];
    sf_corners(c->at->position, n, corner);
    sf_triangle_normal(corner[0], corner[1], corner[2], own);
    sf_sub3(x, corner[0], arm);
    double area = sqrt(sf_dot3(own, own)),
           reach =
               SPREAD * c->at->travel + (skin->half[f] ? WARP * fmax(skin->size[p], skin->size[n[0]]) : 0);
    if (sf_dot3(arm, own) > reach * area)
        return false;
    bool alone = skin->next_side[p] >= 0 || sf_skin_is_rigid(skin, p) || sf_skin_is_rigid(skin, n[0]);
    for (int r = 0; r < 3; r++)
        facing[r] = own[r] / area;
    if (!(area > 0) || !normal_against(c, p, facing, against))
        return false;
    sf_triangle_weights(corner, x, own, q->weight);
    q->weight[3] = 0;
    for (int k = 0; k < 3; k++)
        if (q->weight[k] < -EDGE)
            return false;
    for (int r = 0; r < 3; r++) {
        q->normal[r] = alone ? 0 : -against[r];
        for (int k = 0; k < 3; k++)
            q->normal[r] += q->weight[k] * side_normal(c, f, k)[r];
        q->normal[r] *= !((skin->held[p] >> r) & 1);
    }
    sf_unit3(q->normal);
    if (!project(c, q, n, own, &q->gap, q->weight))
        return false;
    if (skin->half[f])
        take_both_diagonals(c, q);
    drop_traces(q->weight);
    sf_pair_list_parts(skin, q);
    return p < skin->nodes || !matches(skin, q);
}

static sf_shape_triangles triangles_of_supports(const sf_model *m, int body) {
    if (body < SF_BODY_SUPPORT)
        return (sf_shape_triangles){0};
    return (sf_shape_triangles){m->support_node_count, m->support_triangle_count, m->support_position,
                                m->support_triangle};
}

const sf_shape sf_shape_face = {.triangles = triangles_of_supports,
                                .list = list,
                                .turn = turn,
                                .meet = meet,
                                .entry = SF_CONTACT_ENTRY,
                                .deepest = 0.5,
                                .back = 0.1};
