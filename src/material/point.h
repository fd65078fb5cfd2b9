/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A material point of a law of the solver (material/laws.h) in uniaxial compression: what a
 * written card gives in the test that it was fitted to. */
#pragma once
#include "material/laws.h"

/* Sets F [9] of every lane to a stretch along z. */
void sf_material_point_stretch(double f[9][SF_LANES], double stretch);

/* Takes the point through `strain` [count] (from rest, in order) at the nominal rate (s-1), in steps of at
 * most `step` strain; `stress` [count] receives the compressive nominal stress (Pa). */
void sf_material_point_drive(const sf_material_law *law, double rate, double step, int count,
                             const double *strain, double *stress);
