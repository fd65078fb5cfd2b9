/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pairs of the pad's contact with itself; those of two sharp edges that cross, which nodes against faces
 * do not see before an edge has sunk in by up to half a spacing (docs/adr/0024). */
#pragma once
#include "solver/contact/skin.h"
#include "solver/state.h"

/* A point of the skin and what it touches, or two edges. */
typedef struct sf_touch {
    int64_t node, facet; /* of two edges: a node of the one, a facet at the other */
    double weight[4];    /* of the facet's nodes, sf_skin_corner; zeros for a plane and for edges */
    int parts;           /* the nodes of both, with their shares of the force */
    int32_t part[7];
    double share[7];
    double lean[7][3]; /* a force q acts on a part as share q + (lean . q) normal: zeros without friction */
    double normal[3];  /* outward from the facet */
    double gap;        /* m, now; of a depth the part that the step takes back */
    double friction;   /* -, Coulomb coefficient */
    double *force;     /* [3] N, on the point; borrowed */
} sf_touch;

/* Displacement of the point relative to its partner, of a field over the skin. */
void sf_touch_relative(const sf_touch *pair, const double *field, double out[3]);

/* Friction acts on the point and on its partner `gap` apart along the normal. This gives three nodes of the
 * pair, which are on no line, the leans by which forces along the normal take up that moment: then angular
 * momentum holds, and the relative motion is that of one place. Needs parts, normal and gap. */
void sf_touch_lean(const sf_state *state, const int32_t node[3], sf_touch *pair);

/* Weights that are rounding cost as much as others: they become zero, and the sum stays one. */
void sf_touch_drop_traces(double weight[4]);

/* Writes the pairs of edges that close in the next step to `pair` [edge_count], without friction and force;
 * returns their number. `back` (m): the part of a depth that a step takes back. */
int64_t sf_touch_edges(const sf_skin *skin, const sf_state *state, double back, sf_touch *pair);
