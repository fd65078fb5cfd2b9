/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a drop through the three programs (SF_BIN_DIR), as a user would, and reads its summary.json. */
#ifndef SF_VERIFY_DROP_H
#define SF_VERIFY_DROP_H

#include "base/error.h"

typedef struct sf_drop {
    double a_max_g, a_max_raw_g, hic, hic_t1_ms, hic_t2_ms, v_rebound_m_s, max_indentation_mm,
        max_local_strain;
    double local_collapse, energy_error, momentum_error, stabilisation_energy_fraction,
        contact_energy_fraction;
    double constraint_residual_m_s, nodes, steps, wall_s;
} sf_drop;

/* Runs examples/<example>/case.cfg with the foam of verify/materials/eva_like.cfg, or the case file `example`
 * itself when it ends in ".cfg", with `overrides` (a list of "key=value" ended by NULL, or NULL) on `threads`
 * threads. Files go to a temporary folder that is removed, except that results.h5 is moved to `keep` when
 * that is not NULL. */
sf_status sf_drop_run(const char *example, const char *const *overrides, int threads, const char *keep,
                      sf_drop *out, sf_error *err);

#endif
