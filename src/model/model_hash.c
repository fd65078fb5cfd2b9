/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/hash.h"
#include "model/model.h"
#include <stdio.h>

static size_t item_size(sf_model_type type) {
    return type == SF_MODEL_U8 ? 1 : type == SF_MODEL_I32 ? 4 : 8;
}

static uint64_t hash_of(const sf_model *model) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    const char *base = (const char *)model;
    uint64_t hash = SF_HASH_START;
    for (size_t k = 0; k < count; k++) {
        const char *member = base + field[k].offset;
        if (field[k].rows_offset == SIZE_MAX) {
            hash = sf_hash(hash, member, item_size(field[k].type));
            continue;
        }
        const void *data = *(void *const *)member;
        int64_t rows = *(const int64_t *)(base + field[k].rows_offset) + field[k].rows_extra;
        if (data)
            hash = sf_hash(hash, data, (size_t)rows * (size_t)field[k].columns * item_size(field[k].type));
    }
    for (int64_t k = 0; k < model->material_count; k++)
        hash = sf_material_hash(hash, &model->material[k]);
    return hash;
}

void sf_model_hash(const sf_model *model, char text[SF_MODEL_HASH_SIZE]) {
    snprintf(text, SF_MODEL_HASH_SIZE, "%016llx", (unsigned long long)hash_of(model));
}
