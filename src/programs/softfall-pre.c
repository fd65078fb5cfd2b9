/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-pre: CASE -> model.h5. */
#include "accuracy/section_drop.h"
#include "base/program.h"
#include "base/text.h"
#include "case/read.h"
#include "case/values.h"
#include "io/folder.h"
#include "io/h5_data.h"
#include "io/replace.h"
#include "model/model_check.h"
#include "model/model_io.h"
#include "pre/make.h"
#include "pre/model_report.h"

#include <omp.h>

typedef struct options {
    const char *case_path, *output, *store;
    bool force, keys, axisymmetric, estimate;
    sf_option_texts overrides;
} options;

static const sf_option list[] = {
    {"output", 'o', "MODEL", "model file to write (HDF5)", .member = offsetof(options, output)},
    {"set", 0, "GROUP.KEY=VALUE",
     "override a key of the case, e.g. missile.velocity=\"5.2 m/s\", or replace a group by a file, e.g. "
     "material=@other_foam.cfg",
     .member = offsetof(options, overrides), .read = sf_program_read_texts, .repeats = true},
    {"axisymmetric", 0, NULL,
     "model the plane section of a plate that a body of revolution hits straight: --set "
     "geometry.model=\"axisymmetric\"",
     .member = offsetof(options, axisymmetric)},
    {"estimate", 0, NULL,
     "leave out the drops of the section by which the errors of an axisymmetric drop's figures are found: a formula "
     "estimates them, as of other drops",
     .member = offsetof(options, estimate)},
    {"force", 'f', NULL, "replace an existing model file", .member = offsetof(options, force)},
    {"share", 0, "DIR",
     "take the mesh, the smoothing domains and what drops of the section told from this folder if an earlier "
     "drop of the same geometry and kernel left them there, and leave them there; SOFTFALL_SHARE=DIR names one for all programs and the library",
     .member = offsetof(options, store)},
    {"keys", 0, NULL, "list every key of a case file and end", .member = offsetof(options, keys)},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->keys || (o->case_path && o->output) ? NULL : "usage: softfall-pre CASE -o model.h5";
}

static sf_status check_output(const options *o, const char *path, sf_error *err) {
    SF_TRY(sf_replace_check(path, err));
    if (!o->force && sf_replace_exists(path))
        return SF_REFUSE(err, "%s exists; --force replaces it", path);
    return sf_h5_check_replaced(path, "softfall-model", err);
}

/* Facts go to the report of the model. */
static void tell(void *user, sf_severity severity, const char *sentence) {
    const sf_sink *sink = user;
    if (severity == SF_FACT)
        printf("%-26s%s\n", "curve", sentence);
    else
        sink->tell(sink->user, severity, sentence);
}

static sf_status read_drop(const options *o, int drop, const sf_sink *sink, sf_case *c, sf_error *err) {
    const sf_case_input input = {o->case_path, drop, o->overrides.count, o->overrides.text};
    return sf_case_read_values(&input, sink, NULL, c, err);
}

/* Checks the drops of a series that have models of their own, before the first model is made. */
static sf_status check_drops(const options *o, const sf_case *first, sf_error *err) {
    for (int k = 1; k < first->drops && err->status == SF_OK; k++) {
        char path[SF_PATH_SIZE];
        SF_OWNED_BY(sf_case_free) sf_case c = {0};
        sf_model_series_file(o->output, k + 1, path, sizeof path);
        if (first->drop[k].own && check_output(o, path, err) == SF_OK)
            read_drop(o, k + 1, NULL, &c, err);
    }
    return err->status;
}

/* Prints what the drops of the sections showed; `formula`: the error that was expected before. */
static void print_section(const sf_model *model, double formula) {
    if (model->expected_mesh_error != formula)
        printf("%-26sabout %.2g %% of a_max, by an axisymmetric drop on as thick a plate of this foam\n",
               "mesh error by section", 100 * model->expected_mesh_error);
    if (model->section.a_max_g > 0)
        printf("%-26s%.2f g, HIC %.1f, %.2f mm for ever finer meshes of the section\n", "axisymmetric",
               model->section.a_max_g, model->section.hic, 1e3 * model->section.indentation);
}

/* Makes the model of a drop, from 1, and returns its hash, 0 on failure. That of the first of a series makes
 * those of later drops before, and holds their hashes. */
static int64_t build(const options *o, const char *command, int drop, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    SF_OWNED_BY(sf_model_free) sf_model model = {0};
    SF_OWNED_BY(sf_sections_free) sf_sections sections = {0};
    sf_build_report report;
    sf_model_report table;
    char libraries[SF_LIBRARIES_SIZE], output[SF_PATH_SIZE], hash[SF_MODEL_HASH_SIZE] = "0";
    sf_sink program = sf_program_sink("softfall-pre");
    const sf_sink sink = {tell, &program};
    int64_t own[SF_SERIES_MOST] = {0};
    sf_model_series_file(o->output, drop, output, sizeof output);
    if (check_output(o, output, err) != SF_OK ||
        read_drop(o, drop, drop == 1 ? &sink : NULL, &c, err) != SF_OK ||
        (drop == 1 && check_drops(o, &c, err) != SF_OK))
        return 0;
    for (int k = 1; drop == 1 && k < c.drops && err->status == SF_OK; k++)
        own[k] = c.drop[k].own ? build(o, command, k + 1, err) : 0;
    c.store = sf_store_folder(o->store);
    c.drops = drop == 1 ? c.drops : 1;
    if (err->status != SF_OK || sf_replace_check(output, err) != SF_OK || /* not one of what the case names */
        sf_model_make(&c, &model, &report, libraries, drop == 1 && !o->estimate ? &sections : NULL, &sink,
                      err) != SF_OK ||
        sf_replace_check(output, err) != SF_OK) /* nor of what a geometry names */
        return 0;
    for (int64_t k = 0; k < model.series_count; k++)
        model.series_model[k] = own[k];
    sf_replace_clean(output);
    sf_model_report_make(&model, &report, &table);
    sf_model_report_print(stdout, &table);
    double formula = model.expected_mesh_error;
    sf_section_drop_refer(&(sf_case_input){o->case_path, 1, o->overrides.count, o->overrides.text}, &report,
                          &sections, &model, &sink);
    print_section(&model, formula);
    SF_OWNED char *text = sf_model_report_text(&table, err);
    sf_provenance provenance = {.program = "softfall-pre",
                                .command_line = command,
                                .libraries = libraries,
                                .case_text = c.text,
                                .parameters = c.parameters,
                                .mesh_hash = report.mesh_hash,
                                .report = text,
                                .geometry_files = c.geometry_files};
    if (text && sf_model_write(output, &model, &provenance, err) == SF_OK) {
        printf("%-26s%s\n", "written", output);
        sf_model_hash(&model, hash);
    }
    return (int64_t)strtoull(hash, NULL, 16);
}

/* --axisymmetric is a value of the case; another one on the command line contradicts it. */
static sf_status choose_model(sf_option_texts *overrides, sf_error *err) {
    static const char plain[] = "geometry.model=axisymmetric", quoted[] = "geometry.model=\"axisymmetric\"";
    for (int k = 0; k < overrides->count; k++)
        if (sf_text_contradicts(overrides->text[k], plain) && sf_text_contradicts(overrides->text[k], quoted))
            return SF_REFUSE(err, "--axisymmetric contradicts --set %s: give one of them",
                             overrides->text[k]);
        else if (strncmp(overrides->text[k], plain, strcspn(plain, "=") + 1) == 0)
            return SF_OK;
    return sf_program_read_texts("--axisymmetric:", quoted, overrides, err);
}

int main(int argc, char **argv) {
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {
        .program = "softfall-pre",
        .operands = "CASE",
        .meaning = "Builds the model of a drop from a case file and its geometry.",
        .second = "unexpected \"%s\": one case at a time, and values with blanks in quotation marks",
        .operand = offsetof(options, case_path),
        .fault = find_fault,
        .is_usage = true,
        .list = {{list, &o}}};
    if (sf_program_begin(argv, &err) == SF_OK && sf_command_parse(&line, argc, argv, &err) == SF_OK && o.keys)
        sf_case_print_keys(stdout);
    else if (err.status == SF_OK && sf_program_try_threads(omp_get_max_threads(), &err) == SF_OK) {
        SF_OWNED char *command = sf_command_line(argc, argv);
        if (!o.axisymmetric || choose_model(&o.overrides, &err) == SF_OK)
            build(&o, command ? command : "softfall-pre", 1, &err);
    }
    return sf_error_report(&err, "softfall-pre");
}
