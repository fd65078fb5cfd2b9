/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-new DIR [--from EXAMPLE]: a case in a folder of its own. */
#include "build_info.h"
#include "study/case_folder.h"
#include "base/program.h"
#include "io/process.h"
#include "study/examples.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define USUAL "eva50-v4.5"
enum { MAX_OVERRIDES = 64, KEY_SET = 1 };

typedef struct options {
    const char *folder, *from;
    bool list;
    int overrides;
    const char *override[MAX_OVERRIDES];
} options;

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'f':
        o->from = arg;
        return 0;
    case 'l':
        o->list = true;
        return 0;
    case KEY_SET:
        if (o->overrides == MAX_OVERRIDES)
            argp_error(state, "at most %d --set options", MAX_OVERRIDES);
        o->override[o->overrides++] = arg;
        return 0;
    case ARGP_KEY_ARG:
        if (o->folder)
            argp_error(state, "one folder at a time: \"%s\" is one too many", arg);
        o->folder = arg;
        return 0;
    case ARGP_KEY_END:
        if (o->list == (o->folder != NULL))
            argp_error(state, "give the name of the new folder, or --list");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Makes the folder of the case file of that name, or of the example. */
static sf_status make(const options *o, const char *path, const char *origin, sf_error *err) {
    const sf_sink sink = sf_program_sink("softfall-new");
    const sf_case_folder_request request = {.case_path = path,
                                            .override_count = o->overrides,
                                            .overrides = o->override,
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
    sf_examples examples = {0};
    bool file = strchr(from, '/') || (strlen(from) > 4 && strcmp(from + strlen(from) - 4, ".cfg") == 0);
    if (file && !o->list)
        return make(o, from, from, err);
    snprintf(origin, sizeof origin, "the example %.100s", from);
    if (sf_examples_find(&examples, err) == SF_OK && o->list)
        sf_examples_print(&examples, stdout, err);
    else if (err->status == SF_OK && (path = sf_examples_case(&examples, from, err)))
        make(o, path, origin, err);
    free(path);
    sf_examples_free(&examples);
    return err->status;
}

int main(int argc, char **argv) {
    static const struct argp_option known[] = {
        {"from", 'f', "EXAMPLE", 0,
         "the example to begin with (default " USUAL "), or a case file (a name with / or .cfg)", 0},
        {"set", KEY_SET, "KEY=VALUE", 0, "change a value, as softfall-pre does; may be repeated", 0},
        {"list", 'l', NULL, 0, "list the examples", 0},
        {0},
    };
    static const struct argp parser = {
        .options = known,
        .parser = parse,
        .args_doc = "DIR\n--list",
        .doc =
            "Makes the folder DIR with a case that runs as it stands: case.cfg, its geometry, its material with its "
            "curves, a README. The folder needs no file outside; DIR must not exist yet, or be empty."};
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    argp_program_version = "softfall-new " SF_VERSION " (" SF_GIT_REVISION ")";
    sf_process_handle_signals();
    if (sf_program_begin(argv, &err) == SF_OK) {
        argp_parse(&parser, argc, argv, 0, NULL, &o);
        run(&o, &err);
    }
    return sf_error_report(&err, "softfall-new");
}
