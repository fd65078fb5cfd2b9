/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geometry_files.h"

#include "io/plain_file.h"
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

/* Has the file the content that it had? */
static bool is_same(const section *s, uint64_t then, const char *name, size_t length) {
    char path[PATH_SIZE];
    uint64_t hash = 0;
    sf_error none = SF_ERROR_INIT;
    return join(s, name, length, "", path) &&
           sf_plain_hash_kept(path, &hash, &none) == SF_OK && hash == then;
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
bool sf_geometry_files_are_same(const char *const folder[2], const char *files) {
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
