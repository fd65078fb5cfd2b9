/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "programs/softfall-solve-options.h"

#include "build_info.h"
#include "base/program.h"
#include "base/units.h"
#include <argp.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { END_TIME = 256, RESTART, CHECKPOINT_EVERY, CHECKPOINT_TIME, NO_CHECKPOINT, ON_FAILURE };

/* A positive time with its unit. */
static double parse_time(const char *option, const char *text, struct argp_state *state) {
    sf_error err = SF_ERROR_INIT;
    sf_units *units = NULL;
    double value = 0;
    if (sf_units_open(&units, &err) == SF_OK && sf_units_parse(units, text, SF_TIME, &value, &err) == SF_OK &&
        !(value > 0))
        SF_FAIL(&err, SF_ERR_INPUT, "\"%s\" is not above 0 s", text);
    sf_units_close(&units);
    if (err.status != SF_OK)
        argp_error(state, "%s: %s", option, err.text);
    return value;
}

static int parse_threads(const char *text, struct argp_state *state) {
    sf_error err = SF_ERROR_INIT;
    int threads = 1;
    if (sf_program_read_threads(text, &threads, &err) != SF_OK)
        argp_error(state, "%s", err.text);
    return threads;
}

static void check_options(sf_solve_options *o, struct argp_state *state) {
    if (o->restart && o->output)
        argp_error(state, "--restart RESULTS writes to RESULTS: -o is not allowed with it");
    if (!o->restart && (!o->model || !o->output))
        argp_error(state, "usage: softfall-solve model.h5 -o results.h5");
    if (o->restart)
        o->output = o->restart;
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    sf_solve_options *o = state->input;
    switch (key) {
    case 'o':
        o->output = arg;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case 't':
        o->threads = parse_threads(arg, state);
        return 0;
    case RESTART:
        o->restart = arg;
        return 0;
    case END_TIME:
        o->end_time = parse_time("--end-time", arg, state);
        return 0;
    case CHECKPOINT_EVERY:
        o->checkpoint_wall = parse_time("--checkpoint-every", arg, state);
        return 0;
    case CHECKPOINT_TIME:
        o->checkpoint_time = parse_time("--checkpoint-time", arg, state);
        return 0;
    case NO_CHECKPOINT:
        o->no_checkpoint = true;
        return 0;
    case ON_FAILURE:
        o->remove_failed = strcmp(arg, "remove") == 0;
        if (!o->remove_failed && strcmp(arg, "keep") != 0)
            argp_error(state, "--on-failure takes keep or remove, not \"%s\"", arg);
        return 0;
    case ARGP_KEY_ARG:
        if (o->model)
            argp_error(state, "one model file at a time: \"%s\" is one too many", arg);
        o->model = arg;
        return 0;
    case ARGP_KEY_END:
        check_options(o, state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void sf_solve_options_parse(int argc, char **argv, sf_solve_options *o) {
    static const struct argp_option list[] = {
        {"output", 'o', "RESULTS", 0, "results file to write (HDF5)", 0},
        {"threads", 't', "N", 0, "OpenMP threads (default: all processors, or OMP_NUM_THREADS)", 0},
        {"force", 'f', 0, 0, "replace an existing results file", 0},
        {"restart", RESTART, "RESULTS", 0,
         "resume RESULTS from RESULTS.restart, bit for bit as if uninterrupted; MODEL only if it has been moved",
         0},
        {"end-time", END_TIME, "TIME", 0, "another end of the simulated time, such as \"40 ms\"", 0},
        {"checkpoint-every", CHECKPOINT_EVERY, "TIME", 0, "wall time between checkpoints (default: 60 s)", 0},
        {"checkpoint-time", CHECKPOINT_TIME, "TIME", 0, "simulated time between checkpoints (default: none)",
         0},
        {"no-checkpoint", NO_CHECKPOINT, 0, 0, "write no checkpoints, not even at the end", 0},
        {"on-failure", ON_FAILURE, "keep|remove", 0,
         "after a numerical failure, keep results and a checkpoint of the last step that held (default), or "
         "remove all",
         0},
        {0},
    };
    argp_program_version = "softfall-solve " SF_VERSION " (" SF_GIT_REVISION ")";
    static const struct argp argp = {
        .options = list,
        .parser = parse,
        .args_doc = "MODEL",
        .doc = "Solves the drop in MODEL (from softfall-pre). Ctrl-C (SIGINT, SIGTERM) ends the run after "
               "the present step with readable results and a checkpoint, from which --restart resumes.\vExit "
               "code: 0 done, 2 wrong input, 3 a file failed, 4 wrong model, 5 numerical failure, 6 out of "
               "memory, 7 a library failed, 130 interrupted (SIGINT, SIGTERM)."};
    *o = (sf_solve_options){
        .threads = omp_get_max_threads(), .checkpoint_wall = 60, .checkpoint_time = INFINITY};
    argp_parse(&argp, argc, argv, 0, NULL, o);
}
