/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The key of a drop, its folder, and the figures of a finished drop. */
#pragma once
#include "case/case.h"
#include "post/figures/verdict.h"
#include <limits.h>

/* Figures of a finished drop, cached beside its results in a small text, figures.txt. It tells in place of
 * results.h5 that the drop is finished, as long as that is the file that it was made of (size and time);
 * without it, or with one of another version, damaged or half written, it is written anew. */
typedef struct sf_run_record {
    sf_grade grade;
    const char *verdict;  /* sf_verdict_line */
    const char *status;   /* /summary/status */
    const char *geometry; /* the list of what the geometries read (pre/mesh/mesh_store.h) */
    double *figure;       /* [of sf_figure_at] sf_figure_number; owned */
    char *text;           /* that the strings are parts of; owned */
} sf_run_record;

/* True if the record at `path` is whole, of this version, and made of the file `results` as it is now.
 * Release with sf_run_record_free, also if it is false. */
bool sf_run_record_read(const char *path, const char *results, sf_run_record *record);
void sf_run_record_free(sf_run_record *record);

/* Writes the record at `path`, of the open results of the file `results`. It is only a shorter way: where it
 * cannot be written, nothing is said. */
void sf_run_record_write(const char *path, const char *results, const sf_results *r, const sf_figures *f,
                         sf_grade grade, const char *verdict, const char *geometry);

/* The key of a drop: equal for equal inputs. */

/* A hash of the values of every key of the case, the points of its curves and motion, its geometry files and
 * the programs that simulate it; the names of files do not count. What a geometry includes or merges is known
 * only after it was read: sf_run_folder_is_finished. */
sf_status sf_campaign_key(const sf_case *c, uint64_t *key, sf_error *err);

/* Returns the list of the files that the geometries read, at `text` of the HDF5 file `path` (docs/formats.md,
 * geometry_files), from malloc; NULL if there is none. */
char *sf_campaign_geometry_list(const char *path, const char *text);

/* The folder of one drop: it holds the log, the model and the checkpoint while the drop is not finished, and
 * the results. The folder of a series of drops on one pad holds those of each drop. */

/* The folder of meshes and domains that the drops share, beside the drops' folders (io/folder.h). */
#define SF_RUN_SHARED "shared"

enum { SF_RUN_PATH_SIZE = PATH_MAX + 128 };

typedef struct sf_run_folder {
    uint64_t key;    /* of the case with its overrides */
    int drops;       /* of the series, 1: a single drop */
    int64_t counted; /* drops by which it is judged: bit k for drop k + 1 */
    char path[PATH_MAX];
    char model[SF_RUN_PATH_SIZE], results[SF_RUN_PATH_SIZE], checkpoint[SF_RUN_PATH_SIZE],
        log[SF_RUN_PATH_SIZE], failed[SF_RUN_PATH_SIZE], figures[SF_RUN_PATH_SIZE];
    char geometry[SF_GEOMETRIES][PATH_MAX]; /* folder of each; "": there is none */
} sf_run_folder;

/* The names, "parent/label-<key of the case with its overrides>" and the names of its files; nothing is
 * created. */
sf_status sf_run_folder_name(const char *parent, const char *label, const char *case_path, int count,
                             const char *const *overrides, sf_run_folder *folder, sf_error *err);

/* Only the names, of a key that is known, and as of a single drop: the folders of the geometries are left "".
 */
void sf_run_folder_name_key(const char *parent, const char *label, uint64_t key, sf_run_folder *folder);

/* The same folder with the names of the files of one drop of its series, from 1. */
sf_run_folder sf_run_folder_of_drop(const sf_run_folder *folder, int drop);

/* Writes by what a series is judged: "the mean of drops 2, 3 of 3", or "drop 2 of 2"; "" of a single drop. */
void sf_run_counted_text(int drops, int64_t counted, char *text, size_t size);

/* True if the folder holds a drop, or all of a series, that ran to its end, and every file that its geometry
 * read is as it was then. */
bool sf_run_folder_is_finished(const sf_run_folder *folder);

/* True if the drop failed in softfall-solve (SF_ERR_NUMERIC), and every file that its geometry read is as it
 * was then: `*failure` is as it was. A failure of softfall-pre is not kept: it costs little, and what else
 * its geometry would have read is not known. */
bool sf_run_folder_has_failed(const sf_run_folder *folder, sf_error *failure);

/* True if softfall-solve is at work in the folder. */
bool sf_run_folder_is_running(const sf_run_folder *folder);

/* Removes model and checkpoint, which an orphan may have left in the folder of a finished drop. */
void sf_run_folder_clean(const sf_run_folder *folder);

/* Simulates the drop by softfall-pre and softfall-solve on `threads` threads, with their output in the log. A
 * drop that was interrupted or killed resumes from its model and its checkpoint, or starts anew if it cannot;
 * one whose campaign was killed, but whose solver still runs, is waited for, as is another process that
 * simulates it. Errors: the last line that the
 * program printed, with its exit code and the log; SF_INTERRUPTED (io/process.h), which keeps model and
 * checkpoint. */
sf_status sf_run_folder_simulate(const sf_run_folder *folder, const char *case_path, int count,
                                 const char *const *overrides, int threads, sf_error *err);

/* Records SF_INTERRUPTED. */
sf_status sf_run_folder_interrupted(sf_error *err);
