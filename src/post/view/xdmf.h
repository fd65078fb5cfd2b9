/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pad.xdmf and its data, pad-HASH.h5: the deformed pad with its cells, materials and fields, and the
 * missile's surface with its speed, deceleration and contact force, at every frame and at the peak, for
 * ParaView. Written so that all three XDMF readers of ParaView 5.11 take it: the topology is repeated in
 * every step (no Reference), connectivities are int32, number types and precisions are explicit, tensors have
 * nine components. The data bear the hash of their content in their name: a pad.xdmf never speaks of those of
 * another run, at whatever instant softfall-post is killed. Array names carry their units, e.g. von_mises_Pa.
 */
#ifndef SF_POST_XDMF_H
#define SF_POST_XDMF_H

#include "io/staging.h"
#include "post/view/xdmf_data.h"

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

#endif
