/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop of a campaign, and what runs a batch of them. */
#pragma once
#include "base/error.h"
#include <stdint.h>

enum { SF_RUNNER_OVERRIDES = 16 };

/* One drop. Strings are borrowed. */
typedef struct sf_runner_drop {
    const char *label;     /* begins the name of its folder */
    const char *case_path; /* case file */
    const char *material;  /* file that replaces the case's group material, NULL: none */
    int override_count;
    const char *overrides[SF_RUNNER_OVERRIDES]; /* "group.key=value" */
    int number; /* of a series, from 1: the drop whose figures are wanted; 0: those of the drops that count */
} sf_runner_drop;

/* The engine of a batch, and the part of the batch that it runs. Strings are borrowed. */
typedef struct sf_runner_engine {
    const char *name;    /* NULL or "local": this process; "snakemake" */
    const char *profile; /* of Snakemake; NULL: none */
    int per_job;         /* drops of a job; 0: one */
    int job_threads;     /* of a job; 0: one */
    bool retry;          /* drops that failed earlier are simulated again; else they fail as they did */
    const int *lock;     /* of the campaign (sf_folder_lock): an engine that outlives this process keeps it;
                            NULL: none */
} sf_runner_engine;

/* Engines that run a batch: this program itself, or Snakemake by the workflow that comes with softfall
 * (share/softfall/Snakefile), on this machine or by a profile on a cluster. */

/* This process runs the drops. */
bool sf_engine_is_local(const sf_runner_engine *engine);

/* Can the engine be used? SF_ERR_INPUT: it is unknown, a profile without it, no such profile; SF_ERR_IO: it
 * is not installed, or Slurm's commands are not, with the name of the package. */
sf_status sf_engine_check(const sf_runner_engine *engine, sf_error *err);

/* Runs every group of the manifest by Snakemake, without a profile on `threads` processors of this machine;
 * returns when no more can be done. What was done is told by the drops' folders and the files of the groups.
 * `tick`: called with `context` every ten seconds meanwhile. SF_ERR_IO: it cannot be started;
 * SF_INTERRUPTED. `*code` its exit code. */
sf_status sf_engine_run(const sf_runner_engine *engine, int threads, const char *manifest,
                        void (*tick)(void *context), void *context, int *code, sf_error *err);

/* " (sentence)", the last one of sbatch in the log of Snakemake, from byte `begin` on; "" if none. */
void sf_engine_complaint(const char *log, size_t begin, char *text, size_t size);

/* The manifest of a batch: its drops on disk, in groups, for an engine that starts softfall-batch once for
 * each group (docs/formats.md). It says what is to be done; what has been done is told by the drops' folders,
 * so that nobody has to write the manifest again. */

#define SF_MANIFEST_FOLDER "batch" /* in the folder of the runs */
#define SF_MANIFEST_NAME "manifest.tsv"
enum { SF_MANIFEST_GROUP_SIZE = 32 };

/* A drop, its key and its group. */
typedef struct sf_manifest_run {
    uint64_t key;                       /* 0: not known, in a manifest that somebody wrote */
    char group[SF_MANIFEST_GROUP_SIZE]; /* "00001-<hash of the group's lines>" */
    sf_runner_drop drop;                /* its strings are in sf_manifest.text */
} sf_manifest_run;

typedef struct sf_manifest {
    char *runs;   /* the folder of the drops' folders, where it begins with / or from `folder` */
    char *folder; /* in which the campaign runs: where paths of cases, materials and overrides begin */
    int count;
    sf_manifest_run *run; /* [count], the groups one after another; owned */
    char *text;           /* owned */
} sf_manifest;

/* Writes the manifest of drop[index[k]] with their keys, k < count. SF_ERR_INPUT: a text holds a tab or a
 * line end. */
sf_status sf_manifest_write(const char *path, const char *runs, int count, const int *index,
                            const sf_runner_drop *drop, const uint64_t *key, int group_size, sf_error *err);
/* Release with sf_manifest_free, also on failure. SF_ERR_INPUT: no manifest, damaged, or more than 4 GB. */
sf_status sf_manifest_read(const char *path, sf_manifest *manifest, sf_error *err);
void sf_manifest_free(sf_manifest *manifest);

/* The first run behind the group of run k. */
int sf_manifest_group_end(const sf_manifest *manifest, int k);

/* Name of the file, beside the manifest, that says that a group is done. */
void sf_manifest_outcome_path(const char *manifest, const char *group, char *path, size_t size);

/* Its lines: key, status and sentence of each drop of the group that failed. */
sf_status sf_manifest_write_outcome(const char *path, int count, const sf_manifest_run *run,
                                    const sf_error *failure, sf_error *err);
/* Puts the failures in the file into failure[k] of the drop with that key; returns how many there are, -1:
 * there is no such file. */
int sf_manifest_read_outcome(const char *path, int count, const sf_manifest_run *run, sf_error *failure);
