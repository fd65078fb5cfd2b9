/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/packed_gradient.h"

#include "core/mat3.h"
#include <stdbool.h>

static const uint64_t SHARED = 1 << 16; /* values of the bits that belong to the number before */
static const uint64_t SIGN = (uint64_t)1 << 63;

/* Lengths, areas and volumes of equal parts of a lattice differ by less, in any unit of the geometry. */
static const double EQUAL = 1 + 1e-9;

static uint64_t shared_bits(const uint8_t *number) {
    uint16_t shared;
    memcpy(&shared, number, sizeof shared);
    return shared;
}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double from_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* The largest of the bits up to `size` (a positive double's) whose lower ones are `shared`. */
static uint64_t round_down(uint64_t size, uint64_t shared) {
    return (size - shared) / SHARED * SHARED + shared;
}

void sf_packed_neighbours(double x, const uint8_t *number, double pair[2]) {
    uint64_t sign = bits_of(x) & SIGN, below = round_down(bits_of(fabs(x)), shared_bits(number));
    pair[0] = from_bits(sign | below);
    pair[1] = from_bits(sign | (below + SHARED));
}

void sf_packed_put(double x, uint8_t *number) {
    uint64_t size = bits_of(fmin(fmax(fabs(x), SF_PACKED_LEAST), SF_PACKED_MOST));
    uint64_t bits = (bits_of(x) & SIGN) | round_down(size + SHARED / 2, shared_bits(number));
    memcpy(number, &bits, sizeof bits);
}

void sf_pack_row(int64_t count, const int32_t *order, const double *b, uint8_t *bytes) {
    for (int64_t k = 0; k < count && k < SF_TAKERS; k++)
        memcpy(&bytes[sf_packed_place(k, 0)], &b[3 * order[k]], 3 * sizeof *b);
    for (int64_t k = SF_TAKERS; k < count; k++)
        for (int c = 0; c < 3; c++)
            sf_packed_put(b[3 * order[k] + c], &bytes[sf_packed_place(k, c)]);
}

/* Length, area or volume that x spans with the `taken` nodes so far. */
static double measure_with(const double *const taker[SF_TAKERS], int taken, const double x[3]) {
    double edge[3][3], normal[3];
    for (int t = 1; t <= taken; t++)
        for (int a = 0; a < 3; a++)
            edge[t - 1][a] = (t == taken ? x : taker[t])[a] - taker[0][a];
    if (taken == 1)
        return sf_dot3(edge[0], edge[0]);
    sf_cross3(edge[0], edge[1], normal);
    return taken == 2 ? sf_dot3(normal, normal) : fabs(sf_dot3(normal, edge[2]));
}

static bool is_taken(const int32_t *order, int taken, int64_t k) {
    for (int t = 0; t < taken; t++)
        if (order[t] == k)
            return true;
    return false;
}

void sf_packed_order(const double *position, const int32_t *node, int64_t count, int32_t own,
                     int32_t *order) {
    const double *taker[SF_TAKERS];
    int taken = 0;
    for (; taken < count && taken < SF_TAKERS; taken++) {
        double largest = -1;
        for (int64_t k = 0; k < count; k++) {
            const double *x = &position[3 * (int64_t)node[k]];
            double measure = taken == 0 ? node[k] == own : measure_with(taker, taken, x);
            /* where it overflows, NaN is a choice too */
            if (!(measure <= largest * EQUAL) && !is_taken(order, taken, k)) {
                largest = measure;
                order[taken] = (int32_t)k;
            }
        }
        taker[taken] = &position[3 * (int64_t)node[order[taken]]];
    }
    int64_t next = taken;
    for (int64_t k = 0; k < count; k++)
        if (!is_taken(order, taken, k))
            order[next++] = (int32_t)k;
}
