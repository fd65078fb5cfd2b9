/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Runs gnuplot in `directory`. Returns its exit code, or -1 with errno. */
static int run_gnuplot(const char *directory, const char *script) {
    char program[] = "gnuplot";
    char *const arguments[] = {program, (char *)script, NULL};
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int status = 0;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return -1;
    int result = posix_spawn_file_actions_addchdir_np(&actions, directory);
    for (int descriptor = 0; descriptor <= 2 && result == 0; descriptor++)
        result = posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_RDWR, 0);
    if (result == 0)
        result = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (result != 0) {
        errno = result;
        return -1;
    }
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

void sf_gnuplot_draw(const sf_output *output, const char *script, const char *picture, char *warning,
                     size_t size) {
    warning[0] = '\0';
    int code = run_gnuplot(output->staging, script);
    if (code == -1)
        snprintf(warning, size,
                 "%s was not drawn, as gnuplot cannot be run (%s): install it and run \"gnuplot %s\" in the "
                 "output directory",
                 picture, strerror(errno), script);
    else if (code != 0 || !sf_output_has(output, picture))
        snprintf(warning, size,
                 "%s was not drawn: gnuplot ended with code %d; run \"gnuplot %s\" in the output directory "
                 "to see why",
                 picture, code, script);
}
