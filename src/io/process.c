/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/process.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

sf_status sf_process_find(const char *name, char *path, size_t size, sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    char self[PATH_MAX];
    if (given && *given) {
        snprintf(path, size, "%s/%s", given, name);
    } else {
        ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
        if (length < 0)
            return SF_FAIL(err, SF_ERR_IO, "the folder of this program is unknown: %s", strerror(errno));
        self[length] = '\0';
        *strrchr(self, '/') = '\0';
        snprintf(path, size, "%s/%s", self, name);
    }
    if (access(path, X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the program %s cannot be run: %s", path, strerror(errno));
    return SF_OK;
}

static volatile sig_atomic_t stopped, running; /* running: process id of the stoppable program, 0 = none */

static void pass_on(int signal_number) {
    stopped = 1;
    if (running > 0)
        kill((pid_t)running, signal_number);
}

void sf_process_handle_signals(void) {
    struct sigaction action = {.sa_handler = pass_on};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool sf_process_stopped(void) {
    return stopped != 0;
}

/* Where it runs, reads and prints. */
static int prepare(posix_spawn_file_actions_t *actions, const sf_process *p) {
    int result = p->folder ? posix_spawn_file_actions_addchdir_np(actions, p->folder) : 0;
    if (result == 0)
        result = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    if (result == 0)
        result = p->log
                     ? posix_spawn_file_actions_addopen(
                           actions, 1, p->log, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK, 0666)
                     : posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_WRONLY, 0);
    return result == 0 ? posix_spawn_file_actions_adddup2(actions, 1, 2) : result;
}

/* Waits for the child; 0 or an errno value. */
static int await(pid_t child, int *exit_code) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return errno;
    *exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return 0;
}

int sf_process_run(const sf_process *p, int *exit_code) {
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int result = posix_spawn_file_actions_init(&actions);
    if (result != 0)
        return result;
    result = prepare(&actions, p);
    if (result == 0)
        result = posix_spawnp(&child, p->arguments[0], &actions, NULL, (char *const *)p->arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (result != 0)
        return result;
    if (p->stoppable) {
        running = child;
        if (stopped) /* the signal came before the child was known */
            kill(child, SIGTERM);
    }
    result = await(child, exit_code);
    running = 0;
    return result;
}
