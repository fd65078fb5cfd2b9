/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh_stream.h"

#include "base/sets.h"
#include "pre/mesh/mesher_protocol.h"
#include <assert.h>
#include <math.h>

/* The unread rest. `bad` once something was missing or out of range; then all reads give zero. */
typedef struct reader {
    const uint64_t *word;
    size_t left; /* words */
    bool bad;
} reader;

static uint64_t take(reader *r) {
    if (r->left == 0)
        r->bad = true;
    if (r->bad)
        return 0;
    r->left--;
    return *r->word++;
}

static int32_t take_int(reader *r, int32_t low, int32_t high) {
    int64_t value = (int64_t)take(r);
    if (value < low || value > high) {
        r->bad = true;
        return low;
    }
    return (int32_t)value;
}

/* A count of things of `words` words each, at least, that must still be there. */
static size_t take_count(reader *r, size_t words) {
    uint64_t count = take(r);
    if (count > r->left / words)
        r->bad = true;
    return r->bad ? 0 : (size_t)count;
}

static const uint64_t *take_words(reader *r, size_t count) {
    const uint64_t *words = r->word;
    if (r->bad || count > r->left) {
        r->bad = true;
        return NULL;
    }
    r->word += count;
    r->left -= count;
    return words;
}

/* Longer texts are cut. */
static void take_text(reader *r, char *out, size_t size) {
    uint64_t length = take(r);
    const uint64_t *words = length <= 8 * (uint64_t)r->left ? take_words(r, (size_t)(length + 7) / 8) : NULL;
    size_t kept = length < size - 1 ? (size_t)length : size - 1;
    r->bad = r->bad || !words;
    if (r->bad)
        kept = 0;
    else if (kept > 0)
        memcpy(out, words, kept);
    out[kept] = '\0';
}

static sf_status read_nodes(reader *r, const char *file, sf_geo_data *out, sf_error *err) {
    size_t count = take_count(r, 4);
    out->tag = take_words(r, count);
    const uint64_t *words = take_words(r, 3 * count);
    if (r->bad)
        return SF_OK;
    out->node_count = count;
    out->xyz = (const double *)(const void *)words;
    for (size_t n = 0; n < count; n++) {
        const double *x = &out->xyz[3 * n];
        r->bad = r->bad || out->tag[n] == 0;
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            return SF_REFUSE(err, "%s: gmsh gives node %llu the position (%g, %g, %g)", file,
                             (unsigned long long)out->tag[n], x[0], x[1], x[2]);
    }
    return SF_OK;
}

static sf_status read_groups(reader *r, const char *file, sf_geo_data *out, sf_error *err) {
    size_t count = take_count(r, 4);
    if (count > SF_GEO_MAX_GROUPS)
        return SF_REFUSE(err, "%s has %zu physical groups" SF_AT_MOST("%d"), file, count, SF_GEO_MAX_GROUPS);
    out->group = sf_alloc(err, count, sizeof *out->group, "physical groups");
    for (size_t g = 0; out->group && !r->bad && g < count && err->status == SF_OK; g++) {
        sf_geo_group *group = &out->group[out->group_count++];
        group->dimension = take_int(r, 1, 3);
        group->tag = take_int(r, INT32_MIN, INT32_MAX);
        take_text(r, group->name, sizeof group->name);
        size_t entities = take_count(r, 1);
        group->entity = sf_alloc(err, entities, sizeof *group->entity, "entities of a group");
        for (size_t i = 0; group->entity && i < entities; i++)
            group->entity[group->count++] = take_int(r, INT32_MIN, INT32_MAX);
        if (group->count > 0)
            qsort(group->entity, group->count, sizeof *group->entity, sf_by_number);
    }
    return err->status;
}

static bool precedes(const sf_geo_block *a, int dimension, int entity) {
    return a->dimension < dimension || (a->dimension == dimension && a->entity < entity);
}

static sf_status read_blocks(reader *r, sf_geo_data *out, sf_error *err) {
    size_t count = take_count(r, 5);
    out->block = sf_alloc(err, count, sizeof *out->block, "element blocks");
    for (size_t k = 0; out->block && !r->bad && k < count; k++) {
        sf_geo_block *block = &out->block[out->block_count++];
        block->dimension = take_int(r, 1, 3);
        block->entity = take_int(r, INT32_MIN, INT32_MAX);
        block->type = take_int(r, 0, INT32_MAX);
        take_text(r, block->type_name, sizeof block->type_name);
        block->length = take_count(r, 1);
        block->node = take_words(r, block->length);
        r->bad = r->bad || (k > 0 && precedes(block, block[-1].dimension, block[-1].entity));
    }
    return err->status;
}

sf_status sf_geo_data_read(const void *data, size_t size, const char *file, sf_geo_data *out, sf_error *err) {
    reader r = {.word = data, .left = size / sizeof(uint64_t)};
    memset(out, 0, sizeof *out);
    assert((uintptr_t)data % sizeof(uint64_t) == 0);
    r.bad = take(&r) != SF_MESH_STREAM_BEGIN;
    take_text(&r, out->version, sizeof out->version);
    take_text(&r, out->error, sizeof out->error);
    if (!r.bad && *out->error == '\0' && read_nodes(&r, file, out, err) == SF_OK &&
        read_groups(&r, file, out, err) == SF_OK)
        read_blocks(&r, out, err);
    if (err->status == SF_OK &&
        (take(&r) != SF_MESH_STREAM_END || r.bad || r.left > 0 || size % sizeof(uint64_t) > 0))
        SF_REFUSE(err, "%s: the mesh that gmsh gave is cut or damaged", file);
    if (err->status != SF_OK)
        sf_geo_data_free(out);
    return err->status;
}

void sf_geo_data_free(sf_geo_data *data) {
    for (size_t g = 0; g < data->group_count; g++)
        free(data->group[g].entity);
    SF_CLEAR(data, data->group, data->block);
}

bool sf_geo_group_has(const sf_geo_group *group, int32_t entity) {
    return group->count > 0 &&
           bsearch(&entity, group->entity, group->count, sizeof *group->entity, sf_by_number) != NULL;
}

size_t sf_geo_data_blocks(const sf_geo_data *data, int dimension, int entity, size_t *end) {
    size_t low = 0, high = data->block_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (precedes(&data->block[middle], dimension, entity))
            low = middle + 1;
        else
            high = middle;
    }
    for (*end = low; *end < data->block_count && data->block[*end].dimension == dimension &&
                     data->block[*end].entity == entity;)
        ++*end;
    return low;
}
