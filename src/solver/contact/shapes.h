/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the bodies of a model by the table of shapes (contact/shape.h). */
#pragma once
#include "solver/contact/shape.h"

sf_status sf_body_of_missile(const sf_model *model, sf_body *missile, sf_error *err);
/* Makes the planes of bodies [SF_BODY_MISSILE]: the anvil, if the pad may reach it, and those of symmetry;
 * `spacing` (m): of the pad. */
sf_status sf_bodies_of_planes(const sf_model *model, double spacing, sf_body *body, sf_error *err);
void sf_body_free(sf_body *body);
