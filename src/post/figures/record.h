/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The judgement of a measured record before it is compared with: it is judged like a run, every check of
 * SF_GOOD_RECORD becomes a row, the worst row is the grade. The checks know the shape of one impact: rest or
 * free flight, a pulse, rest or free flight. */
#pragma once
#include "post/figures/verdict.h"

/* X(name, bound of a remark, bound of use (INFINITY: none), title, how the value is found, why it matters).
 * Values are shown in percent, or as a sentence (describe in record.c). The peak and the pulse are those of
 * the medians of five samples; the pulse goes from 10 % of the peak to 10 %. The bounds of saturation, gap
 * and removed are those of tests/python/test_pulses.py, which counts false alarms and what is found among
 * synthetic pulses. */
/* clang-format off */
#define SF_GOOD_RECORD(X)                                                                                            \
    X(velocity, 0.1, 0.3, "change of velocity", "part of the known speed by which it lies below that speed, or 1.5 times that by which it lies above twice", \
      "a missile that falls at the known speed changes its velocity by 1 to 2 times that speed: the unit or the drop is another one") \
    X(duration, 1.0, 1.0, "length of the pulse", "0.2 ms over it, or it over 1 s, whichever is larger",                  \
      "no drop on a pad is so short or so long: the times have another unit")                                        \
    X(spike, 0.2, 0.5, "spike", "largest distance of a sample from the median of five, over the peak",               \
      "single samples are no acceleration of the missile, and make a_max")                                           \
    X(range, 0.95, 0.99, "peak over the channel's range", "largest magnitude of a sample, over the range (--reference-range)", \
      "the channel ended at its rail: the true peak was higher")                                                     \
    X(saturation, 0.02, 0.05, "saturation", "height of a parabola through the flanks above a top that is flat and has corners, over the peak", \
      "the channel ended at its rail: the true peak was higher (--reference-range with a range that the peak does not reach says that it did not)") \
    X(cut, 0.1, 0.3, "cut in the pulse", "first or last value, over the peak, if the pulse is not complete",         \
      "a part of the impact is missing, and with it a part of HIC")                                                  \
    X(offset, 0.01, 0.05, "offset before contact", "median before contact, over the peak",                           \
      "the zero line is shifted, a_max and HIC with it (--reference-zero takes it away)")                            \
    X(drift, 0.02, 0.2, "drift", "median of the last quarter after the pulse less that before it, over the peak",    \
      "the zero line moved during the impact")                                                                       \
    X(gap, 0.08, 0.16, "gap between samples", "longest interval in the pulse, over its length",                        \
      "the curve between these samples is a straight line, not a measurement: a_max and HIC are too small")          \
    X(noise, 0.02, 0.1, "noise", "root mean square about the median of five outside the pulse, over the peak",       \
      "the peak is partly noise")                                                                                    \
    X(ringing, 0.1, 0.5, "ringing", "largest raw value over the filtered one, less 1",                               \
      "the filter makes the peak")                                                                                   \
    X(removed, 0.03, 0.1, "peak removed by the filter", "1 less the mean of the filtered over that of the raw samples, where the filtered curve is above 90 % of its peak", \
      "the pulse is too short for the filter class, which takes a part of a_max and HIC away")                       \
    X(other_impact, 0.1, INFINITY, "other impact in the record", "highest rise of the medians' mean outside the pulse, over the peak", \
      "the highest pulse is compared, which may be another impact than the model's")
/* clang-format on */

#define SF_RECORD_INDEX(name, ...) SF_RECORD_##name,
enum { SF_GOOD_RECORD(SF_RECORD_INDEX) SF_RECORD_CHECKS };
#undef SF_RECORD_INDEX

typedef struct sf_record_verdict {
    sf_grade grade;
    sf_check rows[SF_RECORD_CHECKS]; /* value NaN: the record does not tell */
} sf_record_verdict;

/* Facts about a record besides its samples. */
typedef struct sf_record_facts {
    double other; /* highest of the other impacts that were left out, over the peak; 0: none */
    double speed; /* m/s, of the missile at contact; 0: unknown */
    double range; /* g, of the channel; 0: unknown */
} sf_record_facts;

/* `raw`: the samples (s, g), positive while the missile is slowed down; `curve`: the filtered ones. */
sf_status sf_record_judge(const sf_series *raw, const sf_series *curve, const sf_record_facts *facts,
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
