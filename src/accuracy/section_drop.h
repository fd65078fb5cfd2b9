/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The errors of a drop's figures by further drops, of its section. */
#pragma once
#include "case/read.h"
#include "pre/make.h"
#include "pre/vary.h"

/* Runs drops of the section of `model`, for which sf_model_make has left the sections, and fills
 * model->section (docs/theory.md, section 14); all are 0 if there are none, or their drops do not work, which
 * is no failure of the drop. `input`: the case, to be read once more. */
void sf_section_drop_refer(const sf_case_input *input, const sf_build_report *report, sf_sections *sections,
                           sf_model *model);
