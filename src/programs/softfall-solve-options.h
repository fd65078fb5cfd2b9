/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of softfall-solve. */
#ifndef SF_SOLVER_PROGRAM_OPTIONS_H
#define SF_SOLVER_PROGRAM_OPTIONS_H

#include <stdbool.h>

typedef struct sf_solve_options {
    const char *model;
    const char *output;
    const char *restart;
    double end_time;                         /* s, 0: as the model says, or the run so far */
    double checkpoint_wall, checkpoint_time; /* s */
    bool no_checkpoint;
    bool remove_failed;
    int threads;
    bool force;
} sf_solve_options;

/* Reads the command line; a wrong command line ends the program with a message. Texts are borrowed from
 * `argv`. */
void sf_solve_options_parse(int argc, char **argv, sf_solve_options *options);

#endif
