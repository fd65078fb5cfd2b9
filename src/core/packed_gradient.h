/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The smoothed gradient B in 6 bytes a number, read without decoding (docs/adr/0009).
 *
 * A number of six bytes is the double in bytes [p, p + 8): the upper 48 bits are its own, the lower 16 are
 * the upper 16 of the number stored before it. These are known when it is rounded, so that it is within 2^-37
 * of what it stands for.
 *
 * Row l of B begins at byte sf_packed_start(l, domain_ptr[l]). Its takers come first, as plain doubles x, y,
 * z: at most four entries in general position, which softfall-pre corrects for what rounding the others
 * spoils (pre/cloud/rounding.h). The others follow in the order of the model. */
#ifndef SF_CORE_PACKED_GRADIENT_H
#define SF_CORE_PACKED_GRADIENT_H

#include <stdint.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "packed numbers overlap at their lower ends");

enum { SF_TAKERS = 4 };

/* m-1. What is smaller, zero too, is packed as about this: far below any B, far above underflow. */
#define SF_PACKED_LEAST 0x1p-500
/* m-1. What is larger is packed as this. */
#define SF_PACKED_MOST 0x1p1000

/* First byte of the row that begins with entry `entry`; with all rows and entries, the size of B. A row of
 * fewer than four entries needs less than it has. */
static inline int64_t sf_packed_start(int64_t row, int64_t entry) {
    return 24 * row + 18 * entry;
}

/* Byte of component c of the packed entry k, from the start of its row. */
static inline int64_t sf_packed_place(int64_t k, int c) {
    return k < SF_TAKERS ? 24 * k + 8 * c : 18 * k + 22 + 6 * c;
}

static inline double sf_packed_number(const uint8_t *number) {
    double x;
    memcpy(&x, number, sizeof x);
    return x;
}

/* The order in which a row of `count` nodes is packed: the node `own` of the row (or the first, if it is not
 * there), the farthest from it, the one that spans the largest area with these, the largest volume (the first
 * of equals, to 1e-9), then the others. It depends on the positions alone. */
void sf_packed_order(const double *position, const int32_t *node, int64_t count, int32_t own, int32_t *order);

/* Packs the row b [count][3], finite, into `bytes`, which it must not overlap. The same bits come back if
 * they are from softfall-pre's rounding; others are rounded to nearest. Where every row holds four entries or
 * more, they can be packed one after the other into the memory of all b, each from a copy. */
void sf_pack_row(int64_t count, const int32_t *order, const double *b, uint8_t *bytes);

/* The two numbers of six bytes around x, |x| > SF_PACKED_LEAST, that can stand behind what is before
 * `number`: towards zero, and away from it. */
void sf_packed_neighbours(double x, const uint8_t *number, double pair[2]);

/* Puts the number of six bytes nearest to x behind what is before it. */
void sf_packed_put(double x, uint8_t *number);

#endif
