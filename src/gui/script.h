/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that does in the window what a user does, for tests and pictures: docs/window.md lists its words. */
#ifndef SF_GUI_SCRIPT_H
#define SF_GUI_SCRIPT_H

#include "gui/session.h"
#include <stdio.h>

typedef struct sf_script {
    char *text; /* owned */
    char *rest; /* what is left of it */
    int line;
    double deadline; /* s, of `wait`; 0: none */
    sf_activity awaited;
    int frames; /* awaited too */
    bool ended; /* by `quit`, or by an error */
} sf_script;

/* SF_ERR_INPUT: the file cannot be read. Release with sf_script_close. */
sf_status sf_script_open(const char *path, sf_script *script, sf_error *err);
/* Runs the next line if it need not wait; its output goes to `out`. Errors name the line. */
sf_status sf_script_step(sf_script *script, sf_session *session, FILE *out, sf_error *err);
void sf_script_close(sf_script *script);

#endif
