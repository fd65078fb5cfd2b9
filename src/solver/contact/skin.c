/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/skin.h"

#include "base/mat3.h"
#include "base/sets.h"

static const char purpose[] = "skin of the pad";

static sf_status number_nodes(const sf_model *m, sf_skin *skin, sf_error *err) {
    int64_t faces = skin->faces = m->skin_count;
    skin->facet_count = faces + m->support_triangle_count;
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->facet, 3 * skin->facet_count),
                        SF_ROOM(skin->half, skin->facet_count)));
    memcpy(skin->facet, m->skin_triangle, 3 * (size_t)faces * sizeof *skin->facet);
    skin->node = sf_list_number(m->node_count, 3 * faces, skin->facet, &skin->moving, purpose, err);
    for (int64_t k = 0; k < 3 * m->support_triangle_count; k++)
        skin->facet[3 * faces + k] = (int32_t)skin->moving + m->support_triangle[k];
    skin->nodes = skin->moving + m->support_node_count;
    skin->count = skin->nodes + sf_model_skin_centroids(m);
    for (int64_t k = 1; k < faces; k++)
        if (sf_model_skin_is_quadrangle(m, k)) {
            skin->half[k - 1] = 1;
            skin->half[k] = 2;
        }
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->own, (unsigned long)(skin->count - skin->nodes))));
    for (int64_t k = 0, used = 0; used < skin->count - skin->nodes; k++)
        if (!skin->half[k])
            skin->own[used++] = (int32_t)k;
    return SF_OK;
}

static sf_status place_nodes(const sf_model *m, sf_skin *skin, sf_error *err) {
    SF_TRY(
        SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->rest, 3 * skin->count), SF_ROOM(skin->size, skin->count)));
    for (int64_t p = 0; p < skin->moving; p++) {
        memcpy(&skin->rest[3 * p], &m->position[3 * (int64_t)skin->node[p]], 3 * sizeof *skin->rest);
        skin->size[p] = m->spacing[skin->node[p]];
        skin->spacing = fmin(skin->spacing, skin->size[p]);
    }
    for (int64_t p = skin->moving; p < skin->nodes; p++) {
        memcpy(&skin->rest[3 * p], &m->support_position[3 * (p - skin->moving)], 3 * sizeof *skin->rest);
        skin->size[p] = skin->spacing;
    }
    for (int64_t p = skin->nodes; p < skin->count; p++) {
        skin->size[p] = INFINITY;
        for (int k = 0; k < 3; k++) {
            int64_t node = sf_skin_member(skin, p, k);
            skin->size[p] = fmin(skin->size[p], skin->size[node]);
            for (int r = 0; r < 3; r++)
                skin->rest[3 * p + r] += skin->rest[3 * node + r] / 3;
        }
    }
    return SF_OK;
}

static sf_status list_rings(sf_skin *skin, sf_error *err) {
    int64_t corners = 3 * skin->facet_count;
    unsigned long all = (unsigned long)(corners + skin->count - skin->nodes);
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->ring_ptr, skin->count + 2), SF_ROOM(skin->ring, all)));
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
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->normal, 3 * skin->count),
                        SF_ROOM(skin->facet_normal, 3 * skin->facet_count)));
    for (int64_t f = 0; f < skin->facet_count; f++) {
        double *normal = &skin->facet_normal[3 * f];
        sf_face_normal(skin->rest, &skin->facet[3 * f], normal);
        for (int k = 0; k < 3; k++)
            for (int r = 0; r < 3; r++)
                skin->normal[3 * (int64_t)skin->facet[3 * f + k] + r] += normal[r];
        sf_unit3(normal);
    }
    for (int64_t p = 0; p < skin->count; p++)
        if (p < skin->nodes)
            sf_unit3(&skin->normal[3 * p]);
        else
            memcpy(&skin->normal[3 * p], &skin->facet_normal[3 * (int64_t)skin->own[p - skin->nodes]],
                   3 * sizeof *skin->normal);
    return SF_OK;
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
    SF_OWNED int64_t *parent = sf_sets_alone(corners, purpose, err);
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->side, corners),
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

int sf_skin_planes_at(const sf_skin *skin, const double x[3]) {
    int in = 0;
    for (int r = 0; r < 2; r++)
        in |= (fabs(x[r] - skin->plane[r]) < skin->on_plane) << r;
    return in;
}

static sf_skin begin(const sf_model *m) {
    static const double ON_PLANE = 1e-6; /* of the thickness */
    sf_skin skin = {.spacing = INFINITY, .on_plane = ON_PLANE * m->thickness};
    for (int r = 0; r < 2; r++)
        skin.plane[r] = sf_symmetry_plane(m, r, &skin.plane[r]) ? skin.plane[r] : NAN;
    return skin;
}

/* Marks how nodes are held, and the planes that may stop those of the pad: not if they are held there, or
 * rest on the anvil already. */
static sf_status mark_held(const sf_model *m, sf_skin *skin, sf_error *err) {
    SF_OWNED uint8_t *rests = sf_alloc(err, m->node_count, 1, purpose);
    SF_OWNED uint8_t *held = sf_alloc(err, m->node_count, 1, purpose);
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->held, skin->count), SF_ROOM(skin->touches, skin->count)));
    for (int64_t k = 0; k < m->fixed_count; k++)
        held[m->fixed_node[k]] = m->fixed_mask[k];
    for (int64_t k = 0; k < m->rest_count; k++)
        rests[m->rest_node[k]] = 1;
    for (int64_t p = 0; p < skin->nodes; p++) {
        bool moves = p < skin->moving;
        skin->held[p] = moves ? held[skin->node[p]] : (uint8_t)sf_skin_planes_at(skin, &skin->rest[3 * p]);
        if (!moves || skin->alone)
            continue;
        bool anvil = m->anvil.depth > 0 && !(skin->held[p] & SF_FIX_Z) && !rests[skin->node[p]];
        skin->touches[p] = (uint8_t)(anvil << SF_BODY_ANVIL);
        for (int r = 0; r < 2; r++)
            if (!isnan(skin->plane[r]) && !(skin->held[p] >> r & 1))
                skin->touches[p] |= (uint8_t)(1 << (SF_BODY_SYMMETRY_X + r));
    }
    return SF_OK;
}

/* The symmetry plane that the line lies in, 1 normal to x or 2 to y, beyond which its one face goes on; 0:
 * none. Of a line in both it is the one that bounds the foam behind the face. */
static int plane_of(const sf_skin *skin, const int32_t line[3]) {
    double normal[3], arm[3];
    int in = sf_skin_planes_at(skin, &skin->rest[3 * (int64_t)line[0]]) &
             sf_skin_planes_at(skin, &skin->rest[3 * (int64_t)line[1]]);
    if (in < 3)
        return in;
    sf_face_normal(skin->rest, line, normal);
    sf_sub3(&skin->rest[3 * (int64_t)line[2]], &skin->rest[3 * (int64_t)line[0]], arm);
    return normal[0] * arm[0] < normal[1] * arm[1] ? 2 : 1;
}

/* True if the faces at a line, of two half edges or one in a symmetry plane, are sharp and convex. */
static bool is_convex(const sf_skin *skin, const int32_t line[4], int64_t one, int64_t other) {
    const double *normal = &skin->facet_normal[3 * (one / 3)];
    double arm[3], beyond[3];
    sf_skin_third(skin->rest, line, 3, arm);
    memcpy(beyond, &skin->facet_normal[3 * (other / 3)], sizeof beyond);
    if (line[3] < 0)
        beyond[-1 - line[3]] *= -1;
    return sf_dot3(normal, arm) < 0 && sf_dot3(normal, beyond) <= SHARP;
}

static sf_status alloc_lines(sf_skin *skin, int64_t most, sf_error *err) {
    SF_TRY(SF_ALLOC_ALL(err, "edges of the pad", SF_ROOM(skin->line, 4 * (most + 1)),
                        SF_ROOM(skin->line_of, 3 * skin->facet_count)));
    memset(skin->line_of, -1, 3 * (size_t)skin->facet_count * sizeof *skin->line_of);
    return SF_OK;
}

/* Lists the edges of two faces that are sharp, or those that are not; in a symmetry plane the second face is
 * the mirror image of the first. */
static void list_lines_if(sf_skin *skin, const sf_half_edge *half, bool sharp) {
    bool parts = skin->facet_normal && !skin->watched;
    int64_t count = 3 * skin->faces;
    for (int64_t k = 0, end; k < count; k = end) {
        end = sf_half_edges_end(half, k, count);
        int64_t one = half[k].slot, other = half[end - 1].slot;
        int32_t *line = &skin->line[4 * skin->line_count];
        for (int of = 0; of < 3; of++)
            line[of] = skin->facet[one - one % 3 + (one + of) % 3];
        int plane = end == k + 1 ? plane_of(skin, line) : 0;
        if (end != k + 2 && plane == 0)
            continue;
        line[3] = plane > 0 ? -plane : skin->facet[other - other % 3 + (other + 2) % 3];
        if ((parts && is_convex(skin, line, one, other)) == sharp)
            skin->line_of[one] = (int32_t)skin->line_count++;
    }
}

static sf_status list_lines(sf_skin *skin, sf_error *err) {
    SF_OWNED sf_half_edge *half = sf_half_edges(skin->faces, skin->facet, err);
    SF_TRY(alloc_lines(skin, 3 * skin->faces, err));
    list_lines_if(skin, half, true);
    skin->sharp_count = skin->line_count;
    list_lines_if(skin, half, false);
    return SF_OK;
}

/* Lists the sides of a section. */
static sf_status list_sides(sf_skin *skin, sf_error *err) {
    SF_TRY(alloc_lines(skin, skin->faces, err));
    for (; skin->line_count < skin->faces; skin->line_count++) {
        const int32_t *side = &skin->facet[3 * skin->line_count];
        memcpy(&skin->line[4 * skin->line_count],
               (const int32_t[4]){side[0], side[1], SF_NO_FACES, SF_NO_FACES}, 4 * sizeof *side);
        skin->line_of[3 * skin->line_count] = (int32_t)skin->line_count;
    }
    return SF_OK;
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
    SF_TRY(SF_ALLOC_ALL(err, purpose, SF_ROOM(skin->passive, skin->count)));
    for (int64_t p = skin->moving; p < skin->count; p++)
        skin->passive[p] = p >= skin->nodes || skin->held[p] != 0 || !is_narrow(skin, p);
    return SF_OK;
}

/* The rows of the pad's nodes; those of the support and of the centroids are empty. */
static sf_status build_rows(const sf_model *m, sf_skin *skin, sf_error *err) {
    SF_TRY(sf_point_rows_build(m, skin->moving, skin->node, &skin->rows, err));
    int64_t *ptr = realloc(skin->rows.ptr, ((size_t)skin->count + 1) * sizeof *ptr);
    if (!ptr)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the skin of the pad");
    skin->rows.ptr = ptr;
    for (int64_t p = skin->moving; p < skin->count; p++)
        ptr[p + 1] = ptr[p];
    return SF_OK;
}

sf_status sf_skin_build(const sf_model *m, sf_skin *skin, sf_error *err) {
    *skin = begin(m);
    skin->alone = m->skin_alone;
    skin->watched = m->skin_watched;
    if (m->skin_count == 0)
        return SF_OK;
    if (number_nodes(m, skin, err) != SF_OK || place_nodes(m, skin, err) != SF_OK ||
        list_rings(skin, err) != SF_OK || find_normals(skin, err) != SF_OK ||
        part_sides(skin, err) != SF_OK || mark_held(m, skin, err) != SF_OK ||
        list_lines(skin, err) != SF_OK || mark_passive(skin, err) != SF_OK ||
        build_rows(m, skin, err) != SF_OK)
        sf_skin_free(skin);
    return err->status;
}

static sf_status build_contact(const sf_model *m, sf_skin *skin, sf_error *err) {
    int64_t count = skin->count = skin->nodes = skin->moving = sf_model_points(m);
    skin->faces = skin->facet_count = m->contact_face_count;
    SF_TRY(SF_ALLOC_ALL(err, "contact points", SF_ROOM(skin->node, count), SF_ROOM(skin->rest, 3 * count),
                        SF_ROOM(skin->size, count), SF_ROOM(skin->touches, count),
                        SF_ROOM(skin->facet, 3 * skin->faces)));
    for (int64_t c = 0; c < count; c++) {
        int64_t node = skin->node[c] = (int32_t)sf_model_point_node(m, c);
        memcpy(&skin->rest[3 * c], &m->position[3 * node], 3 * sizeof *skin->rest);
        skin->size[c] = m->spacing[node];
        bool rests = sf_model_point_rests(m, c);
        skin->touches[c] = (uint8_t)(1 << (rests ? SF_BODY_ANVIL : SF_BODY_MISSILE));
        skin->spacing = rests ? skin->spacing : fmin(skin->spacing, skin->size[c]);
    }
    for (int64_t k = 0; k < 3 * skin->faces; k++)
        skin->facet[k] = (int32_t)sf_list_find(m->contact_node, 0, m->contact_count, m->contact_face[k]);
    if (skin->faces > 0)
        SF_TRY(m->axisymmetric ? list_sides(skin, err) : list_lines(skin, err));
    return sf_point_rows_build(m, count, skin->node, &skin->rows, err);
}

sf_status sf_skin_build_contact(const sf_model *m, sf_skin *skin, sf_error *err) {
    *skin = begin(m);
    if (build_contact(m, skin, err) != SF_OK)
        sf_skin_free(skin);
    return err->status;
}

void sf_skin_free(sf_skin *skin) {
    sf_point_rows_free(&skin->rows);
    SF_CLEAR(skin, skin->node, skin->own, skin->side, skin->next_side, skin->line, skin->line_of, skin->rest,
             skin->size, skin->passive, skin->facet, skin->half, skin->ring_ptr, skin->ring, skin->held,
             skin->touches, skin->normal, skin->facet_normal);
}
