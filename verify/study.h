/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A verification study: a program that measures, compares with bounds, and writes its section of
 * docs/verification.md.
 *
 * Called as `study_<name> [DIR]`. Markdown goes to DIR/<name>.md (and to standard output), data and pictures
 * beside it; without DIR only to standard output. The exit code is the number of failed checks (at most 100),
 * so that CTest fails with it. */
#ifndef SF_VERIFY_STUDY_H
#define SF_VERIFY_STUDY_H

#include "base/error.h"
#include <stdbool.h>
#include <stdio.h>

typedef struct sf_study {
    const char *name;
    const char *folder; /* NULL: nothing is written */
    FILE *out;          /* DIR/<name>.md, or NULL */
    int checks, failures;
    bool in_table; /* a table of checks is open */
} sf_study;

/* Starts a study and prints its heading. */
void sf_study_begin(sf_study *study, const char *name, const char *title, int argc, char **argv);

/* Markdown text, as printf; closes an open table of checks. */
void sf_study_text(sf_study *study, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* One row of the table of checks: passes if low <= value <= high (use -INFINITY or INFINITY for a one-sided
 * bound). */
bool sf_study_check(sf_study *study, double value, double low, double high, const char *what, ...)
    __attribute__((format(printf, 5, 6)));

/* Opens DIR/<name>-<suffix> for writing (data for a plot); NULL when no folder was given. The caller closes
 * it. */
FILE *sf_study_file(sf_study *study, const char *suffix);

/* Runs gnuplot with `commands` in DIR, output DIR/<name>-<suffix> (a .png), and refers to it in the text with
 * the caption. Does nothing without a folder. */
void sf_study_plot(sf_study *study, const char *suffix, const char *caption, const char *commands);

/* Records a failure of the software under study as a failed check. */
void sf_study_fail(sf_study *study, const sf_error *err);

/* Prints the verdict; returns the exit code. */
int sf_study_end(sf_study *study);

#endif
