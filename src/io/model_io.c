/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/model_io.h"

#include "io/replace.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static sf_h5_type h5_type(sf_model_type type) {
    switch (type) {
    case SF_MODEL_I32:
        return SF_H5_I32;
    case SF_MODEL_I64:
        return SF_H5_I64;
    case SF_MODEL_U8:
        return SF_H5_U8;
    default:
        return SF_H5_F64;
    }
}

static sf_status write_fields(sf_h5 *h5, const sf_model *model, sf_error *err) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    const char *base = (const char *)model;
    for (size_t k = 0; k < count && err->status == SF_OK; k++) {
        sf_h5_info info = {field[k].path, field[k].units, field[k].description};
        const char *member = base + field[k].offset;
        if (field[k].rows_offset == SIZE_MAX) {
            sf_h5_write(h5, &info, h5_type(field[k].type), 0, NULL, member, err);
            continue;
        }
        int64_t dims[2] = {*(const int64_t *)(base + field[k].rows_offset) + field[k].rows_extra,
                           field[k].columns};
        sf_h5_write(h5, &info, h5_type(field[k].type), field[k].columns > 1 ? 2 : 1, dims,
                    *(void *const *)member, err);
    }
    return err->status;
}

sf_status sf_model_write(const char *path, const sf_model *model, const sf_provenance *provenance,
                         sf_error *err) {
    char partial[SF_PATH_SIZE];
    sf_h5 *h5 = NULL;
    if (sf_replace_begin(path, partial, err) != SF_OK || sf_h5_create(partial, &h5, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(h5, "softfall-model", provenance, err) == SF_OK)
        write_fields(h5, model, err);
    sf_h5_close(&h5, err);
    if (err->status == SF_OK)
        return sf_replace_commit(partial, path, err);
    unlink(partial);
    return err->status;
}

static sf_status read_field(const sf_h5 *h5, const sf_model_field *field, sf_model *model, sf_error *err) {
    char *base = (char *)model;
    void *data = NULL;
    bool absent = field->optional && !sf_h5_exists(h5, field->path);
    if (field->rows_offset == SIZE_MAX) {
        if (absent)
            return SF_OK;
        if (sf_h5_read(h5, field->path, h5_type(field->type), 0, NULL, &data, err) != SF_OK)
            return err->status;
        memcpy(base + field->offset, data, 8);
        free(data);
        return SF_OK;
    }
    int64_t rows = *(const int64_t *)(base + field->rows_offset);
    if (rows < 0 || rows > INT64_MAX / 2)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: its count %lld is not between 0 and %lld", field->path,
                       (long long)rows, (long long)(INT64_MAX / 2));
    if (absent && rows == 0)
        return SF_OK;
    int64_t dims[2] = {rows + field->rows_extra, field->columns};
    sf_status status =
        sf_h5_read(h5, field->path, h5_type(field->type), field->columns > 1 ? 2 : 1, dims, &data, err);
    *(void **)(base + field->offset) = data;
    return status;
}

sf_status sf_model_read(const char *path, sf_model *model, sf_h5 **file, sf_error *err) {
    sf_h5 *h5 = NULL;
    sf_error inner = SF_ERROR_INIT;
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    memset(model, 0, sizeof *model);
    if (sf_h5_open(path, &h5, err) != SF_OK)
        return err->status;
    sf_status status = sf_provenance_check(h5, path, "softfall-model", &inner);
    for (size_t k = 0; k < count && status == SF_OK; k++)
        status = read_field(h5, &field[k], model, &inner);
    if (status == SF_OK)
        status = sf_model_check(model, &inner);
    if (status != SF_OK) {
        SF_FAIL(err, inner.status, inner.status == SF_ERR_MODEL ? "%.200s: %.800s" : "%.0s%.800s", path,
                inner.text);
        sf_model_free(model);
    }
    if (status == SF_OK && file)
        *file = h5;
    else
        sf_h5_close(&h5, &inner);
    return status;
}
