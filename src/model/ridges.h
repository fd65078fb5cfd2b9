/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/error.h"
#include <stdint.h>

/* The sharp edges and vertices of a triangulated rigid surface: those that would enter the faces of a pad
 * between its nodes by more than a small part of its spacing. An edge of facets that turn by the angle a,
 * each L wide, enters a chord of the length h by h a / 4, or by h^2 a / 8 L if its facets are smaller than
 * the chord. */

#define SF_SMOOTH_DEPTH (1.0 / 16)  /* of the spacing, in a solid */
#define SF_SECTION_DEPTH (1.0 / 32) /* of the spacing, in a section, where corners cost next to nothing */

/* The pad decides what is sharp: by its spacing, and by its symmetry planes, in which a body goes on as its
 * mirror image. */
typedef struct sf_ridge_limits {
    double place[2]; /* m, of the symmetry planes x and y; NAN: there is none */
    double spacing;  /* m, of the pad */
    double depth;    /* largest depth of a smooth surface, of the spacing */
} sf_ridge_limits;

/* A sharp convex edge between two facets. An edge where the surface ends is none: what lies beyond is not
 * known. In a symmetry plane the body goes on as its mirror image. */
typedef struct sf_ridge {
    int32_t node[2];  /* of the surface */
    double arm[2][3]; /* unit vectors in its facets, across the edge and away from it */
    int64_t facet;    /* one of the two */
} sf_ridge;

typedef struct sf_ridges {
    int64_t count;
    sf_ridge *ridge; /* [count]; none that lies in a symmetry plane, where nodes of the pad lie as well */
    int64_t corner_count;
    int32_t *corner; /* [corner_count] nodes at the ends of such edges and at sharp tips, ascending */
    int32_t *facet;  /* [corner_count] one at each */
    int64_t *ptr;    /* [corner_count + 1] */
    double *arm;     /* [..][3] unit vectors along the edges that leave each corner */
} sf_ridges;

/* Nodes at one place count as one. Release with sf_ridges_free, also after a failure. */
sf_status sf_ridges_find(int64_t node_count, const double *position, int64_t triangle_count,
                         const int32_t *triangle, const sf_ridge_limits *limits, sf_ridges *out,
                         sf_error *err);
void sf_ridges_free(sf_ridges *ridges);
