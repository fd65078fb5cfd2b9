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

/* The line at `*text`, and the next one there; false at the end. */
static bool next_key(const char **text, sf_origin_key *key) {
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

static bool find_key(const char *parameters, const char *name, sf_origin_key *key) {
    while (next_key(&parameters, key))
        if (strcmp(key->name, name) == 0)
            return true;
    return false;
}

const char *const sf_origin_report_keys[SF_ORIGIN_REPORT_KEYS] = {"sample", "laboratory", "conditions"};

bool sf_origin_find_report(const char *parameters, const char *name, sf_origin_key *key) {
    SF_PRINTED(full, 64, "report.%s", name);
    return find_key(parameters, full, key) && key->given;
}
