/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What pad.xdmf speaks of: which frames are shown, and their data as an HDF5 file. */
#ifndef SF_POST_XDMF_DATA_H
#define SF_POST_XDMF_DATA_H

#include "post/results/results.h"

typedef struct sf_xdmf_options {
    const char *command_line;
    bool full; /* doubles as they are in results.h5; else floats, see SF_XDMF_BITS */
} sf_xdmf_options;

/* The largest magnitude of an array in a frame has so many bits as a float, and all its values are whole
 * multiples of the last one, so that compression has something to take: the error is at most a millionth of
 * that magnitude. */
enum { SF_XDMF_BITS = 20 };

/* The frames of results.h5 and, in its place among them by time, /peak. */
typedef struct sf_shown {
    int64_t count;                   /* of those that could be read, once the data are written */
    int64_t peak;                    /* which is /peak, -1: none */
    const sf_frame_head **head;      /* [count] of the results; owned */
    double largest[SF_FRAME_FIELDS]; /* magnitude in the data */
    int *fields;                     /* [count] SF_FIELD_* bits; known once the data are written; owned */
} sf_shown;

/* An array of the missile, in each frame: of all its nodes, as it is rigid. */
typedef struct sf_missile_array {
    const char *name, *units, *description;
    int components;
} sf_missile_array;
enum {
    SF_MISSILE_SPEED,
    SF_MISSILE_ACCELERATION,
    SF_MISSILE_FORCE,
    SF_MISSILE_CENTRE, /* only of a missile that is an exact sphere: the last */
    SF_MISSILE_ARRAYS
};
extern const sf_missile_array sf_missile_arrays[SF_MISSILE_ARRAYS];
/* How many of them the missile of these results has. */
int sf_missile_array_count(const sf_results *results);

/* Release with sf_shown_free. */
sf_status sf_shown_find(const sf_results *results, sf_shown *shown, sf_error *err);
void sf_shown_free(sf_shown *shown);

/* Writes the file; `shown` is cut at the first frame that cannot be read, see sf_xdmf_write. */
sf_status sf_xdmf_write_data(const char *path, sf_results *results, const sf_xdmf_options *options,
                             sf_shown *shown, sf_error *err);

#endif
