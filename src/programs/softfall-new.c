/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-new DIR [--from EXAMPLE]: a case in a folder of its own. */
#include "base/error.h"
#include "base/program.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "study/case_folder.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the examples ---- */

/* The examples that come with softfall: the folders of share/softfall/examples with a case.cfg. */
typedef struct example_list {
    char *folder;
    int count;
    char **name; /* [count] ascending; owned */
} example_list;

static void free_examples(example_list *e) {
    for (int k = 0; k < e->count; k++)
        free(e->name[k]);
    free(e->name);
    free(e->folder);
    *e = (example_list){0};
}

static char *case_of(const example_list *e, const char *name, sf_error *err) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s/case.cfg", e->folder, name) >= 0)
        return path;
    SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the examples");
    return NULL;
}

static int compare(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static sf_status add(example_list *e, const char *name, sf_error *err) {
    char **grown = realloc(e->name, (size_t)(e->count + 1) * sizeof *grown);
    if (grown)
        e->name = grown;
    if (!grown || !(e->name[e->count] = strdup(name)))
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the examples");
    e->count++;
    return SF_OK;
}

/* Lists the examples that have a case. */
static sf_status list(example_list *e, sf_error *err) {
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

/* SF_ERR_IO: the folder is missing. Release with free_examples, also on failure. */
static sf_status find_examples(example_list *e, sf_error *err) {
    char folder[PATH_MAX];
    *e = (example_list){0};
    SF_TRY(sf_process_find_shared("examples", folder, sizeof folder, err));
    if (!(e->folder = realpath(folder, NULL)))
        return SF_FAIL(err, SF_ERR_IO, "the folder of the examples, %s: %s", folder, strerror(errno));
    return list(e, err);
}

static sf_status print_line(const example_list *e, const char *name, int width, FILE *out, sf_error *err) {
    char *path = case_of(e, name, err), *text = NULL;
    if (path && sf_plain_read(path, "example", SF_PLAIN_TEXT, &text, NULL, err) == SF_OK) {
        const char *line = text + strspn(text, "# ");
        fprintf(out, "%-*s  %.*s\n", width, name, (int)strcspn(line, "\r\n"), *text == '#' ? line : "");
    }
    free(path);
    free(text);
    return err->status;
}

/* A line for each: its name and the first line of its case, a comment. */
static sf_status print_examples(const example_list *e, FILE *out, sf_error *err) {
    int width = 0;
    for (int k = 0; k < e->count; k++)
        width = (int)strlen(e->name[k]) > width ? (int)strlen(e->name[k]) : width;
    for (int k = 0; k < e->count; k++)
        SF_TRY(print_line(e, e->name[k], width, out, err));
    return SF_OK;
}

/* The case of the example of this name; from malloc. NULL: SF_ERR_INPUT with the names that exist. */
static char *case_of_example(const example_list *e, const char *name, sf_error *err) {
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

/* ---- the program ---- */

#define USUAL "eva50-v4.5"

typedef struct options {
    const char *folder, *from;
    bool list;
    sf_option_texts overrides;
} options;

static const sf_option known[] = {
    {"from", 'f', "EXAMPLE",
     "the example to begin with (default " USUAL "), or a case file (a name with / or .cfg)",
     .member = offsetof(options, from)},
    {"set", 0, "KEY=VALUE", "change a value, as softfall-pre does; may be repeated",
     .member = offsetof(options, overrides), .read = sf_program_read_texts},
    {"list", 'l', NULL, "list the examples", .member = offsetof(options, list)},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->list == (o->folder != NULL) ? "give the name of the new folder, or --list" : NULL;
}

/* Makes the folder of the case file of that name, or of the example. */
static sf_status make(const options *o, const char *path, const char *origin, sf_error *err) {
    const sf_sink sink = sf_program_sink("softfall-new");
    const sf_case_folder_request request = {.case_path = path,
                                            .override_count = o->overrides.count,
                                            .overrides = o->overrides.text,
                                            .folder = o->folder,
                                            .origin = origin};
    SF_TRY(sf_case_folder_make(&request, &sink, err));
    printf("%s holds the case of %s, with all that it needs. Next:\n\n"
           "    cd %s\n"
           "    softfall-pre case.cfg -o model.h5\n"
           "    softfall-solve model.h5 -o results.h5\n"
           "    softfall-post results.h5 -o out\n",
           o->folder, origin, o->folder);
    return SF_OK;
}

static sf_status run(const options *o, sf_error *err) {
    const char *from = o->from ? o->from : USUAL;
    char origin[200], *path = NULL;
    example_list examples = {0};
    bool file = strchr(from, '/') || (strlen(from) > 4 && strcmp(from + strlen(from) - 4, ".cfg") == 0);
    if (file && !o->list)
        return make(o, from, from, err);
    snprintf(origin, sizeof origin, "the example %.100s", from);
    if (find_examples(&examples, err) == SF_OK && o->list)
        print_examples(&examples, stdout, err);
    else if (err->status == SF_OK && (path = case_of_example(&examples, from, err)))
        make(o, path, origin, err);
    free(path);
    free_examples(&examples);
    return err->status;
}

int main(int argc, char **argv) {
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {
        .program = "softfall-new",
        .operands = "DIR\n--list",
        .meaning =
            "Makes the folder DIR with a case that runs as it stands: case.cfg, its geometry, its material with its "
            "curves, a README. The folder needs no file outside; DIR must not exist yet, or be empty.",
        .second = "one folder at a time: \"%s\" is one too many",
        .operand = offsetof(options, folder),
        .fault = find_fault,
        .is_usage = true,
        .list = {{known, &o}}};
    sf_process_handle_signals();
    if (sf_program_begin(argv, &err) == SF_OK && sf_command_parse(&line, argc, argv, &err) == SF_OK)
        run(&o, &err);
    return sf_error_report(&err, "softfall-new");
}
