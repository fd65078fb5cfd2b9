/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/key.h"

#include "core/hash.h"
#include "io/process.h"
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    char block[4096];
    size_t size;
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be read: %s", path, strerror(errno));
    while ((size = fread(block, 1, sizeof block, file)) > 0)
        *hash = sf_hash_bytes(*hash, block, size);
    fclose(file);
    return SF_OK;
}

/* The case's list of values without the names of files, whose contents count. */
static uint64_t hash_values(uint64_t hash, const char *values) {
    static const char *const files[] = {"geometry.file ", "geometry.missile_file ", "material.curve ",
                                        "material.curves ", "missile.motion "};
    while (*values) {
        size_t length = strcspn(values, "\n"), skipped = 0;
        for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
            skipped += strncmp(values, files[k], strlen(files[k])) == 0;
        if (!skipped)
            hash = sf_hash_bytes(hash, values, length);
        values += length + (values[length] == '\n');
    }
    return hash;
}

sf_status sf_campaign_key(const sf_case *c, uint64_t *hash, sf_error *err) {
    size_t motion = sf_case_motion_bytes(c);
    *hash = hash_values(SF_HASH_START, c->parameters);
    *hash = sf_material_hash(*hash, &c->material);
    *hash = sf_hash_bytes(*hash, c->motion_time, motion);
    *hash = sf_hash_bytes(*hash, c->motion_displacement, motion);
    if (hash_file(hash, c->pad.path, err) != SF_OK ||
        (c->missile.path && hash_file(hash, c->missile.path, err) != SF_OK))
        return err->status;
    static const char *const programs[] = {"softfall-pre", "softfall-solve"};
    for (int k = 0; k < 2; k++) {
        char path[PATH_MAX];
        if (sf_process_find(programs[k], path, sizeof path, err) != SF_OK ||
            hash_file(hash, path, err) != SF_OK)
            break;
    }
    return err->status;
}
