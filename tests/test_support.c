/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rigid supports and symmetry planes as partners of the pad, by whole programs: a slab below a pad against
 * the plane of the anvil, a post in a tube against glue, a hole, a slot that closes onto its mirror image;
 * momentum, energy, the same bits for any number of threads and after a restart; wrong supports. */
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
#include "post_check.h"

typedef struct figures {
    double a_max, force, base, energy, momentum, angular, penetration;
} figures;

static figures run(const program_place *p, const char *overrides) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force --set pad.mesh_error_limit=10 %s", overrides);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
    figures f = {.a_max = program_file_number(p, "out/summary.json", "a_max_g"),
                 .force = program_history_largest(p, "contact_force_N"),
                 .base = program_file_number(p, "out/summary.json", "base_force_N"),
                 .energy = program_history_largest(p, "energy_error_1"),
                 .momentum = program_history_largest(p, "momentum_error_space_1"),
                 .angular = program_history_largest(p, "angular_momentum_error_1"),
                 .penetration = program_history_largest(p, "penetration_mm")};
    print_message(
        "a_max %.3f g, force %.2f N, base %.2f N; errors of energy %.1e, momentum %.1e, angular %.1e; "
        "penetration %.2g mm: %.60s\n",
        f.a_max, f.force, f.base, f.energy, f.momentum, f.angular, f.penetration, overrides);
    assert_true(f.energy < 1e-3 && f.momentum < 1e-12 && f.angular < 1e-12);
    return f;
}

/* The example, with the geometries beside it. */
static void use_example(const program_place *p, const char *name) {
    program_shell(p,
                  "cp \"$SF_SOURCE_DIR\"/geo/*.geo geo/ && sed 's#\\.\\./\\.\\./geo#geo#; "
                  "s#\\.\\./materials#materials#' \"$SF_SOURCE_DIR/examples/%s/case.cfg\" > case.cfg",
                  name);
}

#define SUPPORT(file) "--set pad.fixed=[] --set support.file='\"geo/" file ".geo\"' "
#define COARSE_PAD                                                                                           \
    "--set geometry.parameters.fine_spacing=12.5 --set geometry.parameters.outer_spacing=25.0 "              \
    "--set solver.end_time='\"15 ms\"' " /* the peak is at 12 ms, over a hole at 14 ms */

#define FINER_PAD "--set geometry.parameters.fine_spacing=10.0 --set geometry.parameters.outer_spacing=20.0 "

static void a_flat_slab_acts_as_the_anvil(void **state) {
    const program_place *p = *state;
    use_example(p, "eva50-v4.5");
    figures smooth = run(p, COARSE_PAD "--set pad.base='\"smooth\"'"),
            slab = run(p, COARSE_PAD SUPPORT("slab") "--set support.friction=0.0"),
            resting = run(p, COARSE_PAD "--set pad.base='\"resting\"'"),
            rough = run(p, COARSE_PAD SUPPORT("slab"));
    assert_relative(slab.a_max, smooth.a_max, 0.001);
    assert_relative(slab.base, smooth.base, 0.01);
    assert_relative(rough.a_max, resting.a_max, 0.001);
    assert_relative(rough.base, resting.base, 0.01);
    assert_true(slab.penetration < 0.001 * 10 && rough.penetration < 0.001 * 10);
    /* Its triangles may be of any size. */
    figures large = run(p, COARSE_PAD SUPPORT("slab") "--set support.parameters='{ element_size = 90.0; }'");
    assert_relative(large.a_max, rough.a_max, 1e-6);
    /* A hole under the missile makes it softer; the foam hangs in it and does not pass through its rim. */
    figures hole = run(p, COARSE_PAD SUPPORT("slab") "--set support.parameters='{ hole = 100.0; }'");
    assert_true(hole.a_max < 0.8 * rough.a_max && hole.penetration < 0.01 * 9);
}

/* Two strips and the rest of the plane below a pad: each transmits its part, and all act as one slab does. */
static const char STRIP[] =
    "SetFactory(\"OpenCASCADE\");\nDefineConstant[ from = 0, to = 300 ];\n"
    "Box(1) = {from,-300,-5,to-from,600,5}; Delete{ Volume{:}; }\n"
    "Physical Surface(\"support\") = Surface{:}; Mesh.MeshSizeMin = 30; Mesh.MeshSizeMax = 30;\n";

static void several_supports_share_the_load(void **state) {
    const program_place *p = *state;
    use_example(p, "eva50-v4.5");
    program_write_text(p, "geo/strip.geo", STRIP);
    figures slab = run(p, COARSE_PAD SUPPORT("slab") "--set support.friction=0.0"),
            plane = run(p, COARSE_PAD "--set pad.fixed=[] --set support.plane='[0.0, 0.0, 2.0]' --set "
                                      "support.friction=0.0");
    assert_relative(plane.a_max, slab.a_max, 1e-4);
    assert_relative(program_history_largest(p, "support_force_1_N"), plane.base, 1e-4);
    program_write_text(
        p, "strips.cfg",
        "@include \"case.cfg\"\nsupports = ( { file = \"geo/strip.geo\"; parameters = { from = -45; to = 45; }; "
        "friction = 0.0; }, { file = \"geo/strip.geo\"; parameters = { from = 45; }; friction = 0.0; } );\n");
    program_shell(p, "mv case.cfg one.cfg && sed 's#case.cfg#one.cfg#' strips.cfg > case.cfg");
    figures both = run(p, COARSE_PAD "--set pad.fixed=[]");
    program_succeed(p, "post", "r.h5 -o out --force"); /* with its pages */
    static const char *const shown[] = {"out/view.html",      "\"support\":",        "out/pad.xdmf",
                                        ":/support/position", "out/pad_paraview.py", "\"support\": True"};
    for (int k = 0; k < 6; k += 2)
        assert_int_equal(program_shell(p, "grep -qF -- '%s' %s", shown[k + 1], shown[k]).code, 0);
    double inner = program_history_largest(p, "support_force_1_N"),
           outer = program_history_largest(p, "support_force_2_N");
    print_message("forces %.1f and %.1f N of %.1f N\n", inner, outer, both.base);
    assert_relative(both.a_max, slab.a_max, 0.01);
    assert_true(inner > 0.2 * both.base && outer > 0.02 * both.base &&
                inner + outer >= both.base * (1 - 1e-9));
    assert_true(inner < both.base && program_history_largest(p, "support_force_3_N") == 0);
}

/* The bits do not depend on the threads, nor on where a run is resumed. */
static void the_bits_are_the_same(void **state) {
    const program_place *p = *state;
    use_example(p, "eva50-v4.5");
    program_succeed(
        p, "pre", "case.cfg -o m.h5 --force --set pad.mesh_error_limit=10 %s",
        COARSE_PAD SUPPORT(
            "slab") "--set support.parameters='{ hole = 60.0; }' --set solver.end_time='\"9 ms\"'");
    program_succeed(p, "solve", "m.h5 -o one.h5 --force -t 1");
    program_succeed(p, "solve", "m.h5 -o two.h5 --force -t 2");
    program_succeed(p, "solve", "m.h5 -o three.h5 --force -t 2 --end-time '6 ms'");
    program_succeed(p, "solve", "m.h5 --restart three.h5 -t 1 --end-time '9 ms'");
    for (int k = 0; k < 3; k++) {
        static const char *const name[] = {"one", "two", "three"};
        program_figures(p, "%s.h5 -o %s --force", name[k], name[k]);
    }
    assert_int_equal(program_shell(p, "cmp one/history.csv two/history.csv").code, 0);
    assert_int_equal(program_shell(p, "cmp one/history.csv three/history.csv").code, 0);
}

/* A case with a support goes to a folder of its own, whose bits are the same. */
static void a_support_moves_with_its_case(void **state) {
    const program_place *p = *state;
    use_example(p, "post");
    program_shell(
        p, "sed -i 's#^material:#supports = ( { file = \"geo/round_post.geo\"; parameters = { element_size = "
           "13.0; }; }, { plane = [0.0, 0.0, 1.0]; place = \"-98 mm\"; } );\\n"
           "pad: { fixed = []; mesh_error_limit = 10.0; };\\nmaterial:#; s#spacing = 5.0#spacing = 13.0#' "
           "case.cfg");
    program_succeed(p, "new", "own --from case.cfg");
    program_succeed(p, "pre", "case.cfg -o m.h5 --force --set solver.end_time='2 ms'");
    program_succeed(p, "pre", "own/case.cfg -o own.h5 --force --set solver.end_time='2 ms'");
    program_shell(p, "for n in m own; do \"$SF_BIN_DIR/softfall-solve\" $n.h5 -o r$n.h5 --force -t 1; "
                     "\"$SF_BIN_DIR/softfall-post\" r$n.h5 -o $n --force; done");
    assert_int_equal(
        program_shell(p, "cmp m/history.csv own/history.csv && test -f own/geo/round_post.geo").code, 0);
}

/* The foam under the missile is the near wall of the tube, with and without glue. */
static void a_post_in_a_tube_acts_as_glue_does(void **state) {
    const program_place *p = *state;
    static const char coarse[] = "--set geometry.parameters='{ spacing = 13.0; length = 160.0; }' ";
    char words[512];
    use_example(p, "post");
    figures glued = run(p, coarse);
    double thickness = program_file_number(p, "out/summary.json", "thickness_mm");
    snprintf(words, sizeof words, "%s%s%s", coarse, SUPPORT("round_post"),
             "--set support.friction=1.0 --set support.parameters='{ element_size = 10.0; }'");
    figures post = run(p, words);
    assert_relative(program_file_number(p, "out/summary.json", "thickness_mm"), thickness, 0.01);
    assert_relative(post.a_max, glued.a_max, 0.02);
}

/* Half of a bridge of foam, or the whole: a slot in its upper face, tip at z = 10 mm, closes as it bends. */
static const char BRIDGE[] =
    "DefineConstant[ whole = 0, slot = 0.6 ];\n"
    "Point(1) = {0,0,0}; Point(2) = {0,0,10}; Line(1) = {1,2}; Transfinite Curve {1} = 3;\n"
    "x[] = {10,50,60}; n[] = {2,8,2};\n"
    "For k In {0:whole}\n"
    "  s = 1 - 2*k; p = 100*(k+1);\n"
    "  Point(p) = {s*slot/2,0,30};\n"
    "  For i In {0:2}\n"
    "    Point(p+10*i+1) = {s*x[i],0,0}; Point(p+10*i+2) = {s*x[i],0,10}; Point(p+10*i+3) = {s*x[i],0,30};\n"
    "    a = (i == 0) ? 1 : p+10*i-9; b = (i == 0) ? 2 : p+10*i-8; c = (i == 0) ? p : p+10*i-7;\n"
    "    Line(p+10*i+1) = {p+10*i+1,p+10*i+2}; Line(p+10*i+2) = {p+10*i+2,p+10*i+3};\n"
    "    Line(p+10*i+3) = {a,p+10*i+1}; Line(p+10*i+4) = {b,p+10*i+2}; Line(p+10*i+5) = {c,p+10*i+3};\n"
    "    If (i == 0)\n      Line(p) = {2,p}; l = 1; u = p;\n    Else\n      l = p+10*i-9; u = p+10*i-8;\n    EndIf\n"
    "    Curve Loop(p+10*i+1) = {p+10*i+3,p+10*i+1,-(p+10*i+4),-l}; Plane Surface(p+10*i+1) = {p+10*i+1};\n"
    "    Curve Loop(p+10*i+2) = {p+10*i+4,p+10*i+2,-(p+10*i+5),-u}; Plane Surface(p+10*i+2) = {p+10*i+2};\n"
    "    Transfinite Curve {p+10*i+3,p+10*i+4,p+10*i+5} = n[i]+1;\n"
    "    Transfinite Curve {l,p+10*i+1} = 3; Transfinite Curve {u,p+10*i+2} = 5;\n"
    "  EndFor\n"
    "  Point(p+50) = {s*50,0,-15}; Point(p+51) = {s*60,0,-15};\n"
    "  Line(p+50) = {p+50,p+51}; Line(p+51) = {p+51,p+21}; Line(p+52) = {p+50,p+11};\n"
    "  Curve Loop(p+50) = {p+50,p+51,-(p+23),-(p+52)}; Plane Surface(p+50) = {p+50};\n"
    "  Transfinite Curve {p+50} = 3; Transfinite Curve {p+51,p+52} = 4;\n"
    "EndFor\n"
    "Transfinite Surface {:}; Recombine Surface {:};\n"
    "Extrude {0,20,0} { Surface{:}; Layers{4}; Recombine; }\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-61,-1,-15.01,61,21,-14.99};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-61,-1,29.99,61,21,30.01};\n"
    "Physical Surface(\"front\") = Surface In BoundingBox{-61,-0.01,-16,61,0.01,31};\n"
    "Physical Surface(\"back\") = Surface In BoundingBox{-61,19.99,-16,61,20.01,31};\n"
    "If (whole == 0)\n  Physical Surface(\"symmetry_x\") = Surface In BoundingBox{-0.01,-1,-1,0.01,21,10.01};\nEndIf\n";

static void a_slot_closes_onto_its_mirror_image(void **state) {
    const program_place *p = *state;
    program_write_text(p, "bridge.geo", BRIDGE);
    program_write_text(
        p, "case.cfg",
        "geometry: { file = \"bridge.geo\"; missile_file = \"geo/platen.geo\"; length_unit = \"mm\";\n"
        "  parameters = { whole = 0; }; missile_parameters = { side = 24.0; }; };\n"
        "pad: { sliding = [\"front\", \"back\"]; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "missile: { motion = \"motion.csv\"; shape = \"surface\"; position = [\"0 mm\", \"10 mm\"]; };\n"
        "solver: { end_time = \"8 ms\"; };\noutput: { frame_interval = \"8 ms\"; };\n");
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n8,8\n");
    program_shell(p, "cp \"$SF_SOURCE_DIR\"/geo/platen.geo geo/");
    figures whole = run(p, "--set geometry.parameters.whole=1"), half = run(p, ""),
            open = run(p, "--set pad.self_contact='\"off\"' --set kernel.stabilisation=0.3");
    assert_relative(half.base, whole.base, 0.005);
    assert_true(open.base < 0.5 * whole.base);
}

/* A kerb below the middle of a pad; its edges lie between two rows of the pad's nodes. */
static const char KERB[] =
    "SetFactory(\"OpenCASCADE\");\nDefineConstant[ size = 30 ];\nBox(1) = {-17.5,-300,-60,35,600,60};\n"
    "Delete{ Volume{:}; } Physical Surface(\"support\") = Surface{:};\n"
    "Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;\n";

/* A post below it; with a size of 30 mm it is a prism of few sides, whose upper edges cross the symmetry
 * planes. */
static const char POST[] =
    "SetFactory(\"OpenCASCADE\");\nDefineConstant[ size = 30 ];\nCylinder(1) = {0,0,-60, 0,0,60, 30};\n"
    "Delete{ Volume{:}; } Physical Surface(\"support\") = Surface{:};\n"
    "Mesh.MeshSizeMin = size; Mesh.MeshSizeMax = size;\n";

/* Edges of a support press the faces of the pad between the nodes of both, however far apart its own are. */
static void edges_press_the_faces_between_nodes(const program_place *p, const char *body) {
    double a_max[2];
    use_example(p, "eva50-v4.5");
    program_write_text(p, "geo/kerb.geo", KERB);
    program_write_text(p, "geo/pole.geo", POST);
    for (int k = 0; k < 2; k++) {
        program_succeed(
            p, "pre",
            "case.cfg -o m.h5 --force --set pad.mesh_error_limit=10 --set missile.velocity='\"3 m/s\"' "
            "--set geometry.parameters.side=200.0 --set geometry.parameters.zone_side=140.0 "
            "--set solver.end_time='\"24 ms\"' " FINER_PAD
            "--set pad.fixed=[] --set support.file='\"geo/%s.geo\"' --set support.parameters='{ size = %d; }'",
            body, k ? 5 : 30);
        program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
        program_figures(p, "r.h5 -o out --force");
        a_max[k] = program_file_number(p, "out/summary.json", "a_max_g");
        double depth = program_file_number(p, "out/summary.json", "rim_depth_mm"),
               deep = program_history_largest(p, "penetration_mm");
        print_message("%s: a_max %.2f g, edges %.4f mm in the faces at the peak, %.4f mm at most\n", body,
                      a_max[k], depth, deep);
        assert_true(depth < 0.01 * 9 && deep < 0.01 * 9);
        assert_true(program_history_largest(p, "energy_error_1") < 2e-3 &&
                    program_history_largest(p, "momentum_error_space_1") < 1e-12 &&
                    program_history_largest(p, "angular_momentum_error_1") < 1e-12);
    }
    assert_relative(a_max[0], a_max[1], 0.02);
}

static void edges_of_a_post_press_the_faces_between_nodes(void **state) {
    edges_press_the_faces_between_nodes(*state, "pole");
}

static void edges_of_a_kerb_press_the_faces_between_nodes(void **state) {
    edges_press_the_faces_between_nodes(*state, "kerb");
}

static void refuse(const program_place *p, const char *words, const char *sentence) {
    program_result r = program_run(p, "pre", "case.cfg -o bad.h5 --force --set pad.mesh_error_limit=10 %s%s",
                                   FINER_PAD "--set geometry.parameters.side=250.0 ", words);
    if (r.code != 2 || !strstr(r.err, sentence))
        fail_msg("%s: exit code %d, %s", words, r.code, r.err);
}

static void wrong_supports_are_refused(void **state) {
    const program_place *p = *state;
    use_example(p, "eva50-v4.5");
    program_write_text(p, "geo/empty.geo", "Point(1) = {0,0,0};\n");
    program_write_text(
        p, "geo/shift.geo",
        "SetFactory(\"OpenCASCADE\");\nDefineConstant[ z = -5, w = 600, x = 0, y = 0 ];\n"
        "Box(1) = {x-w/2,y-w/2,z,w,w,5}; Delete{ Volume{:}; } Physical Surface(\"support\") = Surface{:};\n"
        "Mesh.MeshSizeMin = Max(w/10, 3); Mesh.MeshSizeMax = Max(w/10, 3);\n");
    static const struct {
        const char *words, *sentence;
    } bad[] = {
        {SUPPORT("slab") "--set support.friction=-0.1", "support.friction"},
        {SUPPORT("slab") "--set support.plane='[0.0, 0.0, 1.0]'", "either the surface of a file"},
        {SUPPORT("slab") "--set support.place='\"1 mm\"'", "support.place has no meaning"},
        {"--set support.plane='[0.0, 0.0, 0.0]'", "either the surface of a file"},
        {"--set support.plane='[0.0, 0.0, 1.0]' --set support.group='\"a\"'", "support.group has no meaning"},
        {"--set pad.fixed=[] --set support.plane='[0.0, 0.0, 1.0]' --set support.place='\"3 mm\"'",
         "3 mm inside the support"},
        {"--set pad.fixed=[] --set support.plane='[1.0, 0.0, 0.0]' --set support.place='\"-250 mm\"'",
         "before it within the pad's thickness"},
        {SUPPORT("slab") "--set supports.a.plane='[0.0, 0.0, 1.0]'", "in place of a group support"},
        {"--set pad.fixed=[] --set supports.a.plane='[0.0, 0.0, 1.0]' --set supports.b.plane='[0.0, 0.0, 1.0]' "
         "--set supports.b.place='\"2 mm\"'",
         "support 2: pad and support overlap"},
        {"--set supports.a.plane='[0.0, 0.0, 1.0]' --set supports.a.frction=0.1",
         "did you mean \"friction\""},
        {SUPPORT("slab") "--set support.group='\"nothing\"'", "nothing"},
        {SUPPORT("empty"), "it holds no mesh"},
        {SUPPORT("none"), "cannot be read"},
        {"--set support.friction=0.1", "either the surface of a file"},
        {"--set support.parameters='{ side = 100.0; }'", "either the surface of a file"},
        {SUPPORT("shift") "--set support.parameters='{ z = -3.0; }'", "2 mm inside the support"},
        {SUPPORT("shift") "--set support.parameters='{ z = 1.0; w = 6.0; x = 15.0; y = 15.0; }'",
         "inside the pad"},
        {SUPPORT("shift") "--set support.parameters='{ z = -80.0; }'",
         "before it within the pad's thickness"},
        {SUPPORT("shift") "--set support.parameters='{ z = 60.0; }'", "the missile meets the support"},
        {SUPPORT("shift") "--set support.parameters='{ x = 2000.0; }'",
         "before it within the pad's thickness"},
        {SUPPORT("slab") "--set support.parameters='{ side = 100.0; element_size = 1.9; }'",
         "mesh the support coarser"}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        refuse(p, bad[k].words, bad[k].sentence);
}

/* A wall beside a low pad stops the missile, which is wider. */
static void the_missile_stops_at_a_support(void **state) {
    const program_place *p = *state;
    program_write_text(
        p, "geo/wall.geo",
        "SetFactory(\"OpenCASCADE\");\nBox(1) = {-50,-50,-5,100,100,5}; Box(2) = {60,-50,-5,10,100,41};\n"
        "Delete{ Volume{:}; } Physical Surface(\"support\") = Surface{:};\n"
        "Mesh.MeshSizeMin = 10; Mesh.MeshSizeMax = 10;\n");
    program_write_text(
        p, "case.cfg",
        "geometry: { file = \"geo/cube.geo\"; missile_file = \"geo/platen.geo\"; \n"
        "  length_unit = \"mm\"; parameters = { side = 40.0; spacing = 10.0; }; missile_parameters = { side = 200.0; }; };\n"
        "pad: { fixed = []; mesh_error_limit = 10.0; };\nsupport: { file = \"geo/wall.geo\"; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "missile: { motion = \"motion.csv\"; shape = \"surface\"; };\nsolver: { end_time = \"8 ms\"; };\n");
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n8,8\n");
    program_succeed(p, "pre", "case.cfg -o m.h5 --force");
    program_result r = program_run(p, "solve", "m.h5 -o r.h5 --force -t 1");
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "reached the anvil or the support at t = 4"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slot_closes_onto_its_mirror_image),
        cmocka_unit_test(wrong_supports_are_refused),
        cmocka_unit_test(the_missile_stops_at_a_support),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(edges_of_a_post_press_the_faces_between_nodes),
        cmocka_unit_test(the_bits_are_the_same),
        cmocka_unit_test(a_flat_slab_acts_as_the_anvil),
        cmocka_unit_test(a_support_moves_with_its_case),
        cmocka_unit_test(several_supports_share_the_load),
        cmocka_unit_test(a_post_in_a_tube_acts_as_glue_does),
        cmocka_unit_test(edges_of_a_kerb_press_the_faces_between_nodes),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_case, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_case, program_group_tear_down);
}
