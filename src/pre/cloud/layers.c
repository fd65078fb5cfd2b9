/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/layers.h"

#include "base/mat3.h"
#include "base/sets.h"

enum { ALL = SF_FIX_X | SF_FIX_Y | SF_FIX_Z };

static const double ALONG_AXIS = 1e-6; /* of a normal: the part across the axis */

static int layer_of(const sf_mesh *mesh, int64_t cell) {
    return mesh->cell_layer ? mesh->cell_layer[cell] : 0;
}

/* ---- nodes ---- */

/* The layers whose cells use a node, as a row of marks. */
static uint8_t *mark_layers(const sf_mesh *mesh, int count, sf_error *err) {
    uint8_t *used = sf_alloc(err, (unsigned long)mesh->node_count * (unsigned long)count, 1, "layers");
    for (int64_t k = 0; used && k < mesh->cell_count; k++)
        for (int64_t v = mesh->cell_ptr[k]; v < mesh->cell_ptr[k + 1]; v++)
            used[(int64_t)mesh->cell_node[v] * count + layer_of(mesh, k)] = 1;
    return used;
}

static sf_status number_nodes(const sf_mesh *mesh, const uint8_t *used, sf_layers *l, sf_error *err) {
    unsigned long n = (unsigned long)mesh->node_count;
    SF_ALLOC_ALL(err, "layers", SF_ROOM(l->first, l->count + 1), SF_ROOM(l->copy_ptr, n + 1));
    for (int64_t k = 0; err->status == SF_OK && k < mesh->node_count * l->count; k++)
        l->first[k % l->count + 1] += used[k];
    for (int k = 0; err->status == SF_OK && k < l->count; k++)
        l->first[k + 1] += l->first[k];
    unsigned long all = err->status == SF_OK ? (unsigned long)l->first[l->count] : 0;
    if (all > INT32_MAX)
        return SF_REFUSE(err, "the layers have %lu nodes" SF_AT_MOST("%d"), all, INT32_MAX);
    SF_ALLOC_ALL(err, "layers", SF_ROOM(l->origin, all), SF_ROOM(l->copy, all));
    SF_OWNED int64_t *next = sf_alloc(err, l->count, sizeof *next, "layers");
    int64_t copies = 0;
    if (err->status == SF_OK)
        memcpy(next, l->first, (size_t)l->count * sizeof *next);
    for (int64_t i = 0; err->status == SF_OK && i < mesh->node_count; i++) {
        for (int k = 0; k < l->count; k++)
            if (used[i * l->count + k]) {
                l->origin[next[k]] = (int32_t)i;
                l->copy[copies++] = (int32_t)next[k]++;
            }
        l->copy_ptr[i + 1] = copies;
    }
    return err->status;
}

int32_t sf_layers_copy(const sf_layers *l, int32_t node, int layer) {
    int64_t k = l->copy_ptr[node];
    while (l->copy[k] < l->first[layer])
        k++;
    return l->copy[k];
}

/* ---- interfaces ---- */

/* The faces of each pair of layers. */
typedef struct pair_table {
    int64_t faces[SF_CASE_MAX_LAYERS][SF_CASE_MAX_LAYERS];
} pair_table;

/* The layers of an interface share faces; bodies apart from each other may be loose. */
static sf_status check_pairs(const sf_case *c, const pair_table *pairs, sf_error *err) {
    for (int k = 0; k < c->interface_count; k++) {
        const sf_case_interface *i = &c->interface[k];
        if (pairs->faces[i->layer[0]][i->layer[1]] == 0 && !(i->kind == SF_INTERFACE_LOOSE && c->separate))
            return SF_REFUSE(err,
                             "%s: the layers \"%s\" and \"%s\" do not touch: they share no face of the mesh",
                             i->key, c->layer[i->layer[0]].name, c->layer[i->layer[1]].name);
    }
    return SF_OK;
}

/* Lists the interfaces that the case or the mesh has, by their layers. */
static void list_interfaces(const sf_case *c, const pair_table *pairs, sf_interfaces *out) {
    for (int a = 0; a < c->layer_count; a++)
        for (int b = a + 1; b < c->layer_count; b++) {
            const sf_case_interface *given = sf_case_interface_find(c, a, b);
            sf_interface own = {{a, b}, SF_INTERFACE_TIED, 0, pairs->faces[a][b]};
            if (given) {
                own.kind = given->kind;
                own.friction = given->friction;
            }
            if ((given || own.faces > 0) && out->count++ < SF_INTERFACES_LISTED)
                out->at[out->count - 1] = own;
        }
}

/* The component along the normal of a face; 0 if it is not normal to an axis. */
static uint8_t normal_component(const sf_mesh *mesh, const sf_inner_face *face) {
    const int32_t *node = &face->node[face->node[0] < 0];
    double n[3] = {0};
    if (sf_mesh_is_section(mesh)) {
        const double *a = &mesh->position[3 * (int64_t)face->node[2]],
                     *b = &mesh->position[3 * (int64_t)face->node[3]];
        n[0] = b[2] - a[2];
        n[2] = a[0] - b[0];
    } else {
        sf_face_normal(mesh->position, node, n);
    }
    double length = sqrt(sf_dot3(n, n));
    for (int k = 0; k < 3; k++)
        if (hypot(n[(k + 1) % 3], n[(k + 2) % 3]) <= ALONG_AXIS * length)
            return (uint8_t)(1 << k);
    return 0;
}

SF_ORDER_BY(by_nodes, sf_layer_tie, node, other)

/* The ties of one face between two layers. */
static sf_status tie_face(const sf_case *c, const sf_mesh *mesh, const sf_inner_face *face, pair_table *pairs,
                          sf_layers *l, sf_error *err) {
    int a = layer_of(mesh, face->cell[0]), b = layer_of(mesh, face->cell[1]);
    int low = a < b ? a : b, high = a < b ? b : a;
    const sf_case_interface *given = sf_case_interface_find(c, a, b);
    uint8_t mask = given && given->kind != SF_INTERFACE_TIED ? normal_component(mesh, face) : ALL;
    if (mask == 0) {
        const double *x = &mesh->position[3 * (int64_t)face->node[3]];
        return SF_REFUSE(err,
                         "%s: the interface of \"%s\" and \"%s\" at (%.4g, %.4g, %.4g) mm is not normal to "
                         "x, y or z: one that is sliding or loose must be",
                         given->key, c->layer[low].name, c->layer[high].name, 1e3 * x[0], 1e3 * x[1],
                         1e3 * x[2]);
    }
    pairs->faces[a][b] = ++pairs->faces[b][a];
    for (int k = (face->node[0] < 0) + (face->node[1] < 0); k < 4; k++)
        l->tie[l->tie_count++] = (sf_layer_tie){sf_layers_copy(l, face->node[k], low),
                                                sf_layers_copy(l, face->node[k], high), mask};
    return SF_OK;
}

/* One tie for each two nodes. */
static void merge_ties(sf_layers *l) {
    int64_t kept = 0;
    if (l->tie_count > 0)
        qsort(l->tie, (size_t)l->tie_count, sizeof *l->tie, by_nodes);
    for (int64_t k = 0; k < l->tie_count; k++)
        if (kept > 0 && by_nodes(&l->tie[kept - 1], &l->tie[k]) == 0)
            l->tie[kept - 1].mask |= l->tie[k].mask;
        else
            l->tie[kept++] = l->tie[k];
    l->tie_count = kept;
}

static sf_status find_ties(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_layers *l,
                           sf_error *err) {
    pair_table pairs = {0};
    int64_t faces = 0;
    for (int64_t f = 0; f < dual->inner_count; f++)
        faces += layer_of(mesh, dual->inner[f].cell[0]) != layer_of(mesh, dual->inner[f].cell[1]);
    l->tie = sf_alloc(err, 4 * faces, sizeof *l->tie, "ties between layers");
    for (int64_t f = 0; err->status == SF_OK && f < dual->inner_count; f++)
        if (layer_of(mesh, dual->inner[f].cell[0]) != layer_of(mesh, dual->inner[f].cell[1]))
            tie_face(c, mesh, &dual->inner[f], &pairs, l, err);
    SF_TRY(err->status);
    merge_ties(l);
    list_interfaces(c, &pairs, &l->interfaces);
    return check_pairs(c, &pairs, err);
}

static void find_together(sf_layers *l) {
    for (int64_t k = 0; k < l->tie_count; k++)
        if (l->tie[k].mask == ALL)
            sf_sets_join(l->together, l->tie[k].other, l->tie[k].node);
    for (int64_t i = 0; i < l->first[l->count]; i++)
        l->together[i] = sf_sets_find(l->together, i);
}

sf_status sf_layers_build(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_layers *l,
                          sf_error *err) {
    *l = (sf_layers){.count = c->layer_count > 0 ? c->layer_count : 1};
    SF_OWNED uint8_t *used = mark_layers(mesh, l->count, err);
    if (used && number_nodes(mesh, used, l, err) == SF_OK)
        find_ties(c, mesh, dual, l, err);
    if (err->status == SF_OK && (l->together = sf_sets_alone(l->first[l->count], "ties between layers", err)))
        find_together(l);
    if (err->status != SF_OK)
        sf_layers_free(l);
    return err->status;
}

void sf_layers_free(sf_layers *l) {
    SF_CLEAR(l, l->first, l->origin, l->copy_ptr, l->copy, l->tie, l->together);
}

/* ---- parts of the mesh ---- */

sf_status sf_layers_part(const sf_mesh *mesh, const sf_layers *l, int layer, sf_mesh *part, sf_error *err) {
    int64_t entries = 0, nodes = l->first[layer + 1] - l->first[layer];
    *part = (sf_mesh){.node_count = nodes};
    for (int64_t k = 0; k < mesh->cell_count; k++)
        if (layer_of(mesh, k) == layer) {
            part->cell_count++;
            entries += mesh->cell_ptr[k + 1] - mesh->cell_ptr[k];
        }
    unsigned long cells = (unsigned long)part->cell_count;
    SF_ALLOC_ALL(err, "a layer", SF_ROOM(part->position, 3 * nodes), SF_ROOM(part->cell_type, cells),
                 SF_ROOM(part->cell_ptr, cells + 1), SF_ROOM(part->cell_node, entries));
    int64_t cell = 0, used = 0;
    for (int64_t i = 0; err->status == SF_OK && i < nodes; i++)
        memcpy(&part->position[3 * i], &mesh->position[3 * (int64_t)l->origin[l->first[layer] + i]],
               3 * sizeof *part->position);
    for (int64_t k = 0; err->status == SF_OK && k < mesh->cell_count; k++) {
        if (layer_of(mesh, k) != layer)
            continue;
        part->cell_type[cell] = mesh->cell_type[k];
        for (int64_t v = mesh->cell_ptr[k]; v < mesh->cell_ptr[k + 1]; v++)
            part->cell_node[used++] =
                (int32_t)(sf_layers_copy(l, mesh->cell_node[v], layer) - l->first[layer]);
        part->cell_ptr[++cell] = used;
    }
    if (err->status != SF_OK)
        sf_mesh_free(part);
    return err->status;
}

int32_t sf_layers_heaviest(const sf_layers *layers, const sf_model *m, int32_t node) {
    int32_t origin = layers->origin[node], best = node;
    for (int64_t k = layers->copy_ptr[origin]; k < layers->copy_ptr[origin + 1]; k++) {
        int32_t other = layers->copy[k];
        if (layers->together[other] == layers->together[node] &&
            (m->mass[other] > m->mass[best] || (m->mass[other] == m->mass[best] && other < best)))
            best = other;
    }
    return best;
}

sf_status sf_layers_area(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l, const sf_node_set *set,
                         double *area, sf_error *err) {
    SF_OWNED double *own = sf_alloc(err, mesh->node_count, sizeof *own, "areas");
    for (int layer = 0; own && layer < l->count && err->status == SF_OK; layer++) {
        memset(own, 0, (size_t)mesh->node_count * sizeof *own);
        if (sf_surface_area(mesh, dual, set, l->count > 1 ? layer : SF_ANY_LAYER, own, err) == SF_OK)
            for (int64_t i = l->first[layer]; i < l->first[layer + 1]; i++)
                area[i] += own[l->origin[i]];
    }
    return err->status;
}

/* Marks the nodes of the parted mesh that belong to a set: at each of its nodes, those of the layers with a
 * face of the surface in it; where there is no such face, all. */
static sf_status mark_copies(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l,
                             const sf_node_set *set, uint8_t *mark, sf_error *err) {
    SF_OWNED uint8_t *member = sf_surface_members(mesh, set, err);
    for (int64_t f = 0; member && f < dual->face_count; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool inside = sf_surface_has_face(face, member);
        for (int k = 0; inside && k < face->size; k++)
            mark[sf_layers_copy(l, face->node[k], layer_of(mesh, face->cell))] = 1;
    }
    for (int64_t k = 0; member && k < set->count; k++) {
        int64_t first = l->copy_ptr[set->node[k]], last = l->copy_ptr[set->node[k] + 1], marked = 0;
        for (int64_t i = first; i < last; i++)
            marked += mark[l->copy[i]];
        for (int64_t i = first; marked == 0 && i < last; i++)
            mark[l->copy[i]] = 1;
    }
    return err->status;
}

static sf_status split_set(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l, sf_node_set *set,
                           sf_error *err) {
    int64_t n = l->first[l->count], count = 0;
    SF_OWNED uint8_t *mark = sf_alloc(err, n, 1, "a node set");
    if (mark)
        mark_copies(mesh, dual, l, set, mark, err);
    for (int64_t i = 0; mark && i < n; i++)
        count += mark[i];
    int32_t *node = sf_alloc(err, count, sizeof *node, "a node set");
    SF_TRY(err->status);
    SF_FREE(set->node, set->face);
    set->node = node;
    set->face = NULL;
    set->count = set->face_count = 0;
    for (int64_t i = 0; i < n; i++)
        if (mark[i])
            set->node[set->count++] = (int32_t)i;
    return err->status;
}

sf_status sf_layers_split(sf_mesh *mesh, const sf_dual *dual, const sf_layers *l, sf_error *err) {
    int64_t n = l->first[l->count];
    if (l->count == 1)
        return SF_OK;
    for (int s = 0; s < mesh->set_count && err->status == SF_OK; s++)
        split_set(mesh, dual, l, &mesh->set[s], err);
    double *position = sf_alloc(err, 3 * n, sizeof *position, "positions");
    SF_TRY(err->status);
    for (int64_t i = 0; i < n; i++)
        memcpy(&position[3 * i], &mesh->position[3 * (int64_t)l->origin[i]], 3 * sizeof *position);
    for (int64_t k = 0; k < mesh->cell_count; k++)
        for (int64_t v = mesh->cell_ptr[k]; v < mesh->cell_ptr[k + 1]; v++)
            mesh->cell_node[v] = sf_layers_copy(l, mesh->cell_node[v], layer_of(mesh, k));
    free(mesh->position);
    mesh->position = position;
    mesh->node_count = n;
    return SF_OK;
}

/* ---- ties ---- */

/* A tie carries what is held on one side to the other, until nothing changes. */
static void spread_held(const sf_layers *l, uint8_t *mask, uint8_t *base) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int64_t k = 0; k < l->tie_count; k++) {
            const sf_layer_tie *t = &l->tie[k];
            uint8_t differ = (mask[t->node] ^ mask[t->other]) & t->mask;
            if (!differ)
                continue;
            base[t->node] = base[t->other] = base[t->node] | base[t->other];
            mask[t->node] |= differ;
            mask[t->other] |= differ;
            changed = true;
        }
    }
}

/* The components of a tie that are not held and do not follow from earlier ties. */
static uint8_t join(const sf_layer_tie *t, uint8_t held, int64_t *const parent[3]) {
    uint8_t mask = 0;
    for (int c = 0; c < 3; c++) {
        if (!(t->mask & ~held & 1 << c))
            continue;
        if (sf_sets_find(parent[c], t->node) != sf_sets_find(parent[c], t->other))
            mask |= (uint8_t)(1 << c);
        sf_sets_join(parent[c], t->node, t->other);
    }
    return mask;
}

void sf_layers_loosen(const sf_case *c, sf_model *m) {
    int64_t kept = 0;
    for (int64_t k = 0; k < m->tie_count; k++) {
        int a = m->node_material[m->tie_node[k]], b = m->node_material[m->tie_other[k]];
        const sf_case_interface *given = sf_case_interface_find(c, a, b);
        if (given && given->kind == SF_INTERFACE_LOOSE)
            continue;
        m->tie_node[kept] = m->tie_node[k];
        m->tie_other[kept] = m->tie_other[k];
        m->tie_mask[kept++] = m->tie_mask[k];
    }
    m->tie_count = kept;
}

sf_status sf_layers_hold(const sf_layers *l, uint8_t *mask, uint8_t *base, sf_model *m, sf_error *err) {
    unsigned long ties = (unsigned long)l->tie_count;
    int64_t *parent[3] = {NULL, NULL, NULL};
    if (l->tie_count == 0)
        return SF_OK;
    spread_held(l, mask, base);
    for (int c = 0; c < 3; c++)
        parent[c] = sf_sets_alone(l->first[l->count], "ties between layers", err);
    SF_ALLOC_ALL(err, "ties between layers", SF_ROOM(m->tie_node, ties), SF_ROOM(m->tie_other, ties),
                 SF_ROOM(m->tie_mask, ties));
    for (int64_t k = 0; k < l->tie_count && err->status == SF_OK; k++) {
        const sf_layer_tie *t = &l->tie[k];
        uint8_t open = join(t, mask[t->node], parent);
        if (!open)
            continue;
        m->tie_node[m->tie_count] = t->node;
        m->tie_other[m->tie_count] = t->other;
        m->tie_mask[m->tie_count++] = open;
    }
    sf_free_all(3, parent);
    return err->status;
}
