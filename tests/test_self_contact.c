/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of the pad with itself and with the anvil, by whole programs: a block with a cut against the whole
 * block, a tile on feet whose plate comes down to the floor, momentum, energy, the same bits for any number
 * of threads and after a restart; when a pad has such a contact. */
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "check.h"
#include "extreme.h"
#include "post/results/results.h"
#include "post_check.h"

/* A block of 40 mm, cut at half height from x = 0 to 36 mm: a wedge that is `slit` mm wide at x = 0. */
static const char CUT[] =
    "DefineConstant[ slit = 0.1, cells = 6 ];\n"
    "Point(1) = {0,0,0}; Point(2) = {36,0,0}; Point(3) = {40,0,0}; Point(4) = {0,0,20}; Point(5) = {36,0,20};\n"
    "Point(6) = {40,0,20}; Point(7) = {0,0,20 + slit}; Point(8) = {0,0,40}; Point(9) = {36,0,40};\n"
    "Point(10) = {40,0,40};\n"
    "Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {1,4}; Line(4) = {2,5}; Line(5) = {3,6}; Line(6) = {4,5};\n"
    "Line(7) = {5,6}; Line(9) = {5,9}; Line(10) = {6,10}; Line(11) = {8,9}; Line(12) = {9,10};\n"
    "If (slit > 0)\nLine(8) = {7,8}; Line(13) = {7,5}; u = 13;\nElse\nLine(8) = {4,8}; u = 6;\nEndIf\n"
    "Curve Loop(1) = {1,4,-6,-3}; Curve Loop(2) = {2,5,-7,-4}; Curve Loop(3) = {u,9,-11,-8};\n"
    "Curve Loop(4) = {7,10,-12,-9};\n"
    "Plane Surface(1) = {1}; Plane Surface(2) = {2}; Plane Surface(3) = {3}; Plane Surface(4) = {4};\n"
    "Transfinite Curve {1,6,11} = cells + 1;\nIf (slit > 0)\nTransfinite Curve {13} = cells + 1;\nEndIf\n"
    "Transfinite Curve {2,7,12} = 2; Transfinite Curve {3,4,5,8,9,10} = cells/2 + 1;\n"
    "Transfinite Surface {:}; Recombine Surface {:};\n"
    "Extrude {0,40,0} { Surface{1:4}; Layers{cells}; Recombine; }\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-1,-1,-0.01,41,41,0.01};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-1,-1,39.99,41,41,40.01};\n"
    "l() = Surface In BoundingBox{-0.01,-1,-1,0.01,41,41}; r() = Surface In BoundingBox{39.99,-1,-1,40.01,41,41};\n"
    "f() = Surface In BoundingBox{-1,-0.01,-1,41,0.01,41}; b() = Surface In BoundingBox{-1,39.99,-1,41,40.01,41};\n"
    "Physical Surface(\"left\") = l(); Physical Surface(\"right\") = r(); Physical Surface(\"front\") = f();\n"
    "Physical Surface(\"back\") = b();\n";

static const char CUT_CASE[] =
    "geometry: { file = \"cut.geo\"; missile_file = \"geo/platen.geo\"; length_unit = \"mm\";\n"
    "  parameters = { slit = 0.1; cells = 4; }; missile_parameters = { side = 200.0; }; };\n"
    "pad: { mesh_error_limit = 1.0; sliding = [\"left\", \"right\", \"front\", \"back\"]; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { motion = \"motion.csv\"; friction = 0.5; shape = \"surface\"; };\n"
    "solver: { end_time = \"24 ms\"; };\n"
    "output: { frame_interval = \"24 ms\"; };\n";

typedef struct figures {
    double force, energy_error, contact, penetration, momentum, angular;
} figures;

static figures run(const program_place *p, const char *overrides) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", overrides);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
    return (figures){.force = program_history_largest(p, "contact_force_N"),
                     .energy_error = program_history_largest(p, "energy_error_1"),
                     .contact = program_history_largest(p, "energy_contact_J"),
                     .penetration = program_history_largest(p, "penetration_mm"),
                     .momentum = program_history_largest(p, "momentum_error_space_1"),
                     .angular = program_history_largest(p, "angular_momentum_error_1")};
}

/* A run without contact ends with what the foam has passed through, and where: its undeformed place, mm. */
static void passes_through(const program_place *p, const char *what, double place[3]) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force --set pad.self_contact='\"off\"'");
    program_result r = program_run(p, "solve", "m.h5 -o r.h5 --force -t 1");
    char *through = strstr(r.err, "has passed through "), *undeformed = strstr(r.err, "(undeformed (");
    assert_int_equal(r.code, 5);
    assert_true(through && undeformed && strncmp(through + 19, what, strlen(what)) == 0);
    assert_int_equal(sscanf(undeformed, "(undeformed (%lf, %lf, %lf)", &place[0], &place[1], &place[2]), 3);
}

/* Writes the case of the block, and the history of the block without a cut as whole.csv, once for all tests.
 */
static figures use_block(const program_place *p) {
    static figures whole;
    program_write_text(p, "cut.geo", CUT);
    program_write_text(p, "case.cfg", CUT_CASE);
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n24,24\n");
    if (whole.force > 0)
        return whole;
    whole = run(p, "--set geometry.parameters.slit=0.0");
    program_shell(p, "mv out/history.csv whole.csv");
    return whole;
}

static void a_cut_block_is_as_stiff_as_the_whole_one(void **state) {
    const program_place *p = *state;
    figures whole = use_block(p), cut = run(p, ""), rough = run(p, "--set pad.self_friction=0.5");
    print_message(
        "at 60 %%: whole %.2f N, cut %.2f N, with friction %.2f N; penetration %.2g mm, energy error "
        "%.1e, momentum %.1e, angular %.1e, with friction %.1e\n",
        whole.force, cut.force, rough.force, cut.penetration, cut.energy_error, cut.momentum, cut.angular,
        rough.angular);
    assert_relative(cut.force, whole.force, 0.005);
    assert_relative(rough.force, whole.force, 0.005);
    assert_true(cut.penetration < 0.01 * 5 && cut.energy_error < 1e-3);
    assert_true(cut.momentum < 1e-12 && cut.angular < 1e-12);
    assert_true(rough.momentum < 1e-12 && rough.angular < 1e-12);
    double place[3];
    passes_through(p, "another face of the foam", place);
    assert_true(place[0] < 36 && fabs(place[2] - 20) < 0.2);
}

/* A sheet folded at x = 36 mm, its limbs 12 mm apart at their ends, is pressed until they lie on each other.
 * Between walls every column of it is then as stiff as the whole block at the column's own strain. */
static void a_folded_sheet_meets_itself(void **state) {
    const program_place *p = *state;
    use_block(p);
    program_write_text(
        p, "folded.py",
        "import csv\n"
        "rows = [(float(r['indentation_mm']) / 40, float(r['contact_force_N'])) for r in csv.DictReader(open('whole.csv'))]\n"
        "def force(e):\n"
        "    k = next((k for k in range(1, len(rows)) if rows[k][0] >= e), len(rows) - 1)\n"
        "    (a, f), (b, g) = rows[k - 1], rows[k]\n"
        "    return f + (g - f) * (e - a) / (b - a)\n"
        "gaps = [max(0, 12 * (1 - x / 36)) for x in (0.05 + 0.1 * k for k in range(400))]\n"
        "print(sum(force(1 - 16 / (40 - gap)) for gap in gaps) / 400)\n");
    figures folded = run(p, "--set geometry.parameters.slit=12.0");
    program_result r = program_shell(p, "python3 folded.py");
    double expected = strtod(r.out, NULL), place[3];
    print_message(
        "folded %.2f N, by columns %.2f N; penetration %.2g mm, energy error %.1e, momentum %.1e, angular %.1e\n",
        folded.force, expected, folded.penetration, folded.energy_error, folded.momentum, folded.angular);
    assert_relative(folded.force, expected, 0.005);
    assert_true(folded.penetration < 0.01 * 5 && folded.energy_error < 1e-3);
    assert_true(folded.momentum < 1e-12 && folded.angular < 1e-12);
    program_shell(p, "sed -i 's/slit = 0.1/slit = 12.0/' case.cfg");
    passes_through(p, "another face of the foam", place);
}

/* Two slabs of a block of 40 mm whose meshes do not match, with a gap of a hundredth of a millimetre: of
 * hexahedra, prisms over rows of triangles, prisms over triangles without order, or tetrahedra. */
enum { HEXAHEDRA, ROWS_OF_PRISMS, PRISMS, TETRAHEDRA };
static const char STACK[] =
    "DefineConstant[ kind = 0, cells = 6, fewer = 2 ];\n"
    "For k In {0:1}\n"
    "  n = cells - fewer*k; p = 100*k; z = 20.01*k; s = p + 1;\n"
    "  Point(p+1) = {0,0,z}; Point(p+2) = {40,0,z}; Point(p+3) = {40,40,z}; Point(p+4) = {0,40,z};\n"
    "  Line(p+1) = {p+1,p+2}; Line(p+2) = {p+2,p+3}; Line(p+3) = {p+3,p+4}; Line(p+4) = {p+4,p+1};\n"
    "  Curve Loop(s) = {p+1:p+4}; Plane Surface(s) = {s};\n"
    "  Transfinite Curve {p+1:p+4} = n + 1;\n"
    "  If (kind < 2)\n Transfinite Surface {s};\n EndIf\n"
    "  If (kind == 0)\n Recombine Surface {s};\n EndIf\n"
    "  If (kind == 3)\n e[] = Extrude {0,0,20} { Surface{s}; Layers{Ceil(n/2)}; };\n"
    "  Else\n e[] = Extrude {0,0,20} { Surface{s}; Layers{Ceil(n/2)}; Recombine; };\n EndIf\n"
    "  v[k] = e[1];\n"
    "EndFor\n"
    "DefineConstant[ far = 0 ];\n"
    "If (far)\n  t[] = Translate {400,0,10} { Duplicata { Volume{v[0]}; } }; v[2] = t[0];\nEndIf\n"
    "Physical Volume(\"pad\") = {v[]};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-1,-1,-0.001,41,41,0.001};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-1,-1,40,41,41,40.02};\n"
    "Physical Surface(\"left\") = Surface In BoundingBox{-0.01,-1,-1,0.01,41,41};\n"
    "Physical Surface(\"right\") = Surface In BoundingBox{39.99,-1,-1,40.01,41,41};\n"
    "Physical Surface(\"front\") = Surface In BoundingBox{-1,-0.01,-1,41,0.01,41};\n"
    "Physical Surface(\"back\") = Surface In BoundingBox{-1,39.99,-1,41,40.01,41};\n";

static void write_stack(const program_place *p) {
    program_write_text(p, "stack.geo", STACK);
    program_write_text(p, "case.cfg", CUT_CASE);
    program_write_text(p, "motion.csv",
                       "time_ms,displacement_mm\n0,0\n2,0.2\n4,0.8\n8,4\n10,4.8\n12,5\n24,5\n");
    program_shell(p, "sed -i 's#cut.geo#stack.geo#; s#slit = 0.1; cells = 4;##' case.cfg");
}

/* A patch test across faces that do not match: the stress is uniform in both bodies, to these parts of it. */
static void assert_uniform(const program_place *p, int kind, const char *more, double at_node, double at_ends,
                           double in_mean) {
    char words[256];
    snprintf(
        words, sizeof words,
        "--set pad.separate=true --set pad.triangle_centroids=%s --set geometry.parameters='{ kind = %d; %s }' %s",
        kind == HEXAHEDRA ? "false" : "true", kind, more,
        kind == HEXAHEDRA ? "--set pad.self_friction=0.3" : "");
    figures f = run(p, words);
    assert_true(f.momentum < 1e-12 && f.angular < 1e-12 && f.energy_error < 1e-3);
    sf_results results;
    sf_frame frame;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_results_open(program_path(p, "r.h5"), &results, &err), SF_OK);
    assert_int_equal(
        sf_frame_read(&results, &results.frames[results.frame_count - 1], SF_FIELD_ALL, &frame, &err), SF_OK);
    double sum[2] = {0}, volume[2] = {0}, near = 0, far = 0;
    for (int64_t i = 0; i < results.node_count; i++) {
        int upper = results.position[3 * i + 2] > 0.020005;
        sum[upper] += results.volume[i] * frame.field[SF_FRAME_CAUCHY_STRESS][9 * i + 8];
        volume[upper] += results.volume[i];
    }
    double mean = sum[0] / volume[0];
    for (int64_t i = 0; i < results.node_count; i++) {
        double z = results.position[3 * i + 2],
               error = fabs(frame.field[SF_FRAME_CAUCHY_STRESS][9 * i + 8] / mean - 1);
        near = larger(near, error);
        far = z < 1e-6 || z > 0.040005 ? fmax(far, error) : far;
    }
    print_message(
        "kind %d: stress %.1f and %.1f Pa, off by %.1e at most, by %.1e at the ends; penetration %.2g mm\n",
        kind, mean, sum[1] / volume[1], near, far, f.penetration);
    assert_true(mean < -1e4 && near < at_node && far < at_ends);
    assert_relative(sum[1] / volume[1], mean, in_mean);
    sf_frame_free(&frame);
    sf_results_close(&results);
}

static void bodies_with_other_meshes_pass_on_the_stress(void **state) {
    const program_place *p = *state;
    write_stack(p);
    program_result r = program_run(p, "pre", "case.cfg -o m.h5 --force");
    assert_true(r.code == 2 && strstr(r.err, "2 parts that share no faces") && strstr(r.err, "pad.separate"));
    r = program_run(p, "pre",
                    "case.cfg -o m.h5 --force --set pad.separate=true --set pad.self_contact='\"off\"'");
    assert_true(r.code == 2 && strstr(r.err, "pad.separate: bodies touch each other by pad.self_contact"));
    r = program_run(p, "pre", "case.cfg -o m.h5 --force --set pad.separate=true");
    assert_true(r.code == 2 && strstr(r.err, "hexahedra of two parts touch") &&
                strstr(r.err, "pad.self_friction = 0.3"));
    program_succeed(p, "pre",
                    "case.cfg -o m.h5 --force --set pad.separate=true --set geometry.parameters.fewer=0");
    program_shell(p, "sed -i 's#pad: {#pad: { self_friction = 0.3;#' case.cfg");
    r = program_succeed(p, "pre", "case.cfg -o m.h5 --force --set pad.separate=true");
    assert_null(strstr(r.err, "out of reach"));
    r = program_succeed(p, "pre",
                        "case.cfg -o m.h5 --force --set pad.separate=true --set pad.triangle_centroids=true");
    assert_non_null(strstr(r.err, "pad.triangle_centroids has no effect"));
    r = program_succeed(
        p, "pre",
        "case.cfg -o m.h5 --force --set pad.separate=true --set geometry.parameters='{ far = 1; }'");
    assert_non_null(strstr(r.err, "1 of 3 bodies are out of reach, the first about (420, 20, 20) mm"));
    assert_uniform(p, HEXAHEDRA, "", 2e-4, 1e-4, 1e-4);
    assert_uniform(p, ROWS_OF_PRISMS, "", 1e-3, 1e-4, 1e-4);
}

/* Triangles without order need the centroids in balance with the nodes, and many sweeps. */
static void bodies_of_triangles_pass_on_the_stress(void **state) {
    const program_place *p = *state;
    write_stack(p);
    assert_uniform(p, PRISMS, "cells = 5; fewer = 1;", 2e-3, 5e-4, 1e-4);
    assert_uniform(p, TETRAHEDRA, "cells = 5; fewer = 1;", 2e-3, 5e-4, 1e-4);
}

/* The example in a softer foam, on higher feet. */
static void use_tile(const program_place *p) {
    program_shell(
        p,
        "cp \"$SF_SOURCE_DIR/geo/tile_feet.geo\" geo/ && sed 's#\\.\\./\\.\\./geo#geo#; "
        "s#\\.\\./layers/hard_foam#materials/eva35#; s#foot_height = 15.0; plate = 30.0#foot_height = "
        "20.0; plate = 25.0#; s#spacing = 4.0#spacing = 10.0#; s#^missile:#pad: { mesh_error_limit = 1.0; };\\n&#' "
        "\"$SF_SOURCE_DIR/examples/tile-feet/case.cfg\" > case.cfg");
}

static void a_tile_on_feet_comes_down_to_the_floor(void **state) {
    const program_place *p = *state;
    use_tile(p);
    figures held = run(p, "");
    double below = program_file_number(p, "out/summary.json", "below_anvil_mm"),
           strain = program_file_number(p, "out/summary.json", "max_mean_strain"),
           a_max = program_history_largest(p, "acceleration_cfc1000_g");
    program_shell(p, "cp r.h5 first.h5");
    double place[3];
    passes_through(p, "the anvil", place);
    print_message("a_max %.2f g, %.3g mm below the floor; mean strain %.3f\n", a_max, below, strain);
    assert_true(below < 0.05 && fabs(place[2] - 20) < 0.1); /* the plate's lower face */
    assert_true(strain > 0.5 && strain < 0.9);
    assert_true(held.energy_error < 1e-3 && held.penetration < 0.01 * 6.7);
    assert_true(held.momentum < 1e-12 && held.angular < 1e-12);
}

/* Bits of the histories: of two threads, and of a run that was resumed within the contact. */
static void the_bits_do_not_depend_on_threads_or_restarts(void **state) {
    const program_place *p = *state;
    use_tile(p);
    const char *coarse = "--set solver.end_time='\"18 ms\"'";
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", coarse);
    program_succeed(p, "solve", "m.h5 -o one.h5 --force -t 1");
    program_succeed(p, "solve", "m.h5 -o two.h5 --force -t 2");
    program_succeed(p, "solve", "m.h5 -o three.h5 --force -t 2 --end-time '14 ms'");
    program_succeed(p, "solve", "m.h5 --restart three.h5 -t 1 --end-time '18 ms'");
    for (int k = 0; k < 3; k++) {
        static const char *const name[] = {"one", "two", "three"};
        program_figures(p, "%s.h5 -o %s --force", name[k], name[k]);
    }
    assert_int_equal(program_shell(p, "cmp one/history.csv two/history.csv").code, 0);
    assert_int_equal(program_shell(p, "cmp one/history.csv three/history.csv").code, 0);
    assert_true(program_shell(p, "test $(wc -l < one/history.csv) -gt 200").code == 0);
}

/* A cover that lies loose on a soft foam: pressed, it acts as a glued one; a cover that slides along the
 * undeformed interface does not. */
static void a_loose_cover_acts_as_a_glued_one_while_it_is_pressed(void **state) {
    const program_place *p = *state;
    program_shell(
        p, "cp \"$SF_SOURCE_DIR\"/examples/layers/*.c* . && cp \"$SF_SOURCE_DIR/geo/layers.geo\" geo/ && "
           "sed -i 's#\\.\\./\\.\\./geo#geo#; s#\\.\\./materials#materials#' case.cfg");
    const char *coarse =
        "--set geometry.parameters.fine_spacing=15.0 --set geometry.parameters.outer_spacing=20.0 --set "
        "pad.mesh_error_limit=1 --set solver.end_time='\"16 ms\"' ";
    char words[512];
    figures glued = run(p, coarse);
    double tied = program_file_number(p, "out/summary.json", "a_max_g");
    snprintf(words, sizeof words,
             "%s --set interfaces.a.between='[\"upper\",\"cover\"]' --set interfaces.a.kind=loose "
             "--set interfaces.a.friction=0.0",
             coarse);
    figures loose = run(p, words);
    double open = program_file_number(p, "out/summary.json", "a_max_g");
    print_message("a_max %.2f g glued, %.2f g loose; momentum %.1e, angular %.1e, penetration %.2g mm\n",
                  tied, open, loose.momentum, loose.angular, loose.penetration);
    assert_relative(open, tied, 0.005);
    assert_true(glued.energy_error < 1e-3 && loose.energy_error < 1e-3);
    assert_true(loose.momentum < 1e-12 && loose.angular < 1e-9);
    static const struct {
        const char *words, *sentence;
    } bad[] = {
        {"--set pad.loose_interfaces='[\"upper/nothing\"]'", "does not name two layers"},
        {"--set pad.loose_interfaces='[\"upper/cover\"]' --set pad.sliding_interfaces='[\"cover/upper\"]'",
         "are the same interface"},
        {"--set pad.loose_interfaces='[\"lower/cover\"]'", "do not touch"},
        {"--set pad.loose_interfaces='[\"upper/cover\"]' --set pad.self_contact='\"off\"'",
         "need pad.self_contact"}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        program_result r = program_run(p, "pre", "case.cfg -o bad.h5 %s %s", coarse, bad[k].words);
        if (r.code == 0 || !strstr(r.err, bad[k].sentence))
            fail_msg("%s: %s", bad[k].words, r.err);
    }
}

static bool touches(const program_place *p, const char *words) {
    program_result r = program_succeed(p, "pre", "%s", words);
    return strstr(r.out, "may touch each other") != NULL;
}

static void only_pads_that_can_touch_themselves_have_the_contact(void **state) {
    const program_place *p = *state;
    use_tile(p);
    const char *examples = "'%s/examples/%s/case.cfg' -o m.h5 --force --set pad.mesh_error_limit=1 %s";
    static const struct {
        const char *name, *overrides;
        bool touches;
    } cases[] = {
        {"eva50-v4.5", "--set geometry.parameters.fine_spacing=20.0", false},
        {"eva50-v4.5", "--set geometry.parameters.fine_spacing=20.0 --set pad.self_contact='\"on\"'", true},
        {"layers", "--set geometry.parameters.fine_spacing=10.0 --set geometry.parameters.outer_spacing=20.0",
         false},
        {"cored", "--set geometry.parameters.spacing=10.0", true},
        {"tile-feet", "--set geometry.parameters.spacing=10.0", true},
        {"tile-feet", "--set geometry.parameters.spacing=10.0 --set pad.self_contact='\"off\"'", false}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char words[1024];
        snprintf(words, sizeof words, examples, getenv("SF_SOURCE_DIR"), cases[k].name, cases[k].overrides);
        if (touches(p, words) != cases[k].touches)
            fail_msg("%s %s", cases[k].name, cases[k].overrides);
    }
    program_result r = program_succeed(p, "pre", "case.cfg -o m.h5 --force --set pad.self_contact='\"off\"'");
    assert_non_null(strstr(r.err, "it passes through where they meet"));
    r = program_run(p, "pre", "case.cfg -o m.h5 --force --set pad.self_friction=-1.0");
    assert_int_equal(r.code, 2);
    assert_non_null(strstr(r.err, "pad.self_friction"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tile_on_feet_comes_down_to_the_floor),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_folded_sheet_meets_itself),
        cmocka_unit_test(a_cut_block_is_as_stiff_as_the_whole_one),
        cmocka_unit_test(bodies_with_other_meshes_pass_on_the_stress),
        cmocka_unit_test(the_bits_do_not_depend_on_threads_or_restarts),
        cmocka_unit_test(a_loose_cover_acts_as_a_glued_one_while_it_is_pressed),
        cmocka_unit_test(only_pads_that_can_touch_themselves_have_the_contact),
        cmocka_unit_test(bodies_of_triangles_pass_on_the_stress),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_case, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_case, program_group_tear_down);
}
