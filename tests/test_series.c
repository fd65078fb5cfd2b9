/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops one after the other on the same pad: a series, the same drops run one by one, resumed, with other
 * threads, and what is refused. */
#include "check.h"
#include "extreme.h"
#include "io/h5_data.h"
#include "model_fixture.h"
#include "post_check.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "material/laws.h"
#include "model/model_io.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

/* A coarse model of a foam that remembers. */
static program_result make_model(const program_place *p, const char *name, const char *more) {
    char coarse[512];
    snprintf(coarse, sizeof coarse, "%s", program_coarse(25));
    return program_run(
        p, "pre",
        "'%s' -o %s --force %s --set material=@'%s' --set material.HU=0.05 --set material.ALPHA=0.5 "
        "--set material.memory.reload=0.4 --set material.memory.drift=0.2 "
        "--set material.memory.recovery=0.1 --set material.memory.permanent=0.2 %s",
        fixture_source(EXAMPLE), name, coarse, fixture_source("tests/materials/eva35_first.cfg"), more);
}

static const char *const WHOLE =
    "--set geometry.parameters.quarter=0 --set geometry.missile_parameters.quarter=0";

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    assert_int_equal(make_model(p, "series.h5", "--set series.drops=3 --set series.interval='\"90 s\"'").code,
                     0);
    assert_int_equal(make_model(p, "single.h5", "").code, 0);
    program_succeed(p, "solve", "series.h5 -o s.h5 --threads 1");
    return 0;
}

static double number(const char *text, int row, int column) {
    for (; row > 0 && text; row--)
        text = strchr(text, '\n') + 1;
    for (; column > 0; column--)
        text = strchr(text, ',') + 1;
    return strtod(text, NULL);
}

/* The second drop is harder by the softening, and by less after a longer pause. */
static void later_drops_are_harder(void **state) {
    const program_place *p = *state;
    program_succeed(p, "post", "series s.h5 -o series");
    program_bytes csv = program_read_file(program_path(p, "series/series.csv"));
    double first = number(csv.data, 1, 2), second = number(csv.data, 2, 2), third = number(csv.data, 3, 2);
    assert_true(second > 1.05 * first && third > second && third < 3 * first);
    assert_true(fabs(number(csv.data, 4, 2) / (0.5 * (second + third)) - 1) < 1e-6);
    assert_true(fabs(number(csv.data, 2, 3) - (second / first - 1)) < 1e-4);
    free(csv.data);
    assert_int_equal(
        program_shell(p, "test -s series/compare.json && test -s series/compare_curves.csv").code, 0);
    program_succeed(p, "solve", "single.h5 -o rested.h5 --start-from s.h5 --pause '8 hour' --threads 1");
    program_succeed(p, "post", "rested.h5 -o rested");
    double rested = program_file_number(p, "rested/summary.json", "a_max_g");
    assert_true(rested > 1.01 * first && rested < 0.99 * second);
}

/* But for what the summary says of the series. */
static void assert_same_drop(const program_place *p, const char *first, const char *second) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *a = program_open_h5(p, first), *b = program_open_h5(p, second);
    run_assert_same_group(a, b, "/history");
    run_assert_same_group(a, b, "/peak");
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

static void bits_are_those_of_single_runs(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "single.h5 -o one.h5 --threads 2");
    program_succeed(p, "solve",
                    "single.h5 -o two.h5 --start-from one.h5 --pause '90 s' --threads 2 --end-time '4 ms'");
    program_succeed(p, "solve", "--restart two.h5 --end-time '40 ms' --threads 1");
    program_succeed(p, "solve", "single.h5 -o three.h5 --start-from two.h5 --pause '90 s' --threads 2");
    assert_same_drop(p, "s.h5", "one.h5");
    assert_same_drop(p, "s-2.h5", "two.h5");
    assert_same_drop(p, "s-3.h5", "three.h5");
    program_succeed(p, "post", "series one.h5 two.h5 three.h5 -o again");
}

static void a_series_goes_on_where_it_was(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "series.h5 -o r.h5 --threads 1");
    program_shell(p, "rm r-3.h5 r-3.h5.restart; cp r-2.h5 kept.h5");
    program_succeed(p, "solve", "--restart r.h5 --threads 2");
    run_assert_same(p, "s-3.h5", "r-3.h5");
    program_shell(p, "rm r-2.h5 r-2.h5.restart r-3.h5 r-3.h5.restart");
    program_succeed(p, "solve", "--restart r.h5 --threads 1");
    run_assert_same(p, "s-2.h5", "r-2.h5");
    run_assert_same(p, "s-3.h5", "r-3.h5");
}

/* A series is done anew and interrupted in its first drop: it goes on there, not where the one before has
 * ended. */
static void a_series_anew_does_not_go_on_in_the_one_before(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "series.h5 -o f.h5 --threads 1");
    program_result r = program_shell(
        p,
        "rm f.h5; '%s/softfall-solve' series.h5 -o f.h5 --force --threads 1 > log & for k in $(seq 6000); do "
        "[ -e f.h5.run ] && [ -e f.h5 ] && break; sleep 0.002; done; kill -INT $!; wait $!",
        getenv("SF_BIN_DIR"));
    assert_int_equal(r.code, 130);
    assert_int_not_equal(access(program_path(p, "f-2.h5.restart"), F_OK), 0);
    program_succeed(p, "solve", "--restart f.h5 --threads 1");
    run_assert_same(p, "s.h5", "f.h5");
    run_assert_same(p, "s-3.h5", "f-3.h5");
}

static void expect(program_result r, const char *words) {
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void wrong_series_are_refused(void **state) {
    const program_place *p = *state;
    expect(make_model(p, "x.h5", "--set series.drops=2.5 --set series.interval='\"90 s\"'"), "whole number");
    expect(make_model(p, "x.h5", "--set series.drops=2"), "or series.interval");
    expect(make_model(p, "x.h5", "--set series.interval='\"90 s\"'"), "belongs to a series");
    expect(make_model(p, "x.h5", "--set series.drops=2 --set series.interval='\"0 s\"'"), "series.interval");
    expect(make_model(
               p, "x.h5",
               "--set series.drops=2 --set series.interval='\"9 s\"' --set solver.stop_after_rebound=false"),
           "stop_after_rebound");
    expect(make_model(p, "x.h5", "--set material.HU=1"), "memory.reload");
    expect(make_model(p, "x.h5", "--set material.memory.reload=1.5"), "memory.reload");
    expect(program_run(p, "solve", "series.h5 -o x.h5 --no-checkpoint"), "--no-checkpoint");
    expect(program_run(p, "solve", "series.h5 -o s.h5"), "exists");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from s.h5"), "--pause");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from nowhere.h5 --pause '9 s'"),
           "is not there");
}

static void another_pad_is_refused(void **state) {
    const program_place *p = *state;
    assert_int_equal(make_model(p, "other.h5", "--set geometry.parameters.thickness=60.0").code, 0);
    expect(program_run(p, "solve", "other.h5 -o x.h5 --start-from s.h5 --pause '9 s'"), "is another one");
    assert_int_equal(
        make_model(p, "other.h5", "--set material.memory.reload=0.0 --set material.memory.recovery=0.0").code,
        0);
    expect(program_run(p, "solve", "other.h5 -o x.h5 --start-from s.h5 --pause '9 s'"), "has another foam");
    assert_int_equal(make_model(p, "stiffer.h5", "--set material.E='\"0.9 MPa\"'").code, 0);
    expect(program_run(p, "solve", "stiffer.h5 -o x.h5 --start-from s.h5 --pause '9 s'"), "has another foam");
    program_succeed(p, "solve", "other.h5 -o plain.h5 --threads 1");
    program_succeed(p, "solve", "other.h5 -o plain-2.h5 --start-from plain.h5 --pause '9 s' --threads 1");
    assert_non_null(
        strstr(program_succeed(p, "post", "plain-2.h5 -o plain").err, "loads along its unloading path"));
    assert_null(strstr(program_succeed(p, "post", "s-2.h5 -o second").err, "loads along its unloading path"));
    program_succeed(p, "solve", "single.h5 -o short.h5 --end-time '9 ms'");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from short.h5 --pause '9 s'"),
           "points in contact");
    assert_int_not_equal(access(program_path(p, "x.h5"), F_OK), 0);
    expect(program_run(p, "post", "series one.h5 -o x"), "is no series");
    expect(program_run(p, "post", "series s.h5 s-3.h5 -o x"), "not drop 2");
}

/* A second drop that began on the pad of another run is none of this series, whatever its number says. */
static void drops_of_another_run_are_refused(void **state) {
    const program_place *p = *state;
    assert_int_equal(make_model(p, "slow.h5",
                                "--set series.drops=2 --set series.interval='\"90 s\"' --set "
                                "missile.velocity='\"3 m/s\"'")
                         .code,
                     0);
    program_succeed(p, "solve", "slow.h5 -o slow-run.h5 --threads 1");
    program_succeed(p, "post", "series slow-run.h5 -o slow");
    program_shell(p, "cp s-2.h5 slow-run-2.h5");
    expect(program_run(p, "post", "series slow-run.h5 -o x"), "is of another run");
    expect(program_run(p, "post", "series slow-run.h5 s-2.h5 -o x"), "is of another run");
}

/* The pad of a run is an input: no output replaces it, whatever it is called. */
static void the_run_before_is_not_replaced(void **state) {
    const program_place *p = *state;
    program_shell(
        p, "cp s.h5 kept.h5; cp s.h5.restart kept.h5.restart; ln -s kept.h5 soft.h5; ln kept.h5 hard.h5");
    for (int k = 0; k < 5; k++) {
        static const char *const output[] = {"kept.h5", "./kept.h5", "soft.h5", "hard.h5", "kept.h5.restart"};
        char line[256];
        snprintf(line, sizeof line, "single.h5 -o %s --force --start-from kept.h5 --pause '9 s'", output[k]);
        expect(program_run(p, "solve", line), "would replace an input");
    }
    program_shell(p, "cmp s.h5 kept.h5 && cmp s.h5.restart kept.h5.restart && rm kept.h5* soft.h5 hard.h5");
}

/* A number of a CSV row by the name of its column. */
static double column_of(const char *csv, int row, const char *name) {
    int column = 0;
    const char *at = csv;
    for (; strncmp(at, name, strlen(name)) != 0 || !strchr(",\n", at[strlen(name)]); at = strchr(at, ',') + 1)
        column++;
    return number(csv, row, column);
}

/* Each drop of the list is that of a model made for it alone, and begins where the one before has left the
 * pad. */
static void assert_list(const program_place *p, bool aside) {
    char more[512];
    program_shell(p, "rm -rf l.h5* l-*.h5* a-2.h5* kept.h5 listed");
    snprintf(
        more, sizeof more,
        "%s --set series.drops='( {}, { velocity = \"3.5 m/s\"; %s interval = \"5 s\"; }, { mass = \"3 kg\"; } )' "
        "--set series.interval='\"90 s\"'",
        aside ? WHOLE : "", aside ? "position = [\"40 mm\", \"0 mm\"];" : "");
    assert_int_equal(make_model(p, "list.h5", more).code, 0);
    snprintf(more, sizeof more, "%s --set missile.velocity='\"3.5 m/s\"' %s", aside ? WHOLE : "",
             aside ? "--set missile.position='[\"40 mm\", \"0 mm\"]'" : "");
    assert_int_equal(make_model(p, "aside.h5", more).code, 0);
    program_succeed(p, "solve", "list.h5 -o l.h5 --threads 2");
    program_succeed(p, "solve", "aside.h5 -o a-2.h5 --start-from l.h5 --pause '5 s' --threads 1");
    assert_same_drop(p, "l-2.h5", "a-2.h5");
    program_shell(p, "mv l-3.h5 kept.h5; rm l-3.h5.restart");
    program_succeed(p, "solve", "--restart l.h5 --threads 1");
    run_assert_same(p, "kept.h5", "l-3.h5");
    program_succeed(p, "post", "series l.h5 -o listed");
    program_bytes csv = program_read_file(program_path(p, "listed/series.csv"));
    assert_true(column_of(csv.data, 2, "v0_m_s") == 3.5 && column_of(csv.data, 3, "v0_m_s") == 4.5);
    assert_true(fabs(column_of(csv.data, 2, "x_mm") - column_of(csv.data, 1, "x_mm") - (aside ? 40 : 0)) <
                0.5);
    assert_true(column_of(csv.data, 2, "pause_s") == 5 && column_of(csv.data, 3, "pause_s") == 90);
    free(csv.data);
    program_shell(p, "cp aside.h5 list-3.h5; rm l-3.h5 l-3.h5.restart");
    expect(program_run(p, "solve", "--restart l.h5"), "is not the model of drop 3");
    program_shell(p, "rm list-3.h5");
    expect(program_run(p, "solve", "--restart l.h5"), "list-3.h5");
}

static void drops_of_a_list_are_their_own(void **state) {
    assert_list(*state, false);
}

static void drops_of_a_list_have_their_own_places(void **state) {
    assert_list(*state, true);
}

/* The softening at the start is (1 - q) of what unloading has kept back at the largest energy; recovery takes
 * of it, and where the missile was it is largest. */
static void first_frame_shows_what_is_left(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    double *now = NULL, *rested = NULL, largest = 0;
    int64_t count = -1;
    sf_h5 *second = program_open_h5(p, "s-2.h5"), *first = program_open_h5(p, "s.h5");
    program_succeed(p, "solve",
                    "single.h5 -o late.h5 --start-from s.h5 --pause '8 hour' --end-time '0.2 ms'");
    sf_h5 *late = program_open_h5(p, "late.h5");
    assert_false(sf_h5_exists(first, "/frames/000000/softening"));
    assert_int_equal(
        sf_h5_read(second, "/frames/000000/softening", SF_H5_F64, 1, &count, (void **)&now, &err), SF_OK);
    assert_int_equal(
        sf_h5_read(late, "/frames/000000/softening", SF_H5_F64, 1, &count, (void **)&rested, &err), SF_OK);
    /* q is reload plus what recovery R gives back of the rest, log10(1 + t / 1 s) decades, 0.1 each; W_max is
     * (1 - R^4) of it */
    double r = 0.1 * log10(1 + 90), s = 0.1 * log10(1 + 8 * 3600.0), fresh = (1 - r) * (1 - pow(r, 4)),
           later = (1 - s) * (1 - pow(s, 4));
    for (int64_t k = 0; k < count; k++) {
        largest = larger(largest, now[k]);
        assert_true(now[k] >= 0 && fabs(rested[k] * fresh - now[k] * later) <= 1e-9 * now[k]);
    }
    assert_true(largest > 1e4);
    free(now);
    free(rested);
    sf_h5_close(&first, &err);
    sf_h5_close(&second, &err);
    sf_h5_close(&late, &err);
}

static void expect_list(const program_place *p, const char *list, const char *words) {
    char more[512];
    snprintf(more, sizeof more, "--set series.drops='%s'", list);
    expect(make_model(p, "x.h5", more), words);
    assert_int_not_equal(access(program_path(p, "x.h5"), F_OK), 0);
    assert_int_not_equal(access(program_path(p, "x-2.h5"), F_OK), 0);
}

static void wrong_lists_are_refused(void **state) {
    const program_place *p = *state;
    expect_list(p, "( {}, {} )", "or series.interval");
    expect_list(p, "( { interval = \"9 s\"; }, { interval = \"9 s\"; } )", "nothing was before the first");
    expect_list(p, "( {}, 3 )", "drop 2 is a plain number");
    expect_list(p, "( )", "at least 1");
    expect_list(p, "( {}, { interval = \"0 s\"; } )", "series.interval");
    expect_list(p, "( {}, { interval = 9; } )", "series.interval");
    expect_list(p, "( {}, { interval = \"9 s\"; speed = \"3 m/s\"; } )", "unknown key \"speed\"");
    expect_list(p, "( {}, { interval = \"9 s\"; velocity = \"3 kg\"; } )", "missile.velocity");
    expect_list(p, "( {}, { interval = \"9 s\"; velocity = \"-3 m/s\"; } )", "missile.velocity");
    expect_list(p, "( {}, { interval = \"9 s\"; position = [\"30 mm\", \"0 mm\"]; } )", "symmetry plane");
    expect_list(p, "( {}, { interval = \"9 s\"; position = [\"9 m\", \"0 mm\"]; } )", "missile.position");
    assert_int_equal(
        make_model(p, "lone.h5",
                   "--set series.interval='\"90 s\"' --set series.counted=[2,3] --set series.drops=1")
            .code,
        0);
    program_succeed(p, "solve", "lone.h5 -o one-alone.h5 --threads 1");
    assert_same_drop(p, "s.h5", "one-alone.h5");
    assert_int_equal(make_model(p, "lone.h5", "--set series.drops='( { velocity = \"4.5 m/s\"; } )'").code,
                     0);
    program_succeed(p, "solve", "lone.h5 -o one-of-list.h5 --threads 1");
    assert_same_drop(p, "s.h5", "one-of-list.h5");
}

/* A drop of a mass on a column of the material, whose point goes on; returns the largest specific force (g).
 */
static double drop_on_column(const sf_material_law *law, sf_uniaxial *point) {
    const double thickness = 0.05, area = 0.05 * 0.05, mass = 0.8, dt = 2e-6;
    double x = 0, v = 4, most = 0;
    while (x >= 0) {
        x += dt * v;
        double force = area * law->law->uniaxial(law->numbers, dt, fmax(0, x / thickness), point);
        v += dt * (SF_STANDARD_GRAVITY - force / mass);
        most = larger(most, force / mass);
    }
    return most / SF_STANDARD_GRAVITY;
}

/* A platen on a cube of this foam, which does not bulge, has one strain everywhere but for its inertia (4 g
 * of 0.8 kg) and for DAMP: three drops of it are those of a mass on a point of the law. */
static void drops_on_a_cube_are_those_of_a_column(void **state) {
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
        "HU = 0.05; ALPHA = 0.5; DAMP = 0.05; memory = { reload = 0.4; drift = 0.2; recovery = 0.1; permanent = 0.2; }; };\n"
        "missile: { mass = \"0.8 kg\"; velocity = \"4 m/s\"; friction = 0.5; shape = \"surface\"; };\n"
        "series: { drops = 3; interval = \"90 s\"; };\nsolver: { end_time = \"40 ms\"; };\n"
        "pad: { mesh_error_limit = 1.0; };\n",
        root, root, root);
    program_write_text(p, "cube.cfg", text);
    program_succeed(p, "pre", "cube.cfg -o cube.h5");
    program_succeed(p, "solve", "cube.h5 -o cube-r.h5 --threads 1");
    program_succeed(p, "post", "series cube-r.h5 -o cube");
    program_bytes csv = program_read_file(program_path(p, "cube/series.csv"));
    assert_int_equal(sf_model_read(program_path(p, "cube.h5"), &m, NULL, &err), SF_OK);
    assert_int_equal(sf_material_law_build(&m.material[0], &law, &err), SF_OK);
    for (int k = 1; k <= 3; k++) {
        if (k > 1)
            sf_material_point_rest(&law, 90, &point);
        double column = drop_on_column(&law, &point), drop = column_of(csv.data, k, "a_max_g");
        print_message("drop %d: %.2f g, column %.2f g\n", k, drop, column);
        assert_true(fabs(drop / column - 1) < 0.03);
    }
    free(csv.data);
    sf_material_law_free(&law);
    sf_model_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(later_drops_are_harder),         cmocka_unit_test(bits_are_those_of_single_runs),
        cmocka_unit_test(a_series_goes_on_where_it_was),  cmocka_unit_test(wrong_series_are_refused),
        cmocka_unit_test(another_pad_is_refused),         cmocka_unit_test(drops_of_another_run_are_refused),
        cmocka_unit_test(the_run_before_is_not_replaced), cmocka_unit_test(first_frame_shows_what_is_left),
        cmocka_unit_test(wrong_lists_are_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(drops_of_a_list_are_their_own),
        cmocka_unit_test(a_series_anew_does_not_go_on_in_the_one_before),
        cmocka_unit_test(drops_on_a_cube_are_those_of_a_column),
        cmocka_unit_test(drops_of_a_list_have_their_own_places),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
