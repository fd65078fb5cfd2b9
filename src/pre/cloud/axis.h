/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The axis of a section: u_R = 0 there, a constraint of the model, in the hoop rows. */
#pragma once
#include "model/model.h"

/* Makes the hoop row of every domain one of the fields with u_R = 0 on the axis: b_theta becomes b_theta P
 * with the projection P = I - M^-1 G^T (G M^-1 G^T)^-1 G of these constraints (theory, section "Axisymmetric
 * drops"). F_theta theta and the motion are the same, as u_R and the acceleration are in the range of P; but
 * the bound of the time step and the power iteration, which know no constraints, no longer see a hoop strain
 * of the axis nodes themselves, which is the stiffest of all. Needs masses and constraints. */
sf_status sf_axis_project(sf_model *model, sf_error *err);
