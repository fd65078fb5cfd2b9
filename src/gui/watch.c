/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/watch.h"

#include "io/plain_file.h"
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

sf_watch_stamp sf_watch_look(const char *path) {
    struct stat info;
    if (stat(path, &info) != 0)
        return (sf_watch_stamp){0};
    return (sf_watch_stamp){info.st_mtim.tv_sec, info.st_mtim.tv_nsec, info.st_size, info.st_ino};
}

bool sf_watch_same(const sf_watch_stamp *a, const sf_watch_stamp *b) {
    return a->seconds == b->seconds && a->nanoseconds == b->nanoseconds && a->size == b->size &&
           a->inode == b->inode;
}

static bool is_watched(const sf_watch *w, const char *path) {
    for (int k = 0; k < w->count; k++)
        if (strcmp(w->file[k].path, path) == 0)
            return true;
    return false;
}

void sf_watch_register(sf_watch *w, size_t first) {
    for (size_t k = first; k < sf_plain_count(); k++) {
        const char *path = sf_plain_get(k).path;
        if (w->count == SF_WATCHED || is_watched(w, path))
            continue;
        snprintf(w->file[w->count].path, sizeof w->file[w->count].path, "%s", path);
        w->file[w->count].stamp = sf_watch_look(path);
        w->count++;
    }
}

const char *sf_watch_changed(sf_watch *w) {
    for (int k = 0; k < w->count; k++) {
        sf_watch_stamp now = sf_watch_look(w->file[k].path);
        if (now.inode != 0 && !sf_watch_same(&now, &w->file[k].stamp)) { /* an editor may be replacing it */
            w->file[k].stamp = now;
            return w->file[k].path;
        }
    }
    return NULL;
}
