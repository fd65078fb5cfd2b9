/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/foam_parameters.h"

static const sf_parameter_info info[SF_PARAMETER_COUNT] = {
#define SF_FIT_PARAMETER_ROW(id, name, quantity, unit, per_unit, low, high, prior_sd, description)           \
    [SF_PARAMETER_##id] = {name, quantity, unit, per_unit, low, high, prior_sd, description},
    SF_FIT_PARAMETERS(SF_FIT_PARAMETER_ROW, SF_QUANTITY_COUNT)};

const sf_parameter_info *sf_parameter_get(sf_foam_parameter parameter) {
    return &info[parameter];
}

const char *const sf_form_rate_names[] = {"none", "factor", "maxwell", "both"};

sf_form_rate sf_form_rate_of(sf_foam_parameter p) {
    if (p == SF_PARAMETER_RATE_FACTOR || p == SF_PARAMETER_RATE_REFERENCE ||
        p == SF_PARAMETER_RATE_FILTER_TIME)
        return SF_FORM_RATE_FACTOR;
    return p == SF_PARAMETER_ED || p == SF_PARAMETER_BETA1 ? SF_FORM_RATE_MAXWELL : SF_FORM_RATE_NONE;
}
