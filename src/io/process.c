/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/process.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdint.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The folder of the programs. */
static sf_status find_folder(char folder[PATH_MAX], sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    if (given && *given) {
        snprintf(folder, PATH_MAX, "%s", given);
        return SF_OK;
    }
    ssize_t length = readlink("/proc/self/exe", folder, PATH_MAX - 1);
    if (length < 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder of this program is unknown: %s", strerror(errno));
    folder[length] = '\0';
    *strrchr(folder, '/') = '\0';
    return SF_OK;
}

sf_status sf_process_find(const char *name, char *path, size_t size, sf_error *err) {
    char folder[PATH_MAX];
    SF_TRY(find_folder(folder, err));
    snprintf(path, size, "%s/%s", folder, name);
    if (access(path, X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the program %s cannot be run: %s", path, strerror(errno));
    return SF_OK;
}

static bool is_shared_below(const char *folder, const char *way, const char *name, char *path, size_t size) {
    return snprintf(path, size, "%s/%s/share/softfall/%s", folder, way, name) < (int)size &&
           access(path, R_OK) == 0;
}

sf_status sf_process_find_shared(const char *name, char *path, size_t size, sf_error *err) {
    char folder[PATH_MAX], library[PATH_MAX];
    Dl_info here; /* of a library in the process of a host */
    SF_TRY(find_folder(folder, err));
    if (is_shared_below(folder, "..", name, path, size))
        return SF_OK;
    const char *given = getenv("SF_BIN_DIR"); /* is believed: nothing is looked for elsewhere */
    if (!(given && *given) && dladdr((const void *)(uintptr_t)sf_process_find_shared, &here) != 0 &&
        realpath(here.dli_fname, library)) {
        *strrchr(library, '/') = '\0';
        if (is_shared_below(library, "..", name, path, size) ||
            is_shared_below(library, "../..", name, path, size))
            return SF_OK;
    }
    return SF_FAIL(err, SF_ERR_IO,
                   "%s/../share/softfall/%s, which comes with softfall, is missing: install it again", folder,
                   name);
}

bool sf_process_is_in_path(const char *name) {
    const char *path = getenv("PATH");
    char copy[8192], file[PATH_MAX], *rest = copy, *folder;
    snprintf(copy, sizeof copy, "%s", path ? path : "/usr/bin:/bin");
    while ((folder = strsep(&rest, ":")))
        if (snprintf(file, sizeof file, "%s/%s", *folder ? folder : ".", name) < (int)sizeof file &&
            access(file, X_OK) == 0)
            return true;
    return false;
}

static volatile sig_atomic_t stopped;
/* Process ids of stoppable programs or copies; below 0: of a group; 0: none. */
static volatile sig_atomic_t running[SF_PROCESS_JOBS];

static void tell(sig_atomic_t who, int signal_number) {
    if (who != 0)
        kill((pid_t)who, who < 0 ? SIGINT : signal_number);
}

static void pass_on(int signal_number) {
    stopped = 1;
    for (int k = 0; k < SF_PROCESS_JOBS; k++)
        tell(running[k], signal_number);
}

/* Signals go to the child from now on; also one that came before it was known. */
static void watch(int slot, pid_t child) {
    running[slot] = child;
    if (stopped)
        tell(child, SIGTERM);
}

const volatile sig_atomic_t *sf_process_handle_signals(void) {
    struct sigaction action = {.sa_handler = pass_on};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    return &stopped;
}

bool sf_process_stopped(void) {
    return stopped != 0;
}

/* Who started us may have set the end of children to be ignored: then none could be waited for. */
static void notice_children(void) {
    const struct sigaction action = {.sa_handler = SIG_DFL};
    struct sigaction present;
    if (sigaction(SIGCHLD, NULL, &present) == 0 && present.sa_handler == SIG_IGN)
        sigaction(SIGCHLD, &action, NULL);
}

/* Sets the folder, the input and the output of the process. */
static int prepare(posix_spawn_file_actions_t *actions, const sf_process *p) {
    int result = p->folder ? posix_spawn_file_actions_addchdir_np(actions, p->folder) : 0;
    if (result == 0)
        result = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    if (result == 0)
        result = p->log
                     ? posix_spawn_file_actions_addopen(
                           actions, 1, p->log, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK, 0666)
                     : posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_WRONLY, 0);
    if (result == 0 && p->held && *p->held >= 0)
        result = posix_spawn_file_actions_adddup2(actions, *p->held, *p->held); /* no longer closed by exec */
    return result == 0 ? posix_spawn_file_actions_adddup2(actions, 1, 2) : result;
}

static int start(const sf_process *p, pid_t *child) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int result = posix_spawn_file_actions_init(&actions);
    if (result != 0)
        return result;
    posix_spawnattr_init(&attributes); /* these three cannot fail */
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, p->apart ? POSIX_SPAWN_SETPGROUP : 0);
    result = prepare(&actions, p);
    if (result == 0)
        result =
            posix_spawnp(child, p->arguments[0], &actions, &attributes, (char *const *)p->arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return result;
}

/* Waits for the child; 0 or an errno value. */
static int await(const sf_process *p, pid_t child, int *exit_code) {
    enum { TURNS = 100 }; /* of a tenth of a second between two ticks */
    int status = 0, turn = 0;
    pid_t ended;
    while ((ended = waitpid(child, &status, p->tick ? WNOHANG : 0)) <= 0) {
        if (ended < 0 && errno != EINTR)
            return errno;
        if (ended == 0)
            nanosleep(&(struct timespec){0, 100000000}, NULL);
        if (ended == 0 && ++turn % TURNS == 0)
            p->tick(p->context);
    }
    *exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return 0;
}

int sf_process_run(const sf_process *p, int *exit_code) {
    pid_t child = 0;
    notice_children();
    int result = start(p, &child);
    if (result != 0)
        return result;
    if (p->stoppable)
        watch(0, p->apart ? -child : child);
    result = await(p, child, exit_code);
    running[0] = 0;
    return result;
}

/* ---- copies of this process ---- */

/* One at work. */
typedef struct job {
    pid_t child; /* 0: none */
    int index, pipe;
} job;

/* In the copy: the work, its sentence through the pipe, and the end without what this process would do at its
 * own. */
static _Noreturn void work_in_copy(pid_t parent, int pipe, sf_process_work work, void *context, int index) {
    sf_error err = SF_ERROR_INIT;
    memset((void *)running, 0, sizeof running); /* the children of the parent */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent)
        work(context, index, &err);
    else
        SF_FAIL(&err, SF_ERR_IO, "its program has ended");
    size_t length = strlen(err.text);
    bool told = length == 0 || write(pipe, err.text, length) == (ssize_t)length;
    _exit(told ? (int)err.status : SF_ERR_IO);
}

static sf_status begin_job(job *j, int slot, int index, sf_process_work work, void *context, sf_error *err) {
    int ends[2];
    pid_t self = getpid();
    if (pipe2(ends, O_CLOEXEC) != 0)
        return SF_FAIL(err, SF_ERR_IO, "no pipe to a further process: %s", strerror(errno));
    fflush(NULL); /* or the copy would have our unwritten output too */
    pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        work_in_copy(self, ends[1], work, context, index);
    }
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        return SF_FAIL(err, SF_ERR_IO, "no further process: %s", strerror(errno));
    }
    *j = (job){child, index, ends[0]};
    watch(slot, child);
    return SF_OK;
}

/* The failure of a copy that has ended: its status and its sentence. */
static void end_job(job *j, int status, sf_error *result) {
    char text[sizeof result->text] = "";
    size_t length = 0;
    ssize_t got;
    while ((got = read(j->pipe, text + length, sizeof text - 1 - length)) > 0)
        length += (size_t)got;
    close(j->pipe);
    if (WIFSIGNALED(status))
        SF_FAIL(result, sf_process_stopped() ? SF_INTERRUPTED : SF_ERR_LIBRARY, SF_PROCESS_KILLED " %d",
                WTERMSIG(status));
    else if (WEXITSTATUS(status) != 0)
        SF_FAIL(result, (sf_status)WEXITSTATUS(status), "%s", *text ? text : "it said nothing");
    *j = (job){0};
}

/* Waits for one of the jobs to end; *index of its work. */
static sf_status await_job(job *jobs, int count, sf_error *result, int *index, sf_error *err) {
    int status = 0;
    pid_t child;
    while ((child = waitpid(-1, &status, 0)) < 0 && errno == EINTR)
        ;
    for (int k = 0; k < count; k++)
        if (child > 0 && jobs[k].child == child) {
            running[k] = 0;
            *index = jobs[k].index;
            end_job(&jobs[k], status, &result[*index]);
        }
    return child > 0 ? SF_OK : SF_FAIL(err, SF_ERR_IO, "a process of a batch is lost: %s", strerror(errno));
}

sf_status sf_process_pool(int count, int jobs, sf_process_work work, sf_process_watch watcher, void *context,
                          sf_error *result, sf_error *err) {
    job at[SF_PROCESS_JOBS] = {{0}};
    int next = 0, busy = 0, ended = 0;
    notice_children();
    if (jobs < 1)
        jobs = 1;
    else if (jobs > SF_PROCESS_JOBS)
        jobs = SF_PROCESS_JOBS;
    for (int k = 0; k < count; k++)
        result[k] = (sf_error)SF_ERROR_INIT;
    do {
        busy = 0;
        for (int k = 0; k < jobs; k++) {
            bool more = next < count && !stopped && err->status == SF_OK;
            if (at[k].child == 0 && more && begin_job(&at[k], k, next, work, context, err) == SF_OK)
                next++;
            busy += at[k].child != 0;
        }
        int index = -1;
        if (busy > 0 && await_job(at, jobs, result, &index, err) != SF_OK)
            return err->status;
        if (watcher && index >= 0)
            watcher(context, index, ++ended, &result[index]);
    } while (busy > 0);
    for (int k = next; k < count; k++)
        SF_FAIL(&result[k], SF_INTERRUPTED, "interrupted before it began");
    return err->status;
}

double sf_process_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
