#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# status.sh JOB: prints success, running or failed, without Slurm's accounting. A job that Slurm has forgotten counts as
# failed: Snakemake starts it again, and finished drops are not simulated again. A controller that does not answer says
# nothing about the job: running.
state=$(squeue --noheader --states=all --jobs="$1" --format=%T 2>&1) || case $state in
*"Invalid job id"*) echo failed && exit ;;
*) echo running && exit ;;
esac
case $state in
COMPLETED*) echo success ;;
PENDING* | CONFIGURING* | RUNNING* | COMPLETING* | SUSPENDED* | STOPPED* | SIGNALING* | STAGE_OUT* | RESIZING* | REQUEUE* | RESV_DEL_HOLD*)
    echo running ;;
*) echo failed ;;
esac
