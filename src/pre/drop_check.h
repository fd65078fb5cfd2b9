/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether a model makes sense as a drop: those checks that need the case and the group names of the
 * geometry, which sf_model_check does not have. Among them is the expected error of a_max from the spacing
 * under the missile, by which the mesh is judged. */
#pragma once
#include "case/case.h"
#include "pre/mesh/mesh.h"

/* The law: C (h/t)^2 + D (h/w)^2 with the thickness t and the half width w of the contact zone; C and D are
 * calibrated in docs/theory.md, section 11. */
#define SF_MESH_ERROR_THICKNESS 0.5
#define SF_MESH_ERROR_WIDTH 0.35

#define SF_CONTACT_ZONE_DEPTH 0.5 /* of the thickness: how deep the missile stands there */

/* The part of the pad that the missile touches when it stands half a thickness deep in it. */
typedef struct sf_contact_zone {
    double area;       /* m2, of the whole pad's surface */
    double half_width; /* m, across its narrow direction: the radius of a round zone; of a part that leads,
                          its own as it grows to that depth */
    double spacing;    /* m, root mean square of the pad below it */
} sf_contact_zone;

/* The model has its cloud, its sets and its missile. */
void sf_contact_zone_measure(const sf_model *model, sf_contact_zone *zone);

/* Expected relative error of a_max, or 0 with a prescribed motion, which has no a_max. */
double sf_mesh_error_expect(const sf_model *model, const sf_contact_zone *zone);

/* SF_ERR_INPUT, naming the key, the value and the bound: the pad's thickness is not one of a pad; the
 * missile starts inside the pad; it is not symmetric to a symmetry plane, or cut open where there is none.
 * The model has its nodes, its sets and its missile; the mesh still has its sets. */
sf_status sf_drop_check(const sf_case *c, const sf_mesh *mesh, const sf_model *m, sf_error *err);
/* The same, of all that the missile may touch: the mesh is too coarse for pad.mesh_error_limit; its share in
 * the model is lighter than a node; it turns into the pad before it arrives. */
sf_status sf_drop_check_contact(const sf_case *c, const sf_model *m, const sf_contact_zone *zone,
                                sf_error *err);

/* Warns of a symmetry group of the geometry that the case does not hold, of a material where the solver is
 * known to be weak (sf_law.caution), and of a mass that its body cannot have. `volume`: m3, of the missile's
 * body; 0: unknown. */
void sf_drop_warn(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_contact_zone *zone,
                  double volume, const sf_sink *sink);

/* Warns of a coarse mesh by its spacing, where no drops of the section tell its error. */
void sf_drop_warn_mesh(const sf_model *m, const sf_contact_zone *zone, const sf_sink *sink);
