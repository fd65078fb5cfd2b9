/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/edit.h"

#include "case/grammar.h"

#include "base/text.h"

#include <string.h>

#include "case/values.h"
#include "io/plain_file.h"

static sf_status no_memory(sf_error *err) {
    return SF_NO_MEMORY(err, "the text of a case");
}

/* ---- settings ---- */

/* The characters of names, numbers and words. */
static const char WORD[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-*";

static const char *pass_blanks(const char *at) {
    return sf_blanks_pass(at, true);
}

static const char *pass_string(const char *at) {
    for (at++; *at && *at != '"'; at++)
        at += *at == '\\' && at[1];
    return at + (*at == '"');
}

typedef struct finder {
    const char *text;
    sf_edit_settings *out; /* with room for all */
} finder;

static const char *pass_settings(finder *f, const char *at, const char *path);

static const char *pass_value(finder *f, const char *at, const char *path) {
    if (*at && strchr("{([", *at)) {
        at = pass_settings(f, at + 1, path);
        return at + (*at != '\0');
    }
    if (*at == '"') { /* libconfig joins strings that follow each other */
        const char *end = pass_string(at);
        for (at = pass_blanks(end); *at == '"'; at = pass_blanks(end))
            end = pass_string(at);
        return end;
    }
    size_t length = strspn(at, WORD);
    return at + (length > 0 ? length : *at != '\0');
}

/* Lists the settings from `at` to the bracket that closes their group or list, or to the end. The brackets
 * are not nested deeper than the scan of the case allows (case/grammar.h). */
static const char *pass_settings(finder *f, const char *at, const char *path) {
    for (at = pass_blanks(at); *at && !strchr(")]}", *at); at = pass_blanks(at)) {
        size_t length = strspn(at, WORD);
        const char *next = pass_blanks(at + length);
        if (length == 0 || (*next != '=' && *next != ':')) {
            at = pass_value(f, at, path);
            continue;
        }
        int index = f->out->count++;
        sf_edit_setting *s = &f->out->setting[index];
        snprintf(s->path, sizeof s->path, "%s%s%.*s", path, *path ? "." : "", (int)length, at);
        at = pass_blanks(next + 1);
        s->begin = (size_t)(at - f->text);
        at = pass_value(f, at, s->path);
        s->end = (size_t)(at - f->text);
    }
    return at;
}

sf_status sf_case_edit_find(const char *text, bool only_files, sf_edit_settings *settings, sf_error *err) {
    unsigned long most = 0;
    int kept = 0;
    for (const char *at = text; (at = strpbrk(at, "=:")); at++)
        most++;
    *settings = (sf_edit_settings){0, sf_alloc(err, most, sizeof *settings->setting, "a case's settings")};
    SF_TRY(err->status);
    finder f = {text, settings};
    pass_settings(&f, text, "");
    for (int k = 0; k < settings->count; k++)
        if (!only_files ||
            (text[settings->setting[k].begin] == '"' && sf_case_key_is_file(settings->setting[k].path)))
            settings->setting[kept++] = settings->setting[k];
    settings->count = kept;
    return SF_OK;
}

static const sf_edit_setting *find_path(const sf_edit_settings *settings, const char *path) {
    for (int k = 0; k < settings->count; k++)
        if (strcmp(settings->setting[k].path, path) == 0)
            return &settings->setting[k];
    return NULL;
}

/* ---- values ---- */

static void put_quoted(const char *text, FILE *out) {
    fputc('"', out);
    for (; *text; text++) {
        if ((unsigned char)*text < ' ')
            fprintf(out, "\\x%02x", (unsigned char)*text);
        else
            fprintf(out, "%s%c", *text == '"' || *text == '\\' ? "\\" : "", *text);
    }
    fputc('"', out);
}

/* Returns the value in libconfig syntax as the text that it means; from malloc, NULL if it is no text. `one`
 * receives whether it is one value of libconfig syntax. */
static char *text_of(const char *value, size_t length, bool *one) {
    SF_OWNED_BY(config_destroy) config_t scratch;
    SF_OWNED char *line = NULL;
    const char *text = NULL;
    config_init(&scratch);
    *one = asprintf(&line, "value = %.*s;", (int)length, value) >= 0 && config_read_string(&scratch, line) &&
           config_setting_length(scratch.root) == 1;
    return *one && config_lookup_string(&scratch, "value", &text) ? strdup(text) : NULL;
}

sf_status sf_case_edit_write(const char *text, size_t begin, size_t end, const sf_edit_settings *files,
                             const sf_edit_rename *rename, FILE *out, sf_error *err) {
    for (int k = 0; k < files->count && err->status == SF_OK; k++) {
        const sf_edit_setting *s = &files->setting[k];
        bool one;
        if (s->begin < begin || s->begin >= end)
            continue;
        if (s->end > end)
            return SF_REFUSE(err, "%s begins in one file and ends in another", s->path);
        char *name = text_of(text + s->begin, s->end - s->begin, &one),
             *renamed = name ? rename->name(rename->context, s->path, name, err) : NULL;
        fprintf(out, "%.*s", (int)(s->begin - begin), text + begin);
        if (renamed)
            put_quoted(renamed, out);
        else
            no_memory(err);
        begin = s->end;
        SF_FREE(name, renamed);
    }
    fprintf(out, "%.*s", (int)(end - begin), text + begin);
    return err->status;
}

/* ---- --set texts ---- */

static char *name_whole(void *folder, const char *path, const char *name, sf_error *err) {
    (void)path;
    return sf_path_whole(folder, name, err);
}

/* Writes the value of a --set text as it stands in a case: libconfig's syntax if it is that, else a text. */
static sf_status put_value(const char *path, const char *value, char *folder, FILE *out, sf_error *err) {
    SF_OWNED char *line = NULL;
    size_t size = 0;
    bool one = false;
    sf_edit_settings files = {0};
    FILE *written = open_memstream(&line, &size);
    if (!written)
        return no_memory(err);
    fprintf(written, "%s=", path);
    if (!strpbrk(value, "\r\n"))
        free(text_of(value, strlen(value), &one));
    if (one)
        fputs(value, written);
    else
        put_quoted(value, written);
    fclose(written);
    if (sf_case_edit_find(line, true, &files, err) == SF_OK)
        sf_case_edit_write(line, strlen(path) + 1, size, &files, &(sf_edit_rename){name_whole, folder}, out,
                           err);
    free(files.setting);
    return err->status;
}

/* Writes the file of a "group=@file" as a group that includes it. */
static sf_status put_file(const char *file, FILE *out, sf_error *err) {
    SF_OWNED char *whole = sf_path_whole(NULL, file, err),
                  *text = whole ? sf_case_load_marked(file, true, err) : NULL;
    if (text) {
        size_t size = strlen(text);
        fprintf(out, "{\n#%c@include \"%s\"\n%s%s#%c\n}", SF_CASE_BEGIN, whole, text,
                size > 0 && text[size - 1] != '\n' ? "\n" : "", SF_CASE_END);
    }
    return err->status;
}

/* Puts `insert` in place of text[begin, end), which may hold whole files, but not a part of one. */
static sf_status replace(char **text, size_t begin, size_t end, const char *insert, sf_error *err) {
    char *changed = NULL;
    int depth = 0;
    for (size_t k = begin; k < end && depth >= 0; k++)
        depth += ((*text)[k] == SF_CASE_BEGIN) - ((*text)[k] == SF_CASE_END);
    if (depth != 0)
        return SF_REFUSE(err, "a setting that --set changes begins in one file and ends in another");
    if (asprintf(&changed, "%.*s%s%s", (int)begin, *text, insert, *text + end) < 0)
        return no_memory(err);
    free(*text);
    *text = changed;
    return SF_OK;
}

/* Puts the setting `path`, which is not there, into the innermost of its groups that is: a.b.c = v may become
 * b = { c = v; } in a. A group gets it before its closing bracket, on a line of its own if the bracket has
 * one. Takes `value`, and changes `path`. */
static sf_status add(char **text, const sf_edit_settings *settings, char *path, char *value, sf_error *err) {
    char *dot, *line = NULL;
    const sf_edit_setting *group = NULL;
    while (value && (dot = strrchr(path, '.')) && !group) {
        char *inner = value;
        *dot = '\0';
        group = find_path(settings, path);
        if (asprintf(&value, group ? "%s = %s;" : "{ %s = %s; }", dot + 1, inner) < 0)
            value = NULL;
        free(inner);
    }
    size_t at = group ? group->end - 1 : strlen(*text), from = at;
    while (group && from > 0 && ((*text)[from - 1] == ' ' || (*text)[from - 1] == '\t'))
        from--;
    bool own = at > 0 && (*text)[from - 1] == '\n';
    int length = -1;
    if (value && !group)
        length = asprintf(&line, "%s\n%s = %s;\n", own || at == 0 ? "" : "\n", path, value);
    else if (value && own)
        length = asprintf(&line, "%.*s    %s\n", (int)(at - from), *text + from, value);
    else if (value)
        length = asprintf(&line, "%s ", value);
    if (length < 0)
        no_memory(err);
    else
        replace(text, own ? from : at, own ? from : at, line, err);
    SF_FREE(value, line);
    return err->status;
}

sf_status sf_case_edit_set(char **text, const char *path, const char *set, sf_error *err) {
    SF_OWNED char *value = NULL, *folder = sf_case_folder_of(path, err);
    char key[SF_EDIT_PATH_SIZE] = "";
    const char *file = sf_case_override_file(set), *equals = strchr(set, '=');
    size_t size = 0;
    sf_edit_settings settings = {0};
    sscanf(set, " %255[^= \t]", key);
    FILE *out = folder ? open_memstream(&value, &size) : NULL;
    if (!out)
        return no_memory(err);
    if (file)
        put_file(file, out, err);
    else
        put_value(key, equals + 1 + strspn(equals + 1, " \t"), folder, out, err);
    fclose(out);
    if (err->status == SF_OK && sf_case_edit_find(*text, false, &settings, err) == SF_OK) {
        const sf_edit_setting *s = find_path(&settings, key);
        if (s) {
            replace(text, s->begin, s->end, value, err);
        } else {
            add(text, &settings, key, value, err);
            value = NULL;
        }
    }
    free(settings.setting);
    return err->status;
}
