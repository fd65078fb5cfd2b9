/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/parts.h"

#include "case/keys.h"
#include "case/grammar.h"
#include "case/settings.h"
#include "io/plain_file.h"
#include "material/laws.h"
#include <libconfig.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH = 12, MOST_PARTS = 1000 };

void sf_case_parts_free(sf_case_parts *parts) {
    for (int k = 0; k < parts->count; k++) {
        free(parts->part[k].path);
        free(parts->part[k].included_as);
        free(parts->part[k].text);
        free(parts->part[k].name);
    }
    free(parts->part);
    *parts = (sf_case_parts){0};
}

static sf_status no_memory(sf_error *err) {
    return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the text of a case");
}

/* ---- reading ---- */

/* A new part without a text. */
static sf_status add_part(sf_case_parts *parts, const char *path, sf_error *err) {
    if (parts->count == MOST_PARTS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: more than %d files are included", path, MOST_PARTS);
    if (parts->count == parts->capacity) {
        int capacity = parts->capacity ? 2 * parts->capacity : 8;
        sf_case_part *grown = realloc(parts->part, (size_t)capacity * sizeof *grown);
        if (!grown)
            return no_memory(err);
        parts->part = grown;
        parts->capacity = capacity;
    }
    char *whole = sf_path_whole(NULL, path, err);
    if (whole)
        parts->part[parts->count++] = (sf_case_part){.path = whole};
    return err->status;
}

/* The parts whose text is being written: a file and those that include it. */
typedef struct open_parts {
    sf_case_parts *parts;
    int depth;
    struct {
        int index;
        char *text;
        size_t size;
        FILE *out;
    } at[DEPTH];
} open_parts;

static sf_status begin_part(void *context, const char *path, const sf_case_slice *included_as,
                            sf_error *err) {
    open_parts *o = context;
    int index = o->parts->count;
    if (o->depth == DEPTH)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: @include is nested more than %d deep", path, DEPTH - 1);
    SF_TRY(add_part(o->parts, path, err));
    if (included_as && !(o->parts->part[index].included_as = strndup(included_as->text, included_as->length)))
        return no_memory(err);
    o->at[o->depth].index = index;
    o->at[o->depth].out = open_memstream(&o->at[o->depth].text, &o->at[o->depth].size);
    return o->at[o->depth++].out ? SF_OK : no_memory(err);
}

static sf_status put_line(void *context, const char *text, size_t length, bool ended, sf_error *err) {
    open_parts *o = context;
    FILE *out = o->at[o->depth - 1].out;
    fwrite(text, 1, length, out);
    fputs(ended ? "\n" : "", out);
    return err->status;
}

/* The line of an include becomes that of the next part. */
static sf_status put_include(void *context, const char *text, size_t length, bool ended,
                             const sf_case_slice *name, sf_error *err) {
    open_parts *o = context;
    FILE *out = o->at[o->depth - 1].out;
    const char *rest = name->text + name->length + 1;
    fprintf(out, "%.*s@include \"#%d\"", (int)strspn(text, " \t"), text, o->parts->count);
    return put_line(o, rest, (size_t)(text + length - rest), ended, err);
}

static sf_status end_part(void *context, sf_error *err) {
    open_parts *o = context;
    o->depth--;
    FILE *out = o->at[o->depth].out;
    bool good = out && fclose(out) == 0;
    o->parts->part[o->at[o->depth].index].text = o->at[o->depth].text;
    return good ? err->status : no_memory(err);
}

/* Reads the file and what it includes as the next parts. */
static sf_status read_whole(sf_case_parts *parts, const char *path, sf_error *err) {
    open_parts o = {.parts = parts};
    const sf_case_visitor visitor = {
        .context = &o, .begin = begin_part, .line = put_line, .include = put_include, .end = end_part};
    sf_case_walk(path, &visitor, err);
    while (o.depth > 0) /* after a failure */
        end_part(&o, err);
    return err->status;
}

sf_status sf_case_parts_read(const char *path, sf_case_parts *parts, sf_error *err) {
    *parts = (sf_case_parts){0};
    return read_whole(parts, path, err);
}

/* ---- changing ---- */

/* `text` in place of text[begin, end) of the part. */
static sf_status replace(sf_case_part *part, size_t begin, size_t end, const char *text, sf_error *err) {
    char *changed = NULL;
    if (asprintf(&changed, "%.*s%s%s", (int)begin, part->text, text, part->text + end) < 0)
        return no_memory(err);
    free(part->text);
    part->text = changed;
    return SF_OK;
}

/* A text in quotes. */
static char *quote(const char *text, sf_error *err) {
    char *out = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&out, &size);
    if (!file) {
        no_memory(err);
        return NULL;
    }
    fputc('"', file);
    for (; *text; text++) {
        if ((unsigned char)*text < ' ')
            fprintf(file, "\\x%02x", (unsigned char)*text);
        else
            fprintf(file, "%s%c", *text == '"' || *text == '\\' ? "\\" : "", *text);
    }
    fputc('"', file);
    fclose(file);
    return out;
}

/* A --set value as it stands in a case: libconfig's syntax if it is that, else a text. */
static char *write_value(const char *value, sf_error *err) {
    config_t scratch;
    char *line = NULL, *out = NULL;
    config_init(&scratch);
    bool parsed = !strpbrk(value, "\r\n") && asprintf(&line, "value = %s;", value) >= 0 &&
                  config_read_string(&scratch, line) && config_setting_length(scratch.root) == 1;
    free(line);
    config_destroy(&scratch);
    if (!parsed)
        return quote(value, err);
    if (!(out = strdup(value)))
        no_memory(err);
    return out;
}

/* Before the closing bracket of the group: on a line of its own if the bracket is. */
static sf_status insert(sf_case_parts *parts, const sf_setting *group, const char *name, const char *value,
                        sf_error *err) {
    sf_case_part *part = &parts->part[group->end_part];
    size_t at = group->end - 1, line = at;
    char *text = NULL;
    while (line > 0 && (part->text[line - 1] == ' ' || part->text[line - 1] == '\t'))
        line--;
    bool own = line > 0 && part->text[line - 1] == '\n';
    int result = own ? asprintf(&text, "%.*s    %s = %s;\n", (int)(at - line), part->text + line, name, value)
                     : asprintf(&text, "%s = %s; ", name, value);
    if (result < 0)
        return no_memory(err);
    at = own ? line : at;
    replace(part, at, at, text, err);
    free(text);
    return err->status;
}

/* At the end of the case file. */
static sf_status append(sf_case_part *part, const char *name, const char *value, sf_error *err) {
    char *text = NULL;
    size_t size = strlen(part->text);
    if (asprintf(&text, "%s\n%s = %s;\n", size > 0 && part->text[size - 1] != '\n' ? "\n" : "", name, value) <
        0)
        return no_memory(err);
    replace(part, size, size, text, err);
    free(text);
    return err->status;
}

/* The setting `path`, which is not there, into the innermost of its groups that is: a.b.c = v may become
 * b = { c = v; } in a. Takes `value`. */
static sf_status add_setting(sf_case_parts *parts, const sf_settings *settings, char *path, char *value,
                             sf_error *err) {
    while (value && err->status == SF_OK) {
        char *dot = strrchr(path, '.'), *inner = value;
        if (dot)
            *dot = '\0';
        const sf_setting *group = dot ? sf_settings_get(settings, path) : NULL;
        if (!dot || group) {
            if (!dot)
                append(&parts->part[0], path, value, err);
            else
                insert(parts, group, dot + 1, value, err);
            break;
        }
        if (asprintf(&value, "{ %s = %s; }", dot + 1, inner) < 0)
            value = NULL;
        free(inner);
    }
    if (!value)
        no_memory(err);
    free(value);
    return err->status;
}

/* Returns the kind of file that the setting names; -1: none. */
static int kind_of_file(const sf_setting *s) {
    sf_key_list list;
    char path[SF_SETTING_PATH_SIZE + 16];
    const char *layer = strncmp(s->path, "materials.", 10) == 0 ? strchr(s->path + 10, '.') : NULL;
    snprintf(path, sizeof path, "%s%s", layer ? "material" : "", layer ? layer : s->path);
    char *dot = strrchr(path, '.');
    bool entry = dot && strcmp(dot, ".file") == 0 && strcmp(path, "geometry.file") != 0; /* of a list */
    if (entry)
        *dot = '\0';
    dot = strrchr(path, '.');
    for (int law = 0; dot && s->kind == '"' && sf_law_get(law); law++) {
        sf_case_list_keys(sf_law_get(law), &list);
        *dot = '\0';
        const sf_key *key = sf_case_find_key(&list, path, dot + 1);
        *dot = '.';
        if (key && key->kind == SF_KEY_PATH && !entry)
            return SF_CASE_FILE_GEOMETRY;
        if (key && key->kind == (entry ? SF_KEY_CURVES : SF_KEY_CURVE))
            return SF_CASE_FILE_DATA;
        if (key && key->kind == SF_KEY_MOTION && !entry)
            return SF_CASE_FILE_DATA;
    }
    return -1;
}

bool sf_case_key_is_file(const char *key) {
    sf_setting s = {.kind = '"'};
    snprintf(s.path, sizeof s.path, "%s", key);
    return kind_of_file(&s) >= 0;
}

/* Roots the names of files among the settings in text[begin, end) of the part: they begin at the case's
 * folder, written from / on, as the part may be a file of another folder. */
static sf_status root_files(sf_case_parts *parts, int part, size_t begin, size_t end, sf_error *err) {
    sf_settings settings;
    char *folder = sf_case_folder_of(parts->part[0].path, err);
    sf_settings_find(parts, &settings, err);
    for (int k = settings.count - 1; k >= 0 && err->status == SF_OK; k--) {
        const sf_setting *s = &settings.setting[k];
        if (s->part != part || s->begin < begin || s->end > end || kind_of_file(s) < 0)
            continue;
        char *name = sf_setting_text(parts, s, err), *whole = name ? sf_path_whole(folder, name, err) : NULL,
             *text = whole ? quote(whole, err) : NULL;
        if (text)
            replace(&parts->part[part], s->begin, s->end, text, err);
        free(name);
        free(whole);
        free(text);
    }
    free(folder);
    sf_settings_free(&settings);
    return err->status;
}

/* In place of the setting's value. */
static sf_status change(sf_case_parts *parts, const sf_setting *s, const char *value, sf_error *err) {
    if (s->part != s->end_part)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %s begins in this file and ends in another one",
                       parts->part[s->part].path, s->path);
    SF_TRY(replace(&parts->part[s->part], s->begin, s->end, value, err));
    return root_files(parts, s->part, s->begin, s->begin + strlen(value), err);
}

/* The value of a --set text for a case; from malloc. */
static char *take_value(sf_case_parts *parts, const char *text, sf_error *err) {
    const char *file = sf_case_override_file(text), *value = strchr(text, '=') + 1;
    char *out = NULL;
    int index = parts->count;
    if (!file)
        return write_value(value + strspn(value, " \t"), err);
    if (read_whole(parts, file, err) == SF_OK && asprintf(&out, "{\n@include \"#%d\"\n}", index) < 0)
        no_memory(err);
    return err->status == SF_OK ? out : NULL;
}

sf_status sf_case_parts_set(sf_case_parts *parts, const char *text, sf_error *err) {
    const char *equals = strchr(text, '=');
    char path[SF_SETTING_PATH_SIZE], group[SF_SETTING_PATH_SIZE];
    sf_settings settings = {0};
    if (!equals || equals - text >= SF_SETTING_PATH_SIZE)
        return SF_FAIL(err, SF_ERR_INPUT, "--set %.100s: expected group.key=value", text);
    text += strspn(text, " \t");
    int length = (int)(equals - text);
    while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\t'))
        length--;
    snprintf(path, sizeof path, "%.*s", length, text);
    char *value = take_value(parts, text, err);
    if (!value || sf_settings_find(parts, &settings, err) != SF_OK)
        goto done;
    const sf_setting *s = sf_settings_get(&settings, path);
    if (s) {
        change(parts, s, value, err);
        goto done;
    }
    strcpy(group, path);
    add_setting(parts, &settings, group, value, err);
    value = NULL;
    sf_settings_free(&settings);
    if (err->status == SF_OK && sf_settings_find(parts, &settings, err) == SF_OK &&
        (s = sf_settings_get(&settings, path)))
        root_files(parts, s->part, s->begin, s->end, err);
done:
    free(value);
    sf_settings_free(&settings);
    return err->status;
}

/* ---- new names ---- */

/* In place of text[begin, end) of a part. */
typedef struct edit {
    int part;
    size_t begin, end;
    char *text; /* owned */
} edit;

typedef struct edits {
    int count;
    edit *list; /* [count] */
} edits;

/* Sorts from the back, so that places stay true. */
static int compare_edits(const void *a, const void *b) {
    const edit *p = a, *q = b;
    return p->part != q->part ? p->part - q->part : (p->begin < q->begin) - (p->begin > q->begin);
}

/* Returns the place in the new folder of a name that begins in the folder part of `from`; NULL: outside of
 * it. From malloc. */
static char *find_wanted(const char *from, const char *name, sf_error *err) {
    static const char root[] = "/\001"; /* no folder's name */
    char *folder = NULL, *out = NULL;
    if (*name == '/')
        return NULL;
    if (asprintf(&folder, "%s/%.*s", root, (int)sf_path_folder_length(from), from) < 0) {
        no_memory(err);
        return NULL;
    }
    char *whole = sf_path_whole(folder, name, err);
    const char *below = whole ? sf_path_below(root, whole) : NULL;
    if (below && !(out = strdup(below)))
        no_memory(err);
    free(whole);
    free(folder);
    return out;
}

static const char *ask(const sf_case_file *file, const char *from, const char *name, sf_case_place place,
                       void *context, sf_error *err) {
    char *wanted = name ? find_wanted(from, name, err) : NULL;
    sf_case_file asked = *file;
    asked.wanted = wanted;
    const char *found = err->status == SF_OK ? place(context, &asked, err) : NULL;
    free(wanted);
    return found;
}

/* The part that the include at `s` stands for; includes begin at the case's folder. */
static char *place_part(sf_case_parts *parts, const sf_setting *s, sf_case_place place, void *context,
                        sf_error *err) {
    sf_case_part *part = &parts->part[s->end_part];
    const sf_case_file file = {SF_CASE_FILE_PART, part->path, NULL, part->text};
    const char *name = ask(&file, parts->part[0].name, part->included_as, place, context, err);
    char *line = NULL;
    if (!name)
        return NULL;
    free(part->name);
    part->name = strdup(name);
    if (!part->name || asprintf(&line, "@include \"%s\"", name) < 0)
        no_memory(err);
    return line;
}

static char *place_file(sf_case_parts *parts, const sf_setting *s, sf_case_place place, void *context,
                        sf_error *err) {
    const sf_case_part *part = &parts->part[s->part];
    char *folder = sf_case_folder_of(part->path, err), *name = sf_setting_text(parts, s, err),
         *path = folder && name ? sf_path_whole(folder, name, err) : NULL, *text = NULL;
    const sf_case_file file = {kind_of_file(s) == SF_CASE_FILE_GEOMETRY ? SF_CASE_FILE_GEOMETRY
                                                                        : SF_CASE_FILE_DATA,
                               path, NULL, NULL};
    const char *found = path ? ask(&file, part->name, name, place, context, err) : NULL;
    char *between = found ? sf_path_between(part->name, found, err) : NULL;
    if (between)
        text = quote(between, err);
    free(folder);
    free(name);
    free(path);
    free(between);
    return text;
}

/* Finds the new names: first those of the parts, on whose names those of the files depend. */
static sf_status find_edits(sf_case_parts *parts, const sf_settings *settings, edits *out,
                            sf_case_place place, void *context, sf_error *err) {
    out->list = sf_alloc(err, (unsigned long)settings->count, sizeof *out->list, "the names of files");
    for (int files = 0; files < 2; files++)
        for (int k = 0; k < settings->count && err->status == SF_OK; k++) {
            const sf_setting *s = &settings->setting[k];
            if ((s->kind != '@') != (files == 1) || (files == 1 && kind_of_file(s) < 0))
                continue;
            char *text =
                files ? place_file(parts, s, place, context, err) : place_part(parts, s, place, context, err);
            out->list[out->count++] = (edit){s->part, s->begin, s->end, text};
        }
    return err->status;
}

sf_status sf_case_parts_finish(sf_case_parts *parts, sf_case_place place, void *context, sf_error *err) {
    sf_settings settings;
    edits e = {0};
    if (sf_settings_find(parts, &settings, err) == SF_OK &&
        find_edits(parts, &settings, &e, place, context, err) == SF_OK) {
        qsort(e.list, (size_t)e.count, sizeof *e.list, compare_edits);
        for (int k = 0; k < e.count && err->status == SF_OK; k++)
            replace(&parts->part[e.list[k].part], e.list[k].begin, e.list[k].end, e.list[k].text, err);
    }
    for (int k = 0; k < e.count; k++)
        free(e.list[k].text);
    free(e.list);
    sf_settings_free(&settings);
    return err->status;
}
