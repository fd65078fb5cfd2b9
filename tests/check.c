/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

void check_skip_refused(const char *reason) {
    print_message("skipped: %s\n", reason);
    skip();
}

void check_skip_missing(const char *reason) {
    const char *strict = getenv("SF_NO_SKIP");
    if (strict && *strict)
        fail_msg("%s, and SF_NO_SKIP is set", reason);
    check_skip_refused(reason);
}

void check_programs(const char *names) {
    char command[512], reason[600];
    snprintf(command, sizeof command, "for k in %s; do command -v $k >/dev/null || exit 1; done", names);
    snprintf(reason, sizeof reason, "not all of these programs are installed: %s", names);
    if (system(command) != 0)
        check_skip_missing(reason);
}

bool check_slow(void) {
    const char *slow = getenv("SF_SLOW");
    return slow && strcmp(slow, "1") == 0;
}
