/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/geo_names.h"

#include "io/plain_file.h"
#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST = 1 << 22, DEEPEST = 8 };

/* A word, a string without its quotes, or a single character. */
typedef struct token {
    enum { END, WORD, STRING, OTHER } kind;
    const char *text;
    size_t length;
} token;

static const char *skip_blanks(const char *at) {
    for (;;) {
        at += strspn(at, " \t\r\n");
        if (at[0] == '/' && at[1] == '/')
            at += strcspn(at, "\n");
        else if (at[0] == '/' && at[1] == '*')
            at = strstr(at + 2, "*/") ? strstr(at + 2, "*/") + 2 : at + strlen(at);
        else
            return at;
    }
}

static size_t word_length(const char *at) {
    size_t length = 0;
    while (isalnum((unsigned char)at[length]) || at[length] == '_')
        length++;
    return length;
}

static token next(const char **at) {
    *at = skip_blanks(*at);
    token t = {OTHER, *at, 1};
    if (**at == '\0') {
        t.kind = END;
        return t;
    }
    if (**at == '"') {
        t = (token){STRING, *at + 1, strcspn(*at + 1, "\"\n")};
        *at = t.text + t.length + (t.text[t.length] == '"');
        return t;
    }
    if (word_length(*at) > 0)
        t = (token){WORD, *at, word_length(*at)};
    *at += t.length;
    return t;
}

static bool is(const token *t, const char *text) {
    return t->kind != STRING && t->length == strlen(text) && strncmp(t->text, text, t->length) == 0;
}

static void add(sf_geo_names *names, const token *variable, const token *name) {
    sf_geo_name *out = &names->name[names->count];
    if (names->count == SF_GEO_NAMES || variable->length >= sizeof out->variable ||
        name->length >= sizeof out->name)
        return;
    snprintf(out->variable, sizeof out->variable, "%.*s", (int)variable->length, variable->text);
    snprintf(out->name, sizeof out->name, "%.*s", (int)name->length, name->text);
    names->count++;
}

/* A variable is what stands before "= {" or "= DefineNumber"; its name is the string after the word Name. */
void sf_geo_names_scan(const char *text, sf_geo_names *names) {
    token before = {OTHER, text, 0}, last = before, variable = before;
    for (token t = next(&text); t.kind != END; t = next(&text)) {
        if (is(&last, "=") && before.kind == WORD && (is(&t, "{") || is(&t, "DefineNumber")))
            variable = before;
        if (is(&last, "Name") && t.kind == STRING && variable.length > 0) {
            add(names, &variable, &t);
            variable.length = 0;
        }
        before = last;
        last = t;
    }
}

static sf_status read_depth(const char *path, sf_geo_names *names, int depth, sf_error *err);

/* The files that the text includes, where they are there; gmsh tells of those that are not. */
static void read_included(const char *path, const char *text, sf_geo_names *names, int depth) {
    token last = {OTHER, text, 0};
    const char *slash = strrchr(path, '/');
    for (token t = next(&text); t.kind != END; t = next(&text)) {
        char included[PATH_MAX];
        sf_error none = SF_ERROR_INIT;
        int folder = slash && t.kind == STRING && t.text[0] != '/' ? (int)(slash - path) + 1 : 0;
        if (is(&last, "Include") && t.kind == STRING && depth < DEEPEST &&
            snprintf(included, sizeof included, "%.*s%.*s", folder, path, (int)t.length, t.text) <
                (int)sizeof included)
            read_depth(included, names, depth + 1, &none);
        last = t;
    }
}

static sf_status read_depth(const char *path, sf_geo_names *names, int depth, sf_error *err) {
    char *text = NULL;
    size_t size = 0;
    if (sf_plain_read(path, "geometry", LARGEST, &text, &size, err) != SF_OK)
        return err->status;
    sf_geo_names_scan(text, names);
    read_included(path, text, names, depth);
    free(text);
    return SF_OK;
}

sf_status sf_geo_names_read(const char *path, sf_geo_names *names, sf_error *err) {
    const char *dot = strrchr(path, '.');
    names->count = 0;
    if (!dot || strcmp(dot, ".geo") != 0)
        return sf_plain_check(path, "geometry", err);
    return read_depth(path, names, 0, err);
}
