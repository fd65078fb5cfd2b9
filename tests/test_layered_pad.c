/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad of layers through the three programs: its figures by layer, the same bits for any number of threads
 * and after a restart, and what is refused. */
#include "check.h"
#include "extreme.h"
#include "io/h5_data.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const char *const COARSE =
    "--set geometry.parameters.fine_spacing=10.0 --set geometry.parameters.outer_spacing=20.0 "
    "--set geometry.parameters.side=200.0 --set geometry.parameters.zone_side=120.0 "
    "--set pad.mesh_error_limit=1";

/* The example beside geo and materials, its coarse model, and one run of it. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_result made = program_shell(
        p, "mkdir examples && cp -r \"$SF_SOURCE_DIR/geo\" . && "
           "cp -r \"$SF_SOURCE_DIR/examples/layers\" \"$SF_SOURCE_DIR/examples/materials\" examples && "
           "cp \"$SF_SOURCE_DIR\"/tests/materials/* examples/materials");
    assert_int_equal(made.code, 0);
    program_succeed(p, "pre", "examples/layers/case.cfg -o m.h5 %s", COARSE);
    program_succeed(p, "solve", "m.h5 -o r.h5 --threads 1");
    program_succeed(p, "post", "r.h5 -o out");
    return 0;
}

/* The number behind `"key":` after the `place`-th one of `"name":`. */
static double figure_of(const char *text, const char *key, int place) {
    for (int k = 0; k < place && text; k++)
        text = strstr(text, "\"name\":") ? strstr(text, "\"name\":") + 1 : NULL;
    return program_json_number(text, NULL, key);
}

/* The value of a column in the last row of a CSV file. */
static double last_value(const char *text, const char *column) {
    int place = 0;
    const char *head = text;
    while (*head == '#')
        head = strchr(head, '\n') + 1;
    const char *found = strstr(head, column);
    assert_non_null(found);
    for (const char *c = head; c < found; c++)
        place += *c == ',';
    const char *row = strrchr(text, '\n');
    while (row > text && row[-1] != '\n')
        row--;
    for (; place > 0; place--)
        row = strchr(row, ',') + 1;
    return strtod(row, NULL);
}

static void summary_tells_strain_and_energy_by_layer(void **state) {
    static const char *const energies[][2] = {{"stored_energy_J", "energy_stored_J"},
                                              {"hysteresis_energy_J", "energy_hysteresis_J"},
                                              {"viscous_energy_J", "energy_viscous_J"}};
    const program_place *p = *state;
    program_bytes summary = program_read_file(program_path(p, "out/summary.json")),
                  history = program_read_file(program_path(p, "out/history.csv"));
    const char *layers = strstr(summary.data, "\"layers\":");
    assert_non_null(layers);
    double most = 0, share = 0, volume = 0;
    for (int k = 1; k <= 3; k++) {
        most = larger(most, figure_of(layers, "max_local_strain", k));
        share += figure_of(layers, "energy_share", k);
        volume += figure_of(layers, "volume_cm3", k);
        assert_close(figure_of(layers, "energy_beyond_data", k), 0.5, 0.5);
    }
    assert_close(most, figure_of(summary.data, "max_local_strain", 0), 1e-6);
    assert_close(share, 1, 1e-6);
    assert_close(volume / (1e-3 * figure_of(summary.data, "section_mm2", 0) *
                           figure_of(summary.data, "thickness_mm", 0)),
                 1, 1e-6);
    for (int e = 0; e < 3; e++) { /* the ledger's energy is that of its layers */
        double sum = 0, all = last_value(history.data, energies[e][1]);
        for (int k = 1; k <= 3; k++)
            sum += figure_of(layers, energies[e][0], k);
        assert_close(sum / all, 1, 1e-5);
    }
    assert_close(figure_of(layers, "density_kg_m3", 1), 90, 1e-9);
    free(summary.data);
    free(history.data);
}

static void assert_same_figures(const program_place *p, const char *run) {
    program_figures(p, "%s.h5 -o %s --force", run, run);
    for (int k = 0; k < 2; k++) {
        program_result same = program_shell(
            p,
            k ? "grep -A60 '\"layers\"' out/summary.json > 1; grep -A60 '\"layers\"' %s/summary.json > 2; cmp 1 2"
              : "cmp out/history.csv %s/history.csv",
            run);
        if (same.code != 0)
            fail_msg("%s: %s", run, same.out);
    }
}

static void threads_and_restarts_leave_every_bit(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "m.h5 -o two.h5 --threads 2");
    assert_same_figures(p, "two");
    program_succeed(p, "solve", "m.h5 -o again.h5 --threads 1 --end-time '6.5 ms'");
    program_succeed(p, "solve", "--restart again.h5 --threads 1 --end-time '40 ms'");
    assert_same_figures(p, "again");
}

static void large_slips_are_noted(void **state) {
    const program_place *p = *state;
    program_succeed(
        p, "pre", "examples/layers/case.cfg -o slip.m.h5 %s --set pad.sliding_interfaces='[\"cover/upper\"]'",
        COARSE);
    program_succeed(p, "solve", "slip.m.h5 -o slip.h5 --threads 1 --no-checkpoint");
    program_figures(p, "slip.h5 -o slip");
    assert_int_equal(program_shell(p, "grep -q 'layers slide on each other by up to' slip/summary.json").code,
                     0);
    assert_int_equal(program_shell(p, "grep -q 'layers slide' out/summary.json").code, 1);
}

/* A file may stand in place of a layer's group, and a single layer is a pad of one material. */
static void layers_read_like_the_one_material(void **state) {
    const program_place *p = *state;
    program_shell(p, "cp \"$SF_SOURCE_DIR/examples/eva50-v4.5/case.cfg\" examples/layers/one.cfg; "
                     "sed 's|^material: {|materials: { pad: {|; s|^};|};|; /eva35/{n;s|};|}; };|}' "
                     "examples/layers/one.cfg > examples/layers/named.cfg");
    for (int k = 0; k < 2; k++) {
        const char *name = k ? "named" : "one";
        program_succeed(p, "pre", "examples/layers/%s.cfg -o %s.m.h5 %s", name, name, program_coarse(25));
        program_succeed(p, "solve", "%s.m.h5 -o %s.h5 --threads 1 --end-time '2 ms' --no-checkpoint", name,
                        name);
        program_figures(p, "%s.h5 -o %s", name, name);
    }
    assert_int_equal(program_shell(p, "cmp one/history.csv named/history.csv").code, 0);
    program_succeed(
        p, "pre",
        "examples/layers/case.cfg -o file.h5 %s --set materials.cover=@examples/layers/hard_foam.cfg "
        "--set materials.cover.DAMP=0.1",
        COARSE);
    sf_h5 *file = program_open_h5(p, "file.h5");
    sf_error err = SF_ERROR_INIT;
    double value = 0;
    char *name = NULL;
    assert_int_equal(sf_h5_read_scalar(file, "/material/2/density", &value, &err), SF_OK);
    assert_close(value, 90, 1e-9);
    assert_int_equal(sf_h5_read_scalar(file, "/material/2/DAMP", &value, &err), SF_OK);
    assert_close(value, 0.1, 1e-12);
    assert_int_equal(sf_h5_read_text(file, "/material/2/name", &name, &err), SF_OK);
    assert_string_equal(name, "cover");
    free(name);
    sf_h5_close(&file, &err);
}

static void assert_refused(const program_result *r, const char *part) {
    int lines = 0;
    for (const char *c = r->err; *c; c++)
        lines += *c == '\n';
    if (r->code <= 0 || r->code >= 128 || lines != 1 || !strstr(r->err, part))
        fail_msg("exit code %d where \"%s\" was expected: %s", r->code, part, r->err);
}

/* An entry `name` of the group of interfaces, between these layers. */
#define INTERFACE(name, layers, kind)                                                                        \
    "--set interfaces." name ".between='[\"" layers "\"]' --set interfaces." name ".kind=" kind " "

static void layers_that_cannot_be_meant_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *words, *part;
    } rows[] = {
        {"--set materials.floor=@examples/layers/hard_foam.cfg", "has no volume group \"floor\""},
        {"--set material=@examples/layers/hard_foam.cfg", "there is no place for one material"},
        {"--set pad.sliding_interfaces='[\"cover/upper\",\"upper/cover\"]'", "are the same interface"},
        {"--set materials.cover.eta='1 GPa s'", "too viscous (materials.cover: E, curve, ED, eta, DAMP)"},
        {"--set pad.group=lower", "pad.group: the groups of materials name the pad's volumes"},
        {"--set pad.sliding_interfaces='[\"cover/lower\"]'", "\"cover\" and \"lower\" do not touch"},
        {"--set pad.sliding_interfaces='[\"cover/floor\"]'", "\"cover/floor\" does not name two layers"},
        {"--set pad.sliding_interfaces='[\"cover\"]'", "does not name two layers"},
        {"--set materials.lower.E='1 m'", "materials.lower.E"},
        {"--set materials.lower.memory.set=0.05", "needs foams with the same set"},
        {"--set materials.lower.speed=3", "unknown key \"speed\" in group materials.lower"},
        {"--set materials.lower.law=steel", "materials.lower.law: \"steel\" is none of"},
        {"--set materials.lower.densification.limit=0.3", "materials.lower.densification"},
        {"--set materials.law=steel", "materials.law must be a group"},
        {"--set geometry.parameters.cover=0", "has no volume group \"cover\""},
        {INTERFACE("a", "cover\",\"floor", "loose"), "unknown layer \"floor\" of materials"},
        {INTERFACE("a", "cover", "loose"), "interfaces.between must name two layers"},
        {INTERFACE("a", "cover\",\"cover", "loose"), "\"cover\" is given twice"},
        {INTERFACE("a", "cover\",\"lower", "loose"), "\"lower\" do not touch: they share no face"},
        {INTERFACE("a", "cover\",\"upper", "loose") INTERFACE("b", "upper\",\"cover", "tied"),
         "\"upper\" and \"cover\" are given twice"},
        {INTERFACE("a", "cover\",\"upper", "loose") "--set interfaces.a.friction=-0.1",
         "interfaces.friction: -0.1 is out of bounds"},
        {INTERFACE("a", "cover\",\"upper", "tied") "--set interfaces.a.friction=0.1",
         "is tied; only one that"},
        {INTERFACE("a", "cover\",\"upper", "sliding") "--set interfaces.a.friction=0", "is sliding; only"},
        {INTERFACE("a", "cover\",\"upper", "welded"), "\"welded\" is none of: tied, sliding, loose"},
        {INTERFACE("a", "cover\",\"upper", "loose") "--set interfaces.a.mu=1",
         "in group interfaces; its keys"},
        {INTERFACE("a", "cover\",\"upper", "loose") "--set pad.self_contact=off", "need pad.self_contact"},
        {"--set interfaces.a.kind=loose", "interfaces.between is missing"},
        {"--set interfaces.a=loose", "an interface must be a group"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result r =
            program_run(p, "pre", "examples/layers/case.cfg -o new.h5 %s %s", COARSE, rows[k].words);
        assert_refused(&r, rows[k].part);
        assert_int_equal(program_shell(p, "ls new.h5").code, 2);
    }
    program_shell(p, "sed '/cover: {/,/};/d' examples/layers/case.cfg > examples/layers/two.cfg");
    program_result r = program_run(p, "pre", "examples/layers/two.cfg -o new.h5 %s", COARSE);
    assert_refused(&r, "of the group \"cover\"");
    assert_refused(&r, "has no material");
    r = program_run(p, "pre", "examples/layers/one.cfg -o new.h5 --set pad.sliding_interfaces='[\"a/b\"]'");
    assert_refused(&r, "the pad has one material");
    r = program_run(p, "pre", "examples/layers/one.cfg -o new.h5 %s", INTERFACE("a", "a\",\"b", "tied"));
    assert_refused(&r, "the pad has one material");
    program_shell(p, "(cat examples/layers/case.cfg; echo 'interfaces = [1, 2];') > examples/layers/two.cfg");
    r = program_run(p, "pre", "examples/layers/two.cfg -o new.h5 %s", COARSE);
    assert_refused(&r, "interfaces must be a list");
}

/* Each row: the words of a case, and the lines of the report about its interfaces. */
static void interfaces_come_before_the_older_keys(void **state) {
    const program_place *p = *state;
    static const char *const tied = "lower, upper: tied, ", *const slides = "lower, upper: sliding, ";
    static const struct {
        const char *words, *lower, *cover;
    } rows[] = {
        {"", tied, "upper, cover: tied, "},
        {"--set pad.loose_interfaces='[\"cover/upper\"]' --set pad.self_friction=0.2", tied,
         "upper, cover: loose, friction 0.2, "},
        {INTERFACE("a", "cover\",\"upper", "loose") "--set pad.self_friction=0.2", tied,
         "upper, cover: loose, friction 0.2, "},
        {INTERFACE("a", "cover\",\"upper", "loose") "--set interfaces.a.friction=0.3", tied,
         "upper, cover: loose, friction 0.3, "},
        {INTERFACE("a", "cover\",\"upper", "tied") "--set pad.loose_interfaces='[\"upper/cover\"]' "
                                                   "--set pad.sliding_interfaces='[\"upper/lower\"]'",
         slides, "upper, cover: tied, "},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        program_result r = program_succeed(p, "pre", "examples/layers/case.cfg -o join%zu.h5 %s %s", k,
                                           COARSE, rows[k].words);
        if (!strstr(r.out, rows[k].lower) || !strstr(r.out, rows[k].cover) || !strstr(r.out, " faces\n"))
            fail_msg("%s: %s", rows[k].words, r.out);
    }
    program_shell(
        p, "(cat examples/layers/case.cfg; echo 'interfaces = ( { between = [\"upper\", \"cover\"]; kind = "
           "\"loose\"; friction = 0.3; } );') > examples/layers/two.cfg");
    program_succeed(p, "pre", "examples/layers/two.cfg -o join5.h5 %s", COARSE);
    /* the same model by either key, and by a list or a group */
    static const char *const models[] = {"join1.h5", "join2.h5", "join3.h5", "join5.h5"};
    char hash[4][80];
    for (int k = 0; k < 4; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_h5 *file = program_open_h5(p, models[k]);
        if (sf_h5_get_attribute(file, "/", "content_hash", hash[k], sizeof hash[k], &err) != SF_OK)
            fail_msg("%s", err.text);
        sf_h5_drop(&file);
    }
    assert_string_equal(hash[0], hash[1]);
    assert_string_equal(hash[2], hash[3]);
    assert_string_not_equal(hash[0], hash[2]);
}

/* Two blocks whose meshes do not share faces. */
static void layers_that_do_not_share_faces_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        double gap;
        const char *part;
    } rows[] = {{0.5, "2 parts that share no faces"}, {0, "coincide at"}, {-4, "overlaps"}};
    program_write_text(
        p, "geo/two.geo",
        "SetFactory(\"OpenCASCADE\");\nDefineConstant[gap = 0];\nBox(1) = {0, 0, 0, 40, 40, 20};\n"
        "Box(2) = {0, 0, 20 + gap, 40, 40, 20};\nPhysical Volume(\"lower\") = {1};\n"
        "Physical Volume(\"upper\") = {2};\n"
        "Physical Surface(\"base\") = Surface In BoundingBox{-1, -1, -1, 41, 41, 1};\n"
        "Physical Surface(\"top\") = Surface In BoundingBox{-1, -1, 39 + gap, 41, 41, 41 + gap};\n"
        "Mesh.MeshSizeMax = 10;\n");
    program_shell(
        p,
        "sed '/cover: {/,/};/d; s|layers.geo|two.geo|; s|^    parameters.*|    parameters = { gap = 0.0; };|' "
        "examples/layers/case.cfg > examples/layers/apart.cfg");
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result r =
            program_run(p, "pre",
                        "examples/layers/apart.cfg -o new.h5 --set geometry.parameters.gap=%g --set "
                        "pad.mesh_error_limit=1 --set geometry.missile_parameters.quarter=0",
                        rows[k].gap);
        assert_refused(&r, rows[k].part);
    }
}

/* Three blocks whose seams meet under the missile, on a coarse mesh with copies of unlike mass: contact gives
 * no energy, and no copy escapes it. */
static void contact_on_seams_gives_no_energy(void **state) {
    const program_place *p = *state;
    static const char *const words[] = {"", "--set pad.base=resting --set missile.friction=0.5",
                                        "--set materials.front=@examples/layers/hard_foam.cfg"};
    program_write_text(p, "geo/seams.geo",
                       "SetFactory(\"OpenCASCADE\");\nBox(1) = {-100, -100, 0, 100, 200, 50};\n"
                       "Box(2) = {0, -100, 0, 100, 100, 50};\nBox(3) = {0, 0, 0, 100, 100, 50};\n"
                       "v() = BooleanFragments{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; };\n"
                       "Physical Volume(\"left\") = Volume In BoundingBox{-101, -101, -1, 1, 101, 51};\n"
                       "Physical Volume(\"front\") = Volume In BoundingBox{-1, -101, -1, 101, 1, 51};\n"
                       "Physical Volume(\"back\") = Volume In BoundingBox{-1, -1, -1, 101, 101, 51};\n"
                       "Physical Surface(\"base\") = Surface In BoundingBox{-101, -101, -1, 101, 101, 1};\n"
                       "Physical Surface(\"top\") = Surface In BoundingBox{-101, -101, 49, 101, 101, 51};\n"
                       "Mesh.MeshSizeMin = 25;\nMesh.MeshSizeMax = 25;\n");
    program_write_text(
        p, "examples/layers/seams.cfg",
        "geometry: { file = \"../../geo/seams.geo\"; missile_file = \"../../geo/hemisphere.geo\"; length_unit = "
        "\"mm\"; missile_parameters = { diameter = 160.0; element_size = 15.0; quarter = 0; }; };\n"
        "pad: { mesh_error_limit = 10.0; };\nmissile: { mass = \"4.6 kg\"; velocity = \"3.5 m/s\"; };\n"
        "solver: { end_time = \"40 ms\"; };\nmaterials: {\n"
        "left: {\n@include \"../materials/eva35_first.cfg\"\n};\n"
        "front: {\n@include \"../materials/eva35_first.cfg\"\n};\n"
        "back: {\n@include \"../materials/eva35_first.cfg\"\n};\n};\n");
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        program_succeed(p, "pre", "examples/layers/seams.cfg -o seams.m.h5 --force %s", words[k]);
        program_succeed(p, "solve", "seams.m.h5 -o seams.h5 --threads 1 --no-checkpoint --force");
        program_figures(p, "seams.h5 -o seams --force");
        program_bytes summary = program_read_file(program_path(p, "seams/summary.json"));
        assert_true(figure_of(summary.data, "contact_energy_fraction", 0) > -1e-4);
        assert_close(figure_of(summary.data, "energy_error", 0), 0, 1e-4);
        assert_close(figure_of(summary.data, "max_penetration_mm", 0), 0, 0.02);
        free(summary.data);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(summary_tells_strain_and_energy_by_layer),
        cmocka_unit_test(layers_read_like_the_one_material),
        cmocka_unit_test(layers_that_cannot_be_meant_are_refused),
        cmocka_unit_test(layers_that_do_not_share_faces_are_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(interfaces_come_before_the_older_keys),
        cmocka_unit_test(threads_and_restarts_leave_every_bit),
        cmocka_unit_test(contact_on_seams_gives_no_energy),
        cmocka_unit_test(large_slips_are_noted),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
