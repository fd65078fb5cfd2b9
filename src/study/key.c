/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/key.h"

#include "base/hash.h"
#include "io/h5.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/geometry_files.h"
#include "pre/mesh/mesher_start.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    uint64_t content = 0;
    if (sf_plain_hash_kept(path, &content, err) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
    return err->status;
}

/* The programs that simulate a drop: softfall-pre, softfall-solve, softfall-mesh. */
typedef struct programs {
    char folder[PATH_MAX]; /* SF_BIN_DIR as they were found */
    char path[3][PATH_MAX];
    bool found;
} programs;

static sf_status find_programs(programs *p, sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%s", given ? given : "");
    if (p->found && strcmp(folder, p->folder) == 0)
        return SF_OK;
    memcpy(p->folder, folder, sizeof folder);
    p->found = sf_process_find("softfall-pre", p->path[0], PATH_MAX, err) == SF_OK &&
               sf_process_find("softfall-solve", p->path[1], PATH_MAX, err) == SF_OK &&
               sf_mesher_find(p->path[2], PATH_MAX, err) == SF_OK;
    return err->status;
}

static sf_status hash_programs(uint64_t *hash, sf_error *err) {
    static programs known;
    if (find_programs(&known, err) != SF_OK)
        return err->status;
    for (int k = 0; k < 3 && err->status == SF_OK; k++)
        hash_file(hash, known.path[k], err);
    return err->status;
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
