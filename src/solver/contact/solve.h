/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forces of the pairs of a step, by Lagrange multipliers on the positions of the next time (forward
 * increment method, Carpenter, Taylor, Katona 1991; theory, section "Contact"; docs/adr/0003, 0033).
 *
 * Without these forces the gap of a pair at the next time would be gap + normal . step. The forces q are
 * those for which no gap is negative, none pulls, and Coulomb's law holds: p = q . n >= 0, gap >= 0, p gap =
 * 0, |q - p n| <= mu p (sticking below the bound), found by projected Gauss-Seidel sweeps from the forces
 * that the pairs begin with. There is no penalty: no stored contact energy, no stiffness that limits the time
 * step. The sweeps are serial: the same bits for any number of threads. */
#pragma once
#include "solver/contact/pair.h"

/* The pairs of a step. */
typedef struct sf_contact_system {
    const sf_point_rows *rows; /* of the points that are parts of the pairs */
    double *push; /* [n][3] m s-2, acceleration of the coefficients by the forces so far; zero before */
    double shift; /* s2, dt times the distance of the half steps */
    int64_t count;
    sf_contact_pair *pair; /* [count] */
    bool is_dependent;     /* rows of some pairs are sums of those of others: centroids, sharp edges */
} sf_contact_system;

/* The end of the sweeps. */
typedef struct sf_contact_sweeps {
    int most;
    double over;      /* -, over-relaxation of the normal forces */
    double tolerance; /* -, largest change of a force in the last sweep, over the largest force */
    double unsettled; /* -, likewise, that which is told when the sweeps have not reached it */
} sf_contact_sweeps;

/* Makes the next pair of the system one with mobilities; needs `push` without forces. */
void sf_contact_add(sf_contact_system *system);
/* Finds the forces. Returns false if they did not settle. */
bool sf_contact_relax(sf_contact_system *system, const sf_contact_sweeps *sweeps);
/* Relative motion (m) of a pair in the next step, with the forces of all. */
void sf_contact_motion(const sf_contact_system *system, const sf_contact_pair *pair, double out[3]);
/* Adds the force of a pair to force [n][3], N. */
void sf_contact_apply(const sf_contact_system *system, const sf_contact_pair *pair, double *force);
/* Sets `push` to zero again. */
void sf_contact_clear(sf_contact_system *system);
