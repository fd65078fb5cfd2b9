/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One material point at a time, and its tangent by differences, for the tests of the foam law. */
#ifndef SF_TESTS_FOAM_FIXTURE_H
#define SF_TESTS_FOAM_FIXTURE_H

#include "foam_reference.h"
#include "point_fixture.h"
#include "material/low_density_foam.h"

/* Builds the foam of a card; ends the running test if that fails. */
void foam_build(const point_card *card, sf_foam *foam);

/* Undeformed batch, without history, lengths 1 m. */
void foam_reset(sf_law_batch *batch);
void foam_set(double matrix[9][SF_LANES], int lane, const double f[9]);
void foam_get(double matrix[9][SF_LANES], int lane, double out[9]);
/* Puts F of lane 0 into all lanes' f_old and `f` into all lanes' f, then updates. */
void foam_step(const sf_foam *foam, double dt, const double f[9], sf_law_batch *batch);

/* P, W and the tangent bound at F without viscosity, when the largest W so far was `peak`. */
typedef struct foam_point {
    double p[9];
    double energy, tangent, factor, stiffness;
} foam_point;
foam_point foam_elastic(const sf_foam *foam, const double f[9], double peak);

/* diag(stretch, 1, 1) */
void foam_uniaxial(double stretch, double f[9]);

/* A law at points: `update` of sf_law with its numbers. */
typedef struct point_law {
    void (*update)(const void *numbers, double dt, sf_law_batch *batch);
    const void *numbers;
    double maxwell; /* Pa, its scale for random stresses of the Maxwell branch */
    bool away;      /* keep random W away from its largest: where ALPHA < 1 has no tangent */
} point_law;
void point_law_step(const point_law *law, double dt, const double f[9], sf_law_batch *batch);
void point_law_tangent(const point_law *law, double dt, const sf_law_batch *batch, double tangent[81]);
/* As foam_assert_tangent_bounds, from stretches between `low` and `high`. */
void point_law_assert_bounds(const point_law *law, uint64_t *seed, double low, double high, double dt);

/* dP/dF [9][9] at batch->f by central differences, over a step `dt` from batch->f_old with the batch's
 * history. */
void foam_tangent(const sf_foam *foam, double dt, const sf_law_batch *batch, double tangent[81]);

/* Asserts that dF : tangent : dF is at most the batch's bound of lane 0, as one number and by direction. */
void foam_assert_bounds(const sf_law_batch *batch, const double tangent[81]);

/* Asserts that the bounds cover the numerical tangent over a step of dt (s) from a random
 * deformation at a random rate, with random history. */
void foam_assert_tangent_bounds(const sf_foam *foam, uint64_t *seed, double dt);

#endif
