/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop of a campaign, and what runs a batch of them. */
#ifndef SF_CAMPAIGN_DROP_H
#define SF_CAMPAIGN_DROP_H

#include <stdbool.h>

enum { SF_RUNNER_OVERRIDES = 16 };

/* One drop. Strings are borrowed. */
typedef struct sf_runner_drop {
    const char *label;     /* begins the name of its folder */
    const char *case_path; /* case file */
    const char *material;  /* file that replaces the case's group material, NULL: none */
    int override_count;
    const char *overrides[SF_RUNNER_OVERRIDES]; /* "group.key=value" */
} sf_runner_drop;

/* The engine of a batch, and the part of the batch that it runs. Strings are borrowed. */
typedef struct sf_runner_engine {
    const char *name;    /* NULL or "local": this process; "snakemake" (engine.h) */
    const char *profile; /* of Snakemake; NULL: none */
    int per_job;         /* drops of a job; 0: sf_manifest_group_size */
    double drop_seconds; /* that a drop takes on one core; 0: not known */
    int job_threads;     /* of a job; 0: one */
    bool retry;          /* drops that failed earlier are simulated again; else they fail as they did */
    const int *lock;     /* of the campaign (sf_folder_lock): an engine that outlives this process keeps it;
                            NULL: none */
} sf_runner_engine;

#endif
