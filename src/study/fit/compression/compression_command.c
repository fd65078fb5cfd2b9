/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/program.h"
#include "study/fit/compression/compression_command.h"

#include "study/fit/compression/form_command.h"
#include "study/fit/compression/hyperfoam_command.h"
#include "study/fit/compression/compression_output.h"
#include "study/fit/command_line.h"
#include "io/plain_file.h"
#include "io/process.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>

enum { KEY_FORCE = 256, KEY_SIMULATE, KEY_FRICTION };

typedef struct options {
    const char *path;
    const char *directory;
    const char *command;
    bool force;
    sf_cube_options cube;
} options;

static error_t parse_option(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'o':
        o->directory = text;
        break;
    case KEY_FORCE:
        o->force = true;
        break;
    case KEY_SIMULATE:
        o->cube.case_path = text;
        break;
    case KEY_FRICTION:
        o->cube.friction = text;
        break;
    case ARGP_KEY_ARG:
        if (o->path)
            argp_error(state, "one file is expected, found \"%s\" as well", text);
        o->path = text;
        break;
    case ARGP_KEY_END:
        if (!o->path || !o->directory)
            argp_error(state, "give the file that names the tests, and the output directory with -o");
        if (o->cube.friction && !o->cube.case_path)
            argp_error(state, "--friction needs --simulate");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static sf_status parse_command(int argc, char **argv, options *o, sf_error *err) {
    static char name[] = "softfall-fit compression";
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0, "write everything there (required)", 0},
        {"force", KEY_FORCE, NULL, 0, "replace the output of an earlier fit in DIR", 0},
        {"simulate", KEY_SIMULATE, "CASE", 0,
         "press a cube of the fitted material between platens too, as CASE says "
         "(examples/compression/case.cfg), and compare it with the material point",
         1},
        {"friction", KEY_FRICTION, "MU", 0, "of the upper platen in --simulate (default: that of CASE)", 1},
        {0},
    };
    const struct argp parser = {
        .options = known,
        .parser = parse_option,
        .args_doc = "FIT.cfg -o DIR",
        .doc = "A material file from compression tests of a foam.\vWrites material.cfg with its curves, "
               "report.html, fit.json, fit.png (and .gp), fit.csv and loading_curve.csv. "
               "docs/identification.md explains FIT.cfg and the report.",
    };
    argv[0] = name;
    if (argp_parse(&parser, argc, argv, 0, NULL, o) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the command line cannot be read");
    return SF_OK;
}

static void print_tests(const sf_compression_config *config) {
    for (int k = 0; k < config->test_count; k++)
        printf("test %s: %s\n", config->test[k].path, config->test[k].interpretation);
    fflush(stdout);
}

static sf_status run_form(const options *o, const sf_compression_config *config, const sf_sink *sink,
                          sf_error *err) {
    if (o->cube.case_path)
        return SF_FAIL(err, SF_ERR_INPUT, "--simulate does not work with curve_form = \"%s\" in %s",
                       config->form.form.curve->name, o->path);
    SF_TRY(sf_form_fit_check(o->directory, o->force, err));
    return sf_form_fit_write(config, o->directory, o->force, stdout, sink, err);
}

static sf_status run(const options *o, sf_error *err) {
    sf_compression_config config = {0};
    sf_compression_fit fit = {0};
    const sf_sink sink = sf_program_sink("softfall-fit");
    bool hyperfoam;
    uint64_t ignored; /* the case can be read: nothing is made before */
    SF_TRY(sf_hyperfoam_fit_asked(o->path, &hyperfoam, err));
    if (hyperfoam && o->cube.case_path)
        return SF_FAIL(err, SF_ERR_INPUT, "--simulate does not work with law = \"hyperfoam\" in %s", o->path);
    if (hyperfoam)
        return sf_hyperfoam_fit_file(o->path, o->directory, o->force, stdout, &sink, err);
    if (sf_compression_output_check(o->directory, o->force, err) != SF_OK ||
        (o->cube.case_path &&
         sf_plain_hash(o->cube.case_path, "case file", SF_PLAIN_TEXT, &ignored, err) != SF_OK) ||
        sf_compression_config_read(o->path, &config, err) != SF_OK)
        return err->status;
    print_tests(&config);
    if (config.form.form.curve)
        run_form(o, &config, &sink, err);
    else if (sf_compression_fit_run(&config, &fit, err) == SF_OK)
        sf_compression_output(&fit, o->path, o->command, o->directory, o->force, &o->cube, &sink, err);
    sf_compression_fit_free(&fit);
    sf_compression_config_free(&config);
    return err->status;
}

int sf_fit_compression_main(int argc, char **argv) {
    char *command = sf_fit_command_line(argc, argv);
    options o = {.cube.log = stdout, .command = command ? command : "softfall-fit compression"};
    sf_error err = SF_ERROR_INIT;
    sf_process_handle_signals();
    if (parse_command(argc, argv, &o, &err) == SF_OK)
        run(&o, &err);
    free(command);
    return sf_error_report(&err, "softfall-fit");
}
