/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/source.h"

#include "io/provenance.h"
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { INCLUDE_DEPTH = 10, LARGEST_TEXT = 1 << 24 /* bytes: a case is written by hand */ };

char *sf_case_folder_of(const char *path, sf_error *err) {
    const char *slash = strrchr(path, '/');
    char *folder = !slash ? strdup(".") : slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
    if (!folder)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    return folder;
}

const char *sf_case_override_file(const char *text) {
    const char *equals = strchr(text, '=');
    const char *dot = strchr(text, '.');
    return equals && equals[1] == '@' && (!dot || dot > equals) ? equals + 2 : NULL;
}

/* The file name of a line `@include "name"`, in place; NULL for any other line. */
static char *include_name(char *line) {
    char *text = line + strspn(line, " \t");
    if (strncmp(text, "@include", 8) != 0)
        return NULL;
    text += 8 + strspn(text + 8, " \t");
    char *end = *text == '"' ? strchr(text + 1, '"') : NULL;
    if (!end)
        return NULL;
    *end = '\0';
    return text + 1;
}

void sf_case_source_free(sf_case_source *source) {
    for (int k = 0; k < source->count; k++)
        free(source->piece[k].path);
    free(source->piece);
    *source = (sf_case_source){0};
}

const char *sf_case_source_find(const sf_case_source *source, int line, int *file_line) {
    int k = source->count - 1;
    while (k > 0 && source->piece[k].first > line)
        k--;
    *file_line = line - source->piece[k].first + source->piece[k].line;
    return source->piece[k].path;
}

/* The end of the string or comment that begins at p; p if none does. */
static const char *past_string_or_comment(const char *p) {
    if (*p == '"') {
        for (p++; *p && *p != '"'; p++)
            p += *p == '\\' && p[1];
        return p + (*p == '"');
    }
    if (*p == '#' || strncmp(p, "//", 2) == 0)
        return p + strcspn(p, "\n");
    if (strncmp(p, "/*", 2) == 0) {
        const char *end = strstr(p + 2, "*/");
        return end ? end + 2 : p + strlen(p);
    }
    return p;
}

static bool is_wide(const char *word, size_t length) {
    char *end;
    errno = 0;
    long long value = strtoll(word, &end, word[0] == '0' && (word[1] == 'x' || word[1] == 'X') ? 16 : 10);
    end += errno == ERANGE ? strspn(end, "L") : 0;
    return end == word + length && (errno == ERANGE || value < INT_MIN || value > INT_MAX);
}

const char *sf_case_wide_integer(const char *text, int *length, int *line) {
    *line = 1;
    for (const char *p = text, *end; *p; p = end) {
        size_t word = strspn(p, "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_.+-");
        *length = (int)word;
        if (word > 0 && is_wide(p, word))
            return p;
        end = word > 0 ? p + word : past_string_or_comment(p);
        end += end == p;
        for (const char *c = p; c < end; c++)
            *line += *c == '\n';
    }
    return NULL;
}

static void refuse_wide_integer(const char *path, const char *text, const sf_case_source *source,
                                sf_error *err) {
    int length, line;
    const char *number = sf_case_wide_integer(text, &length, &line);
    const char *file = number && source ? sf_case_source_find(source, line, &line) : path;
    if (number)
        SF_FAIL(err, SF_ERR_INPUT,
                "%s:%d: %.*s is too large for a whole number: write it with a decimal point, or with an L",
                file, line, length, number);
}

/* The text under construction. */
typedef struct text_copy {
    FILE *out;
    int lines;
    const char *folder;     /* of the case: includes are relative to it */
    sf_case_source *source; /* NULL: not wanted */
} text_copy;

/* The next line of the text is line `line` of the file. */
static sf_status begin_piece(text_copy *copy, const char *path, int line, sf_error *err) {
    sf_case_source *source = copy->source;
    if (!source)
        return SF_OK;
    if (source->count == source->capacity) {
        int capacity = source->capacity ? 2 * source->capacity : 8;
        sf_case_piece *grown = realloc(source->piece, (size_t)capacity * sizeof *grown);
        if (!grown)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
        source->piece = grown;
        source->capacity = capacity;
    }
    char *name = strdup(path);
    if (!name)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    source->piece[source->count++] = (sf_case_piece){copy->lines + 1, line, name};
    return SF_OK;
}

static sf_status copy_text(text_copy *copy, const char *path, const char *from, int line, int depth,
                           sf_error *err);

static sf_status copy_include(text_copy *copy, const char *name, const char *path, int line, int depth,
                              sf_error *err) {
    char *included = NULL;
    if (*name == '/')
        included = strdup(name);
    else if (asprintf(&included, "%s/%s", copy->folder, name) < 0)
        included = NULL;
    if (!included)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    fprintf(copy->out, SF_INCLUDED_BEGIN "%s" SF_INCLUDED_END "\n", name);
    copy->lines++;
    if (copy_text(copy, included, path, line, depth + 1, err) == SF_OK)
        begin_piece(copy, path, line + 1, err);
    free(included);
    return err->status;
}

static sf_status copy_line(text_copy *copy, char *text, size_t length, const char *path, int line, int depth,
                           sf_error *err) {
    if (strlen(text) != length)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: a zero byte: this is not a text file", path, line);
    char *kept = strdup(text);
    if (!kept)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    char *name = include_name(kept);
    if (name) {
        copy_include(copy, name, path, line, depth, err);
    } else {
        fputs(text, copy->out);
        if (text[length - 1] != '\n')
            fputc('\n', copy->out);
        copy->lines++;
    }
    free(kept);
    return err->status;
}

static sf_status copy_text(text_copy *copy, const char *path, const char *from, int line, int depth,
                           sf_error *err) {
    char where[SF_CASE_WHERE_SIZE] = "";
    if (from)
        snprintf(where, sizeof where, "%s:%d: ", from, line);
    struct stat info;
    if (depth > INCLUDE_DEPTH)
        return SF_FAIL(err, SF_ERR_INPUT, "%s@include is nested more than %d deep", where, INCLUDE_DEPTH);
    if (stat(path, &info) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s cannot be read: %s", where, path,
                       strerror(errno));
    if (!S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s is not a plain file", where, path);
    if (info.st_size > LARGEST_TEXT || ftell(copy->out) > LARGEST_TEXT) /* includes of includes multiply */
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s and its includes are larger than %d bytes",
                       where, path, LARGEST_TEXT);
    FILE *in = fopen(path, "r");
    if (!in)
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s cannot be read: %s", where, path,
                       strerror(errno));
    char *text = NULL;
    size_t size = 0;
    ssize_t length;
    begin_piece(copy, path, 1, err);
    for (int number = 1; err->status == SF_OK && (length = getline(&text, &size, in)) >= 0; number++)
        copy_line(copy, text, (size_t)length, path, number, depth, err);
    free(text);
    fclose(in);
    return err->status;
}

/* A file that stands in place of a group, each line as a comment. */
static sf_status copy_as_comment(const char *path, FILE *out, sf_error *err) {
    char *text = sf_case_load_text(path, 0, NULL, NULL, err), *rest = text;
    for (char *line = strsep(&rest, "\n"); line && (rest || *line); line = strsep(&rest, "\n"))
        fprintf(out, "#     %s\n", line);
    free(text);
    return err->status;
}

/* A --set text may hold line ends, which would leave the comment. */
static void put_override(const char *text, FILE *out) {
    fputs("# --set ", out);
    for (; *text; text++)
        fputc(*text == '\n' ? ' ' : *text, out);
    fputc('\n', out);
}

char *sf_case_load_text(const char *path, int count, const char *const *overrides, sf_case_source *source,
                        sf_error *err) {
    char *text = NULL, *folder = sf_case_folder_of(path, err);
    size_t size = 0;
    FILE *out = folder ? open_memstream(&text, &size) : NULL;
    if (!out) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
        free(folder);
        return NULL;
    }
    text_copy copy = {.out = out, .folder = folder, .source = source};
    copy_text(&copy, path, NULL, 0, 0, err);
    for (int i = 0; i < count && err->status == SF_OK; i++) {
        const char *file = sf_case_override_file(overrides[i]);
        put_override(overrides[i], out);
        if (file)
            copy_as_comment(file, out, err);
    }
    if (fclose(out) != 0)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    free(folder);
    if (err->status == SF_OK)
        refuse_wide_integer(path, text, source, err);
    if (err->status != SF_OK) {
        free(text);
        return NULL;
    }
    return text;
}
