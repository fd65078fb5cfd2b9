/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit compression FIT.cfg -o DIR: compression tests of a foam to a material file. */
#ifndef SF_FIT_COMPRESSION_COMMAND_H
#define SF_FIT_COMPRESSION_COMMAND_H

/* argv[0] is the name of the program with its word; returns the exit code. */
int sf_fit_compression_main(int argc, char **argv);

#endif
