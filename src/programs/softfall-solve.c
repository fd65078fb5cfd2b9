/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-solve: model.h5 -> results.h5. */
#include "base/program.h"
#include "io/provenance.h"
#include "programs/softfall-solve-solve.h"

#include <omp.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

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
