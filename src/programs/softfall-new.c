/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-new DIR [--from EXAMPLE]: a case in a folder of its own. */
#include "base/near.h"
#include "base/program.h"
#include "base/text.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "study/case_folder.h"

#include <dirent.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>

/* ---- the examples ---- */

/* The examples that come with softfall: the folders of share/softfall/examples with a case.cfg. */
typedef struct example_list {
    char *folder;
    int count;
    struct dirent **entry; /* [count] ascending */
} example_list;

static void free_examples(example_list *e) {
    sf_free_all((size_t)e->count, e->entry);
    SF_FREE(e->entry, e->folder);
}

static void write_path(const example_list *e, int k, char path[PATH_MAX]) {
    snprintf(path, PATH_MAX, "%s/%s/case.cfg", e->folder, e->entry[k]->d_name);
}

/* SF_ERR_IO: the folder is missing. Release with free_examples, also on failure. */
static sf_status find_examples(example_list *e, sf_error *err) {
    char folder[PATH_MAX], path[PATH_MAX];
    SF_TRY(sf_process_find_shared("examples", folder, sizeof folder, err));
    e->folder = realpath(folder, NULL);
    int found = e->folder ? scandir(e->folder, &e->entry, NULL, alphasort) : -1;
    if (found < 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder of the examples, %s: %s", folder, strerror(errno));
    for (int k = 0; k < found; k++) {
        e->entry[e->count] = e->entry[k];
        write_path(e, e->count, path);
        if (*e->entry[k]->d_name != '.' && access(path, R_OK) == 0)
            e->count++;
        else
            free(e->entry[k]);
    }
    return SF_OK;
}

/* A line for each: its name and the first line of its case, a comment. */
static sf_status print_examples(const example_list *e, sf_error *err) {
    int width = 0;
    for (int k = 0; k < e->count; k++)
        width = (int)strlen(e->entry[k]->d_name) > width ? (int)strlen(e->entry[k]->d_name) : width;
    for (int k = 0; k < e->count; k++) {
        char path[PATH_MAX];
        SF_OWNED char *text = NULL;
        write_path(e, k, path);
        SF_TRY(sf_plain_read(path, "example", SF_PLAIN_TEXT, &text, NULL, err));
        const char *line = text + strspn(text, "# ");
        printf("%-*s  %.*s\n", width, e->entry[k]->d_name, (int)strcspn(line, "\r\n"),
               *text == '#' ? line : "");
    }
    return SF_OK;
}

/* Finds the case of the example of this name. */
static sf_status find_case(const example_list *e, const char *name, char path[PATH_MAX], sf_error *err) {
    char names[700] = "", meant[SF_NEAR_HINT];
    sf_near near = sf_near_begin(name);
    for (int k = 0; k < e->count; k++) {
        write_path(e, k, path);
        if (strcmp(e->entry[k]->d_name, name) == 0)
            return SF_OK;
        sf_text_add(names, sizeof names, "%s%s", k ? ", " : "", e->entry[k]->d_name);
        sf_near_offer(&near, e->entry[k]->d_name, strlen(e->entry[k]->d_name));
    }
    return SF_REFUSE(err, "unknown example \"%.80s\"%s; the examples are %s", name,
                     sf_near_hint(&near, meant), names);
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
     .member = offsetof(options, overrides), .read = sf_program_read_texts, .repeats = true},
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
    char command[PATH_MAX];
    bool whole = sf_process_find("softfall", command, sizeof command, SF_IGNORED) == SF_OK;
    printf("%s holds the case of %s, with all that it needs.", o->folder, origin);
    if (whole)
        printf("\nNext: softfall run %s, or step by step:\n\n", o->folder);
    else
        printf(" Next:\n\n");
    printf("    cd %s\n"
           "    softfall-pre case.cfg -o model.h5\n"
           "    softfall-solve model.h5 -o results.h5\n"
           "    softfall-post results.h5 -o out\n",
           o->folder);
    return SF_OK;
}

static sf_status run(const options *o, sf_error *err) {
    const char *from = o->from ? o->from : USUAL;
    char origin[200], path[PATH_MAX];
    SF_OWNED_BY(free_examples) example_list examples = {0};
    bool file = strchr(from, '/') || (strlen(from) > 4 && strcmp(from + strlen(from) - 4, ".cfg") == 0);
    if (file && !o->list)
        return make(o, from, from, err);
    snprintf(origin, sizeof origin, "the example %.100s", from);
    if (find_examples(&examples, err) == SF_OK && o->list)
        print_examples(&examples, err);
    else if (err->status == SF_OK && find_case(&examples, from, path, err) == SF_OK)
        make(o, path, origin, err);
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
