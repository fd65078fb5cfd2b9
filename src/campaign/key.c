/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/key.h"

#include "core/hash.h"
#include "io/h5.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/mesher_start.h"
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    uint64_t content = 0;
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &content, err) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
    return err->status;
}

/* The case's list of values without the names of files, whose contents count, and what cannot change a drop.
 */
static uint64_t hash_values(uint64_t hash, const char *values) {
    static const char *const files[] = {"geometry.file ",  "geometry.missile_file ", "geometry.time_limit ",
                                        "material.curve ", "material.curves ",       "missile.motion "};
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
            return err->status;
    }
    char mesher[PATH_MAX];
    if (sf_mesher_find(mesher, sizeof mesher, err) == SF_OK)
        hash_file(hash, mesher, err);
    return err->status;
}

/* Has the file of a line, "hash path", the content that it had? */
static bool is_same(const char *line, size_t length) {
    char path[PATH_MAX + 8];
    uint64_t then = 0, hash = 0;
    sf_error none = SF_ERROR_INIT;
    int begin = 0;
    if (sscanf(line, "%16" SCNx64 " %n", &then, &begin) != 1 || begin == 0 || (size_t)begin >= length ||
        length - (size_t)begin > PATH_MAX)
        return false;
    snprintf(path, sizeof path, "%.*s", (int)(length - (size_t)begin), line + begin);
    return sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, &none) == SF_OK && hash == then;
}

/* gmsh reads the file NAME.opt beside a geometry NAME, if there is one. */
static bool has_new_options(const char *line, size_t length, const char *files) {
    const char *path = memchr(line, ' ', length);
    char name[PATH_MAX + 8];
    snprintf(name, sizeof name, "%.*s.opt\n", (int)(path ? line + length - path : 0), path ? path : "");
    const char *listed = strstr(files, name);
    name[strlen(name) - 1] = '\0';
    return !listed && path && access(name + 1, F_OK) == 0;
}

static bool are_same(const char *files) {
    for (const char *line = files; *line;) {
        size_t length = strcspn(line, "\n");
        if (!is_same(line, length) || has_new_options(line, length, files))
            return false;
        line += length + (line[length] == '\n');
    }
    return true;
}

bool sf_campaign_geometry_is_same(const char *path, const char *text, bool unlisted) {
    sf_error none = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    char *files = NULL;
    bool same = unlisted;
    if (sf_h5_open(path, &file, &none) == SF_OK && sf_h5_exists(file, text))
        same = sf_h5_read_text(file, text, &files, &none) == SF_OK && are_same(files);
    free(files);
    sf_h5_close(&file, &none);
    return same;
}
