/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The judgement of a measured record before it is compared with: it is judged like a run, every check of
 * SF_GOOD_RECORD becomes a row, the worst row is the grade. The checks know the shape of one impact: rest or
 * free flight, a pulse, rest or free flight. */
#pragma once
#include "post/figures/verdict.h"

/* X(name, bound of a remark, bound of use (INFINITY: none), title, how the value is found, why it matters).
 * Values are shown in percent. The peak and the pulse are those of the medians of five samples; the pulse
 * goes from 10 % of the peak to 10 %. */
/* clang-format off */
#define SF_GOOD_RECORD(X)                                                                                            \
    X(spike, 0.2, 0.5, "spike", "largest distance of a sample from the median of five, over the peak",               \
      "single samples are no acceleration of the missile, and make a_max")                                           \
    X(saturation, 0.02, 0.05, "saturation", "height of a parabola through the flanks above a flat top, over the peak", \
      "the channel ended at its rail: the true peak was higher")                                                     \
    X(cut, 0.1, 0.3, "cut in the pulse", "first or last value, over the peak, if the pulse is not complete",         \
      "a part of the impact is missing, and with it a part of HIC")                                                  \
    X(offset, 0.01, 0.05, "offset before contact", "median before contact, over the peak",                           \
      "the zero line is shifted, a_max and HIC with it (--reference-zero takes it away)")                            \
    X(drift, 0.02, 0.2, "drift", "median of the last quarter after the pulse less that before it, over the peak",    \
      "the zero line moved during the impact")                                                                       \
    X(gap, 0.1, 0.25, "gap between samples", "longest interval in the pulse, over its length",                       \
      "the curve between these samples is a straight line, not a measurement")                                       \
    X(noise, 0.02, 0.1, "noise", "root mean square about the median of five outside the pulse, over the peak",       \
      "the peak is partly noise")                                                                                    \
    X(ringing, 0.1, 0.5, "ringing", "largest raw value over the filtered one, less 1",                               \
      "the filter makes the peak")                                                                                   \
    X(other_impact, 0.1, INFINITY, "other impact in the record", "largest median outside the pulse, over the peak",  \
      "the highest pulse is compared, which may be another impact than the model's")
/* clang-format on */

#define SF_RECORD_INDEX(name, ...) SF_RECORD_##name,
enum { SF_GOOD_RECORD(SF_RECORD_INDEX) SF_RECORD_CHECKS };
#undef SF_RECORD_INDEX

typedef struct sf_record_verdict {
    sf_grade grade;
    sf_check rows[SF_RECORD_CHECKS]; /* value NaN: the record does not tell */
} sf_record_verdict;

/* `raw`: the samples (s, g), positive while the missile is slowed down; `curve`: the filtered ones; `other`:
 * the highest of other impacts that were left out, over the peak, or 0. */
sf_status sf_record_judge(const sf_series *raw, const sf_series *curve, double other,
                          sf_record_verdict *verdict, sf_error *err);

/* Median of the samples of `axis` (g) before the pulse that `raw` has at the same times; NaN: there are too
 * few. */
sf_status sf_record_offset(const sf_series *raw, const sf_series *axis, double *offset, sf_error *err);

/* The impacts of a record: pulses above 20 % of the highest, with less than 10 % between them for
 * 5 ms or longer, which no ringing or noise is. */
typedef struct sf_record_impact {
    double time, peak; /* s and g, of the highest median */
    double begin, end; /* s: the part of the record that holds this impact alone, up to halfway to the next */
} sf_record_impact;
enum { SF_RECORD_IMPACTS = 20 };
/* Fills `impact` and `*count`, at most SF_RECORD_IMPACTS; none in a channel whose largest magnitude is
 * negative. */
sf_status sf_record_find_impacts(const sf_series *raw, sf_record_impact impact[SF_RECORD_IMPACTS], int *count,
                                 sf_error *err);

/* "valid", or the phrase and the findings that are not valid, the worst first. */
void sf_record_line(const sf_record_verdict *verdict, char *text, size_t size);
