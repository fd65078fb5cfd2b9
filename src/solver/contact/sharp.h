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

struct sf_contact_system;

/* The sharp parts of a body; constants. */
typedef struct sf_sharp {
    bool is_there; /* false: nothing is sharp, or there are no faces to press */
    sf_ridges ridges;
    uint8_t *corner_plane;  /* [ridges.corner_count] bits of the symmetry planes that a corner lies in */
    const double *position; /* [..][3] m, of the body's surface at t = 0; borrowed */
} sf_sharp;

/* Finds the sharp parts of the missile, or of the supports. Release with sf_sharp_free. */
sf_status sf_sharp_build(const sf_model *model, bool missile, const sf_skin *skin, sf_sharp *sharp,
                         sf_error *err);
void sf_sharp_free(sf_sharp *sharp);

/* Place (m) now of a node of the body. */
void sf_sharp_node(const sf_scene *scene, int32_t node, double out[3]);

/* Most pairs of a step; 0: nothing is sharp. */
int64_t sf_sharp_room(const sf_sharp *sharp, const sf_skin *skin);

/* Adds the pairs that close in the next step, with the forces of the last one, to those of the scene. */
sf_status sf_sharp_add(const sf_scene *scene, struct sf_contact_system *system, sf_error *err);
