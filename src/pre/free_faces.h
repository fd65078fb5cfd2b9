/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface of the pad: the part of it that may touch the pad itself or the anvil, and the covers without
 * cells on it, membranes (theory, section "Membranes"). */
#pragma once
#include "pre/cloud/layers.h"
#include "pre/drop_check.h"

/* Sets the model's skin by pad.self_contact: "off" none; "on" the surface but for faces that are tied to
 * another layer or held along their normal; "auto" the same if the foam can touch itself or the anvil, that
 * is, if a ray from a face outwards meets another face of it, its mirror image, or the anvil, within the
 * pad's thickness, or layers are loose. With a rigid support it is there in any case, `skin_alone` if it
 * touches that only. `unheld` (m): the middle of such a face of a pad without skin; NaN: there is none. Needs
 * cells, constraints, ties, thickness and the anvil's depth. SF_ERR_INPUT: hexahedra that do not match slide
 * on each other without friction. */
sf_status sf_skin_find(const sf_case *c, sf_model *model, double unheld[3], sf_error *err);

/* Adds the nodes of the other free faces that are neither held altogether nor part of the base to the contact
 * points, with their areas, and to those of pad.contact the area of such faces that look at the missile;
 * where there are some, the zone and the expected mesh error count them. Sets the faces that a missile of
 * triangles may press between the nodes. What places the missile and measures
 * the pad goes by the points of pad.contact and comes before. Needs cells, constraints, ties and masses. */
sf_status sf_contact_add_free(const sf_layers *layers, sf_model *model, sf_contact_zone *zone, sf_error *err);

/* Sets what a missile of triangles may press between the nodes of a section: its free sides between contact
 * points. */
sf_status sf_contact_take_sides(sf_model *model, sf_error *err);

/* Sets the model's membrane to the faces of the case's groups on the surface of the whole mesh. SF_ERR_INPUT:
 * a group has no face there, or two of them share one. */
sf_status sf_membrane_take(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                           const sf_layers *layers, sf_model *model, sf_error *err);
/* Adds its mass to those of the nodes. */
void sf_membrane_weigh(sf_model *model);
