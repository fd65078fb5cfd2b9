/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/h5_file.h"

#include "io/plain_file.h"
#include "io/replace.h"
#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void sf_h5_begin(void) {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

hid_t sf_h5_open_plain(const char *path, sf_error *err) {
    static const char signature[8] = "\211HDF\r\n\032\n";
    char name[32], begin[sizeof signature];
    sf_error inner = SF_ERROR_INIT;
    int gate;
    hid_t id = -1;
    if (sf_plain_open(path, NULL, &gate, NULL, &inner) != SF_OK) {
        SF_FAIL(err, inner.status == SF_ERR_MEMORY ? inner.status : SF_ERR_IO, "%s", inner.text);
        return -1;
    }
    snprintf(name, sizeof name, "/proc/self/fd/%d", gate);
    if (pread(gate, begin, sizeof begin, 0) != (ssize_t)sizeof begin ||
        memcmp(begin, signature, sizeof begin) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s is not an HDF5 file", path);
    else if ((id = H5Fopen(access(name, F_OK) == 0 ? name : path, H5F_ACC_RDONLY, H5P_DEFAULT)) < 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be opened: it is damaged or another program is writing it", path);
    close(gate);
    return id;
}

hid_t sf_h5_open_replaced(const char *path) {
    return sf_replace_exists(path) ? H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
}

enum { OBJECT_SIZE = 512 };

/* Follows a path of hard links. LINK_ELSEWHERE: `part` is the path up to a link that is not hard, `info` says
 * of what kind. */
static int walk(hid_t file, const char *path, char part[OBJECT_SIZE], H5L_info_t *info) {
    size_t length = strlen(path);
    if (length >= OBJECT_SIZE || path[0] != '/')
        return LINK_NONE;
    /* H5Lexists fails on a path whose parent is missing: test each prefix. */
    for (size_t k = 2; k <= length; k++) {
        if (path[k] != '/' && path[k] != '\0')
            continue;
        memcpy(part, path, k);
        part[k] = '\0';
        if (H5Lexists(file, part, H5P_DEFAULT) <= 0 || H5Lget_info(file, part, info, H5P_DEFAULT) < 0)
            return LINK_NONE;
        if (info->type != H5L_TYPE_HARD)
            return LINK_ELSEWHERE;
    }
    return LINK_HARD;
}

/* True if the external link at `path` stands for the object of the same path in a file of the folder that
 * belongs to this file while its run is in progress (FILE.run, docs/formats.md); `folder` and the name
 * there are then set. */
static bool is_own_link(const sf_h5 *file, const char *path, size_t size, char folder[PATH_MAX],
                        char name[NAME_MAX + 1]) {
    char value[1024];
    const char *slash = strrchr(file->path, '/'), *target = NULL, *object = NULL;
    unsigned flags;
    if (file->alone || (size_t)snprintf(folder, PATH_MAX, "%s.run/", file->path) >= PATH_MAX)
        return false;
    const char *own = slash ? folder + (slash + 1 - file->path) : folder;
    if (size > sizeof value || H5Lget_val(file->id, path, value, sizeof value, H5P_DEFAULT) < 0 ||
        H5Lunpack_elink_val(value, size, &flags, &target, &object) < 0 ||
        strncmp(target, own, strlen(own)) != 0 || strcmp(object, path) != 0)
        return false;
    target += strlen(own);
    return *target && *target != '.' && !strchr(target, '/') &&
           (size_t)snprintf(name, NAME_MAX + 1, "%s", target) <= NAME_MAX;
}

/* Opens a file of the folder: LINK_ELSEWHERE if one of them is a symbolic link or anything else that may lead
 * out. By our own hand, because HDF5 looks for it in other places too. */
static int open_part(const sf_h5 *file, const char *folder, const char *name, hid_t *part) {
    sf_error problem = SF_ERROR_INIT;
    char path[PATH_MAX + NAME_MAX + 1], plain[PATH_MAX];
    struct stat info;
    snprintf(plain, sizeof plain, "%.*s", (int)strlen(folder) - 1, folder); /* a slash would follow a link */
    snprintf(path, sizeof path, "%s%s", folder, name);
    if (lstat(plain, &info) != 0)
        return LINK_NONE;
    if (!S_ISDIR(info.st_mode))
        return LINK_ELSEWHERE;
    if (lstat(path, &info) != 0)
        return LINK_NONE;
    if (!S_ISREG(info.st_mode))
        return LINK_ELSEWHERE;
    if (strcmp(file->checked, name) != 0 && sf_seal_check(path, &problem) != SF_OK)
        return LINK_DAMAGED;
    snprintf(((sf_h5 *)file)->checked, NAME_MAX + 1, "%s", name);
    *part = sf_h5_open_plain(path, &problem);
    return *part < 0 ? LINK_DAMAGED : LINK_HARD;
}

int sf_h5_find(const sf_h5 *file, const char *path, hid_t *in) {
    char part[OBJECT_SIZE], folder[PATH_MAX], name[NAME_MAX + 1];
    H5L_info_t info;
    hid_t other = -1;
    int found = walk(file->id, path, part, &info);
    *in = file->id;
    if (found != LINK_ELSEWHERE || info.type != H5L_TYPE_EXTERNAL ||
        !is_own_link(file, part, info.u.val_size, folder, name))
        return found;
    found = open_part(file, folder, name, &other);
    if (found != LINK_HARD)
        return found;
    found = walk(other, path, part, &info);
    if (found == LINK_HARD)
        *in = other;
    else
        H5Fclose(other);
    return found;
}

void sf_h5_leave(const sf_h5 *file, hid_t in) {
    if (in != file->id)
        H5Fclose(in);
}

uint64_t sf_h5_file_bytes(hid_t object) {
    hid_t owner = H5Iget_file_id(object);
    hsize_t size = 0;
    H5Fget_filesize(owner, &size);
    H5Fclose(owner);
    return size;
}
