/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/batch.h"

#include "base/hash.h"
#include "base/text.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"
#include "study/run_folder.h"

#include <errno.h>
#include <inttypes.h>
#include <unistd.h>

/* ---- engines ---- */

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
    return SF_REFUSE(err,
                     "--profile %s: there is no such profile of Snakemake: neither this folder nor one of "
                     "this name in ~/.config/snakemake or /etc/xdg/snakemake has a config.yaml",
                     name);
}

sf_status sf_engine_check(const sf_runner_engine *engine, sf_error *err) {
    if (sf_engine_is_local(engine) && engine->profile)
        return SF_REFUSE(err, "--profile %s: profiles are Snakemake's: add --engine snakemake",
                         engine->profile);
    if (sf_engine_is_local(engine) && engine->per_job > 0)
        return SF_REFUSE(err, "--per-job %d: jobs are Snakemake's: add --engine snakemake", engine->per_job);
    if (sf_engine_is_local(engine))
        return SF_OK;
    if (strcmp(engine->name, "snakemake") != 0)
        return SF_REFUSE(err, "--engine %s: the engines are local and snakemake", engine->name);
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
    snprintf(folder, sizeof folder, "%.*s", (int)sf_path_folder_length(file), file);
    snprintf(log, sizeof log, "%s/log.txt", folder);
    /* Relative to --directory: Snakemake would read braces and ": " of a folder's name as its own syntax. */
    snprintf(manifest_word, sizeof manifest_word, "manifest=%s", sf_path_name(file));
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
    SF_OWNED char *text = NULL;
    char *line;
    size_t length = 0;
    *out = '\0';
    sf_plain_read(log, NULL, SF_PLAIN_TEXT, &text, &length, SF_IGNORED);
    for (char *rest = begin < length ? text + begin : NULL; (line = strsep(&rest, "\n"));)
        if (strncmp(line, who, strlen(who)) == 0)
            snprintf(out, size, " (%.300s)", line);
}

/* ---- the manifest ---- */

static const char HEAD[] = "softfall-manifest 1";
enum { MOST_FIELDS = 5 + SF_RUNNER_OVERRIDES };
#define LARGEST (UINT64_C(1) << 32) /* bytes of a manifest: millions of drops */

/* ---- writing ---- */

static sf_status check_text(const char *text, sf_error *err) {
    return !text || !strpbrk(text, "\t\n")
               ? SF_OK
               : SF_REFUSE(err, "a batch cannot hold \"%.200s\": it has a tab or a line end", text);
}

static sf_status check_drop(const sf_runner_drop *drop, sf_error *err) {
    check_text(drop->label, err);
    check_text(drop->case_path, err);
    check_text(drop->material, err);
    for (int k = 0; k < drop->override_count; k++)
        check_text(drop->overrides[k], err);
    return err->status;
}

/* Prints the columns behind the group in the line of a drop. */
static void print_drop(FILE *out, const sf_runner_drop *drop) {
    fprintf(out, "\t%s\t%s\t%s", drop->label, drop->case_path, drop->material ? drop->material : "");
    for (int k = 0; k < drop->override_count; k++)
        fprintf(out, "\t%s", drop->overrides[k]);
    fputc('\n', out);
}

static void name_group(int number, int count, const int *index, const uint64_t *key,
                       char name[SF_MANIFEST_GROUP_SIZE]) {
    uint64_t hash = SF_HASH_START;
    for (int k = 0; k < count; k++)
        hash = sf_hash_bytes(hash, &key[index[k]], sizeof key[index[k]]);
    snprintf(name, SF_MANIFEST_GROUP_SIZE, "%05d-%016" PRIx64, number, hash);
}

sf_status sf_manifest_write(const char *path, const char *runs, int count, const int *index,
                            const sf_runner_drop *drop, const uint64_t *key, int group_size, sf_error *err) {
    char here[SF_PATH_SIZE], group[SF_MANIFEST_GROUP_SIZE] = "";
    sf_replacement file;
    if (!getcwd(here, sizeof here))
        return SF_FAIL(err, SF_ERR_IO, "the present folder is unknown");
    check_text(here, err);
    check_text(runs, err);
    for (int k = 0; k < count; k++)
        check_drop(&drop[index[k]], err);
    if (err->status != SF_OK || !sf_replace_open(path, &file, err))
        return err->status;
    fprintf(file.file, "%s\nfolder\t%s\nruns\t%s\ncount\t%d\n", HEAD, here, runs, count);
    for (int k = 0; k < count; k++) {
        int left = count - k;
        if (k % group_size == 0)
            name_group(k / group_size + 1, left < group_size ? left : group_size, &index[k], key, group);
        fprintf(file.file, "%016" PRIx64 "\t%s", key[index[k]], group);
        print_drop(file.file, &drop[index[k]]);
    }
    return sf_replace_close(&file, err);
}

/* ---- reading ---- */

static bool take_run(char *line, sf_manifest_run *run) {
    char *field[MOST_FIELDS], *end = NULL;
    int n = 0;
    while (line && n < MOST_FIELDS)
        field[n++] = strsep(&line, "\t");
    if (n < 5 || line || strlen(field[0]) != 16 || strlen(field[1]) >= sizeof run->group ||
        strchr(field[1], '/') || !*field[1])
        return false;
    *run = (sf_manifest_run){.key = strtoull(field[0], &end, 16)};
    snprintf(run->group, sizeof run->group, "%s", field[1]);
    run->drop.label = field[2];
    run->drop.case_path = field[3];
    run->drop.material = *field[4] ? field[4] : NULL;
    for (int k = 5; k < n; k++)
        run->drop.overrides[run->drop.override_count++] = field[k];
    return *end == '\0' && !strchr(run->drop.label, '/');
}

sf_status sf_manifest_read(const char *path, sf_manifest *m, sf_error *err) {
    *m = (sf_manifest){0};
    SF_TRY(sf_plain_read(path, "manifest", LARGEST, &m->text, NULL, err));
    char *rest = m->text, *head = strsep(&rest, "\n");
    m->folder = sf_line_take(&rest, "folder", '\t');
    m->runs = sf_line_take(&rest, "runs", '\t');
    const char *count = sf_line_take(&rest, "count", '\t');
    long wanted = count ? strtol(count, NULL, 10) : -1;
    if (strcmp(head, HEAD) != 0 || !m->folder || !m->runs || wanted < 0 || !rest ||
        (size_t)wanted > strlen(rest))
        return SF_REFUSE(err, "%s is not the manifest of a batch", path);
    m->run = sf_alloc(err, wanted, sizeof *m->run, "runs");
    for (; err->status == SF_OK && m->count < wanted; m->count++)
        if (!rest || !take_run(strsep(&rest, "\n"), &m->run[m->count]))
            return SF_REFUSE(err, "%s:%d: this is not the line of a run: the manifest is damaged", path,
                             m->count + 5);
    return err->status;
}

void sf_manifest_free(sf_manifest *m) {
    SF_CLEAR(m, m->run, m->text);
}

int sf_manifest_group_end(const sf_manifest *m, int k) {
    int end = k + 1;
    while (end < m->count && strcmp(m->run[end].group, m->run[k].group) == 0)
        end++;
    return end;
}

/* ---- outcomes ---- */

void sf_manifest_outcome_path(const char *manifest, const char *group, char *path, size_t size) {
    snprintf(path, size, "%.*s%s.done", (int)(sf_path_name(manifest) - manifest), manifest, group);
}

sf_status sf_manifest_write_outcome(const char *path, int count, const sf_manifest_run *run,
                                    const sf_error *failure, sf_error *err) {
    sf_replacement file;
    if (!sf_replace_open(path, &file, err))
        return err->status;
    for (int k = 0; k < count; k++)
        if (failure[k].status != SF_OK)
            fprintf(file.file, "%016" PRIx64 "\t%d\t%s\n", run[k].key, (int)failure[k].status,
                    failure[k].text);
    return sf_replace_close(&file, err);
}

static void take_failure(const char *line, int count, const sf_manifest_run *run, sf_error *failure) {
    uint64_t key = 0;
    int status = 0, begin = 0;
    if (sscanf(line, "%16" SCNx64 "\t%d\t%n", &key, &status, &begin) != 2 || begin == 0 || status <= 0)
        return;
    for (int k = 0; k < count; k++)
        if (run[k].key == key)
            SF_FAIL(&failure[k], (sf_status)status, "%s", line + begin);
}

int sf_manifest_read_outcome(const char *path, int count, const sf_manifest_run *run, sf_error *failure) {
    SF_OWNED char *text = NULL;
    char *line;
    int lines = 0;
    if (!sf_replace_exists(path) ||
        sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, SF_IGNORED) != SF_OK)
        return -1;
    for (char *rest = text; (line = strsep(&rest, "\n")) && rest; lines++)
        take_failure(line, count, run, failure);
    return lines;
}
