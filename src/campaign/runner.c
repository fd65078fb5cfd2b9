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

sf_status sf_runner_run(sf_runner *runner, const sf_runner_drop *drop, sf_runner_result *result,
                        sf_error *err) {
    char material[MATERIAL_SIZE];
    const char *list[SF_RUNNER_OVERRIDES + 1 + LEAN];
    sf_run_folder at;
    *result = (sf_runner_result){0};
    int count = list_overrides(drop, material, list);
    if (sf_run_folder_name(runner->folder, drop->label, drop->case_path, count, list, &at, err) != SF_OK)
        return err->status;
    bool reused = sf_run_folder_is_finished(&at);
    if (sf_process_stopped())
        return sf_run_folder_interrupted(err);
    if (!reused && (sf_folder_own(runner->folder, err) != SF_OK ||
                    sf_run_folder_simulate(&at, drop->case_path, count, list, runner->threads, err) != SF_OK))
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
    free(result->layer_strain);
    *result = (sf_runner_result){0};
}
