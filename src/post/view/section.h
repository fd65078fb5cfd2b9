/* SPDX-License-Identifier: GPL-3.0-or-later */
/* section.csv: the pad's mid-section at the instant of the largest acceleration. Rows of the set `section`
 * are the nodes of the vertical plane y = constant through the missile's axis (nodes within half their own
 * spacing of it); rows of the set `axis` are points under the axis, evenly spaced through the thickness,
 * interpolated linearly in the cells. */
#ifndef SF_POST_SECTION_H
#define SF_POST_SECTION_H

#include "io/staging.h"
#include "post/results/results.h"

enum { SF_SECTION_STATIONS = 41 }; /* points under the axis */

/* A point of the section: the mean of up to 4 nodes with barycentric weights. */
typedef struct sf_section_point {
    int32_t node[4];
    double weight[4];
    double fit; /* smallest weight: 0 or more inside the tetrahedron, the best so far while searching */
} sf_section_point;

/* The points under the axis, top to bottom, evenly spaced; returns the height of the top (m). */
double sf_section_stations(const sf_results *results, sf_section_point station[SF_SECTION_STATIONS]);
/* Is the point in a cell? Otherwise its mean means nothing. */
bool sf_section_inside(const sf_section_point *point);
/* A component of a field ([node_count][components]) there. */
double sf_section_mean(const double *field, int components, int component, const sf_section_point *point);

/* From /peak, or without it the frame of the largest acceleration. `*written` is false if that holds no von
 * Mises stress: then there is no file. */
sf_status sf_section_write(const sf_staging *output, const sf_results *results, bool *written, sf_error *err);

#endif
