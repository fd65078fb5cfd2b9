/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paths as texts: nothing is looked up but the working directory, and links are not followed. */
#ifndef SF_IO_PATH_H
#define SF_IO_PATH_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>

/* From /, without ".", ".." and double slashes; a relative path begins at `folder` (NULL: the working
 * directory). From malloc, NULL on failure. */
char *sf_path_whole(const char *folder, const char *path, sf_error *err);

/* The part of whole paths below `folder`; NULL: `path` is not below it. Points into `path`. */
const char *sf_path_below(const char *folder, const char *path);

/* The length of the folder part of a path, without the slash but of "/"; 0: none. */
size_t sf_path_folder_length(const char *path);
/* The last part. */
const char *sf_path_name(const char *path);

/* How a file in the folder of `from` names the file `to`; both from the same folder, without "." and "..".
 * From malloc, NULL on failure. */
char *sf_path_between(const char *from, const char *to, sf_error *err);

#endif
