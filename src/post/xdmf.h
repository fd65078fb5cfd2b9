/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pad.xdmf + pad.h5: the deformed pad with its cells and fields, and the missile's surface, at every frame,
 * for ParaView. Written so that all three XDMF readers of ParaView 5.11 take it: the topology is repeated in
 * every step (no Reference), connectivities are int32, number types and precisions are explicit, tensors have
 * nine components, and pad.h5 is complete and closed before pad.xdmf exists. Array names carry their units,
 * e.g. von_mises_Pa. */
#ifndef SF_POST_XDMF_H
#define SF_POST_XDMF_H

#include "io/staging.h"
#include "post/results.h"

/* `*frames` is the number of frames written; with 0 there are no files. A frame that cannot be read ends the
 * export with a note if the run did not end well, and is an error otherwise. */
sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const char *command_line,
                        int64_t *frames, sf_error *err);

#endif
