/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pictures of a sweep, each a gnuplot script that holds its data. */
#ifndef SF_SWEEP_PLOT_H
#define SF_SWEEP_PLOT_H

#include "io/staging.h"
#include "study/sweep/analysis.h"

/* The pictures there may be, NULL at the end, and what each shows. */
typedef struct sf_sweep_picture {
    const char *name, *caption;
} sf_sweep_picture;
const sf_sweep_picture *sf_sweep_pictures(void);

/* Writes NAME.gp and NAME.png of each picture that the runs allow. `folder`: that of the results' folders
 * ("DIR/runs"). `warning`: as sf_chart_write. */
sf_status sf_sweep_plot(const sf_staging *output, const sf_analysis *analysis, const char *folder,
                        char *warning, size_t size, sf_error *err);

#endif
