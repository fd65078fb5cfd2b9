/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rotation of a rigid body: angular momentum L in space, orientation q (base/mat3.h), and the inertia
 * tensor (kg m2, xx, yy, zz, xy, yz, xz) about the centre of mass in the body's axes. docs/adr/0018 */
#ifndef SF_BASE_RIGID_H
#define SF_BASE_RIGID_H

/* omega = R I^-1 R^T L (rad s-1). */
void sf_rigid_angular_velocity(const double inertia[6], const double q[4], const double momentum[3],
                               double omega[3]);
/* R I^-1 R^T (kg-1 m-2), like the inertia. */
void sf_rigid_mobility(const double inertia[6], const double q[4], double mobility[6]);
/* I omega, both in the body's axes. */
void sf_rigid_momentum(const double inertia[6], const double omega[3], double momentum[3]);
/* A symmetric matrix times a vector. */
void sf_rigid_product(const double matrix[6], const double v[3], double out[3]);

/* The turn (sf_rotation_advance), in space, of a body without torque in `dt` (s): the implicit midpoint rule
 * of Euler's equations, whose steps keep |L| and the kinetic energy. Second order, symmetric in time. */
void sf_rigid_turn(const double inertia[6], const double q[4], const double momentum[3], double dt,
                   double turn[3]);

#endif
