/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Is the mesh fine enough? The expected error of a_max from the spacing under the missile. */
#ifndef SF_PRE_MESH_ERROR_H
#define SF_PRE_MESH_ERROR_H

#include "model/model.h"

/* The law: C (h/t)^2 + D (h/w)^2 with the thickness t and the half width w of the contact zone; C and D are
 * calibrated in docs/theory.md, section 11. */
#define SF_MESH_ERROR_THICKNESS 0.5
#define SF_MESH_ERROR_WIDTH 0.35

/* The part of the pad that the missile touches when it stands half a thickness deep in it. */
typedef struct sf_contact_zone {
    double area;       /* m2, of the whole pad's surface */
    double half_width; /* m, across its narrow direction: the radius of a round zone */
    double spacing;    /* m, root mean square of the pad below it */
} sf_contact_zone;

/* The model has its cloud, its sets and its missile. */
void sf_contact_zone_measure(const sf_model *model, sf_contact_zone *zone);

/* Expected relative error of a_max, or 0 with a prescribed motion, which has no a_max. */
double sf_mesh_error_expect(const sf_model *model, const sf_contact_zone *zone);

#endif
