/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/h5.h"

#include "io/h5_file.h"
#include <errno.h>
#include <string.h>

static sf_status wrap(hid_t id, const char *path, bool alone, sf_h5 **file, sf_error *err) {
    sf_h5 *made = calloc(1, sizeof *made);
    if (!made || !(made->path = strdup(path))) {
        free(made);
        H5Fclose(id);
        return SF_NO_MEMORY(err, "%s", path);
    }
    made->id = id;
    made->alone = alone;
    *file = made;
    return SF_OK;
}

sf_status sf_h5_create(const char *path, sf_h5 **file, sf_error *err) {
    *file = NULL;
    sf_h5_begin();
    errno = 0;
    hid_t id = H5Fcreate(path, H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0)
        H5Fflush(id, H5F_SCOPE_LOCAL); /* its signature tells what it is if this process is killed */
    else
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be created: %s", path,
                       errno ? strerror(errno) : "HDF5 refuses it");
    return wrap(id, path, true, file, err);
}

static sf_status open_file(const char *path, bool alone, sf_h5 **file, sf_error *err) {
    *file = NULL;
    sf_h5_begin();
    hid_t id = sf_h5_open_plain(path, err);
    return id < 0 ? err->status : wrap(id, path, alone, file, err);
}

sf_status sf_h5_open(const char *path, sf_h5 **file, sf_error *err) {
    return open_file(path, false, file, err);
}

sf_status sf_h5_open_alone(const char *path, sf_h5 **file, sf_error *err) {
    return open_file(path, true, file, err);
}

sf_status sf_h5_close(sf_h5 **file, sf_error *err) {
    if (!*file)
        return SF_OK;
    sf_status status = SF_OK;
    if (H5Fclose((*file)->id) < 0)
        status = SF_FAIL(err, SF_ERR_IO, "closing %s failed: its last data may be missing (disk full?)",
                         (*file)->path);
    SF_FREE((*file)->path, *file);
    *file = NULL;
    return status;
}

void sf_h5_drop(sf_h5 **file) {
    sf_h5_close(file, SF_IGNORED);
}

bool sf_h5_exists(const sf_h5 *file, const char *path) {
    hid_t in;
    bool found = sf_h5_find(file, path, &in) == LINK_HARD;
    sf_h5_leave(file, in);
    return found;
}

int64_t sf_h5_group_size(const sf_h5 *file, const char *path) {
    H5G_info_t info;
    hid_t in;
    bool known = sf_h5_find(file, path, &in) == LINK_HARD &&
                 H5Gget_info_by_name(in, path, &info, H5P_DEFAULT) >= 0 &&
                 info.nlinks <= sf_h5_file_bytes(in); /* a count that such a file can hold */
    sf_h5_leave(file, in);
    return known ? (int64_t)info.nlinks : -1;
}

sf_status sf_h5_group_member(const sf_h5 *file, const char *path, int64_t index, char *name, size_t size,
                             sf_error *err) {
    hid_t in;
    ssize_t length = -1;
    if (sf_h5_find(file, path, &in) == LINK_HARD)
        length =
            H5Lget_name_by_idx(in, path, H5_INDEX_NAME, H5_ITER_INC, (hsize_t)index, name, size, H5P_DEFAULT);
    sf_h5_leave(file, in);
    if (length < 0 || (size_t)length >= size)
        return SF_FAIL(err, SF_ERR_IO, "%s: group %s has no readable member %lld", file->path, path,
                       (long long)index);
    return SF_OK;
}

const char *sf_h5_version(void) {
    return &H5_VERS_INFO[sizeof "HDF5 library version: " - 1];
}
