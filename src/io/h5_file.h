/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An open HDF5 file, and how an object is found in it and in the files of its run's folder. Internal to
 * src/io: h5.c opens files, h5_data.c reads and writes what the objects hold. */
#pragma once
#include "base/error.h"
#include <hdf5.h>
#include <limits.h>

typedef struct sf_h5 {
    hid_t id;
    char *path;
    bool alone;                 /* no link is followed, not even into its own folder */
    char checked[NAME_MAX + 1]; /* the file of that folder whose seal was checked last */
} sf_h5;

/* To be called before any other call of HDF5. HDF5's own cleaning up at exit crashes after a file that could
 * not be closed (a full disk); everything is closed without it. */
void sf_h5_begin(void);

/* Opens a file that passes the gate; -1 on failure. HDF5 gets the descriptor by its name in /proc: it opens
 * the very file that was looked at, whatever stands at `path` meanwhile. Without /proc it looks for the path.
 */
hid_t sf_h5_open_plain(const char *path, sf_error *err);

/* Opens a plain file that may be replaced, which is no input: it does not pass the gate. -1: there is none,
 * or it cannot be read. */
hid_t sf_h5_open_replaced(const char *path);

/* A path leads to its object not at all, by hard links, by another link, or into a damaged file. */
enum { LINK_NONE, LINK_HARD, LINK_ELSEWHERE, LINK_DAMAGED };

/* The object at a path, and the file that it is `in`, which sf_h5_leave gives back. Links into other files
 * are found but not followed, but for a file's own, and those one deep: a file speaks of itself only. */
int sf_h5_find(const sf_h5 *file, const char *path, hid_t *in);
void sf_h5_leave(const sf_h5 *file, hid_t in);

/* Bytes of the file that holds an open object. */
uint64_t sf_h5_file_bytes(hid_t object);
