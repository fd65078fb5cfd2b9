/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/geo_parameters.h"

#include "pre/mesh/geo_text.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_NAMES = 256, MAX_DEPTH = 10 };

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

/* After DefineConstant: the names at the outermost level of its brackets, each at the beginning of an item.
 */
static void read_constants(const char **text, name_list *list) {
    int depth = 0;
    bool expecting = false;
    do {
        sf_geo_token t = sf_geo_next(text);
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

static void scan(const char *path, int depth, name_list *list);

/* A file named in a .geo stands relative to it. */
static void scan_included(const char *path, sf_geo_token name, int depth, name_list *list) {
    const char *slash = strrchr(path, '/');
    int folder = slash && *name.begin != '/' ? (int)(slash - path) + 1 : 0;
    char *inner = NULL;
    if (asprintf(&inner, "%.*s%.*s", folder, path, (int)name.length, name.begin) < 0)
        return;
    if (sf_geo_is_script(inner) && depth < MAX_DEPTH)
        scan(inner, depth + 1, list);
    free(inner);
}

/* Files that cannot be read are passed over: gmsh reports them. */
static void scan(const char *path, int depth, name_list *list) {
    char *text = sf_geo_load(path);
    const char *p = text;
    for (sf_geo_token t = {SF_GEO_MARK, NULL, 0}; text && t.kind != SF_GEO_END;) {
        t = sf_geo_next(&p);
        if (t.kind == SF_GEO_WORD && sf_geo_is(t, "DefineConstant"))
            read_constants(&p, list);
        if (t.kind != SF_GEO_WORD || (!sf_geo_is(t, "Include") && !sf_geo_is(t, "Merge")))
            continue;
        t = sf_geo_next(&p);
        if (t.kind == SF_GEO_TEXT)
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
    if (!sf_geo_is_script(source->path))
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
