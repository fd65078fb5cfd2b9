/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The guaranteed bound on the highest frequency of the cloud (theory, section "Time step").
 *
 * Every smoothing domain L is given a share theta_IL m_I of its nodes' masses, with sum_L theta_IL = 1. Then
 * the largest eigenvalue of the whole, omega^2, is at most max_L a_L c_L, where a_L bounds the tangent of the
 * domain (Pa) and c_L = V_L * largest eigenvalue of sum_J B_J B_J^T / (theta_JL m_J). The bound costs one
 * pass over the domains a step, holds for any field of tangents, and with damping eta_L (Pa s) gives the time
 * step from c_L (a_L dt^2 + 2 eta_L dt) <= 4. */
#pragma once
#include "model/model.h"

/* Fills c [node_count], m kg-1, with shares theta_IL proportional to V_L |B_I^L|. */
sf_status sf_stability_constants(const sf_model *model, double *c, sf_error *err);

/* 4 / (largest stable step of a domain with c (m/kg), a (Pa), eta (Pa s)); s-1. From the positive root of c a
 * dt^2 + 2 c eta dt - 4 = 0, without cancellation. */
static inline double sf_stability_slowness(double c, double a, double eta) {
    double damping = c * eta;
    return damping + sqrt(damping * damping + 4 * c * a);
}

/* Largest stable step itself; s. */
static inline double sf_stability_step(double c, double a, double eta) {
    return 4 / sf_stability_slowness(c, a, eta);
}

/* The bound (s-2) on the square of the membrane's highest frequency at rest, with the masses of the cloud.
 * The largest eigenvalue of Phi M^-1 Phi^T K is at most max_p r_p s_p: r_p is the sum of row p of |Phi| M^-1
 * |Phi^T|, s_p that of the norms of the blocks of K, as diag(r) and diag(s) exceed the two matrices. */
sf_status sf_stability_membrane(const sf_model *model, double *load, sf_error *err);

/* The stable step (s) of foam and membrane together, `step` being that of the foam, `load` the bound above.
 * The foam has c a dt^2 + 2 c eta dt <= 4 up to `step`: at a part x of it no more than 4 x. */
static inline double sf_stability_with_membrane(double load, double step) {
    return load > 0 ? 2 * step / (1 + sqrt(1 + load * step * step)) : step;
}

/* The largest stable step (s) of the foam at rest, of the node `critical`, and the first step over the mean
 * one of a compression by the missile's speed; 1 with a prescribed motion. */
sf_status sf_stability_first_step(const sf_model *model, double *step, int64_t *critical, double *slowdown,
                                  sf_error *err);
