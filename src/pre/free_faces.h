/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface of the pad, and the part of it that may touch the pad itself or the anvil. */
#pragma once
#include "pre/cloud/layers.h"

/* The free faces of the model's cells as triangles, turned outwards: *node [*count][3], and, unless `half` is
 * NULL, *half [*count] as of sf_model.skin_half; owned by the caller. Faces between layers are among them,
 * once for each layer. */
sf_status sf_skin_triangles(const sf_model *model, int64_t *count, int32_t **node, uint8_t **half,
                            sf_error *err);

/* Sets the model's skin by pad.self_contact: "off" none; "on" the surface but for faces that are tied to
 * another layer or held along their normal; "auto" the same if the foam can touch itself or the anvil, that
 * is, if a ray from a face outwards meets another face of it, its mirror image, or the anvil, within the
 * pad's thickness, or layers are loose. With a rigid support it is there in any case, `skin_alone` if it
 * touches that only. `unheld` (m): the middle of such a face of a pad without skin; NaN: there is none. Needs
 * cells, constraints, ties, thickness and the anvil's depth. */
sf_status sf_skin_find(const sf_case *c, sf_model *model, double unheld[3], sf_error *err);

/* Adds the nodes of the other free faces that are neither held altogether nor part of the base to the contact
 * points, with their areas. What places the missile and measures the pad goes by those of pad.contact and
 * comes before. Needs cells, constraints, ties and masses. */
sf_status sf_contact_add_free(const sf_layers *layers, sf_model *model, sf_error *err);
