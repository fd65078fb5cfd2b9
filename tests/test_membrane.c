/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Membranes: forces and energy of a homogeneous strain, also of a fabric, the bound on the step, the bulge of
 * a clamped circle (Hencky 1915), a drop on a mat against a cover of cells, momentum, energy, threads and
 * restart, wrong keys. */
#include "case/read.h"
#include "check.h"
#include "model_fixture.h"
#include "pre/make.h"
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
#include "solver/constraint/constraint.h"

static const char *const COVER[] = {
    "membrane.faces=[\"top\"]",  "membrane.E=10 MPa",           "membrane.nu=0.3",
    "membrane.thickness=0.5 mm", "membrane.density=1200 kg/m3", NULL};
static const double MODULUS = 1e7, POISSON = 0.3, THICKNESS = 0.5e-3;

static void cover_block(fixture *f, bool fabric) {
    const fixture_block block = {.cells = {5, 4, 2}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.2};
    sf_case c;
    fixture_case(&c, COVER);
    c.membrane_card.fabric = fabric;
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_under_plate(&c, &block, 1, 0, 0, f);
    fixture_start(f);
}

/* Forces of the membrane for d = gradient X; their moments sum f (x) X, in the plane, over its volume. */
static void stretch(fixture *f, double xx, double yy, double xy, double moment[4]) {
    const double gradient[9] = {xx, xy, 0, 0, yy, 0, 0, 0, 0}, none[3] = {0};
    const sf_model *m = &f->model;
    double volume = 0, sum[3] = {0};
    fixture_set_affine(f, gradient, none);
    memset(f->state.force, 0, 3 * (size_t)m->node_count * sizeof(double));
    sf_membrane_force(m, &f->operators.membrane, f->state.d, &f->state.membrane, f->state.force);
    for (int64_t t = 0; t < f->operators.membrane.triangle_count; t++)
        volume += f->operators.membrane.volume[t];
    assert_relative(volume, 0.05 * 0.04 * THICKNESS, 1e-12);
    memset(moment, 0, 4 * sizeof *moment);
    for (int64_t i = 0; i < m->node_count; i++)
        for (int r = 0; r < 3; r++) {
            sum[r] += f->state.force[3 * i + r];
            for (int c = 0; c < 2 && r < 2; c++)
                moment[2 * r + c] -= f->state.force[3 * i + r] * m->position[3 * i + c] / volume;
        }
    for (int r = 0; r < 3; r++)
        assert_true(fabs(sum[r]) < 1e-9);
    f->state.membrane.energy /= volume;
}

/* The mean first Piola-Kirchhoff stress is that of the strain, whatever the mesh. */
static void a_homogeneous_strain_has_its_stress(void **state) {
    (void)state;
    for (int fabric = 0; fabric < 2; fabric++) {
        fixture f;
        double p[4], e = 0.05, plane = MODULUS / (1 - POISSON * POISSON), green = e + 0.5 * e * e;
        cover_block(&f, fabric);
        stretch(&f, e, 0, 0, p);
        assert_relative(p[0], (1 + e) * plane * green, 1e-9);
        assert_relative(p[3], plane * POISSON * green, 1e-9);
        assert_relative(f.state.membrane.energy, 0.5 * plane * green * green, 1e-9);
        stretch(&f, e, sqrt(1 - 2 * POISSON * green) - 1, 0, p); /* free across */
        assert_relative(p[0], (1 + e) * MODULUS * green, 1e-9);
        assert_true(fabs(p[3]) < 1e-6 * p[0]);
        stretch(&f, e, -0.2, 0, p); /* narrower still: a fabric folds */
        if (fabric)
            assert_relative(p[0], (1 + e) * MODULUS * green, 1e-9);
        assert_true(fabric ? fabs(p[3]) < 1e-6 * p[0] : p[3] < -0.1 * p[0]);
        stretch(&f, -e, -e, 0, p);
        assert_true(fabric ? p[0] == 0 && p[3] == 0 && f.state.membrane.energy == 0 : p[0] < 0);
        stretch(&f, 0, 0, 1e-4, p); /* a fabric in shear is pulled along one diagonal */
        assert_relative(p[1], 1e-4 * (fabric ? 0.25 * MODULUS : 0.5 * MODULUS / (1 + POISSON)), 1e-3);
        fixture_free(&f);
    }
}

/* Power iteration on M^-1 K for the largest frequency. */
static void the_bound_is_above_the_highest_frequency(void **state) {
    (void)state;
    fixture f;
    cover_block(&f, false);
    const sf_model *m = &f.model;
    uint64_t seed = 7;
    double value = 0;
    for (int64_t k = 0; k < 3 * m->node_count; k++)
        f.state.d[k] = 1e-9 * fixture_random(&seed);
    for (int pass = 0; pass < 400; pass++) {
        double square = 0;
        memset(f.state.force, 0, 3 * (size_t)m->node_count * sizeof(double));
        sf_membrane_force(m, &f.operators.membrane, f.state.d, &f.state.membrane, f.state.force);
        for (int64_t k = 0; k < 3 * m->node_count; k++) {
            f.state.d[k] = -f.state.force[k] / m->mass[k / 3];
            square += f.state.d[k] * f.state.d[k];
        }
        value = sqrt(square) / 1e-9;
        for (int64_t k = 0; k < 3 * m->node_count; k++)
            f.state.d[k] *= 1e-9 / sqrt(square);
    }
    print_message("highest frequency squared %.4g, bound %.4g s-2\n", value, f.operators.membrane.load);
    assert_true(value < f.operators.membrane.load && value > 0.1 * f.operators.membrane.load);
    fixture_free(&f);
}

static const char DISC[] =
    "SetFactory(\"OpenCASCADE\");\nDisk(1) = {0,0,0,100};\n"
    "Mesh.MeshSizeMin = 9; Mesh.MeshSizeMax = 9;\n"
    "e() = Extrude {0,0,10} { Surface{1}; Layers{1}; Recombine; };\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-101,-101,9.9,101,101,10.1};\n"
    "Physical Surface(\"rim\") = Surface In BoundingBox{-101,-101,-0.1,101,101,10.1};\n"
    "Physical Surface(\"rim\") -= {1, Surface In BoundingBox{-101,-101,9.9,101,101,10.1}};\n";

/* Relaxes the membrane alone, clamped at the rim of the disc, under a dead load along z. */
static double bulge(fixture *f, double pressure) {
    const sf_model *m = &f->model;
    const sf_membrane *b = &f->operators.membrane;
    size_t bytes = 3 * (size_t)m->node_count * sizeof(double);
    double highest = 0;
    for (int step = 0; step < 4000; step++) {
        double *force = f->state.force;
        memset(force, 0, bytes);
        sf_membrane_force(m, b, f->state.d, &f->state.membrane, force);
        for (int64_t k = 0; k < 3 * b->triangle_count; k++) {
            int64_t p = b->triangle[k];
            double load = pressure * b->volume[k / 3] / m->membrane.thickness / 3;
            for (int64_t e = b->rows.ptr[p]; e < b->rows.ptr[p + 1]; e++)
                force[3 * (int64_t)b->rows.node[e] + 2] += load * b->rows.value[e];
        }
        double dt = 1.5 / sqrt(f->state.membrane.load);
        sf_constraint_step held = {.force = force, .v = f->state.v, .dt = dt, .reaction = f->state.reaction};
        sf_constraint_project(&f->operators.constraint, &held);
        for (int64_t k = 0; k < 3 * m->node_count; k++) {
            f->state.v[k] += dt * (force[k] - f->state.reaction[k]) / m->mass[k / 3];
            f->state.v[k] *= 0.995;
            f->state.d[k] += dt * f->state.v[k];
        }
    }
    for (int64_t p = 0; p < b->count; p++)
        highest =
            fmax(highest, f->state.membrane.position[3 * p + 2] - m->position[3 * (int64_t)b->node[p] + 2]);
    return highest;
}

static void a_clamped_circle_bulges_as_hencky_says(void **state) {
    const program_place *p = *state;
    const double radius = 0.1, load = 5e-4, factor = 0.6533; /* of a Poisson's ratio of 0.3 */
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    fixture f = {0};
    char libraries[SF_LIBRARIES_SIZE];
    program_write_text(p, "disc.geo", DISC);
    program_shell(p, "cp \"$SF_SOURCE_DIR\"/geo/platen.geo geo/");
    program_write_text(
        p, "case.cfg",
        "geometry: { file = \"disc.geo\"; missile_file = \"geo/platen.geo\"; length_unit = \"mm\";\n"
        "  missile_parameters = { side = 300.0; }; };\n"
        "pad: { fixed = [\"rim\"]; mesh_error_limit = 100.0; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "missile: { mass = \"1 kg\"; velocity = \"1 m/s\"; shape = \"surface\"; };\n"
        "membrane: { faces = [\"top\"]; E = \"10 MPa\"; nu = 0.3; thickness = \"0.5 mm\"; density = "
        "\"1200 kg/m3\"; };\nsolver: { end_time = \"14 ms\"; };\n");
    if (sf_case_read(program_path(p, "case.cfg"), 0, NULL, NULL, &c, &err) != SF_OK ||
        sf_model_make(&c, &f.model, &f.report, libraries, NULL, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_case_free(&c);
    fixture_start(&f);
    double high = bulge(&f, load * MODULUS * THICKNESS / radius), hencky = factor * radius * cbrt(load);
    print_message("%lld nodes: %.4f mm, Hencky %.4f mm\n", (long long)f.operators.membrane.count, 1e3 * high,
                  1e3 * hencky);
    assert_relative(high, hencky, 0.02);
    fixture_free(&f);
}

/* ---- drops ---- */

/* A mat of a hard and a soft foam, with a cover of cells of `cover` mm, or none. */
static void write_mat(const program_place *p, double cover) {
    char text[2048];
    program_write_text(p, "vinyl.csv", "strain_1,stress_MPa\n0,0\n0.2,4\n0.4,8\n0.6,12\n0.8,16\n");
    snprintf(
        text, sizeof text,
        "geometry: { file = \"geo/layers.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
        "  parameters = { side = 240.0; zone_side = 160.0; lower = 60.0; upper = 20.0; cover = %g; fine_spacing = "
        "10.0; outer_spacing = 20.0; quarter = 1; };\n"
        "  missile_parameters = { diameter = 160.0; element_size = 10.0; quarter = 1; }; };\n"
        "pad: { mesh_error_limit = 10.0; };\nmaterials: {\nlower: {\n@include \"hard_foam.cfg\"\n};\n"
        "upper: {\n@include \"materials/eva35.cfg\"\n};\n%s};\n"
        "missile: { mass = \"4.6 kg\"; velocity = \"4 m/s\"; };\nsolver: { end_time = \"40 ms\"; };\n",
        cover,
        cover > 0
            ? "cover: { density = \"1200 kg/m3\"; E = \"20 MPa\"; curve = \"vinyl.csv\"; HU = 1.0; DAMP = "
              "0.0; };\n"
            : "");
    program_write_text(p, "case.cfg", text);
    program_shell(
        p, "cp \"$SF_SOURCE_DIR\"/geo/*.geo geo/ && cp \"$SF_SOURCE_DIR\"/examples/layers/hard_foam.c* .");
}

#define MEMBRANE                                                                                             \
    "--set 'membrane.faces=[\"top\"]' --set membrane.E='20 MPa' --set membrane.nu=0.0 --set "                \
    "membrane.thickness='1 mm' --set membrane.density='1200 kg/m3' "

static double drop(const program_place *p, const char *overrides, double *hic) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", overrides);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_figures(p, "r.h5 -o out --force");
    assert_true(program_history_largest(p, "energy_error_1") < 1e-3);
    assert_true(program_history_largest(p, "momentum_error_space_1") < 1e-12);
    assert_true(program_history_largest(p, "angular_momentum_error_1") < 1e-12);
    *hic = program_file_number(p, "out/summary.json", "hic");
    return program_file_number(p, "out/summary.json", "a_max_g");
}

static void a_membrane_acts_as_a_cover_of_cells(void **state) {
    const program_place *p = *state;
    double of_cells, of_membrane, of_bare;
    write_mat(p, 1);
    double cells = drop(p, "", &of_cells);
    write_mat(p, 0);
    double membrane = drop(p, MEMBRANE, &of_membrane), bare = drop(p, "", &of_bare);
    print_message("a_max %.2f g of cells, %.2f g of a membrane, %.2f g bare; HIC %.1f, %.1f, %.1f\n", cells,
                  membrane, bare, of_cells, of_membrane, of_bare);
    assert_relative(membrane, cells, 0.01);
    assert_true(fabs(of_membrane - of_cells) < 0.5 * fabs(of_bare - of_cells));
}

static void the_bits_are_the_same(void **state) {
    const program_place *p = *state;
    write_mat(p, 0);
    program_succeed(p, "pre",
                    "case.cfg -o m.h5 --force %s --set membrane.fabric=true --set solver.end_time='9 ms'",
                    MEMBRANE);
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

static void wrong_membranes_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *words, *sentence;
    } bad[] = {{"--set membrane.E='20 MPa'", "no meaning without membrane.faces"},
               {"--set membrane.fabric=true", "no meaning without membrane.faces"},
               {"--set 'membrane.faces=[\"top\"]'", "membrane.E"},
               {MEMBRANE "--set membrane.nu=0.6", "membrane.nu"},
               {MEMBRANE "--set membrane.E='-1 MPa'", "membrane.E"},
               {MEMBRANE "--set membrane.thickness='0 mm'", "membrane.thickness"},
               {MEMBRANE "--set membrane.density='20 MPa'", "membrane.density"},
               {MEMBRANE "--set 'membrane.faces=[\"nothing\"]'", "nothing"},
               {MEMBRANE "--set 'membrane.faces=[\"top\", \"top\"]'", "membrane.faces"}};
    write_mat(p, 0);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        program_result r = program_run(p, "pre", "case.cfg -o bad.h5 --force %s", bad[k].words);
        if (r.code != 2 || !strstr(r.err, bad[k].sentence))
            fail_msg("%s: exit code %d, %s", bad[k].words, r.code, r.err);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_homogeneous_strain_has_its_stress),
        cmocka_unit_test(the_bound_is_above_the_highest_frequency),
        cmocka_unit_test(a_clamped_circle_bulges_as_hencky_says),
        cmocka_unit_test(the_bits_are_the_same),
        cmocka_unit_test(wrong_membranes_are_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_membrane_acts_as_a_cover_of_cells),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_case, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_case, program_group_tear_down);
}
