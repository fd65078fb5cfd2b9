/* SPDX-License-Identifier: GPL-3.0-or-later */
/* view.html: the drop in a browser, one page without anything to load: share/softfall/view.html with the
 * facts and arrays of the drop in it as JSON. Numbers of the arrays have 16 bits between the least and the
 * largest value of a frame; the page states the error. */
#pragma once
#include "post/view/summary.h"
#include "post/view/xdmf.h"

enum { SF_BROWSER_MOST_MB = 200 }; /* beyond that a browser may have no memory for it */

/* After pad.xdmf; before report.html, which links it. The page has at most so many MB: fewer frames than
 * there are, or the skin without the inside; the page says so. `warning` (size bytes) says why there is no
 * page, or is ""; with 0 MB, or without frames, there is none and no warning. */
sf_status sf_browser_write(const sf_staging *output, const sf_summary *summary, const sf_xdmf *made,
                           double megabytes, char *warning, size_t size, sf_error *err);
