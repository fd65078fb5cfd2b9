/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/folder.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

sf_status sf_folder_make(const char *path, sf_error *err) {
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
    return SF_OK;
}
