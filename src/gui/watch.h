/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notices that files change. */
#ifndef SF_GUI_WATCH_H
#define SF_GUI_WATCH_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SF_WATCHED = 64 };

/* Two stamps of a file that is as it was are equal. */
typedef struct sf_watch_stamp {
    int64_t seconds, nanoseconds, size;
    uint64_t inode; /* 0: there is no file */
} sf_watch_stamp;

typedef struct sf_watch {
    int count;
    struct {
        char path[PATH_MAX];
        sf_watch_stamp stamp;
    } file[SF_WATCHED];
} sf_watch;

sf_watch_stamp sf_watch_look(const char *path);
bool sf_watch_same(const sf_watch_stamp *a, const sf_watch_stamp *b);

/* Watches what this process has read from entry `first` of the register on (io/plain_file.h), as it is now.
 */
void sf_watch_register(sf_watch *watch, size_t first);
/* The first file that is not as it was; NULL: none. From now on it is watched as it is now. */
const char *sf_watch_changed(sf_watch *watch);

#endif
