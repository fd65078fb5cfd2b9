/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/runner.h"

#include "base/hash.h"
#include "io/folder.h"
#include "io/process.h"
#include <sys/stat.h>

/* A campaign needs the curve and the figures, not the fields. */
static const char *const lean_output[] = {"output.fields=[\"displacement\"]", "output.frame_interval=1000 s"};
enum { LEAN = sizeof lean_output / sizeof lean_output[0] };

/* ---- drops ---- */

/* A drop with its overrides, those of campaigns included, and its folder. */
typedef struct located {
    char material[PATH_MAX + 64];
    int count;
    const char *overrides[SF_RUNNER_OVERRIDES + 1 + LEAN];
    sf_run_folder at;
} located;

static sf_status locate(const sf_runner *runner, const sf_runner_drop *drop, located *l, sf_error *err) {
    l->count = 0;
    if (drop->material) {
        snprintf(l->material, sizeof l->material, "material=@%s", drop->material);
        l->overrides[l->count++] = l->material;
    }
    for (int k = 0; k < drop->override_count; k++)
        l->overrides[l->count++] = drop->overrides[k];
    for (int k = 0; k < LEAN; k++)
        l->overrides[l->count++] = lean_output[k];
    return sf_run_folder_name(runner->folder, drop->label, drop->case_path, l->count, l->overrides, &l->at,
                              err);
}

sf_status sf_runner_find_status(const sf_runner *runner, const sf_runner_drop *drop, sf_runner_state *state,
                                sf_error *failure, sf_error *err) {
    located l;
    SF_TRY(locate(runner, drop, &l, err));
    *state = sf_run_folder_is_finished(&l.at)           ? SF_DROP_DONE
             : sf_run_folder_is_running(&l.at)          ? SF_DROP_RUNNING
             : sf_run_folder_has_failed(&l.at, failure) ? SF_DROP_FAILED
                                                        : SF_DROP_OPEN;
    return SF_OK;
}

const char *sf_runner_state_name(sf_runner_state state) {
    static const char *const names[] = {"open", "running", "done", "failed"};
    return names[state];
}

sf_status sf_runner_key(const sf_runner *runner, const sf_runner_drop *drop, uint64_t *key, sf_error *err) {
    located l;
    if (locate(runner, drop, &l, err) == SF_OK)
        *key = l.at.key;
    return err->status;
}

/* ---- batches ---- */

/* The request of a drop of a batch; small, as there may be very many. */
typedef struct request {
    uint64_t key;
    bool reused;
    uint64_t geometry; /* hash of the folders that the geometries' other files are in */
    int64_t counted;   /* with the next one those of the folder */
    int drops;
    int first; /* the first drop of the batch with the same folder */
} request;

typedef struct batch {
    const sf_runner *runner;
    int count;
    const sf_runner_drop *drop;
    request *request;
    int *pending; /* those that must be simulated */
    int pending_count, threads /* of each */, failed, ended;
    double start, told; /* s */
} batch;

/* Damaged results of unchanged size and time have a record all the same: it goes, and the drop is simulated
 * again. */
static bool is_readable(const sf_run_folder *at) {
    bool readable = true;
    for (int k = 1; k <= at->drops && readable; k++) {
        const sf_run_folder drop = sf_run_folder_of_drop(at, k);
        SF_OWNED_BY(sf_results_close) sf_results r = {0};
        readable = sf_results_open(drop.results, &r, SF_IGNORED) == SF_OK;
        if (!readable)
            sf_folder_remove_file(drop.figures);
    }
    return readable;
}

/* Finds the drop's folder and whether it is finished, or has failed earlier. A drop that its case refuses has
 * failed: the others go on. */
static void prepare(const sf_runner *runner, const sf_runner_drop *drop, request *r, sf_error *failure) {
    located l;
    if (locate(runner, drop, &l, failure) != SF_OK)
        return;
    r->key = l.at.key;
    r->drops = l.at.drops;
    r->counted = l.at.counted;
    r->geometry = SF_HASH_START;
    for (int k = 0; k < SF_GEOMETRIES; k++)
        r->geometry = sf_hash_bytes(r->geometry, l.at.geometry[k], strlen(l.at.geometry[k]) + 1);
    r->reused = sf_run_folder_is_finished(&l.at) && is_readable(&l.at);
    if (r->reused)
        sf_run_folder_clean(&l.at);
    else if (runner->engine.retry)
        sf_folder_remove_file(l.at.failed);
    else
        sf_run_folder_has_failed(&l.at, failure);
}

/* By the process that simulated the drop, so that nobody reads the results of many drops one by one. */
static void record(const sf_run_folder *at) {
    SF_OWNED_BY(sf_runner_result_free) sf_runner_result result = {0};
    sf_runner_read(at, &result, SF_IGNORED);
}

static sf_status simulate(void *context, int index, sf_error *err) {
    const batch *b = context;
    const sf_runner_drop *drop = &b->drop[b->pending[index]];
    located l;
    SF_TRY(locate(b->runner, drop, &l, err));
    if (l.at.key != b->request[b->pending[index]].key)
        return SF_FAIL(err, SF_ERR_IO, "a file that %s leads to " SF_RUNNER_CHANGED "; repeat the command",
                       drop->case_path);
    if (sf_run_folder_simulate(&l.at, drop->case_path, l.count, l.overrides, b->threads, err) == SF_OK)
        record(&l.at);
    return err->status;
}

static int compare(const void *p, const void *q, void *context) {
    const batch *b = context;
    int j = *(const int *)p, k = *(const int *)q;
    uint64_t one = b->request[j].key, other = b->request[k].key;
    int order = one != other ? (one > other) - (one < other) : strcmp(b->drop[j].label, b->drop[k].label);
    return order ? order : j - k;
}

/* The key knows a geometry by its own text. What it merges lies beside it: the same text in two folders may
 * be two geometries, and both would have one folder of results. */
static void refuse_double(const batch *b, int one, int other, sf_error *failure) {
    if (b->request[one].geometry != b->request[other].geometry && failure->status == SF_OK)
        SF_REFUSE(
            failure,
            "the drops %s and %s read geometry files of the same text in different folders: they may merge different files; make a difference in their text, a comment for example",
            b->drop[one].label, b->drop[other].label);
}

/* The drops that are not there, each once, in the order of the batch. */
static void list_pending(batch *b, sf_error *failure) {
    int *order = b->pending; /* its room serves the sorting first */
    for (int k = 0; k < b->count; k++)
        order[k] = k;
    qsort_r(order, (size_t)b->count, sizeof *order, compare, b);
    for (int k = 0; k < b->count; k++) {
        const request *before = k > 0 ? &b->request[order[k - 1]] : NULL;
        bool same = before && before->key == b->request[order[k]].key &&
                    strcmp(b->drop[order[k - 1]].label, b->drop[order[k]].label) == 0;
        b->request[order[k]].first = same ? before->first : order[k];
        if (same)
            refuse_double(b, before->first, order[k], &failure[order[k]]);
    }
    for (int k = 0; k < b->count; k++)
        if (!b->request[k].reused && failure[k].status == SF_OK && b->request[k].first == k)
            b->pending[b->pending_count++] = k;
}

/* The failure that decides: an interruption, another that is not numerical, the first. */
static sf_status decide(int count, const sf_error *failure, sf_error *err) {
    const sf_error *worst = NULL;
    for (int k = 0; k < count; k++) {
        if (failure[k].status == SF_OK)
            continue;
        bool worse = !worst || (worst->status == SF_ERR_NUMERIC && failure[k].status != SF_ERR_NUMERIC) ||
                     (worst->status != SF_INTERRUPTED && failure[k].status == SF_INTERRUPTED);
        worst = worse ? &failure[k] : worst;
    }
    if (worst && worst->status == SF_INTERRUPTED)
        return sf_run_folder_interrupted(err);
    return worst ? SF_FAIL(err, worst->status, "%s", worst->text) : SF_OK;
}

/* Which drop, and what to do about it. */
static void name_killed(const batch *b, sf_error *failure) {
    for (int k = 0; k < b->pending_count; k++) {
        sf_error before = failure[k];
        sf_run_folder at;
        if (strncmp(before.text, SF_PROCESS_KILLED, strlen(SF_PROCESS_KILLED)) != 0)
            continue;
        failure[k] = (sf_error)SF_ERROR_INIT;
        sf_run_folder_name_key(b->runner->folder, b->drop[b->pending[k]].label, b->request[b->pending[k]].key,
                               &at);
        SF_FAIL(&failure[k], before.status,
                "%.500s: %.400s; finished drops are kept: run the same command again to resume", at.path,
                before.text);
    }
}

/* Returns the number of drops that run side by side; warns where that is not the number that was asked
 * for. */
static int count_abreast(const sf_runner *runner, int pending) {
    int jobs = runner->jobs > 0 ? runner->jobs : runner->threads, most = SF_PROCESS_JOBS;
    int abreast = jobs < most ? jobs : most;
    abreast = pending < abreast ? pending : abreast;
    if (runner->log && runner->simulated == 0 && abreast < jobs && abreast < pending)
        fprintf(runner->log, "  %d drops side by side, not %d: no more are possible\n", abreast, jobs);
    if (runner->log && runner->simulated == 0 && abreast > runner->threads)
        fprintf(runner->log, "  %d drops side by side, one thread each: more than %d thread%s together\n",
                abreast, runner->threads, runner->threads > 1 ? "s" : "");
    return abreast;
}

/* The time that is left at the pace so far. */
static void tell_pace(const batch *b, int ended) {
    double spent = sf_process_now() - b->start, left = spent / ended * (b->pending_count - ended);
    sf_log_print(b->runner->log, "  %d of %d drops, %d failed, %.3g drops per hour, %d h %02d min to go\n",
                 ended, b->pending_count, b->failed, 3600 * ended / spent, (int)(left / 3600),
                 (int)fmod(left / 60, 60));
}

/* A line every ten seconds. */
static void tell_progress(void *context, int index, int ended, const sf_error *result) {
    enum { EVERY = 10 };
    batch *b = context;
    double time = sf_process_now();
    (void)index;
    b->failed += result->status != SF_OK;
    if (!b->runner->log || time < b->told + EVERY || ended == b->pending_count)
        return;
    b->told = time;
    tell_pace(b, ended);
}

/* One drop alone has all threads and needs no process of its own. `failure` by the pending ones. */
static sf_status simulate_here(batch *b, sf_error *failure, sf_error *err) {
    int threads = b->runner->threads, abreast = count_abreast(b->runner, b->pending_count);
    b->threads = threads > abreast ? threads / abreast : 1;
    b->start = b->told = sf_process_now();
    if (b->pending_count == 1)
        simulate(b, 0, failure);
    else if (sf_process_pool(b->pending_count, abreast, simulate, tell_progress, b, failure, err) == SF_OK)
        name_killed(b, failure);
    return err->status;
}

/* Reads the results of the engine: a drop without results and without a sentence was not run to its end.
 * `complaint`: that of the engine. */
static void look_again(const batch *b, const sf_manifest *m, const char *manifest, int code,
                       const char *complaint, sf_error *failure) {
    char path[SF_RUN_PATH_SIZE];
    for (int k = 0, last; k < m->count; k = last) {
        last = sf_manifest_group_end(m, k);
        sf_manifest_outcome_path(manifest, m->run[k].group, path, sizeof path);
        int known = sf_manifest_read_outcome(path, last - k, &m->run[k], &failure[k]);
        for (int j = k; j < last && known < 0; j++) {
            located l;
            if (locate(b->runner, &m->run[j].drop, &l, &failure[j]) == SF_OK &&
                !sf_run_folder_is_finished(&l.at))
                SF_FAIL(
                    &failure[j], SF_ERR_IO,
                    "snakemake (exit code %d) left the drop in %.300s undone%s; see %.300s/" SF_MANIFEST_FOLDER
                    "/log.txt; run the same command again to resume",
                    code, l.at.path, complaint, b->runner->folder);
        }
        sf_folder_remove_file(path);
    }
}

typedef struct elsewhere {
    batch *b;
    const sf_manifest *m;
    const char *manifest;
} elsewhere;

/* The drops of the groups that have ended, if there are more than the last time. */
static void tell_groups(void *context) {
    const elsewhere *e = context;
    batch *b = e->b;
    char path[SF_RUN_PATH_SIZE];
    int ended = 0;
    b->failed = 0;
    for (int k = 0, last; k < e->m->count; k = last) {
        last = sf_manifest_group_end(e->m, k);
        sf_manifest_outcome_path(e->manifest, e->m->run[k].group, path, sizeof path);
        int failed = sf_manifest_read_outcome(path, 0, NULL, NULL);
        ended += failed >= 0 ? last - k : 0;
        b->failed += failed > 0 ? failed : 0;
    }
    if (ended > b->ended && ended < b->pending_count)
        tell_pace(b, ended);
    b->ended = ended;
}

/* By the engine, group by group. `failure` by the pending ones. */
static sf_status simulate_elsewhere(batch *b, sf_error *failure, sf_error *err) {
    const sf_runner *runner = b->runner;
    char folder[SF_RUN_PATH_SIZE], path[SF_RUN_PATH_SIZE + 32], log[SF_RUN_PATH_SIZE + 32], complaint[320];
    struct stat before = {0}; /* of the log, which goes on */
    SF_OWNED_BY(sf_manifest_free) sf_manifest m = {0};
    SF_OWNED uint64_t *key = sf_alloc(err, b->count, sizeof *key, "keys");
    int code = 0, size = runner->engine.per_job > 0 ? runner->engine.per_job : 1;
    for (int k = 0; key && k < b->count; k++)
        key[k] = b->request[k].key;
    snprintf(folder, sizeof folder, "%s/" SF_MANIFEST_FOLDER, runner->folder);
    snprintf(path, sizeof path, "%s/" SF_MANIFEST_NAME, folder);
    snprintf(log, sizeof log, "%s/log.txt", folder);
    if (err->status == SF_OK && sf_folder_own(folder, err) == SF_OK &&
        sf_manifest_write(path, runner->folder, b->pending_count, b->pending, b->drop, key, size, err) ==
            SF_OK &&
        sf_manifest_read(path, &m, err) == SF_OK) {
        for (int k = 0; k < m.count; k = sf_manifest_group_end(&m, k)) {
            char outcome[SF_RUN_PATH_SIZE]; /* of an earlier try: what it says is not so */
            sf_manifest_outcome_path(path, m.run[k].group, outcome, sizeof outcome);
            sf_folder_remove_file(outcome);
        }
        sf_log_print(runner->log, "  %d drops in jobs of %d by snakemake; its words are in %s\n",
                     b->pending_count, size, log);
        elsewhere watched = {b, &m, path};
        b->start = sf_process_now();
        stat(log, &before);
        if (sf_engine_run(&runner->engine, runner->threads, path, runner->log ? tell_groups : NULL, &watched,
                          &code, err) == SF_OK) {
            sf_engine_complaint(log, (size_t)before.st_size, complaint, sizeof complaint);
            look_again(b, &m, path, code, complaint, failure);
        }
    }
    return err->status;
}

static sf_status simulate_pending(batch *b, sf_error *failure, sf_error *err) {
    if (b->pending_count == 0)
        return SF_OK;
    SF_TRY(sf_folder_own(b->runner->folder, err));
    SF_OWN(sf_error, own, b->pending_count, "failures", err);
    for (int k = 0; k < b->pending_count; k++)
        own[k] = (sf_error)SF_ERROR_INIT;
    if (sf_engine_is_local(&b->runner->engine))
        simulate_here(b, own, err);
    else
        simulate_elsewhere(b, own, err);
    for (int k = 0; k < b->pending_count && err->status == SF_OK; k++)
        failure[b->pending[k]] = own[k];
    return err->status;
}

static sf_status take_result(sf_runner *runner, const sf_runner_drop *drop, const request *r,
                             sf_runner_result *result, sf_error *err) {
    sf_run_folder at;
    sf_run_folder_name_key(runner->folder, drop->label, r->key, &at);
    at.drops = drop->number > 0 ? drop->number : r->drops;
    at.counted = drop->number > 0 ? (int64_t)1 << (drop->number - 1) : r->counted;
    SF_TRY(sf_runner_read(&at, result, err));
    sf_run_counted_text(r->drops, at.counted, result->counted, sizeof result->counted);
    result->reused = r->reused;
    *(r->reused ? &runner->reused : &runner->simulated) += 1;
    sf_log_print(runner->log,
                 "  %-24s %7.4g m/s  a_max %7.2f g  HIC %7.1f  largest local strain %.3f%s%s%s\n",
                 drop->label, result->v0, result->a_max_g, result->hic, result->max_local_strain,
                 *result->counted ? "  " : "", result->counted, result->reused ? "  (was there)" : "");
    return SF_OK;
}

/* `b` holds runner, count and drop; its requests are the caller's to free. */
static sf_status run_held(batch *b, sf_error *failure, sf_error *err) {
    SF_ALLOC_ALL(err, "drops", SF_ROOM(b->request, b->count), SF_ROOM(b->pending, b->count));
    for (int k = 0; k < b->count; k++)
        failure[k] = (sf_error)SF_ERROR_INIT;
    if (err->status == SF_OK)
        sf_engine_check(&b->runner->engine, err);
    for (int k = 0; k < b->count && err->status == SF_OK; k++)
        prepare(b->runner, &b->drop[k], &b->request[k], &failure[k]);
    if (err->status == SF_OK && sf_process_stopped())
        sf_run_folder_interrupted(err);
    if (err->status == SF_OK) {
        list_pending(b, failure);
        simulate_pending(b, failure, err);
    }
    for (int k = 0; k < b->count && err->status == SF_OK; k++) {
        if (failure[k].status == SF_OK)
            failure[k] = failure[b->request[k].first];
        if (failure[k].status == SF_INTERRUPTED)
            sf_run_folder_interrupted(err);
    }
    return err->status;
}

sf_status sf_runner_run_each(sf_runner *runner, int count, const sf_runner_drop *drop,
                             sf_runner_result *result, sf_error *failure, sf_error *err) {
    batch b = {.runner = runner, .count = count, .drop = drop};
    if (result)
        memset(result, 0, (size_t)count * sizeof *result);
    if (sf_units_hold(err) == SF_OK) {
        run_held(&b, failure, err);
        sf_units_let_go();
    }
    for (int k = 0; k < count && result && err->status == SF_OK; k++)
        if (failure[k].status == SF_OK)
            take_result(runner, &drop[k], &b.request[k], &result[k], &failure[k]);
    SF_FREE(b.request, b.pending);
    return err->status;
}

sf_status sf_runner_run_batch(sf_runner *runner, int count, const sf_runner_drop *drop,
                              sf_runner_result *result, sf_error *err) {
    SF_OWNED sf_error *failure = sf_alloc(err, count, sizeof *failure, "failures");
    memset(result, 0, (size_t)count * sizeof *result);
    if (failure && sf_runner_run_each(runner, count, drop, result, failure, err) == SF_OK)
        decide(count, failure, err);
    return err->status;
}

sf_status sf_runner_run(sf_runner *runner, const sf_runner_drop *drop, sf_runner_result *result,
                        sf_error *err) {
    return sf_runner_run_batch(runner, 1, drop, result, err);
}
