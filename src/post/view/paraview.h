/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ready state for ParaView, pad_paraview.py beside pad.xdmf: share/softfall/pad_paraview.py with the
 * facts of the drop in it; and the film and the picture that it makes. */
#pragma once
#include "post/view/xdmf.h"

/* The text of a file that comes with softfall in share/softfall, from malloc, owned by the caller. SF_ERR_IO:
 * it is missing, or does not hold `mark`, where the facts of a drop go. */
sf_status sf_template_read(const char *name, const char *mark, char **text, sf_error *err);

/* After pad.xdmf, if that has frames. `warning` (size bytes) says that the template is missing or another
 * one, and there is no state; or that the planes of a half or quarter model cannot be told, and the state
 * shows the modelled part only. Else it is "". */
sf_status sf_paraview_write(const sf_staging *output, const sf_results *results, const sf_xdmf *made,
                            char *warning, size_t size, sf_error *err);

/* Before anything is computed: "pad.mp4" or "pad.gif" of the word "mp4" or "gif" (NULL: mp4), and are the
 * programs there that make it? SF_ERR_INPUT with the package that is missing. */
sf_status sf_paraview_check_film(const char *kind, const char **film, sf_error *err);

/* The film and pad.png, the picture at the peak, in the staging directory, by the state there. */
sf_status sf_paraview_film(const sf_staging *output, const char *film, sf_error *err);
