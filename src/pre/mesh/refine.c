/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/refine.h"

#include "base/sets.h"
#include "model/model.h"
#include <string.h>

/* A side of a cell; its place among the sides that differ is the number of its middle. */
typedef struct side {
    int32_t low, high; /* nodes */
} side;

SF_ORDER_BY(by_nodes, side, low, high)

static side side_of(int32_t a, int32_t b) {
    return (side){a < b ? a : b, a < b ? b : a};
}

static bool is_split(const uint8_t *marked, int64_t cell) {
    return !marked || marked[cell];
}

/* The sides of the marked cells (NULL: of all), each once, ascending: [*count], owned by the caller. */
static side *list_sides(const sf_mesh *m, const uint8_t *marked, int64_t *count, sf_error *err) {
    int64_t all = 0, kept = 0;
    side *list = sf_alloc(err, m->cell_ptr[m->cell_count], sizeof *list, "sides of a section");
    for (int64_t c = 0; list && c < m->cell_count; c++)
        for (int64_t k = m->cell_ptr[c], end = m->cell_ptr[c + 1]; k < end && is_split(marked, c); k++)
            list[all++] = side_of(m->cell_node[k], m->cell_node[k + 1 < end ? k + 1 : m->cell_ptr[c]]);
    if (!list)
        return NULL;
    qsort(list, (size_t)all, sizeof *list, by_nodes);
    for (int64_t k = 0; k < all; k++)
        if (kept == 0 || by_nodes(&list[kept - 1], &list[k]) != 0)
            list[kept++] = list[k];
    *count = kept;
    return list;
}

/* A section, its sides, and where the middles of quadrangles begin. */
typedef struct halving {
    const sf_mesh *from;
    const uint8_t *marked; /* [cells] 1: is split; NULL: all are */
    side *list;            /* [sides] owned */
    int64_t sides, centres /* quadrangles so far */;
} halving;

/* The node in the middle of a side; -1: it has none. */
static int32_t middle_of(const halving *h, int32_t a, int32_t b) {
    const side key = side_of(a, b);
    const side *found = bsearch(&key, h->list, (size_t)h->sides, sizeof key, by_nodes);
    return found ? (int32_t)(h->from->node_count + (found - h->list)) : -1;
}

static void add_cell(sf_mesh *to, uint8_t type, uint8_t layer, const int32_t *node, int64_t vertices) {
    int64_t c = to->cell_count++;
    to->cell_type[c] = type;
    to->cell_ptr[c + 1] = to->cell_ptr[c] + vertices;
    memcpy(&to->cell_node[to->cell_ptr[c]], node, (size_t)vertices * sizeof *node);
    if (to->cell_layer)
        to->cell_layer[c] = layer;
}

/* The four parts of a cell: one at each vertex, and of a triangle the one between the middles. */
static void split_cell(halving *h, int64_t c, sf_mesh *to) {
    const sf_mesh *m = h->from;
    const int32_t *v = &m->cell_node[m->cell_ptr[c]];
    int vertices = (int)(m->cell_ptr[c + 1] - m->cell_ptr[c]);
    uint8_t layer = m->cell_layer ? m->cell_layer[c] : 0;
    int32_t middle[4] = {0}, centre = (int32_t)(m->node_count + h->sides + h->centres);
    for (int k = 0; k < vertices; k++)
        middle[k] = middle_of(h, v[k], v[(k + 1) % vertices]);
    for (int k = 0; k < vertices; k++) {
        const int32_t part[4] = {v[k], middle[k], vertices == 4 ? centre : middle[(k + 2) % 3],
                                 middle[(k + 3) % 4]}; /* the last of a quadrangle only */
        add_cell(to, m->cell_type[c], layer, part, vertices);
    }
    if (vertices == 3) {
        add_cell(to, m->cell_type[c], layer, middle, 3);
        return;
    }
    for (int a = 0; a < 3; a++) {
        double sum = 0;
        for (int k = 0; k < 4; k++)
            sum += m->position[3 * (int64_t)v[k] + a];
        to->position[3 * (int64_t)centre + a] = sum / 4;
    }
    h->centres++;
}

/* The triangles of a cell beside marked ones, from the first middle of its sides on; the cell itself if there
 * is none. */
static void close_cell(const halving *h, int64_t c, sf_mesh *to) {
    const sf_mesh *m = h->from;
    const int32_t *v = &m->cell_node[m->cell_ptr[c]];
    int vertices = (int)(m->cell_ptr[c + 1] - m->cell_ptr[c]), count = 0, first = -1;
    uint8_t layer = m->cell_layer ? m->cell_layer[c] : 0;
    int32_t ring[8];
    for (int k = 0; k < vertices; k++) {
        int32_t middle = middle_of(h, v[k], v[(k + 1) % vertices]);
        ring[count++] = v[k];
        if (middle < 0)
            continue;
        first = first < 0 ? count : first;
        ring[count++] = middle;
    }
    if (first < 0) {
        add_cell(to, m->cell_type[c], layer, v, vertices);
        return;
    }
    for (int k = 1; k + 1 < count; k++) {
        const int32_t part[3] = {ring[first], ring[(first + k) % count], ring[(first + k + 1) % count]};
        add_cell(to, SF_CELL_TRIANGLE, layer, part, 3);
    }
}

static sf_status split_set(const halving *h, const sf_node_set *from, sf_node_set *to, sf_error *err) {
    SF_TRY(SF_ALLOC_ALL(err, "a set of the section", SF_ROOM(to->node, from->count + from->face_count),
                        SF_ROOM(to->face, 8 * from->face_count)));
    if (!(to->name = strdup(from->name)))
        return SF_NO_MEMORY(err, "a set of the section");
    memcpy(to->node, from->node, (size_t)from->count * sizeof *to->node);
    to->count = from->count;
    for (int64_t f = 0; f < from->face_count; f++) {
        int32_t a = from->face[4 * f + 2], b = from->face[4 * f + 3], middle = middle_of(h, a, b);
        if (middle < 0 && !h->marked)
            return SF_REFUSE(err, "the group \"%s\" has a side that no cell of the section has", from->name);
        const int32_t halves[8] = {-1, -1, a, middle < 0 ? b : middle, -1, -1, b, middle};
        int64_t parts = middle < 0 ? 1 : 2;
        memcpy(&to->face[4 * to->face_count], halves, 4 * (size_t)parts * sizeof *halves);
        to->face_count += parts;
        if (middle >= 0)
            to->node[to->count++] = middle;
    }
    qsort(to->node, (size_t)to->count, sizeof *to->node, sf_by_number);
    return SF_OK;
}

static sf_status split(halving *h, sf_mesh *to, sf_error *err) {
    const sf_mesh *m = h->from;
    int64_t entries = 5 * m->cell_ptr[m->cell_count], cells = 6 * m->cell_count;
    SF_TRY(SF_ALLOC_ALL(err, "the finer section",
                        SF_ROOM(to->position, 3 * (m->node_count + h->sides + m->cell_count)),
                        SF_ROOM(to->cell_type, cells), SF_ROOM(to->cell_ptr, cells + 1),
                        SF_ROOM(to->cell_node, entries), SF_ROOM(to->set, m->set_count)));
    if (m->cell_layer)
        to->cell_layer = sf_alloc(err, cells, sizeof *to->cell_layer, "the finer section");
    SF_TRY(err->status);
    memcpy(to->position, m->position, 3 * (size_t)m->node_count * sizeof *to->position);
    for (int64_t k = 0; k < 3 * h->sides; k++)
        to->position[3 * m->node_count + k] = 0.5 * (m->position[3 * (int64_t)h->list[k / 3].low + k % 3] +
                                                     m->position[3 * (int64_t)h->list[k / 3].high + k % 3]);
    for (int64_t c = 0; c < m->cell_count; c++)
        if (is_split(h->marked, c))
            split_cell(h, c, to);
        else
            close_cell(h, c, to);
    to->node_count = m->node_count + h->sides + h->centres;
    for (; to->set_count < m->set_count && err->status == SF_OK; to->set_count++)
        split_set(h, &m->set[to->set_count], &to->set[to->set_count], err);
    return err->status;
}

sf_status sf_section_refine(const sf_mesh *section, const uint8_t *marked, sf_mesh *fine, sf_error *err) {
    halving h = {.from = section, .marked = marked};
    if ((h.list = list_sides(section, marked, &h.sides, err)))
        split(&h, fine, err);
    if (err->status != SF_OK)
        sf_mesh_free(fine);
    free(h.list);
    return err->status;
}

sf_status sf_surface_copy(const sf_surface *from, sf_surface *copy, sf_error *err) {
    int64_t nodes = from->node_count, triangles = from->triangle_count;
    *copy = (sf_surface){.node_count = nodes, .triangle_count = triangles};
    memcpy(copy->origin, from->origin, sizeof copy->origin);
    SF_ALLOC_ALL(err, "a missile's surface", SF_ROOM(copy->position, 3 * nodes),
                 SF_ROOM(copy->triangle, 3 * triangles));
    if (from->solid)
        copy->solid = sf_alloc(err, triangles, sizeof *copy->solid, "a missile's surface");
    if (err->status != SF_OK) {
        sf_surface_free(copy);
        return err->status;
    }
    memcpy(copy->position, from->position, 3 * (size_t)nodes * sizeof *copy->position);
    if (triangles > 0) /* of a profile there are none */
        memcpy(copy->triangle, from->triangle, 3 * (size_t)triangles * sizeof *copy->triangle);
    if (from->solid)
        memcpy(copy->solid, from->solid, (size_t)triangles * sizeof *copy->solid);
    return SF_OK;
}
