/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sharp vertices and edges of a rigid body against the faces of the pad, between its nodes (theory, section
 * "Sharp edges"). A vertex presses a face where it lies over it, along the face's normal; an edge presses a
 * line, an edge of two faces, where they cross, along the normal of both. The depth of a straight edge in
 * triangles is largest at such places, so that nothing else enters. Their forces are unknowns of the solve
 * that the nodes are in (contact/solve.h). In a section it is a corner of the missile's profile that presses
 * a side of the pad: the edge is that of the profile's facets which goes through y = 0. */
#pragma once
#include "model/ridges.h"
#include "solver/contact/solve.h"

/* A body and the faces that it may press; constants. */
typedef struct sf_sharp {
    int64_t face_count; /* 0: nothing is sharp */
    int32_t *face;      /* [face_count][3] points, turned outwards */
    int32_t *face_line; /* [face_count][3] line from each corner to the next, at its first face; -1: none */
    int64_t line_count;
    int32_t *line; /* [line_count][4] two points, and the third ones of both faces; -1 or -2 in place of the
                      last: mirror image of the first, beyond the symmetry plane normal to x or y. Of a
                      section a side, counter-clockwise, and two times -3 */
    sf_ridges ridges;
    uint8_t *corner_plane;  /* [ridges.corner_count] bits of the symmetry planes that a corner lies in */
    const double *position; /* [..][3] m, of the body's surface at t = 0; borrowed */
    double spacing;         /* m, smallest of the pad's points */
} sf_sharp;

/* These find the sharp parts of the missile, `spacing` (m) being the smallest of the contact points, and of
 * the supports, whose sharp vertices are passive nodes of the skin from now on. Release with sf_sharp_free.
 */
sf_status sf_sharp_build_missile(const sf_model *model, double spacing, sf_sharp *sharp, sf_error *err);
sf_status sf_sharp_build_supports(const sf_model *model, sf_skin *skin, sf_sharp *sharp, sf_error *err);
void sf_sharp_free(sf_sharp *sharp);

/* This has the places of all at the time of a step. */
typedef struct sf_sharp_place {
    const sf_model *model;
    const sf_missile *missile;     /* the body; NULL: a support, which rests */
    sf_missile_response *response; /* of the missile, or NULL */
    const double *position, *step; /* [points][3] m, now and of the next step, without contact forces */
} sf_sharp_place;

/* Lists what may meet within `reach` (m), which becomes less if there is no room, and marks the points that
 * take part, in `used`. Needs the positions of all points. */
sf_status sf_sharp_list(const sf_sharp *sharp, const sf_sharp_place *place, double *reach, uint8_t *used,
                        sf_sharp_state *state, sf_error *err);

/* Most pairs of a step; 0: nothing is sharp. */
int64_t sf_sharp_room(const sf_sharp *sharp);

/* Adds the pairs that close in the next step of `dt` (s), with the forces of the last one. `deepest` (m):
 * grows to the largest depth of a pair now. */
sf_status sf_sharp_add(const sf_sharp *sharp, const sf_sharp_place *place, double dt, sf_sharp_state *state,
                       sf_contact_system *system, double *deepest, sf_error *err);
