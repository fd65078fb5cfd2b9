/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-solve: model.h5 -> results.h5. */
#include <limits.h>
#include <malloc.h>
#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/program.h"
#include "build_info.h"
#include "io/h5_data.h"
#include "io/plain_file.h"
#include "model/good_run.h"
#include "model/model_check.h"
#include "model/model_io.h"
#include "solver/run/run.h"

/* ---- the command line ---- */

typedef struct options {
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
} options;

/* A positive time with its unit. */
static sf_status read_time(const char *option, const char *text, void *time, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    if (sf_units_read(text, SF_TIME, time, &inner) == SF_OK && !(*(double *)time > 0))
        SF_REFUSE(&inner, "\"%s\"" SF_NOT_ABOVE_0, text);
    return inner.status != SF_OK ? SF_FAIL(err, inner.status, "%s: %s", option, inner.text) : SF_OK;
}

static sf_status read_on_failure(const char *option, const char *text, void *remove, sf_error *err) {
    *(bool *)remove = strcmp(text, "remove") == 0;
    if (strcmp(text, "remove") != 0 && strcmp(text, "keep") != 0)
        return SF_REFUSE(err, "%s takes keep or remove, not \"%s\"", option, text);
    return SF_OK;
}

static const sf_option list[] = {
    {"output", 'o', "RESULTS", "results file to write (HDF5)", .member = offsetof(options, output)},
    {"threads", 't', "N", "OpenMP threads (default: all processors, or OMP_NUM_THREADS)",
     .member = offsetof(options, threads), .low = 1, .high = SF_MOST_THREADS},
    {"force", 'f', NULL, "replace an existing results file", .member = offsetof(options, force)},
    {"restart", 0, "RESULTS",
     "resume RESULTS from RESULTS.restart, bit for bit as if uninterrupted; MODEL only if it has been moved",
     .member = offsetof(options, restart)},
    {"start-from", 0, "RESULTS",
     "begin with the pad as this earlier run left it, from RESULTS.restart: its foam remembers the drop",
     .member = offsetof(options, earlier.results)},
    {"pause", 0, "TIME", "rest of the pad between that run and this one, such as \"90 s\"",
     .member = offsetof(options, earlier.pause), .read = read_time},
    {"end-time", 0, "TIME", "another end of the simulated time, such as \"40 ms\"",
     .member = offsetof(options, end_time), .read = read_time},
    {"checkpoint-every", 0, "TIME", "wall time between checkpoints (default: 60 s)",
     .member = offsetof(options, checkpoint_wall), .read = read_time},
    {"checkpoint-time", 0, "TIME", "simulated time between checkpoints (default: none)",
     .member = offsetof(options, checkpoint_time), .read = read_time},
    {"no-checkpoint", 0, NULL, "write no checkpoints, not even at the end",
     .member = offsetof(options, no_checkpoint)},
    {"on-failure", 0, "keep|remove",
     "after a numerical failure, keep results and a checkpoint of the last step that held (default), or "
     "remove all",
     .member = offsetof(options, remove_failed), .read = read_on_failure},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    if (o->restart && o->output)
        return "--restart RESULTS writes to RESULTS: -o is not allowed with it";
    if (!o->restart && (!o->model || !o->output))
        return "usage: softfall-solve model.h5 -o results.h5";
    if (!o->earlier.results != !(o->earlier.pause > 0) || (o->restart && o->earlier.results))
        return "a run on the pad of an earlier one needs --start-from RESULTS and --pause TIME, and no --restart: "
               "what is resumed knows its pad";
    return NULL;
}

/* ---- texts before and after a run ---- */

/* The size of the model, on stdout. */
static void print_model(const sf_model *m, int threads) {
    printf("%lld nodes, %lld interactions, %lld held nodes, ", (long long)m->node_count,
           (long long)m->domain_nnz, (long long)m->fixed_count);
    if (m->rest_count > 0)
        printf("%lld resting nodes, ", (long long)m->rest_count);
    printf("%lld contact points, ", (long long)m->contact_count);
    if (m->axisymmetric)
        printf("the section of an axisymmetric pad, ");
    else
        printf("1/%lld of the pad, ", (long long)m->symmetry_factor);
    printf("%d threads\n", threads);
}

/* The ending, the energies and the errors of a run on stdout; warnings on stderr. */
static void print_ledger(const sf_model *m, const sf_state *s, const sf_run *run) {
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
        sf_sink_tell(&sink, SF_WARNING,
                     "energy error %.2f %% (good: %g), stabilisation %.2f %% (%g), contact %.2f %% (%g): "
                     "beyond the limits of a good run, softfall-post gives the verdict",
                     100 * l->largest_error, 100 * good->energy_error, 100 * x->stabilisation_share,
                     100 * good->stabilisation, 100 * x->contact_share, 100 * good->contact);
}

/* ---- the run, from the model's file to the results ---- */

static sf_status check_names(const sf_output *output, sf_error *err) {
    SF_TRY(sf_replace_check(output->results, err));
    return sf_replace_check(output->checkpoint, err);
}

/* Enters the earlier run in the register of inputs, which no output replaces. */
static sf_status register_earlier(const char *results, sf_error *err) {
    SF_PRINTED(checkpoint, SF_PATH_SIZE, "%.4000s.restart", results);
    if (sf_replace_exists(results))
        SF_TRY(sf_plain_check(results, NULL, err));
    return sf_replace_exists(checkpoint) ? sf_plain_check(checkpoint, NULL, err) : SF_OK;
}

/* A file of an earlier run is replaced only with --force. */
static sf_status check_output(const options *o, const sf_output *output, sf_error *err) {
    SF_TRY(check_names(output, err));
    SF_TRY(sf_h5_check_replaced(output->results, "softfall-results", err));
    SF_TRY(sf_h5_check_replaced(output->checkpoint, "softfall-checkpoint", err));
    if (o->force)
        return SF_OK;
    if (sf_replace_exists(output->results))
        return SF_REFUSE(err, "%s exists; --force replaces it%s", output->results,
                         sf_replace_exists(output->checkpoint) ? ", --restart resumes it" : "");
    if (sf_replace_exists(output->checkpoint))
        return SF_REFUSE(err, "%s exists; --restart %s resumes from it, --force starts a new run",
                         output->checkpoint, output->results);
    return SF_OK;
}

/* The model of a new run, or that of the run so far, and its hash. */
static sf_status read_model(const options *o, const sf_checkpoint *from, sf_model *model, sf_h5 **file,
                            char hash[SF_MODEL_HASH_SIZE], sf_error *err) {
    const char *path = o->model ? o->model : from->model_path;
    sf_error inner = SF_ERROR_INIT;
    if (sf_model_read(path, model, file, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%.800s%s", inner.text,
                       o->restart && !o->model ? " (--restart RESULTS MODEL says where the model is now)"
                                               : "");
    sf_model_hash(model, hash);
    if (o->restart && strcmp(hash, from->model_hash) != 0)
        return SF_REFUSE(err, "%s is not the model of %s: its hash is %s, that of the run %s", path,
                         from->path, hash, from->model_hash);
    return SF_OK;
}

static sf_status set_end_time(const options *o, const sf_checkpoint *from, sf_model *model, sf_error *err) {
    if (o->end_time > 0)
        model->run.end_time = o->end_time;
    else if (o->restart)
        model->run.end_time = from->end_time;
    if (o->restart && from->time_before >= model->run.end_time)
        return SF_REFUSE(err, "%s is past %.6g s already, beyond the end time %.6g s", from->path,
                         from->time_before, model->run.end_time);
    return sf_model_check(model, err);
}

/* Other programs may round differently. The sentence also goes into the results. */
static void compare_builds(const sf_checkpoint *from, sf_run *run) {
    if (strcmp(from->git_revision, SF_GIT_REVISION) == 0 &&
        strcmp(from->compiler_flags, SF_COMPILER_FLAGS) == 0)
        return;
    snprintf(run->note, sizeof run->note,
             "%.600s is from another build (%.100s): the last digits may differ from those of one run",
             from->path, from->git_revision);
    sf_sink_tell(run->sink, SF_WARNING, "%s", run->note);
}

/* After a failure: removes the files, or reports which of them remain. */
static void handle_failure(const options *o, const sf_output *output, const sf_state *state, bool shown) {
    if (o->remove_failed) {
        unlink(output->results);
        unlink(output->checkpoint);
        sf_output_clear(output);
        return;
    }
    fprintf(stderr, "softfall-solve: note: %s %s", output->results,
            shown ? "has the frame of the failure" : "ends with the last frame that is finite");
    if (!o->no_checkpoint && access(output->checkpoint, F_OK) == 0)
        fprintf(stderr, "; %s is step %lld, t = %.6g s, the last valid step", output->checkpoint,
                (long long)state->step, state->time);
    fputc('\n', stderr);
}

static void name_checkpoint(const char *results, int64_t k, char checkpoint[SF_PATH_SIZE]) {
    char path[SF_PATH_SIZE - 16];
    sf_model_series_file(results, k, path, sizeof path);
    snprintf(checkpoint, SF_PATH_SIZE, "%s.restart", path);
}

/* True if a run to the results file of drop `k` has begun and can be resumed. */
static bool has_begun(const char *results, int64_t k) {
    char checkpoint[SF_PATH_SIZE];
    name_checkpoint(results, k, checkpoint);
    return access(checkpoint, F_OK) == 0;
}

/* A series of drops on one pad. */
typedef struct series {
    int64_t drops;                        /* 1: a single drop */
    double interval[SF_SERIES_MOST];      /* s, before each */
    int64_t own[SF_SERIES_MOST];          /* hash of the model of its own, 0: that of the first */
    char model[PATH_MAX], next[PATH_MAX]; /* paths: of the first, of the present one */
} series;

static void take_series(const sf_model *m, const char *path, series *all) {
    all->drops = m->series_count > 1 ? m->series_count : 1;
    snprintf(all->model, sizeof all->model, "%s", path);
    for (int64_t k = 0; k < m->series_count; k++) {
        all->interval[k] = m->series_interval[k];
        all->own[k] = m->series_model[k];
    }
}

/* Refuses another model than that which the first of the series was made with. */
static sf_status check_own(const series *all, int64_t k, const char hash[SF_MODEL_HASH_SIZE], sf_error *err) {
    SF_PRINTED(own, SF_MODEL_HASH_SIZE, "%016llx", (unsigned long long)all->own[k - 1]);
    if (all->own[k - 1] == 0 || strcmp(own, hash) == 0)
        return SF_OK;
    return SF_REFUSE(err, "%s is not the model of drop %lld that softfall-pre made with %s: hash %s, not %s",
                     all->next, (long long)k, all->model, hash, own);
}

/* Checks a series beyond the model of its first drop. */
static sf_status check_series(const options *o, const series *all, sf_error *err) {
    if (all->drops == 1)
        return SF_OK;
    if (o->no_checkpoint || (o->restart && o->end_time > 0))
        return SF_REFUSE(err,
                         "a series of drops is solved without %s: each drop begins with the pad at the end "
                         "of the one before",
                         o->no_checkpoint ? "--no-checkpoint" : "--restart and --end-time");
    for (int64_t k = 2; k <= all->drops && !o->restart; k++) {
        char path[SF_PATH_SIZE];
        sf_output output;
        sf_model_series_file(o->output, k, path, sizeof path);
        SF_TRY(sf_output_name(&output, path, err));
        SF_TRY(check_output(o, &output, err));
        sf_model_series_file(all->model, k, path, sizeof path);
        if (all->own[k - 1] && access(path, R_OK) != 0)
            return SF_REFUSE(err, "%s is not there: drop %lld of the series in %s needs it", path,
                             (long long)k, all->model);
    }
    return SF_OK;
}

/* The parts of the solution of a drop, which are released from the last to the first. */
typedef struct solution {
    sf_model model;
    sf_operators operators;
    sf_state state;
    sf_output output;
    sf_checkpoint from;
    sf_h5 *model_file;
    const sf_provenance *provenance; /* borrowed */
} solution;

static void free_solution(solution *d) {
    sf_h5_drop(&d->model_file);
    sf_checkpoint_close(&d->from);
    sf_output_close(&d->output);
    sf_state_free(&d->state);
    sf_operators_free(&d->operators);
    sf_model_free(&d->model);
}

/* Opens the output, writes the base of the results, so that the mesh is released and the model's file closed
 * before operators and state are built, and removes what killed runs left. */
static sf_status start(const options *o, solution *d, sf_error *err) {
    sf_output *output = &d->output;
    if (sf_output_open(output, err) != SF_OK ||
        sf_output_base(output, &d->model, d->model_file, d->provenance, err) != SF_OK ||
        sf_h5_close(&d->model_file, err) != SF_OK ||
        (sf_model_drop_mesh(&d->model), sf_series_shape(&o->earlier, &d->from, &d->model, err)) != SF_OK ||
        sf_operators_take(&d->model, &d->operators, err) != SF_OK ||
        (malloc_trim(0), /* return the freed work memory of the build */
         sf_series_begin(&o->earlier, &d->model, &d->operators, &d->state, err)) != SF_OK ||
        sf_output_start(output, o->restart != NULL, err) != SF_OK) {
        sf_output_abandon(output);
        return err->status;
    }
    sf_replace_clean(output->results);
    sf_replace_clean(output->checkpoint);
    if (!o->restart)
        unlink(output->checkpoint); /* of an earlier run, with --force */
    return SF_OK;
}

/* Solves one drop, or resumes it; of the first, k = 1, `all` receives what the model says of a series. */
static sf_status solve_drop(const options *o, int64_t k, series *all, const char *command,
                            const volatile sig_atomic_t *stop, sf_error *err) {
    SF_OWNED_BY(free_solution) solution d = {.output.lock = -1};
    char libraries[64], hash[SF_MODEL_HASH_SIZE], path[PATH_MAX];
    sf_provenance provenance = {.program = "softfall-solve",
                                .command_line = command,
                                .libraries = libraries,
                                .model_path = path,
                                .model_hash = hash};
    snprintf(libraries, sizeof libraries, "HDF5 %s", sf_h5_version());
    SF_TRY(sf_output_name(&d.output, o->output, err));
    if (o->earlier.results)
        SF_TRY(register_earlier(o->earlier.results, err));
    if (o->restart ? sf_checkpoint_open(d.output.checkpoint, &d.from, err) : check_output(o, &d.output, err))
        return err->status;
    if (read_model(o, &d.from, &d.model, &d.model_file, hash, err) != SF_OK ||
        (!o->restart && check_names(&d.output, err) != SF_OK) || /* now that the input is known */
        set_end_time(o, &d.from, &d.model, err) != SF_OK)
        return err->status;
    const char *named = o->model ? o->model : d.from.model_path;
    if (!realpath(named, path))
        snprintf(path, sizeof path, "%s", named);
    if (k > 1)
        SF_TRY(check_own(all, k, hash, err));
    if (k == 1) {
        take_series(&d.model, path, all);
        SF_TRY(check_series(o, all, err));
        if (o->restart && all->drops > 1 && has_begun(o->output, 2))
            return SF_OK;
    }
    print_model(&d.model, o->threads);
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
    if (o->restart)
        compare_builds(&d.from, &run);
    d.provenance = &provenance;
    SF_TRY(start(o, &d, err));
    for (int64_t later = 2; k == 1 && later <= all->drops && !o->restart; later++) {
        char checkpoint[SF_PATH_SIZE]; /* of an earlier series, which this one would seem to have reached */
        name_checkpoint(o->output, later, checkpoint);
        unlink(checkpoint);
    }
    sf_run_drop(&d.model, &d.operators, &d.state, &run, &d.output, o->restart ? &d.from : NULL, err);
    if (d.state.step > 0)
        print_ledger(&d.model, &d.state, &run);
    if (err->status == SF_ERR_NUMERIC && (o->remove_failed || strcmp(run.ending, "anvil") != 0))
        handle_failure(o, &d.output, &d.state, run.shown);
    return err->status;
}

/* Solves the model of the options, all drops of its series, or resumes them; `command` is for the provenance.
 * Non-zero `*stop` ends the run after the present step. Progress and report go to stdout. */
static sf_status solve(const options *o, const char *command, const volatile sig_atomic_t *stop,
                       sf_error *err) {
    series all = {0};
    char before[SF_PATH_SIZE], now[SF_PATH_SIZE];
    SF_TRY(solve_drop(o, 1, &all, command, stop, err));
    for (int64_t k = 2; k <= all.drops; k++) {
        options drop = *o;
        sf_model_series_file(o->output, k - 1, before, sizeof before);
        sf_model_series_file(o->output, k, now, sizeof now);
        if (o->restart && k < all.drops && has_begun(o->output, k + 1))
            continue;
        drop.output = now;
        sf_model_series_file(all.model, all.own[k - 1] ? k : 1, all.next, sizeof all.next);
        drop.model = all.next;
        drop.restart = o->restart && has_begun(o->output, k) ? now : NULL;
        drop.force = o->force || o->restart;
        drop.earlier = drop.restart ? (sf_earlier){0} : (sf_earlier){before, all.interval[k - 1]};
        printf("drop %lld of %lld, after %g s\n", (long long)k, (long long)all.drops, all.interval[k - 1]);
        SF_TRY(solve_drop(&drop, k, &all, command, stop, err));
    }
    return SF_OK;
}

/* ---- the program ---- */

/* Waiting threads spin for billions of cycles by default, which costs a factor of ten and more as soon as
 * another process wants a processor. The OpenMP runtimes read their policy from the environment before main,
 * so the program starts itself once more with the passive one; a value set by the user is kept. */
static void limit_spinning(char **argv) {
    /* a spin of some 0.2 ms bridges the barriers of a step, and costs little where threads share one */
    if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 1) == 0 &&
        setenv("GOMP_SPINCOUNT", "5000", 0) == 0)
        execv("/proc/self/exe", argv); /* returns only if it cannot: then the run is merely slower */
}

int main(int argc, char **argv) {
    options o = {.threads = omp_get_max_threads(), .checkpoint_wall = 60, .checkpoint_time = INFINITY};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {
        .program = "softfall-solve",
        .operands = "MODEL",
        .meaning =
            "Solves the drop in MODEL (from softfall-pre), or the drops of its series, one after the other: the results "
            "of the second are RESULTS-2.h5. Ctrl-C (SIGINT, SIGTERM) ends the run after "
            "the present step with readable results and a checkpoint, from which --restart resumes.\vExit "
            "code: 0 done, 2 wrong input, 3 a file failed, 4 wrong model, 5 numerical failure, 6 out of "
            "memory, 7 a library failed, 130 interrupted (SIGINT, SIGTERM).",
        .second = "one model file at a time: \"%s\" is one too many",
        .operand = offsetof(options, model),
        .fault = find_fault,
        .is_usage = true,
        .list = {{list, &o}}};
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-solve");
    limit_spinning(argv);
    if (sf_command_parse(&line, argc, argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-solve");
    if (o.restart)
        o.output = o.restart;
    if (sf_program_try_threads(o.threads, &err) != SF_OK)
        return sf_error_report(&err, "softfall-solve");
    omp_set_num_threads(o.threads);
    SF_OWNED char *command = sf_command_line(argc, argv);
    solve(&o, command ? command : "softfall-solve", sf_process_handle_signals(), &err);
    return sf_error_report(&err, "softfall-solve");
}
