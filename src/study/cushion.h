/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/laws.h"

/* The drop of a flat mass that covers a block of foam, as in a test of cushioning (theory, section 9): the
 * block is one column in one state of strain, without mass of its own. */
typedef struct sf_cushion {
    double static_stress; /* Pa, weight of the mass over the block's area */
    double thickness;     /* m, of the block */
    double height;        /* m, of the drop */
} sf_cushion;

/* Peak deceleration (g, F/m) of the first drop, as an accelerometer reads it, filtered with CFC 1000.
 * SF_ERR_INPUT: a member is not above 0; SF_ERR_NUMERIC: the foam collapses. */
sf_status sf_cushion_peak(const sf_cushion *cushion, const sf_material_law *law, double *peak,
                          sf_error *err);
