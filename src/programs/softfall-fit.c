/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit WORD ...: material parameters from measurements. The first word names the kind of
 * measurement. */
#include "build_info.h"
#include "base/near.h"
#include "base/program.h"
#include "study/fit/compression/compression_command.h"

#include <gsl/gsl_errno.h>

/* ---- softfall-fit compression ---- */

typedef struct options {
    const char *input, *directory;
    bool force;
} options;

static const sf_option known[] = {
    {"output", 'o', "DIR", "write everything there (required)", .member = offsetof(options, directory)},
    {"force", 'f', NULL, "replace the files of an earlier fit in DIR", .member = offsetof(options, force)},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->input && o->directory ? NULL : "give FIT.cfg, and the output directory with -o";
}

static int fit_compression(int argc, char **argv) {
    static char name[] = "softfall-fit compression";
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const sf_sink sink = sf_program_sink("softfall-fit");
    const sf_command command = {
        .program = "softfall-fit",
        .operands = "FIT.cfg -o DIR",
        .meaning = "A material file from compression tests of a foam.\vFits a free curve, its rate dependence and "
                   "its unloading; writes material.cfg with its curves, fit.json, fit.csv and loading_curve.csv. "
                   "`softfall fit compression' fits forms, cycles and hyperfoams too, and makes a page of each. "
                   "docs/identification.md explains FIT.cfg.",
        .second = "one FIT.cfg at a time: \"%s\" is one too many",
        .operand = offsetof(options, input),
        .fault = find_fault,
        .list = {{known, &o}}};
    gsl_set_error_handler_off(); /* statuses are looked at */
    argv[0] = name;
    if (sf_command_parse(&command, argc, argv, &err) == SF_OK &&
        sf_compression_command(o.input, o.directory, o.force, stdout, &sink, &err) == SF_OK)
        sf_log_print(stdout, "Written: %s/material.cfg and its curves, fit.json, fit.csv, loading_curve.csv\n",
                     o.directory);
    return sf_error_report(&err, "softfall-fit");
}

/* ---- its words ---- */

static const struct {
    const char *word;
    int (*run)(int argc, char **argv);
    const char *meaning;
} commands[] = {
    {"compression", fit_compression, "from compression tests of a foam cube to a material file"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *file) {
    fputs("Usage: softfall-fit WORD [OPTION...] FIT.cfg -o DIR\n"
          "Material parameters from measurements (docs/identification.md).\n\n",
          file);
    for (int k = 0; k < COMMANDS; k++)
        fprintf(file, "  %-14s %s\n", commands[k].word, commands[k].meaning);
    fputs("\nsoftfall-fit WORD --help lists the options.\n", file);
}

int main(int argc, char **argv) {
    const char *word = argc > 1 ? argv[1] : "";
    sf_error err = SF_ERROR_INIT;
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-fit");
    static const char version[] = "softfall-fit " SF_VERSION " (" SF_GIT_REVISION ")";
    for (int k = 0; k < COMMANDS; k++)
        if (strcmp(word, commands[k].word) == 0)
            return commands[k].run(argc - 1, argv + 1);
    if (strcmp(word, "drop") == 0) {
        fputs("softfall-fit: measured drops are fitted by another program: softfall fit FIT.cfg -o DIR\n", stderr);
        return 2;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-?") == 0) {
        print_usage(stdout);
        return 0;
    }
    if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0) {
        puts(version);
        return 0;
    }
    char meant[SF_NEAR_HINT];
    sf_near near = sf_near_begin(word);
    for (int k = 0; k < COMMANDS; k++)
        sf_near_offer(&near, commands[k].word, strlen(commands[k].word));
    if (argc > 1)
        fprintf(stderr, "softfall-fit: unknown command '%s'%s\n", word, sf_near_hint(&near, meant));
    print_usage(stderr);
    return 2;
}
