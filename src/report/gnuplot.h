/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures by gnuplot. A script NAME.gp runs from any folder and writes beside itself: `gnuplot NAME.gp` the
 * picture NAME.png, `gnuplot -c NAME.gp svg` the same as NAME.svg, which a report takes in. */
#ifndef SF_IO_GNUPLOT_H
#define SF_IO_GNUPLOT_H

#include "io/staging.h"

/* Opens NAME.gp in the staging directory and begins it: the folder of the script, terminal (a PNG of width x
 * height pixels, or the SVG that looks like it), separator of the data files, style. The script may use `svg`
 * (1 or 0), and `dot`, by which it multiplies the sizes of points. NULL on failure; end with
 * sf_staging_close. */
FILE *sf_gnuplot_begin(const sf_staging *output, const char *name, int width, int height, sf_error *err);

/* A key of `entries` entries below the axes, in even rows of at most `columns`: as many as fit into the
 * width, or gnuplot breaks the rows and the key grows over the axis. */
void sf_gnuplot_key(FILE *script, int entries, int columns);

/* Draws NAME.png in the staging directory, silently. If gnuplot is absent or fails, `warning` (size bytes)
 * says so in a sentence; otherwise it is "". */
void sf_gnuplot_draw(const sf_staging *output, const char *name, char *warning, size_t size);

/* The same as an SVG element that can stand in a page: no prologue and no titles, every id with NAME before
 * it. From malloc, owned by the caller; NULL if there is none, and a warning that asks to run `program`,
 * which writes the page, again. No file stays. */
char *sf_gnuplot_svg(const sf_staging *output, const char *name, const char *program, char *warning,
                     size_t size);

/* The SVG element of a file of gnuplot's terminal, as above; NULL if the text holds none, or out of memory.
 */
char *sf_gnuplot_element(const char *text, const char *name);

#endif
