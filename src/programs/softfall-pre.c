/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-pre: CASE -> model.h5. */
#include "base/program.h"
#include "model/model_io.h"
#include "io/replace.h"
#include "case/case.h"
#include "pre/make.h"
#include "pre/model_report.h"

#include <omp.h>
#include <stddef.h>
#include <stdlib.h>

typedef struct options {
    const char *case_path, *output, *store;
    bool force, keys;
    sf_option_texts overrides;
} options;

static const sf_option list[] = {
    {"output", 'o', "MODEL", "model file to write (HDF5)", .member = offsetof(options, output)},
    {"set", 0, "GROUP.KEY=VALUE",
     "override a key of the case, e.g. missile.velocity=\"5.2 m/s\", or replace a group by a file, e.g. "
     "material=@other_foam.cfg",
     .member = offsetof(options, overrides), .read = sf_program_read_texts},
    {"force", 'f', NULL, "replace an existing model file", .member = offsetof(options, force)},
    {"share", 0, "DIR",
     "take the mesh and the smoothing domains from this folder if an earlier drop of the same geometry and "
     "kernel left them there, and leave them there",
     .member = offsetof(options, store)},
    {"keys", 0, NULL, "list every key of a case file and end", .member = offsetof(options, keys)},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->keys || (o->case_path && o->output) ? NULL : "usage: softfall-pre CASE -o model.h5";
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
        return SF_REFUSE(err, "%s exists; --force replaces it", o->output);
    if (sf_case_read(o->case_path, o->overrides.count, o->overrides.text, &sink, &c, err) != SF_OK)
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
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {.program = "softfall-pre",
                             .operands = "CASE",
                             .meaning = "Builds the model of a drop from a case file and its geometry.",
                             .second = "one case at a time: \"%s\" is one too many",
                             .operand = offsetof(options, case_path),
                             .fault = find_fault,
                             .is_usage = true,
                             .list = {{list, &o}}};
    if (sf_program_begin(argv, &err) != SF_OK || sf_command_parse(&line, argc, argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-pre");
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
