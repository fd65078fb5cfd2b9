/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/model_io.h"

#include "io/h5_data.h"
#include "io/replace.h"
#include "material/laws.h"
#include "model/model_check.h"

/* Writes a member of the model, or of a law's curves, as the dataset `path`. */
static sf_status write_field(sf_h5 *h5, const char *path, const sf_model_field *field, const void *record,
                             sf_error *err) {
    const sf_h5_info info = {path, field->units, field->description};
    const char *base = record, *member = base + field->offset;
    if (field->rows_offset == SIZE_MAX)
        return sf_h5_write(h5, &info, field->type, 0, NULL, member, err);
    const int64_t dims[2] = {*(const int64_t *)(base + field->rows_offset) + field->rows_extra,
                             field->columns};
    return sf_h5_write(h5, &info, field->type, field->columns > 1 ? 2 : 1, dims, *(void *const *)member, err);
}

static sf_status write_fields(sf_h5 *h5, const sf_model *model, sf_error *err) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    for (size_t k = 0; k < count && err->status == SF_OK; k++)
        write_field(h5, field[k].path, &field[k], model, err);
    return err->status;
}

/* ---- materials ---- */

enum { PATH_SIZE = 128 };

/* Names parameter `p`: the key E is /material/0/E, densification.limit is /material/0/densification_limit. */
static void name_parameter(int64_t index, const sf_parameter *p, char path[PATH_SIZE]) {
    const char *group = strchr(p->group, '.');
    snprintf(path, PATH_SIZE, "/material/%lld/%s%s%s", (long long)index, group ? group + 1 : "",
             group ? "_" : "", p->key);
}

/* The arrays of curves, in the order of sf_law_curves; the counts come first. Their paths begin in the group
 * of the material. */
#define CURVE(member, type, rows, extra, units, text)                                                        \
    { offsetof(sf_law_curves, member), type, rows, extra, 1, #member, units, text, false, false }
static const sf_model_field curve_fields[] = {
    CURVE(curve_count, SF_H5_I64, SIZE_MAX, 0, "1", "number of compression curves"),
    CURVE(curve_points, SF_H5_I64, SIZE_MAX, 0, "1", "number of points of all curves"),
    CURVE(curve_rate, SF_H5_F64, offsetof(sf_law_curves, curve_count), 0, "s-1", "strain rate of each curve"),
    CURVE(curve_ptr, SF_H5_I64, offsetof(sf_law_curves, curve_count), 1, "1", "start of each curve"),
    CURVE(curve_strain, SF_H5_F64, offsetof(sf_law_curves, curve_points), 0, "1", "engineering strain"),
    CURVE(curve_stress, SF_H5_F64, offsetof(sf_law_curves, curve_points), 0, "Pa", "engineering stress"),
};
enum { CURVE_FIELDS = sizeof curve_fields / sizeof curve_fields[0] };

static sf_status write_material(sf_h5 *h5, const sf_material *m, int64_t index, sf_error *err) {
    const sf_law_curves *curves = sf_material_curves(m);
    SF_PRINTED(path, PATH_SIZE, "/material/%lld/law", (long long)index);
    sf_h5_write_text(h5, &(sf_h5_info){path, "1", "law of the material"}, m->law->name, err);
    snprintf(path, sizeof path, "/material/%lld/name", (long long)index);
    if (*m->name && err->status == SF_OK)
        sf_h5_write_text(h5, &(sf_h5_info){path, "1", "layer of the material"}, m->name, err);
    for (int k = 0; k < m->law->parameter_count && err->status == SF_OK; k++) {
        const sf_parameter *p = &m->law->parameter[k];
        if (!sf_parameter_is_stored(p, m->card))
            continue;
        name_parameter(index, p, path);
        sf_h5_info info = {path, p->kind == SF_PARAMETER_QUANTITY ? sf_quantity_unit(p->quantity) : "1",
                           p->meaning};
        sf_h5_write(h5, &info, p->kind == SF_PARAMETER_CHOICE ? SF_H5_I64 : SF_H5_F64, 0, NULL,
                    (const char *)m->card + p->offset, err);
    }
    for (int k = 0; k < CURVE_FIELDS && curves && err->status == SF_OK; k++) {
        snprintf(path, sizeof path, "/material/%lld/%s", (long long)index, curve_fields[k].path);
        write_field(h5, path, &curve_fields[k], curves, err);
    }
    return err->status;
}

/* Reads a member of the model, or of a law's curves, from the dataset `path`. */
static sf_status read_field(const sf_h5 *h5, const char *path, const sf_model_field *field, void *record,
                            sf_error *err) {
    char *base = record;
    bool absent = field->optional && !sf_h5_exists(h5, path);
    if (field->rows_offset == SIZE_MAX)
        return absent ? SF_OK : sf_h5_read_one(h5, path, field->type, base + field->offset, err);
    int64_t rows = *(const int64_t *)(base + field->rows_offset);
    if (rows < 0 || rows > INT64_MAX / 2)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: its count" SF_OUTSIDE("%lld", "0", "%lld"), path,
                       (long long)rows, (long long)(INT64_MAX / 2));
    if (absent && rows == 0)
        return SF_OK;
    if (absent)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "%s is missing: an older version made this model; make it anew with softfall-pre",
                       path);
    int64_t dims[2] = {rows + field->rows_extra, field->columns};
    return sf_h5_read(h5, path, field->type, field->columns > 1 ? 2 : 1, dims,
                      (void **)(base + field->offset), err);
}

/* The name of a layer; "" if there is none. */
static sf_status read_material_name(const sf_h5 *h5, int64_t index, char name[SF_MATERIAL_NAME_SIZE],
                                    sf_error *err) {
    SF_OWNED char *text = NULL;
    SF_PRINTED(path, PATH_SIZE, "/material/%lld/name", (long long)index);
    if (!sf_h5_exists(h5, path))
        return SF_OK;
    if (sf_h5_read_text(h5, path, &text, err) == SF_OK &&
        snprintf(name, SF_MATERIAL_NAME_SIZE, "%s", text) >= SF_MATERIAL_NAME_SIZE)
        SF_FAIL(err, SF_ERR_MODEL, "%s is longer than %d characters", path, SF_MATERIAL_NAME_SIZE - 1);
    return err->status;
}

static sf_status read_material(const sf_h5 *h5, sf_material *m, int64_t index, sf_error *err) {
    SF_OWNED char *name = NULL;
    SF_PRINTED(path, PATH_SIZE, "/material/%lld/law", (long long)index);
    SF_TRY(sf_h5_read_text(h5, path, &name, err));
    const sf_law *law = sf_law_find(name);
    if (!law)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: \"%.80s\" is not a law that this program has", path, name);
    SF_TRY(sf_material_create(law, m, err));
    SF_TRY(read_material_name(h5, index, m->name, err));
    for (int k = 0; k < law->parameter_count && err->status == SF_OK; k++) {
        const sf_parameter *p = &law->parameter[k];
        if (p->kind > SF_PARAMETER_CHOICE)
            continue;
        name_parameter(index, p, path);
        if (p->optional && !sf_h5_exists(h5, path))
            continue;
        sf_h5_read_one(h5, path, p->kind == SF_PARAMETER_CHOICE ? SF_H5_I64 : SF_H5_F64,
                       (char *)m->card + p->offset, err);
    }
    sf_law_curves *curves = sf_material_curves(m);
    for (int k = 0; k < CURVE_FIELDS && curves && err->status == SF_OK; k++) {
        snprintf(path, sizeof path, "/material/%lld/%s", (long long)index, curve_fields[k].path);
        read_field(h5, path, &curve_fields[k], curves, err);
    }
    return err->status;
}

static sf_status read_materials(const sf_h5 *h5, sf_model *model, sf_error *err) {
    int64_t count = model->material_count;
    if (count < 1 || count > SF_MATERIAL_MAX)
        return SF_FAIL(err, SF_ERR_MODEL, "/material/count" SF_OUTSIDE("%lld", "1", "%d"), (long long)count,
                       SF_MATERIAL_MAX);
    model->material = sf_alloc(err, count, sizeof *model->material, "materials");
    for (int64_t k = 0; k < count && err->status == SF_OK; k++)
        read_material(h5, &model->material[k], k, err);
    return err->status;
}

/* ---- the hash of the content ---- */

/* A flipped bit may give another valid model: only the hash tells. */
static sf_status check_content_hash(const sf_h5 *h5, const sf_model *model, sf_error *err) {
    char stored[64], hash[SF_MODEL_HASH_SIZE];
    SF_TRY(sf_h5_get_attribute(h5, "/", "content_hash", stored, sizeof stored, err));
    sf_model_hash(model, hash);
    if (strcmp(stored, hash) != 0)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "is damaged or was changed, or an older version made it (then make it anew with "
                       "softfall-pre): the hash of its content is %s, not %s",
                       hash, stored);
    return SF_OK;
}

sf_status sf_model_write(const char *path, const sf_model *model, const sf_provenance *provenance,
                         sf_error *err) {
    char partial[SF_PATH_SIZE], hash[SF_MODEL_HASH_SIZE];
    sf_h5 *h5 = NULL;
    if (sf_replace_begin(path, partial, err) != SF_OK || sf_h5_create(partial, &h5, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(h5, "softfall-model", provenance, err) == SF_OK)
        write_fields(h5, model, err);
    for (int64_t k = 0; k < model->material_count && err->status == SF_OK; k++)
        write_material(h5, &model->material[k], k, err);
    sf_model_hash(model, hash);
    if (err->status == SF_OK)
        sf_h5_set_attribute(h5, "content_hash", hash, err);
    sf_h5_close(&h5, err);
    return sf_replace_commit(partial, path, err);
}

sf_status sf_model_read(const char *path, sf_model *model, sf_h5 **file, sf_error *err) {
    sf_h5 *h5 = NULL;
    sf_error inner = SF_ERROR_INIT;
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    memset(model, 0, sizeof *model);
    SF_TRY(sf_h5_open(path, &h5, err));
    sf_provenance_check(h5, path, "softfall-model", &inner);
    for (size_t k = 0; k < count && inner.status == SF_OK; k++)
        read_field(h5, field[k].path, &field[k], model, &inner);
    if (inner.status == SF_OK && read_materials(h5, model, &inner) == SF_OK &&
        sf_model_check(model, &inner) == SF_OK)
        check_content_hash(h5, model, &inner);
    if (inner.status != SF_OK) {
        SF_FAIL(err, inner.status, inner.status == SF_ERR_MODEL ? "%.200s: %.800s" : "%.0s%.800s", path,
                inner.text);
        sf_model_free(model);
    }
    if (inner.status == SF_OK && file)
        *file = h5;
    else
        sf_h5_drop(&h5);
    return err->status;
}
