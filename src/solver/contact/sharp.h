/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sharp vertices and edges of a rigid body against the faces of the pad, between its nodes (theory, section
 * "Sharp edges"). A vertex presses a face where it lies over it, along the face's normal; an edge presses a
 * line, an edge of two faces, where they cross, along the normal of both. The depth of a straight edge in
 * triangles is largest at such places, so that nothing else enters. Their forces are unknowns of the solve
 * that the nodes are in (contact/solve.h). In a section it is a corner of the missile's profile that presses
 * a side of the pad: the edge is that of the profile's facets which goes through y = 0. */
#pragma once
#include "model/ridges.h"
#include "solver/contact/skin.h"

/* The sharp parts of a body; constants. */
typedef struct sf_sharp {
    bool is_there; /* false: nothing is sharp, or there are no faces to press */
    sf_ridges ridges;
    uint8_t *corner_plane;  /* [ridges.corner_count] bits of the symmetry planes that a corner lies in */
    const double *position; /* [..][3] m, of the body's surface at t = 0; borrowed */
} sf_sharp;

/* Finds the sharp parts of a body of these triangles. Release with sf_sharp_free. */
sf_status sf_sharp_build(const sf_model *model, const sf_shape_triangles *triangles, const sf_skin *skin,
                         sf_sharp *sharp, sf_error *err);
void sf_sharp_free(sf_sharp *sharp);

extern const sf_shape sf_shape_sharp;
