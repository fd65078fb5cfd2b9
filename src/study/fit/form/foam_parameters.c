/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/form/foam_parameters.h"

static const sf_parameter_info info[SF_PARAMETER_COUNT] = {
#define SF_FIT_IN(quantity, unit, per_unit) quantity, unit, per_unit
#define SF_FIT_NUMBER SF_QUANTITY_COUNT, "", 1
#define SF_FIT_FROM(low, high) low, high
#define SF_FIT_ROW(id, ...) [SF_PARAMETER_##id] = {__VA_ARGS__},
    SF_FIT_PARAMETERS(SF_FIT_ROW, SF_FIT_IN, SF_FIT_NUMBER, SF_FIT_FROM)};

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
