/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/checks.h"

#include "gui/gmsh/window.h"
#include <stdio.h>
#include <string.h>

/* Lines of the table of softfall-pre (pre/model_report.c), in the order of the tree. */
static const char *const lines[] = {
    "nodes",
    "cells",
    "missile",
    "equivalent drop height",
    "impact point",
    "spacing under missile",
    "expected mesh error",
    "first time step, at least",
    "memory of the solver",
    "typical run time",
};
enum { LINES = sizeof lines / sizeof lines[0], COLUMN = 26 };

static void name_entry(int k, char *name, size_t size) {
    snprintf(name, size, "3Checks/%02d%s", k, lines[k]);
}

/* The value in a line that begins with the label and blanks up to the column. */
static const char *find_value(const char *text, const char *label) {
    size_t length = strlen(label);
    for (const char *line = text; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
        if (strncmp(line, label, length) == 0 && strspn(line + length, " ") == COLUMN - length)
            return line + COLUMN;
    return NULL;
}

void sf_checks_show(const char *text) {
    for (int k = 0; k < LINES; k++) {
        const char *value = find_value(text, lines[k]);
        char name[80], shown[160];
        name_entry(k, name, sizeof name);
        if (!value)
            continue;
        snprintf(shown, sizeof shown, "%.*s", (int)strcspn(value, "\n"), value);
        sf_window_put(&(sf_entry){.name = name, .kind = SF_ENTRY_SHOWN, .text = shown, .help = shown});
    }
}

void sf_checks_clear(void) {
    for (int k = 0; k < LINES; k++) {
        char name[80];
        name_entry(k, name, sizeof name);
        sf_window_remove(name);
    }
}

void sf_checks_sentence(const char *text, char *out, size_t size) {
    const char *last = NULL, *line = text;
    *out = '\0';
    while (line && *line) {
        const char *end = strchr(line, '\n');
        if (*line != '\n' && strncmp(line, "softfall-", 9) == 0)
            last = line;
        line = end ? end + 1 : NULL;
    }
    const char *colon = last ? strstr(last, ": ") : NULL;
    if (colon)
        snprintf(out, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
}

void sf_checks_progress(const char *text, char *out, size_t size) {
    const char *last = NULL, *line = text;
    size_t used = 0;
    while (line && *line) {
        const char *end = strchr(line, '\n');
        if (strncmp(line, "t ", 2) == 0)
            last = line;
        line = end ? end + 1 : NULL;
    }
    for (; last && *last && *last != '\n' && used + 1 < size; last++)
        if (*last != ' ' || (used > 0 && out[used - 1] != ' '))
            out[used++] = *last;
    out[used] = '\0';
}
