/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs of contact: a point of the pad, or a sharp edge of the pad or of a rigid body, and what it touches.
 * To the solve (contact/solve.h) and the ledger all of them are the same constraint. */
#pragma once
#include "solver/contact/skin.h"
#include "solver/state.h"

struct sf_contact_pair {
    int64_t node,
        facet;        /* of the skin, and its partner; of two edges a node of the one, a facet at the other */
    int body;         /* SF_BODY_*, what is touched */
    double weight[4]; /* of the facet's nodes, sf_skin_corner; zeros for bodies and edges */
    int parts;        /* points of the pad that take part, with their shares of the force */
    int32_t part[7];
    double share[7];
    bool leans;        /* a force q acts on a part as share q + (lean . q) normal; else as share q */
    double lean[7][3]; /* of the parts, if so */
    double normal[3];  /* outward from what is touched */
    double gap;        /* m, now; of a depth the part that the step takes back */
    double depth;      /* m, now, all of it */
    double step[3];    /* m, relative motion in the next step without the forces of the solve */
    double friction;   /* -, Coulomb coefficient */
    double mobility;   /* m N-1, gap that opens for each newton along the normal */
    double looseness;  /* m N-1, likewise a bound across the normal */
    double *force;     /* [3] N, on the point; borrowed */
    sf_missile_response *missile; /* what is touched if it is the missile, NULL otherwise; borrowed */
    double place[3];              /* m, of the point on it */
};

/* One solve: the points with all that they may touch. There are two in a step, first that of the skin with
 * itself, supports and planes, then that of the contact points with missile and anvil. */
struct sf_scene {
    const sf_model *model;
    const sf_body *body;          /* [SF_BODIES], all but the supports */
    const sf_skin *skin;          /* its points and faces */
    const struct sf_sharp *sharp; /* the sharp edges that press them */
    sf_state *state;
    sf_contact_points *at;         /* the points' part of it */
    sf_missile_response *response; /* of the missile; NULL: this is the skin's */
};

/* Displacement of the point relative to its partner, of a field over the points. */
void sf_pair_relative(const sf_contact_pair *pair, const double *field, double out[3]);

/* Friction acts on the point and on its partner `gap` apart along the normal. This gives three nodes of the
 * pair, which are on no line, the leans by which forces along the normal take up that moment: then angular
 * momentum holds, and the relative motion is that of one place. Needs parts, normal and depth. */
void sf_pair_lean(const sf_scene *scene, const int32_t node[3], sf_contact_pair *pair);

/* Finds where two edges u and v (m) cross, seen along the common perpendicular of their lines: its unit
 * vector n, and the places along u and v in parts of them. `between` (m) goes from the start of u to that of
 * v. False if the sine of the angle between them is below `least`. */
bool sf_pair_cross(const double u[3], const double v[3], const double between[3], double least, double n[3],
                   double place[2]);

/* Takes at most `back` (m) of a depth back in the step: sets `gap`. Returns whether the pair closes in it. */
bool sf_pair_closes(sf_contact_pair *pair, double back);

/* Finds friction of a pair and, with three nodes, its leans. */
void sf_pair_rub(const sf_scene *scene, const int32_t *node, sf_contact_pair *pair);

/* Turns the force of the last step to the normal of the pair, as that with which its sweeps begin. */
void sf_pair_warm(sf_contact_pair *pair, const double old[3]);

/* Finds the Coulomb coefficient of the pair; the mirror image moves along a symmetry plane as the pad does.
 */
double sf_pair_friction(const sf_scene *scene, const sf_contact_pair *pair);

/* The shape's `meet` of the missile. */
bool sf_pair_missile(const sf_scene *scene, int64_t point, int64_t partner, sf_contact_pair *out);

/* Returns the body (SF_BODY_*) in a pair of point and partner. */
int sf_pair_body(const sf_scene *scene, int64_t point, int64_t partner);

/* Lists the nodes of a pair and their shares. */
void sf_pair_list_parts(const sf_skin *skin, sf_contact_pair *pair);

/* Returns the depth (m) beyond which there is no pair, of one that is new or goes on, at this spacing (m). */
static inline double sf_shape_limit(const sf_shape *shape, bool goes_on, double size) {
    return (goes_on ? shape->deepest : shape->entry) * size;
}

/* Returns false for a pair of the pad with itself that is only watched. */
bool sf_pair_acts(const sf_scene *scene, const sf_contact_pair *pair);
