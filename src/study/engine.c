/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/engine.h"

#include "study/run_folder.h"
#include "io/plain_file.h"
#include "io/process.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WORD_SIZE = PATH_MAX + 64 };

bool sf_engine_is_local(const sf_runner_engine *engine) {
    return !engine->name || strcmp(engine->name, "local") == 0;
}

static sf_status missing(sf_error *err) {
    return SF_FAIL(err, SF_ERR_IO,
                   "--engine snakemake: Snakemake is not installed (package snakemake of Debian)");
}

/* The profile as Snakemake is told: a folder of ours, or what was given. */
static sf_status find_profile(const char *name, char path[PATH_MAX], sf_error *err) {
    if (strcmp(name, "slurm") == 0)
        return sf_process_find_shared("slurm", path, PATH_MAX, err);
    snprintf(path, PATH_MAX, "%s", name);
    return SF_OK;
}

/* True if the folder is one of Snakemake's profiles: it has one of the files that Snakemake reads. */
static bool is_profile(const char *folder) {
    char file[SF_RUN_PATH_SIZE];
    for (int version = 7; version < 10; version++) {
        char infix[8] = "";
        if (version > 7)
            snprintf(infix, sizeof infix, ".v%d+", version);
        if (snprintf(file, sizeof file, "%s/config%s.yaml", folder, infix) < (int)sizeof file &&
            access(file, R_OK) == 0)
            return true;
    }
    return false;
}

/* In Snakemake's folder below one of configurations: `parent`, as far as the first colon, and `rest`. */
static bool is_profile_below(const char *parent, const char *rest, const char *name) {
    char folder[SF_RUN_PATH_SIZE];
    return parent &&
           snprintf(folder, sizeof folder, "%.*s%s/snakemake/%s", (int)strcspn(parent, ":"), parent, rest,
                    name) < (int)sizeof folder &&
           is_profile(folder);
}

/* True if Snakemake finds the name, which is no path, among the user's profiles or the machine's. */
static bool is_profile_name(const char *name) {
    const char *user = getenv("XDG_CONFIG_HOME"), *machine = getenv("XDG_CONFIG_DIRS");
    return (user && *user ? is_profile_below(user, "", name)
                          : is_profile_below(getenv("HOME"), "/.config", name)) ||
           is_profile_below(machine && *machine ? machine : "/etc/xdg", "", name);
}

static sf_status check_profile(const char *name, sf_error *err) {
    char path[PATH_MAX];
    if (strcmp(name, "slurm") == 0)
        return sf_process_is_in_path("sbatch")
                   ? find_profile(name, path, err)
                   : SF_FAIL(err, SF_ERR_IO,
                             "--profile slurm: Slurm's commands (sbatch) are not installed "
                             "(package slurm-client of Debian)");
    if (is_profile(name) || is_profile_name(name))
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "--profile %s: there is no such profile of Snakemake: neither this folder nor one of this "
                   "name in ~/.config/snakemake or /etc/xdg/snakemake has a config.yaml",
                   name);
}

sf_status sf_engine_check(const sf_runner_engine *engine, sf_error *err) {
    if (sf_engine_is_local(engine) && engine->profile)
        return SF_FAIL(err, SF_ERR_INPUT, "--profile %s: profiles are Snakemake's: add --engine snakemake",
                       engine->profile);
    if (sf_engine_is_local(engine) && engine->per_job > 0)
        return SF_FAIL(err, SF_ERR_INPUT, "--per-job %d: jobs are Snakemake's: add --engine snakemake",
                       engine->per_job);
    if (sf_engine_is_local(engine))
        return SF_OK;
    if (strcmp(engine->name, "snakemake") != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "--engine %s: the engines are local and snakemake", engine->name);
    if (!sf_process_is_in_path("snakemake"))
        return missing(err);
    return engine->profile ? check_profile(engine->profile, err) : SF_OK;
}

static sf_status make_absolute(const char *path, char out[PATH_MAX], sf_error *err) {
    return realpath(path, out) ? SF_OK : SF_FAIL(err, SF_ERR_IO, "%s: %s", path, strerror(errno));
}

/* --nolock: a killed Snakemake would leave its lock, and the campaign has one of its own; groups may be run
 * twice. On SIGTERM it would wait for its jobs, on SIGINT it cancels them: so it is apart. */
sf_status sf_engine_run(const sf_runner_engine *engine, int processors, const char *manifest,
                        void (*tick)(void *context), void *context, int *code, sf_error *err) {
    char snakefile[PATH_MAX], found[PATH_MAX], program[PATH_MAX], file[PATH_MAX], folder[PATH_MAX],
        profile[PATH_MAX], shared[PATH_MAX], share[PATH_MAX], log[SF_RUN_PATH_SIZE], manifest_word[WORD_SIZE],
        program_word[WORD_SIZE], cores[32], threads[48];
    if (sf_engine_check(engine, err) != SF_OK ||
        sf_process_find_shared("Snakefile", snakefile, sizeof snakefile, err) != SF_OK ||
        sf_process_find("softfall-batch", found, sizeof found, err) != SF_OK ||
        make_absolute(found, program, err) != SF_OK || make_absolute(manifest, file, err) != SF_OK ||
        (engine->profile && find_profile(engine->profile, profile, err) != SF_OK))
        return err->status;
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(file, '/') - file), file);
    snprintf(log, sizeof log, "%s/log.txt", folder);
    /* Relative to --directory: Snakemake would read braces and ": " of a folder's name as its own syntax. */
    snprintf(manifest_word, sizeof manifest_word, "manifest=%s", strrchr(file, '/') + 1);
    snprintf(program_word, sizeof program_word, "program=%s", program);
    snprintf(cores, sizeof cores, "%d", processors > 0 ? processors : 1);
    snprintf(threads, sizeof threads, "threads=%d", engine->job_threads > 0 ? engine->job_threads : 1);
    if (sf_process_find_shared("", shared, sizeof shared, err) != SF_OK || !realpath(shared, share) ||
        setenv("SOFTFALL_SHARE", share, 1) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be named", shared);
    const char *words[24] = {"snakemake", "--snakefile", snakefile,      "--directory",
                             folder,      "--nolock",    "--keep-going", "--rerun-incomplete",
                             "--config",  manifest_word, program_word,   threads};
    int n = 12;
    words[n++] = engine->profile ? "--profile" : "--cores";
    words[n++] = engine->profile ? profile : cores;
    const sf_process process = {.arguments = words,
                                .log = log,
                                .stoppable = true,
                                .apart = true,
                                .held = engine->lock,
                                .tick = tick,
                                .context = context};
    int reason = sf_process_run(&process, code);
    if (reason == ENOENT)
        return missing(err);
    if (reason != 0)
        return SF_FAIL(err, SF_ERR_IO, "snakemake cannot be run: %s", strerror(reason));
    return sf_process_stopped() ? sf_run_folder_interrupted(err) : SF_OK;
}

void sf_engine_complaint(const char *log, size_t begin, char *out, size_t size) {
    static const char who[] = "sbatch: ";
    sf_error ignored = SF_ERROR_INIT;
    char *text = NULL, *line;
    size_t length = 0;
    *out = '\0';
    sf_plain_read(log, NULL, SF_PLAIN_TEXT, &text, &length, &ignored);
    for (char *rest = begin < length ? text + begin : NULL; (line = strsep(&rest, "\n"));)
        if (strncmp(line, who, strlen(who)) == 0)
            snprintf(out, size, " (%.300s)", line);
    free(text);
}
