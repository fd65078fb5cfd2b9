/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are complete at any instant: written under another name on the same file system, synchronised
 * (fsync) and renamed. After a failure in between, the earlier file remains. Model, results, checkpoint and
 * reports all go through here. */
#ifndef SF_IO_REPLACE_H
#define SF_IO_REPLACE_H

#include "core/error.h"

enum { SF_PATH_SIZE = 4096 };

/* "path.partial", the name to write under. */
sf_status sf_replace_begin(const char *path, char partial[SF_PATH_SIZE], sf_error *err);

/* Makes the closed file `partial` the file `path`, both on the disk (fsync of the file and of the folder);
 * removes it on failure. */
sf_status sf_replace_commit(const char *partial, const char *path, sf_error *err);

#endif
