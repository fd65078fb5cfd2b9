/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/program.h"

#include "base/text.h"
#include "base/threads.h"
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { LEAST_STACK = 1 << 20, USUAL_STACK = 1 << 23 /* bytes */ };

/* The stack of the main thread, and OpenMP's of its threads. */
static sf_status check_stack(char **argv, sf_error *err) {
    struct rlimit stack;
    if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur >= LEAST_STACK)
        return SF_OK;
    rlim_t given = stack.rlim_cur;
    if (stack.rlim_max >= LEAST_STACK) {
        stack.rlim_cur = stack.rlim_max < USUAL_STACK ? stack.rlim_max : USUAL_STACK;
        if (setrlimit(RLIMIT_STACK, &stack) == 0)
            execv("/proc/self/exe", argv); /* threads take the limit of the start */
    }
    return SF_FAIL(err, SF_ERR_MEMORY,
                   "the stack is limited to %llu kB; at least %d kB are needed (ulimit -s)",
                   (unsigned long long)given / 1024, LEAST_STACK / 1024);
}

sf_status sf_program_begin(char **argv, sf_error *err) {
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    sf_sink sink = sf_program_sink(program_invocation_short_name);
    SF_TRY(sf_openmp_environment_check(&sink, err));
    return check_stack(argv, err);
}

/* Until the gate opens. */
static void *wait_for_all(void *gate) {
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

sf_status sf_program_try_threads(int threads, sf_error *err) {
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    pthread_t *thread = sf_alloc(err, (unsigned long)threads, sizeof *thread, "the threads");
    int count = 0, failed = 0;
    if (!thread)
        return err->status;
    pthread_mutex_lock(&gate);
    while (count < threads - 1 && failed == 0) {
        failed = pthread_create(&thread[count], NULL, wait_for_all, &gate);
        count += failed == 0;
    }
    pthread_mutex_unlock(&gate);
    for (int k = 0; k < count; k++)
        pthread_join(thread[k], NULL);
    free(thread);
    if (failed != 0)
        return SF_FAIL(
            err, SF_ERR_MEMORY,
            "%d threads cannot be started, only %d: %s; ask for fewer (--threads, OMP_NUM_THREADS), or "
            "raise the limit of processes or of memory",
            threads, count + 1, strerror(failed));
    return SF_OK;
}

sf_status sf_program_read_threads(const char *text, int *threads, sf_error *err) {
    if (!sf_whole_is(text, 1, SF_MOST_THREADS, threads))
        return SF_FAIL(err, SF_ERR_INPUT, "--threads takes a number from 1 to %d, not \"%s\"",
                       SF_MOST_THREADS, text);
    return SF_OK;
}

sf_status sf_program_read_limit(const char *option, const char *text, double *limit, sf_error *err) {
    if (!sf_decimal_is(text, limit) || !(*limit > 0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s %s: not a positive number", option, text);
    return SF_OK;
}

int sf_error_report(const sf_error *err, const char *program) {
    sf_error last = *err;
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout))
        SF_FAIL(&last, SF_ERR_IO, "the standard output cannot be written%s%s", errno ? ": " : "",
                errno ? strerror(errno) : "");
    if (last.status == SF_OK)
        return 0;
    if (getenv("SOFTFALL_DEBUG"))
        fprintf(stderr, "%s: [%s:%d] %s\n", program, last.where, last.line, last.text);
    else
        fprintf(stderr, "%s: %s\n", program, last.text);
    return (int)last.status;
}

static void print(void *user, sf_severity severity, const char *sentence) {
    const char *program = user;
    fprintf(stderr, "%s: %s: %s\n", program, severity == SF_WARNING ? "warning" : "note", sentence);
}

sf_sink sf_program_sink(const char *program) {
    return (sf_sink){print, (void *)(uintptr_t)program};
}
