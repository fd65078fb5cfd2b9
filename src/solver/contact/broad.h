/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The broad phase of a solve: lists of what may touch soon, which each shape makes (contact/shape.h). They
 * are made anew when the fastest may have left them. */
#pragma once
#include "solver/contact/pair.h"

/* Takes the last step's travel off the room of the lists; true: they must be made anew. Then all points are
 * listed as near. */
bool sf_broad_is_due(const sf_scene *scene);

/* Makes the lists: candidates, the points that may touch (close), and those whose positions these need
 * (near). Needs the positions of all points. */
sf_status sf_broad_list(const sf_scene *scene, sf_error *err);
