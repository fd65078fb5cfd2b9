/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a plan, what is refused, and samples. */
#include "model_fixture.h"
#include "post_check.h"
#include "program_fixture.h"
#include "sweep_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Values that are the same but for their order, or for two signs, are another plan. */
static void another_order_is_another_plan(void **state) {
    static const char *const values[] = {"(-20, -10, 10, 20)", "(20, 10, -10, -20)", "(-20, 10, -10, 20)"};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        char factors[200];
        sf_plan plan;
        snprintf(factors, sizeof factors, "{ key = \"geometry.parameters.thickness\"; values = %s; }",
                 values[k]);
        sweep_read_plan(*state, factors, &plan);
        hash[k] = sf_plan_hash(&plan);
        sf_plan_free(&plan);
    }
    assert_true(hash[0] != hash[1] && hash[1] != hash[2] && hash[0] != hash[2]);
}

static void the_last_block_is_the_fastest_and_zipped_lists_go_together(void **state) {
    sf_plan plan;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    sweep_read_plan(*state,
                    "{ key = \"missile.velocity\"; values = [\"4 m/s\", \"500 cm/s\"]; },"
                    "{ zip = ( { key = \"geometry.parameters.thickness\"; values = (40, 50.0, 60); },"
                    "          { key = \"pad.base\"; values = [\"glued\", \"smooth\", \"resting\"]; } ); }",
                    &plan);
    assert_int_equal(plan.rows, 6);
    for (int64_t row = 0; row < 6; row++) {
        assert_close(sf_plan_value(&plan, 0, row), row < 3 ? 4 : 5, 1e-12);
        assert_close(sf_plan_value(&plan, 1, row), 40 + 10 * (double)(row % 3), 0);
        assert_int_equal((int)sf_plan_value(&plan, 2, row), row % 3);
    }
    assert_int_equal(sf_plan_overrides(&plan, 5, text, NULL), 3);
    assert_string_equal(text[0], "missile.velocity=\"5 m/s\"");
    assert_string_equal(text[1], "geometry.parameters.thickness=60");
    assert_string_equal(text[2], "pad.base=\"resting\"");
    sf_factor_heading(&plan.factor[0], text[0], sizeof text[0]);
    assert_string_equal(text[0], "missile.velocity (m/s)");
    sf_plan_free(&plan);
}

static void a_material_comes_before_its_keys_and_ranges_hold_both_ends(void **state) {
    sf_plan plan;
    char factors[2048], text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    snprintf(factors, sizeof factors,
             "{ key = \"material.HU\"; from = 0.01; to = 1.0; count = 3; spacing = \"log\"; },"
             "{ key = \"material\"; files = [\"%s\"]; }",
             fixture_source("examples/materials/eva35.cfg"));
    sweep_read_plan(*state, factors, &plan);
    assert_close(sf_plan_value(&plan, 0, 0), 0.01, 1e-15);
    assert_close(sf_plan_value(&plan, 0, 1), 0.1, 1e-15);
    assert_close(sf_plan_value(&plan, 0, 2), 1, 1e-15);
    assert_int_equal(sf_plan_overrides(&plan, 1, text, NULL), 2);
    assert_ptr_equal(strstr(text[0], "material=@/"), text[0]);
    assert_string_equal(text[1], "material.HU=0.1");
    sf_plan_free(&plan);
}

typedef struct refusal {
    const char *factors, *part; /* of the plan, and of the sentence */
} refusal;

/* A sentence each, with the line of the plan. */
static void assert_refusals(const program_place *place, const refusal *cases, size_t count) {
    for (size_t k = 0; k < count; k++) {
        sf_plan plan;
        sf_error err;
        sweep_try_plan(place, cases[k].factors, false, &plan, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part) || !strstr(err.text, "plan.cfg:"))
            fail_msg("%zu: \"%s\" expected in: %s", k, cases[k].part, err.text);
        sf_plan_free(&plan);
    }
}

static void plans_that_cannot_be_meant_are_refused(void **state) {
    static const refusal cases[] = {
        {"{ key = \"missile.velocity\"; values = []; }", "is empty: there is no run"},
        {"{ key = \"missile.velocity\"; values = [\"4 m/s\"]; }, { key = \"missile.velocity\"; values = [\"5 m/s\"]; }",
         "missile.velocity is a factor already, at "},
        {"{ key = \"missile.velocity\"; values = [\"4 m/s\", \"5 kg\"]; }", "\"5 kg\" is a mass"},
        {"{ key = \"missile.velocity\"; values = (\"4 m/s\", 5); }", "5 has no unit"},
        {"{ zip = ( { key = \"missile.velocity\"; values = [\"4 m/s\", \"5 m/s\"]; },"
         " { key = \"missile.mass\"; values = [\"4 kg\"]; } ); }",
         "missile.velocity has 2 values and missile.mass 1; the lists must have one length"},
        {"{ zip = ( { key = \"missile.velocity\"; values = [\"4 m/s\", \"5 m/s\"]; },"
         " { key = \"missile.mass\"; values = [\"4 kg\", \"5 kg\"]; uncertain = true; } ); }",
         "one of missile.velocity and missile.mass is chosen and the other uncertain"},
        {"{ key = \"a.b\"; from = 0.0; to = 1.0; count = 2000; }, { key = \"a.c\"; from = 0.0; to = 1.0; count = 2000; }",
         "the plan has 4000000 runs, more than 1000000: give --yes"},
        {"{ sample = \"sobol\"; count = 2000000; of = ( { key = \"a.b\"; low = 0.0; high = 1.0; } ); }",
         "more than 1000000 rows: give --yes"},
        {"{ sample = \"sobol\"; count = 8; of = ( { key = \"a.b\"; low = 1.0; high = 1.0; } ); }",
         "low must be below high"},
        {"{ sample = \"dice\"; count = 8; of = ( { key = \"a.b\"; low = 0.0; high = 1.0; } ); }",
         "random, latin_hypercube, sobol, saltelli"},
        {"{ sample = \"saltelli\"; count = 8; of = ( { key = \"a.b\"; low = 0.0; high = 1.0; } ); },"
         "{ key = \"a.c\"; values = [1, 2]; }",
         "stands alone"},
        {"{ key = \"material\"; posterior = \"none\"; }", "there is no draw-001.cfg"},
        {"{ key = \"material\"; files = [\"none.cfg\"]; }", "none.cfg"},
        {"{ key = \"a.b\"; values = [1]; name = \"hic\"; }", "\"hic\" is a column of runs.csv"},
        {"{ sample = \"saltelli\"; count = 7; of = ( { key = \"a.b\"; low = 0.0; high = 1.0; } ); }",
         "Sobol' indices need 8 samples"},
        {"{ key = \"output.frame_interval\"; values = [\"1 ms\", \"2 ms\"]; }",
         "output.frame_interval has no effect in a campaign"},
        {"{ key = \"a.b\"; values = [1]; } ); set = ( \"output.fields = [\\\"strain\\\"]\"",
         "set: output.fields has no effect in a campaign"},
        {"{ key = \"a.b\"; values = [1]; } ); set = ( \" a.b =2\"", "set: a.b is a factor, at "},
    };
    assert_refusals(*state, cases, sizeof cases / sizeof cases[0]);
}

static void keys_of_other_kinds_of_factor_are_refused(void **state) {
    static const refusal cases[] = {
        {"{ key = \"material\"; values = [\"@foam.cfg\"]; }", "material is given by a file: give files"},
        {"{ key = \"a.b\"; value = [1]; }", "unknown key \"value\""},
        {"{ key = \"a.b\"; values = [1]; from = 1; }", "exclude each other"},
        {"{ key = \"a.b\"; low = 1.0; high = 2.0; }", "unknown key \"low\""},
        {"{ key = \"a.b\"; values = [1]; to = 2; }",
         "unknown key \"to\"; the keys here are key, name, values"},
        {"{ key = \"material\"; files = [\"a.cfg\"]; draws = 2; }", "unknown key \"draws\""},
        {"{ key = \"material\"; posterior = \"none\"; count = 2; }", "unknown key \"count\""},
        {"{ key = \"a.b\"; from = 1.0; to = 2.0; count = 2; draws = 2; }", "unknown key \"draws\""},
        {"{ key = \"a.b\"; from = 1.0; to = 2.0; count = 2.5; }", "count is 2.5; it must be a whole number"},
        {"{ sample = \"sobol\"; count = 8; of = ( { key = \"a.b\"; distribution = \"normal\"; mean = 1.0; "
         "deviation = 1.0; low = 0.0; } ); }",
         "unknown key \"low\"; the keys here are key, name, distribution, mean, deviation"},
        {"{ sample = \"sobol\"; count = 8; of = ( { key = \"a.b\"; distribution = \"uniform\"; low = 1.0; "
         "high = 2.0; median = 1.0; } ); }",
         "unknown key \"median\""},
        {"{ sample = \"sobol\"; count = 8; of = ( { key = \"material\"; posterior = \"none\"; "
         "distribution = \"normal\"; } ); }",
         "unknown key \"distribution\""},
        {"{ sample = \"sobol\"; count = 8.5; of = ( { key = \"a.b\"; low = 1.0; high = 2.0; } ); }",
         "count is 8.5; it must be a whole number"},
        {"{ sample = \"random\"; count = 8; seed = 0.5; of = ( { key = \"a.b\"; low = 1.0; high = 2.0; } ); }",
         "seed is 0.5; it must be a whole number"},
        {"{ key = \"material\"; posterior = \"none\"; draws = 1.5; }",
         "draws is 1.5; it must be a whole number"},
        {"{ key = \"geometry.file\"; values = [\"a.geo\"]; }",
         "geometry.file is given by a file: give files, relative to the plan"},
        {"{ key = \"material.curve\"; values = [\"/a.csv\", \"b.csv\"]; }",
         "material.curve is given by a file"},
        {"", "factors must be a list"},
    };
    assert_refusals(*state, cases, sizeof cases / sizeof cases[0]);
}

/* With the line of the factor and what the case says. */
static void keys_and_units_that_a_case_does_not_take_are_refused(void **state) {
    static const struct {
        const char *factors, *part;
    } cases[] = {
        {"{ key = \"missile.speed\"; values = [\"4 m/s\"]; }", "velocity"},
        {"{ key = \"missile.velocity\"; values = [\"4 kg\", \"5 kg\"]; }",
         "\"4 kg\" is a mass; expected a speed"},
        {"{ key = \"missile.friction\"; from = 0.0; to = 100.0; count = 5; }", "missile.friction"},
        {"{ sample = \"latin_hypercube\"; count = 64; of = ( { key = \"missile.mass\"; distribution = \"normal\"; "
         "mean = \"1 kg\"; deviation = \"1 kg\"; } ); }",
         "missile.mass"},
        {"{ key = \"geometry.parameters.thicknes\"; values = [40.0, 50.0]; }",
         "pad.geo has no parameter \"thicknes\" (did you mean \"thickness\"?); its DefineConstant parameters are: "},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_plan plan;
        sf_error err = SF_ERROR_INIT;
        uint64_t hash;
        sweep_read_plan(*state, cases[k].factors, &plan);
        sf_sweep_check_inputs(&plan, &hash, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part) || !strstr(err.text, "plan.cfg:2"))
            fail_msg("%zu: \"%s\" expected in: %s", k, cases[k].part, err.text);
        sf_plan_free(&plan);
    }
}

/* An error of `set` has the line of `set`, that of a factor its own. */
static void what_set_does_wrong_is_told_of_set(void **state) {
    static const struct {
        const char *factors, *part;
    } cases[] = {
        {"{ key = \"missile.velocity\"; values = [\"4 m/s\"]; } );\nset = ( \"pad.base=glued\", \"missile.mas=4 kg\"",
         "plan.cfg:3: --set missile.mas="},
        {"{ key = \"missile.mass\"; values = [\"4 m\"]; } );\nset = ( \"pad.base=glued\"",
         "plan.cfg:2: --set missile.mass="},
    };
    for (size_t k = 0; k < 2; k++) {
        sf_plan plan;
        sf_error err = SF_ERROR_INIT;
        uint64_t hash;
        sweep_read_plan(*state, cases[k].factors, &plan);
        assert_int_equal(sf_sweep_check_inputs(&plan, &hash, &err), SF_ERR_INPUT);
        if (!strstr(err.text, cases[k].part))
            fail_msg("%s", err.text);
        sf_plan_free(&plan);
    }
}

/* Only combinations that a zip has are looked at: half of the gap's fall takes longer than the other end
 * time. */
static void values_that_are_zipped_are_checked_together(void **state) {
    static const struct {
        const char *ends;
        sf_status status;
    } cases[] = {{"\"20 ms\", \"200 ms\"", SF_OK}, {"\"200 ms\", \"20 ms\"", SF_ERR_INPUT}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[512];
        sf_plan plan;
        sf_error err = SF_ERROR_INIT;
        uint64_t hash;
        snprintf(text, sizeof text,
                 "{ zip = ( { key = \"missile.gap\"; values = [\"1 mm\", \"500 mm\"]; }, "
                 "{ key = \"solver.end_time\"; values = [%s]; } ); }",
                 cases[k].ends);
        sweep_read_plan(*state, text, &plan);
        sf_sweep_check_inputs(&plan, &hash, &err);
        if (err.status != cases[k].status)
            fail_msg("%s: %s", cases[k].ends, err.text);
        sf_plan_free(&plan);
    }
}

static void the_inputs_are_known_by_their_contents(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash[3];
    program_shell(p, "cp '%s' foam.cfg; cp '%s' eva35.csv", fixture_source("examples/materials/eva35.cfg"),
                  fixture_source("examples/materials/eva35.csv"));
    for (int k = 0; k < 3; k++) {
        if (k == 1)
            program_shell(p, "touch eva35.csv foam.cfg");
        if (k == 2) /* the last digit of a stress of the curve that the file names */
            program_shell(p, "sed -i '$s/[0-9]$/7/; $s/7$/&1/' eva35.csv");
        sweep_read_plan(p, "{ key = \"material\"; files = [\"foam.cfg\"]; }", &plan);
        if (sf_sweep_check_inputs(&plan, &hash[k], &err) != SF_OK)
            fail_msg("%s", err.text);
        sf_plan_free(&plan);
    }
    assert_true(hash[0] == hash[1]);
    assert_true(hash[0] != hash[2]);
}

static void geometries_of_one_text_in_two_folders_are_refused(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash;
    program_shell(p, "mkdir -p one two; cp '%s' one; cp one/pad.geo two", fixture_source("geo/pad.geo"));
    sweep_read_plan(p, "{ key = \"geometry.file\"; files = [\"one/pad.geo\", \"two/pad.geo\"]; }", &plan);
    assert_int_equal(sf_sweep_check_inputs(&plan, &hash, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "one/pad.geo and two/pad.geo have the same text in different folders"));
    sf_plan_free(&plan);
    err = (sf_error)SF_ERROR_INIT;
    program_shell(p, "cp one/pad.geo one/copy.geo; echo '// two' >>two/pad.geo");
    sweep_read_plan(
        p, "{ key = \"geometry.file\"; files = [\"one/pad.geo\", \"one/copy.geo\", \"two/pad.geo\"]; }",
        &plan);
    if (sf_sweep_check_inputs(&plan, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_plan_free(&plan);
}

/* softfall-fit writes draws model by model: some of them must not be the first ones. */
static void draws_are_taken_from_the_whole_posterior(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    static const char *const expected[4] = {"draw-002.cfg", "draw-004.cfg", "draw-007.cfg", "draw-009.cfg"};
    sweep_make_posterior(p);
    sweep_read_plan(p, "{ key = \"material\"; posterior = \"ten\"; draws = 4; }", &plan);
    assert_int_equal(plan.rows, 4);
    for (int64_t row = 0; row < 4; row++) {
        assert_int_equal(sf_plan_overrides(&plan, row, text, NULL), 1);
        assert_non_null(strstr(text[0], expected[row]));
    }
    sf_plan_free(&plan);
    sweep_read_plan(p, "{ key = \"material\"; posterior = \"ten\"; }", &plan);
    assert_int_equal(plan.rows, 10);
    sf_plan_free(&plan);
}

/* An array of libconfig has whole or fractional numbers, not both. */
static void a_vector_with_whole_and_fractional_numbers_is_a_value(void **state) {
    sf_plan plan;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    sweep_read_plan(
        *state,
        "{ key = \"missile.direction\"; values = ([0.0, 0.0, -1.0], [0.1, 0.0, -1.0], (0, 0.2, -1)); }",
        &plan);
    sf_plan_overrides(&plan, 1, text, NULL);
    assert_string_equal(text[0], "missile.direction=[0.1, 0.0, -1.0]");
    sf_factor_text(&plan.factor[0], 1, text[0], sizeof text[0]);
    assert_string_equal(text[0], "[0.1, 0, -1]"); /* in tables as before */
    if (sf_sweep_check_inputs(&plan, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_plan_free(&plan);
}

/* As all names of the plan, from whatever folder softfall-sweep is started. */
static void a_file_of_set_is_relative_to_the_plan(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE], expected[700];
    program_shell(p, "cp '%s' foam.cfg; cp '%s' eva35.csv", fixture_source("examples/materials/eva35.cfg"),
                  fixture_source("examples/materials/eva35.csv"));
    sweep_read_plan(p,
                    "{ key = \"missile.velocity\"; values = [\"4 m/s\"]; } );"
                    "set = ( \"pad.base=glued\", \"material=@foam.cfg\"",
                    &plan);
    assert_int_equal(sf_plan_overrides(&plan, 0, text, NULL), 3);
    snprintf(expected, sizeof expected, "material=@%s/foam.cfg", p->folder);
    assert_string_equal(text[0], "pad.base=glued");
    assert_string_equal(text[1], expected);
    if (sf_sweep_check_inputs(&plan, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_plan_free(&plan);
}

/* ---- samples ---- */

static void a_latin_hypercube_has_one_point_in_each_stratum(void **state) {
    (void)state;
    enum { N = 50, D = 3 };
    double u[N * D], again[N * D], other[N * D];
    sf_error err = SF_ERROR_INIT;
    sf_sample(SF_SAMPLING_LATIN, D, N, 7, u, &err);
    sf_sample(SF_SAMPLING_LATIN, D, N, 7, again, &err);
    sf_sample(SF_SAMPLING_LATIN, D, N, 8, other, &err);
    assert_int_equal(err.status, SF_OK);
    for (int i = 0; i < D; i++) {
        bool hit[N] = {false};
        for (int k = 0; k < N; k++) {
            int stratum = (int)(u[k * D + i] * N);
            assert_true(stratum >= 0 && stratum < N && !hit[stratum]);
            hit[stratum] = true;
        }
    }
    assert_memory_equal(u, again, sizeof u);
    assert_memory_not_equal(u, other, sizeof u);
}

static void the_sobol_sequence_begins_as_it_is_known_and_has_its_limit(void **state) {
    (void)state;
    static const double known[] = {0.5, 0.5, 0.75, 0.25, 0.25, 0.75, 0.375, 0.375};
    double u[8], *many = malloc(41 * 2 * sizeof *many);
    sf_error err = SF_ERROR_INIT;
    sf_sample(SF_SAMPLING_SOBOL, 2, 4, 1, u, &err);
    for (int k = 0; k < 8; k++)
        assert_close(u[k], known[k], 0);
    assert_int_equal(sf_sample(SF_SAMPLING_SOBOL, 40, 2, 1, many, &err), SF_OK);
    assert_int_equal(sf_sample(SF_SAMPLING_SOBOL, 41, 2, 1, many, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "41 coordinates of a Sobol' sequence; at most 40 are allowed"));
    free(many);
}

/* Row by row: A, B, and A with one coordinate from B. */
static void a_sample_of_saltelli_mixes_two_samples(void **state) {
    (void)state;
    enum { N = 4, D = 3 };
    double u[N * (D + 2) * D];
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_sample_rows(SF_SAMPLING_SALTELLI, D, N), N * (D + 2));
    sf_sample(SF_SAMPLING_SALTELLI, D, N, 1, u, &err);
    for (int i = 0; i < D; i++)
        for (int k = 0; k < N; k++)
            for (int j = 0; j < D; j++)
                assert_close(u[((2 + i) * N + k) * D + j], u[((i == j ? N : 0) + k) * D + j], 0);
    for (int k = 0; k < N * D; k++)
        assert_true(u[k] > 0 && u[k] < 1);
}

/* Another seed, other points, as evenly spread: in each of 16 parts of each coordinate as many. */
static void a_seed_moves_the_sobol_sequence(void **state) {
    (void)state;
    enum { N = 256, D = 3, PARTS = 16 };
    double u[3][N * D];
    static const uint64_t seed[3] = {1, 2, 3};
    sf_error err = SF_ERROR_INIT;
    for (int s = 0; s < 3; s++) {
        int part[D][PARTS] = {{0}};
        assert_int_equal(sf_sample(SF_SAMPLING_SOBOL, D, N, seed[s], u[s], &err), SF_OK);
        for (int k = 0; k < N * D; k++) {
            assert_true(u[s][k] > 0 && u[s][k] < 1);
            assert_true(s == 0 || u[s][k] != u[s - 1][k]);
            part[k % D][(int)(PARTS * u[s][k])]++;
        }
        for (int k = 0; k < D * PARTS; k++)
            assert_true(abs(part[k / PARTS][k % PARTS] - N / PARTS) <= 2);
    }
}

static void distributions_have_their_quantiles(void **state) {
    sf_plan plan;
    enum { N = 2000 };
    sweep_read_plan(*state,
                    "{ sample = \"latin_hypercube\"; count = 2000; of = ("
                    "{ key = \"a.u\"; low = \"4 m/s\"; high = \"600 cm/s\"; },"
                    "{ key = \"a.n\"; distribution = \"normal\"; mean = 10.0; deviation = 2.0; },"
                    "{ key = \"a.l\"; distribution = \"lognormal\"; median = 3.0; deviation_ln = 0.5; },"
                    "{ key = \"a.w\"; values = [\"one\", \"two\"]; } ); }",
                    &plan);
    double sum[4] = {0}, squares = 0, logs = 0, two = 0;
    for (int64_t row = 0; row < N; row++) {
        double u = sf_plan_value(&plan, 0, row), n = sf_plan_value(&plan, 1, row),
               l = sf_plan_value(&plan, 2, row);
        assert_true(u >= 4 && u <= 6);
        sum[0] += u / N;
        sum[1] += n / N;
        squares += (n - 10) * (n - 10) / N;
        sum[2] += log(l) / N;
        logs += pow(log(l / 3), 2) / N;
        two += sf_plan_value(&plan, 3, row) / N;
    }
    assert_relative(sum[0], 5, 1e-3);
    assert_relative(sum[1], 10, 1e-3);
    assert_relative(sqrt(squares), 2, 0.01);
    assert_relative(sum[2], log(3), 1e-3);
    assert_relative(sqrt(logs), 0.5, 0.01);
    assert_relative(two, 0.5, 1e-12);
    sf_plan_free(&plan);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_order_is_another_plan),
        cmocka_unit_test(the_last_block_is_the_fastest_and_zipped_lists_go_together),
        cmocka_unit_test(a_material_comes_before_its_keys_and_ranges_hold_both_ends),
        cmocka_unit_test(plans_that_cannot_be_meant_are_refused),
        cmocka_unit_test(keys_of_other_kinds_of_factor_are_refused),
        cmocka_unit_test(keys_and_units_that_a_case_does_not_take_are_refused),
        cmocka_unit_test(what_set_does_wrong_is_told_of_set),
        cmocka_unit_test(values_that_are_zipped_are_checked_together),
        cmocka_unit_test(the_inputs_are_known_by_their_contents),
        cmocka_unit_test(geometries_of_one_text_in_two_folders_are_refused),
        cmocka_unit_test(draws_are_taken_from_the_whole_posterior),
        cmocka_unit_test(a_vector_with_whole_and_fractional_numbers_is_a_value),
        cmocka_unit_test(a_file_of_set_is_relative_to_the_plan),
        cmocka_unit_test(a_latin_hypercube_has_one_point_in_each_stratum),
        cmocka_unit_test(the_sobol_sequence_begins_as_it_is_known_and_has_its_limit),
        cmocka_unit_test(a_sample_of_saltelli_mixes_two_samples),
        cmocka_unit_test(a_seed_moves_the_sobol_sequence),
        cmocka_unit_test(distributions_have_their_quantiles),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
