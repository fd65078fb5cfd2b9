/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The facets that each node of the skin may touch soon: the broad phase of the pad's contact with itself,
 * made anew when the fastest node may have left its list. */
#pragma once
#include "solver/contact/sharp.h"
#include "solver/state.h"

/* Sets the lists of candidates, those of the supports' sharp edges too, of the nodes that have some or can
 * reach a plane, and of those whose positions these need. Needs self_position of all nodes. */
sf_status sf_candidates_find(const sf_skin *skin, const sf_sharp *sharp, const sf_sharp_place *place,
                             sf_state *state, sf_error *err);

/* Takes the last step's travel off the room of the lists; false: they must be made anew. */
bool sf_candidates_last(const sf_skin *skin, sf_state *state);
