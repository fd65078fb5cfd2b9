/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foam law as plain scalar code, one point at a time, written from the theory (section "Foam"): what the
 * vectorised kernel is compared with. */
#ifndef SF_TESTS_FOAM_REFERENCE_H
#define SF_TESTS_FOAM_REFERENCE_H

#include "material/low_density_foam.h"

/* Recoverable energy and energy lost to hysteresis (J m-3) at W and its maximum (theory eq. 15, 16). */
void sf_foam_energies(const sf_foam *foam, double energy, double peak, double *stored, double *lost);

/* sf_foam_update for lane l alone. */
void foam_reference_update(const sf_foam *foam, double dt, sf_law_batch *batch, int l);

#endif
