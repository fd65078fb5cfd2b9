/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_PRE_HOLD_H
#define SF_PRE_HOLD_H
#include "base/error.h"
#include "model/model.h"

/* The connected parts of a pad of layers: cells that share a face, within a layer or where all the nodes of
 * the face are tied in all components. Parts move rigidly against each other unless ties or supports hold
 * them. */

typedef struct sf_bodies {
    int64_t count;
    int64_t *cell;  /* [cell_count] owned */
    int32_t *node;  /* [node_count] owned; of a node where several bodies meet one of them */
    int32_t *first; /* [count] owned; the first node of each, ascending */
} sf_bodies;

/* Needs cells and ties of the model; a pad of one material and without ties is one body. On failure `*bodies`
 * is empty. */
sf_status sf_bodies_find(const sf_model *model, sf_bodies *bodies, sf_error *err);
void sf_bodies_free(sf_bodies *bodies);

/* Finds the rigid-body modes of the pad, and of its connected parts against each other, that base, anvil,
 * symmetry planes and ties leave free. */

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
 * rigid support may. */
sf_status sf_hold_check(const sf_hold *hold, const sf_model *model, sf_error *err);
/* Tells `sink` of an underside that is mostly free, and of a missile that pushes the pad along a free motion.
 */
void sf_hold_warn(const sf_hold *hold, const sf_model *model, const sf_sink *sink);
#endif
