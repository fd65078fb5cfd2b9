/* SPDX-License-Identifier: GPL-3.0-or-later */
/* May the figures of a run be used? Every check of model/good_run.h becomes a row, the worst row is the
 * verdict. Limits that the user puts on the figures (200 g, HIC 1000) pass or fail beside it: a pad may fail
 * them in a valid run. */
#pragma once
#include "model/good_run.h"
#include "post/figures/figures.h"

typedef enum sf_grade { SF_GRADE_VALID, SF_GRADE_REMARKS, SF_GRADE_DO_NOT_USE } sf_grade;

/* A row. Strings but `text` are static. */
typedef struct sf_check {
    const char *key, *title, *why;
    const char *unit; /* of value and bounds */
    double value;     /* NaN: not defined by the run, or not recorded; then it is not judged, grade valid */
    double bound;     /* the grade is "valid" up to here */
    double use_bound; /* and "do not use" beyond; INFINITY: never */
    sf_grade grade;
    char text[320]; /* the finding as a clause: title, value and bound, or what is not known */
} sf_check;

typedef struct sf_limit {
    const char *key, *title, *unit; /* static */
    double value;                   /* NaN: not defined by the run */
    double bound;
    bool judged; /* the value is that of a whole drop, and the verdict lets it be used */
    bool passed; /* value <= bound; false if it is not judged */
} sf_limit;

typedef struct sf_limits {
    double a_max_g; /* g */
    double hic;     /* - */
} sf_limits;

#define SF_DEFAULT_LIMIT_G 200
#define SF_DEFAULT_LIMIT_HIC 1000
#define SF_DEFAULT_LIMITS ((sf_limits){SF_DEFAULT_LIMIT_G, SF_DEFAULT_LIMIT_HIC})

enum { SF_LIMITS = 2 }; /* a_max, HIC in this order */

typedef struct sf_verdict {
    sf_grade grade;
    double sure; /* -, part of a_max that is sure all the same with "do not use"; 0: nothing is known */
    int count;
    sf_check rows[SF_CHECKS];
    int limit_count; /* 0: a prescribed motion has no injury figures */
    sf_limit limits[SF_LIMITS];
} sf_verdict;

/* "passed", "failed" or "not judged"; static. */
const char *sf_limit_phrase(const sf_limit *limit);

/* Grades a value by its bounds, and writes the finding; `percent`: they are shown in percent. */
void sf_check_judge(sf_check *check, bool percent);

/* "valid", or the phrase and the findings of the rows that are not valid, the worst first; after `shown`
 * findings only the number of the others: "and 2 more". */
void sf_check_line(sf_grade grade, int count, const sf_check *rows, int shown, char *text, size_t size);

/* "valid", "valid with remarks", "do not use"; static. */
const char *sf_verdict_phrase(sf_grade grade);

void sf_verdict_compute(const sf_results *results, const sf_figures *figures, const sf_limits *limits,
                        sf_verdict *verdict);

/* The beginning of the status of a run that ended on the anvil (solver/run/run.c). */
#define SF_ENDED_ON_ANVIL "the missile reached the anvil"

/* Bytes that hold every line of sf_verdict_line. */
enum { SF_VERDICT_LINE_SIZE = 1280 };

/* The line of its rows, with three findings. */
void sf_verdict_line(const sf_verdict *verdict, char *text, size_t size);
