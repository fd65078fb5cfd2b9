/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A program that runs beside this one and is asked from time to time: it and what it starts are a process
 * group of their own, and it gets SIGTERM when this process ends, in whatever way. */
#ifndef SF_IO_CHILD_H
#define SF_IO_CHILD_H

#include "base/error.h"
#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

typedef struct sf_child {
    pid_t process; /* 0: none */
} sf_child;

/* Starts the program `arguments[0]` (a path, or a name to look for in PATH; ends with NULL) with nothing to
 * read and its output in the open file `log`, which stays the caller's. Call it from the thread that lives as
 * long as the process. */
sf_status sf_child_start(sf_child *child, const char *const *arguments, FILE *log, sf_error *err);

/* Starts a program that may outlive this process and is never asked (a browser). */
sf_status sf_child_leave(const char *const *arguments, sf_error *err);

/* True once the child has ended; then `*exit_code` (128 + the signal that ended it), and there is none any
 * more. */
bool sf_child_poll(sf_child *child, int *exit_code);

/* Asks the child and what it started to end (SIGTERM); sf_child_poll tells when they have. */
void sf_child_ask_to_end(const sf_child *child);
/* Ends them: asks, and after `patience` seconds ends them by force. Returns when they are gone. */
void sf_child_end(sf_child *child, double patience);

#endif
