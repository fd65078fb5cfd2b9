/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A manufactured finite-strain solution on a cube: u = A X + w, strong uniaxial compression with sideways
 * extension (A), and an irregular w that vanishes on the cube's surface. The stretch along z runs from about
 * 0.45 to 0.85, those across stay above 1, so that no point crosses the kink of the law at 1. */
#ifndef SF_VERIFY_MMS_FIELD_H
#define SF_VERIFY_MMS_FIELD_H

#include "material/low_density_foam.h"

typedef struct sf_mms_field {
    double side;         /* m, the cube is [0, side]^3 */
    double stretch[3];   /* -, 1 + diagonal of A */
    double amplitude[3]; /* -, of w, in units of the side */
} sf_mms_field;

/* The field on a cube of `side` (m). */
sf_mms_field sf_mms_field_on(double side);

/* w (m) at x, and F there (row-major). */
void sf_mms_disturbance(const sf_mms_field *field, const double x[3], double w[3]);
void sf_mms_gradient(const sf_mms_field *field, const double x[3], double f[9]);

/* First Piola-Kirchhoff stress (Pa) of `foam`, elastic, at x; stretches [3] too unless NULL. */
void sf_mms_stress(const sf_mms_field *field, const sf_foam *foam, const double x[3], double p[9],
                   double stretch[3]);

/* Body force (N m-3, of the reference volume) that holds the field in equilibrium: - Div P, by central
 * differences of fourth order over 2e-5 of the side. */
void sf_mms_body_force(const sf_mms_field *field, const sf_foam *foam, const double x[3], double b[3]);

#endif
