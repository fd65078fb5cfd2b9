/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The smoothed gradient B as the solver keeps it: rows packed in six bytes a number (core/packed_gradient.h,
 * docs/adr/0009). */
#ifndef SF_SOLVER_FIELD_GRADIENT_H
#define SF_SOLVER_FIELD_GRADIENT_H

#include "core/error.h"
#include "core/model.h"
#include "core/packed_gradient.h"

/* Bytes of B between what a kernel works on and what it asks the memory for, as B does not fit into the
 * caches and processors stop reading ahead at the end of a page. */
enum { SF_AHEAD = 4096 };

/* The model's rows, packed one after the other; owned by the caller. */
sf_status sf_gradient_build(const sf_model *model, uint8_t **gradient, sf_error *err);

/* The same in the memory of the model's domain_b, which the model loses. */
sf_status sf_gradient_take(sf_model *model, uint8_t **gradient, sf_error *err);

/* The order of row l's entries in it: order [entries of the row]. */
void sf_gradient_order(const sf_model *model, int64_t l, int32_t *order);

/* Entries in the longest row. */
int64_t sf_gradient_longest(const sf_model *model);

/* Part of a row with numbers of one width: entry k is at b + 3 width k, in the order of sf_gradient_order. */
typedef struct sf_gradient_part {
    const uint8_t *b;
    const uint16_t *local; /* where the row's group keeps what belongs to the entries (halo.h) */
    int64_t count;
} sf_gradient_part;

/* The takers, 8 bytes a number, and all others, 6 bytes a number, of row l, whose entries the group keeps at
 * `local` [domain_nnz]. */
static inline sf_gradient_part sf_gradient_takers(const sf_model *m, const uint8_t *gradient,
                                                  const uint16_t *local, int64_t l) {
    int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    return (sf_gradient_part){&gradient[sf_packed_start(l, first)], &local[first],
                              count < SF_TAKERS ? count : SF_TAKERS};
}
static inline sf_gradient_part sf_gradient_others(const sf_model *m, const uint8_t *gradient,
                                                  const uint16_t *local, int64_t l) {
    int64_t first = m->domain_ptr[l];
    return (sf_gradient_part){&gradient[sf_packed_start(l, first) + sf_packed_place(SF_TAKERS, 0)],
                              &local[first + SF_TAKERS], m->domain_ptr[l + 1] - first - SF_TAKERS};
}

#endif
