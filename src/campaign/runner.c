/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "campaign/runner.h"

#include "campaign/run_folder.h"
#include "io/folder.h"
#include "io/process.h"
#include "post/figures.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { MATERIAL_SIZE = PATH_MAX + 64 };

/* A campaign needs the curve and the figures, not the fields. */
static const char *const lean_output[] = {"output.fields=[\"displacement\"]", "output.frame_interval=1000 s"};
enum { LEAN = sizeof lean_output / sizeof lean_output[0] };

/* Every override of the drop, ours included; `material` is the buffer of the first. */
static int list_overrides(const sf_runner_drop *drop, char *material, const char **list) {
    int count = 0;
    if (drop->material) {
        snprintf(material, MATERIAL_SIZE, "material=@%s", drop->material);
        list[count++] = material;
    }
    for (int k = 0; k < drop->override_count; k++)
        list[count++] = drop->overrides[k];
    for (int k = 0; k < LEAN; k++)
        list[count++] = lean_output[k];
    return count;
}

static sf_status result_path(const char *path, sf_runner_result *out, sf_error *err) {
    out->path = strdup(path);
    if (!out->path) {
        sf_runner_result_free(out);
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    }
    return SF_OK;
}

static void judge(const sf_results *r, const sf_figures *f, sf_runner_result *out) {
    sf_verdict verdict;
    const sf_limits limits = SF_DEFAULT_LIMITS; /* no part of the grade */
    sf_verdict_compute(r, f, &limits, &verdict);
    out->grade = verdict.grade;
    sf_verdict_line(&verdict, out->verdict, sizeof out->verdict);
}

static sf_status take_layers(const sf_results *r, const sf_figures *f, sf_runner_result *out, sf_error *err) {
    if (r->layer_count == 0 || !f->layers)
        return SF_OK;
    out->layer_strain = sf_alloc(err, (unsigned long)r->layer_count, sizeof *out->layer_strain, "layers");
    if (!out->layer_strain)
        sf_runner_result_free(out);
    else
        out->layer_count = r->layer_count;
    for (int k = 0; k < out->layer_count; k++)
        out->layer_strain[k] = f->layers[k].max_local_strain;
    return err->status;
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
                                  .hic_window = f.injury.hic.t2 - f.injury.hic.t1,
                                  .contact_time = f.rebound_time - r.contact_time,
                                  .v0 = f.v0,
                                  .v_rebound = f.v_rebound,
                                  .max_indentation = f.max_indentation,
                                  .max_local_strain = f.max_local_strain,
                                  .energy_error = f.energy_error,
                                  .nodes = r.node_count,
                                  .steps = r.steps,
                                  .curve = f.filtered};
        judge(&r, &f, out);
        f.filtered = (sf_series){0};
        if (take_layers(&r, &f, out, err) == SF_OK)
            result_path(path, out, err);
    }
    sf_figures_free(&f);
    sf_results_close(&r);
    return err->status;
}

/* ---- batches ---- */

/* A drop of a batch, with its overrides and its folder. */
typedef struct request {
    const sf_runner_drop *drop;
    char material[MATERIAL_SIZE];
    int count;
    const char *overrides[SF_RUNNER_OVERRIDES + 1 + LEAN];
    sf_run_folder at;
    bool reused;
} request;

typedef struct batch {
    const sf_runner *runner;
    request *request;
    int *pending; /* those that must be simulated */
    int threads;  /* of each */
} batch;

static sf_status prepare(const sf_runner *runner, const sf_runner_drop *drop, request *r, sf_error *err) {
    r->drop = drop;
    r->count = list_overrides(drop, r->material, r->overrides);
    if (sf_run_folder_name(runner->folder, drop->label, drop->case_path, r->count, r->overrides, &r->at,
                           err) == SF_OK)
        r->reused = sf_run_folder_is_finished(&r->at);
    if (r->reused)
        sf_run_folder_clean(&r->at);
    return err->status;
}

static sf_status simulate(void *context, int index, sf_error *err) {
    const batch *b = context;
    const request *r = &b->request[b->pending[index]];
    return sf_run_folder_simulate(&r->at, r->drop->case_path, r->count, r->overrides, b->threads, err);
}

/* The drops that are not there, each once. */
static int list_pending(batch *b, int count) {
    int pending = 0;
    for (int k = 0; k < count; k++) {
        bool twice = b->request[k].reused;
        for (int j = 0; j < k && !twice; j++)
            twice = strcmp(b->request[j].at.path, b->request[k].at.path) == 0;
        if (!twice)
            b->pending[pending++] = k;
    }
    return pending;
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
static void name_killed(const batch *b, int pending, sf_error *failure) {
    for (int k = 0; k < pending; k++) {
        sf_error before = failure[k];
        if (strncmp(before.text, SF_PROCESS_KILLED, strlen(SF_PROCESS_KILLED)) != 0)
            continue;
        failure[k] = (sf_error)SF_ERROR_INIT;
        SF_FAIL(&failure[k], before.status,
                "%.700s: %.100s; finished drops are kept: run the same command again to resume",
                b->request[b->pending[k]].at.path, before.text);
    }
}

/* How many drops run side by side; says where that is not what was asked for. */
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

/* One drop alone has all threads and needs no process of its own. `failure` by the request. */
static sf_status simulate_pending(batch *b, int pending, sf_error *failure, sf_error *err) {
    if (pending == 0)
        return SF_OK;
    int threads = b->runner->threads, abreast = count_abreast(b->runner, pending);
    b->threads = threads > abreast ? threads / abreast : 1;
    if (sf_folder_own(b->runner->folder, err) != SF_OK)
        return err->status;
    sf_error *own = sf_alloc(err, (unsigned long)pending, sizeof *own, "failures");
    if (own && pending == 1)
        simulate(b, 0, own);
    else if (own && sf_process_pool(pending, abreast, simulate, b, own, err) == SF_OK)
        name_killed(b, pending, own);
    for (int k = 0; k < pending && own && err->status == SF_OK; k++)
        failure[b->pending[k]] = own[k];
    free(own);
    return err->status;
}

static sf_status take_result(sf_runner *runner, const request *r, sf_runner_result *result, sf_error *err) {
    if (read_result(r->at.results, result, err) != SF_OK)
        return err->status;
    result->reused = r->reused;
    *(r->reused ? &runner->reused : &runner->simulated) += 1;
    if (runner->log) {
        fprintf(runner->log, "  %-24s %7.4g m/s  a_max %7.2f g  HIC %7.1f  largest local strain %.3f%s\n",
                r->drop->label, result->v0, result->a_max_g, result->hic, result->max_local_strain,
                result->reused ? "  (was there)" : "");
        fflush(runner->log);
    }
    return SF_OK;
}

sf_status sf_runner_run_each(sf_runner *runner, int count, const sf_runner_drop *drop,
                             sf_runner_result *result, sf_error *failure, sf_error *err) {
    unsigned long n = (unsigned long)count;
    batch b = {.runner = runner,
               .request = sf_alloc(err, n, sizeof *b.request, "drops"),
               .pending = sf_alloc(err, n, sizeof *b.pending, "drops")};
    memset(result, 0, (size_t)count * sizeof *result);
    for (int k = 0; k < count; k++)
        failure[k] = (sf_error)SF_ERROR_INIT;
    for (int k = 0; k < count && err->status == SF_OK; k++)
        prepare(runner, &drop[k], &b.request[k], err);
    if (err->status == SF_OK && sf_process_stopped())
        sf_run_folder_interrupted(err);
    if (err->status == SF_OK)
        simulate_pending(&b, list_pending(&b, count), failure, err);
    for (int k = 0; k < count && err->status == SF_OK; k++)
        if (failure[k].status == SF_INTERRUPTED)
            sf_run_folder_interrupted(err);
    for (int k = 0; k < count && err->status == SF_OK; k++)
        if (failure[k].status == SF_OK)
            take_result(runner, &b.request[k], &result[k], &failure[k]);
    free(b.request);
    free(b.pending);
    return err->status;
}

sf_status sf_runner_run_batch(sf_runner *runner, int count, const sf_runner_drop *drop,
                              sf_runner_result *result, sf_error *err) {
    sf_error *failure = sf_alloc(err, (unsigned long)count, sizeof *failure, "failures");
    memset(result, 0, (size_t)count * sizeof *result);
    if (failure && sf_runner_run_each(runner, count, drop, result, failure, err) == SF_OK)
        decide(count, failure, err);
    free(failure);
    return err->status;
}

sf_status sf_runner_run(sf_runner *runner, const sf_runner_drop *drop, sf_runner_result *result,
                        sf_error *err) {
    return sf_runner_run_batch(runner, 1, drop, result, err);
}

void sf_runner_result_free(sf_runner_result *result) {
    sf_series_free(&result->curve);
    free(result->path);
    free(result->layer_strain);
    *result = (sf_runner_result){0};
}
