/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit drop FIT.cfg -o DIR: the foam from drops. */
#ifndef SF_FIT_DROP_COMMAND_H
#define SF_FIT_DROP_COMMAND_H

/* `argv[0]` is the command's name for messages. Returns the exit code. */
int sf_fit_drop_main(int argc, char **argv);

#endif
