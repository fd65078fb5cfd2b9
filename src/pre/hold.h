/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the rigid-body modes of the pad, and of its connected parts against each other, that base, anvil,
 * symmetry planes and ties leave free. */
#pragma once
#include "model/model.h"

#define SF_HOLD_MOST 0.5 /* of the underside's nodes, held along z: mostly held */

typedef struct sf_hold {
    int64_t rows[3];         /* nodes held along x, y and z; those that rest are held along z */
    bool lifts;              /* some rigid motion with a vertical part is free */
    int64_t lifted;          /* the layer of a part that it moves */
    double lifted_middle[3]; /* m, of the part */
    bool lifted_whole;       /* the part is the whole layer */
    bool slides[2];          /* along x, y */
    bool turns;              /* about a vertical axis */
    double underside;        /* share of the nodes of the pad's underside that are held along z or rest */
    double underside_low;    /* m, its z */
} sf_hold;

/* Needs positions and constraints of the model. */
sf_status sf_hold_find(const sf_model *model, sf_hold *hold, sf_error *err);

/* SF_ERR_INPUT if the pad or a layer can be moved vertically or tilted without being deformed; a pad on a
 * rigid support may, and so may `separate` bodies, which lie where they are until they are hit. Also of foam
 * with a permanent set that may move at all without being deformed, and of several sets. */
sf_status sf_hold_check(const sf_hold *hold, bool separate, const sf_model *model, sf_error *err);
/* Tells `sink` of a mostly free underside, and of a missile that pushes the pad along a free motion. */
void sf_hold_warn(const sf_hold *hold, const sf_model *model, const sf_sink *sink);
/* Tells `sink` of bodies of a pad that neither the missile on its way nor a body that it may move comes near.
 */
sf_status sf_hold_warn_apart(const sf_model *model, const sf_sink *sink, sf_error *err);
