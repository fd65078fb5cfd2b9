/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `table`: the start material's curve, scaled; its densification law stays. */
#include "study/fit/form/form.h"

static const sf_form_entry entries[] = {{SF_PARAMETER_STRESS_SCALE, 0.3, true},
                                        {SF_PARAMETER_EXPONENT, 0.3, false}};

static void start(double *value) {
    value[SF_PARAMETER_STRESS_SCALE] = 1;
}

const sf_curve_form sf_form_table = {
    .name = "table",
    .formula = "the start material's curve times stress_scale",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
};
