/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad that rests on the anvil under a dome, for test_anvil and the verification study of the base. */
#ifndef SF_TESTS_RESTING_FIXTURE_H
#define SF_TESTS_RESTING_FIXTURE_H

#include "model_fixture.h"

typedef enum resting_symmetry { WHOLE, HALF, QUARTER } resting_symmetry; /* HALF: the plane x = 0 */

typedef struct resting {
    double friction;
    double gap; /* m, of the missile */
    resting_symmetry symmetry;
    double across; /* m, of the missile's place from the middle, x */
    int layers;    /* of cells; 0: 3 */
    double speed;  /* m/s, of the missile; 0: as in the example */
} resting;

/* Starts a block of 50 x 40 mm on the anvil, 10 mm a layer, under a dome of 20 mm radius and 0.5 kg. */
void resting_start(fixture *f, const resting *r);
/* Mass of the pad (kg) and displacement of its centre of mass (m). */
double resting_mass(const sf_model *m);
void resting_centre(const fixture *f, double out[3]);
/* Gives every node of the pad this velocity, m/s. */
void resting_throw(fixture *f, double x, double z);
void resting_advance_to(fixture *f, double time);

#endif
