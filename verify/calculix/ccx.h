/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs CalculiX (the program ccx in PATH) on a deck and reads the total forces that it printed. */
#ifndef SF_VERIFY_CCX_H
#define SF_VERIFY_CCX_H

#include "base/error.h"
#include <stdbool.h>

/* True if there is a ccx; its version into `version`. */
bool sf_ccx_present(char version[64]);

typedef struct sf_ccx_run {
    double reached;   /* time of the last converged increment; 1 = the end */
    double cpu;       /* s, of user and system */
    char ending[256]; /* the program's last error line, "" if none */
} sf_ccx_run;

/* Runs FOLDER/JOB.inp on one thread. A run that ends early is no failure: its increments count. */
sf_status sf_ccx_solve(const char *folder, const char *job, sf_ccx_run *run, sf_error *err);

/* CPU time (s) of all programs that this process has started and waited for. */
double sf_children_cpu(void);

typedef struct sf_ccx_forces {
    int count;
    double *time;  /* [count] */
    double *force; /* [count][3] N, owned */
} sf_ccx_forces;

/* Total forces of the node set `set` (upper case) of every printed state, from FOLDER/JOB.dat. */
sf_status sf_ccx_forces_read(const char *folder, const char *job, const char *set, sf_ccx_forces *out,
                             sf_error *err);
void sf_ccx_forces_free(sf_ccx_forces *forces);

#endif
