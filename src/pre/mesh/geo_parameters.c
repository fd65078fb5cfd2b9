/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geo_parameters.h"

#include <ctype.h>

#include "base/text.h"
#include "io/plain_file.h"

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

sf_geo_token sf_geo_token_next(const char **text) {
    const char *p = skip_blank(*text);
    sf_geo_token t = {SF_GEO_MARK, p, 1};
    if (*p == '\0') {
        t = (sf_geo_token){SF_GEO_END, p, 0};
    } else if (*p == '"' || *p == '\'') {
        size_t length = strcspn(p + 1, *p == '"' ? "\"" : "'");
        *text = p + 1 + length + (p[1 + length] != '\0');
        return (sf_geo_token){SF_GEO_TEXT, p + 1, length};
    } else if (is_word(*p)) {
        t.kind = SF_GEO_WORD;
        while (is_word(p[t.length]))
            t.length++;
    }
    *text = p + t.length;
    return t;
}

bool sf_geo_token_is(sf_geo_token t, const char *text) {
    return t.length == strlen(text) && strncmp(t.begin, text, t.length) == 0;
}

enum { MAX_NAMES = 256 };

typedef struct name_list {
    int count;
    char name[MAX_NAMES][SF_CASE_NAME_SIZE];
} name_list;

static void add_name(name_list *list, sf_geo_token t) {
    if (t.length >= SF_CASE_NAME_SIZE || list->count == MAX_NAMES)
        return;
    memcpy(list->name[list->count], t.begin, t.length);
    list->name[list->count++][t.length] = '\0';
}

/* After DefineConstant: names at the outermost level of its brackets, each at the beginning of an item. */
static void read_constants(const char **text, name_list *list) {
    int depth = 0;
    bool expecting = false;
    do {
        sf_geo_token t = sf_geo_token_next(text);
        if (t.kind == SF_GEO_END)
            return;
        if (t.kind == SF_GEO_MARK && strchr("[({", *t.begin)) {
            expecting = depth++ == 0;
        } else if (t.kind == SF_GEO_MARK && strchr("])}", *t.begin)) {
            depth--;
        } else if (t.kind == SF_GEO_MARK && *t.begin == ',') {
            expecting = depth == 1;
        } else if (t.kind == SF_GEO_WORD && expecting && depth == 1) {
            add_name(list, t);
            expecting = false;
        }
    } while (depth > 0);
}

static void scan(const char *text, name_list *list) {
    for (sf_geo_token t = {SF_GEO_MARK, NULL, 0}; t.kind != SF_GEO_END;) {
        t = sf_geo_token_next(&text);
        if (t.kind == SF_GEO_WORD && sf_geo_token_is(t, "DefineConstant"))
            read_constants(&text, list);
    }
}

static bool has_name(const name_list *list, const char *name) {
    for (int k = 0; k < list->count; k++)
        if (strcmp(list->name[k], name) == 0)
            return true;
    return false;
}

/* The names in all texts; in the named file alone if the list is not complete. */
static sf_status collect(const sf_geo_source *source, const sf_broker *read, bool complete, name_list *list,
                         sf_error *err) {
    SF_OWNED char *text = NULL;
    for (size_t k = 0; complete && k < read->count; k++)
        if (read->file[k].is_text)
            scan(read->file[k].text, list);
    if (!complete && sf_plain_read(source->path, "geometry", SF_PLAIN_ANY, &text, NULL, err) == SF_OK)
        scan(text, list);
    return err->status;
}

/* Refuses the first parameter that is not in the list. */
static sf_status refuse_missing(const sf_geo_source *source, const name_list *list, sf_error *err) {
    for (int k = 0; k < source->parameter_count; k++) {
        if (has_name(list, source->parameter[k].name))
            continue;
        char names[640] = "";
        for (int i = 0; i < list->count; i++)
            sf_text_add(names, sizeof names, "%s%s", i ? ", " : "", list->name[i]);
        return SF_REFUSE(err, "%s has no parameter \"%s\"; its DefineConstant parameters are: %s",
                         source->path, source->parameter[k].name, list->count ? names : "none");
    }
    return SF_OK;
}

sf_status sf_geo_parameters_check(const sf_geo_source *source, const sf_broker *read, bool complete,
                                  sf_error *err) {
    if (source->parameter_count == 0)
        return SF_OK;
    SF_OWNED name_list *list = sf_alloc(err, 1, sizeof *list, "parameter names");
    if (list && collect(source, read, complete, list, err) == SF_OK)
        refuse_missing(source, list, err);
    return err->status;
}

static bool reads_others(const char *text) {
    for (sf_geo_token t = sf_geo_token_next(&text); t.kind != SF_GEO_END; t = sf_geo_token_next(&text))
        if (t.kind == SF_GEO_WORD && (sf_geo_token_is(t, "Include") || sf_geo_token_is(t, "Merge")))
            return true;
    return false;
}

sf_status sf_geo_parameters_check_alone(const sf_geo_source *source, sf_error *err) {
    const char *ending = source->path ? strrchr(source->path, '.') : NULL;
    SF_OWNED char *text = NULL;
    if (source->parameter_count == 0 || !ending || strcmp(ending, ".geo") != 0)
        return SF_OK;
    SF_OWNED name_list *list = sf_alloc(err, 1, sizeof *list, "parameter names");
    if (list && sf_plain_read(source->path, "geometry", SF_PLAIN_ANY, &text, NULL, err) == SF_OK &&
        !reads_others(text)) {
        scan(text, list);
        refuse_missing(source, list, err);
    }
    return err->status;
}
