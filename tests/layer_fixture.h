/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pads of several layers in memory, for the tests and the verification study of layers. */
#ifndef SF_TESTS_LAYER_FIXTURE_H
#define SF_TESTS_LAYER_FIXTURE_H

#include "model_fixture.h"

/* The layer of a cell by the place of its centroid, in cells. */
typedef int (*layering)(const double cell[3]);

/* Gives the cells of a block's mesh their layers. */
void layers_assign(const fixture_block *block, layering layer, sf_mesh *mesh);
/* Makes `count` layers "A", "B" ... of the case's material. */
void layers_make(sf_case *c, int count);
/* The example case with `overrides`, held by the sets `held` (both up to NULL), and with `count` such layers.
 */
void layers_case(sf_case *c, const char *const *overrides, const char *const *held, int count);
/* Adds an interface of two layers. */
void layers_join(sf_case *c, int layer, int other, int kind, double friction);
/* Builds a block of the case's layers under a plate of 1 m; the case is released. */
void layers_under_plate(sf_case *c, const fixture_block *block, layering layer, fixture *out);
/* Nominal stress (Pa) of first loading at rest; fails the test if the law cannot be built. */
double layers_stress(const sf_material *material, double strain);
/* Replaces a foam by a linear elastic one without losses: stress = modulus (Pa) x strain up to 80 %. */
void layers_make_linear(sf_material *material, double modulus, double density);
/* Multiplies the stresses of the curve, and switches off hysteresis and every viscosity. */
void layers_make_elastic(sf_material *material, double factor);

#endif
