/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/runner.h"

#include "post/figures.h"
#include "case/case.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_ARGUMENTS = 2 * SF_RUNNER_OVERRIDES + 16, TEXT_SIZE = PATH_MAX + 64 };

/* A campaign needs the curve and the figures, not the fields. */
static const char *const lean_output[] = {"output.fields=[\"displacement\"]", "output.frame_interval=1000 s"};
enum { LEAN = sizeof lean_output / sizeof lean_output[0] };

/* ---- the programs ---- */

/* "folder/name" of a program of ours. */
static sf_status find_program(const char *name, char *path, sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    char self[PATH_MAX];
    if (given && *given) {
        snprintf(path, TEXT_SIZE, "%s/%s", given, name);
    } else {
        ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
        if (length < 0)
            return SF_FAIL(err, SF_ERR_IO, "the folder of this program is unknown: %s", strerror(errno));
        self[length] = '\0';
        *strrchr(self, '/') = '\0';
        snprintf(path, TEXT_SIZE, "%s/%s", self, name);
    }
    if (access(path, X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the program %s cannot be run: %s", path, strerror(errno));
    return SF_OK;
}

/* ---- what makes two drops the same ---- */

static const uint64_t FNV_OFFSET = 14695981039346656037u, FNV_PRIME = 1099511628211u;

static uint64_t hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t k = 0; k < size; k++)
        hash = (hash ^ byte[k]) * FNV_PRIME;
    return hash;
}

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    char block[4096];
    size_t size;
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be read: %s", path, strerror(errno));
    while ((size = fread(block, 1, sizeof block, file)) > 0)
        *hash = hash_bytes(*hash, block, size);
    fclose(file);
    return SF_OK;
}

/* The case's list of values without the names of files, whose contents count. */
static uint64_t hash_values(uint64_t hash, const char *values) {
    static const char *const files[] = {"geometry.file ", "geometry.missile_file ", "material.curve ",
                                        "material.curves ", "missile.motion "};
    while (*values) {
        size_t length = strcspn(values, "\n"), skipped = 0;
        for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
            skipped += strncmp(values, files[k], strlen(files[k])) == 0;
        if (!skipped)
            hash = hash_bytes(hash, values, length);
        values += length + (values[length] == '\n');
    }
    return hash;
}

static sf_status hash_case(const sf_case *c, uint64_t *hash, sf_error *err) {
    size_t motion = sf_case_motion_bytes(c);
    *hash = hash_values(FNV_OFFSET, c->parameters);
    *hash = sf_material_hash(*hash, &c->material);
    *hash = hash_bytes(*hash, c->motion_time, motion);
    *hash = hash_bytes(*hash, c->motion_displacement, motion);
    if (hash_file(hash, c->pad.path, err) != SF_OK ||
        (c->missile.path && hash_file(hash, c->missile.path, err) != SF_OK))
        return err->status;
    static const char *const programs[] = {"softfall-pre", "softfall-solve"};
    for (int k = 0; k < 2; k++) {
        char path[TEXT_SIZE];
        if (find_program(programs[k], path, err) != SF_OK || hash_file(hash, path, err) != SF_OK)
            break;
    }
    return err->status;
}

/* ---- child processes ---- */

/* The last line of a log that says something, for an error's sentence. */
static void last_line(const char *path, char *out, size_t size) {
    char *line = NULL;
    size_t room = 0;
    FILE *file = fopen(path, "r");
    snprintf(out, size, "it said nothing");
    while (file && getline(&line, &room, file) >= 0) {
        line[strcspn(line, "\n")] = '\0';
        if (*line)
            snprintf(out, size, "%s", line);
    }
    free(line);
    if (file)
        fclose(file);
}

static volatile sig_atomic_t stopped, running; /* running: process id of the child, 0 = none */

static void pass_on(int signal_number) {
    stopped = 1;
    if (running > 0)
        kill((pid_t)running, signal_number);
}

void sf_runner_handle_signals(void) {
    struct sigaction action = {.sa_handler = pass_on};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool sf_runner_stopped(void) {
    return stopped != 0;
}

static sf_status interrupted(sf_error *err) {
    return SF_FAIL(err, SF_INTERRUPTED,
                   "interrupted; finished drops are kept: the same command goes on from here");
}

/* Runs a program with its words appended to `log`; its exit code decides. */
static sf_status run_program(char *const *arguments, const char *log, sf_error *err) {
    posix_spawn_file_actions_t actions;
    pid_t child = 0;
    int status = 0, result;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for running %s", arguments[0]);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, log, O_WRONLY | O_CREAT | O_APPEND, 0666);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    result = posix_spawn(&child, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (result != 0)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be run: %s", arguments[0], strerror(result));
    running = child;
    if (stopped) /* the signal came before the child was known */
        kill(child, SIGTERM);
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return SF_FAIL(err, SF_ERR_IO, "%s was lost: %s", arguments[0], strerror(errno));
    running = 0;
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (code == 0)
        return SF_OK;
    if (stopped || code == SF_INTERRUPTED || code == 128 + SIGTERM)
        return interrupted(err);
    char said[800];
    last_line(log, said, sizeof said);
    return SF_FAIL(err, code <= SF_ERR_LIBRARY ? (sf_status)code : SF_ERR_LIBRARY,
                   "%s (exit code %d; see %s)", said, code, log);
}

/* ---- a drop ---- */

typedef struct place {
    char folder[TEXT_SIZE], model[TEXT_SIZE + 16], results[TEXT_SIZE + 16], checkpoint[TEXT_SIZE + 32],
        log[TEXT_SIZE + 16];
} place;

static sf_status make_folder(const char *path, sf_error *err) {
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
    return SF_OK;
}

/* Every override of the drop, ours included; `material` is the buffer of the first. */
static int list_overrides(const sf_runner_drop *drop, char *material, const char **list) {
    int count = 0;
    if (drop->material) {
        snprintf(material, TEXT_SIZE, "material=@%s", drop->material);
        list[count++] = material;
    }
    for (int k = 0; k < drop->override_count; k++)
        list[count++] = drop->overrides[k];
    for (int k = 0; k < LEAN; k++)
        list[count++] = lean_output[k];
    return count;
}

static sf_status locate(const sf_runner *runner, const sf_runner_drop *drop, int count,
                        const char *const *list, place *at, sf_error *err) {
    sf_case c;
    uint64_t hash = 0;
    if (sf_case_read(drop->case_path, count, list, &c, err) != SF_OK)
        return err->status;
    hash_case(&c, &hash, err);
    sf_case_free(&c);
    snprintf(at->folder, sizeof at->folder, "%s/%s-%016llx", runner->folder, drop->label,
             (unsigned long long)hash);
    snprintf(at->model, sizeof at->model, "%s/model.h5", at->folder);
    snprintf(at->results, sizeof at->results, "%s/results.h5", at->folder);
    snprintf(at->checkpoint, sizeof at->checkpoint, "%s.restart", at->results);
    snprintf(at->log, sizeof at->log, "%s/log.txt", at->folder);
    return err->status;
}

/* Takes up a drop that was interrupted. False if there is none, or it cannot go on: then it starts anew. */
static bool resume(const char *solve, const char *threads, const place *at, sf_error *err) {
    const char *run[] = {solve, "--restart", at->results, at->model, "-t", threads, NULL};
    sf_error trial = SF_ERROR_INIT;
    if (access(at->model, R_OK) != 0 || access(at->checkpoint, R_OK) != 0)
        return false;
    run_program((char *const *)run, at->log, &trial);
    if (trial.status != SF_OK && trial.status != SF_INTERRUPTED && trial.status != SF_ERR_NUMERIC)
        return false;
    if (trial.status != SF_OK)
        SF_FAIL(err, trial.status, "%s", trial.text);
    return true;
}

static sf_status simulate(const sf_runner *runner, const sf_runner_drop *drop, int count,
                          const char *const *list, const place *at, sf_error *err) {
    char pre[TEXT_SIZE], solve[TEXT_SIZE], threads[16];
    const char *build[MAX_ARGUMENTS] = {pre, drop->case_path, "-o", at->model, "--force"};
    int n = 5;
    for (int k = 0; k < count; k++) {
        build[n++] = "--set";
        build[n++] = list[k];
    }
    snprintf(threads, sizeof threads, "%d", runner->threads);
    const char *run[] = {solve, at->model, "-o", at->results, "--force", "-t", threads, NULL};
    if (find_program("softfall-pre", pre, err) != SF_OK ||
        find_program("softfall-solve", solve, err) != SF_OK || make_folder(runner->folder, err) != SF_OK ||
        make_folder(at->folder, err) != SF_OK)
        return err->status;
    if (!resume(solve, threads, at, err)) {
        remove(at->log);
        if (run_program((char *const *)build, at->log, err) == SF_OK)
            run_program((char *const *)run, at->log, err);
    }
    if (err->status != SF_INTERRUPTED) {
        remove(at->model);
        remove(at->checkpoint);
    }
    return err->status;
}

/* True if the file holds a drop that ran to its end. */
static bool is_finished(const char *path) {
    sf_error none = SF_ERROR_INIT;
    sf_results r;
    if (access(path, R_OK) != 0 || sf_results_open(path, &r, &none) != SF_OK)
        return false;
    bool finished = strcmp(r.status, "finished") == 0 || strcmp(r.status, "rebound") == 0;
    sf_results_close(&r);
    return finished;
}

static sf_status result_path(const char *path, sf_runner_result *out, sf_error *err) {
    out->path = strdup(path);
    if (!out->path) {
        sf_runner_result_free(out);
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    }
    return SF_OK;
}

static sf_status read_result(const char *path, sf_runner_result *out, sf_error *err) {
    sf_results r;
    sf_figures f = {0};
    if (sf_results_open(path, &r, err) != SF_OK)
        return err->status;
    if (sf_figures_compute(&r, 1000, &f, err) == SF_OK && !f.touched)
        SF_FAIL(err, SF_ERR_INPUT, "the missile of %s never touched the pad", path);
    if (err->status == SF_OK) {
        *out = (sf_runner_result){.a_max_g = f.injury.a_max_g,
                                  .hic = f.injury.hic.value,
                                  .v0 = f.v0,
                                  .v_rebound = f.v_rebound,
                                  .max_indentation = f.max_indentation,
                                  .max_local_strain = f.max_local_strain,
                                  .energy_error = f.energy_error,
                                  .nodes = r.node_count,
                                  .steps = r.steps,
                                  .curve = f.filtered};
        f.filtered = (sf_series){0};
        result_path(path, out, err);
    }
    sf_figures_free(&f);
    sf_results_close(&r);
    return err->status;
}

sf_status sf_runner_run(sf_runner *runner, const sf_runner_drop *drop, sf_runner_result *result,
                        sf_error *err) {
    char material[TEXT_SIZE];
    const char *list[SF_RUNNER_OVERRIDES + 1 + LEAN];
    place at;
    *result = (sf_runner_result){0};
    int count = list_overrides(drop, material, list);
    if (locate(runner, drop, count, list, &at, err) != SF_OK)
        return err->status;
    bool reused = is_finished(at.results);
    if (stopped)
        return interrupted(err);
    if (!reused && simulate(runner, drop, count, list, &at, err) != SF_OK)
        return err->status;
    if (read_result(at.results, result, err) != SF_OK)
        return err->status;
    result->reused = reused;
    *(reused ? &runner->reused : &runner->simulated) += 1;
    if (runner->log) {
        fprintf(runner->log, "  %-24s %7.4g m/s  a_max %7.2f g  HIC %7.1f  largest local strain %.3f%s\n",
                drop->label, result->v0, result->a_max_g, result->hic, result->max_local_strain,
                reused ? "  (was there)" : "");
        fflush(runner->log);
    }
    return SF_OK;
}

void sf_runner_result_free(sf_runner_result *result) {
    sf_series_free(&result->curve);
    free(result->path);
    *result = (sf_runner_result){0};
}
