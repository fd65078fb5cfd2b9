/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/drop_kind.h"

const sf_drop_kind_info *sf_drop_kind_get(int kind) {
#define SF_DROP_KIND_INFO(name, key, error_key, ...) {key, error_key, SF_DROP_SD(error_key), __VA_ARGS__},
    static const sf_drop_kind_info info[] = {SF_DROP_KINDS(SF_DROP_KIND_INFO)};
    return &info[kind];
}
