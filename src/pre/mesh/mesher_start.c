/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesher_start.h"

#include "build_info.h"
#include "pre/mesh/broker.h"
#include "pre/mesh/mesher_protocol.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define NAME "softfall-mesh"

static bool is_there(char *path, size_t size, const char *folder, const char *below) {
    return snprintf(path, size, "%s%s/%s", folder, below, NAME) < (int)size && access(path, X_OK) == 0;
}

/* Beside `file`, or in its neighbourhood. */
static bool find_near(const char *file, char *path, size_t size) {
    static const char *const below[] = {"", "/../libexec/softfall", "/../../libexec/softfall", "/../bin"};
    char folder[PATH_MAX];
    if (!realpath(file, folder))
        return false;
    *strrchr(folder, '/') = '\0';
    for (size_t k = 0; k < sizeof below / sizeof below[0]; k++)
        if (is_there(path, size, folder, below[k]))
            return true;
    return false;
}

sf_status sf_mesher_find(char *path, size_t size, sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    Dl_info here;
    if (given && *given && is_there(path, size, given, ""))
        return SF_OK;
    if (find_near("/proc/self/exe", path, size) ||
        (dladdr((const void *)(uintptr_t)sf_mesher_find, &here) != 0 &&
         find_near(here.dli_fname, path, size)) ||
        is_there(path, size, SF_LIBEXEC_DIR, ""))
        return SF_OK;
    return SF_FAIL(err, SF_ERR_IO,
                   "the program " NAME
                   ", which reads geometries, is missing: it belongs into libexec/softfall beside the folder "
                   "of this program (%s)",
                   SF_LIBEXEC_DIR);
}

/* The child's ends, out of the way of the numbers that they get there. */
typedef struct ends {
    int control, data, print, parameters;
} ends;

static int lift(int file) {
    int lifted = file >= 0 ? fcntl(file, F_DUPFD_CLOEXEC, 10) : -1;
    if (file >= 0)
        close(file);
    return lifted;
}

static void close_ends(const ends *e) {
    const int file[] = {e->control, e->data, e->print, e->parameters};
    for (size_t k = 0; k < sizeof file / sizeof file[0]; k++)
        if (file[k] >= 0)
            close(file[k]);
}

static bool make_ends(const char *parameters, sf_mesher_child *child, ends *e) {
    int control[2] = {-1, -1}, data[2] = {-1, -1}, print[2] = {-1, -1};
    bool made = socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, control) == 0 &&
                pipe2(data, O_CLOEXEC) == 0 && pipe2(print, O_CLOEXEC) == 0;
    child->control = control[0];
    child->data = data[0];
    child->print = print[0];
    *e = (ends){lift(control[1]), lift(data[1]), lift(print[1]),
                lift(sf_broker_memory(parameters, strlen(parameters)))};
    return made && e->control >= 0 && e->data >= 0 && e->print >= 0 && e->parameters >= 0;
}

static int prepare(posix_spawn_file_actions_t *actions, const ends *e) {
    const int pairs[][2] = {{e->print, 1},
                            {e->print, 2},
                            {e->control, SF_MESHER_CONTROL},
                            {e->data, SF_MESHER_DATA},
                            {e->parameters, SF_MESHER_PARAMETERS}};
    int result = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0] && result == 0; k++)
        result = posix_spawn_file_actions_adddup2(actions, pairs[k][0], pairs[k][1]);
    return result == 0 ? posix_spawn_file_actions_addclosefrom_np(actions, SF_MESHER_PARAMETERS + 1) : result;
}

/* Nothing of the user's but where libraries are. The options are for the sanitizers of a test build: gmsh
 * crashes, and keeps memory. */
static int spawn(const char *path, const posix_spawn_file_actions_t *actions,
                 const posix_spawnattr_t *attributes, pid_t *process) {
    static const char sanitizers[] =
        "detect_leaks=0:handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill="
        "0";
    char name[] = NAME, home[] = "HOME=/dev/null", locale[] = "LC_ALL=C", threads[] = "OMP_NUM_THREADS=1",
         libraries[PATH_MAX + 32] = "LD_LIBRARY_PATH=", asan[256], ubsan[256];
    const char *given = getenv("LD_LIBRARY_PATH");
    snprintf(asan, sizeof asan, "ASAN_OPTIONS=%s", sanitizers);
    snprintf(ubsan, sizeof ubsan, "UBSAN_OPTIONS=%s", sanitizers);
    char *const arguments[] = {name, NULL};
    char *environment[] = {home, locale, threads, asan, ubsan, NULL, NULL};
    if (given && *given) {
        snprintf(libraries, sizeof libraries, "LD_LIBRARY_PATH=%s", given);
        environment[5] = libraries;
    }
    return posix_spawn(process, path, actions, attributes, arguments, environment);
}

/* Signals as in a fresh program; those that users send stay ignored if they are (nohup). */
static int prepare_signals(posix_spawnattr_t *attributes) {
    static const int sent[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    sigset_t all, none;
    sigfillset(&all);
    for (size_t k = 0; k < sizeof sent / sizeof sent[0]; k++)
        sigdelset(&all, sent[k]);
    sigemptyset(&none);
    int result = posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    if (result == 0)
        result = posix_spawnattr_setsigdefault(attributes, &all);
    return result == 0 ? posix_spawnattr_setsigmask(attributes, &none) : result;
}

sf_status sf_mesher_start(const char *parameters, sf_mesher_child *child, sf_error *err) {
    char path[PATH_MAX];
    ends e;
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    if (sf_mesher_find(path, sizeof path, err) != SF_OK)
        return err->status;
    int result = make_ends(parameters, child, &e) ? 0 : errno;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    if (result == 0)
        result = prepare(&actions, &e);
    if (result == 0)
        result = prepare_signals(&attributes);
    if (result == 0)
        result = spawn(path, &actions, &attributes, &child->process);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close_ends(&e);
    if (result == 0)
        return SF_OK;
    close_ends(&(ends){child->control, child->data, child->print, -1});
    return SF_FAIL(err, SF_ERR_IO, "%s cannot be started: %s", path, strerror(result));
}
