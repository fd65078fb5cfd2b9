/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The errors of a drop's figures by further drops, of its section. */
#pragma once
#include "case/read.h"
#include "pre/make.h"
#include "pre/vary.h"

/* Runs the drop of `section`, that of `fine`, the same with half the spacing, one that is 1 % faster and one
 * on a pad SF_SECTION_DROP_THINNER thinner, side by side, and fills `out` (docs/theory.md, section 14).
 * Where the first two do not rebound it is all 0; a change is 0 where its drop does not. `kernel`: of both.
 */
sf_status sf_section_drop_run(const sf_model *section, sf_model *fine, const sf_kernel *kernel,
                              sf_section_drop *out, sf_error *err);

/* Runs these drops for `model`, of which sf_model_make has left the sections, and fills model->section; all
 * are 0 if there are none, or their drops do not work, which is no failure of the drop. `input`: the case, to
 * be read once more. */
void sf_section_drop_refer(const sf_case_input *input, const sf_build_report *report, sf_sections *sections,
                           sf_model *model);
