/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_FIT_COMMAND_LINE_H
#define SF_FIT_COMMAND_LINE_H

/* "softfall-fit " and the words, the first of which is that of the command; from malloc, owned by the caller;
 * NULL without memory. */
char *sf_fit_command_line(int argc, char *const *argv);

#endif
