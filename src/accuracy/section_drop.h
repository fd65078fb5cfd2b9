/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The errors of a drop's figures by further drops, of its section. */
#pragma once
#include "case/read.h"
#include "pre/make.h"

/* Runs the drops of the sections that sf_model_make has left. Of the model's own drop they fill
 * model->section; of one that is like it they give model->expected_mesh_error, if it is larger than the formula's.
 * Neither changes where there are none, or they do not work, which is no failure of the model. A coarse mesh
 * is told to `sink` (may be NULL). `input`: the case, to be read once more. */
void sf_section_drop_refer(const sf_case_input *input, const sf_build_report *report, sf_sections *sections,
                           sf_model *model, const sf_sink *sink);
