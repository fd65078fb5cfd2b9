/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/h5_data.h"

#include "io/h5_file.h"
#include "io/replace.h"
#include <string.h>

enum { SF_H5_MAX_RANK = 4, SF_H5_ATTRIBUTE_SIZE = 65536, SF_H5_COPY_SIZE = 1 << 16 };
enum { SF_H5_PIECE_SIZE = 1 << 20, SF_H5_PACKED_FROM = 1 << 14 }; /* bytes */
enum { SF_H5_DEFLATE = 1 };                                       /* level */

/* Closes an id of HDF5, if it is not below 0, at the end of its block: KEPT hid_t space = ...; H5Idec_ref
 * would leave the id of a dataset whose last write failed. */
#define KEPT SF_OWNED_BY(let_go)
static void let_go(hid_t *id) {
    if (*id >= 0 && H5Iget_type(*id) == H5I_DATASET)
        H5Dclose(*id);
    else if (*id >= 0)
        H5Idec_ref(*id);
}

size_t sf_h5_size(sf_h5_type type) {
    static const size_t size[] = {[SF_H5_F64] = 8, [SF_H5_I32] = 4, [SF_H5_I64] = 8, [SF_H5_U8] = 1};
    return size[type];
}

static hid_t native_type(sf_h5_type type) {
    switch (type) {
    case SF_H5_I32:
        return H5T_NATIVE_INT32;
    case SF_H5_I64:
        return H5T_NATIVE_INT64;
    case SF_H5_U8:
        return H5T_NATIVE_UINT8;
    default:
        return H5T_NATIVE_DOUBLE;
    }
}

/* The type of a text. */
static hid_t text_type(const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return type;
}

static hid_t make_space(int rank, const int64_t *dims) {
    hsize_t extent[SF_H5_MAX_RANK] = {0};
    for (int k = 0; k < rank; k++)
        extent[k] = (hsize_t)dims[k];
    return rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, extent, NULL);
}

/* Replaces an attribute of an open object. */
static sf_status put_attribute(const sf_h5 *file, hid_t object, const char *name, hid_t type,
                               const void *value, sf_error *err) {
    KEPT hid_t space = make_space(0, NULL);
    if (H5Aexists(object, name) > 0)
        H5Adelete(object, name);
    KEPT hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0 || H5Awrite(attribute, type, value) < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: attribute %s cannot be written", file->path, name);
    return SF_OK;
}

static sf_status string_attribute(const sf_h5 *file, hid_t object, const char *name, const char *text,
                                  sf_error *err) {
    KEPT hid_t type = text_type(text);
    return put_attribute(file, object, name, type, text, err);
}

/* Links that are made with the groups above them. */
static hid_t make_groups(void) {
    hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    return links;
}

/* Creates a dataset with its two attributes and closes it again unless `keep` is given. `storage`: a property
 * list, or H5P_DEFAULT. */
static sf_status create_dataset(sf_h5 *file, const sf_h5_info *info, hid_t type, hid_t space, hid_t storage,
                                hid_t *keep, sf_error *err) {
    KEPT hid_t links = make_groups();
    KEPT hid_t set = H5Dcreate2(file->id, info->path, type, space, links, storage, H5P_DEFAULT);
    if (set < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: dataset %s cannot be created", file->path, info->path);
    SF_TRY(string_attribute(file, set, "units", info->units, err));
    SF_TRY(string_attribute(file, set, "description", info->description, err));
    *keep = set;
    set = -1;
    return SF_OK;
}

/* Reads rows of an open dataset into `out`, or writes them from `in`. A scalar is one row. */
static bool move_rows(hid_t set, hid_t type, int64_t first, int64_t rows, void *out, const void *in) {
    KEPT hid_t space = H5Dget_space(set);
    hsize_t start[H5S_MAX_RANK] = {(hsize_t)first}, count[H5S_MAX_RANK];
    int rank = H5Sget_simple_extent_dims(space, count, NULL);
    count[0] = (hsize_t)rows;
    KEPT hid_t memory = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, count, NULL);
    herr_t result = 0;
    if (H5Sget_simple_extent_npoints(memory) > 0) {
        if (rank > 0)
            result = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
        if (result >= 0)
            result = out ? H5Dread(set, type, memory, space, H5P_DEFAULT, out)
                         : H5Dwrite(set, type, memory, space, H5P_DEFAULT, in);
    }
    return result >= 0;
}

sf_status sf_h5_rows_begin(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank,
                           const int64_t *dims, sf_h5_rows *rows, sf_error *err) {
    KEPT hid_t space = make_space(rank, dims);
    *rows = (sf_h5_rows){
        .file = file, .path = info->path, .type = type, .count = rank == 0 ? 1 : dims[0], .set = -1};
    return create_dataset(file, info, native_type(type), space, H5P_DEFAULT, &rows->set, err);
}

sf_status sf_h5_rows_add(sf_h5_rows *rows, int64_t count, const void *data, sf_error *err) {
    if (!move_rows(rows->set, native_type(rows->type), rows->next, count, NULL, data))
        return SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, rows->file->path, rows->path);
    rows->next += count;
    return SF_OK;
}

sf_status sf_h5_rows_end(sf_h5_rows *rows, sf_error *err) {
    if (rows->set < 0)
        return err->status;
    if (H5Dclose(rows->set) < 0) /* small pieces wait in the library until now */
        SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, rows->file->path, rows->path);
    rows->set = -1;
    if (err->status == SF_OK && rows->next != rows->count)
        SF_FAIL(err, SF_ERR_IO, "%s: %s was given %lld of its %lld rows", rows->file->path, rows->path,
                (long long)rows->next, (long long)rows->count);
    return err->status;
}

sf_status sf_h5_write(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank, const int64_t *dims,
                      const void *data, sf_error *err) {
    sf_h5_rows rows;
    if (sf_h5_rows_begin(file, info, type, rank, dims, &rows, err) == SF_OK)
        sf_h5_rows_add(&rows, rows.count, data, err);
    return sf_h5_rows_end(&rows, err);
}

/* Pieces of whole rows, of about a megabyte. Little to compress: as any dataset, as starting deflate would
 * take longer than writing it. */
static hid_t packed_storage(int rank, const int64_t *dims, size_t item_size) {
    hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t piece[SF_H5_MAX_RANK];
    size_t row = item_size;
    for (int k = 1; k < rank; k++) {
        piece[k] = (hsize_t)dims[k];
        row *= (size_t)dims[k];
    }
    if (rank == 0 || row * (size_t)dims[0] < SF_H5_PACKED_FROM)
        return storage;
    int64_t most = row < SF_H5_PIECE_SIZE ? (int64_t)(SF_H5_PIECE_SIZE / row) : 1;
    piece[0] = (hsize_t)(dims[0] < most ? dims[0] : most);
    H5Pset_chunk(storage, rank, piece);
    H5Pset_shuffle(storage);
    H5Pset_deflate(storage, SF_H5_DEFLATE);
    return storage;
}

static sf_status write_packed(sf_h5 *file, const sf_h5_info *info, hid_t type, int rank, const int64_t *dims,
                              const void *data, sf_error *err) {
    hid_t set = -1;
    KEPT hid_t space = make_space(rank, dims);
    KEPT hid_t storage = packed_storage(rank, dims, H5Tget_size(type));
    create_dataset(file, info, type, space, storage, &set, err);
    bool written = set < 0 || H5Sget_simple_extent_npoints(space) == 0 ||
                   H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0;
    if ((set >= 0 && H5Dclose(set) < 0) || !written)
        SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, file->path, info->path);
    return err->status;
}

sf_status sf_h5_write_packed(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank,
                             const int64_t *dims, const void *data, sf_error *err) {
    return write_packed(file, info, native_type(type), rank, dims, data, err);
}

/* Converted here: HDF5 would clear a buffer of a megabyte for each dataset. */
sf_status sf_h5_write_singles(sf_h5 *file, const sf_h5_info *info, int rank, const int64_t *dims,
                              const double *data, sf_error *err) {
    int64_t count = 1;
    for (int k = 0; k < rank; k++)
        count *= dims[k];
    SF_OWNED float *single = sf_alloc(err, (size_t)count, sizeof *single, info->path);
    SF_TRY(err->status);
    for (int64_t i = 0; i < count; i++)
        single[i] = (float)data[i];
    return write_packed(file, info, H5T_NATIVE_FLOAT, rank, dims, single, err);
}

sf_status sf_h5_write_scalar(sf_h5 *file, const sf_h5_info *info, double value, sf_error *err) {
    return sf_h5_write(file, info, SF_H5_F64, 0, NULL, &value, err);
}

sf_status sf_h5_write_text(sf_h5 *file, const sf_h5_info *info, const char *text, sf_error *err) {
    KEPT hid_t type = text_type(text), space = make_space(0, NULL), set = -1;
    SF_TRY(create_dataset(file, info, type, space, H5P_DEFAULT, &set, err));
    bool written = H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0;
    written = H5Dclose(set) >= 0 && written; /* HDF5 may write a short text only here */
    set = -1;
    if (!written)
        return SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, file->path, info->path);
    return SF_OK;
}

/* Data of other files (external, virtual) would let a file refer to data outside it, and a filter
 * (compression) lets a small file claim a large memory: softfall writes neither and refuses both. */
static sf_status check_storage(const sf_h5 *file, const char *path, hid_t set, sf_error *err) {
    KEPT hid_t creation = H5Dget_create_plist(set);
    H5D_layout_t layout = H5Pget_layout(creation);
    int external = H5Pget_external_count(creation), filters = H5Pget_nfilters(creation);
    if (external != 0 || layout == H5D_VIRTUAL || layout == H5D_LAYOUT_ERROR)
        return SF_FAIL(err, SF_ERR_IO, "%s: the data of %s are in another file, which is not read",
                       file->path, path);
    if (filters != 0)
        return SF_FAIL(
            err, SF_ERR_IO,
            "%s: %s is compressed or filtered; only plain data are read: make it anew with the program "
            "that wrote it",
            file->path, path);
    return SF_OK;
}

/* The storage of a dataset must be known before any other property is asked for: even the extent of a
 * virtual dataset is looked up in the other files. The caller closes *set, also on failure. */
static sf_status open_dataset(const sf_h5 *file, const char *path, hid_t *set, sf_error *err) {
    hid_t in;
    int found = sf_h5_find(file, path, &in);
    *set = found == LINK_HARD ? H5Dopen2(in, path, H5P_DEFAULT) : -1;
    sf_h5_leave(file, in); /* the dataset holds it open */
    if (found == LINK_NONE)
        return SF_FAIL(err, SF_ERR_IO, "%s has no dataset %s: it is incomplete or not of this kind",
                       file->path, path);
    if (found == LINK_ELSEWHERE)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s is reached by a soft or external link, which is not followed",
                       file->path, path);
    if (found == LINK_DAMAGED)
        return SF_FAIL(err, SF_ERR_IO, "%s: the file of its run that holds %s is damaged", file->path, path);
    if (*set < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s is not a dataset", file->path, path);
    return check_storage(file, path, *set, err);
}

/* A dataset that is read. */
typedef struct open_set {
    const sf_h5 *file;
    const char *path;
    hid_t id;
} open_set;

/* Rank and extents of a dataset against what the caller expects; fills dims and the number of items.
 * A header may claim any extent: the items must be stored, and within the size of the file. */
static sf_status check_shape(const open_set *set, size_t item_size, int rank, int64_t *dims,
                             unsigned long *count, sf_error *err) {
    const char *file = set->file->path, *path = set->path;
    KEPT hid_t space = H5Dget_space(set->id);
    int found = H5Sget_simple_extent_ndims(space);
    H5S_class_t kind = H5Sget_simple_extent_type(space);
    hsize_t extent[SF_H5_MAX_RANK] = {0};
    if (found == rank)
        H5Sget_simple_extent_dims(space, extent, NULL);
    if (found != rank || kind == H5S_NULL)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s has rank %d, expected %d", file, path, found, rank);
    uint64_t bytes = item_size;
    bool overflow = false;
    *count = 1;
    for (int k = 0; k < rank; k++) {
        if (dims[k] >= 0 && (hsize_t)dims[k] != extent[k])
            return SF_FAIL(err, SF_ERR_IO, "%s: %s has extent %llu in dimension %d, expected %lld", file,
                           path, (unsigned long long)extent[k], k, (long long)dims[k]);
        overflow = overflow || extent[k] > INT64_MAX || __builtin_mul_overflow(bytes, extent[k], &bytes) ||
                   __builtin_mul_overflow(*count, (unsigned long)extent[k], count);
        dims[k] = (int64_t)extent[k];
    }
    hsize_t stored = H5Dget_storage_size(set->id);
    uint64_t size = sf_h5_file_bytes(set->id);
    if (overflow || (*count > 0 && (bytes > stored || bytes > size)))
        return SF_FAIL(err, SF_ERR_IO,
                       "%s: %s claims %llu%s bytes, of which %llu are stored in a file of %llu", file, path,
                       (unsigned long long)bytes, overflow ? " (and more)" : "", (unsigned long long)stored,
                       (unsigned long long)size);
    return SF_OK;
}

static sf_status read_items(const open_set *set, sf_h5_type type, int rank, int64_t *dims, void **data,
                            sf_error *err) {
    const char *file = set->file->path, *path = set->path;
    unsigned long count = 0;
    KEPT hid_t stored = H5Dget_type(set->id);
    H5T_class_t expected = type == SF_H5_F64 ? H5T_FLOAT : H5T_INTEGER, found = H5Tget_class(stored);
    size_t size = H5Tget_size(stored);
    if (found != expected)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s does not hold %s numbers", file, path,
                       expected == H5T_FLOAT ? "floating-point" : "integer");
    SF_TRY(check_shape(set, size, rank, dims, &count, err));
    *data = sf_alloc(err, count, sf_h5_size(type), path);
    if (*data && count && H5Dread(set->id, native_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, *data) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s: %s cannot be read", file, path);
    *data = sf_keep(*data, err);
    return err->status;
}

sf_status sf_h5_read(const sf_h5 *file, const char *path, sf_h5_type type, int rank, int64_t *dims,
                     void **data, sf_error *err) {
    KEPT hid_t set = -1;
    *data = NULL;
    SF_TRY(open_dataset(file, path, &set, err));
    return read_items(&(open_set){file, path, set}, type, rank, dims, data, err);
}

sf_status sf_h5_read_one(const sf_h5 *file, const char *path, sf_h5_type type, void *value, sf_error *err) {
    SF_OWNED void *data = NULL;
    SF_TRY(sf_h5_read(file, path, type, 0, NULL, &data, err));
    memcpy(value, data, 8);
    return SF_OK;
}

sf_status sf_h5_read_scalar(const sf_h5 *file, const char *path, double *value, sf_error *err) {
    return sf_h5_read_one(file, path, SF_H5_F64, value, err);
}

/* Room for one fixed-length string of at most `limit` bytes, NULL if the type or the space is anything else;
 * the caller frees. */
static char *text_buffer(hid_t type, hid_t space, uint64_t limit) {
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
        H5Sget_simple_extent_npoints(space) != 1 || H5Tget_size(type) > limit)
        return NULL;
    return calloc(H5Tget_size(type) + 1, 1);
}

sf_status sf_h5_read_text(const sf_h5 *file, const char *path, char **text, sf_error *err) {
    *text = NULL;
    KEPT hid_t set = -1;
    SF_TRY(open_dataset(file, path, &set, err));
    KEPT hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    SF_OWNED char *buffer = text_buffer(type, space, sf_h5_file_bytes(set));
    if (!buffer || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s is not a readable text", file->path, path);
    *text = buffer;
    buffer = NULL;
    return SF_OK;
}

sf_status sf_h5_set_attribute(sf_h5 *file, const char *name, const char *text, sf_error *err) {
    return string_attribute(file, file->id, name, text, err);
}

sf_status sf_h5_set_attribute_i64(sf_h5 *file, const char *name, int64_t value, sf_error *err) {
    return put_attribute(file, file->id, name, H5T_NATIVE_INT64, &value, err);
}

static sf_status open_attribute(const sf_h5 *file, const char *object, const char *name, hid_t *id,
                                sf_error *err) {
    hid_t in;
    *id = sf_h5_find(file, object, &in) == LINK_HARD
              ? H5Aopen_by_name(in, object, name, H5P_DEFAULT, H5P_DEFAULT)
              : -1;
    sf_h5_leave(file, in); /* the attribute holds it open */
    if (*id < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s has no attribute %s", file->path, object, name);
    return SF_OK;
}

sf_status sf_h5_get_attribute(const sf_h5 *file, const char *object, const char *name, char *text,
                              size_t size, sf_error *err) {
    KEPT hid_t id = -1;
    SF_TRY(open_attribute(file, object, name, &id, err));
    KEPT hid_t type = H5Aget_type(id), space = H5Aget_space(id);
    SF_OWNED char *buffer = text_buffer(type, space, SF_H5_ATTRIBUTE_SIZE);
    if (!buffer || H5Aread(id, type, buffer) < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: attribute %s of %s is not a readable text", file->path, name,
                       object);
    snprintf(text, size, "%s", buffer);
    return SF_OK;
}

sf_status sf_h5_get_attribute_i64(const sf_h5 *file, const char *object, const char *name, int64_t *value,
                                  sf_error *err) {
    KEPT hid_t id = -1;
    SF_TRY(open_attribute(file, object, name, &id, err));
    KEPT hid_t space = H5Aget_space(id);
    if (H5Sget_simple_extent_npoints(space) != 1 || H5Aread(id, H5T_NATIVE_INT64, value) < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: attribute %s of %s is not one integer", file->path, name, object);
    return SF_OK;
}

/* All rows of a dataset of `items` items to one of the same shape, some of them at a time. */
static sf_status copy_rows(const open_set *from, const open_set *to, hid_t type, int64_t items,
                           sf_error *err) {
    const char *path = from->path;
    KEPT hid_t space = H5Dget_space(from->id);
    hsize_t extent[H5S_MAX_RANK] = {1};
    H5Sget_simple_extent_dims(space, extent, NULL);
    int64_t rows = (int64_t)extent[0], row_size = items / rows * (int64_t)H5Tget_size(type);
    int64_t piece = row_size < SF_H5_COPY_SIZE ? SF_H5_COPY_SIZE / row_size : 1;
    piece = piece < rows ? piece : rows;
    SF_OWNED void *data = sf_alloc(err, piece, (unsigned long)row_size, path);
    for (int64_t first = 0; first < rows && err->status == SF_OK; first += piece) {
        int64_t count = piece < rows - first ? piece : rows - first;
        if (!move_rows(from->id, type, first, count, data, NULL))
            SF_FAIL(err, SF_ERR_IO, "%s: %s cannot be read", from->file->path, path);
        else if (!move_rows(to->id, type, first, count, NULL, data))
            SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, to->file->path, path);
    }
    return err->status;
}

/* One plain dataset with its two attributes. */
static sf_status copy_dataset(const sf_h5 *from, const char *path, hid_t set, sf_h5 *to, sf_error *err) {
    char units[128], description[512];
    KEPT hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    hid_t made = -1;
    hssize_t items = H5Sget_simple_extent_npoints(space);
    size_t size = H5Tget_size(type);
    if (sf_h5_get_attribute(from, path, "units", units, sizeof units, err) == SF_OK &&
        sf_h5_get_attribute(from, path, "description", description, sizeof description, err) == SF_OK &&
        (items < 0 || size == 0 || (uint64_t)items > sf_h5_file_bytes(set) / size))
        SF_FAIL(err, SF_ERR_IO, "%s: %s claims more than its file can hold", from->path, path);
    sf_h5_info info = {path, units, description};
    if (err->status == SF_OK && create_dataset(to, &info, type, space, H5P_DEFAULT, &made, err) == SF_OK &&
        items > 0)
        copy_rows(&(open_set){from, path, set}, &(open_set){to, path, made}, type, items, err);
    if (made >= 0 && H5Dclose(made) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s: " SF_NOT_WRITTEN, to->path, path);
    return err->status;
}

/* Not by H5Ocopy, which crashes when the disk is full (HDF5 1.10). */
sf_status sf_h5_copy(const sf_h5 *from, const char *path, sf_h5 *to, sf_error *err) {
    int64_t members = sf_h5_group_size(from, path);
    KEPT hid_t set = -1;
    for (int64_t k = 0; k < members && err->status == SF_OK; k++) {
        char name[128], member[512];
        if (sf_h5_group_member(from, path, k, name, sizeof name, err) != SF_OK)
            break;
        if ((size_t)snprintf(member, sizeof member, "%s/%s", path, name) >= sizeof member)
            return SF_FAIL(err, SF_ERR_IO, "%s: %s lies too deep", from->path, path);
        sf_h5_copy(from, member, to, err);
    }
    if (members >= 0 || open_dataset(from, path, &set, err) != SF_OK)
        return err->status;
    return copy_dataset(from, path, set, to, err);
}

sf_status sf_h5_link(sf_h5 *file, const char *path, const char *target, sf_error *err) {
    KEPT hid_t links = make_groups();
    if (H5Lcreate_external(target, path, file->id, path, links, H5P_DEFAULT) < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: no link %s to %s can be made", file->path, path, target);
    return SF_OK;
}

sf_status sf_h5_check_replaced(const char *path, const char *format, sf_error *err) {
    char found[64] = "";
    sf_h5 file = {.alone = true, .path = (char[]){""}};
    if (!sf_replace_is_hdf5(path))
        return SF_REFUSE(err, "%s is not replaced, as it is no %s file: give another output", path, format);
    sf_h5_begin();
    file.id = sf_h5_open_replaced(path);
    if (file.id < 0) /* there is none, or it cannot be told */
        return SF_OK;
    sf_h5_get_attribute(&file, "/", "format", found, sizeof found, SF_IGNORED);
    H5Fclose(file.id);
    if (strcmp(found, format) == 0)
        return SF_OK;
    return SF_REFUSE(err, "%s is not replaced, as it is %s%s and no %s file: give another output", path,
                     *found ? "a file of the format " : "an HDF5 file of another program", found, format);
}
