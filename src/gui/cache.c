/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/cache.h"

#include "io/folder.h"
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static sf_status find(char *path, size_t size, sf_error *err) {
    const char *given = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int length = 0;
    if (given && *given == '/')
        length = snprintf(path, size, "%s", given);
    else if (home && *home == '/')
        length = snprintf(path, size, "%s/.cache", home);
    else
        return SF_FAIL(err, SF_ERR_IO,
                       "there is no place for runs: neither XDG_CACHE_HOME nor HOME names a folder");
    mkdir(path, 0700); /* a folder of the user's programs, not of softfall alone: without its mark */
    if (length >= (int)size ||
        (size_t)snprintf(path + length, size - (size_t)length, "/softfall") >= size - (size_t)length)
        return SF_FAIL(err, SF_ERR_IO, "the name of the folder for runs is too long: %.100s...", path);
    return sf_folder_own(path, err);
}

sf_status sf_cache_find(char *path, size_t size, sf_error *err) {
    *path = '\0';
    if (find(path, size, err) != SF_OK)
        *path = '\0'; /* no run may go where it is not allowed to */
    return err->status;
}
