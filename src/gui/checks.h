/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What softfall-pre says of a model, and the sentences of programs, from their output. */
#ifndef SF_GUI_CHECKS_H
#define SF_GUI_CHECKS_H

#include <stddef.h>

/* Puts the checks that the text of softfall-pre holds into the branch Checks of the tree. */
void sf_checks_show(const char *text);
/* Empties the branch. */
void sf_checks_clear(void);

/* The last sentence of a program's output, without the program's name. */
void sf_checks_sentence(const char *text, char *out, size_t size);
/* The solver's last line of progress, without double blanks; "" if there is none. */
void sf_checks_progress(const char *text, char *out, size_t size);

#endif
