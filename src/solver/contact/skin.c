/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/skin.h"

#include "base/mat3.h"
#include "base/sets.h"

static sf_status number_nodes(const sf_model *m, sf_skin *skin, sf_error *err) {
    skin->facet_count = m->skin_count + m->support_triangle_count;
    skin->facet = sf_alloc(err, 3 * skin->facet_count, sizeof *skin->facet, "skin of the pad");
    SF_TRY(err->status);
    for (int64_t k = 0; k < 3 * m->skin_count; k++)
        skin->facet[k] = m->skin_triangle[k];
    skin->node =
        sf_list_number(m->node_count, 3 * m->skin_count, skin->facet, &skin->moving, "skin of the pad", err);
    for (int64_t k = 0; err->status == SF_OK && k < 3 * m->support_triangle_count; k++)
        skin->facet[3 * m->skin_count + k] = (int32_t)skin->moving + m->support_triangle[k];
    skin->nodes = skin->moving + m->support_node_count;
    skin->count = skin->nodes + sf_model_skin_centroids(m);
    SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->own, (unsigned long)(skin->count - skin->nodes)),
                 SF_ROOM(skin->half, skin->facet_count));
    for (int64_t k = 1; err->status == SF_OK && k < m->skin_count; k++)
        if (sf_model_skin_is_quadrangle(m, k)) {
            skin->half[k - 1] = 1;
            skin->half[k] = 2;
        }
    for (int64_t k = 0, used = 0; err->status == SF_OK && used < skin->count - skin->nodes; k++)
        if (!skin->half[k])
            skin->own[used++] = (int32_t)k;
    return err->status;
}

static sf_status place_nodes(const sf_model *m, sf_skin *skin, sf_error *err) {
    SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->rest, 3 * skin->count),
                 SF_ROOM(skin->size, skin->count));
    for (int64_t p = 0; err->status == SF_OK && p < skin->moving; p++) {
        memcpy(&skin->rest[3 * p], &m->position[3 * (int64_t)skin->node[p]], 3 * sizeof *skin->rest);
        skin->size[p] = m->spacing[skin->node[p]];
        skin->spacing = fmin(skin->spacing, skin->size[p]);
    }
    for (int64_t p = skin->moving; err->status == SF_OK && p < skin->nodes; p++) {
        memcpy(&skin->rest[3 * p], &m->support_position[3 * (p - skin->moving)], 3 * sizeof *skin->rest);
        skin->size[p] = skin->spacing;
    }
    for (int64_t p = skin->nodes; err->status == SF_OK && p < skin->count; p++)
        for (int k = 0; k < 3; k++) {
            int64_t node = sf_skin_member(skin, p, k);
            skin->size[p] = k == 0 ? skin->size[node] : fmin(skin->size[p], skin->size[node]);
            for (int r = 0; r < 3; r++)
                skin->rest[3 * p + r] += skin->rest[3 * node + r] / 3;
        }
    return err->status;
}

static sf_status list_rings(sf_skin *skin, sf_error *err) {
    int64_t corners = 3 * skin->facet_count;
    unsigned long all = (unsigned long)(corners + skin->count - skin->nodes);
    SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->ring_ptr, skin->count + 2), SF_ROOM(skin->ring, all));
    if (err->status != SF_OK)
        return err->status;
    for (int64_t k = 0; k < corners; k++)
        skin->ring_ptr[skin->facet[k] + 2]++;
    for (int64_t p = 0; p < skin->count; p++)
        skin->ring_ptr[p + 2] += (p >= skin->nodes) + skin->ring_ptr[p + 1];
    for (int64_t k = 0; k < corners; k++)
        skin->ring[skin->ring_ptr[skin->facet[k] + 1]++] = (int32_t)(k / 3);
    for (int64_t p = skin->nodes; p < skin->count; p++)
        skin->ring[skin->ring_ptr[p + 1]++] = skin->own[p - skin->nodes];
    return SF_OK;
}

/* Normals at rest; those of a node are weighted by the areas. */
static sf_status find_normals(sf_skin *skin, sf_error *err) {
    skin->normal = sf_alloc(err, 3 * skin->count, sizeof(double), "skin of the pad");
    skin->facet_normal = sf_alloc(err, 3 * skin->facet_count, sizeof(double), "skin of the pad");
    for (int64_t f = 0; err->status == SF_OK && f < skin->facet_count; f++) {
        const double *x[3];
        double *normal = &skin->facet_normal[3 * f];
        sf_corners(skin->rest, &skin->facet[3 * f], x);
        sf_triangle_normal(x[0], x[1], x[2], normal);
        for (int k = 0; k < 3; k++)
            for (int r = 0; r < 3; r++)
                skin->normal[3 * (int64_t)skin->facet[3 * f + k] + r] += normal[r];
        sf_unit3(normal);
    }
    for (int64_t p = skin->nodes; err->status == SF_OK && p < skin->count; p++)
        memcpy(&skin->normal[3 * p], &skin->facet_normal[3 * (int64_t)skin->own[p - skin->nodes]],
               3 * sizeof *skin->normal);
    for (int64_t p = 0; err->status == SF_OK && p < skin->count; p++)
        sf_unit3(&skin->normal[3 * p]);
    return err->status;
}

static int64_t corner_at(const sf_skin *skin, int64_t facet, int64_t node) {
    int64_t corner = 3 * facet;
    while (skin->facet[corner] != node)
        corner++;
    return corner;
}

static const double SHARP = 0.64; /* cosine of the angle between the normals */

/* True if two facets at one node share an edge that is not sharp. */
static bool go_on_smoothly(const sf_skin *skin, int64_t f, int64_t g) {
    int shared = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            shared += skin->facet[3 * f + a] == skin->facet[3 * g + b];
    return shared > 1 && sf_dot3(&skin->facet_normal[3 * f], &skin->facet_normal[3 * g]) > SHARP;
}

/* Parts the corners of the pad's facets at each node into sides. */
static sf_status part_sides(sf_skin *skin, sf_error *err) {
    enum { MOST_FACETS = 1000 };
    int64_t corners = 3 * skin->facet_count, sides = skin->count;
    SF_OWNED int64_t *parent = sf_sets_alone(corners, "skin of the pad", err);
    SF_TRY(SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->side, corners),
                        SF_ROOM(skin->next_side, (unsigned long)(corners + sides))));
    memset(skin->next_side, -1, (size_t)(corners + sides) * sizeof *skin->next_side);
    memcpy(skin->side, skin->facet, (size_t)corners * sizeof *skin->side);
    for (int64_t p = 0; p < skin->moving; p++) {
        int64_t last = -1, end = skin->ring_ptr[p + 1];
        if (end - skin->ring_ptr[p] > MOST_FACETS)
            return SF_FAIL(err, SF_ERR_MODEL, "%lld triangles of the pad's skin share a node, more than %d",
                           (long long)(end - skin->ring_ptr[p]), MOST_FACETS);
        for (int64_t e = skin->ring_ptr[p]; e < end; e++)
            for (int64_t other = e + 1; other < end; other++)
                if (go_on_smoothly(skin, skin->ring[e], skin->ring[other]))
                    sf_sets_join(parent, corner_at(skin, skin->ring[e], p),
                                 corner_at(skin, skin->ring[other], p));
        for (int64_t e = skin->ring_ptr[p]; e < end; e++) {
            int64_t corner = corner_at(skin, skin->ring[e], p), first = sf_sets_find(parent, corner);
            if (first != corner) {
                skin->side[corner] = skin->side[first];
                continue;
            }
            skin->side[corner] = (int32_t)(last < 0 ? p : sides++);
            if (last >= 0)
                skin->next_side[last] = skin->side[corner];
            last = skin->side[corner];
        }
    }
    return SF_OK;
}

static sf_status mark_held(const sf_model *m, sf_skin *skin, sf_error *err) {
    static const double ON_PLANE = 1e-6; /* of the thickness */
    SF_OWNED uint8_t *mark = sf_alloc(err, m->node_count, 1, "skin of the pad");
    SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->held, skin->count), SF_ROOM(skin->rests, skin->count));
    for (int64_t k = 0; err->status == SF_OK && k < m->fixed_count; k++)
        mark[m->fixed_node[k]] = m->fixed_mask[k];
    for (int64_t k = 0; err->status == SF_OK && k < m->rest_count; k++)
        mark[m->rest_node[k]] |= 8;
    for (int64_t p = 0; err->status == SF_OK && p < skin->moving; p++) {
        skin->held[p] = mark[skin->node[p]] & 7;
        skin->rests[p] = mark[skin->node[p]] >> 3;
    }
    for (int64_t p = skin->moving; err->status == SF_OK && p < skin->nodes; p++)
        for (int axis = 0; axis < 2; axis++) {
            double place;
            if (sf_symmetry_plane(m, axis, &place) &&
                fabs(skin->rest[3 * p + axis] - place) < ON_PLANE * m->thickness)
                skin->held[p] |= (uint8_t)(1 << axis);
        }
    return err->status;
}

/* Writes an edge, of one or two half edges, to edge [4]. One alone lies in a symmetry plane or at the end of
 * the skin. False: it is not sharp, or not convex. */
static bool take_edge(const sf_skin *skin, const sf_half_edge *half, int64_t count, int32_t edge[4]) {
    int64_t one = half[0].slot, other = half[count - 1].slot;
    const double *normal = &skin->facet_normal[3 * (one / 3)];
    int in = count > 1 ? 0 : skin->held[half->low] & skin->held[half->high];
    double arm[3], beyond[3];
    edge[0] = half->low;
    edge[1] = half->high;
    edge[2] = skin->facet[one - one % 3 + (one + 2) % 3];
    edge[3] = skin->facet[other - other % 3 + (other + 2) % 3];
    for (int r = 0; r < 3; r++) {
        double turned = r == in - 1 ? -1 : 1;
        arm[r] = turned * (skin->rest[3 * (int64_t)edge[3] + r] - skin->rest[3 * (int64_t)edge[0] + r]);
        beyond[r] = turned * skin->facet_normal[3 * (other / 3) + r];
    }
    if (in == SF_FIX_X || in == SF_FIX_Y)
        edge[3] = -in;
    return (count == 2 || edge[3] < 0) && sf_dot3(normal, arm) < 0 && sf_dot3(normal, beyond) <= SHARP;
}

/* Lists the sharp edges of the pad's facets, `count` of them, that are convex. */
static sf_status list_edges(int64_t count, sf_skin *skin, sf_error *err) {
    SF_OWNED sf_half_edge *half = sf_half_edges(count, skin->facet, err);
    SF_TRY(SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(skin->edge, 12 * (unsigned long)count),
                        SF_ROOM(skin->edge_of, 3 * skin->facet_count)));
    memset(skin->edge_of, -1, 3 * (size_t)skin->facet_count * sizeof *skin->edge_of);
    for (int64_t k = 0, end; k < 3 * count && !skin->watched; k = end) {
        end = sf_half_edges_end(half, k, 3 * count);
        if (end - k <= 2 && take_edge(skin, &half[k], end - k, &skin->edge[4 * skin->edge_count]))
            skin->edge_of[half[k].slot] = (int32_t)skin->edge_count++;
    }
    return SF_OK;
}

static void find_planes(const sf_model *m, sf_skin *skin) {
    double low[3], high[3], place;
    sf_box3(m->node_count, m->position, low, high);
    if (m->anvil.depth > 0)
        skin->plane[SF_SKIN_ANVIL] = (sf_skin_plane){2, sf_model_anvil_plane(m, high[2]), 1};
    for (int axis = 0; axis < 2; axis++)
        if (sf_symmetry_plane(m, axis, &place))
            skin->plane[SF_SKIN_SYMMETRY_X + axis] =
                (sf_skin_plane){axis, place, low[axis] < place - 0.5 * skin->spacing ? -1 : 1};
}

/* True if the pad's nodes may miss the support near its node p: at an edge, where the facets round it are no
 * closed ring, and where its radius of curvature is less than two spacings. */
static bool is_narrow(const sf_skin *skin, int64_t p) {
    static const double RADIUS = 2;
    double turn = 0, length = 0, cross[3];
    int32_t other[64];
    int others = 0, facets = (int)(skin->ring_ptr[p + 1] - skin->ring_ptr[p]);
    for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1]; e++) {
        const int32_t *n = &skin->facet[3 * (int64_t)skin->ring[e]];
        sf_cross3(&skin->normal[3 * p], &skin->facet_normal[3 * (int64_t)skin->ring[e]], cross);
        turn = fmax(turn, asin(fmin(1, sqrt(sf_dot3(cross, cross)))));
        for (int k = 0; k < 3; k++) {
            int known = 0;
            length = fmax(length, sf_distance3(&skin->rest[3 * (int64_t)n[k]], &skin->rest[3 * p]));
            while (known < others && other[known] != n[k])
                known++;
            if (n[k] != p && known == others && others < 64)
                other[others++] = n[k];
        }
    }
    return others != facets || 2 * RADIUS * turn * skin->spacing > length;
}

static sf_status mark_passive(sf_skin *skin, sf_error *err) {
    skin->passive = sf_alloc(err, skin->count, 1, "skin of the pad");
    for (int64_t p = skin->moving; err->status == SF_OK && p < skin->count; p++)
        skin->passive[p] = p >= skin->nodes || skin->held[p] != 0 || !is_narrow(skin, p);
    return err->status;
}

/* The rows of the pad's nodes; those of the support and of the centroids are empty. */
static sf_status build_rows(const sf_model *m, sf_skin *skin, sf_error *err) {
    SF_TRY(sf_contact_rows_of_nodes(m, skin->moving, skin->node, &skin->rows, err));
    int64_t *ptr = realloc(skin->rows.ptr, ((size_t)skin->count + 1) * sizeof *ptr);
    if (!ptr)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the skin of the pad");
    skin->rows.ptr = ptr;
    for (int64_t p = skin->moving; p < skin->count; p++)
        ptr[p + 1] = ptr[p];
    return SF_OK;
}

sf_status sf_skin_build(const sf_model *m, sf_skin *skin, sf_error *err) {
    *skin = (sf_skin){.spacing = INFINITY, .alone = m->skin_alone, .watched = m->skin_watched};
    if (m->skin_count == 0)
        return SF_OK;
    if (number_nodes(m, skin, err) != SF_OK || place_nodes(m, skin, err) != SF_OK ||
        list_rings(skin, err) != SF_OK || find_normals(skin, err) != SF_OK ||
        part_sides(skin, err) != SF_OK || mark_held(m, skin, err) != SF_OK ||
        list_edges(m->skin_count, skin, err) != SF_OK || mark_passive(skin, err) != SF_OK ||
        build_rows(m, skin, err) != SF_OK)
        sf_skin_free(skin);
    else if (!skin->alone)
        find_planes(m, skin);
    return err->status;
}

void sf_skin_free(sf_skin *skin) {
    sf_contact_rows_free(&skin->rows);
    SF_CLEAR(skin, skin->node, skin->own, skin->side, skin->next_side, skin->edge, skin->edge_of, skin->rest,
             skin->size, skin->passive, skin->facet, skin->half, skin->ring_ptr, skin->ring, skin->held,
             skin->rests, skin->normal, skin->facet_normal);
}
