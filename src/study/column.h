/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/laws.h"
#include "model/drop_kind.h"
#include "model/model.h"
#include "post/figures/injury.h"
#include "post/results/results.h"

/* The drop as uncoupled columns (theory, section 9): every piece of the missile's surface compresses
 * the foam below it as if the neighbouring foam and the pad's mass were not there,
 *
 *     F(t) = sum_k A_k P(eps_k, history),   eps_k = (delta - g_k) / H,   m d2(delta)/dt2 = m g - F.
 *
 * P is the uniaxial nominal stress of the law (sf_law.uniaxial). A three-dimensional pad is somewhat stiffer.
 * A later drop of a series begins with the histories that the same drops before it have left.
 * It costs a fifth of a millisecond: the surrogate of identification. */

enum { SF_COLUMNS = 48 };

typedef struct sf_columns {
    double mass;      /* kg, of the whole missile */
    double speed;     /* m s-1 at contact, downwards */
    double thickness; /* m, H */
    int count;
    double area[SF_COLUMNS];      /* m2, of the whole pad, A_k */
    double gap[SF_COLUMNS];       /* m, g_k: height above the missile's lowest point, ascending */
    int before;                   /* drops like this one before it on the pad; 0: the foam is new */
    double pause[SF_SERIES_MOST]; /* [before] s, at rest after each of them */
    double informed;              /* -, strain up to which data inform the foam; 0: without bound */
} sf_columns;

/* Columns below the missile's surface, as results.h5 holds it, and within the pad's outline. Errors: the
 * surface has no area facing the pad. */
sf_status sf_columns_build(const sf_results *results, sf_columns *columns, sf_error *err);

/* Figures of a drop; the first three are readings of an accelerometer in the missile, filtered with
 * CFC 1000. */
typedef struct sf_columns_figures {
    double a_max_g, hic;
    double hic_window;   /* s, its length */
    double v_rebound;    /* m s-1; NaN: contact had not ended */
    double contact_time; /* s, from first contact to the end of contact; NaN: it had not */
    double strain;       /* -, largest indentation over the thickness */
    double beyond; /* -, share of the work on the foam, at that indentation, in columns beyond `informed` */
} sf_columns_figures;

/* Their natural logarithms: of the numbers that may be measured (model/drop_kind.h), window and contact in
 * ms, and of the strain; and the share of work as it is. */
enum { SF_COLUMNS_STRAIN = SF_FIT_SAMPLES, SF_COLUMNS_BEYOND, SF_COLUMNS_LOGARITHMS };
void sf_columns_scale(const sf_columns_figures *figures, double y[SF_COLUMNS_LOGARITHMS]);

/* Deceleration (s, g) from first contact until the missile has left the foam, at most 0.2 s, at
 * the times of the steps (velocity Verlet, 0.1 ms at most). Sets rebound, contact time, strain and
 * `beyond` of `figures`. `curve` is owned by the caller. Errors: the foam collapses. */
sf_status sf_columns_drop(const sf_columns *columns, const sf_material_law *law, sf_series *curve,
                          sf_columns_figures *figures, sf_error *err);

/* Sets the figures of a filtered curve (s, g): a_max_g, hic and hic_window. */
sf_status sf_columns_read(const sf_series *filtered, sf_columns_figures *figures, sf_error *err);

/* Drops, filters and evaluates. `filtered` (s, g; owned by the caller) begins 5 ms before contact, which is
 * at 0; NULL: not wanted. Errors as of sf_columns_drop. */
sf_status sf_columns_respond(const sf_columns *columns, const sf_material_law *law,
                             sf_columns_figures *figures, sf_series *filtered, sf_error *err);

/* The scaled figures alone (sf_columns_scale). Errors as of sf_columns_drop. */
sf_status sf_columns_expect(const sf_columns *columns, const sf_material_law *law,
                            double y[SF_COLUMNS_LOGARITHMS], sf_error *err);
