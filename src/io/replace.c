/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

sf_status sf_replace_begin(const char *path, char partial[SF_PATH_SIZE], sf_error *err) {
    if ((size_t)snprintf(partial, SF_PATH_SIZE, "%s.partial", path) >= SF_PATH_SIZE)
        return SF_FAIL(err, SF_ERR_IO, "the path of an output file is longer than %d bytes", SF_PATH_SIZE);
    return SF_OK;
}

static int sync_file(const char *path, int flags) {
    int file = open(path, flags);
    if (file < 0)
        return -1;
    int result = fsync(file);
    int reason = errno;
    close(file);
    errno = reason;
    return result;
}

/* The new name survives a power cut when the folder has been written. Some file systems cannot do that for
 * folders; the name is then as safe as they make it. */
static void sync_folder(const char *path) {
    char folder[SF_PATH_SIZE];
    snprintf(folder, sizeof folder, "%s", path);
    char *slash = strrchr(folder, '/');
    snprintf(slash ? slash + 1 : folder, 2, "%s", slash ? "" : ".");
    sync_file(folder, O_RDONLY | O_DIRECTORY);
}

sf_status sf_replace_commit(const char *partial, const char *path, sf_error *err) {
    if (sync_file(partial, O_RDWR) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be brought to the disk: %s", partial, strerror(errno));
    else if (rename(partial, path) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be renamed to %s: %s", partial, path, strerror(errno));
    if (err->status != SF_OK)
        unlink(partial);
    else
        sync_folder(path);
    return err->status;
}
