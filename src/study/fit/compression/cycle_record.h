/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A record of several cycles of compression of one specimen, with its time: what a foam remembers is in the
 * cycles after the first (theory, section "Memory"). A time of rest without load in which nothing was
 * recorded is a pause. */
#ifndef SF_FIT_COMPRESSION_CYCLE_RECORD_H
#define SF_FIT_COMPRESSION_CYCLE_RECORD_H

#include "study/config.h"

enum { SF_CYCLES = 16 }; /* in a record at most */

typedef struct sf_cycle_record {
    char *path;            /* owned, as the next three */
    int count;             /* points; 0: there is no record */
    double *time;          /* [count] s */
    double *strain;        /* [count] -, not below 0 */
    double *stress;        /* [count] Pa */
    double largest_stress; /* Pa */
    int cycles;            /* loadings, each with its unloading */
    int turn[2 * SF_CYCLES +
             1]; /* first point, that of the largest strain of cycle 1, of the least after it, ... */
    int pauses;
    int fitted; /* cycles, from the first on; the others are predicted */
} sf_cycle_record;

/* Reads the key `cycles`, { file = "cycles.csv"; fitted = 3; }, if it is there. SF_ERR_INPUT also where the
 * file has no two cycles, one does not return, or time goes back. Release with sf_cycle_record_free. */
sf_status sf_cycle_record_read(const sf_config *file, const config_setting_t *root, sf_cycle_record *record,
                               sf_error *err);
void sf_cycle_record_free(sf_cycle_record *record);

/* The pause (s) before point i; 0: none. */
double sf_cycle_record_pause(const sf_cycle_record *record, int i);

#endif
