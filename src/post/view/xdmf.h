/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pad.xdmf and its data, pad-HASH.h5: the deformed pad with its cells, materials and fields, and the
 * missile's surface with its speed, deceleration and contact force, at every frame and at the peak, for
 * ParaView. Written so that all three XDMF readers of ParaView 5.11 take it: the topology is repeated in
 * every step (no Reference), connectivities are int32, number types and precisions are explicit, tensors have
 * nine components. The data bear the hash of their content in their name: a pad.xdmf never speaks of those of
 * another run, whenever softfall-post is killed. Array names carry their units, e.g. von_mises_Pa. */
#pragma once
#include "io/staging.h"
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

/* Release with sf_shown_free. */
sf_status sf_shown_find(const sf_results *results, sf_shown *shown, sf_error *err);
void sf_shown_free(sf_shown *shown);

enum { SF_XDMF_NAME_SIZE = 32 };

typedef struct sf_xdmf {
    int64_t frames;                  /* written; 0: there are no files */
    int fields;                      /* SF_FIELD_* bits that all of them have */
    double largest[SF_FRAME_FIELDS]; /* magnitude of each in all frames, SI */
    double peak_time;                /* s, of the frame that is /peak of results.h5; NaN: there is none */
} sf_xdmf;

/* `data` is the name of the file of the data; without frames it stays as it is. A frame that cannot be read
 * ends the export with a note if the run did not end well, and is an error otherwise. */
sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const sf_xdmf_options *options,
                        char data[SF_XDMF_NAME_SIZE], sf_xdmf *made, sf_error *err);

/* Removes data of earlier runs from the directory, after pad.xdmf is in its place: files pad-HASH.h5 with
 * that hash that no .xdmf file there names, but not `data`. */
void sf_xdmf_remove_old(const char *directory, const char *data);
