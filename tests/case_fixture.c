/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case_fixture.h"

#include "case/read.h"
#include "program_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <cmocka.h>

static program_place place; /* of this run's files; set up once before the tests */

const char *case_path(const char *name) {
    return program_path(&place, name);
}

void case_write(const char *name, const char *text) {
    program_write_text(&place, name, text);
}

int case_set_up(void **state) {
    (void)state;
    program_set_up(&place);
    mkdir(case_path("materials"), 0700);
    case_write("pad.geo", "DefineConstant[ side = 1 ];\n");
    case_write("ball.geo", "DefineConstant[ diameter = 1 ];\n");
    case_write("foam.csv", "# a foam\nstrain,stress_kPa\n0,0\n0.1,20\n0.5,100\n0.8,900\n");
    case_write("fast.csv", "strain,stress_kPa\n0,0\n0.1,30\n0.5,150\n0.7,1500\n");
    case_write("materials/inner.csv", "strain_percent,stress_MPa\n0,0\n10,0.02\n50,0.1\n80,0.9\n");
    case_write("materials/soft.cfg", "density = \"35 kg/m3\";\nE = \"0.4 MPa\";\ncurve = \"inner.csv\";\n");
    return 0;
}

int case_tear_down(void **state) {
    (void)state;
    program_tear_down(&place);
    return 0;
}

sf_status case_read_text(const char *text, const char *override, sf_case *c, sf_error *err) {
    case_write("case.cfg", text);
    return sf_case_read(case_path("case.cfg"), override ? 1 : 0, &override, NULL, c, err);
}

void case_read_good(const char *text, const char *override, sf_case *c) {
    sf_error err = SF_ERROR_INIT;
    if (case_read_text(text, override, c, &err) != SF_OK)
        fail_msg("%s", err.text);
}

void case_assert_refused(const char *text, const char *override, ...) {
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    if (case_read_text(text, override, &c, &err) == SF_OK)
        fail_msg("accepted: %s %s", text, override ? override : "");
    assert_int_equal(err.status, SF_ERR_INPUT);
    assert_null(c.path);
    va_list parts;
    va_start(parts, override);
    for (const char *part = va_arg(parts, const char *); part; part = va_arg(parts, const char *))
        if (!strstr(err.text, part))
            fail_msg("the sentence is '%s' and lacks '%s'", err.text, part);
    va_end(parts);
}
