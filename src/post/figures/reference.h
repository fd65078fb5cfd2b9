/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured acceleration from a CSV file (io/table_csv.h): a time and an acceleration, positive while the
 * missile is slowed down, in any unit that the heading names. It is treated like the model's curve: sampled
 * uniformly at SF_SIGNAL_RATE or faster by linear interpolation, then filtered with a channel frequency
 * class.
 */
#ifndef SF_POST_REFERENCE_H
#define SF_POST_REFERENCE_H

#include "post/figures/signal.h"
#include <stdbool.h>

enum { SF_REFERENCE_UNDERSTOOD = 640 };

/* The texts tell the user, in sentences, how to choose otherwise ("--reference-filter none"). All borrowed.
 */
typedef struct sf_reference_options {
    const char *path;
    const char *column; /* heading of the acceleration; NULL: the only one */
    double cfc;         /* channel frequency class; 0: the file is filtered already and used as it is */
    bool invert;        /* the file has the other sign */
    const char *column_option, *unfiltered_option, *invert_option;
} sf_reference_options;

typedef struct sf_reference {
    sf_series raw;   /* the points of the file, s and g, inverted if asked for; owned */
    sf_series curve; /* sampled and filtered; without a filter the same as raw; owned */
    char understood[SF_REFERENCE_UNDERSTOOD]; /* how the file was read, for the report */
} sf_reference;

/* SF_ERR_INPUT names the file, the line and what was expected: also if the samples are further apart than a
 * tenth of the reciprocal class (SAE J211 asks for a sampling rate of ten times the class), and if the
 * largest magnitude is negative, as of an inverted channel. Release with sf_reference_free; on failure it is
 * zeroed. */
sf_status sf_reference_read(const sf_reference_options *options, sf_reference *reference, sf_error *err);
void sf_reference_free(sf_reference *reference);

#endif
