/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile meets every free face of the pad, whether pad.contact names it or not: a pad whose group is a
 * part of its top against one whose group is the whole top, and a blow near an edge, where the side folds up
 * into the missile; the rim of a disc; and two edges that cross carry each other. By whole programs. */
#include "check.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "extreme.h"
#include "post/results/results.h"
#include "post_check.h"

/* A block of 120 x 120 x 50 mm of cells of 12 mm, of two halves; the group "top" is the top of the left half,
 * or of both with `whole`. */
static const char BLOCK[] =
    "DefineConstant[ whole = 0 ];\n"
    "For k In {0:2}\n  Point(k+1) = {60*k-60,-60,0};\nEndFor\n"
    "Line(1) = {1,2}; Line(2) = {2,3}; Transfinite Curve {1,2} = 6;\n"
    "Extrude {0,120,0} { Line{1,2}; Layers{10}; Recombine; }\n"
    "Extrude {0,0,50} { Surface{:}; Layers{4}; Recombine; }\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-61,-61,-0.1,61,61,0.1};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-61,-61,49.9,60*whole+1,61,50.1};\n";

static const char CASE[] =
    "geometry: { file = \"block.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
    "  missile_parameters = { diameter = 160.0; element_size = 10.0; quarter = 0; }; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { mass = \"4.6 kg\"; velocity = \"3 m/s\"; };\n"
    "pad: { mesh_error_limit = 10.0; };\n"
    "solver: { end_time = \"26 ms\"; };\n"
    "output: { frame_interval = \"2 ms\"; };\n";

/* Largest magnitude of a column of the history, up to a displacement of `most` mm. */
static double largest(const program_place *p, const char *column, double most) {
    program_result r = program_shell(
        p,
        "awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) { if ($k == \"%s\") c = k; if ($k == \"displacement_mm\") d = k } "
        "next } $d < %g { v = $c < 0 ? -$c : $c; if (v > m) m = v } END { print m + 0 }' out/history.csv",
        column, most);
    assert_int_equal(r.code, 0);
    return strtod(r.out, NULL);
}

/* Depth (m) of the pad's deepest node inside the missile, which is a sphere, over all frames. */
static double deepest_inside(const program_place *p) {
    sf_results r;
    sf_frame frame;
    sf_error err = SF_ERROR_INIT;
    double deepest = 0;
    assert_int_equal(sf_results_open(program_path(p, "r.h5"), &r, &err), SF_OK);
    assert_true(r.frame_count > 10 && r.sphere_radius > 0);
    for (int64_t k = 0; k < r.frame_count; k++) {
        assert_int_equal(sf_frame_read(&r, &r.frames[k], SF_FIELD_ALL, &frame, &err), SF_OK);
        for (int64_t i = 0; i < r.node_count; i++) {
            double arm[3];
            for (int c = 0; c < 3; c++)
                arm[c] = r.position[3 * i + c] + frame.field[SF_FRAME_DISPLACEMENT][3 * i + c] -
                         r.sphere_centre[c] - r.frames[k].missile_displacement[c];
            deepest = larger(deepest, r.sphere_radius - sqrt(sf_dot3(arm, arm)));
        }
        sf_frame_free(&frame);
    }
    sf_results_close(&r);
    return deepest;
}

/* a_max (g) of a drop; the missile has no node of the pad inside. */
static double drop(const program_place *p, const char *overrides) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", overrides);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
    double a_max = program_file_number(p, "out/summary.json", "a_max_g"), inside = deepest_inside(p);
    print_message("a_max %.3f g, foam %.2g mm inside the missile: %s\n", a_max, 1e3 * inside, overrides);
    assert_true(inside < 0.01 * 12e-3);
    return a_max;
}

static void the_missile_touches_faces_that_are_not_named(void **state) {
    const program_place *p = *state;
    program_write_text(p, "block.geo", BLOCK);
    program_write_text(p, "case.cfg", CASE);
    double part = drop(p, "--set geometry.parameters.whole=0"), area = largest(p, "contact_area_mm2", 1e9),
           error = program_file_number(p, "out/summary.json", "a_max_mesh_error"),
           whole = drop(p, "--set geometry.parameters.whole=1");
    assert_relative(part, whole, 1e-12);
    assert_relative(area, largest(p, "contact_area_mm2", 1e9), 0.05); /* triangles halve some squares */
    assert_relative(error, program_file_number(p, "out/summary.json", "a_max_mesh_error"), 0.03);
    drop(p, "--set geometry.parameters.whole=1 --set missile.position='[\"58 mm\",\"0 mm\"]'");
}

/* The rim of a disc, which the mesh does not resolve, presses the faces between the nodes. */
static void a_rim_of_the_missile_presses_the_faces_between_nodes(void **state) {
    const program_place *p = *state;
    program_write_text(p, "block.geo", BLOCK);
    program_write_text(p, "case.cfg", CASE);
    program_shell(
        p, "cp \"$SF_SOURCE_DIR\"/geo/missiles/disc.geo geo/ && sed -i 's#geo/hemisphere.geo#geo/disc.geo#; "
           "s#diameter = 160.0; element_size = 10.0;#diameter = 60.0; thickness = 40.0; edge_radius = 2.0; "
           "element_size = 4.0;#' case.cfg");
    program_succeed(p, "pre", "case.cfg -o m.h5 --force --set geometry.parameters.whole=1");
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
    double cut = program_file_number(p, "out/summary.json", "rim_depth_mm"),
           deep = largest(p, "penetration_mm", 1e9);
    print_message("at the peak the disc lies %.3f mm in faces between nodes of 12 mm, %.3f mm at most\n", cut,
                  deep);
    assert_true(cut < 0.01 * 12 && deep < 0.01 * 12);
    assert_true(largest(p, "energy_error_1", 1e9) < 2e-3);
}

/* Two bars with the section of a house, crosswise, ridge on ridge; cells of 5 mm along the ridges, 9 of them,
 * so that no node is near the crossing. With hx or hy a half in the plane of a ridge, with both a quarter. */
static const char ROOFS[] =
    "DefineConstant[ n = 9, hx = 0, hy = 0, top = 20, low = 10 ];\n"
    "For k In {0:1}\n"
    "  p = 100*k; s = 1 - 2*k; z = k*(2*top+0.01); a = 22.5;\n"
    "  cut = k ? hy : hx; shorter = k ? hx : hy;\n"
    "  b = shorter ? 0 : -a;\n"
    "  u[] = {-20,20,20,0,-20,0}; h[] = {0,0,low,top,low,0};\n"
    "  For i In {0:5}\n"
    "    If (!cut || u[i] >= 0)\n"
    "    Point(p+i+1) = {k ? b : u[i], k ? u[i] : b, z + s*h[i]};\n"
    "    EndIf\n"
    "  EndFor\n"
    "  Line(p+2) = {p+6,p+2}; Line(p+3) = {p+2,p+3}; Line(p+4) = {p+3,p+4}; Line(p+7) = {p+6,p+4};\n"
    "  Curve Loop(p+2) = {p+2,p+3,p+4,-(p+7)}; Plane Surface(p+2) = {p+2}; list[] = {p+2};\n"
    "  Transfinite Curve {p+2,p+4} = 5; Transfinite Curve {p+3,p+7} = 4;\n"
    "  If (!cut)\n"
    "  Line(p+1) = {p+1,p+6}; Line(p+5) = {p+4,p+5}; Line(p+6) = {p+5,p+1};\n"
    "  Curve Loop(p+1) = {p+1,p+7,p+5,p+6}; Plane Surface(p+1) = {p+1}; list[] += {p+1};\n"
    "  Transfinite Curve {p+1,p+5} = 5; Transfinite Curve {p+6} = 4;\n"
    "  EndIf\n"
    "  Transfinite Surface {list[]}; Recombine Surface {list[]};\n"
    "  Extrude {k ? a-b : 0, k ? 0 : a-b, 0} { Surface{list[]}; Layers{shorter ? n/2 : n}; Recombine; }\n"
    "EndFor\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-100,-100,-0.1,100,100,0.1};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-100,-100,z-0.1,100,100,z+0.1};\n"
    "If (hx)\n"
    "  Physical Surface(\"symmetry_x\") = Surface In BoundingBox{-0.01,-100,-100,0.01,100,100};\n"
    "EndIf\n"
    "If (hy)\n"
    "  Physical Surface(\"symmetry_y\") = Surface In BoundingBox{-100,-0.01,-100,100,0.01,100};\n"
    "EndIf\n";

static const char ROOFS_CASE[] =
    "geometry: { file = \"roofs.geo\"; missile_file = \"geo/platen.geo\"; length_unit = \"mm\";\n"
    "  parameters = { n = 9; }; missile_parameters = { side = 200.0; }; };\n"
    "pad: { mesh_error_limit = 10.0; separate = true; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { motion = \"motion.csv\"; shape = \"surface\"; friction = 1.0; };\n"
    "solver: { end_time = \"8 ms\"; };\n";

static void figures_of_roofs(const program_place *p, const char *words) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", words);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
}

static void edges_that_cross_carry_each_other(void **state) {
    const program_place *p = *state;
    program_write_text(p, "roofs.geo", ROOFS);
    program_write_text(p, "case.cfg", ROOFS_CASE);
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n4,0.5\n8,1.5\n");
    program_succeed(p, "pre", "case.cfg -o m.h5 --force");
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_succeed(p, "solve", "m.h5 -o two.h5 --force -t 2 --end-time '5 ms'");
    program_succeed(p, "solve", "m.h5 --restart two.h5 -t 2 --end-time '8 ms'");
    program_figures(p, "two.h5 -o two --force");
    program_figures(p, "r.h5 -o out --force");
    double half = largest(p, "base_reaction_N", 0.5), all = largest(p, "base_reaction_N", 1.5),
           deep = largest(p, "penetration_mm", 1.5);
    print_message("force %.3f N at 0.5 mm, %.3f N at 1.5 mm; penetration %.2g mm; energy error %.1e\n", half,
                  all, deep, largest(p, "energy_error_1", 1.5));
    assert_true(half > 0.4 && all > 2 * half && deep < 0.01 * 5);
    assert_true(largest(p, "energy_error_1", 1.5) < 1e-3);
    assert_true(largest(p, "momentum_error_space_1", 1.5) < 1e-12 &&
                largest(p, "angular_momentum_error_1", 1.5) < 1e-12);
    assert_int_equal(program_shell(p, "cmp two/history.csv out/history.csv").code, 0);
    /* with 10 cells nodes lie on the crossing: node and edge both act */
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n4,1\n8,4.5\n");
    figures_of_roofs(p, "--set geometry.parameters.n=10");
    deep = largest(p, "penetration_mm", 5);
    print_message("nodes on the crossing: force %.3f N at 3 mm, penetration %.2g mm up to 4.5 mm\n",
                  largest(p, "base_reaction_N", 3), deep);
    assert_true(deep < 0.01 * 5 && largest(p, "energy_error_1", 5) < 1e-3);
    figures_of_roofs(p, "--set geometry.parameters.n=10 --set pad.self_friction=0.5");
    print_message("with friction: %.3g J rubbed off; angular momentum error %.1e\n",
                  largest(p, "energy_friction_J", 5), largest(p, "angular_momentum_error_1", 5));
    assert_true(largest(p, "energy_friction_J", 5) > 0 && largest(p, "energy_error_1", 5) < 1e-3 &&
                largest(p, "penetration_mm", 5) < 0.01 * 5);
    assert_true(largest(p, "momentum_error_space_1", 5) < 1e-12 &&
                largest(p, "angular_momentum_error_1", 5) < 1e-12);
}

/* Ridges in the planes of a half and a quarter, of faces that fall away by 60 degrees: they carry as those of
 * the whole, but for what the foam at a plane is stiffer or softer, and its light nodes heavier or lighter.
 */
static void ridges_in_symmetry_planes_carry(void **state) {
    const program_place *p = *state;
    program_write_text(p, "roofs.geo", ROOFS);
    program_write_text(p, "case.cfg", ROOFS_CASE);
    program_write_text(p, "motion.csv", "time_ms,displacement_mm\n0,0\n4,1\n");
    double whole = 0;
    for (int k = 0; k < 4; k++) {
        char words[160];
        snprintf(words, sizeof words,
                 "--set geometry.parameters='{ n = 10; top = 40; low = 5; hx = %d; hy = %d; }' "
                 "--set solver.end_time='\"4 ms\"'",
                 k & 1, k >> 1);
        figures_of_roofs(p, words);
        double force = largest(p, "base_reaction_N", 0.5);
        print_message("half in x %d, in y %d: %.4f N at 0.5 mm\n", k & 1, k >> 1, force);
        whole = k == 0 ? force : whole;
        assert_relative(force, whole, 0.08);
        assert_true(largest(p, "penetration_mm", 1) < 0.01 * 5 && largest(p, "energy_error_1", 1) < 1e-3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_that_cross_carry_each_other),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_rim_of_the_missile_presses_the_faces_between_nodes),
        cmocka_unit_test(ridges_in_symmetry_planes_carry),
        cmocka_unit_test(the_missile_touches_faces_that_are_not_named),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_case, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_case, program_group_tear_down);
}
