/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Centre of mass and inertia of a missile with six degrees of freedom. */
#ifndef SF_PRE_MISSILE_BODY_H
#define SF_PRE_MISSILE_BODY_H

#include "case/case.h"
#include "pre/mesh/mesh.h"

/* Sets the card's freedom, centre, inertia and angular velocity by the case; what it does not give comes from
 * the solid: the missile's cells, or its closed surface, with uniform density; where its surface is a sphere,
 * with what lies between the triangles and the sphere. The card has mass and shape; the surface is not placed
 * yet, the centre lies by it. SF_ERR_INPUT: there is no solid, or no body can have this inertia. */
sf_status sf_missile_take_body(const sf_case *c, const sf_surface *surface, sf_missile_card *card,
                               sf_error *err);

#endif
