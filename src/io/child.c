/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CANNOT_RUN = 127 };

/* In the copy. Who started us may have set signals to be ignored. */
static _Noreturn void become(const char *const *arguments, int input, int output, pid_t parent, int failure) {
    setpgid(0, 0);
    for (int k = 1; k < 32; k++)
        signal(k, SIG_DFL);
    if (parent > 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (getppid() != parent)
            _exit(CANNOT_RUN);
    }
    if (dup2(input, 0) >= 0 && (output < 0 || (dup2(output, 1) >= 0 && dup2(output, 2) >= 0)))
        execvp(arguments[0], (char *const *)arguments);
    int reason = errno;
    if (write(failure, &reason, sizeof reason) < 0)
        _exit(CANNOT_RUN);
    _exit(CANNOT_RUN);
}

/* The copy tells through a pipe that closes by itself when the program begins why it could not. */
static sf_status launch(const char *const *arguments, int output, bool bound, pid_t *process, sf_error *err) {
    int nothing[2] = {-1, -1}, failure[2] = {-1, -1}, reason = 0;
    pid_t self = getpid();
    if (pipe2(nothing, O_CLOEXEC) != 0 || pipe2(failure, O_CLOEXEC) != 0) {
        reason = errno;
        *process = -1;
    } else {
        *process = fork();
        if (*process == 0)
            become(arguments, nothing[0], output, bound ? self : 0, failure[1]);
        reason = *process < 0 ? errno : 0;
    }
    close(failure[1]);
    if (*process > 0 && read(failure[0], &reason, sizeof reason) == (ssize_t)sizeof reason) {
        waitpid(*process, NULL, 0);
        *process = -1;
    }
    close(failure[0]);
    close(nothing[0]);
    close(nothing[1]);
    if (*process > 0)
        return SF_OK;
    *process = 0;
    return SF_FAIL(err, SF_ERR_IO, "the program %s cannot be run: %s", arguments[0], strerror(reason));
}

sf_status sf_child_start(sf_child *child, const char *const *arguments, FILE *log, sf_error *err) {
    const struct sigaction action = {.sa_handler = SIG_DFL};
    sigaction(SIGCHLD, &action, NULL); /* or none could be waited for */
    fflush(log);
    return launch(arguments, fileno(log), true, &child->process, err);
}

sf_status sf_child_leave(const char *const *arguments, sf_error *err) {
    pid_t process;
    return launch(arguments, -1, false, &process, err);
}

bool sf_child_poll(sf_child *child, int *exit_code) {
    int status = 0;
    if (child->process == 0 || waitpid(child->process, &status, WNOHANG) == 0)
        return false;
    kill(-child->process, SIGTERM); /* what it may have left behind */
    *exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    child->process = 0;
    return true;
}

void sf_child_ask_to_end(const sf_child *child) {
    if (child->process > 0)
        kill(-child->process, SIGTERM);
}

void sf_child_end(sf_child *child, double patience) {
    const struct timespec pause = {0, 20000000};
    int code;
    sf_child_ask_to_end(child);
    for (double waited = 0; child->process > 0 && waited < patience && !sf_child_poll(child, &code);
         waited += 0.02)
        nanosleep(&pause, NULL);
    if (child->process == 0)
        return;
    kill(-child->process, SIGKILL);
    waitpid(child->process, NULL, 0);
    child->process = 0;
}
