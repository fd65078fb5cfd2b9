/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foam cards, random deformations and dense algebra for the tests of material points and small lattices.
 * Matrices 3 x 3 are row-major. */
#ifndef SF_TESTS_POINT_FIXTURE_H
#define SF_TESTS_POINT_FIXTURE_H

#include "material/foam_card.h"
#include <stdint.h>

enum { POINT_CURVE_ROOM = 8192, POINT_CURVES = 3 };

/* A foam card and the storage behind its pointers: init in place, do not copy. */
typedef struct point_card {
    sf_foam_card card;
    int64_t ptr[POINT_CURVES + 1];
    double rate[POINT_CURVES];
    double strain[POINT_CURVE_ROOM]; /* - */
    double stress[POINT_CURVE_ROOM]; /* Pa */
} point_card;

/* Nominal stress (Pa) of an EVA-like foam: yield, plateau, densification; smooth and singular at 1. */
double point_eva_stress(double strain);

/* What all foams share, of one of this density (kg m-3) without hysteresis and viscosity. */
sf_foam_shared point_elastic_foam(double density);

/* Card without viscosity, hysteresis or cut-off, E = 0.4 MPa, rule H1, and no curve yet. */
void point_card_init(point_card *card);

/* Appends a curve of `count` points, strain ascending from 0. */
void point_card_add(point_card *card, double rate, int64_t count, const double *strain, const double *stress);

/* Appends `count` points of point_eva_stress, uniform up to `last`, times `factor`. */
void point_card_add_eva(point_card *card, double rate, int64_t count, double last, double factor);

/* Appends the straight line of the given modulus up to `last`. */
void point_card_add_line(point_card *card, double modulus, double last);

/* Uniform in [low, high). */
double point_random(uint64_t *seed, double low, double high);

void point_rotation(uint64_t *seed, double q[9]);
/* Rotation about the unit vector `axis` by `angle` (rad). */
void point_rotation_about(const double axis[3], double angle, double q[9]);
/* Left rotation x diagonal x right rotation, with stretches in [low, high). */
void point_deformation(uint64_t *seed, double low, double high, double f[9]);

void point_product(const double a[9], const double b[9], double out[9]);
void point_transpose(const double a[9], double out[9]);

/* Largest difference of two arrays. */
double point_distance(int count, const double *a, const double *b);
double point_norm(int count, const double *a);

/* Largest eigenvalue of the symmetric part of a [n][n], by GSL. */
double point_largest_eigenvalue(int n, const double *a);

#endif
