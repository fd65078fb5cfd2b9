/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of softfall-fit. */
#pragma once

/* softfall-fit compression FIT.cfg -o DIR: compression tests of a foam to a material file;
 * softfall-fit drop FIT.cfg -o DIR: the foam from drops. argv[0] is the name of the program with its word;
 * return the exit code. */
int sf_fit_compression_main(int argc, char **argv);
int sf_fit_drop_main(int argc, char **argv);
