/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geometry_check.h"

#include "pre/mesh/geo_text.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    MAX_DEPTH = 10,
    LONGEST_TEXT = 1000 /* gmsh ends a longer one early and reads on in the middle of it */
};

/* Formats that hold data only, by the ending that makes gmsh choose their reader. */
static const char *const data_formats[] = {".step", ".stp",  ".iges", ".igs", ".brep", ".stl", ".vtk",
                                           ".unv",  ".mesh", ".bdf",  ".nas", ".med",  ".inp"};

/* They write files, run programs, or end the process. */
static const char *const commands[] = {"Save", "Print", "Exit", "Abort", "Plugin", "Parse", "CreateDir"};
static const char *const options[] = {"Solver.",
                                      "General.SaveOptions",
                                      "General.OptionsFileName",
                                      "General.SaveSession",
                                      "General.SessionFileName",
                                      "General.ErrorFileName"};

static const char *ending(const char *path) {
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    return dot && (!slash || dot > slash) ? dot : "";
}

static int line_of(const char *text, const char *place) {
    int line = 1;
    for (; text < place; text++)
        line += *text == '\n';
    return line;
}

static sf_status refuse(const char *path, const char *text, sf_geo_token t, sf_error *err) {
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "%s:%d: \"%.*s\" may write files, run programs or end this one: a geometry may not do that", path,
        line_of(text, t.begin), (int)(t.length < 40 ? t.length : 40), t.begin);
}

static sf_status check_word(const char *path, const char *text, sf_geo_token t, sf_error *err) {
    for (size_t k = 0; k < sizeof commands / sizeof commands[0]; k++)
        if (sf_geo_is(t, commands[k]))
            return refuse(path, text, t, err);
    for (size_t k = 0; k < sizeof options / sizeof options[0]; k++)
        if (strncmp(t.begin, options[k], strlen(options[k])) == 0)
            return refuse(path, text, t, err);
    return SF_OK;
}

static sf_status check_file(const char *path, int depth, sf_error *err);

/* A file named in a .geo stands relative to it. */
static sf_status check_included(const char *path, const char *text, sf_geo_token name, int depth,
                                sf_error *err) {
    const char *slash = strrchr(path, '/');
    int folder = slash && *name.begin != '/' ? (int)(slash - path) + 1 : 0;
    char *inner = NULL;
    if (name.kind != SF_GEO_TEXT)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: the file after Include or Merge must be named by a plain text", path,
                       line_of(text, name.begin));
    if (depth == MAX_DEPTH)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d files include one another", path,
                       line_of(text, name.begin), MAX_DEPTH);
    if (asprintf(&inner, "%.*s%.*s", folder, path, (int)name.length, name.begin) < 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path of a geometry");
    check_file(inner, depth + 1, err);
    free(inner);
    return err->status;
}

/* `Printf(...) > "file"` writes; up to the semicolon, as the arguments may hold brackets. */
static bool is_redirected(const char *rest) {
    bool closed = false;
    for (sf_geo_token t = sf_geo_next(&rest); t.kind != SF_GEO_END && *t.begin != ';';
         t = sf_geo_next(&rest)) {
        if (closed && t.kind == SF_GEO_MARK && *t.begin == '>')
            return true;
        closed = t.kind == SF_GEO_MARK && *t.begin == ')';
    }
    return false;
}

static sf_status check_tokens(const char *path, const char *text, int depth, sf_error *err) {
    const char *rest = text;
    for (sf_geo_token t = sf_geo_next(&rest); t.kind != SF_GEO_END && err->status == SF_OK;
         t = sf_geo_next(&rest)) {
        if (t.kind == SF_GEO_TEXT && t.length > LONGEST_TEXT)
            SF_FAIL(err, SF_ERR_INPUT, "%s:%d: a text of %zu characters; gmsh takes %d", path,
                    line_of(text, t.begin), t.length, LONGEST_TEXT);
        if (t.kind != SF_GEO_WORD)
            continue;
        check_word(path, text, t, err);
        if (sf_geo_is(t, "Printf") && is_redirected(rest))
            refuse(path, text, t, err);
        if (sf_geo_is(t, "Include") || sf_geo_is(t, "Merge") || sf_geo_is(t, "MergeFile")) {
            sf_geo_token name = sf_geo_next(&rest);
            check_included(path, text, name, depth, err);
        }
    }
    return err->status;
}

static sf_status check_script(const char *path, off_t size, int depth, sf_error *err) {
    /* Refused wherever they stand, whatever gmsh takes for a comment or a text. */
    static const char *const anywhere[] = {"SystemCall", "OnelabRun"};
    char *text = sf_geo_load(path);
    if (!text)
        return size == 0 ? SF_OK : SF_FAIL(err, SF_ERR_INPUT, "the geometry %s cannot be read", path);
    if ((off_t)strlen(text) != size)
        SF_FAIL(err, SF_ERR_INPUT, "%s: a zero byte: this is not a text file", path);
    for (size_t k = 0; k < sizeof anywhere / sizeof anywhere[0] && err->status == SF_OK; k++) {
        const char *found = strstr(text, anywhere[k]);
        if (found)
            refuse(path, text, (sf_geo_token){SF_GEO_WORD, found, strlen(anywhere[k])}, err);
    }
    if (err->status == SF_OK)
        check_tokens(path, text, depth, err);
    free(text);
    return err->status;
}

static sf_status check_mesh(const char *path, sf_error *err) {
    static const char wanted[] = "$MeshFormat";
    char found[sizeof wanted] = "";
    FILE *file = fopen(path, "r");
    size_t length = file ? fread(found, 1, sizeof wanted - 1, file) : 0;
    if (file)
        fclose(file);
    if (length == sizeof wanted - 1 && memcmp(found, wanted, length) == 0)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "%s does not begin with %s: it is not a mesh of gmsh", path, wanted);
}

static sf_status check_file(const char *path, int depth, sf_error *err) {
    struct stat info;
    if (stat(path, &info) != 0 || access(path, R_OK) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the geometry %s cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "the geometry %s is not a plain file", path);
    if (sf_geo_is_script(path))
        return check_script(path, info.st_size, depth, err);
    if (strcasecmp(ending(path), ".msh") == 0)
        return check_mesh(path, err);
    for (size_t k = 0; k < sizeof data_formats / sizeof data_formats[0]; k++)
        if (strcasecmp(ending(path), data_formats[k]) == 0)
            return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "%s: gmsh takes an unknown format for a script: the name must end in .geo, .msh, .step, "
                   ".iges, .brep or another format of data",
                   path);
}

sf_status sf_geometry_check(const char *path, sf_error *err) {
    return check_file(path, 0, err);
}
