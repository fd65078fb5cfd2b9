/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/grammar.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <string.h>

#include "base/text.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/provenance.h"

enum { MOST_WORDS = 20000, DEEPEST = 32, LONGEST = 4096 /* characters of a string */ };

static const char DIGITS[] = "0123456789", HEXADECIMAL[] = "0123456789abcdefABCDEF";

/* One text, with everything that it includes. Begins with zeros; `path` and `line` are those of the line that
 * follows, for the sentences. */
typedef struct scan_state {
    const char *path;
    int line;
    bool open; /* within a comment that began on `open_line` */
    int open_line;
    int comments; /* so far, like the next */
    int words;    /* names, numbers and strings */
    int depth;    /* of brackets */
} scan_state;

/* A piece of a line, not terminated. */
typedef struct slice {
    const char *text; /* NULL: none */
    size_t length;
} slice;

/* The line being read. */
typedef struct cursor {
    scan_state *scan;
    const char *at, *end;
    sf_error *err;
} cursor;

/* Records "path:line: sentence", of a line 0 "path: sentence". */
#define REFUSE(c, ...) refuse((c)->scan, (c)->scan->line, (c)->err, __LINE__, __VA_ARGS__)

__attribute__((format(printf, 5, 6))) static sf_status refuse(const scan_state *scan, int line, sf_error *err,
                                                              int source_line, const char *format, ...) {
    char sentence[400], number[16] = "";
    SF_PRINT_INTO(sentence, format);
    if (line > 0)
        snprintf(number, sizeof number, ":%d", line);
    return sf_error_set(err, SF_ERR_INPUT, __FILE__, source_line, "%s%s: %s", scan->path, number, sentence);
}

static bool begins(const cursor *c, const char *with) {
    size_t length = strlen(with);
    return (size_t)(c->end - c->at) >= length && memcmp(c->at, with, length) == 0;
}

static size_t blanks(const cursor *c) {
    size_t count = 0;
    while (c->at + count < c->end && (c->at[count] == ' ' || c->at[count] == '\t'))
        count++;
    return count;
}

/* ---- words ---- */

static bool is_word(char c) {
    return isalnum((unsigned char)c) || (c != '\0' && strchr("_.+-*", c));
}

/* [+-] digits or 0x digits, and L or LL. */
static bool is_whole(const char *word) {
    const char *at = word + (*word == '+' || *word == '-');
    bool hexadecimal = at[0] == '0' && (at[1] == 'x' || at[1] == 'X');
    at += hexadecimal ? 2 : 0;
    size_t digits = strspn(at, hexadecimal ? HEXADECIMAL : DIGITS);
    size_t suffix = strspn(at + digits, "L");
    return digits > 0 && suffix <= 2 && at[digits + suffix] == '\0';
}

/* A whole number that is cut: without an L to 32 bits, with one to 64. */
static bool is_wide(const char *word) {
    char *end;
    errno = 0;
    long long value = strtoll(word, &end, word[0] == '0' && (word[1] == 'x' || word[1] == 'X') ? 16 : 10);
    return errno == ERANGE || (*end == '\0' && (value < INT_MIN || value > INT_MAX));
}

static sf_status read_word(cursor *c) {
    char word[64];
    const char *from = c->at;
    while (c->at < c->end && is_word(*c->at))
        c->at++;
    int length = snprintf(word, sizeof word, "%.*s", (int)(c->at - from), from);
    if (isalpha((unsigned char)*word) || *word == '*' || *word == '_')
        return SF_OK;
    const char *rest = sf_decimal_read(word, NULL);
    if (length >= (int)sizeof word || (!is_whole(word) && (!rest || *rest)))
        return REFUSE(c, "\"%.63s\" is not a number", word);
    if (is_whole(word) && is_wide(word))
        return REFUSE(c, "%s is too large for a whole number: write it with a decimal point, or with an L",
                      word);
    return SF_OK;
}

/* ---- strings and comments ---- */

static bool is_hexadecimal(char c) {
    return c != '\0' && strchr(HEXADECIMAL, c);
}

/* libconfig 1.5 keeps the backslash of \a, \b and \v, and newer versions do not. */
static sf_status read_escape(cursor *c) {
    char next = c->at + 1 < c->end ? c->at[1] : '\0';
    bool code = next == 'x' && c->end - c->at > 3 && is_hexadecimal(c->at[2]) && is_hexadecimal(c->at[3]);
    bool known = next != '\0' && strchr("fnrt\\\"", next), zero = code && c->at[2] == '0' && c->at[3] == '0';
    if (zero || (!code && !known))
        return REFUSE(c, "\\%.*s in a text is not a character (a backslash is written \\\\)", code ? 3 : 1,
                      next ? c->at + 1 : "");
    c->at += code ? 4 : 2;
    return SF_OK;
}

static sf_status read_string(cursor *c) {
    const char *from = c->at++;
    while (c->at < c->end && *c->at != '"') {
        if (*c->at != '\\')
            c->at++;
        else if (read_escape(c) != SF_OK)
            return c->err->status;
    }
    if (c->at == c->end)
        return REFUSE(c, "the text that begins with %.*s is not closed with \" on its line",
                      (int)(c->end - from < 24 ? c->end - from : 24), from);
    if (++c->at - from > LONGEST)
        return REFUSE(c, "a text is longer than %d characters", LONGEST);
    return SF_OK;
}

/* Within a comment from here on; moves past its end if that is on the line. */
static void pass_comment(cursor *c) {
    while (c->at < c->end && !begins(c, "*/"))
        c->at++;
    if (c->at < c->end) {
        c->at += 2;
        c->scan->open = false;
    }
}

/* ---- a line ---- */

static sf_status read_item(cursor *c) {
    if (begins(c, "#") || begins(c, "//")) {
        c->scan->comments++;
        c->at = c->end;
    } else if (begins(c, "/*")) {
        c->scan->comments++;
        c->scan->open = true;
        c->scan->open_line = c->scan->line;
        c->at += 2;
        pass_comment(c);
    } else if (*c->at == '"' || is_word(*c->at)) {
        if (++c->scan->words > MOST_WORDS)
            return REFUSE(c, "more than %d names and values: nobody writes such a file", MOST_WORDS);
        return *c->at == '"' ? read_string(c) : read_word(c);
    } else if (strchr("{([])}", *c->at)) {
        c->scan->depth += strchr("{([", *c->at++) ? 1 : -1;
        if (c->scan->depth > DEEPEST)
            return REFUSE(c, "brackets are nested more than %d deep", DEEPEST);
    } else if (*c->at == '@') {
        return REFUSE(c, "%s", "what begins with @ is not @include \"FILE\" at the beginning of a line");
    } else {
        c->at++;
    }
    return SF_OK;
}

/* `@include "name"`, and a comment at most behind it. */
static sf_status read_include(cursor *c, slice *include) {
    c->at += 8;
    c->at += blanks(c);
    const char *name = c->at + 1;
    if (!begins(c, "\""))
        return REFUSE(c, "%s", "@include: the name of a file in quotes is missing");
    for (c->at++; c->at < c->end && *c->at != '"'; c->at++)
        ;
    if (c->at == c->end)
        return REFUSE(c, "%s", "@include: the name of the file is not closed with \"");
    *include = (slice){name, (size_t)(c->at - name)};
    c->at++;
    c->at += blanks(c);
    if (c->at < c->end && !begins(c, "#") && !begins(c, "//"))
        return REFUSE(c, "\"%.*s\" follows @include on its line: write it in the next line",
                      (int)(c->end - c->at < 40 ? c->end - c->at : 40), c->at);
    c->at = c->end;
    return include->length > 0 ? SF_OK : REFUSE(c, "%s", "@include: the name of the file is empty");
}

/* Reads one line (`length` characters, without its line end). `include` receives the file name of an
 * `@include "name"`. */
static sf_status scan_line(scan_state *scan, const char *line, size_t length, slice *include, sf_error *err) {
    bool dos = length > 0 && line[length - 1] == '\r';
    cursor c = {scan, line, line + length - dos, err};
    *include = (slice){0};
    if (memchr(line, '\0', length))
        return REFUSE(&c, "%s", "a zero byte: this is not a text file");
    if (memchr(line, '\r', length - dos))
        return REFUSE(&c, "%s",
                      "a line end of another kind (a carriage return alone): save the file with usual ones");
    if (scan->open) {
        pass_comment(&c);
    } else {
        c.at += blanks(&c);
        if (begins(&c, "@include"))
            return read_include(&c, include);
    }
    while (c.at < c.end && err->status == SF_OK)
        read_item(&c);
    return err->status;
}

/* At the end of a file: an open comment is refused. */
static sf_status scan_end(const scan_state *scan, sf_error *err) {
    if (scan->open)
        return refuse(scan, scan->open_line, err, __LINE__,
                      "the comment that begins here is not closed with */");
    return SF_OK;
}

sf_status sf_case_scan_value(const char *name, const char *text, sf_error *err) {
    scan_state scan = {.path = name};
    slice include;
    SF_TRY(scan_line(&scan, text, strlen(text), &include, err));
    SF_TRY(scan_end(&scan, err));
    if (scan.comments > 0)
        return refuse(&scan, 0, err, __LINE__, "the value holds a comment");
    return SF_OK;
}

/* A case is written by hand. */
enum { INCLUDE_DEPTH = 10, MOST_INCLUDES = 200, LARGEST_TEXT = 1 << 20 /* bytes, of all files together */ };

char *sf_case_folder_of(const char *path, sf_error *err) {
    size_t length = sf_path_folder_length(path);
    char *folder = length > 0 ? strndup(path, length) : strdup(".");
    if (!folder)
        SF_NO_MEMORY(err, "the path %s", path);
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
    SF_CLEAR(source, source->piece);
}

const char *sf_case_source_find(const sf_case_source *source, int line, int *file_line) {
    int k = source->count - 1;
    while (k > 0 && source->piece[k].first > line)
        k--;
    *file_line = line - source->piece[k].first + source->piece[k].line;
    return source->piece[k].path;
}

/* ---- the text with its includes in place ---- */

typedef struct walk {
    FILE *out;
    int lines;              /* written */
    sf_case_source *source; /* NULL: not wanted */
    bool of_case;           /* a line `material = "NAME";` stands for the file of that foam */
    bool marked, whole;     /* as sf_case_load_marked */
    const char *folder;     /* of the case: includes are relative to it */
    int includes;
    size_t bytes; /* read so far: includes of includes multiply */
    scan_state scan;
} walk;

static sf_status no_memory(const char *path, sf_error *err) {
    return SF_NO_MEMORY(err, "the case file %s", path);
}

/* The next line of the text is line `line` of the file. */
static sf_status begin_piece(const walk *w, const char *path, int line, sf_error *err) {
    sf_case_source *source = w->source;
    if (!source)
        return SF_OK;
    char *name = sf_grow(&source->piece, (size_t)source->count, sizeof *source->piece) ? strdup(path) : NULL;
    if (!name)
        return no_memory(path, err);
    source->piece[source->count++] = (sf_case_piece){w->lines + 1, line, name};
    return SF_OK;
}

static sf_status walk_file(walk *w, const char *path, const char *from, int line, int depth, sf_error *err);

/* The file of an include in place of its line, `text`. */
static sf_status walk_include(walk *w, slice text, slice name, const char *path, int line, int depth,
                              sf_error *err) {
    SF_OWNED char *included = NULL, *whole = NULL;
    const char *shown = name.text;
    int length = (int)name.length;
    if (++w->includes > MOST_INCLUDES)
        return SF_REFUSE(err, "%s:%d: more than %d files are included", path, line, MOST_INCLUDES);
    if (asprintf(&included, "%s%s%.*s", *name.text == '/' ? "" : w->folder, *name.text == '/' ? "" : "/",
                 length, name.text) < 0)
        return no_memory(path, err);
    if (w->whole && (whole = sf_path_whole(NULL, included, err))) {
        shown = whole;
        length = (int)strlen(whole);
    }
    if (w->marked)
        fprintf(w->out, "#%c%.*s%.*s%.*s\n", SF_CASE_BEGIN, (int)(name.text - text.text), text.text, length,
                shown, (int)(text.length - (size_t)(name.text - text.text) - name.length),
                name.text + name.length);
    else
        fprintf(w->out, SF_INCLUDED_BEGIN "%.*s" SF_INCLUDED_END "\n", length, shown);
    w->lines++;
    if (err->status == SF_OK && walk_file(w, included, path, line, depth + 1, err) == SF_OK)
        begin_piece(w, path, line + 1, err);
    if (w->marked)
        fprintf(w->out, "#%c\n", SF_CASE_END);
    return err->status;
}

/* The text in quotes of a line `material = "TEXT";` outside of groups; false: it is another line. */
static bool finds_material(const scan_state *scan, slice line, slice *text) {
    cursor c = {.at = line.text, .end = line.text + line.length};
    if (scan->open || scan->depth > 0)
        return false;
    c.at += blanks(&c);
    if (!begins(&c, "material"))
        return false;
    c.at += strlen("material");
    c.at += blanks(&c);
    if (!begins(&c, "=") && !begins(&c, ":"))
        return false;
    c.at++;
    c.at += blanks(&c);
    const char *end = begins(&c, "\"") ? memchr(c.at + 1, '"', (size_t)(c.end - c.at) - 1) : NULL;
    if (!end)
        return false;
    *text = (slice){c.at + 1, (size_t)(end - c.at) - 1};
    c.at = end + 1;
    c.at += blanks(&c);
    c.at += begins(&c, ";");
    c.at += blanks(&c);
    return c.at == c.end || begins(&c, "#") || begins(&c, "//") || begins(&c, "\r");
}

/* Puts the group of a material file in place of a line `material = "NAME";`: that of a foam which comes with
 * softfall, or of a path, which has a dot or a slash. */
static sf_status walk_material(walk *w, slice name, const char *path, int line, int depth, sf_error *err) {
    static const char FOAMS[] = "examples/materials";
    char file[PATH_MAX];
    SF_OWNED char *include = NULL;
    bool is_path = memchr(name.text, '.', name.length) || memchr(name.text, '/', name.length);
    SF_PRINTED(shared, PATH_MAX, "%s/%.*s.cfg", FOAMS, (int)name.length, name.text);
    if (is_path)
        snprintf(file, sizeof file, "%.*s", (int)name.length, name.text);
    else if (name.length == 0 || sf_process_find_shared(shared, file, sizeof file, SF_IGNORED) != SF_OK)
        return SF_REFUSE(err,
                         "%s:%d: material: there is no foam \"%.*s\"; `softfall foam list` lists them, and a "
                         "material file has a name such as \"foam/material.cfg\"",
                         path, line, (int)name.length, name.text);
    if (asprintf(&include, "@include \"%s\"", file) < 0)
        return no_memory(path, err);
    fputs("material: {\n", w->out);
    w->lines++;
    SF_TRY(walk_include(w, (slice){include, strlen(include)}, (slice){include + 10, strlen(file)}, path, line,
                        depth, err));
    fputs("};\n", w->out);
    w->lines++;
    return begin_piece(w, path, line + 1, err);
}

static sf_status walk_lines(walk *w, const char *text, size_t size, const char *path, int depth,
                            sf_error *err) {
    for (int line = 1; size > 0; line++) {
        const char *end = memchr(text, '\n', size);
        size_t length = end ? (size_t)(end - text) : size;
        slice include, material = {0};
        w->scan.path = path;
        w->scan.line = line;
        bool named = w->of_case && depth == 0 && finds_material(&w->scan, (slice){text, length}, &material);
        SF_TRY(scan_line(&w->scan, text, length, &include, err));
        if (named) {
            SF_TRY(walk_material(w, material, path, line, depth, err));
        } else if (include.text) {
            SF_TRY(walk_include(w, (slice){text, length}, include, path, line, depth, err));
        } else {
            if (w->marked && (memchr(text, SF_CASE_BEGIN, length) || memchr(text, SF_CASE_END, length)))
                return SF_REFUSE(err, "%s:%d: a control character", path, line);
            fwrite(text, 1, length, w->out);
            fputs(end || depth > 0 || !w->marked ? "\n" : "", w->out);
            w->lines++;
        }
        text += length + (end != NULL);
        size -= length + (end != NULL);
    }
    w->scan.path = path;
    return scan_end(&w->scan, err);
}

/* `from`: the file with the @include, at `line`; NULL: none. Refuses includes that are missing or no plain
 * files, nested or many beyond reason, and what the scan refuses. */
static sf_status walk_file(walk *w, const char *path, const char *from, int line, int depth, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE] = "";
    SF_OWNED char *text = NULL;
    size_t size = 0;
    sf_error inner = SF_ERROR_INIT;
    if (from)
        snprintf(where, sizeof where, "%s:%d: ", from, line);
    if (depth > INCLUDE_DEPTH)
        return SF_REFUSE(err, "%s@include is nested more than %d deep", where, INCLUDE_DEPTH);
    if (sf_plain_read(path, "file", LARGEST_TEXT, &text, &size, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s%s", where, inner.text);
    size_t mark = strncmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* byte order mark */
    w->bytes += size;
    if (w->bytes > LARGEST_TEXT)
        SF_REFUSE(err, "%sthe file %s and its includes are larger than %d bytes", where, path, LARGEST_TEXT);
    else if (begin_piece(w, path, 1, err) == SF_OK)
        walk_lines(w, text + mark, size - mark, path, depth, err);
    return err->status;
}

/* ---- overrides ---- */

/* A file that stands in place of a group, each line as a comment. */
static sf_status copy_as_comment(const char *path, FILE *out, sf_error *err) {
    SF_OWNED char *text = sf_case_load_text(path, false, 0, NULL, NULL, err);
    char *rest = text;
    for (char *line = strsep(&rest, "\n"); line && (rest || *line); line = strsep(&rest, "\n"))
        fprintf(out, "#     %s\n", line);
    return err->status;
}

/* A --set text may hold line ends, which would leave the comment. */
static void put_override(const char *text, FILE *out) {
    fputs("# --set ", out);
    for (; *text; text++)
        fputc(*text == '\n' ? ' ' : *text, out);
    fputc('\n', out);
}

static char *load(walk *w, const char *path, int count, const char *const *overrides, sf_error *err) {
    char *text = NULL;
    SF_OWNED char *folder = sf_case_folder_of(path, err);
    size_t size = 0;
    w->folder = folder;
    w->out = folder ? open_memstream(&text, &size) : NULL;
    if (w->out)
        walk_file(w, path, NULL, 0, 0, err);
    for (int i = 0; i < count && err->status == SF_OK && w->out; i++) {
        const char *file = sf_case_override_file(overrides[i]);
        put_override(overrides[i], w->out);
        if (file)
            copy_as_comment(file, w->out, err);
    }
    if (!sf_text_close(w->out, &text))
        no_memory(path, err);
    return sf_keep(text, err);
}

char *sf_case_load_text(const char *path, bool of_case, int count, const char *const *overrides,
                        sf_case_source *source, sf_error *err) {
    return load(&(walk){.source = source, .of_case = of_case}, path, count, overrides, err);
}

char *sf_case_load_marked(const char *path, bool whole, sf_error *err) {
    return load(&(walk){.marked = true, .whole = whole, .of_case = true}, path, 0, NULL, err);
}

/* True if the line has a number that a unit follows without quotation marks, such as "velocity = 4.5 m/s". */
static bool has_bare_unit(const char *text, int line) {
    for (int k = 1; text && k < line; k++)
        text = (text = strchr(text, '\n')) ? text + 1 : NULL;
    size_t length = text ? strcspn(text, "\n#") : 0, equal = text ? strcspn(text, "=:\n#") : 0;
    if (equal >= length)
        return false;
    const char *value = text + equal + 1, *rest = sf_decimal_read(value + strspn(value, " \t"), NULL);
    rest = rest ? rest + strspn(rest, " \t") : "";
    return rest < text + length && (isalpha((unsigned char)*rest) || *rest == '%');
}

/* True if the text opens more brackets and braces than it closes, outside of strings and comments. */
static bool is_cut(const char *text) {
    int depth = 0;
    for (; text && *(text = sf_blanks_pass(text, true)); text++) {
        if (*text == '"')
            while (text[1] && *++text != '"')
                text += *text == '\\' && text[1];
        depth += strchr("{[(", *text) ? 1 : 0;
        depth -= strchr("}])", *text) ? 1 : 0;
    }
    return depth > 0;
}

const char *sf_case_syntax_phrase(const char *libconfig_text, const char *text, int line) {
    if (libconfig_text && strcmp(libconfig_text, "mismatched element type in array") == 0)
        return "the numbers of an array must all have a decimal point, or none: [0.5, 0.0, -1.0]";
    if (has_bare_unit(text, line))
        return "a value with a unit stands in quotation marks, such as \"4.5 m/s\"";
    if (libconfig_text && strcmp(libconfig_text, "syntax error") == 0 && is_cut(text))
        return "the text ends within a group or a list: a bracket or a brace is missing";
    return libconfig_text ? libconfig_text : "syntax error";
}
