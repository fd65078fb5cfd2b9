/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/grid.h"
#include "solver/contact/pair.h"

/* Lists of candidates in the making (contact/broad.h), with the facets of pad and supports as they lie now,
 * each in a ball, and their grids; all in memory of the state. */
typedef struct sf_listing {
    double reach;            /* m, of the lists */
    uint8_t *used;           /* [points] 1: the lists need the point */
    double *centre, *radius; /* [facets] m */
    sf_grid pad, support;    /* the support's facets are numbered from 0 */
    int32_t *found;          /* [facets] room for a query */
} sf_listing;

/* Finds the facets, once. */
sf_status sf_listing_facets(const sf_scene *scene, sf_listing *listing, sf_error *err);
/* Returns the distance (m) of x and a facet of the skin now. */
double sf_listing_distance(const sf_scene *scene, const double x[3], int64_t facet);
