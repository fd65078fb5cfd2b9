/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/settings.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 40 };

/* A name, a number or a word ('w'), a string ('"'), or the character itself; 0: the end. */
typedef struct token {
    char kind;
    int part;
    size_t begin, end;
} token;

typedef struct reader {
    const sf_case_parts *parts;
    sf_settings *out;
    token *token; /* [count], then one of kind 0 */
    int count, capacity, at, depth;
    sf_error *err;
} reader;

/* ---- tokens ---- */

static sf_status add_token(reader *r, char kind, int part, size_t begin, size_t end) {
    if (r->count == r->capacity) {
        int capacity = r->capacity ? 2 * r->capacity : 256;
        token *grown = realloc(r->token, (size_t)capacity * sizeof *grown);
        if (!grown)
            return SF_FAIL(r->err, SF_ERR_MEMORY, "out of memory for the text of a case");
        r->token = grown;
        r->capacity = capacity;
    }
    r->token[r->count++] = (token){kind, part, begin, end};
    return SF_OK;
}

static bool is_word(char c) {
    return isalnum((unsigned char)c) || (c != '\0' && strchr("_.+-*", c));
}

/* Behind the comment at `at`, or `at`. */
static const char *pass_comment(const char *at) {
    if (*at == '#' || strncmp(at, "//", 2) == 0)
        return at + strcspn(at, "\n");
    if (strncmp(at, "/*", 2) == 0) {
        const char *end = strstr(at + 2, "*/");
        return end ? end + 2 : at + strlen(at);
    }
    return at;
}

static const char *pass_string(const char *at) {
    for (at++; *at && *at != '"'; at++)
        at += *at == '\\' && at[1];
    return at + (*at == '"');
}

int sf_settings_include(const char *line, const char *end) {
    int part = -1, length = 0;
    line += strspn(line, " \t");
    if (end - line < 12 || sscanf(line, "@include \"#%d\"%n", &part, &length) != 1 || length > end - line)
        return -1;
    return part;
}

static sf_setting *add_setting(reader *r, const char *path) {
    sf_settings *s = r->out;
    if (s->count == s->capacity) {
        int capacity = s->capacity ? 2 * s->capacity : 64;
        sf_setting *grown = realloc(s->setting, (size_t)capacity * sizeof *grown);
        if (!grown) {
            SF_FAIL(r->err, SF_ERR_MEMORY, "out of memory for the text of a case");
            return NULL;
        }
        s->setting = grown;
        s->capacity = capacity;
    }
    sf_setting *out = &s->setting[s->count++];
    *out = (sf_setting){0};
    snprintf(out->path, sizeof out->path, "%s", path);
    return out;
}

static sf_status add_include(reader *r, int part, int included, size_t begin, size_t end) {
    sf_setting *s = add_setting(r, "");
    if (s)
        *s = (sf_setting){.kind = '@', .part = part, .end_part = included, .begin = begin, .end = end};
    return r->err->status;
}

static sf_status read_part(reader *r, int part);

/* The token at `*at`, or what stands between tokens; at the beginning of a line perhaps an include. */
static sf_status read_item(reader *r, int part, const char **at, bool line_begins) {
    const char *text = r->parts->part[part].text, *from = *at, *end = pass_comment(from);
    int included = line_begins ? sf_settings_include(from, from + strcspn(from, "\n")) : -1;
    if (included > 0 && included < r->parts->count) {
        *at = strchr(strchr(from, '"') + 1, '"') + 1;
        SF_TRY(add_include(r, part, included, (size_t)(from - text), (size_t)(*at - text)));
        return read_part(r, included);
    }
    char kind = '\0';
    if (end == from && (*from == '"' || is_word(*from))) {
        kind = *from == '"' ? '"' : 'w';
        for (end = kind == '"' ? pass_string(from) : from; kind == 'w' && is_word(*end);)
            end++;
    } else if (end == from) {
        kind = isspace((unsigned char)*from) ? '\0' : *from;
        end = from + 1;
    }
    *at = end;
    return kind ? add_token(r, kind, part, (size_t)(from - text), (size_t)(end - text)) : SF_OK;
}

static sf_status read_part(reader *r, int part) {
    if (++r->depth > DEEPEST)
        return SF_FAIL(r->err, SF_ERR_INPUT, "%s: @include is nested too deep", r->parts->part[part].path);
    bool line_begins = true;
    for (const char *at = r->parts->part[part].text; *at && r->err->status == SF_OK;) {
        line_begins = line_begins || *at == '\n';
        if (*at == '\n' || *at == ' ' || *at == '\t') {
            at++;
            continue;
        }
        read_item(r, part, &at, line_begins);
        line_begins = false;
    }
    r->depth--;
    return r->err->status;
}

/* ---- settings ---- */

static sf_status read_settings(reader *r, const char *path);

/* The items of a list or an array up to its end; a group among them gives its settings. */
static sf_status read_items(reader *r, const char *path) {
    while (r->err->status == SF_OK && r->token[r->at].kind && !strchr(")]", r->token[r->at].kind)) {
        char kind = r->token[r->at++].kind;
        if (!strchr("{([", kind))
            continue;
        if (++r->depth > DEEPEST)
            return SF_FAIL(r->err, SF_ERR_INPUT, "brackets are nested too deep");
        if (kind == '{')
            read_settings(r, path);
        else
            read_items(r, path);
        r->depth--;
        r->at += r->token[r->at].kind != '\0';
    }
    return r->err->status;
}

/* The value that begins at the present token. */
static sf_status read_value(reader *r, const char *path) {
    const token first = r->token[r->at];
    int index = r->out->count;
    if (!add_setting(r, path))
        return r->err->status;
    if (first.kind != '\0' && strchr("{([", first.kind)) {
        if (++r->depth > DEEPEST)
            return SF_FAIL(r->err, SF_ERR_INPUT, "brackets are nested too deep");
        r->at++;
        SF_TRY(first.kind == '{' ? read_settings(r, path) : read_items(r, path));
        r->depth--;
    } else {
        while (first.kind == '"' && r->token[r->at + 1].kind == '"') /* libconfig joins them */
            r->at++;
    }
    const token last = r->token[r->at];
    sf_setting *s = &r->out->setting[index];
    s->kind = first.kind;
    s->part = first.part;
    s->begin = first.begin;
    s->end_part = last.part;
    s->end = last.end;
    r->at += last.kind != '\0';
    return SF_OK;
}

/* Reads the settings of a group up to its end. */
static sf_status read_settings(reader *r, const char *path) {
    while (r->err->status == SF_OK && r->token[r->at].kind && r->token[r->at].kind != '}') {
        const token name = r->token[r->at++];
        char inner[SF_SETTING_PATH_SIZE];
        if (name.kind != 'w' || !r->token[r->at].kind || !strchr("=:", r->token[r->at].kind))
            continue;
        r->at++;
        snprintf(inner, sizeof inner, "%s%s%.*s", path, *path ? "." : "", (int)(name.end - name.begin),
                 r->parts->part[name.part].text + name.begin);
        read_value(r, inner);
    }
    return r->err->status;
}

sf_status sf_settings_find(const sf_case_parts *parts, sf_settings *settings, sf_error *err) {
    reader r = {.parts = parts, .out = settings, .err = err};
    *settings = (sf_settings){0};
    if (read_part(&r, 0) == SF_OK && add_token(&r, '\0', 0, 0, 0) == SF_OK)
        read_settings(&r, "");
    free(r.token);
    return err->status;
}

void sf_settings_free(sf_settings *settings) {
    free(settings->setting);
    *settings = (sf_settings){0};
}

const sf_setting *sf_settings_get(const sf_settings *settings, const char *path) {
    for (int k = 0; k < settings->count; k++)
        if (strcmp(settings->setting[k].path, path) == 0)
            return &settings->setting[k];
    return NULL;
}

/* ---- texts ---- */

/* The character of the escape behind the backslash at `at`, which moves to its last character. */
static char read_escape(const char **at) {
    static const char from[] = "nrtf", to[] = "\n\r\t\f";
    char next = *++*at;
    const char *known = strchr(from, next);
    if (next == 'x') {
        char digits[3] = {(*at)[1], (*at)[1] ? (*at)[2] : '\0', '\0'};
        *at += strlen(digits);
        return (char)strtol(digits, NULL, 16);
    }
    return known && next ? to[known - from] : next;
}

char *sf_setting_text(const sf_case_parts *parts, const sf_setting *s, sf_error *err) {
    const char *at = parts->part[s->part].text + s->begin, *end = parts->part[s->part].text + s->end;
    char *text = sf_alloc(err, s->end > s->begin ? s->end - s->begin + 1 : 1, 1, "a text of a case");
    size_t length = 0;
    bool open = false;
    for (; text && s->end_part == s->part && at < end; at++) {
        if (!open && pass_comment(at) != at)
            at = pass_comment(at) - 1;
        else if (*at == '"')
            open = !open;
        else if (open)
            text[length++] = *at == '\\' ? read_escape(&at) : *at;
    }
    return text;
}
