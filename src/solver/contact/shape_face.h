/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/contact/pair.h"

/* Finds the outward normals of the sides of the points that may touch, weighted by the areas of their facets;
 * of a centroid the mean of its nodes'. */
void sf_faces_turn(const sf_scene *scene);

/* Outward normal now of a facet, of twice its area. */
static inline void sf_facet_normal(const sf_scene *scene, int64_t facet, double normal[3]) {
    sf_face_normal(scene->at->position, &scene->skin->facet[3 * facet], normal);
}
