/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/key.h"

#include "core/hash.h"
#include "io/h5.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/geometry_files.h"
#include "pre/mesh/mesher_start.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    uint64_t content = 0;
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &content, err) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
    return err->status;
}

/* Of the programs that simulate a drop: read again only when one of them has changed. */
typedef struct programs {
    struct stat of[3]; /* softfall-pre, softfall-solve, softfall-mesh */
    uint64_t hash;
} programs;

static bool is_same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

static sf_status hash_programs(uint64_t *hash, sf_error *err) {
    static programs known;
    char path[3][PATH_MAX];
    programs now = {.hash = SF_HASH_START};
    bool same = true;
    if (sf_process_find("softfall-pre", path[0], PATH_MAX, err) != SF_OK ||
        sf_process_find("softfall-solve", path[1], PATH_MAX, err) != SF_OK ||
        sf_mesher_find(path[2], PATH_MAX, err) != SF_OK)
        return err->status;
    for (int k = 0; k < 3; k++)
        same = stat(path[k], &now.of[k]) == 0 && is_same_file(&now.of[k], &known.of[k]) && same;
    for (int k = 0; k < 3 && !same; k++)
        if (hash_file(&now.hash, path[k], err) != SF_OK)
            return err->status;
    if (!same)
        known = now;
    *hash = sf_hash_bytes(*hash, &known.hash, sizeof known.hash);
    return SF_OK;
}

uint64_t sf_campaign_case_hash(const sf_case *c) {
    size_t motion = sf_case_motion_bytes(c);
    uint64_t hash = sf_hash_bytes(SF_HASH_START, &c->values, sizeof c->values);
    if (c->layer_count == 0)
        hash = sf_material_hash(hash, &c->material);
    for (int k = 0; k < c->layer_count; k++)
        hash = sf_material_hash(hash, &c->layer[k]);
    hash = sf_hash_bytes(hash, c->motion_time, motion);
    return sf_hash_bytes(hash, c->motion_displacement, motion);
}

sf_status sf_campaign_key(const sf_case *c, uint64_t *hash, sf_error *err) {
    *hash = sf_campaign_case_hash(c);
    if (hash_file(hash, c->pad.path, err) != SF_OK ||
        (c->missile.path && hash_file(hash, c->missile.path, err) != SF_OK))
        return err->status;
    return hash_programs(hash, err);
}

char *sf_campaign_geometry_list(const char *path, const char *text) {
    sf_error none = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    char *files = NULL;
    if (sf_h5_open(path, &file, &none) == SF_OK && sf_h5_exists(file, text))
        sf_h5_read_text(file, text, &files, &none);
    sf_h5_close(&file, &none);
    return files;
}

bool sf_campaign_geometry_is_same(const char *const folder[2], const char *path, const char *text,
                                  bool unlisted) {
    char *files = sf_campaign_geometry_list(path, text);
    bool same = files ? sf_geometry_files_are_same(folder, files) : unlisted;
    free(files);
    return same;
}
