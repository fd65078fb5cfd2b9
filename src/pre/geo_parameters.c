/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/geo_parameters.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_NAMES = 256, MAX_DEPTH = 10 };

typedef struct name_list {
    int count;
    char name[MAX_NAMES][SF_CASE_NAME_SIZE];
} name_list;

typedef enum token_kind { TOKEN_END, TOKEN_WORD, TOKEN_TEXT, TOKEN_MARK } token_kind;

typedef struct token {
    token_kind kind;
    const char *begin;
    size_t length;
} token;

static const char *skip_blank(const char *p) {
    for (;;) {
        if (isspace((unsigned char)*p)) {
            p++;
        } else if (p[0] == '/' && p[1] == '/') {
            p += strcspn(p, "\n");
        } else if (p[0] == '/' && p[1] == '*') {
            const char *end = strstr(p + 2, "*/");
            p = end ? end + 2 : p + strlen(p);
        } else {
            return p;
        }
    }
}

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_' || c == '.';
}

/* Words (names and numbers), texts in quotes, and single marks; comments vanish. */
static token next_token(const char **text) {
    const char *p = skip_blank(*text);
    token t = {TOKEN_MARK, p, 1};
    if (*p == '\0') {
        t = (token){TOKEN_END, p, 0};
    } else if (*p == '"') {
        t = (token){TOKEN_TEXT, p + 1, strcspn(p + 1, "\"")};
        *text = p + 1 + t.length + (p[1 + t.length] == '"');
        return t;
    } else if (is_word(*p)) {
        t.kind = TOKEN_WORD;
        while (is_word(p[t.length]))
            t.length++;
    }
    *text = p + t.length;
    return t;
}

static bool is_text(token t, const char *text) {
    return t.length == strlen(text) && strncmp(t.begin, text, t.length) == 0;
}

static void add_name(name_list *list, token t) {
    if (t.length >= SF_CASE_NAME_SIZE || list->count == MAX_NAMES)
        return;
    memcpy(list->name[list->count], t.begin, t.length);
    list->name[list->count++][t.length] = '\0';
}

/* After DefineConstant: the names at the outermost level of its brackets, each at the beginning of an item.
 */
static void read_constants(const char **text, name_list *list) {
    int depth = 0;
    bool expecting = false;
    do {
        token t = next_token(text);
        if (t.kind == TOKEN_END)
            return;
        if (t.kind == TOKEN_MARK && strchr("[({", *t.begin)) {
            expecting = depth++ == 0;
        } else if (t.kind == TOKEN_MARK && strchr("])}", *t.begin)) {
            depth--;
        } else if (t.kind == TOKEN_MARK && *t.begin == ',') {
            expecting = depth == 1;
        } else if (t.kind == TOKEN_WORD && expecting && depth == 1) {
            add_name(list, t);
            expecting = false;
        }
    } while (depth > 0);
}

static char *load(const char *path) {
    char *text = NULL;
    size_t size = 0;
    FILE *in = fopen(path, "r");
    if (!in)
        return NULL;
    if (getdelim(&text, &size, '\0', in) < 0) {
        free(text);
        text = NULL;
    }
    fclose(in);
    return text;
}

static bool is_geo(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcasecmp(path + length - 4, ".geo") == 0;
}

static void scan(const char *path, int depth, name_list *list);

/* A file named in a .geo stands relative to it. */
static void scan_included(const char *path, token name, int depth, name_list *list) {
    const char *slash = strrchr(path, '/');
    int folder = slash && *name.begin != '/' ? (int)(slash - path) + 1 : 0;
    char *inner = NULL;
    if (asprintf(&inner, "%.*s%.*s", folder, path, (int)name.length, name.begin) < 0)
        return;
    if (is_geo(inner) && depth < MAX_DEPTH)
        scan(inner, depth + 1, list);
    free(inner);
}

/* Files that cannot be read are passed over: gmsh reports them. */
static void scan(const char *path, int depth, name_list *list) {
    char *text = load(path);
    const char *p = text;
    for (token t = {TOKEN_MARK, NULL, 0}; text && t.kind != TOKEN_END;) {
        t = next_token(&p);
        if (t.kind == TOKEN_WORD && is_text(t, "DefineConstant"))
            read_constants(&p, list);
        if (t.kind != TOKEN_WORD || (!is_text(t, "Include") && !is_text(t, "Merge")))
            continue;
        t = next_token(&p);
        if (t.kind == TOKEN_TEXT)
            scan_included(path, t, depth, list);
    }
    free(text);
}

static bool has_name(const name_list *list, const char *name) {
    for (int k = 0; k < list->count; k++)
        if (strcmp(list->name[k], name) == 0)
            return true;
    return false;
}

sf_status sf_geo_parameters_check(const sf_geo_source *source, sf_error *err) {
    if (source->parameter_count == 0)
        return SF_OK;
    if (!is_geo(source->path))
        return SF_FAIL(err, SF_ERR_INPUT, "%s takes no parameters (\"%s\" is set): only .geo files do",
                       source->path, source->parameter[0].name);
    name_list *list = sf_alloc(err, 1, sizeof *list, "parameter names");
    if (!list)
        return err->status;
    scan(source->path, 0, list);
    for (int k = 0; k < source->parameter_count && err->status == SF_OK; k++) {
        if (has_name(list, source->parameter[k].name))
            continue;
        char names[640];
        size_t used = 0;
        names[0] = '\0';
        for (int i = 0; i < list->count && used < sizeof names; i++)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", list->name[i]);
        SF_FAIL(err, SF_ERR_INPUT, "%s has no parameter \"%s\"; its DefineConstant parameters are: %s",
                source->path, source->parameter[k].name, list->count ? names : "none");
    }
    free(list);
    return err->status;
}
