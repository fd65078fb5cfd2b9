/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured acceleration from a CSV file (io/table_csv.h): a time and an acceleration, positive while the
 * missile is slowed down, in any unit that the heading names. It is filtered with a channel frequency
 * class at its own rate; samples at uneven times are first put at uniform ones, at SF_SIGNAL_RATE or faster.
 * A clock that counts from long before the record, such as an epoch, begins with the record.
 *
 * Of several columns, the axes of one accelerometer, each is filtered and its zero taken away before the
 * resultant is formed: noise and an offset do not average out in a square root of squares. */
#pragma once
#include "post/figures/record.h"

enum { SF_REFERENCE_INTERPRETATION = 1280, SF_REFERENCE_AXES = 3 };

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
    double cfc;   /* channel frequency class; 0: the file is filtered already and used as it is */
    bool invert;  /* the file has the other sign */
    bool zero;    /* take the median before contact away */
    double speed, range; /* m/s and g: facts of the record (sf_record_facts); 0: unknown */
    double from, to;     /* s, the part to be used, on the record's clock; 0, 0: all of it */
    int impact;          /* the one to be used, from 1; 0: the highest */
    const char *column_option, *filter_option, *invert_option, *zero_option; /* "--reference-filter " */
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

/* "200 g" (standard gravity), "2 km/s2" to g; SF_ERR_INPUT names the text. */
sf_status sf_reference_parse_range(const char *text, double *range, sf_error *err);
/* The number of an impact, from 1 on; SF_ERR_INPUT names the option and the text. */
sf_status sf_reference_parse_impact(const char *option, const char *text, int *impact, sf_error *err);
