/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The permanent set: the reference that it moves, its recovery, later drops on it against a thinner pad,
 * resumed and run one by one, and what is refused. */
#include "check.h"
#include "extreme.h"
#include "io/h5_data.h"
#include "model/model_io.h"
#include "model_fixture.h"
#include "post_check.h"
#include "program_fixture.h"
#include "run_fixture.h"
#include "solver/set.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* ---- the reference ---- */

static const fixture_block BLOCK = {.cells = {4, 4, 4}, .spacing = 0.01, .jitter = 0.2};
static const char *const SIDES[] = {"base", NULL};

static void make_block(const sf_memory *memory, fixture *f) {
    sf_case c;
    fixture_case(&c, NULL);
    fixture_hold(&c, SIDES);
    sf_foam_card_of(&c.material)->shared.memory = *memory;
    fixture_under_plate(&c, &BLOCK, 0.1, 0.02, 0.02, f);
}

static sf_status move(fixture *f, const double *set, const double *peak, double pause) {
    sf_error err = SF_ERROR_INIT;
    return sf_set_move(&f->model, set, peak, pause, &err);
}

/* Largest difference of the gradient of the places from the unit tensor. */
static double inconsistency(const sf_model *m) {
    const double *x = sf_model_coefficients(m);
    double worst = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        for (int e = 0; e < 9; e++) {
            double sum = e % 4 == 0 ? -1 : 0;
            for (int64_t k = m->domain_ptr[i]; k < m->domain_ptr[i + 1]; k++)
                sum += x[3 * (int64_t)m->domain_node[k] + e / 3] * m->domain_b[3 * k + e % 3];
            worst = larger(worst, fabs(sum));
        }
    return worst;
}

/* An even set is a change of shape: places, gradients and volumes are those of it, and the pad is at rest. */
static void an_even_set_is_a_thinner_block(void **state) {
    static const double less = 0.9;
    const sf_memory memory = {.start = 1, .set = 0.1};
    fixture f, plain;
    (void)state;
    make_block(&memory, &f);
    make_block(&memory, &plain);
    int64_t n = f.model.node_count;
    double *set = calloc((size_t)(4 * n), sizeof *set), worst = inconsistency(&plain.model);
    assert_true(worst < 1e-12);
    for (int64_t i = 0; i < n; i++)
        set[3 * i + 2] = (less - 1) * f.model.position[3 * i + 2];
    assert_int_equal(move(&f, set, NULL, 0), SF_OK);
    for (int64_t k = 0; k < 3 * n; k++) {
        double factor = k % 3 == 2 ? less : 1;
        worst = larger(worst, fabs(f.model.position[k] - factor * plain.model.position[k]) / BLOCK.spacing);
        worst = larger(worst, fabs(f.model.volume[k / 3] / plain.model.volume[k / 3] - less));
    }
    for (int64_t k = 0; k < 3 * f.model.domain_nnz; k++)
        worst = larger(worst, fabs(f.model.domain_b[k] * (k % 3 == 2 ? less : 1) - plain.model.domain_b[k]) *
                                  BLOCK.spacing);
    worst = larger(worst, inconsistency(&f.model));
    print_message("thinner block: off by %.2g\n", worst);
    assert_true(worst < 1e-12);
    fixture_start(&f);
    fixture_step(&f);
    assert_true(f.state.ledger.stored == 0 && f.state.ledger.viscous == 0);
    set[2] = NAN;
    sf_model_free(&plain.model);
    make_block(&memory, &plain);
    assert_int_equal(move(&plain, set, NULL, 0), SF_ERR_INPUT);
    free(set);
    fixture_free(&f);
    fixture_free(&plain);
}

/* Any field leaves linear consistency, and a rotation of the moved block has no stress and no moment. */
static void any_set_is_consistent(void **state) {
    const sf_memory memory = {.start = 1, .set = 0.1};
    const double angle = 0.3,
                 turn[9] = {cos(angle) - 1, -sin(angle), 0, sin(angle), cos(angle) - 1, 0, 0, 0, 0};
    uint64_t seed = 7;
    fixture f;
    (void)state;
    make_block(&memory, &f);
    int64_t n = f.model.node_count;
    double *set = calloc((size_t)(4 * n), sizeof *set), worst;
    for (int64_t k = 0; k < 3 * n; k++)
        set[k] = f.model.position[3 * (k / 3) + 2] < 1e-9
                     ? 0
                     : 0.05 * BLOCK.spacing * (fixture_random(&seed) - (k % 3 == 2));
    assert_int_equal(move(&f, set, NULL, 0), SF_OK);
    worst = inconsistency(&f.model);
    fixture_start(&f);
    const double *x = sf_model_coefficients(&f.model);
    for (int64_t i = 0; i < n; i++)
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                f.state.d[3 * i + r] += turn[3 * r + c] * x[3 * i + c];
    fixture_forces(&f);
    print_message("rough set: off by %.2g, force %.2g N\n", worst, largest_of(f.state.force, 3 * n));
    assert_true(worst < 1e-12 && largest_of(f.state.force, 3 * n) < 1e-8);
    free(set);
    fixture_free(&f);
}

/* Displacements that the base does not allow, as where the sets of several places meet, are taken out: held
 * nodes stay where they are, to the bit, and their displacement is 0. */
static void held_nodes_stay(void **state) {
    const sf_memory memory = {.start = 1, .set = 0.1};
    uint64_t seed = 3;
    fixture f, plain;
    double worst = 0;
    (void)state;
    make_block(&memory, &f);
    make_block(&memory, &plain);
    int64_t n = f.model.node_count;
    double *set = calloc((size_t)(7 * n), sizeof *set), *peak = &set[4 * n];
    for (int64_t k = 0; k < 3 * n; k++)
        peak[k] = 0.3 * BLOCK.spacing * fixture_random(&seed);
    assert_int_equal(move(&f, set, peak, 9), SF_OK);
    const sf_model *m = &f.model;
    for (int64_t k = 0; k < m->fixed_count; k++)
        for (int r = 0; r < 3; r++) {
            int64_t i = m->fixed_node[k];
            double way = 0;
            for (int64_t e = m->phi_ptr[i]; e < m->phi_ptr[i + 1]; e++)
                way += m->phi_value[e] * m->set[3 * (int64_t)m->phi_node[e] + r];
            worst = larger(worst, fabs(way));
            assert_memory_equal(&m->position[3 * i], &plain.model.position[3 * i], 3 * sizeof(double));
        }
    print_message("held nodes move by %.2g m of %.2g m\n", worst, largest_of(m->set, 3 * n));
    assert_true(m->fixed_count > 0 && worst < 1e-16);
    free(set);
    fixture_free(&f);
    fixture_free(&plain);
}

/* Foam that a set moves into the missile, and foam that it crushes, are refused. */
static void impossible_sets_are_refused(void **state) {
    const sf_memory memory = {.start = 1, .set = 0.1};
    (void)state;
    for (int up = 0; up < 2; up++) {
        sf_error err = SF_ERROR_INIT;
        fixture f;
        make_block(&memory, &f);
        double *set = calloc((size_t)(4 * f.model.node_count), sizeof *set);
        for (int64_t i = 0; i < f.model.node_count; i++)
            set[3 * i + 2] = (up ? 0.05 : -0.8) * f.model.position[3 * i + 2];
        sf_status status = sf_set_move(&f.model, set, NULL, 0, &err);
        if (up) {
            assert_int_equal(status, SF_OK);
            status = sf_operators_build(&f.model, &f.operators, &err);
        }
        assert_int_equal(status, SF_ERR_INPUT);
        assert_non_null(strstr(err.text, up ? "larger missile.gap" : "of the foam's volume at"));
        free(set);
        fixture_free(&f);
    }
}

/* ---- recovery ---- */

/* The set (m) at the top after sets and peaks in turn; a row: indentation of the drop before, pause (s). */
static double after(const sf_memory *memory, int rests, const double (*row)[2]) {
    fixture f;
    double *last = NULL, top = 0;
    for (int k = 0; k < rests; k++) {
        make_block(memory, &f);
        int64_t n = f.model.node_count;
        double *set = last ? last : calloc((size_t)(4 * n), sizeof *set),
               *peak = calloc((size_t)(3 * n), sizeof *peak), high = BLOCK.spacing * BLOCK.cells[2];
        for (int64_t i = 0; i < n; i++) /* the coefficients of a linear field are its values */
            peak[3 * i + 2] = -row[k][0] * f.model.position[3 * i + 2] / high - set[3 * i + 2];
        assert_int_equal(move(&f, set, peak, row[k][1]), SF_OK);
        memcpy(set, f.model.set, (size_t)(4 * n) * sizeof *set);
        top = set[3 * (n - 1) + 2] / f.model.position[3 * (n - 1) + 2];
        for (int64_t i = 0; i < n; i++)
            assert_true(fabs(set[3 * i + 2] - top * f.model.position[3 * i + 2]) < 1e-12);
        last = set;
        free(peak);
        fixture_free(&f);
    }
    free(last);
    return -top / (1 - top) * BLOCK.spacing * BLOCK.cells[2];
}

static void rests_recover_in_closed_form(void **state) {
    const sf_memory m = {.start = 2, .permanent = 0.3, .set = 0.1, .set_recovery = 0.2};
    const double d = 0.02, first = m.set * d;
    (void)state;
    double once = after(&m, 1, (const double[][2]){{d, 90}}), parted = 1 - 0.2 * log10(1 + 90 / 2.0);
    assert_relative(once, first * parted, 1e-12);
    assert_relative(after(&m, 2, (const double[][2]){{d, 30}, {0, 60}}), once, 1e-12);
    assert_relative(after(&m, 1, (const double[][2]){{d, 1e9}}), 0.3 * first, 1e-12);
    assert_relative(after(&m, 2, (const double[][2]){{d, 1e9}, {0, 9}}), 0.3 * first, 1e-12);
    /* a later drop renews what recovered up to its own part, from the new pad, and a deeper one begins anew
     */
    assert_relative(after(&m, 2, (const double[][2]){{d, 90}, {0.9 * d, 0}}), 0.9 * first, 1e-12);
    assert_relative(after(&m, 2, (const double[][2]){{d, 90}, {0.2 * d, 0}}), once, 1e-12);
    assert_relative(after(&m, 2, (const double[][2]){{d, 90}, {1.1 * d, 0}}), 1.1 * first, 1e-12);
    assert_relative(after(&m, 2, (const double[][2]){{d, 0}, {d, 0}}), first, 1e-12);
}

/* ---- drops ---- */

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

static program_result make_model(const program_place *p, const char *name, const char *more) {
    return program_run(p, "pre",
                       "'%s' -o %s --force %s --set material=@'%s' --set material.HU=0.05 --set "
                       "material.memory.reload=0.4 --set material.memory.set=0.05 --set "
                       "material.memory.set_recovery=0.1 %s",
                       fixture_source(EXAMPLE), name, program_coarse(25),
                       fixture_source("tests/materials/eva35_first.cfg"), more);
}

static const char *const SERIES = "--set series.drops=3 --set series.interval='\"90 s\"'";

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    assert_int_equal(make_model(p, "series.h5", SERIES).code, 0);
    assert_int_equal(make_model(p, "single.h5", "").code, 0);
    program_succeed(p, "solve", "series.h5 -o s.h5 --threads 1");
    return 0;
}

static void assert_same_drop(const program_place *p, const char *first, const char *second) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *a = program_open_h5(p, first), *b = program_open_h5(p, second);
    run_assert_same_group(a, b, "/history");
    run_assert_same_group(a, b, "/peak");
    run_assert_same_group(a, b, "/frames");
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

static void bits_are_those_of_single_runs(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "single.h5 -o one.h5 --threads 2 --end-time '4 ms'");
    program_succeed(p, "solve", "--restart one.h5 --end-time '40 ms' --threads 1");
    program_succeed(p, "solve",
                    "single.h5 -o two.h5 --start-from one.h5 --pause '90 s' --threads 2 --end-time '4 ms'");
    program_succeed(p, "solve", "--restart two.h5 --end-time '40 ms' --threads 1");
    program_succeed(p, "solve", "single.h5 -o three.h5 --start-from two.h5 --pause '90 s' --threads 2");
    program_shell(p, "rm s-3.h5.restart; mv s-3.h5 whole.h5");
    program_succeed(p, "solve", "--restart s.h5 --threads 1");
    run_assert_same(p, "whole.h5", "s-3.h5");
    assert_same_drop(p, "s-2.h5", "two.h5");
    assert_same_drop(p, "s-3.h5", "three.h5");
}

/* The first frame shows the set, and the figures tell its depth; the missile flies through it. */
static void frames_and_figures_show_the_set(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    int64_t dims[2] = {-1, 3};
    double *u = NULL, depth, largest = 0, touch[2];
    sf_h5 *first = program_open_h5(p, "s.h5"), *second = program_open_h5(p, "s-2.h5");
    assert_false(sf_h5_exists(first, "/summary/set"));
    assert_int_equal(sf_h5_read(second, "/frames/000000/displacement", SF_H5_F64, 2, dims, (void **)&u, &err),
                     SF_OK);
    assert_int_equal(sf_h5_read_scalar(second, "/summary/set", &depth, &err), SF_OK);
    for (int64_t k = 0; k < dims[0]; k++)
        largest = larger(largest, -u[3 * k + 2]);
    assert_relative(depth, largest, 1e-9);
    assert_int_equal(sf_h5_read_scalar(first, "/summary/contact_time", &touch[0], &err), SF_OK);
    assert_int_equal(sf_h5_read_scalar(second, "/summary/contact_time", &touch[1], &err), SF_OK);
    print_message("set %.3f mm, contact %.3f ms later\n", 1e3 * depth, 1e3 * (touch[1] - touch[0]));
    assert_true(depth > 1e-3 && fabs((touch[1] - touch[0]) * 4.5 - depth) < 0.3e-3);
    free(u);
    sf_h5_close(&first, &err);
    sf_h5_close(&second, &err);
    program_succeed(p, "post", "s-2.h5 -o second");
    assert_relative(program_file_number(p, "second/summary.json", "set_mm"), 1e3 * depth, 1e-5);
}

static void expect(program_result r, const char *words) {
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void wrong_sets_are_refused(void **state) {
    const program_place *p = *state;
    expect(make_model(p, "x.h5", "--set material.memory.set=0.5"),
           "material.memory.set: 0.5 is out of bounds");
    expect(make_model(p, "x.h5", "--set material.memory.set=-0.1"),
           "material.memory.set: -0.1 is out of bounds");
    expect(make_model(p, "x.h5", "--set pad.base=resting --set missile.friction=0.5"),
           "a pad whose layers its base holds");
    expect(make_model(p, "x.h5",
                      "--set pad.base=smooth --set geometry.parameters.quarter=0 --set "
                      "geometry.missile_parameters.quarter=0"),
           "a pad whose layers its base holds");
    assert_int_equal(make_model(p, "smooth.h5", "--set pad.base=smooth").code, 0); /* its planes hold it */
    assert_int_equal(make_model(p, "none.h5", "--set material.memory.set=0.0").code, 0);
    expect(program_run(p, "solve", "none.h5 -o x.h5 --start-from s.h5 --pause '9 s'"), "has another foam");
    program_succeed(p, "solve", "none.h5 -o none-r.h5 --threads 1");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from none-r.h5 --pause '9 s'"),
           "has another foam");
    assert_same_drop(p, "s.h5", "none-r.h5"); /* the first drop does not know of it */
}

/* A drop of a mass on a column of the material; returns the largest specific force (g), and the strain there.
 */
static double drop_on_column(const sf_material_law *law, double thickness, sf_uniaxial *point,
                             double *strain) {
    const double area = 0.05 * 0.05, mass = 0.8, dt = 2e-6;
    double x = 0, v = 4, most = 0;
    for (*strain = 0; x >= 0; *strain = larger(*strain, x / thickness)) {
        x += dt * v;
        double force = area * law->law->uniaxial(law->numbers, dt, fmax(0, x / thickness), point);
        v += dt * (SF_STANDARD_GRAVITY - force / mass);
        most = larger(most, force / mass);
    }
    return most / SF_STANDARD_GRAVITY;
}

/* A platen on a cube of foam without hysteresis: the second drop is a first one on a pad that is thinner by
 * the set of its largest strain. Inertia, which the column has not, is the same in both. */
static void the_second_drop_is_on_a_thinner_pad(void **state) {
    static const double SET = 0.1, HIGH = 0.05;
    const program_place *p = *state;
    char text[4096], root[1024];
    sf_model m = {0};
    sf_error err = SF_ERROR_INIT;
    sf_material_law law;
    sf_uniaxial point = {0};
    snprintf(root, sizeof root, "%s", fixture_source(""));
    snprintf(
        text, sizeof text,
        "geometry: { file = \"%s/geo/cube.geo\"; missile_file = \"%s/geo/platen.geo\"; length_unit = \"mm\";\n"
        "parameters = { side = 50.0; spacing = 10.0; quarter = 1; }; missile_parameters = { side = 100.0; }; };\n"
        "material: { density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curve = \"%s/tests/materials/eva35_first.csv\"; "
        "DAMP = 0.05; memory = { set = %g; }; };\n"
        "missile: { mass = \"0.8 kg\"; velocity = \"4 m/s\"; friction = 0.5; shape = \"surface\"; };\n"
        "series: { drops = 2; interval = \"90 s\"; };\nsolver: { end_time = \"40 ms\"; };\n"
        "pad: { mesh_error_limit = 1.0; };\n",
        root, root, root, SET);
    program_write_text(p, "cube.cfg", text);
    program_succeed(p, "pre", "cube.cfg -o cube.h5");
    program_succeed(p, "solve", "cube.h5 -o cube-r.h5 --threads 1");
    program_succeed(p, "post", "cube-r.h5 -o cube-1");
    program_succeed(p, "post", "cube-r-2.h5 -o cube-2");
    assert_int_equal(sf_model_read(program_path(p, "cube.h5"), &m, NULL, &err), SF_OK);
    assert_int_equal(sf_material_law_build(&m.material[0], &law, &err), SF_OK);
    double strain, ignored, first = drop_on_column(&law, HIGH, &point, &strain);
    point = (sf_uniaxial){0};
    double thin = HIGH * (1 - SET * strain), second = drop_on_column(&law, thin, &point, &ignored),
           growth = program_file_number(p, "cube-2/summary.json", "a_max_g") /
                    program_file_number(p, "cube-1/summary.json", "a_max_g"),
           set = 1e-3 * program_file_number(p, "cube-2/summary.json", "set_mm");
    print_message("set %.3f mm, column %.3f mm; growth %.4f, column %.4f\n", 1e3 * set, 1e3 * (HIGH - thin),
                  growth, second / first);
    assert_relative(set, HIGH - thin, 0.01);
    assert_relative(growth, second / first, 0.01);
    assert_true(second > 1.05 * first);
    sf_material_law_free(&law);
    sf_model_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_even_set_is_a_thinner_block),
        cmocka_unit_test(any_set_is_consistent),
        cmocka_unit_test(held_nodes_stay),
        cmocka_unit_test(impossible_sets_are_refused),
        cmocka_unit_test(rests_recover_in_closed_form),
        cmocka_unit_test(frames_and_figures_show_the_set),
        cmocka_unit_test(wrong_sets_are_refused),
        cmocka_unit_test(the_second_drop_is_on_a_thinner_pad),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(bits_are_those_of_single_runs),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
