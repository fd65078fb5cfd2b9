/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/key.h"

#include "core/hash.h"
#include "io/h5.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/gmsh_session.h"
#include "pre/mesh/mesher_start.h"
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 2 * PATH_MAX };

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    uint64_t content = 0;
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &content, err) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
    return err->status;
}

/* Does the line begin with materials.NAME.curve or .curves? */
static bool is_layer_curve(const char *line) {
    size_t length = strcspn(line, " \n");
    const char *dot = memrchr(line, '.', length);
    return strncmp(line, "materials.", 10) == 0 && dot > line + 9 &&
           (strncmp(dot, ".curve ", 7) == 0 || strncmp(dot, ".curves ", 8) == 0);
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
        skipped += is_layer_curve(values);
        if (!skipped)
            hash = sf_hash_bytes(hash, values, length);
        values += length + (values[length] == '\n');
    }
    return hash;
}

sf_status sf_campaign_key(const sf_case *c, uint64_t *hash, sf_error *err) {
    size_t motion = sf_case_motion_bytes(c);
    *hash = hash_values(SF_HASH_START, c->parameters);
    if (c->layer_count == 0)
        *hash = sf_material_hash(*hash, &c->material);
    for (int k = 0; k < c->layer_count; k++)
        *hash = sf_material_hash(*hash, &c->layer[k]);
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

/* The files of one geometry in a list of files, and the folder that their paths begin at. */
typedef struct section {
    const char *begin, *end, *folder;
} section;

/* The path at the end of a line, with `ending`. */
static bool join(const section *s, const char *name, size_t length, const char *ending, char out[PATH_SIZE]) {
    bool relative = *name != '/';
    return snprintf(out, PATH_SIZE, "%s%s%.*s%s", relative ? s->folder : "", relative ? "/" : "", (int)length,
                    name, ending) < PATH_SIZE;
}

/* Has the file the content that it had? */
static bool is_same(const section *s, uint64_t then, const char *name, size_t length) {
    char path[PATH_SIZE];
    uint64_t hash = 0;
    sf_error none = SF_ERROR_INIT;
    return join(s, name, length, "", path) &&
           sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, &none) == SF_OK && hash == then;
}

/* gmsh reads the file NAME.opt beside a geometry NAME, if there is one. */
static bool has_new_options(const section *s, const char *name, size_t length) {
    char path[PATH_SIZE], line[PATH_SIZE];
    snprintf(line, sizeof line, " %.*s.opt\n", (int)length, name);
    const char *listed = strstr(s->begin, line);
    return (!listed || listed >= s->end) && join(s, name, length, ".opt", path) && access(path, F_OK) == 0;
}

/* Its lines are "hash path". */
static bool is_section_same(const section *s) {
    for (const char *line = s->begin; line < s->end;) {
        size_t length = strcspn(line, "\n");
        uint64_t then = 0;
        int begin = 0;
        if (sscanf(line, "%16" SCNx64 " %n", &then, &begin) != 1 || begin == 0 || (size_t)begin >= length ||
            length - (size_t)begin > PATH_MAX)
            return false;
        const char *name = line + begin;
        length -= (size_t)begin;
        if (!is_same(s, then, name, length) || has_new_options(s, name, length))
            return false;
        line = name + length + (name[length] == '\n');
    }
    return true;
}

/* A section for the pad's geometry, and one for the missile's if it has one. */
static bool are_same(const char *files, const char *const folder[2]) {
    static const char head[] = SF_GMSH_FILES_OF "\n";
    for (int k = 0; k < 2; k++) {
        if (k == 1 && *folder[k] == '\0')
            break;
        if (strncmp(files, head, sizeof head - 1) != 0)
            return false;
        section s = {.begin = files + sizeof head - 1, .folder = folder[k]};
        s.end = strstr(s.begin - 1, "\n" SF_GMSH_FILES_OF "\n");
        s.end = s.end ? s.end + 1 : s.begin + strlen(s.begin);
        if (!is_section_same(&s))
            return false;
        files = s.end;
    }
    return *files == '\0';
}

bool sf_campaign_geometry_is_same(const char *const folder[2], const char *path, const char *text,
                                  bool unlisted) {
    sf_error none = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    char *files = NULL;
    bool same = unlisted;
    if (sf_h5_open(path, &file, &none) == SF_OK && sf_h5_exists(file, text))
        same = sf_h5_read_text(file, text, &files, &none) == SF_OK && are_same(files, folder);
    free(files);
    sf_h5_close(&file, &none);
    return same;
}
