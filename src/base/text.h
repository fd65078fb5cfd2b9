/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers in texts of the user: decimal ones alone. */
#ifndef SF_CORE_DECIMAL_H
#define SF_CORE_DECIMAL_H

#include <stdbool.h>

/* The number at `text`, [+-] digits [. digits] [e [+-] digits] with at least one digit, and what follows it;
 * NULL if there is none (hexadecimal). "nan" and "inf", and numbers that are too large, give a value that is
 * not finite. */
const char *sf_decimal_read(const char *text, double *value);

/* Is the whole text one finite number? */
bool sf_decimal_is(const char *text, double *value);

/* Is the whole text one whole number from `low` to `high`? */
bool sf_whole_is(const char *text, long low, long high, int *value);

#endif
