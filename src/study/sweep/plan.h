/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plan of a sweep: a base case, factors in blocks, and what is asked of the results. The rows are the
 * full product of the blocks, the last block the fastest. A block is one list, a group of lists of one length
 * (zip), or a sample of several factors. docs/campaigns.md has the keys. */
#ifndef SF_SWEEP_PLAN_H
#define SF_SWEEP_PLAN_H

#include "case/case.h"
#include "study/runner.h"
#include "study/sweep/factor.h"
#include "study/sweep/sample.h"

enum {
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
    int64_t samples; /* as asked for; of Saltelli the rows are samples (count + 2) */
    uint64_t seed;
    int64_t rows;
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
    char set_where[SF_FACTOR_WHERE_SIZE]; /* "file:line" of their list, for sentences */
    int factor_count, block_count;
    sf_factor factor[SF_SWEEP_FACTORS];
    int block_of[SF_SWEEP_FACTORS];
    sf_block block[SF_SWEEP_FACTORS];
    int64_t rows;
    int figure_count;
    sf_sweep_limit figure[SF_SWEEP_FIGURES]; /* that the report looks at */
} sf_plan;

/* Reads the plan and makes the values of all rows. `huge`: more than SF_SWEEP_ROWS rows are allowed. Every
 * sentence of an error begins with "file:line". Release with sf_plan_free, also on failure. */
sf_status sf_plan_read(const char *path, bool huge, sf_plan *plan, sf_error *err);
void sf_plan_free(sf_plan *plan);

/* The value of a factor in a row: a number in its unit, or the index of a word. */
double sf_plan_value(const sf_plan *plan, int factor, int64_t row);

/* True if the overrides of this factor replace a whole group; they come first. */
bool sf_factor_is_group(const sf_factor *f);

/* The overrides of a row in the order in which they apply, and their number; text [SF_RUNNER_OVERRIDES]. */
int sf_plan_overrides(const sf_plan *plan, int64_t row, char (*text)[SF_SWEEP_OVERRIDE_SIZE]);

/* Entry k of `set` as an override; text [SF_SWEEP_OVERRIDE_SIZE]. */
void sf_plan_set(const sf_plan *plan, int k, char *text);

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

#endif
