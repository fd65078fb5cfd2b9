/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of shapes, and the bodies that a model has of them. */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape *const sf_shapes[]; /* NULL behind the last */

/* Returns the triangles of a body whose sharp edges press the pad, or of all supports for one of them; none
 * of a body of another shape. */
sf_shape_triangles sf_shape_triangles_of(const sf_model *model, int body);

/* Makes a body of the model that is no part of the skin, for contact points of its largest spacing; *body is
 * empty if the model has none. */
sf_status sf_body_build(const sf_model *model, int number, sf_body *body, sf_error *err);
void sf_body_free(sf_body *body);
