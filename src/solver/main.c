/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-solve: model.h5 -> results.h5. */
#include "build_info.h"
#include "io/model_io.h"
#include "solver/results_file.h"
#include "solver/run.h"

#include <argp.h>
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
    if (!getenv("OMP_WAIT_POLICY") && setenv("OMP_WAIT_POLICY", "passive", 1) == 0)
        execv("/proc/self/exe", argv); /* returns only if it cannot: then the run is merely slower */
}

typedef struct options {
    const char *model;
    const char *output;
    int threads;
    bool force;
} options;

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    char *end;
    switch (key) {
    case 'o':
        o->output = arg;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case 't': {
        long threads = strtol(arg, &end, 10);
        if (*end || threads < 1 || threads > 1024)
            argp_error(state, "--threads takes a number from 1 to 1024, not \"%s\"", arg);
        o->threads = (int)threads;
        return 0;
    }
    case ARGP_KEY_ARG:
        if (o->model)
            argp_error(state, "one model file at a time: \"%s\" is one too many", arg);
        o->model = arg;
        return 0;
    case ARGP_KEY_END:
        if (!o->model || !o->output)
            argp_error(state, "usage: softfall-solve model.h5 -o results.h5");
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
    double whole = (double)m->symmetry_factor;
    bool driven = m->motion_count > 0;
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
           l->largest_error, run->largest_momentum, run->largest_residual, 1e3 * run->largest_penetration);
    printf("at the peak of the internal energy (%.3f J): stabilisation %.2f %%, contact %.3f %%\n",
           run->peak_internal, 100 * run->stabilisation_share, 100 * run->contact_share);
    if (driven)
        printf("largest contact force %.2f N at %.3f ms, largest local compression %.4f\n", run->peak_value,
               1e3 * run->peak_time, run->largest_compression);
    else
        printf("largest acceleration %.2f g at %.3f ms, largest local compression %.4f, speed upwards at the "
               "end %.3f m/s\n",
               run->peak_value / 9.80665, 1e3 * run->peak_time, run->largest_compression,
               fmax(0, -s->missile.velocity_now));
    const sf_missile_card *card = &m->missile;
    double height = card->sphere_radius * (1 - card->sphere_cap_cosine);
    if (card->shape == SF_SHAPE_SPHERE && run->largest_indentation > height)
        warn("the missile went %.4g mm deep, beyond its spherical cap of %.4g mm",
             1e3 * run->largest_indentation, 1e3 * height);
    if (l->largest_error > 0.01 || fabs(run->stabilisation_share) > 0.05 || fabs(run->contact_share) > 0.01)
        warn("energy error %.2f %% (good: 1), stabilisation %.2f %% (5), contact %.2f %% (1): do not trust "
             "these figures",
             100 * l->largest_error, 100 * run->stabilisation_share, 100 * run->contact_share);
    if (s->contact_unsettled > 0)
        warn("the contact forces of %lld steps did not settle to the last digits",
             (long long)s->contact_unsettled);
    if (isnan(s->missile.contact_time))
        warn("the missile never touched the pad");
    if (run->largest_indentation > m->thickness)
        warn("the missile went %.4g mm into a pad of %.4g mm: it is smaller than "
             "the spacing "
             "of the contact points and passed between them",
             1e3 * run->largest_indentation, 1e3 * m->thickness);
}

static sf_status solve(const options *o, const char *command, sf_error *err) {
    sf_model model = {0};
    sf_operators operators = {0};
    sf_state state = {0};
    sf_h5 *model_file = NULL, *file = NULL;
    sf_provenance provenance = {.program = "softfall-solve", .command_line = command};
    char libraries[64];
    snprintf(libraries, sizeof libraries, "HDF5 %s", sf_h5_version());
    provenance.libraries = libraries;
    if (!o->force && access(o->output, F_OK) == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --force replaces it", o->output);
    if (sf_model_read(o->model, &model, &model_file, err) != SF_OK)
        goto done;
    print_model(&model, o->threads);
    if (sf_operators_build(&model, &operators, err) != SF_OK ||
        sf_state_create(&model, &state, err) != SF_OK ||
        sf_results_create(o->output, &model, model_file, &provenance, &file, err) != SF_OK)
        goto done;
    sf_model_drop_mesh(&model);
    sf_model_drop_domain_nodes(&model);
    sf_run run = {.stop = &stop_requested,
                  .log = stdout,
                  .terminal = isatty(STDOUT_FILENO),
                  .threads = o->threads,
                  .ending = "failed"};
    sf_run_drop(&model, &operators, &state, &run, file, err);
    sf_h5_close(&file, err);
    print_ledger(&model, &state, &run);
done:
    sf_h5_close(&file, err);
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
        {0},
    };
    argp_program_version = "softfall-solve " SF_VERSION " (" SF_GIT_REVISION ")";
    static const struct argp argp = {
        .options = list,
        .parser = parse,
        .args_doc = "MODEL",
        .doc = "Solves the drop in MODEL (from softfall-pre). Ctrl-C ends the run after the "
               "present step with readable results."};
    limit_spinning(argv);
    options o = {.threads = omp_get_max_threads()};
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
