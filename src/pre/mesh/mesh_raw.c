/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh_raw.h"

#include "pre/mesh/cell_topology.h"

#include <stdlib.h>
#include <string.h>

void sf_raw_mesh_free(sf_raw_mesh *raw) {
    free(raw->tag);
    free(raw->xyz);
    free(raw->cell_type);
    free(raw->cell_chosen);
    free(raw->cell_node);
    free(raw->face_group);
    free(raw->face_part);
    free(raw->face_node);
    for (int g = 0; g < raw->group_count; g++)
        free(raw->group_name[g]);
    free(raw->group_name);
    memset(raw, 0, sizeof *raw);
}

/* Makes room for `capacity` items in *array. */
static bool grow(void *array, size_t capacity, size_t size) {
    void *old;
    memcpy(&old, array, sizeof old);
    void *block = realloc(old, capacity * size);
    if (block)
        memcpy(array, &block, sizeof block);
    return block != NULL;
}

sf_status sf_raw_mesh_add_cell(sf_raw_mesh *raw, int type, int chosen, const size_t *node, int count,
                               sf_error *err) {
    if (raw->cell_count == raw->cell_capacity) {
        size_t capacity = raw->cell_capacity ? 2 * raw->cell_capacity : 4096;
        if (!grow(&raw->cell_type, capacity, sizeof *raw->cell_type) ||
            !grow(&raw->cell_chosen, capacity, sizeof *raw->cell_chosen) ||
            !grow(&raw->cell_node, capacity, SF_RAW_CELL * sizeof *raw->cell_node))
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %zu mesh cells", capacity);
        raw->cell_capacity = capacity;
    }
    size_t k = raw->cell_count++;
    raw->cell_type[k] = (uint8_t)type;
    raw->cell_chosen[k] = (uint8_t)chosen;
    for (int a = 0; a < SF_RAW_CELL; a++)
        raw->cell_node[SF_RAW_CELL * k + (size_t)a] = a < count ? node[a] : 0;
    return SF_OK;
}

sf_status sf_raw_mesh_add_face(sf_raw_mesh *raw, int32_t group, int32_t part, const size_t *node, int count,
                               sf_error *err) {
    if (raw->face_count == raw->face_capacity) {
        size_t capacity = raw->face_capacity ? 2 * raw->face_capacity : 4096;
        if (!grow(&raw->face_group, capacity, sizeof *raw->face_group) ||
            !grow(&raw->face_part, capacity, sizeof *raw->face_part) ||
            !grow(&raw->face_node, capacity, SF_RAW_FACE * sizeof *raw->face_node))
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %zu mesh faces", capacity);
        raw->face_capacity = capacity;
    }
    size_t k = raw->face_count++;
    raw->face_group[k] = group;
    raw->face_part[k] = part;
    for (int a = 0; a < SF_RAW_FACE; a++)
        raw->face_node[SF_RAW_FACE * k + (size_t)a] = a < count ? node[a] : 0;
    return SF_OK;
}

static int compare_tag(const void *a, const void *b) {
    const sf_tag_index *p = a, *q = b;
    return p->tag < q->tag ? -1 : p->tag > q->tag;
}

sf_tag_index *sf_raw_mesh_index(const sf_raw_mesh *raw, sf_error *err) {
    sf_tag_index *index = sf_alloc(err, raw->node_count, sizeof *index, "node tags");
    if (!index)
        return NULL;
    for (size_t n = 0; n < raw->node_count; n++)
        index[n] = (sf_tag_index){raw->tag[n], n};
    qsort(index, raw->node_count, sizeof *index, compare_tag);
    return index;
}

size_t sf_raw_mesh_find(const sf_raw_mesh *raw, const sf_tag_index *index, size_t tag) {
    sf_tag_index wanted = {tag, 0};
    const sf_tag_index *found = bsearch(&wanted, index, raw->node_count, sizeof *index, compare_tag);
    return found ? found->place : SIZE_MAX;
}

static int cell_vertices(const sf_raw_mesh *raw, size_t cell) {
    return sf_cell_topology_of(raw->cell_type[cell])->vertices;
}

void sf_raw_face_sort(size_t tag[SF_RAW_FACE]) {
    for (int i = 1; i < SF_RAW_FACE; i++)
        for (int j = i; j > 0 && tag[j] < tag[j - 1]; j--) {
            size_t swap = tag[j];
            tag[j] = tag[j - 1];
            tag[j - 1] = swap;
        }
}

int sf_raw_face_compare(const size_t a[SF_RAW_FACE], const size_t b[SF_RAW_FACE]) {
    for (int i = 0; i < SF_RAW_FACE; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

int sf_raw_mesh_face_size(const sf_raw_mesh *raw, size_t face) {
    return raw->face_node[SF_RAW_FACE * face + 3] != 0 ? 4 : 3;
}

enum { UNUSED = -1, OTHER = -2 };

/* Numbers the nodes of the chosen cells from 0 in the order of `tag`; others get UNUSED, or OTHER if some
 * other cell uses them. `number` is [node_count], by place. */
static sf_status number_nodes(const sf_raw_mesh *raw, const sf_tag_index *index, int32_t *number,
                              sf_mesh *mesh, sf_error *err) {
    for (size_t n = 0; n < raw->node_count; n++)
        number[n] = UNUSED;
    for (size_t k = 0; k < raw->cell_count; k++) {
        for (int a = 0; a < cell_vertices(raw, k); a++) {
            size_t tag = raw->cell_node[SF_RAW_CELL * k + (size_t)a];
            size_t place = sf_raw_mesh_find(raw, index, tag);
            if (place == SIZE_MAX)
                return SF_FAIL(err, SF_ERR_INPUT, "a cell uses node %zu, which the mesh does not have", tag);
            if (raw->cell_chosen[k])
                number[place] = 0;
            else if (number[place] == UNUSED)
                number[place] = OTHER;
        }
    }
    for (size_t n = 0; n < raw->node_count; n++) {
        mesh->orphan_count += number[n] == UNUSED;
        if (number[n] == 0)
            number[n] = (int32_t)mesh->node_count++;
    }
    return SF_OK;
}

static sf_status copy_cells(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number,
                            int layers, double unit, sf_mesh *mesh, sf_error *err) {
    int64_t entries = 0;
    for (size_t k = 0; k < raw->cell_count; k++) {
        mesh->cell_count += raw->cell_chosen[k] > 0;
        entries += raw->cell_chosen[k] ? cell_vertices(raw, k) : 0;
    }
    mesh->position = sf_alloc(err, 3 * (size_t)mesh->node_count, sizeof *mesh->position, "mesh positions");
    mesh->cell_type = sf_alloc(err, (size_t)mesh->cell_count, sizeof *mesh->cell_type, "cell types");
    mesh->cell_ptr = sf_alloc(err, (size_t)mesh->cell_count + 1, sizeof *mesh->cell_ptr, "cell list");
    mesh->cell_node = sf_alloc(err, (size_t)entries, sizeof *mesh->cell_node, "cell vertices");
    if (layers > 1)
        mesh->cell_layer = sf_alloc(err, (size_t)mesh->cell_count, 1, "layers of the cells");
    if (err->status != SF_OK)
        return err->status;
    for (size_t n = 0; n < raw->node_count; n++)
        for (size_t i = 0; number[n] >= 0 && i < 3; i++)
            mesh->position[3 * (size_t)number[n] + i] = unit * raw->xyz[3 * n + i];
    int64_t cell = 0;
    for (size_t k = 0; k < raw->cell_count; k++) {
        if (!raw->cell_chosen[k])
            continue;
        int count = cell_vertices(raw, k);
        mesh->cell_type[cell] = raw->cell_type[k];
        if (layers > 1)
            mesh->cell_layer[cell] = raw->cell_chosen[k] - 1;
        for (int a = 0; a < count; a++)
            mesh->cell_node[mesh->cell_ptr[cell] + a] =
                number[sf_raw_mesh_find(raw, index, raw->cell_node[SF_RAW_CELL * k + (size_t)a])];
        mesh->cell_ptr[cell + 1] = mesh->cell_ptr[cell] + count;
        cell++;
    }
    return SF_OK;
}

static void sort_face(int32_t node[SF_RAW_FACE]) {
    for (int i = 1; i < SF_RAW_FACE; i++)
        for (int j = i; j > 0 && node[j] < node[j - 1]; j--) {
            int32_t swap = node[j];
            node[j] = node[j - 1];
            node[j - 1] = swap;
        }
}

/* Marks the nodes of the group's faces that lie wholly in the chosen cells, and writes these faces to the
 * set; returns how many nodes. */
static int64_t mark_group(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number, int group,
                          uint8_t *mark, sf_node_set *set) {
    int64_t marked = 0;
    for (size_t f = 0; f < raw->face_count; f++) {
        int32_t node[SF_RAW_FACE] = {-1, -1, -1, -1};
        int count = raw->face_group[f] == group ? sf_raw_mesh_face_size(raw, f) : 0;
        bool whole = count > 0;
        for (int a = 0; a < count; a++) {
            size_t place = sf_raw_mesh_find(raw, index, raw->face_node[SF_RAW_FACE * f + (size_t)a]);
            node[a] = place == SIZE_MAX ? UNUSED : number[place];
            whole = whole && node[a] >= 0;
        }
        set->left_out += count > 0 && !whole;
        for (int a = 0; whole && a < count; a++) {
            marked += !mark[node[a]];
            mark[node[a]] = 1;
        }
        sort_face(node);
        if (whole)
            memcpy(&set->face[SF_RAW_FACE * set->face_count++], node, sizeof node);
    }
    return marked;
}

static int64_t count_faces(const sf_raw_mesh *raw, int group) {
    int64_t count = 0;
    for (size_t f = 0; f < raw->face_count; f++)
        count += raw->face_group[f] == group;
    return count;
}

static sf_status build_sets(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number,
                            sf_mesh *mesh, sf_error *err) {
    uint8_t *mark = sf_alloc(err, (size_t)mesh->node_count, 1, "node marks");
    mesh->set = sf_alloc(err, (size_t)raw->group_count, sizeof *mesh->set, "node sets");
    for (int g = 0; mark && mesh->set && g < raw->group_count && err->status == SF_OK; g++) {
        sf_node_set *set = &mesh->set[mesh->set_count];
        *set = (sf_node_set){0};
        memset(mark, 0, (size_t)mesh->node_count);
        set->face =
            sf_alloc(err, SF_RAW_FACE * (size_t)count_faces(raw, g), sizeof *set->face, "surface faces");
        int64_t count = set->face ? mark_group(raw, index, number, g, mark, set) : 0;
        if (count == 0) {
            free(set->face);
            set->face = NULL;
            continue;
        }
        mesh->set_count++;
        set->name = strdup(raw->group_name[g]);
        set->node = sf_alloc(err, (size_t)count, sizeof *set->node, "node set");
        if (!set->name)
            SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the node set %s", raw->group_name[g]);
        for (int32_t n = 0; set->node && n < mesh->node_count; n++)
            if (mark[n])
                set->node[set->count++] = n;
    }
    free(mark);
    return err->status;
}

sf_status sf_mesh_assemble(const sf_raw_mesh *raw, int layers, double unit, sf_mesh *mesh, sf_error *err) {
    memset(mesh, 0, sizeof *mesh);
    int32_t *number = NULL;
    sf_tag_index *index = NULL;
    if (raw->node_count > INT32_MAX)
        return SF_FAIL(err, SF_ERR_INPUT, "the mesh has %zu nodes; at most %d are supported", raw->node_count,
                       INT32_MAX);
    index = sf_raw_mesh_index(raw, err);
    number = sf_alloc(err, raw->node_count, sizeof *number, "node numbers");
    if (err->status == SF_OK && number_nodes(raw, index, number, mesh, err) == SF_OK &&
        copy_cells(raw, index, number, layers, unit, mesh, err) == SF_OK)
        build_sets(raw, index, number, mesh, err);
    if (err->status == SF_OK)
        sf_mesh_orient(mesh);
    else
        sf_mesh_free(mesh);
    free(number);
    free(index);
    return err->status;
}
