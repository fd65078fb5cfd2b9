/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table that softfall-pre prints: size and checks of the model, before a run. */
#ifndef SF_PRE_REPORT_H
#define SF_PRE_REPORT_H

#include "pre/build.h"
#include <stdio.h>

void sf_report_print(FILE *out, const sf_model *model, const sf_build_report *report);

/* Expected time of the run on two cores, s, to a factor of 2. */
double sf_report_seconds(const sf_model *model, const sf_build_report *report);

#endif
