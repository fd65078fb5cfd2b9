/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manifest of a batch: its drops on disk, in groups, for an engine that starts softfall-batch once for
 * each group (docs/formats.md). It says what is to be done; what has been done is told by the drops' folders,
 * so that nobody has to write the manifest again. */
#ifndef SF_CAMPAIGN_MANIFEST_H
#define SF_CAMPAIGN_MANIFEST_H

#include "study/drop.h"
#include "base/error.h"
#include <stddef.h>
#include <stdint.h>

#define SF_MANIFEST_FOLDER "batch" /* in the folder of the runs */
#define SF_MANIFEST_NAME "manifest.tsv"
enum { SF_MANIFEST_GROUP_SIZE = 32, SF_MANIFEST_GROUPS = 1000 /* of a batch, at most, unless asked for */ };

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

/* Drops of a group, a job of an engine: as many as take three minutes, if it is known how many `seconds` one
 * takes (else 0), but of few drops not so many that only a few jobs are left: at most 20, or what makes 200
 * groups. At least as many as make SF_MANIFEST_GROUPS. */
int sf_manifest_group_size(int count, double seconds);

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
/* Puts the failures in the file into failure[k] of the drop with that key; false: there is no such file. */
bool sf_manifest_read_outcome(const char *path, int count, const sf_manifest_run *run, sf_error *failure);
/* Returns the number of failures in the file; -1: there is no such file. */
int sf_manifest_count_failed(const char *path);

#endif
