/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangulated bodies with known distances, for the tests of the missile's surface. */
#ifndef SF_TESTS_BODY_FIXTURE_H
#define SF_TESTS_BODY_FIXTURE_H

#include "pre/mesh/mesh.h"
#include "solver/contact/shapes.h"

/* A surface and the model around it that sf_body_build reads. */
typedef struct body {
    sf_surface surface;
    sf_model model;
    double spacing;       /* of the one contact node: the reach */
    int32_t contact_node; /* its number */
} body;

/* Octahedron of n x n triangles a face, its nodes on the sphere about `centre`; the triangles of an octant
 * follow each other, those of x, y, z >= 0 first. */
void body_ball(body *b, int n, double radius, const double centre[3]);
/* Square plate [0, side]^2 at z = 0 in n x n cells, facing down. */
void body_plate(body *b, int n, double side);
/* Tetrahedron, apex at the origin, opening upwards, with acute dihedral angles; its first face is a fan of
 * `slivers` triangles, the other two at the apex are the last triangles. `mirrored` turns it inside out. */
void body_spike(body *b, int slivers, bool mirrored);

/* The solver's surface of the body with the given reach; release both with body_free (surface may be
 * NULL). */
void body_build(body *b, double reach, sf_body *out);
void body_free(body *b, sf_body *surface);

double *body_node(body *b, int64_t i);
/* Unit normal of triangle t. */
void body_face_normal(const body *b, int64_t t, double n[3]);
/* Largest signed distance of x to the planes of the faces: exact inside a convex body. */
double body_largest_plane(const body *b, const double x[3]);

/* b - a, and a . b */
void body_vector(const double a[3], const double b[3], double out[3]);
double body_dot(const double a[3], const double b[3]);

#endif
