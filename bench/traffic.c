/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "traffic.h"

enum { WORD = 8 }; /* bytes of a double */

/* Operations of the foam law at one point, counted in foam_point.c with three sweeps of the eigenvalues. */
static const double LAW = 1100;
/* Of one pair in domain_stress.c, and of its scalar form. */
static const double PAIR = 84, SCALAR_PAIR = 33;

/* Reading B, the places of its nodes, and the groups' lists of others. */
static double gradient_bytes(const sf_model *m, const sf_operators *op) {
    return (3 * WORD + 2) * (double)m->domain_nnz + WORD * (double)m->node_count +
           4 * (double)op->halo.ptr[op->halo.group_count];
}

static double pair_bytes(const sf_model *m, double inner, double outer) {
    return inner * (WORD + 2) + outer * (WORD + 4) + 4 * (double)m->node_count;
}

bench_traffic bench_count(const sf_model *m, const sf_operators *op) {
    bench_traffic t = {0};
    double n = (double)m->node_count, nnz = (double)m->domain_nnz, vec = sizeof(sf_vec);
    double others = (double)op->halo.ptr[op->halo.group_count];
    double inner = (double)op->pairs.inner_ptr[op->halo.group_count];
    double outer = (double)op->pairs.outer_ptr[op->halo.group_count];
    const sf_constraint *held_nodes = &op->constraint;
    double rows = (double)held_nodes->rows, touched = (double)held_nodes->touched_count;
    double entries = rows > 0 ? (double)held_nodes->row_ptr[held_nodes->rows] : 0;
    double factor = rows > 0 ? (double)held_nodes->factor.column[held_nodes->rows] : 0;

    /* d; F old, new; V P; Maxwell in, out; peak in, out; stiffness, tangent; L, c, V */
    t.bytes[SF_PHASE_STRESS] = gradient_bytes(m, op) + n * WORD * (3 + 18 + 9 + 12 + 2 + 2 + 3);
    t.flops[SF_PHASE_STRESS] = 18 * nnz + LAW * n;
    /* X, d, F, g; force; V P in, out; pair sum, pair stiffness in, out */
    t.bytes[SF_PHASE_STABILISATION] = pair_bytes(m, inner, outer) + n * WORD * (3 + 3 + 9 + 1 + 3 + 18 + 4);
    t.flops[SF_PHASE_STABILISATION] = PAIR * (inner + outer);
    /* V P; force in, out, twice; sums for others in, out; the list of slots */
    t.bytes[SF_PHASE_FORCE] = gradient_bytes(m, op) + n * (WORD * (9 + 12) + 4) + others * (6 * WORD + 4);
    t.flops[SF_PHASE_FORCE] = 18 * nnz + 3 * (n + others);
    /* contact: the points near the missile are few */
    /* G by row and by node, L there and back; at touched nodes f, v, 1/m, field in, out, reaction; lambda in
     * each of four passes in and out */
    t.bytes[SF_PHASE_CONSTRAINT] = 2 * (entries + factor) * (WORD + 4) +
                                   touched * (4 + WORD * (3 + 3 + 1 + 3) + 2 * vec) + 8 * rows * vec;
    t.flops[SF_PHASE_CONSTRAINT] = 12 * (entries + factor) + 12 * touched;
    /* m, v in, out, force, reaction; then d in, out, v */
    t.bytes[SF_PHASE_MOTION] = n * WORD * (1 + 6 + 3 + 3 + 9);
    t.flops[SF_PHASE_MOTION] = n * (30 + 6);

    /* gradients out, in; pairs with A; fluxes out, in; product three times, sums for others; X, g, V; the
     * mode and two vectors of the basis */
    t.product_bytes = 2 * gradient_bytes(m, op) + pair_bytes(m, inner, outer) +
                      n * (4 * (6 + 6 + 6 + 2) + WORD * (3 + 1 + 1 + 6 + 4)) + others * (2 * 4 + 4);
    t.product_flops = 12 * nnz + SCALAR_PAIR * (inner + outer) + 30 * n;
    return t;
}
