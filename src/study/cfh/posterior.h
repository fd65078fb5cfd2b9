/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The draws of a foam's posterior: material files draw-001.cfg, draw-002.cfg, ... of a folder, each as
 * probable as any other, as softfall-fit drop writes them. */
#ifndef SF_CFH_POSTERIOR_H
#define SF_CFH_POSTERIOR_H

#include "model/good_run.h"
#include "material/laws.h"

enum { SF_CFH_LEAST_DRAWS = 100, SF_CFH_MOST_DRAWS = 2000 };

typedef struct sf_cfh_draw {
    char *path;           /* owned, as the next two */
    sf_material material; /* of the case with that file */
    sf_material_law law;
    sf_response_error response; /* of its file; of other numbers than a_max and HIC none is used */
} sf_cfh_draw;

typedef struct sf_cfh_draws {
    const char *folder; /* borrowed */
    int count;
    bool with_response; /* every draw states the errors of a_max and HIC; else none of them does */
    sf_cfh_draw *draw;  /* [count] owned */
} sf_cfh_draws;

/* Reads every draw as the material of the case, with the case's overrides; `own` is the case's own material.
 * SF_ERR_INPUT: an override of the material, which would be the same in every draw; no draw, a gap in their
 * numbers, fewer than SF_CFH_LEAST_DRAWS, one that the case refuses, one with another law or density, one
 * with errors of the responses where another has none, or of a_max or HIC only; draws that are all the same.
 * Release with sf_cfh_draws_free, also on failure. */
sf_status sf_cfh_draws_read(const char *folder, const char *case_path, int override_count,
                            const char *const *overrides, const sf_material *own, sf_cfh_draws *draws,
                            sf_error *err);
void sf_cfh_draws_free(sf_cfh_draws *draws);

#endif
