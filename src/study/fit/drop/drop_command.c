/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/folder.h"
#include "study/fit/drop/drop_report.h"
#include <omp.h>

/* The models of the file, each with its fit and posterior. */
typedef struct models {
    int count;
    sf_fit_input input[SF_FIT_MAX_MODELS];
    sf_drop_fit fit[SF_FIT_MAX_MODELS];
    sf_drop_inference inference[SF_FIT_MAX_MODELS];
    sf_error failure[SF_FIT_MAX_MODELS]; /* of a model alone: the others go on */
    sf_drop_average average;             /* without posterior: of no models */
} models;

static void print_curves(const sf_fit_input *in) {
    for (int k = 0; k < in->drop_count; k++)
        if (in->drop[k].curve_path)
            printf("reference %s: %s\n", in->drop[k].curve_path, in->drop[k].interpretation);
    for (int t = 0; t < in->joint.test_count; t++)
        printf("test %s\n", in->joint.test[t].interpretation);
    for (int c = 0; c < in->joint.cushion_count; c++)
        if (*in->joint.cushion[c].interpretation)
            printf("cushion %s\n", in->joint.cushion[c].interpretation);
    fflush(stdout);
}

static sf_status fit_model(models *all, int m, sf_runner *runner, sf_fit_memory *memory, sf_error *err) {
    const sf_fit_input *in = &all->input[m];
    sf_drop_fit *fit = &all->fit[m];
    const sf_inference_options sampling = sf_inference_defaults(in->seed);
    *fit = (sf_drop_fit){
        .input = in, .runner = runner, .folder = runner->folder, .log = runner->log, .memory = memory};
    for (int k = 0; k < m && !fit->earlier; k++)
        if (all->failure[k].status == SF_OK)
            fit->earlier = &all->fit[k];
    if (all->count > 1)
        printf("model %d of %d: %s, %d unknown parameters\n", m + 1, all->count, in->label,
               in->unknown_count);
    if (sf_drop_fit_run(fit, err) != SF_OK || !in->posterior)
        return err->status;
    if (sf_drop_infer(fit, &sampling, &all->inference[m], err) == SF_OK)
        sf_inference_print_chains(stdout, &all->inference[m]);
    return err->status;
}

/* Averages the models that have a posterior; the others are listed. */
static sf_status average_models(models *all, sf_error *err) {
    const sf_drop_inference *list[SF_FIT_MAX_MODELS];
    sf_drop_average *a = &all->average;
    int count = 0;
    for (int m = 0; m < all->count; m++)
        if (all->failure[m].status == SF_OK)
            list[count++] = &all->inference[m];
    SF_TRY(sf_drop_average_build(count, list, all->input[0].seed, a, err));
    for (int m = 0; m < all->count; m++) {
        if (all->failure[m].status == SF_OK)
            continue;
        sf_failed_model *failed = &a->failure[a->failed++];
        failed->label = all->input[m].label;
        snprintf(failed->sentence, sizeof failed->sentence, "%.500s", all->failure[m].text);
    }
    return SF_OK;
}

static sf_status fit_models(models *all, sf_runner *runner, sf_fit_memory *memory, sf_error *err) {
    int fitted = 0;
    for (int m = 0; m < all->count; m++) {
        sf_error *failure = &all->failure[m];
        *failure = (sf_error)SF_ERROR_INIT;
        if (fit_model(all, m, runner, memory, failure) == SF_OK) {
            fitted++;
            continue;
        }
        if (failure->status != SF_ERR_NUMERIC && failure->status != SF_ERR_MODEL &&
            failure->status != SF_ERR_INPUT) { /* it concerns the others, too */
            *err = *failure;
            return err->status;
        }
        if (all->count > 1)
            printf("model %d of %d FAILED: %s: %s\n", m + 1, all->count, all->input[m].label, failure->text);
        fflush(stdout);
    }
    if (fitted == 0 && all->count == 1)
        *err = all->failure[0];
    else if (fitted == 0)
        SF_FAIL(err, all->failure[0].status, "none of the %d models was fitted; the first: %.800s",
                all->count, all->failure[0].text);
    else if (all->input[0].posterior)
        average_models(all, err);
    return err->status;
}

static void clear_posterior(const char *folder) {
    static const char *const ends[] = {"cfg", "csv", "-1.csv", "-2.csv", "-3.csv"};
    char path[PATH_MAX + 32];
    for (int k = 1; k <= SF_POSTERIOR_DRAWS; k++)
        for (size_t e = 0; e < sizeof ends / sizeof *ends; e++) {
            snprintf(path, sizeof path, "%s/draw-%03d%s%s", folder, k, *ends[e] == '-' ? "" : ".", ends[e]);
            sf_folder_remove_file(path);
        }
}

/* Moves the files to their places. The draws of an earlier run go before, those of this one come after: they
 * never stand beside another posterior. */
static sf_status commit(const char *directory, const sf_drop_average *average, sf_staging *output,
                        sf_error *err) {
    SF_PRINTED(folder, PATH_MAX, "%s/posterior", directory);
    SF_TRY(sf_folder_own(folder, err));
    clear_posterior(folder);
    if (sf_staging_commit(output, err) == SF_OK && average->models > 0)
        sf_drop_average_write(average, folder, err);
    if (average->models == 0)
        sf_folder_leave(folder);
    return err->status;
}

static sf_status report(sf_study *study, const models *all, char *warning, size_t size, sf_error *err) {
    const sf_drop_average *average = all->average.models > 0 ? &all->average : NULL;
    const sf_drop_fit *best = average ? average->model[sf_drop_average_best(average)]->fit : &all->fit[0];
    SF_TRY(sf_drop_report_write(best, average, study, warning, size, err));
    SF_TRY(commit(study->directory, &all->average, &study->output, err));
    sf_drop_report_print(best, stdout);
    return average ? sf_inference_print(stdout, average, err) : SF_OK;
}

/* Tells what has no weight; a fit that did not converge is a failure, though its files are written. */
static sf_status warn(const sf_sink *sink, const models *all, sf_error *err) {
    int open = 0;
    for (int m = 0; m < all->count; m++)
        if (all->failure[m].status != SF_OK)
            sf_sink_tell(sink, SF_WARNING, "model %s has no weight: %s", all->input[m].label,
                         all->failure[m].text);
        else if (!all->fit[m].result.converged) {
            open++;
            sf_sink_tell(sink, SF_WARNING, "%s%snot converged after %d iterations: %s",
                         all->count > 1 ? all->input[m].label : "", all->count > 1 ? ": " : "",
                         all->fit[m].result.iterations, all->fit[m].result.reason);
        }
    if (open > 0)
        SF_FAIL(err, SF_ERR_NUMERIC,
                "%d of %d fits did not converge: the files are written, but their values are not to be used; "
                "start nearer to the foam, or leave out what contradicts",
                open, all->count);
    return err->status;
}

/* Fits all models and writes the files. What was computed between the drops is kept in DIR/runs/columns.bin
 * until the fit has ended. */
static sf_status fit_and_write(sf_study *study, models *all, sf_fit_memory *memory, sf_error *err) {
    char columns[PATH_MAX + 16], warning[512] = "", files[SF_FIT_NAME_SIZE + 80];
    const sf_fit_input *in = &all->input[0];
    snprintf(columns, sizeof columns, "%s/columns.bin", study->runs);
    sf_fit_memory_open(columns, memory);
    printf("softfall-fit drop: %d unknown parameters, %d drops; finished drops are kept in %s\n",
           in->unknown_count, in->drop_count, study->runs);
    print_curves(in);
    omp_set_num_threads(study->threads);
    SF_TRY(fit_models(all, &study->runner, memory, err));
    SF_TRY(report(study, all, warning, sizeof warning, err));
    if (memory->file >= 0)
        sf_folder_remove_file(columns);
    snprintf(files, sizeof files, "%s.cfg, report.html, fit.json, fit.png%s", in->material_name,
             all->average.models > 0 ? ", posterior.csv, posterior/" : "");
    sf_study_close(study, files, warning);
    return warn(&study->sink, all, err);
}

static sf_status run(sf_study *study, void *own, sf_error *err) {
    models *all = own;
    SF_OWNED_BY(sf_fit_memory_close) sf_fit_memory memory = {.file = -1};
    char card[SF_FIT_NAME_SIZE + 8], curve[SF_FIT_NAME_SIZE + 8];
    const char *const none[] = {NULL}; /* the names are in the input */
    const char *const names[] = {curve,     card,       "fit-curve.csv", "fit-drops.csv", "fit.gp",
                                 "fit.png", "fit.json", "report.html",   "posterior.csv", NULL};
    SF_TRY(sf_study_check(study, none, err));
    all->count = 1;
    for (int m = 0; m < all->count; m++) {
        SF_TRY(sf_fit_input_read(study->input, m, &all->input[m], err));
        all->count = all->input[m].model_count;
    }
    snprintf(card, sizeof card, "%s.cfg", all->input[0].material_name);
    snprintf(curve, sizeof curve, "%s.csv", all->input[0].material_name);
    if (sf_study_begin(study, names, err) == SF_OK && sf_folder_own(study->runs, err) == SF_OK) {
        sf_study_run_apart(study);
        fit_and_write(study, all, &memory, err);
    }
    sf_staging_end(&study->output); /* before its names go */
    return err->status;
}

int sf_fit_drop_main(int argc, char **argv) {
    static const sf_study_program program = {
        .name = "softfall-fit",
        .word = "drop",
        .argument = "FIT.cfg",
        .doc = "Identifies a foam from measured drops, and predicts others.",
        .drops = true,
        .run = run,
    };
    sf_error err = SF_ERROR_INIT;
    SF_OWNED models *all = sf_alloc(&err, 1, sizeof *all, "the models");
    if (!all)
        return sf_error_report(&err, program.name);
    int code = sf_study_main(argc, argv, &program, all);
    for (int m = 0; m < SF_FIT_MAX_MODELS; m++) {
        sf_drop_inference_free(&all->inference[m]);
        sf_drop_fit_free(&all->fit[m]);
        sf_fit_input_free(&all->input[m]);
    }
    return code;
}
