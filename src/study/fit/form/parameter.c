/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/parameter.h"

#include <string.h>

static const sf_parameter_info info[SF_PARAMETER_COUNT] = {
#define SF_FIT_PARAMETER_ROW(id, name, quantity, unit, per_unit, low, high, prior_sd, description)           \
    [SF_PARAMETER_##id] = {name, quantity, unit, per_unit, low, high, prior_sd, description},
    SF_FIT_PARAMETERS(SF_FIT_PARAMETER_ROW, SF_QUANTITY_COUNT)};

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter) {
    return &info[parameter];
}

sf_foam_parameter sf_parameter_find(const char *name) {
    int k = 0;
    while (k < SF_PARAMETER_COUNT && strcmp(info[k].name, name) != 0)
        k++;
    return (sf_foam_parameter)k;
}
