/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The errors of a drop's figures by further drops, of its section. */
#pragma once
#include "pre/vary.h"

/* `a_max`: that of `section`, g; 0: it does not rebound. Runs the drop of `section`, that of `fine`, the same
 * with half the spacing, one that is 1 % faster and one on a pad SF_SECTION_DROP_THINNER thinner, side by
 * side, and fills `out` (docs/theory.md, section 14). Where the first two do not rebound it is all 0; a
 * change is 0 where its drop does not. `kernel`: of both.
 */
sf_status sf_section_drop_run(const sf_model *section, sf_model *fine, const sf_kernel *kernel,
                              sf_section_drop *out, double *a_max, sf_error *err);
