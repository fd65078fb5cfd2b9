/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Engines that run a batch: this program itself, or Snakemake by the workflow that comes with softfall
 * (share/softfall/Snakefile), on this machine or by a profile on a cluster. */
#ifndef SF_CAMPAIGN_ENGINE_H
#define SF_CAMPAIGN_ENGINE_H

#include "study/drop.h"
#include "base/error.h"
#include <stddef.h>

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

/* " (sentence)", the last one of sbatch in the log of Snakemake, from byte `begin` on; "" if there is none.
 */
void sf_engine_complaint(const char *log, size_t begin, char *text, size_t size);

#endif
