/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The connected parts of a pad of layers: cells that share a face, within a layer or where all the nodes of
 * the face are tied in all components. Parts move rigidly against each other unless ties or supports hold
 * them. */
#ifndef SF_PRE_BODIES_H
#define SF_PRE_BODIES_H

#include "base/error.h"
#include "model/model.h"

typedef struct sf_bodies {
    int64_t count;
    int32_t *cell;  /* [cell_count] owned */
    int32_t *node;  /* [node_count] owned; of a node where several bodies meet one of them */
    int32_t *first; /* [count] owned; the first node of each, ascending */
} sf_bodies;

/* Needs cells and ties of the model; a pad of one material and without ties is one body. On failure `*bodies`
 * is empty. */
sf_status sf_bodies_find(const sf_model *model, sf_bodies *bodies, sf_error *err);
void sf_bodies_free(sf_bodies *bodies);

#endif
