/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sweep_fixture.h"

#include "model_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

sf_status sweep_try_plan(const program_place *p, const char *factors, bool huge, sf_plan *plan,
                         sf_error *err) {
    static char path[600];
    char text[4096];
    *err = (sf_error)SF_ERROR_INIT;
    snprintf(text, sizeof text, "case = \"%s\";\nfactors = ( %s );\n",
             fixture_source("examples/eva50-v4.5/case.cfg"), factors);
    snprintf(path, sizeof path, "%s", program_write_text(p, "plan.cfg", text));
    return sf_plan_read(path, huge, plan, err);
}

void sweep_read_plan(const program_place *p, const char *factors, sf_plan *plan) {
    sf_error err;
    if (sweep_try_plan(p, factors, false, plan, &err) != SF_OK)
        fail_msg("%s", err.text);
}

void sweep_make_posterior(const program_place *p) {
    program_shell(p,
                  "mkdir -p ten && for k in 01 02 03 04 05 06 07 08 09 10; do sed 's|eva35.csv|%s|' '%s' > "
                  "ten/draw-0$k.cfg; done",
                  "../eva35.csv", fixture_source("examples/materials/eva35.cfg"));
    program_shell(p, "cp '%s' eva35.csv", fixture_source("examples/materials/eva35.csv"));
}
