/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/verdict.h"

/* May a measured record be compared with? It is judged like a run: every check of SF_GOOD_RECORD becomes a
 * row, the worst row is the grade. The checks know the shape of one impact: rest or free flight, a pulse,
 * rest or free flight. */

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

/* What is known of a record besides its samples. */
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

/* A measured acceleration from a CSV file (io/table_csv.h): a time and an acceleration, positive while the
 * missile is slowed down, in any unit that the heading names. It is filtered with a channel frequency
 * class at its own rate; samples at uneven times are first put at uniform ones, at SF_SIGNAL_RATE or faster.
 * A clock that counts from long before the record, such as an epoch, begins with the record.
 *
 * Of several columns, the axes of one accelerometer, each is filtered and its zero taken away before the
 * resultant is formed: noise and an offset do not average out in a square root of squares. */

enum { SF_REFERENCE_INTERPRETATION = 1024, SF_REFERENCE_AXES = 3 };

/* Samples that were read already. All borrowed. */
typedef struct sf_reference_samples {
    int64_t count;
    const double *time;                     /* [count] s */
    int axes;                               /* 1 to SF_REFERENCE_AXES */
    const double *value[SF_REFERENCE_AXES]; /* [axes][count] g */
    const char *reading;                    /* how their file was read */
} sf_reference_samples;

/* The texts tell the user, in sentences, how to choose otherwise ("--reference-filter none"). All borrowed.
 */
typedef struct sf_reference_options {
    const char *path;
    const sf_reference_samples *samples; /* of the path; NULL: it is read */
    const char *column;                  /* heading of the acceleration; NULL: the only one */
    const char
        *columns; /* headings of two or three axes, "x,y,z", of which the resultant is taken; or NULL */
    const char *heading; /* of a file without one; or NULL */
    double sensitivity;  /* V / (m/s2), of a column in volts; 0: the column is an acceleration */
    double rate;         /* Hz, of a file whose samples are numbered or not told apart; 0: it has a time */
    double cfc;          /* channel frequency class; 0: the file is filtered already and used as it is */
    bool invert;         /* the file has the other sign */
    bool zero;           /* take the median before contact away */
    double speed, range; /* m/s and g: facts of the record (sf_record_facts); 0: unknown */
    double from, to;     /* s, the part to be used, on the record's clock; 0, 0: all of it */
    int impact;          /* the one to be used, from 1; 0: the highest */
    const char *column_option, *unfiltered_option, *invert_option, *heading_option;
} sf_reference_options;

typedef struct sf_reference {
    sf_series raw;     /* the points of the file, s and g, inverted if asked for; owned */
    sf_series curve;   /* filtered; without a filter the same as raw; owned */
    double origin;     /* s, of its clock, that was taken away from the times */
    double offset;     /* g, that was taken away from the values; of axes, the resultant of theirs */
    char impacts[256]; /* "1 at 12.4 ms (150 g), ..."; empty: there is one */
    char interpretation[SF_REFERENCE_INTERPRETATION]; /* how the file was read, for the report */
    sf_record_verdict record;                         /* may it be compared with? */
} sf_reference;

/* SF_ERR_INPUT names the file, the line and what was expected: also if the samples are further apart than a
 * tenth of the reciprocal class (SAE J211 asks for a sampling rate of ten times the class), if the largest
 * magnitude is negative, as of an inverted channel, or if a time stands in a file whose rate is given.
 * Release with sf_reference_free; on failure it is zeroed. */
sf_status sf_reference_read(const sf_reference_options *options, sf_reference *reference, sf_error *err);
void sf_reference_free(sf_reference *reference);

/* "0.102 mV/(m/s2)", "10 mV/g" (g: standard gravity) to V / (m/s2); SF_ERR_INPUT names the text. */
sf_status sf_reference_parse_sensitivity(const char *text, double *sensitivity, sf_error *err);

/* "20 kHz", "20000 Hz", "20000 1/s" to Hz; SF_ERR_INPUT names the text. */
sf_status sf_reference_parse_rate(const char *text, double *rate, sf_error *err);

/* "200 g" (standard gravity), "2 km/s2" to g; SF_ERR_INPUT names the text. */
sf_status sf_reference_parse_range(const char *text, double *range, sf_error *err);

/* Model against measurement (Penta et al., Appl. Sci. 2018, 8(7), 1174, Table 2): over a region of the
 * measured curve, sampled every 0.25 and every 0.50 ms,
 *
 *     R2 = 1 - sum (a_i - m_i)^2 / sum (a_i - mean a)^2,   RMSE = sqrt(sum (a_i - m_i)^2 / n),
 *
 * a measured, m model, both in g and filtered alike (post/figures/compare.h). The measured curve's clock is
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

/* One region at one sampling interval (s). `left`: the missile is off the pad at the model's end, and stays
 * in free flight; `flight` (g): the model there, and before its curve. SF_ERR_INPUT if the region is not
 * within the measured curve, or where the model has no value. */
sf_status sf_compare_fit(const sf_series *measured, const sf_series *model, bool left, double flight,
                         double shift, sf_region region, double interval, sf_fit *fit, sf_error *err);

/* Reads the measured curve and compares `model` (s, g) with it. Release with sf_comparison_free. */
sf_status sf_compare_run(const sf_compare_options *options, const sf_series *model, sf_comparison *comparison,
                         sf_error *err);
void sf_comparison_free(sf_comparison *comparison);
