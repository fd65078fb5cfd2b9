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

/* Runs the drops of the sections that sf_model_make has left. Of the model's own drop they fill
 * model->section; of one that is like it they give model->expected_mesh_error, in place of the formula's.
 * Neither changes where there are none, or they do not work, which is no failure of the model. `input`: the
 * case, to be read once more. */
void sf_section_drop_refer(const sf_case_input *input, sf_sections *sections, sf_model *model);
