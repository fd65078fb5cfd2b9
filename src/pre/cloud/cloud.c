/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/cloud.h"

#include "base/hash.h"
#include "base/mat3.h"
#include "base/sets.h"
#include "io/folder.h"
#include "io/plain_file.h"

typedef struct keyed_node {
    uint64_t key;
    int32_t node;
} keyed_node;

SF_ORDER_BY(by_key, keyed_node, key, node)

/* Spreads the low 21 bits of x to every third bit. */
static uint64_t spread(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

sf_status sf_cloud_reorder(sf_mesh *mesh, sf_error *err) {
    int64_t n = mesh->node_count;
    double low[3], high[3], extent = 0;
    SF_OWNED keyed_node *order = sf_alloc(err, n, sizeof *order, "node order");
    SF_OWNED int32_t *rank = sf_alloc(err, n, sizeof *rank, "node order");
    SF_OWN(double, moved, 3 * n, "node order", err);
    sf_box3(n, mesh->position, low, high);
    for (int c = 0; c < 3; c++)
        extent = fmax(extent, high[c] - low[c]);
    for (int64_t i = 0; i < n; i++) {
        order[i].node = (int32_t)i;
        for (int c = 0; c < 3; c++)
            order[i].key |= spread((uint64_t)((mesh->position[3 * i + c] - low[c]) / extent * 2097151.0))
                            << c;
    }
    qsort(order, (size_t)n, sizeof *order, by_key);
    for (int64_t i = 0; i < n; i++) {
        rank[order[i].node] = (int32_t)i;
        memcpy(&moved[3 * i], &mesh->position[3 * (int64_t)order[i].node], 3 * sizeof *moved);
    }
    memcpy(mesh->position, moved, 3 * (size_t)n * sizeof *moved);
    for (int64_t k = 0; k < mesh->cell_ptr[mesh->cell_count]; k++)
        mesh->cell_node[k] = rank[mesh->cell_node[k]];
    for (int s = 0; s < mesh->set_count; s++) {
        for (int64_t k = 0; k < 4 * mesh->set[s].face_count; k++)
            if (mesh->set[s].face[k] >= 0)
                mesh->set[s].face[k] = rank[mesh->set[s].face[k]];
        for (int64_t k = 0; k < mesh->set[s].face_count; k++)
            qsort(&mesh->set[s].face[4 * k], 4, sizeof(int32_t), sf_by_number);
        for (int64_t k = 0; k < mesh->set[s].count; k++)
            mesh->set[s].node[k] = rank[mesh->set[s].node[k]];
        qsort(mesh->set[s].node, (size_t)mesh->set[s].count, sizeof(int32_t), sf_by_number);
    }
    return err->status;
}

/* Keeps the `limit` smallest of the values offered, ascending. */
static void keep_smallest(double value, int limit, int *count, double *kept) {
    int k = *count < limit ? (*count)++ : limit;
    if (k == limit && !(value < kept[--k]))
        return;
    for (; k > 0 && kept[k - 1] > value; k--)
        kept[k] = kept[k - 1];
    kept[k] = value;
}

void sf_cloud_spacing(const sf_mesh *mesh, const sf_dual *dual, double *spacing) {
    for (int64_t i = 0; i < mesh->node_count; i++) {
        double nearest[SF_SPACING_NEIGHBOURS], sum = 0;
        int count = 0;
        for (int64_t k = dual->edge_ptr[i]; k < dual->edge_ptr[i + 1]; k++) {
            const double *a = &mesh->position[3 * i], *b = &mesh->position[3 * (int64_t)dual->edge_node[k]];
            keep_smallest(sf_distance3(a, b), SF_SPACING_NEIGHBOURS, &count, nearest);
        }
        for (int k = 0; k < count; k++)
            sum += nearest[k];
        spacing[i] = sum / count;
    }
}

/* A node is light whose volume, of a whole ball, is less than LIGHT of the mean of its neighbours'. */
static const double LIGHT = 0.7;
/* Part of rho V that a node keeps at least. */
static const double LEAST_MASS = 0.5;

/* Volume of each domain over the solid angle of the pad that its node sees: one number for all nodes of a
 * lattice, those of its faces, edges and corners too. The angle is that of the domain's inner facets, each by
 * its middle. */
static void whole_volumes(const sf_mesh *mesh, const sf_dual *dual, const double *volume, double *whole) {
    const bool section = sf_mesh_is_section(mesh);
    for (int64_t e = 0; e < dual->edge_count; e++)
        for (int64_t u = dual->use_ptr[e]; u < dual->use_ptr[e + 1]; u++) {
            sf_facet_triangle facet[2];
            sf_dual_facet(mesh, &dual->use[u], facet);
            for (int k = 0; k < 4; k++) {
                int64_t node = dual->edge[2 * e + k % 2];
                const double *x = &mesh->position[3 * node], *c = facet[k / 2].centroid;
                double arm[3] = {c[0] - x[0], c[1] - x[1], c[2] - x[2]}, length = sqrt(sf_dot3(arm, arm)),
                       girth = section ? 2 * M_PI * c[0] : length; /* a plane angle in a section */
                whole[node] += fabs(sf_dot3(arm, facet[k / 2].area)) / (length * length * girth);
            }
        }
    for (int64_t i = 0; i < mesh->node_count; i++)
        whole[i] = volume[i] / whole[i];
}

/* Sets role [n] of the nodes: LONE, LIGHT_NODE, or NEIGHBOUR, which sees a light one. */
enum { LONE, LIGHT_NODE, NEIGHBOUR };
static sf_status find_light(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *d, uint8_t *role,
                            sf_error *err) {
    SF_OWNED double *whole = sf_alloc(err, mesh->node_count, sizeof *whole, "masses");
    SF_TRY(err->status);
    whole_volumes(mesh, dual, d->volume, whole);
    for (int64_t i = 0; i < mesh->node_count; i++) {
        double sum = 0;
        for (int64_t k = dual->edge_ptr[i]; k < dual->edge_ptr[i + 1]; k++)
            sum += whole[dual->edge_node[k]];
        bool light = whole[i] * (double)(dual->edge_ptr[i + 1] - dual->edge_ptr[i]) < LIGHT * sum;
        role[i] = light ? LIGHT_NODE : LONE;
    }
    for (int64_t j = 0; j < mesh->node_count; j++)
        for (int64_t e = d->phi_ptr[j]; e < d->phi_ptr[j + 1] && role[j] == LONE; e++)
            role[j] = role[d->phi_node[e]] == LIGHT_NODE ? NEIGHBOUR : LONE;
    return SF_OK;
}

sf_status sf_cloud_masses(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *d, double density,
                          double *mass, sf_error *err) {
    int64_t n = mesh->node_count;
    SF_OWNED double *carried = sf_alloc(err, n, sizeof *carried, "masses");
    SF_OWNED uint8_t *role = sf_alloc(err, n, 1, "masses");
    double least = 1;
    if (err->status != SF_OK || find_light(mesh, dual, d, role, err) != SF_OK)
        return err->status;
    for (int64_t j = 0; j < n; j++) {
        carried[j] += role[j] == LONE ? d->volume[j] : 0;
        for (int64_t e = d->phi_ptr[j]; e < d->phi_ptr[j + 1] && role[j] != LONE; e++)
            carried[d->phi_node[e]] += d->volume[j] * d->phi_value[e];
    }
    for (int64_t i = 0; i < n; i++)
        least = fmin(least, carried[i] / d->volume[i]);
    double share = fmin(1, (1 - LEAST_MASS) / (1 - least));
    for (int64_t i = 0; i < n; i++)
        mass[i] = density * (d->volume[i] + share * (carried[i] - d->volume[i]));
    return SF_OK;
}

void sf_cloud_hash(const sf_mesh *mesh, char text[17]) {
    uint64_t hash = SF_HASH_START;
    hash = sf_hash_bytes(hash, mesh->position, 3 * (size_t)mesh->node_count * sizeof *mesh->position);
    hash = sf_hash_bytes(hash, mesh->cell_type, (size_t)mesh->cell_count);
    hash = sf_hash_bytes(hash, mesh->cell_node,
                         (size_t)mesh->cell_ptr[mesh->cell_count] * sizeof *mesh->cell_node);
    if (mesh->cell_layer)
        hash = sf_hash_bytes(hash, mesh->cell_layer, (size_t)mesh->cell_count);
    snprintf(text, 17, "%016llx", (unsigned long long)hash);
}

static const char KIND[] = "domains";
enum { PARTS = 9 };

/* The numbers of the store beside its arrays. */
typedef struct numbers {
    int64_t nodes, count, phi_count; /* count: of entries of B */
    sf_domain_figures figures;
} numbers;

/* False: this program cannot be read. */
static bool find_key(const sf_mesh *mesh, double condition_limit, const double *support, uint64_t *key) {
    size_t n = (size_t)mesh->node_count, cells = (size_t)mesh->cell_count;
    if (!sf_store_begin_key(key))
        return false;
    *key = sf_hash_bytes(*key, &condition_limit, sizeof condition_limit);
    *key = sf_hash_bytes(*key, support, n * sizeof *support);
    *key = sf_hash_bytes(*key, mesh->position, 3 * n * sizeof *mesh->position);
    *key = sf_hash_bytes(*key, mesh->cell_type, cells * sizeof *mesh->cell_type);
    *key = sf_hash_bytes(*key, mesh->cell_ptr, (cells + 1) * sizeof *mesh->cell_ptr);
    *key = sf_hash_bytes(*key, mesh->cell_node, (size_t)mesh->cell_ptr[cells] * sizeof *mesh->cell_node);
    return true;
}

/* The arrays and their sizes in bytes, in the order of the file. */
static void list_parts(const numbers *h, sf_domains *d, double **support, void **array[PARTS - 1],
                       size_t size[PARTS - 1]) {
    size_t n = (size_t)h->nodes, b = (size_t)h->count, phi = (size_t)h->phi_count;
    void **const list[PARTS - 1] = {(void **)&d->volume,    (void **)&d->ptr,     (void **)&d->node,
                                    (void **)&d->b,         (void **)&d->phi_ptr, (void **)&d->phi_node,
                                    (void **)&d->phi_value, (void **)support};
    const size_t bytes[PARTS - 1] = {n * sizeof *d->volume,        (n + 1) * sizeof *d->ptr,
                                     b * sizeof *d->node,          3 * b * sizeof *d->b,
                                     (n + 1) * sizeof *d->phi_ptr, phi * sizeof *d->phi_node,
                                     phi * sizeof *d->phi_value,   n * sizeof **support};
    memcpy(array, list, sizeof list);
    memcpy(size, bytes, sizeof bytes);
}

/* Copies the arrays out of what was stored; false: it is not whole. */
static bool take(const sf_stored *found, int64_t nodes, double *support, sf_domains *out) {
    numbers h;
    void **array[PARTS - 1];
    size_t size[PARTS - 1], at = sizeof h, total = sizeof h;
    SF_OWNED double *supports = NULL;
    if (found->size < sizeof h)
        return false;
    memcpy(&h, found->data, sizeof h);
    int64_t most = (int64_t)found->size;
    if (h.nodes != nodes || h.count < 0 || h.count > most || h.phi_count < 0 || h.phi_count > most)
        return false;
    list_parts(&h, out, &supports, array, size);
    for (int k = 0; k < PARTS - 1; k++)
        total += size[k];
    sf_error none = SF_ERROR_INIT;
    for (int k = 0; total == found->size && k < PARTS - 1; at += size[k], k++)
        if ((*array[k] = sf_alloc(&none, size[k], 1, "domains")) != NULL)
            memcpy(*array[k], found->data + at, size[k]);
    bool whole = total == found->size && none.status == SF_OK;
    if (whole) {
        memcpy(support, supports, (size_t)nodes * sizeof *support);
        out->figures = h.figures;
    } else {
        sf_domains_free(out);
    }
    return whole;
}

static void keep(const char *folder, uint64_t key, int64_t nodes, double *support, sf_domains *d) {
    const numbers h = {nodes, d->ptr[nodes], d->phi_ptr[nodes], d->figures};
    void **array[PARTS - 1];
    size_t size[PARTS - 1];
    sf_store_part part[PARTS] = {{&h, sizeof h}};
    list_parts(&h, d, &support, array, size);
    for (int k = 0; k < PARTS - 1; k++)
        part[k + 1] = (sf_store_part){*array[k], size[k]};
    sf_store_keep(folder, KIND, key, PARTS, part);
}

sf_status sf_domain_store_build(const char *folder, const sf_mesh *mesh, const sf_dual *dual,
                                double condition_limit, double *support, sf_domains *out, sf_error *err) {
    uint64_t key = 0;
    sf_stored found;
    bool known = folder && find_key(mesh, condition_limit, support, &key);
    if (known && sf_store_find(folder, KIND, key, &found)) {
        bool whole = take(&found, mesh->node_count, support, out);
        free(found.block);
        if (whole)
            return SF_OK;
    }
    if (sf_domains_build(mesh, dual, condition_limit, support, out, err) == SF_OK && known)
        keep(folder, key, mesh->node_count, support, out);
    return err->status;
}
