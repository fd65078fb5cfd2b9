/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/results/origin.h"

#include "base/text.h"
#include "io/h5_data.h"
#include "io/provenance.h"
#include <string.h>

char *sf_origin_text(const sf_results *results, const char *path) {
    char *text = NULL;
    if (sf_h5_exists(results->file, path) && sf_h5_read_text(results->file, path, &text, SF_IGNORED) == SF_OK)
        return text;
    return strdup("");
}

/* The end of a value: a quoted text, a group or an array, or a word. */
static const char *value_end(const char *p, const char *end) {
    int depth = 0;
    bool quoted = false;
    for (; p < end; p++) {
        if (quoted && *p == '\\' && p + 1 < end) {
            p++;
            continue;
        }
        if (*p == '"')
            quoted = !quoted;
        if (quoted)
            continue;
        depth += (*p != '\0' && strchr("{[(", *p) != NULL) - (*p != '\0' && strchr("}])", *p) != NULL);
        if (depth == 0 && *p == ' ')
            break;
    }
    return p;
}

/* The text from begin to end without blanks at both, cut. */
static void copy(char *to, size_t size, const char *begin, const char *end) {
    while (begin < end && *begin == ' ')
        begin++;
    while (begin < end && end[-1] == ' ')
        end--;
    snprintf(to, size, "%.*s", (int)(end - begin), begin);
}

/* The same of a value: a quoted text without its quotes and escapes. */
static void copy_value(char *to, size_t size, const char *begin, const char *end) {
    bool quoted = end - begin >= 2 && *begin == '"' && end[-1] == '"';
    copy(to, size, begin + quoted, end - quoted);
    char *write = to;
    for (const char *read = to; quoted && *read; read++) {
        read += *read == '\\' && read[1];
        *write++ = *read;
    }
    if (quoted)
        *write = '\0';
}

bool sf_origin_next(const char **text, sf_origin_key *key) {
    const char *line = *text;
    if (!*line)
        return false;
    size_t length = strcspn(line, "\n"), name = strcspn(line, " \n");
    const char *end = line + length, *last = end;
    *text = end + (*end == '\n');
    while (last > line && last[-1] != ' ')
        last--;
    copy(key->name, sizeof key->name, line, line + name);
    const char *value = line + name + strspn(line + name, " ");
    if (value > last) /* not such a line */
        value = last;
    const char *behind = value_end(value, last);
    copy_value(key->value, sizeof key->value, value, behind);
    copy(key->si, sizeof key->si, behind, last);
    key->given = strncmp(last, "given", 5) == 0;
    return true;
}

bool sf_origin_find(const char *parameters, const char *name, sf_origin_key *key) {
    while (sf_origin_next(&parameters, key))
        if (strcmp(key->name, name) == 0)
            return true;
    return false;
}

const char *const sf_origin_report_keys[SF_ORIGIN_REPORT_KEYS] = {"sample", "laboratory", "conditions"};

bool sf_origin_find_report(const char *parameters, const char *name, sf_origin_key *key) {
    SF_PRINTED(full, 64, "report.%s", name);
    return sf_origin_find(parameters, full, key) && key->given;
}

static void put_comment(FILE *out, const char *begin, const char *end) {
    begin += strspn(begin, " ");
    fprintf(out, "%.*s\n", (int)(end - begin), begin);
}

/* True of the comment that stands where a case includes a file, from begin to end. */
static bool is_included(const char *begin, const char *end) {
    const size_t before = strlen(SF_INCLUDED_BEGIN), behind = strlen(SF_INCLUDED_END);
    return (size_t)(end - begin) > before + behind && strncmp(begin, SF_INCLUDED_BEGIN, before) == 0 &&
           strncmp(end - behind, SF_INCLUDED_END, behind) == 0;
}

/* Comments from `line` on to a closing brace, NULL: none; `prefix` stands before each line. */
static char *collect(const char *line, const char *prefix) {
    size_t length, before = strlen(prefix);
    SF_TEXT_STREAM(out, text, size);
    if (!out)
        return NULL;
    for (; line && *line; line += length + (line[length] == '\n')) {
        length = strcspn(line, "\n");
        if (strncmp(line, prefix, before) != 0)
            break;
        const char *p = line + before + strspn(line + before, " \t");
        if (*p == '}')
            break;
        if (*p == '#' && !is_included(line + before, line + length))
            put_comment(out, p + 1, line + length);
    }
    return sf_text_close(out, &text);
}

/* The line after the last one that begins so; NULL if none does. */
static const char *after_last(const char *text, const char *begin) {
    const char *found = NULL;
    for (const char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n')
        if (strncmp(line, begin, strlen(begin)) == 0)
            found = line + strcspn(line, "\n");
    return found ? found + (*found == '\n') : NULL;
}

/* The line after the first one below `text` whose first word is `name`; NULL if there is none. */
static const char *after_name(const char *text, const char *name) {
    size_t length = strlen(name);
    for (const char *line = text; line && *line; line += strcspn(line, "\n"), line += *line == '\n') {
        const char *word = line + strspn(line, " \t");
        if (strncmp(word, name, length) == 0 && strchr(" \t:=\n", word[length]))
            return line + strcspn(line, "\n") + (line[strcspn(line, "\n")] == '\n');
    }
    return NULL;
}

char *sf_origin_material(const char *case_text, const char *layer) {
    SF_PRINTED(replacing, SF_ORIGIN_NAME_SIZE + 32, layer ? "# --set materials.%s=@" : "# --set material%s=@",
               layer ? layer : "");
    const char *replaced = after_last(case_text, replacing);
    if (replaced)
        return collect(replaced, "#     ");
    return collect(layer ? after_name(after_last(case_text, "materials"), layer)
                         : after_last(case_text, "material"),
                   "");
}
