/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-post compare A B ... -o DIR: several runs in one picture and one table. softfall-post series: the
 * drops of a series on one pad, with their growth and mean. */
#pragma once

/* The program with this command; returns its exit code. argv[1] is "compare" or "series". */
int sf_overlay_main(int argc, char **argv);
