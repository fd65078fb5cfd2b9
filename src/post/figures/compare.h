/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/reference.h"

/* Model against measurement (Penta et al., Appl. Sci. 2018, 8(7), 1174, Table 2): over a region of the
 * measured curve, sampled every 0.25 and every 0.50 ms,
 *
 *     R2 = 1 - sum (a_i - m_i)^2 / sum (a_i - mean a)^2,   RMSE = sqrt(sum (a_i - m_i)^2 / n),
 *
 * a measured, m model, both in g and filtered alike (post/figures/reference.h). The measured curve's clock is
 * shifted so that both curves begin contact at the same instant: model time = measured time + shift. Regions
 * and windows are given and reported on the clock of the measured curve. They must lie within it, and over
 * the model's curve: before that, and after it if the missile has left the pad, the model is in free flight
 * (0 g), which the fit counts. */

typedef struct sf_region {
    double begin; /* s, clock of the measured curve */
    double end;   /* s */
} sf_region;

typedef struct sf_fit {
    sf_region region; /* as asked for */
    bool is_window;   /* the region is the window of the options */
    char span[48];    /* the region in ms, for tables */
    double first;     /* s, first sample */
    double last;      /* s */
    double interval;  /* s */
    int64_t count;    /* samples */
    int64_t flight;   /* of them, before or after the model's curve: free flight */
    double r2;        /* NaN if fewer than 2 samples or a constant measured curve */
    double rmse_g;    /* NaN if fewer than 2 samples */
} sf_fit;

typedef struct sf_compare_options {
    sf_reference_options reference;
    bool left;          /* the model's curve ends with the missile off the pad */
    double flight;      /* g: the model's curve in free flight */
    double shift;       /* s; NaN = align the contacts */
    sf_region window;   /* NaN = HIC window of the measured curve */
    sf_region *regions; /* [region_count], besides the window; the caller's */
    int64_t region_count;
} sf_compare_options;

typedef struct sf_comparison {
    sf_reference measured; /* on its own clock, filtered like the model; owned */
    double cfc;            /* of the measured curve; 0: not filtered here */
    bool inverted;         /* on the user's word */
    sf_injury injury;      /* of the measured curve */
    double shift;          /* s, as used */
    int shift_given;       /* 1 if the caller gave it */
    double peak_error;     /* model a_max / measured a_max - 1 */
    double hic_error;      /* the same of HIC; NaN if the measured one is 0 */
    const char *agreement; /* "agrees", "does not agree" or "not judged"; static */
    char finding[320]; /* a sentence with the errors, the agreement and its bounds, or why it is not judged */
    int64_t fit_count;
    sf_fit *fits; /* [fit_count]: for the window, then each region: at 0.25 and at 0.50 ms; owned */
} sf_comparison;

/* "A,B" or "A-B" in ms. SF_ERR_INPUT names the text. */
sf_status sf_region_parse(const char *text, sf_region *region, sf_error *err);
/* "0-10,10-16,16-30" in ms; `*regions` from sf_alloc, owned by the caller. */
sf_status sf_regions_parse(const char *text, sf_region **regions, int64_t *count, sf_error *err);

/* Instant at which contact begins: the straight line through the points where the curve, less its value
 * `zero` (g) before contact, last rises through 2 % and 10 % of its peak, before the peak, extrapolated to
 * that zero. SF_ERR_INPUT naming `name` if the curve has no such rise. */
sf_status sf_contact_instant(const sf_series *curve, const char *name, double zero, double *instant,
                             sf_error *err);

/* The rows of an sf_fit; static storage. */
sf_rows sf_fit_rows(void);

/* A region, and the way in which the curves are compared there. */
typedef struct sf_fit_of {
    sf_region region; /* s, of the measured time */
    double interval;  /* s, of the samples */
    double shift;     /* s, model time less measured time */
    bool left;        /* the missile is off the pad at the model's end, and stays in free flight */
    double flight;    /* g, the model there, and before its curve */
} sf_fit_of;

/* SF_ERR_INPUT if the region is not within the measured curve, or where the model has no value. */
sf_status sf_compare_fit(const sf_series *measured, const sf_series *model, const sf_fit_of *of, sf_fit *fit,
                         sf_error *err);

/* Reads the measured curve and compares `model` (s, g) with it. Release with sf_comparison_free. */
sf_status sf_compare_run(const sf_compare_options *options, const sf_series *model, sf_comparison *comparison,
                         sf_error *err);

/* Judges whether the model agrees with the measurement: a_max within SF_AGREE_A_MAX, HIC within SF_AGREE_HIC
 * and R2 of the first fit at least SF_AGREE_R2. Curves are not judged if the record or the run, whose grade
 * is `run`, is not to be used, nor if one of the three is not defined. */
#define SF_AGREE_A_MAX 0.1
#define SF_AGREE_HIC 0.2
#define SF_AGREE_R2 0.9
void sf_comparison_judge(sf_comparison *comparison, double model_hic, sf_grade run);
void sf_comparison_free(sf_comparison *comparison);
