/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh_store.h"

#include <inttypes.h>
#include <unistd.h>

#include "base/hash.h"
#include "io/folder.h"
#include "io/plain_file.h"

enum { PATH_SIZE = 2 * PATH_MAX };

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

/* True if the file has the content that it had. */
static bool is_same(const section *s, uint64_t then, const char *name, size_t length) {
    char path[PATH_SIZE];
    uint64_t hash = 0;
    return join(s, name, length, "", path) && sf_plain_hash_kept(path, &hash, SF_IGNORED) == SF_OK &&
           hash == then;
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

/* A section for the pad's geometry, and one for those of missile and supports if there are any. */
bool sf_geometry_files_are_same(const char *const folder[SF_GEOMETRIES], const char *files) {
    static const char head[] = SF_GMSH_FILES_OF "\n";
    for (int k = 0; k < SF_GEOMETRIES; k++) {
        if (k > 0 && (!folder[k] || *folder[k] == '\0'))
            continue;
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

static const char KIND[] = "mesh";

/* In the order of the names, as another order of the case gives the same mesh. */
static const sf_geo_parameter *next_parameter(const sf_geo_source *source, const sf_geo_parameter *last) {
    const sf_geo_parameter *next = NULL;
    for (int k = 0; k < source->parameter_count; k++) {
        const sf_geo_parameter *p = &source->parameter[k];
        if ((!last || strcmp(p->name, last->name) > 0) && (!next || strcmp(p->name, next->name) < 0))
            next = p;
    }
    return next;
}

/* Computes the key from the geometry's own file with its name, by which gmsh tells formats, its parameters
 * and softfall-mesh. False: the key is not known, and nothing is shared. */
static bool find_key(const sf_geo_source *source, uint64_t *key) {
    char mesher[PATH_MAX];
    uint64_t content[2];
    sf_error none = SF_ERROR_INIT;
    if (sf_mesher_find(mesher, sizeof mesher, &none) != SF_OK ||
        sf_plain_hash(mesher, NULL, SF_PLAIN_ANY, &content[0], &none) != SF_OK ||
        sf_plain_hash(source->path, NULL, SF_PLAIN_GEOMETRY, &content[1], &none) != SF_OK)
        return false;
    const char *name = sf_path_name(source->path);
    *key = sf_hash_bytes(SF_HASH_START, content, sizeof content);
    *key = sf_hash_bytes(*key, name, strlen(name) + 1);
    *key = sf_hash_bytes(*key, &source->unit, sizeof source->unit);
    for (const sf_geo_parameter *p = NULL; (p = next_parameter(source, p)) != NULL;) {
        *key = sf_hash_bytes(*key, p->name, strlen(p->name) + 1);
        *key = sf_hash_bytes(*key, &p->value, sizeof p->value);
    }
    *key = sf_hash_bytes(*key, &source->spacing_factor, sizeof source->spacing_factor);
    return true;
}

static bool are_files_same(const sf_geo_source *source, const char *files) {
    char folder[PATH_MAX];
    int length = (int)(sf_path_name(source->path) - source->path);
    if (snprintf(folder, sizeof folder, "%.*s", length > 1 ? length - 1 : length, source->path) >=
        (int)sizeof folder)
        return false;
    const char *const folders[SF_GEOMETRIES] = {length > 0 ? folder : "."};
    return sf_geometry_files_are_same(folders, files);
}

/* Bytes that a text takes with its zero, in whole words. */
static size_t padded(size_t length) {
    return (length + 8) / 8 * 8;
}

bool sf_mesh_store_find(const char *folder, const sf_geo_source *source, sf_meshed *out, char **files) {
    sf_stored found;
    uint64_t key, length;
    *files = NULL;
    if (!folder || !find_key(source, &key) || !sf_store_find(folder, KIND, key, &found))
        return false;
    const char *text = found.data + sizeof length;
    memcpy(&length, found.data, found.size >= sizeof length ? sizeof length : 0);
    if (found.size >= sizeof length && length < found.size && sizeof length + padded(length) < found.size &&
        text[length] == '\0' && are_files_same(source, text)) {
        size_t before = sizeof length + padded(length);
        if (sf_geo_data_read(found.data + before, found.size - before, source->path, &out->data,
                             SF_IGNORED) == SF_OK)
            *files = strdup(text);
    }
    if (*files) {
        out->stream = found.block;
        out->confined = true;
    } else {
        sf_geo_data_free(&out->data);
        memset(out, 0, sizeof *out);
        free(found.block);
    }
    return *files != NULL;
}

void sf_mesh_store_keep(const char *folder, const sf_geo_source *source, const sf_meshed *meshed,
                        const char *files) {
    static const char zeros[8];
    uint64_t key, length = strlen(files);
    if (!folder || !meshed->confined || !find_key(source, &key))
        return;
    const sf_store_part part[] = {{&length, sizeof length},
                                  {files, length},
                                  {zeros, padded(length) - length},
                                  {meshed->stream, meshed->size}};
    sf_store_keep(folder, KIND, key, 4, part);
}
