/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/invariants.h"

#include <math.h>
#include <stdlib.h>

static const double INVARIANT_BOUND = 1e-10;

/* Both completeness conditions of one domain, with coordinates taken from the node itself. */
static void measure_domain(const sf_mesh *mesh, const sf_domains *d, int64_t i, double spacing,
                           sf_invariants *out) {
    const double *x = &mesh->position[3 * i];
    double unity[3] = {0}, linear[3][3] = {{0}};
    for (int64_t k = d->ptr[i]; k < d->ptr[i + 1]; k++)
        for (int c = 0; c < 3; c++) {
            unity[c] += d->b[3 * k + c];
            for (int r = 0; r < 3; r++)
                linear[r][c] += (mesh->position[3 * (int64_t)d->node[k] + r] - x[r]) * d->b[3 * k + c];
        }
    for (int c = 0; c < 3; c++) {
        out->unity = fmax(out->unity, fabs(unity[c]) * spacing);
        for (int r = 0; r < 3; r++)
            out->linear = fmax(out->linear, fabs(linear[r][c] - (r == c)));
    }
}

static void measure_shape(const sf_mesh *mesh, const sf_domains *d, int64_t i, double spacing,
                          sf_invariants *out) {
    double sum = -1, moment[3] = {0};
    for (int64_t k = d->phi_ptr[i]; k < d->phi_ptr[i + 1]; k++) {
        sum += d->phi_value[k];
        for (int c = 0; c < 3; c++)
            moment[c] += d->phi_value[k] *
                         (mesh->position[3 * (int64_t)d->phi_node[k] + c] - mesh->position[3 * i + c]);
    }
    out->shape = fmax(out->shape, fabs(sum));
    for (int c = 0; c < 3; c++)
        out->shape = fmax(out->shape, fabs(moment[c]) / spacing);
}

sf_status sf_invariants_measure(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *d,
                                const double *spacing, double volume, sf_invariants *out, sf_error *err) {
    int64_t n = mesh->node_count;
    *out = (sf_invariants){0};
    double *balance = sf_alloc(err, 3 * (unsigned long)n, sizeof *balance, "invariants"), total = 0;
    if (!balance)
        return err->status;
    sf_domains_boundary_integral(mesh, dual, d, balance);
    for (int64_t i = 0; i < n; i++) {
        measure_domain(mesh, d, i, spacing[i], out);
        measure_shape(mesh, d, i, spacing[i], out);
        total += d->volume[i];
        for (int64_t k = d->ptr[i]; k < d->ptr[i + 1]; k++)
            for (int c = 0; c < 3; c++)
                balance[3 * (int64_t)d->node[k] + c] -= d->volume[i] * d->b[3 * k + c];
    }
    for (int64_t k = 0; k < 3 * n; k++)
        out->telescope = fmax(out->telescope, fabs(balance[k]) / (spacing[k / 3] * spacing[k / 3]));
    out->volume = fabs(total / volume - 1);
    free(balance);
    return SF_OK;
}

sf_status sf_invariants_check(const sf_invariants *v, sf_error *err) {
    const struct {
        const char *name;
        double value;
    } item[] = {
        {"sum of B", v->unity},
        {"sum of X B", v->linear},
        {"sum of V", v->volume},
        {"sum of V B against the boundary", v->telescope},
        {"completeness of phi", v->shape},
    };
    for (size_t k = 0; k < sizeof item / sizeof item[0]; k++)
        if (!(item[k].value <= INVARIANT_BOUND))
            return SF_FAIL(err, SF_ERR_MODEL,
                           "the discretisation breaks an invariant: %s is off by %.3g (bound %.0e)",
                           item[k].name, item[k].value, INVARIANT_BOUND);
    return SF_OK;
}
