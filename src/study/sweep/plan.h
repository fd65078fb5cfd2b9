/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plan of a sweep: a base case, factors in blocks, and what is asked of the results. The rows are the
 * full product of the blocks, the last block the fastest. A block is one list, a group of lists of one length
 * (zip), or a sample of several factors. docs/campaigns.md has the keys. */
#pragma once
#include "study/config.h"
#include "study/runner.h"

/* A factor of a sweep: a key of the case and the values that it takes. A factor of numbers has one unit, that
 * of its first value; all others are converted. One of words (names, files, lists) has numbered levels. */

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
    long long count; /* levels of a list; words that it repeats are one, but in a sample */
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
/* The value for a table: a number with 12 digits, or the label. Returns `text`, as the next one does. */
const char *sf_factor_text(const sf_factor *f, double value, char *text, size_t size);
/* "name (unit)". */
const char *sf_factor_heading(const sf_factor *f, char *text, size_t size);
/* "normal, mean 5, standard deviation 0.1 m/s", of a factor with a distribution. */
void sf_factor_distribution_text(const sf_factor *f, char *text, size_t size);

/* Points in the unit cube, the same for the same seed on every machine. No coordinate is 0 or 1. */

typedef enum sf_sampling {
    SF_SAMPLING_RANDOM, /* independent */
    SF_SAMPLING_LATIN,  /* Latin hypercube: one point in each of `count` strata of each coordinate */
    SF_SAMPLING_SOBOL,  /* the Sobol' sequence from its first point after 0 on; with another seed than 1 moved
                           by a random vector, modulo 1 */
    SF_SAMPLING_SALTELLI, /* for Sobol' indices, see below */
} sf_sampling;

#define SF_SAMPLING_WORDS "random|latin_hypercube|sobol|saltelli"

/* Coordinates that the Sobol' sequence of GSL has. */
enum { SF_SOBOL_DIMENSIONS = 40 };

/* Rows of `count` samples: `count`, or count (d + 2) of Saltelli. */
int64_t sf_sample_rows(sf_sampling method, int d, int64_t count);

/* u [sf_sample_rows][d]. Of Saltelli the rows are blocks of `count`: A, B, then for each coordinate i A with
 * its coordinate i from B; A and B are the halves of a Sobol' sequence of 2 d coordinates. SF_ERR_INPUT: the
 * sequence has not so many coordinates. */
sf_status sf_sample(sf_sampling method, int d, int64_t count, uint64_t seed, double *u, sf_error *err);

/* Sobol' indices of a sample of Saltelli: the share of the variance of a figure that one factor explains
 * alone (first order) and with all its interactions (total). */

#define SF_INDEX_SHARE 0.95
enum { SF_INDEX_LEAST = 8 };

typedef struct sf_index {
    double first, first_low, first_high; /* the 95 % interval of the bootstrap */
    double total, total_low, total_high;
} sf_index;

/* y [d + 2][n]: the blocks A, B, and A with each coordinate from B. A sample of which
 * one value is NaN is left out in all blocks; `*used` receives the number of the others. index [d]: NaN where
 * fewer than SF_INDEX_LEAST or than SF_INDEX_SHARE are left (values that are missing for what they would be
 * leave no random part) or y does not vary. Saltelli's estimator of 2010 and Jansen's; percentiles of
 * bootstrap samples, the same for the same seed. */
sf_status sf_indices(int d, int64_t n, const double *y, uint64_t seed, sf_index *index, long long *used,
                     sf_error *err);

enum {
    SF_SWEEP_RATIO = 2, /* spacing of a coarse drop that refines a row over that of the row */
    SF_SWEEP_FACTORS = SF_RUNNER_OVERRIDES - 1,
    SF_SWEEP_FIGURES = 6,
    SF_SWEEP_OVERRIDE_SIZE = 4352,
    SF_SWEEP_ROWS = 1000000 /* more are taken with --yes alone */
};

typedef enum sf_block_kind { SF_BLOCK_LIST, SF_BLOCK_ZIP, SF_BLOCK_SAMPLE } sf_block_kind;

typedef struct sf_block {
    sf_block_kind kind;
    int first, count; /* factors */
    sf_sampling method;
    long long samples; /* as asked for; of Saltelli the rows are samples (count + 2) */
    uint64_t seed;
    long long rows;
    int64_t stride; /* rows of the product of all later blocks */
} sf_block;

/* A figure of summary.json and the limit to stay below; NaN: none. */
typedef struct sf_sweep_limit {
    const char *figure; /* static */
    double limit;
    double accuracy; /* -, half of the 95 % interval of rows that are predicted, relative; 0: all are
                        simulated */
} sf_sweep_limit;

typedef struct sf_plan {
    const char *path; /* borrowed */
    char *folder;     /* that holds the plan; owned */
    char *case_path;  /* owned */
    char *title;      /* owned; NULL: none */
    int set_count;
    char *set[SF_RUNNER_OVERRIDES];       /* "group.key=value" of every run; owned */
    char set_where[SF_FACTOR_WHERE_SIZE]; /* "file:line" of their last list, for sentences */
    bool coarse; /* coarse drops are asked for, by which the rows are predicted or, if `refine`, refined */
    bool refine;
    char refine_where[SF_FACTOR_WHERE_SIZE]; /* "file:line" of the key, of its coarse drops too; "": none */
    int factor_count, block_count;
    sf_factor factor[SF_SWEEP_FACTORS];
    int block_of[SF_SWEEP_FACTORS];
    sf_block block[SF_SWEEP_FACTORS];
    long long rows;
    int figure_count;
    sf_sweep_limit figure[SF_SWEEP_FIGURES]; /* that the report looks at */
} sf_plan;

/* Reads the plan and makes the values of all rows. `huge`: more than SF_SWEEP_ROWS rows are allowed.
 * `coarse`: the plan of its coarse drops, whose `set` ends with the overrides of the key `coarse` and whose
 * accuracies are half of those of the plan, or whose `set` ends with those of the key `refine`. Every
 * sentence of an error begins with "file:line". Release with sf_plan_free, also on failure. */
sf_status sf_plan_read(const char *path, bool huge, bool coarse, sf_plan *plan, sf_error *err);
void sf_plan_free(sf_plan *plan);

/* The value of a factor in a row: a number in its unit, or the index of a word. */
double sf_plan_value(const sf_plan *plan, int factor, int64_t row);

/* The overrides of a row in the order in which they apply, and their number; text and list
 * [SF_RUNNER_OVERRIDES]. `list`: their addresses; may be NULL. */
int sf_plan_overrides(const sf_plan *plan, int64_t row, char (*text)[SF_SWEEP_OVERRIDE_SIZE],
                      const char **list);

/* A hash of the rows: of keys, units and values. */
uint64_t sf_plan_hash(const sf_plan *plan);

/* True if rows may be predicted instead of simulated: each figure then has its accuracy. */
bool sf_plan_is_adaptive(const sf_plan *plan);

/* The block of Saltelli samples; NULL: none. */
const sf_block *sf_plan_saltelli(const sf_plan *plan);

/* Reads the case of a row with each level of each factor (of many numbers the least and the greatest), the
 * other blocks at their first values. `hash`: of the contents of all files that these cases lead to and of
 * the programs. Errors: "file:line of the factor: the sentence of the case". */
sf_status sf_sweep_check_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err);

/* The case of a row; sf_case_free. */
sf_status sf_sweep_read_case(const sf_plan *plan, int64_t row, sf_case *c, sf_error *err);
