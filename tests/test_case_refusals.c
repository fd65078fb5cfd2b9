/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Case files: the sentence that each fault gets. */
#include "case/read.h"
#include "material/hyperfoam.h"
#include "case_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <cmocka.h>

static void unknown_names_are_refused_with_what_exists(void **state) {
    (void)state;
    case_assert_refused(
        GEOMETRY MATERIAL SOLVER "missile: { mass = \"4.6 kg\";\n velocty = \"4.5 m/s\"; };\n", NULL,
        "case.cfg:5: unknown key \"velocty\" in group missile (did you mean \"velocity\"?)",
        "mass, velocity, speed_scatter, motion, direction, position, friction", NULL);
    case_assert_refused(
        GOOD "missle: { };\n", NULL,
        "case.cfg:5: unknown group \"missle\" (did you mean \"missile\"?); the groups are geometry, pad, "
        "material, missile, support, interfaces, membrane, kernel, solver, series, output, report",
        NULL);
    case_assert_refused(GOOD "colour = 3;\n", NULL, "case.cfg:5: unknown group \"colour\"; the groups are",
                        NULL);
    case_assert_refused(GOOD, "missile.weight=3 kg", "--set missile.weight=3 kg: unknown key \"weight\"",
                        NULL);
    case_assert_refused(GOOD, "material.densification.power=3",
                        "unknown key \"power\" in group material.densification",
                        "rule, start, exponent, limit", NULL);
    case_assert_refused(GOOD, "material.densification=3", "material.densification must be a group", NULL);
    case_assert_refused(GOOD "pad = 3;\n", NULL, "case.cfg:5: pad must be a group", NULL);
    case_assert_refused(GEOMETRY MISSILE SOLVER
                        "material: {\n@include \"materials/soft.cfg\"\ncolor = 3; };\n",
                        NULL, "case.cfg:6: unknown key \"color\"", NULL);
    case_write("materials/wrong.cfg", "density = \"35 kg/m3\";\n\nmodulus = 3;\n");
    case_assert_refused(GEOMETRY MISSILE SOLVER "material: {\n@include \"materials/wrong.cfg\"\n};\n", NULL,
                        "materials/wrong.cfg:3: unknown key \"modulus\" in group material", NULL);
}

static void missing_keys_are_refused(void **state) {
    (void)state;
    case_assert_refused(
        GEOMETRY MATERIAL SOLVER "missile: { mass = \"4.6 kg\"; };\n", NULL,
        "case.cfg:4: missile.velocity is missing: speed when it first touches the pad, whatever the gap; required without "
        "`motion`, for "
        "example velocity = \"4.5 m/s\"",
        NULL);
    case_assert_refused(GEOMETRY MATERIAL MISSILE, NULL,
                        "solver.end_time is missing (there is no such group)", NULL);
    case_assert_refused(MATERIAL MISSILE SOLVER, NULL, "geometry.file is missing", NULL);
    case_assert_refused(GEOMETRY MISSILE SOLVER "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; };\n",
                        NULL, "material.curve is missing", NULL);
    case_assert_refused(GOOD, "material.ED=1 MPa", "material.BETA1 is missing", NULL);
    case_assert_refused(GOOD, "material.densification.rule=H2", "material.densification.limit is missing",
                        NULL);
    case_assert_refused(GOOD, "material.densification={ rule = \"H2\"; limit = 0.95; }",
                        "material.densification.exponent is missing: rule H2 needs it", NULL);
}

static void units_of_another_kind_are_refused(void **state) {
    (void)state;
    case_assert_refused(
        GEOMETRY MATERIAL SOLVER "missile: { mass = \"4.6 kg\";\n\n velocity = \"4.6 kg\"; };\n", NULL,
        "case.cfg:6: missile.velocity: \"4.6 kg\" is a mass; expected a speed, for example \"4.5 m/s\"",
        NULL);
    case_assert_refused(GOOD, "missile.gravity=5 g", "is a mass; expected an acceleration", NULL);
    case_assert_refused(GOOD, "missile.mass=4.6",
                        "missile.mass: the value is a plain number; expected a mass as a text", NULL);
    case_assert_refused(GOOD, "material.E=0.4 GigaPascals!", "is not a unit", NULL);
    case_assert_refused(GOOD, "material.damp_length=cell",
                        "material.damp_length: \"cell\" does not begin with a number", "or \"spacing\"",
                        NULL);
    case_assert_refused(GOOD, "geometry.length_unit=kg", "\"kg\" is not a unit of length", NULL);
    case_assert_refused(GOOD, "output.times=[\"1 ms\", \"2 kg\"]",
                        "output.times: \"2 kg\" is a mass; expected a time", NULL);
    case_assert_refused(GOOD, "output.times=[1.0]", "item 1 is a plain number; expected a time", NULL);
    case_assert_refused(GOOD, "output.times=\"1 ms\"", "expected an array of at most", NULL);
    case_assert_refused(GOOD, "kernel.support_ratio=\"1.4\"", "the value is a text; expected a plain number",
                        NULL);
}

static void values_out_of_bounds_are_refused(void **state) {
    (void)state;
    case_assert_refused(GOOD, "missile.mass=0 kg",
                        "missile.mass: 0 kg is out of bounds; it must be at least 1e-09 kg", NULL);
    case_assert_refused(GOOD, "material.HU=1.5",
                        "material.HU: 1.5 is out of bounds; it must be at least 1e-06 and at most 1", NULL);
    case_assert_refused(GOOD, "material.HU=0", "material.HU: 0 is out of bounds", NULL);
    case_assert_refused(GOOD, "solver.step_limit=1 ms", "solver.step_limit: 0.001 s is out of bounds",
                        "5e-05 s", NULL);
    case_assert_refused(GOOD, "missile.friction=-0.1",
                        "missile.friction: -0.1 is out of bounds; it must be at least 0", NULL);
    case_assert_refused(GOOD, "kernel.support_ratio=1", "must be above 1", NULL);
    case_assert_refused(GOOD, "missile.friction=1e999", "not finite", NULL);
    case_assert_refused(GOOD, "missile.velocity=1000 m/s", "missile.velocity: 1000 m s-1 is out of bounds",
                        "at most 200 m s-1", NULL);
    case_assert_refused(GOOD, "solver.end_time=59 us", "solver.end_time: 5.9e-05 s is less than 3 times",
                        NULL);
    case_assert_refused(GOOD, "output.frame_interval=0.3 us", "1.33e+05 frames", "at most 100000", NULL);
    case_assert_refused(GOOD, "missile.gap=1 m", "missile.gap: the missile travels 0.039",
                        "never reaches the pad", "1 m away", NULL);
    case_assert_refused(GOOD, "output.times=[\"-1 ms\"]", "output.times: -0.001 s is out of bounds", NULL);
    case_assert_refused(GOOD, "missile.direction=[0, 0, 1]",
                        "missile.direction: [0, 0, 1] does not point to the pad", NULL);
    case_assert_refused(GOOD, "missile.direction=[0, -1]", "expected three plain numbers", NULL);
    case_assert_refused(GOOD, "missile.position=[\"0 mm\"]", "expected an array of two lengths, x and y",
                        NULL);
    case_assert_refused(GOOD, "missile.position=\"0 mm\"", "expected an array of two lengths, x and y", NULL);
    case_assert_refused(GOOD, "missile.position=[1, 2]", "item 1 is a plain number; expected a length", NULL);
    case_assert_refused(GOOD, "missile.position=[\"0 mm\", \"3 kg\"]",
                        "\"3 kg\" is a mass; expected a length", NULL);
    case_assert_refused(GOOD, "missile.position=[\"0 mm\", \"-2 km\"]", "-2000 m is out of bounds", NULL);
    case_assert_refused(GOOD, "material.densification.start=0.9",
                        "0.9 lies beyond the end of the compression table (0.8)", NULL);
    case_assert_refused(GOOD, "material.densification.limit=0.9", "0.9 belongs to rule H2", NULL);
    case_assert_refused(GOOD, "material.densification={ rule = \"H2\"; limit = 0.95; exponent = 0; }",
                        "exponent: rule H2 needs one above 0", NULL);
    case_assert_refused(GOOD, "material.densification={ rule = \"H2\"; limit = 0.5; exponent = 2; }",
                        "0.5 is not above the strain 0.8 at which the law starts", NULL);
}

static void wrong_types_and_words_are_refused(void **state) {
    (void)state;
    case_assert_refused(GOOD, "missile.shape=cube",
                        "missile.shape: \"cube\" is none of: auto, sphere, surface", NULL);
    case_assert_refused(GOOD, "output.fields=[\"stress\"]", "\"stress\" is none of: displacement, velocity",
                        NULL);
    case_assert_refused(GOOD, "output.fields=all", "expected an array of field names", NULL);
    case_assert_refused(GOOD, "solver.stop_after_rebound=1", "expected true or false", NULL);
    case_assert_refused(GOOD, "pad.fixed=base", "the value is a text; expected an array of names", NULL);
    case_assert_refused(GOOD, "pad.fixed=[\"base\", \"base\"]", "\"base\" is given twice", NULL);
    case_assert_refused(GOOD, "pad.fixed=[]", "pad.fixed: at least one surface must hold the pad", NULL);
    case_assert_refused(GOOD, "pad.group=3", "pad.group: the value is a plain number; expected a name", NULL);
    case_assert_refused(GOOD, "pad.group=true", "the value is true or false; expected a name", NULL);
    case_assert_refused(GOOD, "pad.group=[1]", "the value is an array; expected a name", NULL);
    case_assert_refused(GOOD, "pad.group=(1)", "the value is a list; expected a name", NULL);
    case_assert_refused(GOOD, "pad.group=\"\"", "pad.group: the name is empty", NULL);
    case_assert_refused(GOOD, "geometry.file=\"\"", "the value is an empty text; expected the name of a file",
                        NULL);
    case_assert_refused(GOOD, "geometry.length_unit=3", "expected a unit of length, for example", NULL);
    case_assert_refused(GOOD, "geometry.parameters=3", "expected a group such as", NULL);
    case_assert_refused(GOOD, "geometry.parameters.side=40 mm",
                        "\"side\" must be a finite number without a unit", NULL);
    case_assert_refused(GOOD, "geometry.missile_parameters.diameter=3", "no geometry.missile_file", NULL);
}

static void names_and_lists_that_are_too_long_are_refused(void **state) {
    (void)state;
    char name[SF_CASE_NAME_SIZE + 1], set[2048];
    memset(name, 'n', SF_CASE_NAME_SIZE);
    name[SF_CASE_NAME_SIZE] = '\0';
    snprintf(set, sizeof set, "pad.group=%s", name);
    case_assert_refused(GOOD, set, "the name is longer than 127 characters", NULL);
    snprintf(set, sizeof set, "geometry.parameters={ %s = 1; }", name);
    case_assert_refused(GOOD, set, "is longer than 127 characters", NULL);
    snprintf(set, sizeof set, "missile.%s%s%s=1", name, name, name);
    case_assert_refused(GOOD, set, "the key is longer than 255 characters", NULL);

    int length = snprintf(set, sizeof set, "pad.fixed=[\"n0\"");
    for (int k = 1; k <= SF_CASE_MAX_GROUPS; k++)
        length += snprintf(set + length, sizeof set - (size_t)length, ", \"n%d\"", k);
    snprintf(set + length, sizeof set - (size_t)length, "]");
    case_assert_refused(GOOD, set, "17 names; at most 16 are allowed", NULL);
    length = snprintf(set, sizeof set, "geometry.parameters={ ");
    for (int k = 0; k <= SF_CASE_MAX_PARAMETERS; k++)
        length += snprintf(set + length, sizeof set - (size_t)length, "p%d = 1; ", k);
    snprintf(set + length, sizeof set - (size_t)length, "}");
    case_assert_refused(GOOD, set, "65 parameters; at most 64 are allowed", NULL);
}

/* libconfig's own type for whole numbers beyond 32 bits, in the file and by --set. */
static void long_whole_numbers_are_numbers(void **state) {
    (void)state;
    sf_case c;
    case_read_good(GEOMETRY MATERIAL SOLVER
                   "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; friction = 1L; };\n",
                   "geometry.parameters={ side = 5000000000L; thickness = 50; }", &c);
    assert_true(c.missile_card.friction == 1.0);
    assert_true(c.pad.parameter[0].value == 5e9 && c.pad.parameter[1].value == 50.0);
    sf_case_free(&c);
    case_assert_refused(GOOD, "geometry.parameters.side=5000000000", "--set", "5000000000 is too large",
                        NULL);
    case_assert_refused(GOOD, "geometry.parameters={ a = 1; b = 99999999999999999999L; }",
                        "99999999999999999999L is too large", NULL);
    case_assert_refused(GEOMETRY MATERIAL SOLVER
                        "# 3000000000 /* \" */\nmissile: { mass = \"4000000000 kg\";\n"
                        "velocity = \"4.5 m/s\"; friction = -3000000000; };\n",
                        NULL, "case.cfg:6: -3000000000 is too large", NULL);
    case_assert_refused(GOOD "pad: { fixed = 0x100000000; };\n", NULL, "case.cfg:5: 0x100000000 is", NULL);
    case_read_good(GOOD "# 5000000000\n", "geometry.parameters={ side5000000000 = 5000000000.0; }", &c);
    assert_true(c.pad.parameter[0].value == 5e9);
    sf_case_free(&c);
}

static void files_that_are_not_there_are_refused(void **state) {
    (void)state;
    case_assert_refused(GOOD, "geometry.file=none.geo", "geometry.file: \"none.geo\": ", NULL);
    case_assert_refused(GOOD, "material.curve=none.csv", "none.csv cannot be read: No such file",
                        "(named at --set material.curve=none.csv)", NULL);
    case_assert_refused(GOOD, "material.curve=materials", "is not a plain file", NULL);
    case_assert_refused(GOOD "@include \"none.cfg\"\n", NULL, "case.cfg:5: ", "none.cfg cannot be read",
                        NULL);
    case_assert_refused(GOOD "@include \"materials\"\n", NULL, "is not a plain file", NULL);
    case_assert_refused(GOOD "@include \"case.cfg\"\n", NULL, "nested more than", NULL);
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    assert_int_equal(sf_case_read(case_path("absent.cfg"), 0, NULL, NULL, &c, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "absent.cfg cannot be read"));
    sf_error of_folder = SF_ERROR_INIT;
    assert_int_equal(sf_case_read(case_path(""), 0, NULL, NULL, &c, &of_folder), SF_ERR_INPUT);
    assert_non_null(strstr(of_folder.text, "is not a plain file"));
}

static void broken_syntax_names_file_and_line(void **state) {
    (void)state;
    case_assert_refused(GEOMETRY "missile: { mass = 4.6 kg; };\n", NULL, "case.cfg:2: syntax error", NULL);
    case_assert_refused(GOOD "pad: { group = \"a\"; group = \"b\"; };\n", NULL,
                        "case.cfg:5: duplicate setting name", NULL);
    case_write("materials/broken.cfg", "density = ;\n");
    case_assert_refused(GEOMETRY "material: {\n@include \"materials/broken.cfg\"\n};\n", NULL,
                        "materials/broken.cfg:1: syntax error", NULL);
    case_assert_refused(GOOD, "velocity=3", "--set velocity=3: expected group.key=value", NULL);
    case_assert_refused(GOOD, "missile.velocity", "--set missile.velocity: expected group.key=value", NULL);
    case_assert_refused(GOOD, "missile.mass.value=3", "\"mass\" is not a group", NULL);
    case_assert_refused(GOOD, "missile.=3", "--set missile.=3: \"\" is not a valid key", NULL);
}

static void assert_faults_are_refused(const char *const (*faults)[3], size_t count) {
    for (size_t k = 0; k < count; k++)
        case_assert_refused(faults[k][0], NULL, faults[k][1], faults[k][2], NULL);
}

/* libconfig 1.5 alone drops or cuts each of these, and reads the rest. */
static void nothing_of_the_text_is_dropped(void **state) {
    (void)state;
    static const char *const faults[][3] = {
        {GOOD "@include \"empty.cfg\" solver: { };\n", "case.cfg:5: \"solver: { };\" follows", "@include"},
        {GOOD "@include \"empty.cfg\";\n", "case.cfg:5: \";\" follows @include", "next line"},
        {GOOD "@include \"empty.cfg\" /* a\nb */\n", "case.cfg:5: \"/* a\" follows @include", "next line"},
        {GOOD "@include \"empty.cfg\n", "case.cfg:5: @include: the name", "not closed"},
        {GOOD "@include empty.cfg\n", "case.cfg:5: @include: the name", "in quotes is missing"},
        {GOOD "@include \"\"\n", "case.cfg:5: @include: the name", "is empty"},
        {GOOD "pad: { @include \"empty.cfg\"\n};\n", "case.cfg:5: what begins with @", "beginning of a line"},
        {GOOD "/* a */ @include \"empty.cfg\"\n", "case.cfg:5: what begins with @", "beginning of a line"},
        {GOOD "/* pad: {};\n\n", "case.cfg:5: the comment that begins here", "not closed"},
        {GOOD "/* a */ /* pad: {}; *\n/", "case.cfg:5: the comment that begins here", "not closed"},
        {GOOD "@include \"open.cfg\"\npad: {};\n", "open.cfg:2: the comment that begins here", "not closed"},
        {GOOD "x = \"abc\n;\n", "case.cfg:5: the text that begins with \"abc is not closed", "on its line"},
        {GOOD "# a\rpad: {};\n", "case.cfg:5: a line end of another kind", "carriage return"},
        {GOOD "pad: { group = \"a\\qb\"; };\n", "case.cfg:5: \\q in a text is not a character", "\\\\"},
        {GOOD "pad: { group = \"pad\\x00b\"; };\n", "case.cfg:5: \\x00 in a text", "not a character"},
        {GOOD "missile2: { friction = .; };\n", "case.cfg:5: \".\" is not a number", "."},
        {GOOD "kernel: { stabilisation = -.e5; };\n", "case.cfg:5: \"-.e5\" is not a number", "-.e5"},
        {GOOD "kernel: { stabilisation = 99999999999999999999L; };\n", "case.cfg:5: 99999999999999999999L",
         "too large"},
        {GOOD "kernel: { stabilisation = 1e999; };\n", "kernel.stabilisation", "not finite"},
        {GOOD "solver: { end_time = \"1 ms\"; };\n", "case.cfg:5", "duplicate"},
        {GOOD "};\n", "case.cfg:5", "syntax error"},
    };
    sf_case c;
    case_write("empty.cfg", "");
    case_write("open.cfg", "\n/* a\n");
    assert_faults_are_refused(faults, sizeof faults / sizeof *faults);
    case_assert_refused(GOOD, "solver.energy_limit=0.1 /* 2",
                        "--set solver.energy_limit=0.1 /* 2: ", "not closed", NULL);
    case_assert_refused(GOOD, "solver.energy_limit=0.1 /* 2 */",
                        "--set solver.energy_limit=0.1 /* 2 */: ", "a comment", NULL);
    case_read_good(GOOD "@include \"empty.cfg\"   # nothing\n\t@include \"empty.cfg\"\t// nothing\n"
                        "/* @include \"none.cfg\" \" */ pad: { group = \"#/*@\\\"\\x41\"; }; // \" /* @\n",
                   NULL, &c);
    assert_string_equal(c.pad_group, "#/*@\"A");
    sf_case_free(&c);
    case_read_good("\xEF\xBB\xBF# Windows\r\n" GEOMETRY "\r\n" MATERIAL MISSILE SOLVER, NULL, &c);
    sf_case_free(&c);
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* `count` copies of the line, where %d is the copy's number, after GOOD. */
static char *repeat(const char *line, int count) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    fputs(GOOD, out);
    for (int k = 0; k < count; k++)
        fprintf(out, line, k); /* NOLINT: formats of this file */
    fclose(out);
    return text;
}

/* 49 s and hours before there were limits. */
static void work_does_not_grow_with_what_a_case_asks_for(void **state) {
    (void)state;
    double begin = seconds();
    char name[16], text[1024];
    for (int k = 0; k < 9; k++) { /* 20^9 files */
        size_t used = 0;
        for (int i = 0; i < 20; i++)
            used += (size_t)snprintf(text + used, sizeof text - used, "@include \"level%d.cfg\"\n", k + 1);
        snprintf(name, sizeof name, "level%d.cfg", k);
        case_write(name, text);
    }
    case_write("level9.cfg", "\n");
    case_assert_refused(GOOD "@include \"level0.cfg\"\n", NULL, "more than 200 files are included", NULL);

    case_assert_refused(
        "geometry: { file = \"pad.geo\"; length_unit = \"mm\"; parameters = { side = 1e300; }; };\n" MATERIAL
            MISSILE SOLVER,
        NULL, "case.cfg:1: geometry.parameters: side is 1e+300", "outside -1e+12 to 1e+12", NULL);

    char *curves = NULL;
    size_t curves_size = 0;
    FILE *list = open_memstream(&curves, &curves_size);
    fputs(GEOMETRY MISSILE SOLVER "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curves = (", list);
    for (int k = 1; k <= 65; k++)
        fprintf(list, "%s{ rate = \"%d 1/s\"; file = \"foam.csv\"; }", k > 1 ? ", " : "", k);
    fputs("); };\n", list);
    fclose(list);
    case_assert_refused(curves, NULL, "material.curves: 65 curves; at most 64 are allowed", NULL);
    free(curves);

    char *many = repeat("u%06d = 1;\n", 70000), *few = repeat("u%d = 1;\n", 700),
         *deep = repeat("x%d: (", 40), *wide = repeat("x = [1,1,1,1,1,1,1,1,1,1 /* %d */ ];\n", 2000);
    case_assert_refused(many, NULL, "case.cfg:", "more than 20000 names and values", NULL);
    case_assert_refused(few, NULL, "case.cfg:5: unknown group \"u0\"",
                        "; unknown too: u1, u2, u3, u4, u5, u6, u7, u8, u9 and 690 more; the groups are",
                        NULL);
    case_assert_refused(deep, NULL, "case.cfg:5: brackets are nested", "32 deep", NULL);
    case_assert_refused(wide, NULL, "more than 20000 names and values", NULL);
    free(many);
    free(few);
    free(deep);
    free(wide);
    assert_true(seconds() - begin < 20);
}

/* Terms that mean nothing or are unstable, with their line; and what is right. */
static void hyperfoam_terms_are_checked(void **state) {
    (void)state;
    static const struct {
        const char *keys, *sentence;
    } cases[] = {
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; nu = 0.2; beta = 0.1; };",
         "material.term_1: both nu and beta are given"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 0.0; };", "material.term_1: alpha is 0"},
        {"term_1 = { mu = \"60 kPa\"; };", "material.term_1.alpha is missing"},
        {"", "material.term_1.mu is missing"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; nu = 0.5; };", "material.term_1.nu: 0.5 is out of bounds"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; term_3 = { nu = 0.1; };",
         "material.term_3.mu is missing"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; term_2 = { mu = \"-10 kPa\"; };",
         "material.term_2: mu and alpha are both needed"},
        {"term_1 = { mu = \"200 kPa\"; alpha = 8.0; }; term_2 = { mu = \"-20 kPa\"; alpha = 2.0; };",
         "material.term_2 (mu = -20 kPa, alpha = 2) makes the law unstable in uniaxial compression from a strain "
         "of 0.32 on (Drucker's condition); stable_to asks for 0.9"},
        {"term_1 = { mu = \"-60 kPa\"; alpha = 8.0; };", "material.term_1 (mu = -60 kPa"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; ALPHA = 0.05;",
         "material.ALPHA: 0.05 is out of bounds"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; ALPHA = 0.5; SHAPE = 0.01;",
         "material.SHAPE is 0.01; with ALPHA = 0.5"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; ED = \"1 MPa\";", "material.BETA1 is missing"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; rate_factor = 0.3;",
         "material.rate_reference is missing"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; E = \"1 MPa\";", "unknown key \"E\" in group material"},
        {"term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; };\npad: { stress_factor = 1.2;",
         "case.cfg:4: pad.stress_factor = 1.2, but the pad's material has no compression curve"},
    };
    char text[1200];
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        snprintf(text, sizeof text,
                 GEOMETRY
                 "material: { law = \"hyperfoam\"; density = \"100 kg/m3\";\n%s\n};\n" MISSILE SOLVER,
                 cases[k].keys);
        case_assert_refused(text, NULL, cases[k].sentence, NULL);
    }
    case_read_good(
        GEOMETRY
        "material: { law = \"hyperfoam\"; density = \"100 kg/m3\"; stable_to = 0.3; HU = 0.2; ALPHA = 0.4;"
        "term_1 = { mu = \"200 kPa\"; alpha = 8.0; nu = 0.25; };"
        "term_3 = { mu = \"-20 kPa\"; alpha = 2.0; beta = 0.1; }; };\n" MISSILE SOLVER,
        NULL, &c);
    const sf_hyperfoam_card *card = c.material.card;
    assert_true(card->term[0].mu == 2e5 && card->term[1].mu == 0 && card->term[2].beta == 0.1);
    assert_true(card->shared.hysteresis_alpha == 0.4 && sf_material_informed(&c.material) == 0.3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unknown_names_are_refused_with_what_exists),
        cmocka_unit_test(missing_keys_are_refused),
        cmocka_unit_test(units_of_another_kind_are_refused),
        cmocka_unit_test(values_out_of_bounds_are_refused),
        cmocka_unit_test(wrong_types_and_words_are_refused),
        cmocka_unit_test(names_and_lists_that_are_too_long_are_refused),
        cmocka_unit_test(long_whole_numbers_are_numbers),
        cmocka_unit_test(files_that_are_not_there_are_refused),
        cmocka_unit_test(broken_syntax_names_file_and_line),
        cmocka_unit_test(nothing_of_the_text_is_dropped),
        cmocka_unit_test(work_does_not_grow_with_what_a_case_asks_for),
        cmocka_unit_test(hyperfoam_terms_are_checked),
    };
    return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
