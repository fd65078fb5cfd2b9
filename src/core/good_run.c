/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/good_run.h"

const sf_good_run *sf_good_run_limits(void) {
#define LIMIT(name, value, ...) .name = value,
    static const sf_good_run limits = {SF_GOOD_RUN(LIMIT)};
#undef LIMIT
    return &limits;
}
