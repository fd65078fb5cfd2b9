/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/shapes.h"

#include "core/hash.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static int64_t slab_size(int64_t node_count, int64_t first) {
    return first + SF_SLAB < node_count ? SF_SLAB : node_count - first;
}

static uint64_t hash_rows(const sf_shape_rows *rows, int64_t count) {
    size_t entries = (size_t)(rows->ptr[count] - rows->ptr[0]);
    uint64_t hash = sf_hash(SF_HASH_START, rows->ptr, (size_t)(count + 1) * sizeof *rows->ptr);
    hash = sf_hash(hash, rows->node, entries * sizeof *rows->node);
    return sf_hash(hash, rows->value, entries * sizeof *rows->value);
}

static void take_from_model(const sf_model *m, int64_t first, sf_shape_rows *rows) {
    int64_t begin = m->phi_ptr[first];
    *rows = (sf_shape_rows){.first = first,
                            .ptr = &m->phi_ptr[first],
                            .node = &m->phi_node[begin],
                            .value = &m->phi_value[begin]};
}

sf_status sf_shapes_open(const sf_model *m, const sf_h5 *file, sf_shapes *s, sf_error *err) {
    int64_t rows = m->node_count + 1, entries = m->phi_nnz;
    int64_t slabs = (m->node_count + SF_SLAB - 1) / SF_SLAB;
    *s = (sf_shapes){.node_count = m->node_count};
    s->hash = sf_alloc(err, (unsigned long)slabs, sizeof *s->hash, "hashes of the shape functions");
    if (!s->hash || sf_h5_source_open(file, "/shape/ptr", SF_H5_I64, 1, &rows, &s->ptr, err) != SF_OK ||
        sf_h5_source_open(file, "/shape/node", SF_H5_I32, 1, &entries, &s->node, err) != SF_OK ||
        sf_h5_source_open(file, "/shape/value", SF_H5_F64, 1, &entries, &s->value, err) != SF_OK)
        return err->status;
    for (int64_t k = 0; k < slabs; k++) {
        sf_shape_rows slab;
        take_from_model(m, k * SF_SLAB, &slab);
        s->hash[k] = hash_rows(&slab, slab_size(m->node_count, k * SF_SLAB));
    }
    return SF_OK;
}

void sf_shapes_close(sf_shapes *s) {
    sf_h5_source_close(&s->ptr);
    sf_h5_source_close(&s->node);
    sf_h5_source_close(&s->value);
    free(s->hash);
    memset(s, 0, sizeof *s);
}

static bool ascend(const int64_t *ptr, int64_t count, int64_t limit) {
    bool good = ptr[0] >= 0 && ptr[count] <= limit;
    for (int64_t k = 0; k < count && good; k++)
        good = ptr[k] <= ptr[k + 1];
    return good;
}

static bool are_nodes(const int32_t *node, int64_t count, int64_t node_count) {
    bool good = true;
    for (int64_t k = 0; k < count && good; k++)
        good = node[k] >= 0 && node[k] < node_count;
    return good;
}

static sf_status tell_change(const sf_shapes *s, sf_error *err) {
    return SF_FAIL(err, SF_ERR_IO,
                   "%s has changed since the run began: the shape functions that a frame needs are no longer "
                   "those of the model",
                   sf_h5_path(s->ptr.file));
}

/* The entries of rows whose pointers have been read. */
static sf_status read_entries(const sf_shapes *s, const int64_t *ptr, int64_t count, sf_shape_rows *rows,
                              sf_error *err) {
    int64_t entries = ptr[count] - ptr[0];
    int32_t *node = rows->own[1] = sf_alloc(err, (unsigned long)entries, sizeof *node, "shape functions");
    double *value = rows->own[2] = sf_alloc(err, (unsigned long)entries, sizeof *value, "shape functions");
    if (!node || !value || sf_h5_source_read(&s->node, ptr[0], entries, node, err) != SF_OK ||
        sf_h5_source_read(&s->value, ptr[0], entries, value, err) != SF_OK)
        return err->status;
    rows->ptr = ptr;
    rows->node = node;
    rows->value = value;
    if (!are_nodes(node, entries, s->node_count) || hash_rows(rows, count) != s->hash[rows->first / SF_SLAB])
        return tell_change(s, err);
    return SF_OK;
}

sf_status sf_shapes_read(const sf_shapes *s, const sf_model *m, int64_t first, int64_t count,
                         sf_shape_rows *rows, sf_error *err) {
    if (!s) {
        take_from_model(m, first, rows);
        return SF_OK;
    }
    *rows = (sf_shape_rows){.first = first};
    int64_t *ptr = rows->own[0] =
        sf_alloc(err, (unsigned long)count + 1, sizeof *ptr, "rows of shape functions");
    if (!ptr || sf_h5_source_read(&s->ptr, first, count + 1, ptr, err) != SF_OK)
        return err->status;
    if (!ascend(ptr, count, s->node.rows))
        return tell_change(s, err);
    return read_entries(s, ptr, count, rows, err);
}

void sf_shapes_release(sf_shape_rows *rows) {
    for (int k = 0; k < 3; k++)
        free(rows->own[k]);
    memset(rows, 0, sizeof *rows);
}
