/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of model/drop_kinds.h as the columns give them: the same of the simulation and of the columns.
 */
#ifndef SF_FIT_DROP_KINDS_H
#define SF_FIT_DROP_KINDS_H

#include "model/drop_kinds.h"
#include "study/column.h"

/* Logarithms of the values in the units of the keys; NaN where a value is not defined. */
void sf_drop_values_scale(const sf_columns_figures *values, double y[SF_FIT_SAMPLES]);

#endif
