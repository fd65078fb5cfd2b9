/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/path.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *no_memory(const char *path, sf_error *err) {
    SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %.200s", path);
    return NULL;
}

size_t sf_path_folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return !slash ? 0 : slash == path ? 1 : (size_t)(slash - path);
}

const char *sf_path_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Takes the parts of `path` one after another onto `whole`, which has room. */
static void append(char *whole, const char *path) {
    while (*path) {
        size_t length = strcspn(path, "/"), used = strlen(whole);
        if (length == 2 && strncmp(path, "..", 2) == 0)
            whole[used ? sf_path_folder_length(whole) : 0] = '\0';
        else if (length > 0 && !(length == 1 && *path == '.'))
            sprintf(whole + used, "/%.*s", (int)length, path);
        if (strcmp(whole, "/") == 0)
            *whole = '\0';
        path += length + (path[length] == '/');
    }
}

char *sf_path_whole(const char *folder, const char *path, sf_error *err) {
    char here[PATH_MAX] = "";
    bool relative = *path != '/', below_here = relative && (!folder || *folder != '/');
    if (below_here && !getcwd(here, sizeof here)) {
        SF_FAIL(err, SF_ERR_IO, "the present folder is not known: %s", strerror(errno));
        return NULL;
    }
    char *whole = calloc(strlen(here) + (folder ? strlen(folder) : 0) + strlen(path) + 5, 1);
    if (!whole)
        return no_memory(path, err);
    append(whole, here);
    if (relative && folder)
        append(whole, folder);
    append(whole, path);
    if (!*whole)
        strcpy(whole, "/");
    return whole;
}

const char *sf_path_below(const char *folder, const char *path) {
    size_t length = strcmp(folder, "/") == 0 ? 0 : strlen(folder);
    return strncmp(folder, path, length) == 0 && path[length] == '/' && path[length + 1] ? path + length + 1
                                                                                         : NULL;
}

char *sf_path_between(const char *from, const char *to, sf_error *err) {
    size_t same = 0;
    char *text = NULL;
    for (size_t k = 0; from[k] && from[k] == to[k]; k++)
        if (from[k] == '/')
            same = k + 1;
    int up = 0;
    for (const char *at = from + same; (at = strchr(at, '/')); at++)
        up++;
    size_t length = 3 * (size_t)up;
    text = malloc(length + strlen(to + same) + 1);
    if (!text)
        return no_memory(to, err);
    for (int k = 0; k < up; k++)
        memcpy(text + 3 * k, "../", 3);
    strcpy(text + length, to + same);
    return text;
}
