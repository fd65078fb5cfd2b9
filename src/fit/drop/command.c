/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/program.h"
#include "fit/drop/command.h"

#include "fit/command_line.h"
#include "fit/drop/report.h"
#include "io/folder.h"
#include "io/process.h"
#include <argp.h>
#include <gsl/gsl_errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct options {
    const char *input, *directory, *command;
    bool force;
    int threads, jobs;
} options;

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    sf_error err = SF_ERROR_INIT;
    switch (key) {
    case 'o':
        o->directory = arg;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case 't':
        if (sf_program_read_threads(arg, &o->threads, &err) != SF_OK)
            argp_error(state, "%s", err.text);
        return 0;
    case 'j':
        if (sf_program_read_threads(arg, &o->jobs, &err) != SF_OK)
            argp_error(state, "--jobs takes a number from 1 on, as --threads does, not \"%s\"", arg);
        return 0;
    case ARGP_KEY_ARG:
        if (o->input)
            argp_error(state, "one input at a time: \"%s\" is one too many", arg);
        o->input = arg;
        return 0;
    case ARGP_KEY_END:
        if (!o->input || !o->directory)
            argp_error(state, "give the input, and the output directory with -o");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* "<material>.cfg" and so on, for sf_staging. */
typedef struct names {
    char card[SF_FIT_NAME_SIZE + 8], curve[SF_FIT_NAME_SIZE + 8];
    const char *list[9];
} names;

static void name_files(const sf_fit_input *in, names *n) {
    snprintf(n->card, sizeof n->card, "%s.cfg", in->material_name);
    snprintf(n->curve, sizeof n->curve, "%s.csv", in->material_name);
    const char *const list[] = {n->curve,        n->card,       "fit-curve.csv",
                                "fit-drops.csv", "fit.gp",      "fit.png",
                                "fit.json",      "report.html", NULL};
    memcpy(n->list, list, sizeof list);
}

/* The drops' folders are kept between runs of the command: DIR/runs. So is, until the fit has ended, what was
 * computed between the drops: DIR/runs/columns.bin. */
static sf_status make_runs(const char *directory, char *runs, sf_error *err) {
    snprintf(runs, PATH_MAX, "%s/runs", directory);
    return sf_folder_own(runs, err);
}

static void print_curves(const sf_fit_input *in) {
    for (int k = 0; k < in->drop_count; k++)
        if (in->drop[k].curve_path)
            printf("reference %s: %s\n", in->drop[k].curve_path, in->drop[k].understood);
    fflush(stdout);
}

static sf_status run(const options *o, sf_fit_input *in, sf_drop_fit *fit, sf_fit_memory *memory,
                     sf_staging *output, sf_error *err) {
    char runs[PATH_MAX], warning[512] = "";
    names n;
    char columns[PATH_MAX + 16];
    const char *const none[] = {NULL}; /* the names are in the input */
    if (sf_staging_check(o->directory, none, o->force, err) != SF_OK ||
        sf_fit_input_read(o->input, in, err) != SF_OK)
        return err->status;
    name_files(in, &n);
    if (sf_staging_begin(o->directory, n.list, o->force, output, err) != SF_OK ||
        make_runs(o->directory, runs, err) != SF_OK)
        return err->status;
    sf_runner runner = {.folder = runs, .threads = o->threads, .jobs = o->jobs, .log = stdout};
    snprintf(columns, sizeof columns, "%s/columns.bin", runs);
    sf_fit_memory_open(columns, memory);
    *fit = (sf_drop_fit){.input = in, .runner = &runner, .folder = runs, .log = stdout, .memory = memory};
    printf("softfall-fit drop: %d unknown parameters, %d drops; finished drops are kept in %s\n",
           in->unknown_count, in->drop_count, runs);
    print_curves(in);
    if (sf_drop_fit_run(fit, err) != SF_OK ||
        sf_drop_report_write(fit, o->input, o->command, output, warning, sizeof warning, err) != SF_OK ||
        sf_staging_commit(output, err) != SF_OK)
        return err->status;
    if (memory->file >= 0)
        sf_folder_remove_file(columns);
    sf_drop_report_print(fit, stdout);
    printf("%lld drops simulated, %lld found; written: %s/%s.cfg, report.html, fit.json, fit.png\n",
           (long long)runner.simulated, (long long)runner.reused, o->directory, in->material_name);
    fflush(stdout);
    const sf_sink sink = sf_program_sink("softfall-fit");
    if (*warning)
        sf_sink_tell(&sink, SF_WARNING, "%s", warning);
    if (!fit->result.converged)
        sf_sink_tell(&sink, SF_WARNING, "not converged after %d iterations", fit->result.iterations);
    return SF_OK;
}

int sf_fit_drop_main(int argc, char **argv) {
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0,
         "write everything there (required); drops that are there already are used again", 0},
        {"force", 'f', 0, 0, "replace the results of an earlier fit in DIR", 0},
        {"threads", 't', "N", 0, "threads of the simulations together (default: every core)", 0},
        {"jobs", 'j', "N", 0, "drops that run side by side (default: as many as threads)", 0},
        {0},
    };
    static const struct argp parser = {.options = known,
                                       .parser = parse,
                                       .args_doc = "FIT.cfg -o DIR",
                                       .doc = "Identifies a foam from measured drops, and predicts others."};
    char *command = sf_fit_command_line(argc, argv);
    options o = {.threads = (int)sysconf(_SC_NPROCESSORS_ONLN),
                 .command = command ? command : "softfall-fit drop"};
    sf_error err = SF_ERROR_INIT;
    sf_fit_input input = {0};
    sf_drop_fit fit = {0};
    sf_fit_memory memory = {.file = -1};
    sf_staging output = {0};
    static char name[] = "softfall-fit drop";
    argv[0] = name;
    gsl_set_error_handler_off(); /* statuses are looked at */
    sf_process_handle_signals();
    argp_parse(&parser, argc, argv, 0, NULL, &o);
    run(&o, &input, &fit, &memory, &output, &err);
    sf_staging_end(&output);
    sf_fit_memory_close(&memory);
    sf_drop_fit_free(&fit);
    sf_fit_input_free(&input);
    free(command);
    return sf_error_report(&err, "softfall-fit");
}
