/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "programs/softfall-solve-solve.h"

#include "build_info.h"
#include "base/program.h"
#include "model/model_io.h"
#include "io/replace.h"
#include "programs/softfall-solve-report.h"
#include "solver/run/run.h"
#include <limits.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static sf_status check_names(const sf_output *output, sf_error *err) {
    SF_TRY(sf_replace_check(output->results, err));
    return sf_replace_check(output->checkpoint, err);
}

/* A file of an earlier run is replaced only with --force. */
static sf_status check_output(const sf_solve_options *o, const sf_output *output, sf_error *err) {
    SF_TRY(check_names(output, err));
    if (o->force)
        return SF_OK;
    if (sf_replace_exists(output->results))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --force replaces it%s", output->results,
                       sf_replace_exists(output->checkpoint) ? ", --restart resumes it" : "");
    if (sf_replace_exists(output->checkpoint))
        return SF_FAIL(err, SF_ERR_INPUT, "%s exists; --restart %s resumes from it, --force starts a new run",
                       output->checkpoint, output->results);
    return SF_OK;
}

/* The model of a new run, or that of the run so far, and its hash. */
static sf_status read_model(const sf_solve_options *o, const sf_checkpoint *from, sf_model *model,
                            sf_h5 **file, char hash[SF_MODEL_HASH_SIZE], sf_error *err) {
    const char *path = o->model ? o->model : from->model_path;
    sf_error inner = SF_ERROR_INIT;
    if (sf_model_read(path, model, file, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%.800s%s", inner.text,
                       o->restart && !o->model ? " (--restart RESULTS MODEL says where the model is now)"
                                               : "");
    sf_model_hash(model, hash);
    if (o->restart && strcmp(hash, from->model_hash) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is not the model of %s: its hash is %s, that of the run %s",
                       path, from->path, hash, from->model_hash);
    return SF_OK;
}

static sf_status set_end_time(const sf_solve_options *o, const sf_checkpoint *from, sf_model *model,
                              sf_error *err) {
    model->run.end_time = o->end_time > 0 ? o->end_time : o->restart ? from->end_time : model->run.end_time;
    if (o->restart && from->time_before >= model->run.end_time)
        return SF_FAIL(err, SF_ERR_INPUT, "%s is past %.6g s already, beyond the end time %.6g s", from->path,
                       from->time_before, model->run.end_time);
    return sf_model_check(model, err);
}

/* Other programs may round differently. The sentence also goes into the results; "" if there is none. */
static void compare_builds(const sf_checkpoint *from, char note[1024]) {
    const sf_sink sink = sf_program_sink("softfall-solve");
    note[0] = '\0';
    if (strcmp(from->git_revision, SF_GIT_REVISION) == 0 &&
        strcmp(from->compiler_flags, SF_COMPILER_FLAGS) == 0)
        return;
    snprintf(note, 1024,
             "%.600s is from another build (%.100s): the last digits may differ from those of one run",
             from->path, from->git_revision);
    sf_sink_tell(&sink, SF_WARNING, "%s", note);
}

static void remove_all(const sf_output *output) {
    unlink(output->results);
    unlink(output->checkpoint);
    sf_output_clear(output);
}

/* After a failure: removes the files, or reports which of them remain. */
static void handle_failure(const sf_solve_options *o, const sf_output *output, const sf_state *state,
                           bool shown) {
    if (o->remove_failed) {
        remove_all(output);
        return;
    }
    fprintf(stderr, "softfall-solve: note: %s %s", output->results,
            shown ? "has the frame of the failure" : "ends with the last frame that is finite");
    if (!o->no_checkpoint && access(output->checkpoint, F_OK) == 0)
        fprintf(stderr, "; %s is step %lld, t = %.6g s, the last valid step", output->checkpoint,
                (long long)state->step, state->time);
    fputc('\n', stderr);
}

/* Builds operators and state, and writes the base of the results first: so the mesh is released before the
 * operators are built, and the model's file is closed. */
static sf_status build(sf_model *model, sf_h5 **model_file, const sf_provenance *provenance,
                       const sf_output *output, sf_operators *operators, sf_state *state, sf_error *err) {
    if (sf_output_base(output, model, *model_file, provenance, err) != SF_OK ||
        sf_h5_close(model_file, err) != SF_OK)
        return err->status;
    sf_model_drop_mesh(model);
    if (sf_operators_take(model, operators, err) != SF_OK)
        return err->status;
    malloc_trim(0); /* return the freed work memory of the build */
    return sf_state_create(model, state, err);
}

sf_status sf_solve(const sf_solve_options *o, const char *command, const volatile sig_atomic_t *stop,
                   sf_error *err) {
    sf_model model = {0};
    sf_operators operators = {0};
    sf_state state = {0};
    sf_output output;
    sf_checkpoint from = {0};
    sf_h5 *model_file = NULL;
    char libraries[64], hash[SF_MODEL_HASH_SIZE], path[PATH_MAX];
    sf_provenance provenance = {.program = "softfall-solve",
                                .command_line = command,
                                .libraries = libraries,
                                .model_path = path,
                                .model_hash = hash};
    snprintf(libraries, sizeof libraries, "HDF5 %s", sf_h5_version());
    if (sf_output_name(&output, o->output, err) != SF_OK)
        return err->status;
    if (o->restart ? sf_checkpoint_open(output.checkpoint, &from, err) : check_output(o, &output, err))
        return err->status;
    if (read_model(o, &from, &model, &model_file, hash, err) != SF_OK ||
        (!o->restart && check_names(&output, err) != SF_OK) || /* now that the input is known */
        set_end_time(o, &from, &model, err) != SF_OK)
        goto done;
    const char *named = o->model ? o->model : from.model_path;
    if (!realpath(named, path))
        snprintf(path, sizeof path, "%s", named);
    sf_solve_print_model(&model, o->threads);
    char note[1024] = "";
    if (o->restart)
        compare_builds(&from, note);
    if (sf_output_open(&output, err) != SF_OK ||
        build(&model, &model_file, &provenance, &output, &operators, &state, err) != SF_OK ||
        sf_output_start(&output, o->restart != NULL, err) != SF_OK) {
        sf_output_abandon(&output);
        goto done;
    }
    sf_replace_clean(output.results);
    sf_replace_clean(output.checkpoint);
    if (!o->restart)
        unlink(output.checkpoint); /* of an earlier run, with --force */
    const sf_sink sink = sf_program_sink("softfall-solve");
    sf_run run = {.stop = stop,
                  .log = stdout,
                  .sink = &sink,
                  .terminal = isatty(STDOUT_FILENO),
                  .threads = o->threads,
                  .to_end_time = o->end_time > 0,
                  .checkpoints = !o->no_checkpoint,
                  .checkpoint_wall = o->checkpoint_wall,
                  .checkpoint_time = o->checkpoint_time,
                  .provenance = &provenance};
    snprintf(run.note, sizeof run.note, "%s", note);
    sf_run_drop(&model, &operators, &state, &run, &output, o->restart ? &from : NULL, err);
    if (state.step > 0)
        sf_solve_print_ledger(&model, &state, &run);
    if (err->status == SF_ERR_NUMERIC && (o->remove_failed || strcmp(run.ending, "anvil") != 0))
        handle_failure(o, &output, &state, run.shown);
done:
    sf_output_close(&output);
    sf_checkpoint_close(&from);
    sf_h5_close(&model_file, err);
    sf_state_free(&state);
    sf_operators_free(&operators);
    sf_model_free(&model);
    return err->status;
}
