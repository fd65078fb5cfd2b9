/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A factor of a sweep: a key of the case and the values that it takes. A factor of numbers has one unit, that
 * of its first value; all others are converted. A factor of words (names, files, lists) has numbered levels.
 */
#ifndef SF_SWEEP_FACTOR_H
#define SF_SWEEP_FACTOR_H

#include "study/config.h"
#include <stdint.h>

enum { SF_FACTOR_KEY_SIZE = 200, SF_FACTOR_UNIT_SIZE = 32, SF_FACTOR_WHERE_SIZE = 512 };

typedef struct sf_distribution sf_distribution; /* an entry of the table in factor.c */

typedef struct sf_factor {
    char key[SF_FACTOR_KEY_SIZE];        /* of the case: "missile.velocity", "material" */
    char name[SF_FACTOR_KEY_SIZE];       /* in tables and pictures; the key unless the plan names it */
    char unit[SF_FACTOR_UNIT_SIZE];      /* of the numbers; "": none */
    char where[SF_FACTOR_WHERE_SIZE];    /* "file:line" of the plan, for sentences */
    bool words;                          /* the values are words */
    bool uncertain;                      /* an unknown of which the values are draws, not a choice */
    bool posterior;                      /* the words are draws of a posterior */
    const sf_distribution *distribution; /* of a factor that is sampled; NULL: a list */
    double a, b;                         /* its numbers, in `unit` */
    int64_t count;  /* levels of a list; words that it repeats are one, but in a sample */
    double *number; /* [count] in `unit`; of words NULL; owned */
    char **text;    /* [count] of words: as --set takes it after '='; owned */
    char **label;   /* [count] of words: as the plan has it; owned */
    double *value;  /* [rows of its block] number, or index of the level; owned */
} sf_factor;

/* Reads the keys of a factor from its group; `sampled`: distributions are allowed. Release with
 * sf_factor_free, also on failure. A kind of factor is one entry of a table in factor.c, and so is a
 * distribution. */
sf_status sf_factor_read(const sf_config *config, const config_setting_t *group, bool sampled, sf_factor *f,
                         sf_error *err);
void sf_factor_free(sf_factor *f);

/* The value at a place u in (0, 1) of the distribution, or of the levels, all equally probable. */
double sf_factor_quantile(const sf_factor *f, double u);

/* "key=value" as --set takes it. */
void sf_factor_override(const sf_factor *f, double value, char *text, size_t size);
/* The value for a table: a number with 12 digits, or the label. */
void sf_factor_text(const sf_factor *f, double value, char *text, size_t size);
/* "name (unit)". */
void sf_factor_heading(const sf_factor *f, char *text, size_t size);
/* "normal, mean 5, standard deviation 0.1 m/s", of a factor with a distribution. */
void sf_factor_distribution_text(const sf_factor *f, char *text, size_t size);

#endif
