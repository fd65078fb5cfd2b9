/* SPDX-License-Identifier: GPL-3.0-or-later */
/* acceleration.png: the curves, the HIC window and the limit; acceleration.gp, which draws the picture again,
 * or differently, stays beside it. Of a run with a prescribed motion compression.png: stress over strain. */
#pragma once
#include "post/view/summary.h"

/* Columns of the key: three entries such as "HIC 595.2: 6.54 to 15.33 ms" do not fit beside each other. */
enum { SF_PLOT_KEY_COLUMNS = 2 };

/* The name of the script without its ending. */
const char *sf_plot_name(const sf_figures *figures);

/* Writes the script and the picture, which names the verdict and shows its limits. If gnuplot is absent or
 * fails, `warning` (size bytes) says so in a sentence, and that is no error; otherwise it is "". */
sf_status sf_plot_write(const sf_staging *output, const sf_summary *summary, char *warning, size_t size,
                        sf_error *err);

/* Instants (s) between which the axis of the pulse runs: where the model's curve is above 2 % of its largest
 * value, or the measured one above 5 %, and a margin; all of a run without a pulse. */
void sf_plot_time_range(const sf_figures *figures, const sf_comparison *comparison, double range[2]);

/* Returns the largest difference of two curves over the range, over the largest value of `a`: a curve with a
 * small one is not seen beside the other. */
double sf_plot_difference(const sf_series *a, const sf_series *b, const double range[2]);
