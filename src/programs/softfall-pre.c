/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-pre: CASE -> model.h5. */
#include "build_info.h"
#include "base/program.h"
#include "model/model_io.h"
#include "io/replace.h"
#include "case/case.h"
#include "pre/make.h"
#include "pre/model_report.h"

#include <argp.h>
#include <omp.h>
#include <stdlib.h>

enum { MAX_OVERRIDES = 64, KEY_SET = 1, KEY_KEYS = 2, KEY_SHARE = 3 };

typedef struct options {
    const char *case_path;
    const char *output;
    const char *store;
    bool force;
    bool keys;
    int overrides;
    const char *override[MAX_OVERRIDES];
} options;

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'o':
        o->output = arg;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case KEY_KEYS:
        o->keys = true;
        return 0;
    case KEY_SHARE:
        o->store = arg;
        return 0;
    case KEY_SET:
        if (o->overrides == MAX_OVERRIDES)
            argp_error(state, "at most %d --set options", MAX_OVERRIDES);
        o->override[o->overrides++] = arg;
        return 0;
    case ARGP_KEY_ARG:
        if (o->case_path)
            argp_error(state, "one case at a time: \"%s\" is one too many", arg);
        o->case_path = arg;
        return 0;
    case ARGP_KEY_END:
        if (!o->keys && (!o->case_path || !o->output))
            argp_error(state, "usage: softfall-pre CASE -o model.h5");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static sf_status build(const options *o, const char *command, sf_error *err) {
    sf_case c = {0};
    sf_model model = {0};
    sf_build_report report;
    sf_model_report table;
    char *text = NULL;
    char libraries[SF_LIBRARIES_SIZE];
    const sf_sink sink = sf_program_sink("softfall-pre");
    SF_TRY(sf_replace_check(o->output, err));
    if (!o->force && sf_replace_exists(o->output))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --force replaces it", o->output);
    if (sf_case_read(o->case_path, o->overrides, o->override, &sink, &c, err) != SF_OK)
        goto done;
    c.store = o->store;
    if (sf_replace_check(o->output, err) != SF_OK || /* not one of what the case names */
        sf_model_make(&c, &model, &report, libraries, &sink, err) != SF_OK ||
        sf_replace_check(o->output, err) != SF_OK) /* nor of what a geometry names */
        goto done;
    sf_replace_clean(o->output);
    sf_model_report_make(&model, &report, &table);
    sf_model_report_print(stdout, &table);
    text = sf_model_report_text(&table, err);
    sf_provenance provenance = {.program = "softfall-pre",
                                .command_line = command,
                                .libraries = libraries,
                                .case_text = c.text,
                                .parameters = c.parameters,
                                .mesh_hash = report.mesh_hash,
                                .report = text,
                                .geometry_files = c.geometry_files};
    if (text && sf_model_write(o->output, &model, &provenance, err) == SF_OK)
        printf("%-26s%s\n", "written", o->output);
done:
    free(text);
    sf_model_free(&model);
    sf_case_free(&c);
    return err->status;
}

int main(int argc, char **argv) {
    static const struct argp_option list[] = {
        {"output", 'o', "MODEL", 0, "model file to write (HDF5)", 0},
        {"set", KEY_SET, "GROUP.KEY=VALUE", 0,
         "override a key of the case, e.g. missile.velocity=\"5.2 m/s\", or replace a group by a file, e.g. "
         "material=@other_foam.cfg",
         0},
        {"force", 'f', 0, 0, "replace an existing model file", 0},
        {"share", KEY_SHARE, "DIR", 0,
         "take the mesh and the smoothing domains from this folder if an earlier drop of the same geometry and "
         "kernel left them there, and leave them there",
         0},
        {"keys", KEY_KEYS, 0, 0, "list every key of a case file and end", 0},
        {0},
    };
    argp_program_version = "softfall-pre " SF_VERSION " (" SF_GIT_REVISION ")";
    static const struct argp argp = {.options = list,
                                     .parser = parse,
                                     .args_doc = "CASE",
                                     .doc = "Builds the model of a drop from a case file and its geometry."};
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-pre");
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    if (o.keys) {
        sf_case_print_keys(stdout);
        return sf_error_report(&err, "softfall-pre");
    }
    char *command = sf_command_line(argc, argv);
    if (sf_program_try_threads(omp_get_max_threads(), &err) == SF_OK)
        build(&o, command ? command : "softfall-pre", &err);
    free(command);
    return sf_error_report(&err, "softfall-pre");
}
