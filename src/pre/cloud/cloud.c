/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/cloud.h"

#include "base/hash.h"
#include "base/mat3.h"
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
    uint64_t program = 0;
    size_t n = (size_t)mesh->node_count, cells = (size_t)mesh->cell_count;
    if (sf_plain_hash("/proc/self/exe", NULL, SF_PLAIN_ANY, &program, SF_IGNORED) != SF_OK)
        return false;
    *key = sf_hash_bytes(SF_HASH_START, &program, sizeof program);
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
