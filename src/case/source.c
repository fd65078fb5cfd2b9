/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/source.h"

#include "case/grammar.h"
#include "io/plain_file.h"
#include "io/provenance.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A case is written by hand. */
enum { INCLUDE_DEPTH = 10, MOST_INCLUDES = 200, LARGEST_TEXT = 1 << 20 /* bytes, of all files together */ };

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
    if (dot && strncmp(text, "materials.", 10) == 0) /* a layer */
        dot = strchr(dot + 1, '.');
    return equals && equals[1] == '@' && (!dot || dot > equals) ? equals + 2 : NULL;
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

/* The text under construction. */
typedef struct text_copy {
    FILE *out;
    int lines, includes;
    size_t bytes; /* read so far */
    sf_case_scan scan;
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

static sf_status copy_include(text_copy *copy, sf_case_slice name, const char *path, int line, int depth,
                              sf_error *err) {
    char *included = NULL;
    int length = (int)name.length;
    if (++copy->includes > MOST_INCLUDES)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d files are included", path, line,
                       MOST_INCLUDES);
    if (asprintf(&included, "%s%s%.*s", *name.text == '/' ? "" : copy->folder, *name.text == '/' ? "" : "/",
                 length, name.text) < 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    fprintf(copy->out, SF_INCLUDED_BEGIN "%.*s" SF_INCLUDED_END "\n", length, name.text);
    copy->lines++;
    if (copy_text(copy, included, path, line, depth + 1, err) == SF_OK)
        begin_piece(copy, path, line + 1, err);
    free(included);
    return err->status;
}

static sf_status copy_line(text_copy *copy, const char *text, size_t length, const char *path, int line,
                           int depth, sf_error *err) {
    sf_case_slice include;
    copy->scan.path = path;
    copy->scan.line = line;
    SF_TRY(sf_case_scan_line(&copy->scan, text, length, &include, err));
    if (include.text)
        return copy_include(copy, include, path, line, depth, err);
    fwrite(text, 1, length, copy->out);
    fputc('\n', copy->out);
    copy->lines++;
    return SF_OK;
}

static sf_status copy_lines(text_copy *copy, const char *text, size_t size, const char *path, int depth,
                            sf_error *err) {
    SF_TRY(begin_piece(copy, path, 1, err));
    for (int line = 1; size > 0; line++) {
        const char *end = memchr(text, '\n', size);
        size_t length = end ? (size_t)(end - text) : size;
        SF_TRY(copy_line(copy, text, length, path, line, depth, err));
        text += length + (end != NULL);
        size -= length + (end != NULL);
    }
    copy->scan.path = path;
    return sf_case_scan_end(&copy->scan, err);
}

/* `from`: the file with the @include, at `line`; NULL: none. */
static sf_status copy_text(text_copy *copy, const char *path, const char *from, int line, int depth,
                           sf_error *err) {
    char where[SF_CASE_WHERE_SIZE] = "", *text = NULL;
    size_t size = 0;
    sf_error inner = SF_ERROR_INIT;
    if (from)
        snprintf(where, sizeof where, "%s:%d: ", from, line);
    if (depth > INCLUDE_DEPTH)
        return SF_FAIL(err, SF_ERR_INPUT, "%s@include is nested more than %d deep", where, INCLUDE_DEPTH);
    if (sf_plain_read(path, "file", LARGEST_TEXT, &text, &size, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s%s", where, inner.text);
    size_t mark = strncmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* byte order mark */
    copy->bytes += size;                                         /* includes of includes multiply */
    if (copy->bytes > LARGEST_TEXT)
        SF_FAIL(err, SF_ERR_INPUT, "%sthe file %s and its includes are larger than %d bytes", where,
                path, LARGEST_TEXT);
    else
        copy_lines(copy, text + mark, size - mark, path, depth, err);
    free(text);
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
    if (err->status != SF_OK) {
        free(text);
        return NULL;
    }
    return text;
}
