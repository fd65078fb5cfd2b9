/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a unit, "m/s2", as factors: names of one table with powers. Numbers, offsets and every other
 * name are refused, so that nothing in the text can change the value unseen. */
#ifndef SF_CORE_UNIT_TEXT_H
#define SF_CORE_UNIT_TEXT_H

#include <stdio.h>

enum { SF_UNIT_FACTORS = 8, SF_UNIT_NAME = 16, SF_UNIT_POWER = 4, SF_UNIT_REASON = 96 };

typedef struct sf_unit_factor {
    char name[SF_UNIT_NAME]; /* of UDUNITS: "mm", "us" */
    int power;               /* -SF_UNIT_POWER to SF_UNIT_POWER, not 0 */
} sf_unit_factor;

typedef struct sf_unit_text {
    int count;
    sf_unit_factor factor[SF_UNIT_FACTORS];
    char reason[SF_UNIT_REASON]; /* empty: the text is a unit; else what is wrong with it */
} sf_unit_text;

/* Grammar: product = factor { ("/" | "." | "*" | "·" | blanks) factor }, from left to right (kg/m s is (kg/m)
 * s); factor = (name | "(" product ")") [power], power = ["^"] ["-"] digit, or ², ³, ⁻¹; the first factor of
 * a product may be 1 if "/" follows. */
sf_unit_text sf_unit_text_read(const char *text);

/* The names as Markdown: a table for docs/case.md. */
void sf_unit_text_print(FILE *file);

#endif
