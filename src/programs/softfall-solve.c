/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <limits.h>
#include <malloc.h>
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/error.h"
#include "base/program.h"
#include "base/units.h"
#include "build_info.h"
#include "io/provenance.h"
#include "io/replace.h"
#include "model/good_run.h"
#include "model/model_io.h"
#include "solver/run/run.h"
#include "solver/run/series.h"

/* The command line of softfall-solve. */

typedef struct sf_solve_options {
    const char *model;
    const char *output;
    const char *restart;
    double end_time;                         /* s, 0: as the model says, or the run so far */
    double checkpoint_wall, checkpoint_time; /* s */
    sf_earlier earlier;                      /* the pad from which the run begins */
    bool no_checkpoint;
    bool remove_failed;
    int threads;
    bool force;
} sf_solve_options;

/* Reads the command line; a wrong command line ends the program with a message. Texts are borrowed from
 * `argv`. */
void sf_solve_options_parse(int argc, char **argv, sf_solve_options *options);

/* Texts of softfall-solve before and after a run. */

/* The size of the model, on stdout. */
void sf_solve_print_model(const sf_model *model, int threads);

/* The ending, the energies and the errors of a run on stdout; warnings on stderr. */
void sf_solve_print_ledger(const sf_model *model, const sf_state *state, const sf_run *run);

/* softfall-solve's run, from the model's file to the results. */

/* Solves the model of the options, all drops of its series, or resumes them; `command` is for the provenance.
 * Non-zero `*stop` ends the run after the present step. Progress and report go to stdout. */
sf_status sf_solve(const sf_solve_options *options, const char *command, const volatile sig_atomic_t *stop,
                   sf_error *err);

enum {
    END_TIME = 256,
    RESTART,
    START_FROM,
    PAUSE,
    CHECKPOINT_EVERY,
    CHECKPOINT_TIME,
    NO_CHECKPOINT,
    ON_FAILURE
};

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
    if (!o->earlier.results != !(o->earlier.pause > 0) || (o->restart && o->earlier.results))
        argp_error(state,
                   "a run on the pad of an earlier one needs --start-from RESULTS and --pause TIME, and no "
                   "--restart: what is resumed knows its pad");
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
    case START_FROM:
        o->earlier.results = arg;
        return 0;
    case PAUSE:
        o->earlier.pause = parse_time("--pause", arg, state);
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
        {"start-from", START_FROM, "RESULTS", 0,
         "begin with the pad as this earlier run left it, from RESULTS.restart: its foam remembers the drop",
         0},
        {"pause", PAUSE, "TIME", 0, "rest of the pad between that run and this one, such as \"90 s\"", 0},
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
        .doc =
            "Solves the drop in MODEL (from softfall-pre), or the drops of its series, one after the other: the results "
            "of the second are RESULTS-2.h5. Ctrl-C (SIGINT, SIGTERM) ends the run after "
            "the present step with readable results and a checkpoint, from which --restart resumes.\vExit "
            "code: 0 done, 2 wrong input, 3 a file failed, 4 wrong model, 5 numerical failure, 6 out of "
            "memory, 7 a library failed, 130 interrupted (SIGINT, SIGTERM)."};
    *o = (sf_solve_options){
        .threads = omp_get_max_threads(), .checkpoint_wall = 60, .checkpoint_time = INFINITY};
    argp_parse(&argp, argc, argv, 0, NULL, o);
}

void sf_solve_print_model(const sf_model *m, int threads) {
    printf("%lld nodes, %lld interactions, %lld held nodes, ", (long long)m->node_count,
           (long long)m->domain_nnz, (long long)m->fixed_count);
    if (m->rest_count > 0)
        printf("%lld resting nodes, ", (long long)m->rest_count);
    printf("%lld contact points, 1/%lld of the pad, %d threads\n", (long long)m->contact_count,
           (long long)m->symmetry_factor, threads);
}

void sf_solve_print_ledger(const sf_model *m, const sf_state *s, const sf_run *run) {
    const sf_sink sink = sf_program_sink("softfall-solve");
    const sf_ledger *l = &s->ledger;
    const sf_extremes *x = &run->extremes;
    double whole = sf_model_whole(m);
    bool driven = sf_missile_is_driven(m);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("ended: %s at %.3f ms after %lld steps, %.1f s, %.2f million node-steps/s, peak memory %.0f MB\n",
           run->ending, 1e3 * s->time, (long long)s->step, run->wall_time,
           (double)m->node_count * (double)s->step / run->wall_time / 1e6, (double)usage.ru_maxrss / 1e3);
    printf("energies at the end (J, whole pad): missile %.4f  pad %.4f  stored %.4f  hysteresis %.4f  "
           "viscous %.4f\n"
           "  stabilisation %.4f  contact %.5f  friction %.5f  %s work %.4f\n",
           whole * l->kinetic_missile, whole * l->kinetic_pad, whole * l->stored, whole * l->hysteresis,
           whole * l->viscous, whole * l->stabilisation, whole * l->contact, whole * l->friction,
           driven ? "the motion's" : "gravity's", whole * l->external);
    if (m->rest_count > 0)
        printf("  of contact and friction at the anvil %.5f  work of the pad's weight %.5f\n",
               whole * l->anvil, whole * l->weight);
    printf("energy error %.2e (largest), momentum error %.1e, |G v| %.1e m/s, penetration %.2g mm\n",
           l->largest_error, x->largest_momentum, x->largest_residual, 1e3 * x->largest_penetration);
    printf("at the peak of the internal energy (%.3f J): stabilisation %.2f %%, contact %.3f %%\n",
           x->peak_internal, 100 * x->stabilisation_share, 100 * x->contact_share);
    if (driven)
        printf("largest contact force %.2f N at %.3f ms, largest local compression %.4f\n", x->peak_value,
               1e3 * x->peak_time, x->largest_compression);
    else
        printf(
            "largest specific force %.2f g at %.3f ms, largest local compression %.4f, speed upwards at the "
            "end %.3f m/s\n",
            x->peak_value / SF_STANDARD_GRAVITY, 1e3 * x->peak_time, x->largest_compression,
            fmax(0, sf_missile_turns(m) ? s->missile.rate_now[2] : -s->missile.velocity_now));
    sf_run_tell(m, s, x, &sink);
    const sf_good_run *good = sf_good_run_limits();
    if (l->largest_error > good->energy_error || fabs(x->stabilisation_share) > good->stabilisation ||
        fabs(x->contact_share) > good->contact)
        sf_sink_tell(
            &sink, SF_WARNING,
            "energy error %.2f %% (good: %g), stabilisation %.2f %% (%g), contact %.2f %% (%g): beyond "
            "the limits of a good run, softfall-post gives the verdict",
            100 * l->largest_error, 100 * good->energy_error, 100 * x->stabilisation_share,
            100 * good->stabilisation, 100 * x->contact_share, 100 * good->contact);
}

static sf_status check_names(const sf_output *output, sf_error *err) {
    SF_TRY(sf_replace_check(output->results, err));
    return sf_replace_check(output->checkpoint, err);
}

/* A file of an earlier run is replaced only with --force. */
static sf_status check_output(const sf_solve_options *o, const sf_output *output, sf_error *err) {
    SF_TRY(check_names(output, err));
    if (o->force)
        return SF_OK;
    if (sf_replace_exists(output->results))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --force replaces it%s", output->results,
                       sf_replace_exists(output->checkpoint) ? ", --restart resumes it" : "");
    if (sf_replace_exists(output->checkpoint))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --restart %s resumes from it, --force starts a new run",
                       output->checkpoint, output->results);
    return SF_OK;
}

/* The model of a new run, or that of the run so far, and its hash. */
static sf_status read_model(const sf_solve_options *o, const sf_checkpoint *from, sf_model *model,
                            sf_h5 **file, char hash[SF_MODEL_HASH_SIZE], sf_error *err) {
    const char *path = o->model ? o->model : from->model_path;
    sf_error inner = SF_ERROR_INIT;
    if (sf_model_read(path, model, file, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%.800s%s", inner.text,
                       o->restart && !o->model ? " (--restart RESULTS MODEL says where the model is now)"
                                               : "");
    sf_model_hash(model, hash);
    if (o->restart && strcmp(hash, from->model_hash) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is not the model of %s: its hash is %s, that of the run %s",
                       path, from->path, hash, from->model_hash);
    return SF_OK;
}

static sf_status set_end_time(const sf_solve_options *o, const sf_checkpoint *from, sf_model *model,
                              sf_error *err) {
    model->run.end_time = o->end_time > 0 ? o->end_time : o->restart ? from->end_time : model->run.end_time;
    if (o->restart && from->time_before >= model->run.end_time)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is past %.6g s already, beyond the end time %.6g s", from->path,
                       from->time_before, model->run.end_time);
    return sf_model_check(model, err);
}

/* Other programs may round differently. The sentence also goes into the results; "" if there is none. */
static void compare_builds(const sf_checkpoint *from, char note[1024]) {
    const sf_sink sink = sf_program_sink("softfall-solve");
    note[0] = '\0';
    if (strcmp(from->git_revision, SF_GIT_REVISION) == 0 &&
        strcmp(from->compiler_flags, SF_COMPILER_FLAGS) == 0)
        return;
    snprintf(note, 1024,
             "%.600s is from another build (%.100s): the last digits may differ from those of one run",
             from->path, from->git_revision);
    sf_sink_tell(&sink, SF_WARNING, "%s", note);
}

static void remove_all(const sf_output *output) {
    unlink(output->results);
    unlink(output->checkpoint);
    sf_output_clear(output);
}

/* After a failure: removes the files, or reports which of them remain. */
static void handle_failure(const sf_solve_options *o, const sf_output *output, const sf_state *state,
                           bool shown) {
    if (o->remove_failed) {
        remove_all(output);
        return;
    }
    fprintf(stderr, "softfall-solve: note: %s %s", output->results,
            shown ? "has the frame of the failure" : "ends with the last frame that is finite");
    if (!o->no_checkpoint && access(output->checkpoint, F_OK) == 0)
        fprintf(stderr, "; %s is step %lld, t = %.6g s, the last valid step", output->checkpoint,
                (long long)state->step, state->time);
    fputc('\n', stderr);
}

/* True if a run to the results file of drop `k` has begun and can be resumed. */
static bool has_begun(const char *results, int64_t k) {
    char path[SF_PATH_SIZE - 16], checkpoint[SF_PATH_SIZE];
    sf_model_series_file(results, k, path, sizeof path);
    snprintf(checkpoint, sizeof checkpoint, "%s.restart", path);
    return access(checkpoint, F_OK) == 0;
}

/* A series of drops on one pad. */
typedef struct series {
    int64_t drops;        /* 1: a single drop */
    double interval;      /* s */
    char model[PATH_MAX]; /* path */
} series;

/* Checks a series beyond the model of its first drop. */
static sf_status check_series(const sf_solve_options *o, const series *all, sf_error *err) {
    if (all->drops == 1)
        return SF_OK;
    if (o->no_checkpoint || (o->restart && o->end_time > 0))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "a series of drops is solved without %s: each drop begins with the pad at the end of the one before",
            o->no_checkpoint ? "--no-checkpoint" : "--restart and --end-time");
    for (int64_t k = 2; k <= all->drops && !o->restart; k++) {
        char path[SF_PATH_SIZE];
        sf_output output;
        sf_model_series_file(o->output, k, path, sizeof path);
        if (sf_output_name(&output, path, err) != SF_OK || check_output(o, &output, err) != SF_OK)
            return err->status;
    }
    return SF_OK;
}

/* Builds operators and state, and writes the base of the results first: so the mesh is released before the
 * operators are built, and the model's file is closed. */
static sf_status build(sf_model *model, sf_h5 **model_file, const sf_provenance *provenance,
                       const sf_output *output, const sf_earlier *earlier, sf_operators *operators,
                       sf_state *state, sf_error *err) {
    if (sf_output_base(output, model, *model_file, provenance, err) != SF_OK ||
        sf_h5_close(model_file, err) != SF_OK)
        return err->status;
    sf_model_drop_mesh(model);
    if (sf_operators_take(model, operators, err) != SF_OK)
        return err->status;
    malloc_trim(0); /* return the freed work memory of the build */
    return sf_series_begin(earlier, model, operators, state, err);
}

/* One drop; of the first, `all` receives what the model says of a series. */
static sf_status solve_drop(const sf_solve_options *o, series *all, const char *command,
                            const volatile sig_atomic_t *stop, sf_error *err) {
    sf_model model = {0};
    sf_operators operators = {0};
    sf_state state = {0};
    sf_output output;
    sf_checkpoint from = {0};
    sf_h5 *model_file = NULL;
    char libraries[64], hash[SF_MODEL_HASH_SIZE], path[PATH_MAX];
    sf_provenance provenance = {.program = "softfall-solve",
                                .command_line = command,
                                .libraries = libraries,
                                .model_path = path,
                                .model_hash = hash};
    snprintf(libraries, sizeof libraries, "HDF5 %s", sf_h5_version());
    if (sf_output_name(&output, o->output, err) != SF_OK)
        return err->status;
    if (o->restart ? sf_checkpoint_open(output.checkpoint, &from, err) : check_output(o, &output, err))
        return err->status;
    if (read_model(o, &from, &model, &model_file, hash, err) != SF_OK ||
        (!o->restart && check_names(&output, err) != SF_OK) || /* now that the input is known */
        set_end_time(o, &from, &model, err) != SF_OK)
        goto done;
    const char *named = o->model ? o->model : from.model_path;
    if (!realpath(named, path))
        snprintf(path, sizeof path, "%s", named);
    if (all->drops == 0) {
        all->drops = model.run.drops > 1 ? (int64_t)model.run.drops : 1;
        all->interval = model.run.interval;
        snprintf(all->model, sizeof all->model, "%s", path);
        if (check_series(o, all, err) != SF_OK || (o->restart && all->drops > 1 && has_begun(o->output, 2)))
            goto done;
    }
    sf_solve_print_model(&model, o->threads);
    char note[1024] = "";
    if (o->restart)
        compare_builds(&from, note);
    if (sf_output_open(&output, err) != SF_OK ||
        build(&model, &model_file, &provenance, &output, &o->earlier, &operators, &state, err) != SF_OK ||
        sf_output_start(&output, o->restart != NULL, err) != SF_OK) {
        sf_output_abandon(&output);
        goto done;
    }
    sf_replace_clean(output.results);
    sf_replace_clean(output.checkpoint);
    if (!o->restart)
        unlink(output.checkpoint); /* of an earlier run, with --force */
    const sf_sink sink = sf_program_sink("softfall-solve");
    sf_run run = {.stop = stop,
                  .log = stdout,
                  .sink = &sink,
                  .terminal = isatty(STDOUT_FILENO),
                  .threads = o->threads,
                  .earlier = o->earlier,
                  .to_end_time = o->end_time > 0,
                  .checkpoints = !o->no_checkpoint,
                  .checkpoint_wall = o->checkpoint_wall,
                  .checkpoint_time = o->checkpoint_time,
                  .provenance = &provenance};
    snprintf(run.note, sizeof run.note, "%s", note);
    sf_run_drop(&model, &operators, &state, &run, &output, o->restart ? &from : NULL, err);
    if (state.step > 0)
        sf_solve_print_ledger(&model, &state, &run);
    if (err->status == SF_ERR_NUMERIC && (o->remove_failed || strcmp(run.ending, "anvil") != 0))
        handle_failure(o, &output, &state, run.shown);
done:
    sf_output_close(&output);
    sf_checkpoint_close(&from);
    sf_h5_close(&model_file, err);
    sf_state_free(&state);
    sf_operators_free(&operators);
    sf_model_free(&model);
    return err->status;
}

sf_status sf_solve(const sf_solve_options *o, const char *command, const volatile sig_atomic_t *stop,
                   sf_error *err) {
    series all = {0};
    char before[SF_PATH_SIZE], now[SF_PATH_SIZE];
    SF_TRY(solve_drop(o, &all, command, stop, err));
    for (int64_t k = 2; k <= all.drops; k++) {
        sf_solve_options drop = *o;
        sf_model_series_file(o->output, k - 1, before, sizeof before);
        sf_model_series_file(o->output, k, now, sizeof now);
        if (o->restart && k < all.drops && has_begun(o->output, k + 1))
            continue;
        drop.output = now;
        drop.model = all.model;
        drop.restart = o->restart && has_begun(o->output, k) ? now : NULL;
        drop.force = o->force || o->restart;
        drop.earlier = drop.restart ? (sf_earlier){0} : (sf_earlier){before, all.interval};
        printf("drop %lld of %lld, after %g s\n", (long long)k, (long long)all.drops, all.interval);
        SF_TRY(solve_drop(&drop, &all, command, stop, err));
    }
    return SF_OK;
}

/* softfall-solve: model.h5 -> results.h5. */

static volatile sig_atomic_t stop_requested; /* the one global: a signal handler can reach nothing else */

static void request_stop(int signal_number) {
    (void)signal_number;
    stop_requested = 1;
}

/* Waiting threads spin for billions of cycles by default, which costs a factor of ten and more as soon as
 * another process wants a processor. The OpenMP runtimes read their policy from the environment before main,
 * so the program starts itself once more with the passive one; a value set by the user is kept. */
static void limit_spinning(char **argv) {
    /* a spin of some 0.2 ms bridges the barriers of a step, and costs little where threads share a processor
     */
    if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 1) == 0 &&
        setenv("GOMP_SPINCOUNT", "5000", 0) == 0)
        execv("/proc/self/exe", argv); /* returns only if it cannot: then the run is merely slower */
}

int main(int argc, char **argv) {
    sf_solve_options o;
    sf_error err = SF_ERROR_INIT;
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-solve");
    limit_spinning(argv);
    sf_solve_options_parse(argc, argv, &o);
    if (sf_program_try_threads(o.threads, &err) != SF_OK)
        return sf_error_report(&err, "softfall-solve");
    omp_set_num_threads(o.threads);
    struct sigaction action = {.sa_handler = request_stop};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    char *command = sf_command_line(argc, argv);
    sf_solve(&o, command ? command : "softfall-solve", &stop_requested, &err);
    free(command);
    return sf_error_report(&err, "softfall-solve");
}
