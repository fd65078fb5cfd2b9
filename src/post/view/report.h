/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.html: one page to hand on, self-contained, usually two sides of A4: verdict, what was dropped on
 * what, the deformed pad at the peak, the mid-section at three instants, curves, figures, material, mesh and
 * where it all comes from. A picture that cannot be made is replaced by the reason. */
#ifndef SF_POST_REPORT_H
#define SF_POST_REPORT_H

#include "post/view/summary.h"

typedef struct sf_report {
    const sf_summary *summary;
    const char *command_line; /* of softfall-post */
} sf_report;

/* After sf_plot_write, whose picture the page takes in. */
sf_status sf_report_write(const sf_staging *output, const sf_report *report, sf_error *err);

#endif
