/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/examples.h"

#include "io/plain_file.h"
#include "io/process.h"
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void sf_examples_free(sf_examples *e) {
    for (int k = 0; k < e->count; k++)
        free(e->name[k]);
    free(e->name);
    free(e->folder);
    *e = (sf_examples){0};
}

static char *case_of(const sf_examples *e, const char *name, sf_error *err) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s/case.cfg", e->folder, name) >= 0)
        return path;
    SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the examples");
    return NULL;
}

static int compare(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static sf_status add(sf_examples *e, const char *name, sf_error *err) {
    char **grown = realloc(e->name, (size_t)(e->count + 1) * sizeof *grown);
    if (grown)
        e->name = grown;
    if (!grown || !(e->name[e->count] = strdup(name)))
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the examples");
    e->count++;
    return SF_OK;
}

/* Lists the examples that have a case. */
static sf_status list(sf_examples *e, sf_error *err) {
    DIR *folder = opendir(e->folder);
    const struct dirent *entry;
    if (!folder)
        return SF_FAIL(err, SF_ERR_IO, "the folder of the examples, %s, cannot be read: %s", e->folder,
                       strerror(errno));
    while (err->status == SF_OK && (entry = readdir(folder)) != NULL) {
        char *path = *entry->d_name == '.' ? NULL : case_of(e, entry->d_name, err);
        if (path && access(path, R_OK) == 0)
            add(e, entry->d_name, err);
        free(path);
    }
    closedir(folder);
    if (e->count > 0)
        qsort(e->name, (size_t)e->count, sizeof *e->name, compare);
    return err->status;
}

sf_status sf_examples_find(sf_examples *e, sf_error *err) {
    char folder[PATH_MAX];
    *e = (sf_examples){0};
    SF_TRY(sf_process_find_shared("examples", folder, sizeof folder, err));
    if (!(e->folder = realpath(folder, NULL)))
        return SF_FAIL(err, SF_ERR_IO, "the folder of the examples, %s: %s", folder, strerror(errno));
    return list(e, err);
}

static sf_status print_line(const sf_examples *e, const char *name, int width, FILE *out, sf_error *err) {
    char *path = case_of(e, name, err), *text = NULL;
    if (path && sf_plain_read(path, "example", SF_PLAIN_TEXT, &text, NULL, err) == SF_OK) {
        const char *line = text + strspn(text, "# ");
        fprintf(out, "%-*s  %.*s\n", width, name, (int)strcspn(line, "\r\n"), *text == '#' ? line : "");
    }
    free(path);
    free(text);
    return err->status;
}

sf_status sf_examples_print(const sf_examples *e, FILE *out, sf_error *err) {
    int width = 0;
    for (int k = 0; k < e->count; k++)
        width = (int)strlen(e->name[k]) > width ? (int)strlen(e->name[k]) : width;
    for (int k = 0; k < e->count; k++)
        SF_TRY(print_line(e, e->name[k], width, out, err));
    return SF_OK;
}

char *sf_examples_case(const sf_examples *e, const char *name, sf_error *err) {
    char names[700] = "";
    for (int k = 0; k < e->count; k++) {
        size_t used = strlen(names);
        if (strcmp(e->name[k], name) == 0)
            return case_of(e, name, err);
        snprintf(names + used, sizeof names - used, "%s%s", k ? ", " : "", e->name[k]);
    }
    SF_FAIL(err, SF_ERR_INPUT, "there is no example \"%.80s\"; the examples are %s", name, names);
    return NULL;
}
