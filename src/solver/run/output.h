/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.h5 while it grows (docs/formats.md, section "While a run goes on"). Every file is written under
 * another name and renamed, so that results.h5 is complete at any instant. During the run, results.h5 holds
 * the history and links to the model and the frames, which are files of their own in the folder
 * results.h5.run, like the fields at the peak; in the end everything is copied into results.h5 and the folder
 * removed. The files of the folder are sealed (io/replace.h) and checked before use. */
#pragma once
#include "io/replace.h"
#include "solver/operators.h"
#include "solver/state.h"

typedef struct sf_output {
    char results[SF_PATH_SIZE];
    char checkpoint[SF_PATH_SIZE]; /* results.h5.restart */
    char folder[SF_PATH_SIZE];     /* results.h5.run */
    char partial[SF_PATH_SIZE];    /* of results.h5, between sf_output_begin and sf_output_commit */
    int lock;                      /* the open folder; -1: closed */
    int64_t fresh;                 /* bytes of the frames written since results.h5 was replaced last */
    int64_t size;                  /* bytes of that results.h5; 0: none yet */
} sf_output;

/* Closes a file, seals it and gives it its name; removes it if it failed. */
sf_status sf_output_seal(sf_h5 **file, const char *partial, const char *path, sf_error *err);

/* The names only. */
sf_status sf_output_name(sf_output *output, const char *results, sf_error *err);

/* Makes the folder and locks it: SF_ERR_INPUT if another run writes there. Release with sf_output_close. */
sf_status sf_output_open(sf_output *output, sf_error *err);
void sf_output_close(sf_output *output);

/* Provenance and model, from which every results.h5 starts: written under another name,
 * without change to the files of an earlier run. sf_output_start renames it, and keeps or removes the frames
 * of the earlier run. sf_output_abandon undoes everything since sf_output_open. */
sf_status sf_output_base(const sf_output *output, const sf_model *model, const sf_h5 *model_file,
                         const sf_provenance *provenance, sf_error *err);
sf_status sf_output_start(const sf_output *output, bool keep, sf_error *err);
void sf_output_abandon(const sf_output *output);

/* The present state as frame `index`. */
sf_status sf_output_frame(sf_output *output, const sf_model *model, const sf_operators *operators,
                          const sf_state *state, int64_t index, sf_error *err);

/* The present state as that at the peak, with all fields, in place of an earlier one. */
sf_status sf_output_peak(const sf_output *output, const sf_model *model, const sf_operators *operators,
                         const sf_state *state, sf_error *err);
/* Adds it as /peak to a results.h5 or a checkpoint, and takes it back from a checkpoint: a folder that is
 * there may hold a later one. */
sf_status sf_output_copy_peak(const sf_output *output, sf_h5 *file, sf_error *err);
sf_status sf_output_recover_peak(const sf_output *output, const sf_h5 *checkpoint, sf_error *err);

/* Frames 0 to count - 1 of the run so far: those that are not in the folder, or damaged there, come back from
 * results.h5, which has those of an ended run. `*lost`: the first that is nowhere whole, or -1. Fails if a
 * file cannot be read or written: then nothing is known to be lost. */
sf_status sf_output_recover(const sf_output *output, int64_t count, int64_t *lost, sf_error *err);

/* May results.h5 be replaced with `rows` new rows of history? A new file takes somewhat more bytes than the
 * last one, and four times as many must be new: then all of them together take a part of the data only. */
bool sf_output_is_due(const sf_output *output, int64_t rows);

/* A new results.h5 with model and frames 0 to count - 1, as links or copied. The caller adds the rest and
 * commits; on failure it closes the file. */
sf_status sf_output_begin(sf_output *output, bool copied, int64_t count, sf_h5 **file, sf_error *err);
sf_status sf_output_commit(sf_output *output, sf_h5 **file, sf_error *err);

/* Removes the folder with its files. */
void sf_output_clear(const sf_output *output);
