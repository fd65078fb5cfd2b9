/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/good_run.h"

const sf_good_run *sf_good_run_limits(void) {
#define LIMIT(name, remark, ...) .name = remark,
    static const sf_good_run limits = {SF_GOOD_RUN(LIMIT)};
#undef LIMIT
    return &limits;
}

const sf_good_run_rule *sf_good_run_rule_get(int k) {
#define RULE(name, remark, refuse, sure, shown, title, figures, why)                                         \
    {#name, title, remark, refuse, sure, shown == SF_AS_PERCENT, figures, why},
    static const sf_good_run_rule rules[SF_CHECKS] = {SF_GOOD_RUN(RULE)};
#undef RULE
    return &rules[k];
}
