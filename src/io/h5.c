/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/h5.h"

#include <errno.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SF_H5_MAX_RANK = 4 };

struct sf_h5 {
    hid_t id;
    char *path;
};

static hid_t native_type(sf_h5_type type) {
    switch (type) {
    case SF_H5_F64:
        return H5T_NATIVE_DOUBLE;
    case SF_H5_I32:
        return H5T_NATIVE_INT32;
    case SF_H5_I64:
        return H5T_NATIVE_INT64;
    case SF_H5_U8:
        return H5T_NATIVE_UINT8;
    }
    return H5T_NATIVE_DOUBLE;
}

static size_t type_size(sf_h5_type type) {
    return type == SF_H5_U8 ? 1 : type == SF_H5_I32 ? 4 : 8;
}

static sf_status wrap(hid_t id, const char *path, sf_h5 **file, sf_error *err) {
    sf_h5 *made = malloc(sizeof *made);
    char *copy = strdup(path);
    if (!made || !copy) {
        free(made);
        free(copy);
        H5Fclose(id);
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory opening %s", path);
    }
    made->id = id;
    made->path = copy;
    *file = made;
    return SF_OK;
}

sf_status sf_h5_create(const char *path, sf_h5 **file, sf_error *err) {
    *file = NULL;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    errno = 0;
    hid_t id = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (id < 0)
        return SF_FAIL(err, SF_ERR_IO, "cannot create %s: %s", path,
                       errno ? strerror(errno) : "HDF5 refuses it");
    return wrap(id, path, file, err);
}

sf_status sf_h5_open(const char *path, sf_h5 **file, sf_error *err) {
    *file = NULL;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (access(path, R_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "cannot read %s: %s", path, strerror(errno));
    if (H5Fis_hdf5(path) <= 0)
        return SF_FAIL(err, SF_ERR_IO, "%s is not an HDF5 file", path);
    hid_t id = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be opened: it is damaged or another program is writing it",
                       path);
    return wrap(id, path, file, err);
}

sf_status sf_h5_close(sf_h5 **file, sf_error *err) {
    if (!*file)
        return SF_OK;
    sf_status status = SF_OK;
    if (H5Fclose((*file)->id) < 0)
        status = SF_FAIL(err, SF_ERR_IO, "closing %s failed: its last data may be missing (disk full?)",
                         (*file)->path);
    free((*file)->path);
    free(*file);
    *file = NULL;
    return status;
}

bool sf_h5_exists(const sf_h5 *file, const char *path) {
    /* H5Lexists fails on a path whose parent is missing: test each prefix. */
    char part[512];
    size_t length = strlen(path);
    if (length >= sizeof part || path[0] != '/')
        return false;
    for (size_t k = 1; k <= length; k++) {
        if (path[k] != '/' && path[k] != '\0')
            continue;
        memcpy(part, path, k);
        part[k] = '\0';
        if (k > 1 && H5Lexists(file->id, part, H5P_DEFAULT) <= 0)
            return false;
    }
    return true;
}

int64_t sf_h5_group_size(const sf_h5 *file, const char *path) {
    H5G_info_t info;
    if (!sf_h5_exists(file, path) || H5Gget_info_by_name(file->id, path, &info, H5P_DEFAULT) < 0)
        return -1;
    return (int64_t)info.nlinks;
}

sf_status sf_h5_group_member(const sf_h5 *file, const char *path, int64_t index, char *name, size_t size,
                             sf_error *err) {
    ssize_t length = H5Lget_name_by_idx(file->id, path, H5_INDEX_NAME, H5_ITER_INC, (hsize_t)index, name,
                                        size, H5P_DEFAULT);
    if (length < 0 || (size_t)length >= size)
        return SF_FAIL(err, SF_ERR_IO, "%s: group %s has no readable member %lld", file->path, path,
                       (long long)index);
    return SF_OK;
}

static sf_status string_attribute(const sf_h5 *file, hid_t object, const char *name, const char *text,
                                  sf_error *err) {
    if (H5Aexists(object, name) > 0)
        H5Adelete(object, name);
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    herr_t result = attribute < 0 ? -1 : H5Awrite(attribute, type, text);
    if (attribute >= 0)
        H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    if (result < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: attribute %s cannot be written", file->path, name);
    return SF_OK;
}

/* Links that are made with the groups above them. */
static hid_t make_groups(void) {
    hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    return links;
}

/* Creates a dataset with its two attributes and closes it again unless `keep` is given. */
static sf_status create_dataset(sf_h5 *file, const sf_h5_info *info, hid_t type, hid_t space, hid_t *keep,
                                sf_error *err) {
    hid_t links = make_groups();
    hid_t set = H5Dcreate2(file->id, info->path, type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    H5Pclose(links);
    if (set < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: dataset %s cannot be created", file->path, info->path);
    if (string_attribute(file, set, "units", info->units, err) != SF_OK ||
        string_attribute(file, set, "description", info->description, err) != SF_OK) {
        H5Dclose(set);
        return err->status;
    }
    *keep = set;
    return SF_OK;
}

sf_status sf_h5_write(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank, const int64_t *dims,
                      const void *data, sf_error *err) {
    hsize_t extent[SF_H5_MAX_RANK];
    bool empty = false;
    for (int k = 0; k < rank; k++) {
        extent[k] = (hsize_t)dims[k];
        empty = empty || dims[k] == 0;
    }
    hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, extent, NULL);
    hid_t set = -1;
    sf_status status = create_dataset(file, info, native_type(type), space, &set, err);
    if (status == SF_OK && !empty &&
        H5Dwrite(set, native_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)
        status = SF_FAIL(err, SF_ERR_IO, "%s: writing %s failed (disk full?)", file->path, info->path);
    if (set >= 0)
        H5Dclose(set);
    H5Sclose(space);
    return status;
}

sf_status sf_h5_write_scalar(sf_h5 *file, const sf_h5_info *info, double value, sf_error *err) {
    return sf_h5_write(file, info, SF_H5_F64, 0, NULL, &value, err);
}

sf_status sf_h5_write_text(sf_h5 *file, const sf_h5_info *info, const char *text, sf_error *err) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t set = -1;
    sf_status status = create_dataset(file, info, type, space, &set, err);
    if (status == SF_OK && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0)
        status = SF_FAIL(err, SF_ERR_IO, "%s: writing %s failed (disk full?)", file->path, info->path);
    if (set >= 0)
        H5Dclose(set);
    H5Sclose(space);
    H5Tclose(type);
    return status;
}

static sf_status open_dataset(const sf_h5 *file, const char *path, hid_t *set, sf_error *err) {
    if (!sf_h5_exists(file, path))
        return SF_FAIL(err, SF_ERR_IO, "%s has no dataset %s: it is incomplete or not of this kind",
                       file->path, path);
    *set = H5Dopen2(file->id, path, H5P_DEFAULT);
    if (*set < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s is not a dataset", file->path, path);
    return SF_OK;
}

/* Rank and extents of an open dataset against what the caller expects; fills dims and the number of items. */
static sf_status check_shape(const sf_h5 *file, const char *path, hid_t set, int rank, int64_t *dims,
                             unsigned long *count, sf_error *err) {
    hid_t space = H5Dget_space(set);
    int found = H5Sget_simple_extent_ndims(space);
    hsize_t extent[SF_H5_MAX_RANK] = {0};
    if (found == rank)
        H5Sget_simple_extent_dims(space, extent, NULL);
    H5Sclose(space);
    if (found != rank)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s has rank %d, expected %d", file->path, path, found, rank);
    *count = 1;
    for (int k = 0; k < rank; k++) {
        if (dims[k] >= 0 && (hsize_t)dims[k] != extent[k])
            return SF_FAIL(err, SF_ERR_IO, "%s: %s has extent %llu in dimension %d, expected %lld",
                           file->path, path, (unsigned long long)extent[k], k, (long long)dims[k]);
        dims[k] = (int64_t)extent[k];
        *count *= extent[k];
    }
    return SF_OK;
}

sf_status sf_h5_read(const sf_h5 *file, const char *path, sf_h5_type type, int rank, int64_t *dims,
                     void **data, sf_error *err) {
    *data = NULL;
    hid_t set = -1, stored = -1;
    unsigned long count = 0;
    if (open_dataset(file, path, &set, err) != SF_OK)
        return err->status;
    stored = H5Dget_type(set);
    H5T_class_t expected = type == SF_H5_F64 ? H5T_FLOAT : H5T_INTEGER;
    if (H5Tget_class(stored) != expected) {
        SF_FAIL(err, SF_ERR_IO, "%s: %s does not hold %s numbers", file->path, path,
                expected == H5T_FLOAT ? "floating-point" : "integer");
        goto done;
    }
    if (check_shape(file, path, set, rank, dims, &count, err) != SF_OK)
        goto done;
    /* A header may claim any extent; contiguous data cannot exceed what the file stores. */
    if (H5Dget_storage_size(set) == 0 && count > 0) {
        SF_FAIL(err, SF_ERR_IO, "%s: %s holds no data", file->path, path);
        goto done;
    }
    *data = sf_alloc(err, count, type_size(type), path);
    if (*data && count && H5Dread(set, native_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, *data) < 0) {
        SF_FAIL(err, SF_ERR_IO, "%s: reading %s failed", file->path, path);
        free(*data);
        *data = NULL;
    }
done:
    if (stored >= 0)
        H5Tclose(stored);
    H5Dclose(set);
    return err->status;
}

sf_status sf_h5_read_scalar(const sf_h5 *file, const char *path, double *value, sf_error *err) {
    void *data = NULL;
    if (sf_h5_read(file, path, SF_H5_F64, 0, NULL, &data, err) != SF_OK)
        return err->status;
    *value = *(double *)data;
    free(data);
    return SF_OK;
}

/* Reads a fixed-length string of an open dataset or attribute type; the caller frees. */
static char *text_buffer(hid_t type) {
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
        return NULL;
    return calloc(H5Tget_size(type) + 1, 1);
}

sf_status sf_h5_read_text(const sf_h5 *file, const char *path, char **text, sf_error *err) {
    *text = NULL;
    hid_t set = -1;
    if (open_dataset(file, path, &set, err) != SF_OK)
        return err->status;
    hid_t type = H5Dget_type(set);
    char *buffer = text_buffer(type);
    if (!buffer || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) < 0) {
        free(buffer);
        SF_FAIL(err, SF_ERR_IO, "%s: %s is not a readable text", file->path, path);
    } else {
        *text = buffer;
    }
    H5Tclose(type);
    H5Dclose(set);
    return err->status;
}

sf_status sf_h5_set_attribute(sf_h5 *file, const char *object, const char *name, const char *text,
                              sf_error *err) {
    hid_t id = H5Oopen(file->id, object, H5P_DEFAULT);
    if (id < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s has no object %s", file->path, object);
    sf_status status = string_attribute(file, id, name, text, err);
    H5Oclose(id);
    return status;
}

static sf_status open_attribute(const sf_h5 *file, const char *object, const char *name, hid_t *id,
                                sf_error *err) {
    *id = H5Aopen_by_name(file->id, object, name, H5P_DEFAULT, H5P_DEFAULT);
    if (*id < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: %s has no attribute %s", file->path, object, name);
    return SF_OK;
}

sf_status sf_h5_get_attribute(const sf_h5 *file, const char *object, const char *name, char *text,
                              size_t size, sf_error *err) {
    hid_t id = -1;
    if (open_attribute(file, object, name, &id, err) != SF_OK)
        return err->status;
    hid_t type = H5Aget_type(id);
    char *buffer = text_buffer(type);
    if (!buffer || H5Aread(id, type, buffer) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s: attribute %s of %s is not a readable text", file->path, name, object);
    else
        snprintf(text, size, "%s", buffer);
    free(buffer);
    H5Tclose(type);
    H5Aclose(id);
    return err->status;
}

sf_status sf_h5_set_attribute_i64(sf_h5 *file, const char *object, const char *name, int64_t value,
                                  sf_error *err) {
    hid_t id = H5Oopen(file->id, object, H5P_DEFAULT);
    if (id < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s has no object %s", file->path, object);
    if (H5Aexists(id, name) > 0)
        H5Adelete(id, name);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(id, name, H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0 || H5Awrite(attribute, H5T_NATIVE_INT64, &value) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s: attribute %s of %s cannot be written", file->path, name, object);
    if (attribute >= 0)
        H5Aclose(attribute);
    H5Sclose(space);
    H5Oclose(id);
    return err->status;
}

sf_status sf_h5_get_attribute_i64(const sf_h5 *file, const char *object, const char *name, int64_t *value,
                                  sf_error *err) {
    hid_t id = -1;
    if (open_attribute(file, object, name, &id, err) != SF_OK)
        return err->status;
    hid_t space = H5Aget_space(id);
    if (H5Sget_simple_extent_npoints(space) != 1 || H5Aread(id, H5T_NATIVE_INT64, value) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s: attribute %s of %s is not one integer", file->path, name, object);
    H5Sclose(space);
    H5Aclose(id);
    return err->status;
}

sf_status sf_h5_copy(const sf_h5 *from, const char *path, sf_h5 *to, sf_error *err) {
    hid_t links = make_groups();
    herr_t result = H5Ocopy(from->id, path, to->id, path, H5P_DEFAULT, links);
    H5Pclose(links);
    if (result < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s of %s cannot be copied to %s", path, from->path, to->path);
    return SF_OK;
}

sf_status sf_h5_link(sf_h5 *file, const char *path, const char *target, sf_error *err) {
    hid_t links = make_groups();
    herr_t result = H5Lcreate_external(target, path, file->id, path, links, H5P_DEFAULT);
    H5Pclose(links);
    if (result < 0)
        return SF_FAIL(err, SF_ERR_IO, "%s: no link %s to %s can be made", file->path, path, target);
    return SF_OK;
}

const char *sf_h5_version(void) {
    return &H5_VERS_INFO[sizeof "HDF5 library version: " - 1];
}
