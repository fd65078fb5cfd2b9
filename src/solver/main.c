/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-solve: model.h5 -> results.h5. */
#include "build_info.h"
#include "core/good_run.h"
#include "core/units.h"
#include "io/model_io.h"
#include "solver/run/run.h"

#include <argp.h>
#include <limits.h>
#include <malloc.h>
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static volatile sig_atomic_t stop_requested; /* the one global: a signal handler can reach nothing else */

static void request_stop(int signal_number) {
    (void)signal_number;
    stop_requested = 1;
}

/* Waiting threads spin for billions of cycles by default, which costs a factor of ten and more as soon as
 * another process wants a processor. The OpenMP runtimes read their policy from the environment before main,
 * so the program starts itself once more with the passive one; what the user has set stands. */
static void limit_spinning(char **argv) {
    /* a spin of some 0.2 ms bridges the barriers of a step, and costs little where threads share a processor
     */
    if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 1) == 0 &&
        setenv("GOMP_SPINCOUNT", "5000", 0) == 0)
        execv("/proc/self/exe", argv); /* returns only if it cannot: then the run is merely slower */
}

typedef struct options {
    const char *model;
    const char *output;
    const char *restart;
    double end_time;                         /* s, 0: as the model says, or the run so far */
    double checkpoint_wall, checkpoint_time; /* s */
    bool no_checkpoint;
    bool remove_failed;
    int threads;
    bool force;
} options;

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
    char *end;
    long threads = strtol(text, &end, 10);
    if (*end || threads < 1 || threads > 1024)
        argp_error(state, "--threads takes a number from 1 to 1024, not \"%s\"", text);
    return (int)threads;
}

static void check_options(options *o, struct argp_state *state) {
    if (o->restart && o->output)
        argp_error(state, "--restart RESULTS goes on in RESULTS: -o has no place beside it");
    if (!o->restart && (!o->model || !o->output))
        argp_error(state, "usage: softfall-solve model.h5 -o results.h5");
    if (o->restart)
        o->output = o->restart;
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
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

static void print_model(const sf_model *m, int threads) {
    printf("%lld nodes, %lld interactions, %lld held nodes, %lld contact points, 1/%lld of the pad, %d "
           "threads\n",
           (long long)m->node_count, (long long)m->domain_nnz, (long long)m->fixed_count,
           (long long)m->contact_count, (long long)m->symmetry_factor, threads);
}

__attribute__((format(printf, 1, 2))) static void warn(const char *format, ...) {
    va_list args;
    va_start(args, format);
    fputs("softfall-solve: warning: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
}

static void print_ledger(const sf_model *m, const sf_state *s, const sf_run *run) {
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
    printf("energy error %.2e (largest), momentum error %.1e, |G v| %.1e m/s, penetration %.2g mm\n",
           l->largest_error, x->largest_momentum, x->largest_residual, 1e3 * x->largest_penetration);
    printf("at the peak of the internal energy (%.3f J): stabilisation %.2f %%, contact %.3f %%\n",
           x->peak_internal, 100 * x->stabilisation_share, 100 * x->contact_share);
    if (driven)
        printf("largest contact force %.2f N at %.3f ms, largest local compression %.4f\n", x->peak_value,
               1e3 * x->peak_time, x->largest_compression);
    else
        printf("largest acceleration %.2f g at %.3f ms, largest local compression %.4f, speed upwards at the "
               "end %.3f m/s\n",
               x->peak_value / SF_STANDARD_GRAVITY, 1e3 * x->peak_time, x->largest_compression,
               fmax(0, -s->missile.velocity_now));
    const sf_missile_card *card = &m->missile;
    double height = card->sphere_radius * (1 - card->sphere_cap_cosine);
    if (card->shape == SF_SHAPE_SPHERE && x->largest_indentation > height)
        warn("the missile went %.4g mm deep, beyond its spherical cap of %.4g mm",
             1e3 * x->largest_indentation, 1e3 * height);
    const sf_good_run *good = sf_good_run_limits();
    if (l->largest_error > good->energy_error || fabs(x->stabilisation_share) > good->stabilisation ||
        fabs(x->contact_share) > good->contact)
        warn(
            "energy error %.2f %% (good: %g), stabilisation %.2f %% (%g), contact %.2f %% (%g): do not trust "
            "these figures",
            100 * l->largest_error, 100 * good->energy_error, 100 * x->stabilisation_share,
            100 * good->stabilisation, 100 * x->contact_share, 100 * good->contact);
    if (s->contact_unsettled > 0)
        warn("the contact forces of %lld steps did not settle to the last digits",
             (long long)s->contact_unsettled);
    if (isnan(s->missile.contact_time))
        warn("the missile never touched the pad");
    if (x->largest_indentation > m->thickness)
        warn("the missile went %.4g mm into a pad of %.4g mm: it is smaller than the spacing of the contact "
             "points and passed between them",
             1e3 * x->largest_indentation, 1e3 * m->thickness);
}

/* A file of an earlier run is replaced only with --force. */
static sf_status check_output(const options *o, const sf_output *output, sf_error *err) {
    if (o->force)
        return SF_OK;
    if (access(output->results, F_OK) == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --force replaces it%s", output->results,
                       access(output->checkpoint, F_OK) == 0 ? ", --restart goes on with it" : "");
    if (access(output->checkpoint, F_OK) == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --restart %s goes on from it, --force starts anew",
                       output->checkpoint, output->results);
    return SF_OK;
}

/* The model of a new run, or that of the run so far, and its hash. */
static sf_status read_model(const options *o, const sf_checkpoint *from, sf_model *model, sf_h5 **file,
                            char hash[17], sf_error *err) {
    const char *path = o->model ? o->model : from->model_path;
    sf_error inner = SF_ERROR_INIT;
    if (sf_model_read(path, model, file, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%.800s%s", inner.text,
                       o->restart && !o->model ? " (--restart RESULTS MODEL says where the model is now)"
                                               : "");
    snprintf(hash, 17, "%016llx", (unsigned long long)sf_model_hash(model));
    if (o->restart && strcmp(hash, from->model_hash) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is not the model of %s: its hash is %s, that of the run %s",
                       path, from->path, hash, from->model_hash);
    return SF_OK;
}

static sf_status set_end_time(const options *o, const sf_checkpoint *from, sf_model *model, sf_error *err) {
    model->run.end_time = o->end_time > 0 ? o->end_time : o->restart ? from->end_time : model->run.end_time;
    if (o->restart && from->time_before >= model->run.end_time)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is past %.6g s already, beyond the end time %.6g s", from->path,
                       from->time_before, model->run.end_time);
    return sf_model_check(model, err);
}

/* Other programs may round differently. */
static void compare_builds(const sf_checkpoint *from) {
    if (strcmp(from->git_revision, SF_GIT_REVISION) != 0 ||
        strcmp(from->compiler_flags, SF_COMPILER_FLAGS) != 0)
        warn("%s is from another build (%s): the last digits may differ from those of one run", from->path,
             from->git_revision);
}

static void remove_all(const sf_output *output) {
    unlink(output->results);
    unlink(output->checkpoint);
    sf_output_clear(output);
}

/* What a failure leaves behind. */
static void handle_failure(const options *o, const sf_output *output, const sf_state *state) {
    if (o->remove_failed) {
        remove_all(output);
        return;
    }
    fprintf(stderr, "softfall-solve: %s has the frame of the failure", output->results);
    if (!o->no_checkpoint && access(output->checkpoint, F_OK) == 0)
        fprintf(stderr, "; %s is step %lld, t = %.6g s, the last that held", output->checkpoint,
                (long long)state->step, state->time);
    fputc('\n', stderr);
}

/* All that a step needs, and the base of the results: the mesh, and the shape functions of inner nodes, are
 * never in memory together with what the solver derives from the model. */
static sf_status build(sf_model *model, const sf_h5 *model_file, const sf_provenance *provenance,
                       const sf_output *output, sf_shapes *shapes, sf_operators *operators, sf_state *state,
                       sf_error *err) {
    if (sf_output_base(output, model, model_file, provenance, err) != SF_OK ||
        sf_shapes_open(model, model_file, shapes, err) != SF_OK)
        return err->status;
    sf_model_drop_mesh(model);
    sf_model_drop_inner_shapes(model);
    if (sf_operators_take(model, operators, err) != SF_OK)
        return err->status;
    malloc_trim(0); /* what building took and gave back */
    return sf_state_create(model, state, err);
}

static sf_status solve(const options *o, const char *command, sf_error *err) {
    sf_model model = {0};
    sf_operators operators = {0};
    sf_state state = {0};
    sf_shapes shapes = {0};
    sf_output output;
    sf_checkpoint from = {0};
    sf_h5 *model_file = NULL;
    char libraries[64], hash[17], path[PATH_MAX];
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
        set_end_time(o, &from, &model, err) != SF_OK)
        goto done;
    if (!realpath(o->model ? o->model : from.model_path, path))
        snprintf(path, sizeof path, "%s", o->model);
    print_model(&model, o->threads);
    if (o->restart)
        compare_builds(&from);
    if (sf_output_open(&output, err) != SF_OK ||
        build(&model, model_file, &provenance, &output, &shapes, &operators, &state, err) != SF_OK ||
        sf_output_start(&output, o->restart != NULL, err) != SF_OK) {
        sf_output_abandon(&output);
        goto done;
    }
    output.shapes = &shapes;
    if (!o->restart)
        unlink(output.checkpoint); /* of an earlier run, with --force */
    sf_run run = {.stop = &stop_requested,
                  .log = stdout,
                  .terminal = isatty(STDOUT_FILENO),
                  .threads = o->threads,
                  .checkpoints = !o->no_checkpoint,
                  .checkpoint_wall = o->checkpoint_wall,
                  .checkpoint_time = o->checkpoint_time,
                  .provenance = &provenance};
    sf_run_drop(&model, &operators, &state, &run, &output, o->restart ? &from : NULL, err);
    if (state.step > 0)
        print_ledger(&model, &state, &run);
    if (err->status == SF_ERR_NUMERIC)
        handle_failure(o, &output, &state);
done:
    sf_output_close(&output);
    sf_checkpoint_close(&from);
    sf_shapes_close(&shapes);
    sf_h5_close(&model_file, err);
    sf_state_free(&state);
    sf_operators_free(&operators);
    sf_model_free(&model);
    return err->status;
}

int main(int argc, char **argv) {
    static const struct argp_option list[] = {
        {"output", 'o', "RESULTS", 0, "results file to write (HDF5)", 0},
        {"threads", 't', "N", 0, "OpenMP threads (default: all processors, or OMP_NUM_THREADS)", 0},
        {"force", 'f', 0, 0, "replace an existing results file", 0},
        {"restart", RESTART, "RESULTS", 0,
         "go on with RESULTS from RESULTS.restart, with the bits of one run; MODEL only if it has been moved",
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
               "the present step with readable results and a checkpoint, from which --restart goes on.\vExit "
               "code: 0 done, 2 wrong input, 3 a file failed, 4 wrong model, 5 numerical failure, 6 out of "
               "memory, 7 a library failed, 130 interrupted (SIGINT, SIGTERM)."};
    limit_spinning(argv);
    options o = {.threads = omp_get_max_threads(), .checkpoint_wall = 60, .checkpoint_time = INFINITY};
    sf_error err = SF_ERROR_INIT;
    sf_error_ignore_closed_pipe();
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    omp_set_num_threads(o.threads);
    struct sigaction action = {.sa_handler = request_stop};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    char *command = sf_command_line(argc, argv);
    solve(&o, command ? command : "softfall-solve", &err);
    free(command);
    return sf_error_report(&err, "softfall-solve");
}
