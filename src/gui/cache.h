/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder in which the window keeps its runs: $XDG_CACHE_HOME/softfall, or ~/.cache/softfall. Nothing is
 * written anywhere else but by Save case. */
#ifndef SF_GUI_CACHE_H
#define SF_GUI_CACHE_H

#include "base/error.h"
#include <stddef.h>

/* Makes it if need be. SF_ERR_IO: there is no home folder, or it cannot be made; SF_ERR_INPUT: it is not
 * softfall's own (io/folder.h). On failure the path is "". */
sf_status sf_cache_find(char *path, size_t size, sf_error *err);

#endif
