/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs of contact: a point of the pad, or of two sharp edges of it that cross, and what it touches. To the
 * solve (contact/solve.h) and the ledger all of them are the same constraint. */
#pragma once
#include "solver/contact/skin.h"
#include "solver/state.h"

typedef struct sf_contact_pair {
    int64_t node, facet; /* of the skin; of two edges a node of the one, a facet at the other */
    double weight[4];    /* of the facet's nodes, sf_skin_corner; zeros for a plane and for edges */
    int parts;           /* points of the pad that take part, with their shares of the force */
    int32_t part[7];
    double share[7];
    bool leans;        /* a force q acts on a part as share q + (lean . q) normal; else as share q */
    double lean[7][3]; /* of the parts, if so */
    double normal[3];  /* outward from what is touched */
    double gap;        /* m, now; of a depth the part that the step takes back */
    double step[3];    /* m, relative motion in the next step without the forces of the solve */
    double friction;   /* -, Coulomb coefficient */
    double mobility;   /* m N-1, gap that opens for each newton along the normal */
    double looseness;  /* m N-1, likewise a bound across the normal */
    double *force;     /* [3] N, on the point; borrowed */
    sf_missile_response *missile; /* what is touched if it is the missile, NULL otherwise; borrowed */
    double place[3];              /* m, of the point on it */
} sf_contact_pair;

/* Displacement of the point relative to its partner, of a field over the points. */
void sf_pair_relative(const sf_contact_pair *pair, const double *field, double out[3]);

/* Friction acts on the point and on its partner `gap` apart along the normal. This gives three nodes of the
 * pair, which are on no line, the leans by which forces along the normal take up that moment: then angular
 * momentum holds, and the relative motion is that of one place. Needs parts, normal and gap. */
void sf_pair_lean(const sf_state *state, const int32_t node[3], sf_contact_pair *pair);

/* Finds where two edges u and v (m) cross, seen along the common perpendicular of their lines: its unit vector
 * n, and the places along u and v in parts of them. `between` (m) goes from the start of u to that of v. False if
 * the sine of the angle between them is below `least`. */
bool sf_pair_cross(const double u[3], const double v[3], const double between[3], double least, double n[3],
                   double place[2]);

/* Weights that are rounding cost as much as others: they become zero, and the sum stays one. */
void sf_pair_drop_traces(double weight[4]);

/* Writes the pairs of edges that close in the next step to `pair` [edge_count], without friction and force;
 * returns their number. Nodes against faces do not see them before an edge has sunk in by up to half a
 * spacing (docs/adr/0024). `back` (m): the part of a depth that a step takes back. */
int64_t sf_pair_edges(const sf_skin *skin, const sf_state *state, double back, sf_contact_pair *pair);
