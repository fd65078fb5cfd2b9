/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile's surface: its hull, its orientation (contact sees only what its normals face), whether it is a
 * sphere cap, and where it first touches the pad. */
#pragma once
#include "model/model.h"
#include "pre/mesh/mesh_raw.h"

/* Adds the hull to a surface that was assembled from the same mesh: of all cells that are joined through
 * faces to one behind it. Without cells there is none. */
sf_status sf_hull_assemble(const sf_raw_mesh *raw, double unit, sf_surface *surface, sf_error *err);

/* Parts (triangles joined by edges) without cells behind them are turned as one: a closed part outwards, or,
 * within an odd number of other closed ones, into the cavity that it bounds; an open one so that its area
 * faces along `direction`, as the missile's motion. Parts with cells behind them stay as they are.
 * SF_ERR_INPUT: a part is one-sided (a Moebius strip). */
sf_status sf_surface_turn(sf_surface *surface, const double direction[3], sf_error *err);
/* The same, and refuses a surface that nowhere faces along `direction`. */
sf_status sf_surface_orient(sf_surface *surface, const double direction[3], sf_error *err);

/* Least-squares sphere through the surface's nodes. `*deviation` is the largest distance of a node from it
 * divided by the radius. Fails on fewer than 4 nodes or coplanar ones. */
sf_status sf_missile_fit_sphere(const sf_surface *surface, double centre[3], double *radius,
                                double *deviation, sf_error *err);

/* Sets shape, sphere_* of the card from the surface by `rule` (0 auto, 1 sphere, 2 surface): a surface is a
 * sphere when its nodes deviate by less than 1e-6 of the radius. */
sf_status sf_missile_set_shape(const sf_surface *surface, int rule, sf_missile_card *card, sf_error *err);

/* Distance (m, any sign) that the missile must travel along its direction until its surface touches one of
 * the `count` points; SF_ERR_MODEL if its path misses them all. */
sf_status sf_missile_distance(const sf_surface *surface, const sf_missile_card *card, const double *position,
                              int64_t count, const int32_t *node, double *distance, sf_error *err);

/* Travel (m) of a triangle along the direction until it touches x, negative if it has passed x: intersection
 * with the line through x (Moeller and Trumbore 1997). Infinity if it is missed or the line is in its plane.
 */
double sf_triangle_travel(const double *a, const double *b, const double *c, const double direction[3],
                          const double x[3]);

/* The same distance to one point; infinity if the path misses it. */
double sf_missile_travel(const sf_surface *surface, const sf_missile_card *card, const double x[3]);

/* The missile's surface of a model; borrowed. */
sf_surface sf_surface_of_missile(const sf_model *model);
