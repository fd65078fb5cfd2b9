/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Case files: what a good one gives. Its faults: test_case_refusals. */
#include "case/read.h"
#include "case/values.h"
#include "case_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void good_case_is_in_si(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_read_good(
        GEOMETRY
        "material: { density = \"0.035 g/cm3\"; E = \"0.4136 MPa\"; curve = \"foam.csv\"; HU = 0.01; "
        "SHAPE = 2;\n"
        "  DAMP = 0.35; damp_length = \"5 mm\"; ED = \"3.43 MPa\"; BETA1 = \"5000 1/s\"; eta = \"690 "
        "Pa s\";\n"
        "  tension_cutoff = \"20 kPa\"; densification = { start = 0.7; exponent = 3.0; }; };\n"
        "missile: { mass = \"4600 g\"; velocity = \"16.2 km/h\"; direction = [0.0, 3.0, -4.0]; "
        "friction = 0.3;\n"
        "  shape = \"surface\"; gap = \"2 mm\"; position = [\"30 mm\", \"-1 in\"]; };\n"
        "pad: { group = \"foam\"; fixed = [\"base\", \"wall\"]; symmetry = []; };\n"
        "solver: { end_time = \"40 ms\"; step_limit = \"10 us\"; stop_after_rebound = false; };\n"
        "output: { frame_interval = \"0.5 ms\"; times = [\"12.2 ms\", \"300 us\"];\n"
        "  fields = [\"displacement\", \"von_mises\"]; };\n",
        NULL, &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_true(fabs(foam->shared.density - 35.0) < 1e-12);
    assert_true(fabs(foam->modulus - 413600.0) < 1e-8);
    assert_true(foam->shared.hysteresis_hu == 0.01 && foam->shared.hysteresis_shape == 2.0 &&
                foam->shared.damp == 0.35);
    assert_true(fabs(foam->shared.damp_length - 0.005) < 1e-16 && foam->shared.maxwell_rate == 5000.0);
    assert_true(fabs(foam->shared.maxwell_modulus - 3.43e6) < 1e-8 && foam->shared.kelvin_viscosity == 690.0);
    assert_true(foam->tension_cutoff == 20000.0 && foam->densification_exponent == 3.0);
    assert_true(foam->densification_start == 0.7 && foam->densification_limit == 1.0);
    assert_true(fabs(c.missile_card.mass - 4.6) < 1e-14 && fabs(c.missile_card.speed - 4.5) < 1e-14);
    assert_true(fabs(c.missile_card.direction[1] - 0.6) < 1e-15 &&
                fabs(c.missile_card.direction[2] + 0.8) < 1e-15);
    assert_true(c.missile_card.friction == 0.3 && c.missile_card.gravity == 9.80665);
    assert_true(fabs(c.missile_card.gap - 0.002) < 1e-16);
    assert_true(c.position_given && fabs(c.missile_position[0] - 0.03) < 1e-16 &&
                fabs(c.missile_position[1] + 0.0254) < 1e-16);
    assert_true(c.length_unit == 0.001);
    assert_int_equal(c.shape_rule, 2);
    assert_string_equal(c.pad_group, "foam");
    assert_string_equal(c.contact_group, "top");
    assert_int_equal(c.fixed_count, 2);
    assert_string_equal(c.fixed_group[1], "wall");
    assert_int_equal(c.symmetry_count, 0);
    assert_true(c.symmetry_given);
    assert_true(fabs(c.run.end_time - 0.04) < 1e-16 && fabs(c.run.frame_interval - 5e-4) < 1e-18);
    assert_int_equal(c.frame_time_count, 2);
    assert_true(fabs(c.frame_time[0] - 3e-4) < 1e-18 && fabs(c.frame_time[1] - 0.0122) < 1e-16);
    assert_int_equal(c.run.stop_after_rebound, 0);
    assert_int_equal(c.run.output_fields, SF_FIELD_DISPLACEMENT | SF_FIELD_VON_MISES);
    assert_int_equal(foam->curves.curve_count, 1);
    assert_int_equal(foam->curves.curve_points, 4);
    assert_true(foam->curves.curve_strain[2] == 0.5 && foam->curves.curve_stress[2] == 100e3);
}

static void defaults_are_those_of_the_table(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_read_good(GOOD, NULL, &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_string_equal(c.pad_group, "pad");
    assert_string_equal(c.fixed_group[0], "base");
    assert_int_equal(c.symmetry_count, 2);
    assert_false(c.symmetry_given);
    assert_string_equal(c.symmetry_group[1], "symmetry_y");
    assert_string_equal(c.surface_group, "missile_surface");
    assert_true(c.support_ratio == 1.4 && c.run.stabilisation == 0.1 && c.run.step_safety == 0.97);
    assert_true(foam->shared.hysteresis_hu == 1.0 && foam->shared.damp_length == 0.0 &&
                foam->shared.maxwell_modulus == 0.0);
    assert_true(foam->tension_cutoff >= 1e30 && isfinite(foam->tension_cutoff));
    assert_true(c.missile_card.direction[2] == -1.0);
    assert_int_equal(c.run.output_fields, SF_FIELD_ALL);
    assert_int_equal(c.run.stop_after_rebound, 1);
    assert_null(c.missile.path);
    assert_non_null(strstr(c.parameters, "given"));
    assert_non_null(strstr(c.parameters, "kernel.support_ratio"));
}

/* The line of the listing that begins with `key`. */
static void listed_line(const sf_case *c, const char *key, char *out, size_t size) {
    const char *at = strstr(c->parameters, key);
    assert_non_null(at);
    snprintf(out, size, "%.*s", (int)strcspn(at, "\n"), at);
}

static void listing_has_value_si_value_and_origin(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    char line[512];
    case_read_good(GOOD, "missile.velocity=18 km/h", &c);
    listed_line(&c, "missile.velocity", line, sizeof line);
    assert_non_null(strstr(line, "\"18 km/h\""));
    assert_non_null(strstr(line, "5 m s-1"));
    assert_non_null(strstr(line, "given"));
    listed_line(&c, "missile.gravity", line, sizeof line);
    assert_non_null(strstr(line, "9.80665 m s-2"));
    assert_non_null(strstr(line, "default"));
}

static void set_overrides_every_kind_of_value(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_write("case.cfg", GOOD);
    const char *const sets[] = {
        "missile.velocity=5.2 m/s",        "missile.mass = \"5 kg\"",
        "geometry.parameters.side=70",     "geometry.parameters.quarter=true",
        "geometry.missile_file=ball.geo",  "geometry.missile_parameters={ diameter = 160; }",
        "solver.stop_after_rebound=false", "kernel.support_ratio=1.5",
        "pad.fixed=[\"left\", \"right\"]", "material.densification.start=0.6"};
    sf_error err = SF_ERROR_INIT;
    if (sf_case_read(case_path("case.cfg"), 10, sets, NULL, &c, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(c.missile_card.speed == 5.2 && c.missile_card.mass == 5.0);
    assert_int_equal(c.pad.parameter_count, 2);
    assert_string_equal(c.pad.parameter[0].name, "side");
    assert_true(c.pad.parameter[0].value == 70.0 && c.pad.parameter[1].value == 1.0);
    assert_string_equal(c.missile.path, case_path("ball.geo"));
    assert_true(c.missile.parameter[0].value == 160.0);
    assert_int_equal(c.run.stop_after_rebound, 0);
    assert_true(c.support_ratio == 1.5);
    assert_string_equal(c.fixed_group[1], "right");
    assert_true(sf_foam_card_of(&c.material)->densification_start == 0.6);
    assert_non_null(strstr(c.text, "# --set missile.velocity=5.2 m/s\n"));
}

static void set_replaces_a_group_by_a_file(void **state) {
    (void)state;
    sf_case c;
    char set[600], where[600];
    snprintf(set, sizeof set, "material=@%s", case_path("materials/soft.cfg"));
    case_read_good(GOOD, set, &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_int_equal(foam->curves.curve_points, 4);
    assert_true(foam->curves.curve_stress[3] == 0.9e6); /* inner.csv, beside soft.cfg */
    assert_non_null(strstr(c.text, "#     curve = \"inner.csv\";\n"));
    sf_case_free(&c);

    case_write("materials/other.cfg", "density = \"35 kg/m3\";\nE = \"3 kg\";\ncurve = \"inner.csv\";\n");
    snprintf(set, sizeof set, "material=@%s", case_path("materials/other.cfg"));
    snprintf(where, sizeof where, "%s:2: material.E", case_path("materials/other.cfg"));
    case_assert_refused(GOOD, set, where, NULL);
    case_assert_refused(GOOD, "material=@none.cfg", "the file none.cfg cannot be read", NULL);
    case_write("materials/broken.cfg", "density = ;\n");
    snprintf(set, sizeof set, "material=@%s", case_path("materials/broken.cfg"));
    case_assert_refused(GOOD, set, "broken.cfg:1: syntax error", NULL);
}

/* A draw of a posterior states errors of the responses: read from the file, of no effect on the foam. */
static void response_errors_of_a_material_are_read(void **state) {
    (void)state;
    sf_case c;
    char set[600];
    case_read_good(GOOD, NULL, &c);
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        assert_false(c.response_error.given[kind]);
    sf_case_free(&c);
    case_write("materials/draw.cfg",
               "density = \"35 kg/m3\";\nE = \"0.4 MPa\";\ncurve = \"inner.csv\";\n"
               "response_error = { HIC = -0.0125; HIC_sd = 0.02; a_max = 1e-3; a_max_sd = 0; };\n");
    snprintf(set, sizeof set, "material=@%s", case_path("materials/draw.cfg"));
    case_read_good(GOOD, set, &c);
    assert_true(c.response_error.given[SF_FIT_HIC] && c.response_error.given[SF_FIT_A_MAX]);
    assert_false(c.response_error.given[SF_FIT_WINDOW]);
    assert_true(c.response_error.shared[SF_FIT_HIC] == -0.0125 &&
                c.response_error.own_sd[SF_FIT_HIC] == 0.02);
    assert_true(c.response_error.shared[SF_FIT_A_MAX] == 1e-3 && c.response_error.own_sd[SF_FIT_A_MAX] == 0);
    sf_case_free(&c);
    snprintf(set, sizeof set, "materials.core=@%s", case_path("materials/draw.cfg"));
    case_read_good(GEOMETRY MISSILE SOLVER "materials: { core: {}; };\n", set, &c);
    assert_int_equal(c.layer_count, 1);
    assert_false(c.response_error.given[SF_FIT_HIC]); /* of a pad of one material */
    sf_case_free(&c);
}

static void response_errors_that_cannot_be_meant_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *group, *part;
    } cases[] = {
        {"3", "material.response_error must be a group: response_error = { "},
        {"{ HIC = 0.01; }", "material.response_error.HIC is given without HIC_sd"},
        {"{ HIC_sd = 0.01; }", "material.response_error.HIC_sd is given without HIC"},
        {"{ hic = 0.01; }",
         "unknown key \"hic\" in group material.response_error; its keys are a_max, a_max_sd, HIC, "
         "HIC_sd, HIC_window, HIC_window_sd, v_rebound, v_rebound_sd, contact_time, contact_time_sd"},
        {"{ HIC = \"1 %\"; HIC_sd = 0.1; }", "material.response_error.HIC: the value is "},
        {"{ HIC = 0.1; HIC_sd = -0.1; }", "material.response_error.HIC_sd: -0.1 is out of bounds"},
        {"{ HIC = 2.0; HIC_sd = 0.1; }", "material.response_error.HIC: 2 is out of bounds"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 GEOMETRY MISSILE SOLVER
                 "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curve = \"foam.csv\";\n"
                 "response_error = %s; };\n",
                 cases[k].group);
        case_assert_refused(text, NULL, "case.cfg:5: ", cases[k].part, NULL);
    }
    case_assert_refused(GOOD, "material.response_eror=3", "unknown key \"response_eror\"", ", response_error",
                        NULL);
}

static void include_brings_its_own_folder_for_the_curve(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_read_good(GEOMETRY "material: {\n@include \"materials/soft.cfg\"\n};\n" MISSILE SOLVER, NULL, &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_int_equal(foam->curves.curve_points, 4);
    assert_true(fabs(foam->curves.curve_strain[1] - 0.1) < 1e-16 &&
                fabs(foam->curves.curve_stress[3] - 0.9e6) < 1e-9);
    assert_non_null(strstr(c.text, "density = \"35 kg/m3\";\nE = "));
    assert_null(strstr(c.text, "@include"));
}

/* Also inside an included file, and the lines after it keep their numbers. */
static void include_may_be_absolute(void **state) {
    (void)state;
    char text[2048];
    case_write("materials/outer.cfg",
               "density = \"35 kg/m3\";\n@include \"materials/rest.cfg\"\nHU = 3.0;\n");
    case_write("materials/rest.cfg", "E = \"0.4 MPa\";\ncurve = \"inner.csv\";\n");
    snprintf(text, sizeof text, "%smaterial: {\n@include \"%s\"\n};\n%s%s", GEOMETRY,
             case_path("materials/soft.cfg"), MISSILE, SOLVER);
    sf_case c;
    case_read_good(text, NULL, &c);
    assert_int_equal(sf_foam_card_of(&c.material)->curves.curve_points, 4);
    sf_case_free(&c);
    case_assert_refused(text, "missile.mass=3", "--set missile.mass=3: ", NULL);
    snprintf(text, sizeof text, "%smaterial: {\n@include \"%s\"\n};\n%s%s", GEOMETRY,
             case_path("materials/outer.cfg"), MISSILE, SOLVER);
    case_assert_refused(text, NULL, "materials/outer.cfg:3: material.HU: 3 is out of bounds", NULL);
    snprintf(text, sizeof text, "%smaterial: {\n@include \"%s\"\n};\nmissile: { mass = 3; };\n", GEOMETRY,
             case_path("materials/soft.cfg"));
    case_assert_refused(text, NULL, "case.cfg:5: missile.mass: the value is a plain number", NULL);
    snprintf(text, sizeof text, "%smaterial: {\n@include \"%s\"\n};\nmissile: { mass = ; };\n", GEOMETRY,
             case_path("materials/soft.cfg"));
    case_assert_refused(text, NULL, "case.cfg:5: syntax error", NULL);
}

/* `material = "NAME";` is the group of that foam of softfall, or of a material file; a line of its own. */
static void material_may_be_a_name(void **state) {
    (void)state;
    static const char *const lines[] = {"material = \"leap\";\n", "  material : \"leap\" ; # a foam\n",
                                        "material = \"materials/leap.cfg\"\n"};
    sf_case c, same;
    char text[4096];
    case_write("materials/leap.cfg", "density = \"100 kg/m3\"; E = \"0.96 MPa\"; curve = \"../foam.csv\";\n");
    snprintf(text, sizeof text, "%smaterial: {\n@include \"%s/examples/materials/leap.cfg\"\n};\n%s%s",
             GEOMETRY, getenv("SF_SOURCE_DIR"), MISSILE, SOLVER);
    case_read_good(text, NULL, &same);
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text, "%s%s%s%s", GEOMETRY, lines[k], MISSILE, SOLVER);
        case_read_good(text, "material.DAMP=0.1", &c);
        assert_true(sf_material_density(&c.material) == 100);
        assert_int_equal(sf_material_curves(&c.material)->curve_points ==
                             sf_material_curves(&same.material)->curve_points,
                         k < 2);
        sf_case_free(&c);
    }
    sf_case_free(&same);
    case_assert_refused(GEOMETRY "material = \"laep\";\n" MISSILE SOLVER, NULL,
                        "case.cfg:2: ", "no foam \"laep\"", "softfall foam list", NULL);
    case_assert_refused(GEOMETRY "material = \"leap\"; missile: { };\n" SOLVER, NULL,
                        "case.cfg:2: ", "must be a group", NULL);
    case_assert_refused(GEOMETRY "material = \"leap\";\n" MISSILE "solver: { end_time = 3; };\n", NULL,
                        "case.cfg:4: ", NULL);
}

static void h2_takes_limit_and_exponent(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_read_good(GOOD, "material.densification={ rule = \"H2\"; limit = 0.95; exponent = 2.5; }", &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_int_equal(foam->densification_rule, SF_DENSIFICATION_H2);
    assert_true(foam->densification_limit == 0.95 && foam->densification_exponent == 2.5);
}

/* Every example reads, and they differ in what their names say. */
static void examples_are_the_drops_they_are_called(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double thickness, speed, quarter;
    } drops[] = {{"eva50-v4.5", 50, 4.5, 1}, {"eva50-v5.2", 50, 5.2, 1}, {"eva70-v4.5", 70, 4.5, 1},
                 {"eva70-v5.2", 70, 5.2, 1}, {"eva70-v6.2", 70, 6.2, 1}, {"eva50-v4.5-full", 50, 4.5, 0}};
    const char *root = getenv("SF_SOURCE_DIR");
    assert_non_null(root);
    for (size_t k = 0; k < sizeof drops / sizeof *drops; k++) {
        char path[1024];
        sf_error err = SF_ERROR_INIT;
        sf_case c;
        snprintf(path, sizeof path, "%s/examples/%s/case.cfg", root, drops[k].name);
        if (sf_case_read(path, 0, NULL, NULL, &c, &err) != SF_OK)
            fail_msg("%s", err.text);
        int seen = 0;
        for (int i = 0; i < c.pad.parameter_count; i++) {
            const sf_geo_parameter *p = &c.pad.parameter[i];
            seen += strcmp(p->name, "thickness") == 0 && p->value == drops[k].thickness;
            seen += strcmp(p->name, "quarter") == 0 && p->value == drops[k].quarter;
        }
        assert_int_equal(seen, 2);
        assert_true(c.missile_card.speed == drops[k].speed && c.missile_card.mass == 4.6);
        assert_true(sf_foam_card_of(&c.material)->shared.density == 35.0 &&
                    sf_foam_card_of(&c.material)->shared.rate_factor > 0.3 &&
                    sf_foam_card_of(&c.material)->shared.damp == 0.05);
        sf_case_free(&c);
    }
}

/* docs/case.md ends with the table as the program prints it. */
static void reference_is_the_table(void **state) {
    (void)state;
    char *table = NULL, path[1024];
    size_t size = 0;
    FILE *out = open_memstream(&table, &size);
    assert_non_null(out);
    sf_case_print_keys(out);
    fclose(out);
    const char *root = getenv("SF_SOURCE_DIR");
    assert_non_null(root);
    snprintf(path, sizeof path, "%s/docs/case.md", root);
    FILE *in = fopen(path, "r");
    assert_non_null(in);
    char *text = NULL;
    size_t capacity = 0;
    assert_true(getdelim(&text, &capacity, '\0', in) > 0);
    fclose(in);
    if (!strstr(text, table))
        fail_msg("docs/case.md is not up to date; its last part must be the output of softfall-pre --keys");
    free(text);
    free(table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_case_is_in_si),
        cmocka_unit_test(defaults_are_those_of_the_table),
        cmocka_unit_test(listing_has_value_si_value_and_origin),
        cmocka_unit_test(set_overrides_every_kind_of_value),
        cmocka_unit_test(set_replaces_a_group_by_a_file),
        cmocka_unit_test(response_errors_of_a_material_are_read),
        cmocka_unit_test(response_errors_that_cannot_be_meant_are_refused),
        cmocka_unit_test(include_brings_its_own_folder_for_the_curve),
        cmocka_unit_test(include_may_be_absolute),
        cmocka_unit_test(material_may_be_a_name),
        cmocka_unit_test(h2_takes_limit_and_exponent),
        cmocka_unit_test(examples_are_the_drops_they_are_called),
        cmocka_unit_test(reference_is_the_table),
    };
    return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
