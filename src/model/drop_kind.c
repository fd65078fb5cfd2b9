/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/drop_kind.h"

const sf_drop_kind_info *sf_drop_kind_get(int kind) {
#define INFO(kind, in_fit, in_error, ...)                                                                    \
    {.key = in_fit, .error_key = in_error, .sd_key = SF_DROP_SD(in_error), __VA_ARGS__},
    static const sf_drop_kind_info info[] = {SF_DROP_KINDS(INFO)};
#undef INFO
    return &info[kind];
}
