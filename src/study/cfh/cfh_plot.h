/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cfh.gp and cfh.png: a_max and HIC over the drop height with limits, points, fits and crossings. */
#ifndef SF_CFH_PLOT_H
#define SF_CFH_PLOT_H

#include "study/cfh/cfh_report.h"

/* `warning` (size bytes) says why there is no picture, or is "". */
sf_status sf_cfh_plot(const sf_staging *output, const sf_cfh_report *report, char *warning, size_t size,
                      sf_error *err);

#endif
