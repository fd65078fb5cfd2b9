/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/run_folder.h"

#include "base/hash.h"
#include "base/text.h"
#include "build_info.h"
#include "case/read.h"
#include "io/folder.h"
#include "io/h5_data.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"
#include "material/laws.h"
#include "pre/mesh/mesh_store.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- figures of a finished drop ---- */

#define HEAD "softfall-drop-figures 1 " SF_VERSION " " SF_GIT_REVISION
enum { END_SIZE = 21 }; /* "end 0123456789abcdef\n" */

/* ---- writing ---- */

/* "size second nanosecond" of the file; false: it is not there. */
static bool describe_results(const char *results, char text[80]) {
    struct stat info;
    if (stat(results, &info) != 0)
        return false;
    snprintf(text, 80, "%" PRId64 " %" PRId64 " %ld", (int64_t)info.st_size, (int64_t)info.st_mtim.tv_sec,
             info.st_mtim.tv_nsec);
    return true;
}

static void put_figures(FILE *out, const sf_results *r, const sf_figures *f) {
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        if (sf_figure_at[k].row.type != SF_ROW_TEXT)
            fprintf(out, "%s %a\n", sf_figure_at[k].row.key, sf_figure_number(&sf_figure_at[k], r, f));
}

/* Not synchronised with the disk: the end says whether it is whole. */
static void keep(const char *path, const char *text, size_t length) {
    sf_folder_remove_file(path);
    FILE *file = sf_replace_create(path, SF_IGNORED);
    if (!file)
        return;
    fwrite(text, 1, length, file);
    fprintf(file, "end %016" PRIx64 "\n", sf_hash_bytes(SF_HASH_START, text, length));
    fclose(file);
}

void sf_run_record_write(const char *path, const char *results, const sf_results *r, const sf_figures *f,
                         sf_grade grade, const char *verdict, const char *geometry) {
    char of[80] = "";
    SF_TEXT_STREAM(out, text, length);
    if (!out)
        return;
    bool there = describe_results(results, of) && !strchr(verdict, '\n') && !strchr(r->status, '\n');
    fprintf(out, "%s\nresults %s\ngrade %d\nverdict %s\nstatus %s\n", HEAD, of, (int)grade, verdict,
            r->status);
    put_figures(out, r, f);
    fprintf(out, "geometry\n%s", geometry);
    if (fclose(out) == 0 && there)
        keep(path, text, length);
    free(text);
}

/* ---- reading ---- */

/* Takes the last line away. */
static bool is_whole(char *text, size_t length) {
    uint64_t hash = 0;
    if (length < END_SIZE || sscanf(text + length - END_SIZE, "end %16" SCNx64, &hash) != 1)
        return false;
    length -= END_SIZE;
    text[length] = '\0';
    return hash == sf_hash_bytes(SF_HASH_START, text, length);
}

static bool take_figures(char **rest, sf_run_record *out) {
    out->figure = sf_alloc(SF_IGNORED, SF_FIGURE_TOTAL, sizeof *out->figure, "figures");
    for (size_t k = 0; out->figure && k < SF_FIGURE_TOTAL; k++) {
        char *end = NULL;
        const char *value =
            sf_figure_at[k].row.type == SF_ROW_TEXT ? NULL : sf_line_take(rest, sf_figure_at[k].row.key, ' ');
        if (sf_figure_at[k].row.type != SF_ROW_TEXT && !value)
            return false;
        out->figure[k] = value ? strtod(value, &end) : NAN;
        if (value && (end == value || *end))
            return false;
    }
    return out->figure != NULL;
}

static bool take(char *rest, const char *results, sf_run_record *out) {
    char now[80];
    const char *head = strsep(&rest, "\n"), *of = sf_line_take(&rest, "results", ' '),
               *grade = sf_line_take(&rest, "grade", ' ');
    out->verdict = sf_line_take(&rest, "verdict", ' ');
    out->status = sf_line_take(&rest, "status", ' ');
    if (strcmp(head, HEAD) != 0 || !of || !describe_results(results, now) || strcmp(of, now) != 0 || !grade ||
        !out->verdict || !out->status || !take_figures(&rest, out))
        return false;
    const char *geometry = rest ? strsep(&rest, "\n") : NULL;
    out->grade = (sf_grade)atoi(grade);
    out->geometry = rest;
    return geometry && strcmp(geometry, "geometry") == 0 && rest && out->grade <= SF_GRADE_DO_NOT_USE;
}

bool sf_run_record_read(const char *path, const char *results, sf_run_record *out) {
    size_t length = 0;
    *out = (sf_run_record){0};
    return sf_replace_exists(path) &&
           sf_plain_read(path, NULL, SF_PLAIN_TEXT, &out->text, &length, SF_IGNORED) == SF_OK &&
           is_whole(out->text, length) && take(out->text, results, out);
}

void sf_run_record_free(sf_run_record *record) {
    SF_CLEAR(record, record->figure, record->text);
}

/* ---- the folder of a drop ---- */

static sf_status hash_file(uint64_t *hash, const char *path, sf_error *err) {
    uint64_t content = 0;
    if (sf_plain_hash_kept(path, &content, err) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
    return err->status;
}

/* The programs that simulate a drop. */
static sf_status hash_programs(uint64_t *hash, sf_error *err) {
    char path[3][PATH_MAX];
    if (sf_process_find("softfall-pre", path[0], PATH_MAX, err) == SF_OK &&
        sf_process_find("softfall-solve", path[1], PATH_MAX, err) == SF_OK)
        sf_mesher_find(path[2], PATH_MAX, err);
    for (int k = 0; k < 3 && err->status == SF_OK; k++)
        hash_file(hash, path[k], err);
    return err->status;
}

sf_status sf_campaign_key(const sf_case *c, uint64_t *hash, sf_error *err) {
    SF_TRY(sf_case_check_memory(c, err));
    *hash = sf_case_hash(c);
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        if (sf_case_geometry(c, k)->path)
            hash_file(hash, sf_case_geometry(c, k)->path, err);
    return err->status == SF_OK ? hash_programs(hash, err) : err->status;
}

char *sf_campaign_geometry_list(const char *path, const char *text) {
    sf_error none = SF_ERROR_INIT;
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    char *files = NULL;
    if (sf_h5_open(path, &file, &none) == SF_OK && sf_h5_exists(file, text))
        sf_h5_read_text(file, text, &files, &none);
    return files;
}

enum { MAX_ARGUMENTS = 64 };

/* The folder of a file; "" of none. */
static sf_status name_folder(const char *path, char out[PATH_MAX], sf_error *err) {
    size_t length = path ? sf_path_folder_length(path) : 0;
    const char *folder = length > 0 ? path : path ? "." : "";
    return sf_path_print(out, PATH_MAX, err, "%.*s", length > 0 ? (int)length : 1, folder);
}

void sf_run_folder_name_key(const char *parent, const char *label, uint64_t key, sf_run_folder *at) {
    *at = (sf_run_folder){.key = key, .drops = 1, .counted = 1};
    snprintf(at->path, sizeof at->path, "%s/%s-%016llx", parent, label, (unsigned long long)key);
    snprintf(at->model, sizeof at->model, "%s/model.h5", at->path);
    snprintf(at->results, sizeof at->results, "%s/results.h5", at->path);
    snprintf(at->checkpoint, sizeof at->checkpoint, "%s/results.h5.restart", at->path);
    snprintf(at->log, sizeof at->log, "%s/log.txt", at->path);
    snprintf(at->failed, sizeof at->failed, "%s/failed.txt", at->path);
    snprintf(at->figures, sizeof at->figures, "%s/figures.txt", at->path);
}

sf_run_folder sf_run_folder_of_drop(const sf_run_folder *at, int drop) {
    sf_run_folder out = *at;
    sf_model_series_file(at->model, drop, out.model, sizeof out.model);
    sf_model_series_file(at->results, drop, out.results, sizeof out.results);
    snprintf(out.checkpoint, sizeof out.checkpoint, "%.*s.restart", SF_RUN_PATH_SIZE - 9, out.results);
    if (drop > 1)
        snprintf(out.figures, sizeof out.figures, "%s/figures-%d.txt", at->path, drop);
    return out;
}

void sf_run_counted_text(int drops, int64_t counted, char *text, size_t size) {
    bool many = (counted & (counted - 1)) != 0;
    *text = '\0';
    for (int k = 0, before = 0; k < drops && drops > 1; k++)
        if (counted >> k & 1)
            sf_text_add(text, size, "%s%d", before++ ? ", " : many ? "the mean of drops " : "drop ", k + 1);
    if (drops > 1)
        sf_text_add(text, size, " of %d", drops);
}

sf_status sf_run_folder_name(const char *parent, const char *label, const char *case_path, int count,
                             const char *const *overrides, sf_run_folder *at, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    uint64_t key = 0;
    SF_TRY(sf_case_read(case_path, count, overrides, NULL, &c, err));
    sf_campaign_key(&c, &key, err);
    sf_run_folder_name_key(parent, label, key, at);
    at->drops = (int)c.drops;
    at->counted = c.counted;
    for (int k = 0; k < SF_GEOMETRIES && err->status == SF_OK; k++)
        name_folder(sf_case_geometry(&c, k)->path, at->geometry[k], err);
    return err->status;
}

/* True if every file of the list of what the geometries read (docs/formats.md, geometry_files) has the
 * content that it had. */
static bool are_files_same(const sf_run_folder *at, const char *files) {
    const char *folder[SF_GEOMETRIES];
    for (int k = 0; k < SF_GEOMETRIES; k++)
        folder[k] = at->geometry[k];
    return sf_geometry_files_are_same(folder, files);
}

/* The same by the list at `text` of the HDF5 file `path`; `unlisted` if there is no such list. */
static bool is_geometry_same(const sf_run_folder *at, const char *path, const char *text, bool unlisted) {
    SF_OWNED char *files = sf_campaign_geometry_list(path, text);
    return files ? are_files_same(at, files) : unlisted;
}

/* By the record of its figures: only of a drop that ran to its end. */
static bool is_recorded(const sf_run_folder *at) {
    SF_OWNED_BY(sf_run_record_free) sf_run_record record = {0};
    return sf_run_record_read(at->figures, at->results, &record) && are_files_same(at, record.geometry);
}

static bool is_drop_finished(const sf_run_folder *at) {
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    if (is_recorded(at))
        return true;
    if (access(at->results, R_OK) != 0 || sf_results_open(at->results, &r, SF_IGNORED) != SF_OK)
        return false;
    bool finished = strcmp(r.status, "finished") == 0 || strcmp(r.status, "rebound") == 0;
    return finished && is_geometry_same(at, at->results, "/provenance/model/geometry_files", false);
}

/* Returns the first drop, from 1, that did not run to its end; 0: there is none. */
static int find_unfinished(const sf_run_folder *at) {
    for (int k = 1; k <= at->drops; k++) {
        const sf_run_folder drop = sf_run_folder_of_drop(at, k);
        if (!is_drop_finished(&drop))
            return k;
    }
    return 0;
}

bool sf_run_folder_is_finished(const sf_run_folder *at) {
    return find_unfinished(at) == 0;
}

/* ---- failures ---- */

/* failed.txt: the status, the sentence, the list of what the geometry read (geometry_files). */
static void keep_failure(const sf_run_folder *at, const char *files, const sf_error *failure) {
    sf_replacement text;
    sf_error none = SF_ERROR_INIT;
    if (!sf_replace_open(at->failed, &text, &none))
        return;
    fprintf(text.file, "%d\n%s\n%s", (int)failure->status, failure->text, files);
    sf_replace_close(&text, &none);
}

bool sf_run_folder_has_failed(const sf_run_folder *at, sf_error *failure) {
    SF_OWNED char *text = NULL;
    if (access(at->failed, R_OK) != 0 ||
        sf_plain_read(at->failed, NULL, SF_PLAIN_TEXT, &text, NULL, SF_IGNORED) != SF_OK)
        return false;
    char *rest = text, *status = strsep(&rest, "\n"), *sentence = rest ? strsep(&rest, "\n") : NULL;
    bool failed = rest && atoi(status) == SF_ERR_NUMERIC && are_files_same(at, rest);
    if (failed)
        SF_FAIL(failure, SF_ERR_NUMERIC, "%s", sentence);
    return failed;
}

/* The last line of a log that says something, for an error's sentence. */
static void last_line(const char *path, char *out, size_t size) {
    SF_OWNED char *text = NULL;
    char *line;
    snprintf(out, size, "it said nothing");
    sf_plain_read(path, NULL, SF_PLAIN_TEXT, &text, NULL, SF_IGNORED);
    for (char *rest = text; rest && (line = strsep(&rest, "\n"));)
        if (*line)
            snprintf(out, size, "%s", line);
}

sf_status sf_run_folder_interrupted(sf_error *err) {
    return SF_FAIL(err, SF_INTERRUPTED,
                   "interrupted; finished drops are kept: run the same command again to resume");
}

/* Runs a program with its words appended to `log`; its exit code decides. `held`: the lock of the folder,
 * which it keeps, so that a campaign that was killed leaves it locked between the drops of a series. */
static sf_status run_program(const char *const *arguments, const char *log, const int *held, sf_error *err) {
    const sf_process process = {.arguments = arguments, .log = log, .stoppable = true, .held = held};
    int code = 0, reason = sf_process_run(&process, &code);
    if (reason != 0)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be run: %s", arguments[0], strerror(reason));
    if (code == 0)
        return SF_OK;
    if (sf_process_stopped() || code == SF_INTERRUPTED || code == 128 + SIGTERM)
        return sf_run_folder_interrupted(err);
    if (code == 128 + SIGKILL) /* by the kernel without memory, or by somebody: no fault of the drop */
        return SF_FAIL(err, SF_ERR_LIBRARY, SF_PROCESS_KILLED " %d (see %s)", SIGKILL, log);
    char said[800];
    last_line(log, said, sizeof said);
    if (code == 126 || code == 127) /* of the loader: a library is missing here, for every drop */
        return SF_FAIL(err, SF_ERR_IO, "%s does not start: %s (exit code %d; see %s)", arguments[0], said,
                       code, log);
    return SF_FAIL(err, code <= SF_ERR_LIBRARY ? (sf_status)code : SF_ERR_LIBRARY,
                   "%s (exit code %d; see %s)", said, code, log);
}

/* The folder of a run is locked (solver/run/output.c). */
bool sf_run_folder_is_running(const sf_run_folder *at) {
    bool locked = false;
    for (int k = 1; k <= at->drops && !locked; k++) {
        const sf_run_folder drop = sf_run_folder_of_drop(at, k);
        SF_PRINTED(folder, SF_RUN_PATH_SIZE + 8, "%s.run", drop.results);
        int handle = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        locked = handle >= 0 && flock(handle, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
        if (handle >= 0)
            close(handle); /* and the lock with it */
    }
    return locked;
}

/* A campaign that was killed may have left its solver at work: its drop is waited for. */
static sf_status wait_for_orphan(const sf_run_folder *at, sf_error *err) {
    const struct timespec pause = {0, 100000000};
    while (!sf_process_stopped() && sf_run_folder_is_running(at))
        nanosleep(&pause, NULL);
    return sf_process_stopped() ? sf_run_folder_interrupted(err) : SF_OK;
}

/* Resumes a drop of which a model, whole because softfall-pre moves it into its place, and perhaps a
 * checkpoint are there. False if there is none or it cannot be resumed: then the drop starts anew. */
static bool resume(const char *const *run, const char *const *restart, const sf_run_folder *at,
                   const int *held, sf_error *err) {
    sf_error trial = SF_ERROR_INIT;
    if (access(at->model, R_OK) != 0 || !is_geometry_same(at, at->model, "/provenance/geometry_files", true))
        return false;
    run_program(access(at->checkpoint, R_OK) == 0 ? restart : run, at->log, held, &trial);
    if (trial.status != SF_OK && trial.status != SF_INTERRUPTED && trial.status != SF_ERR_NUMERIC &&
        !strstr(trial.text, SF_PROCESS_KILLED))
        return false;
    if (trial.status != SF_OK)
        SF_FAIL(err, trial.status, "%s", trial.text);
    return true;
}

void sf_run_folder_clean(const sf_run_folder *at) {
    for (int k = 1; k <= at->drops; k++) {
        const sf_run_folder drop = sf_run_folder_of_drop(at, k);
        sf_folder_remove_file(drop.model);
        sf_folder_remove_file(drop.checkpoint);
    }
}

/* Says which drop of a series failed: those before it ran to their end. */
static void name_failed_drop(const sf_run_folder *at, sf_error *err) {
    const sf_error before = *err;
    if (at->drops == 1 || err->status != SF_ERR_NUMERIC)
        return;
    *err = (sf_error)SF_ERROR_INIT;
    SF_FAIL(err, before.status, "drop %d of %d: %.900s", find_unfinished(at), at->drops, before.text);
}

static sf_status simulate(const sf_run_folder *at, const char *case_path, int count,
                          const char *const *overrides, int threads, const int *held, sf_error *err) {
    char pre[PATH_MAX], solve[PATH_MAX], thread_text[16], share[SF_RUN_PATH_SIZE];
    const char *build[MAX_ARGUMENTS] = {pre,       case_path, "-o",  at->model,
                                        "--force", "--share", share, "--estimate"};
    assert(8 + 2 * count < MAX_ARGUMENTS);
    int n = 8;
    snprintf(share, sizeof share, "%.*s" SF_RUN_SHARED, (int)(strrchr(at->path, '/') + 1 - at->path),
             at->path);
    for (int k = 0; k < count; k++) {
        bool last = true; /* a factor comes after the value of the plan that it replaces */
        for (int later = k + 1; later < count && last; later++)
            last = !sf_text_contradicts(overrides[k], overrides[later]);
        build[n] = "--set";
        build[n + 1] = overrides[k];
        n += last ? 2 : 0;
    }
    snprintf(thread_text, sizeof thread_text, "%d", threads);
    const char *run[] = {solve, at->model, "-o", at->results, "--force", "-t", thread_text, NULL};
    const char *restart[] = {solve, "--restart", at->results, at->model, "-t", thread_text, NULL};
    SF_TRY(sf_process_find("softfall-pre", pre, sizeof pre, err));
    SF_TRY(sf_process_find("softfall-solve", solve, sizeof solve, err));
    SF_TRY(wait_for_orphan(at, err));
    if (!sf_run_folder_is_finished(at) && !resume(run, restart, at, held, err) &&
        wait_for_orphan(at, err) == SF_OK &&
        !sf_run_folder_is_finished(at)) { /* it may have begun meanwhile */
        sf_folder_remove_file(at->log);
        sf_folder_remove_file(at->model); /* the failure of softfall-pre is none of an earlier model */
        if (run_program(build, at->log, held, err) == SF_OK)
            run_program(run, at->log, held, err);
    }
    name_failed_drop(at, err);
    if (err->status == SF_ERR_NUMERIC && access(at->model, R_OK) == 0) {
        SF_OWNED char *files = sf_campaign_geometry_list(at->model, "/provenance/geometry_files");
        if (files)
            keep_failure(at, files, err);
    }
    bool resumes = err->status == SF_INTERRUPTED || strstr(err->text, SF_PROCESS_KILLED);
    if (!resumes)
        sf_run_folder_clean(at);
    return err->status;
}

/* A scheduler may start a job again whose first process has not ended yet: one of them waits for the other.
 */
sf_status sf_run_folder_simulate(const sf_run_folder *at, const char *case_path, int count,
                                 const char *const *overrides, int threads, sf_error *err) {
    int lock = -1;
    SF_TRY(sf_folder_own(at->path, err));
    if (sf_folder_wait_lock(at->path, &lock))
        simulate(at, case_path, count, overrides, threads, &lock, err);
    else
        sf_run_folder_interrupted(err);
    if (lock >= 0)
        close(lock);
    return err->status;
}
