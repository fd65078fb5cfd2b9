/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a plan, what is computed of them, and campaigns of which the drops are replaced by a formula.
 */
#include "model_fixture.h"
#include "program_fixture.h"

#include "sweep/analysis.h"
#include "sweep/campaign.h"
#include "sweep/cost.h"
#include "sweep/drops.h"
#include "sweep/inputs.h"
#include "sweep/plot.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

/* ---- plans ---- */

/* Writes the plan with the example as its case, and reads it. */
static sf_status try_plan(const program_place *p, const char *factors, bool huge, sf_plan *plan,
                          sf_error *err) {
    static char path[600];
    char text[4096];
    *err = (sf_error)SF_ERROR_INIT;
    snprintf(text, sizeof text, "case = \"%s\";\nfactors = ( %s );\n", fixture_source(EXAMPLE), factors);
    snprintf(path, sizeof path, "%s", program_write_text(p, "plan.cfg", text));
    return sf_plan_read(path, huge, plan, err);
}

static void read_plan(const program_place *p, const char *factors, sf_plan *plan) {
    sf_error err;
    if (try_plan(p, factors, false, plan, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* Values that are the same but for their order, or for two signs, are another plan. */
static void another_order_is_another_plan(void **state) {
    static const char *const values[] = {"(-20, -10, 10, 20)", "(20, 10, -10, -20)", "(-20, 10, -10, 20)"};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        char factors[200];
        sf_plan plan;
        snprintf(factors, sizeof factors, "{ key = \"geometry.parameters.thickness\"; values = %s; }",
                 values[k]);
        read_plan(*state, factors, &plan);
        hash[k] = sf_plan_hash(&plan);
        sf_plan_free(&plan);
    }
    assert_true(hash[0] != hash[1] && hash[1] != hash[2] && hash[0] != hash[2]);
}

static void the_last_block_is_the_fastest_and_zipped_lists_go_together(void **state) {
    sf_plan plan;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    read_plan(*state,
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
    assert_int_equal(sf_plan_overrides(&plan, 5, text), 3);
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
    read_plan(*state, factors, &plan);
    assert_close(sf_plan_value(&plan, 0, 0), 0.01, 1e-15);
    assert_close(sf_plan_value(&plan, 0, 1), 0.1, 1e-15);
    assert_close(sf_plan_value(&plan, 0, 2), 1, 1e-15);
    assert_int_equal(sf_plan_overrides(&plan, 1, text), 2);
    assert_ptr_equal(strstr(text[0], "material=@/"), text[0]);
    assert_string_equal(text[1], "material.HU=0.1");
    sf_plan_free(&plan);
}

/* A sentence each, with the line of the plan. */
static void plans_that_cannot_be_meant_are_refused(void **state) {
    static const struct {
        const char *factors, *part;
    } cases[] = {
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
        {"{ key = \"output.frame_interval\"; values = [\"1 ms\", \"2 ms\"]; }",
         "output.frame_interval has no effect in a campaign"},
        {"{ key = \"a.b\"; values = [1]; } ); set = ( \"output.fields = [\\\"strain\\\"]\"",
         "set: output.fields has no effect in a campaign"},
        {"{ key = \"a.b\"; values = [1]; } ); set = ( \" a.b =2\"", "set: a.b is a factor, at "},
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
         "geometry.file is the name of a file: give files, relative to the plan"},
        {"{ key = \"material.curve\"; values = [\"/a.csv\", \"b.csv\"]; }",
         "material.curve is the name of a file"},
        {"", "factors must be a list"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_plan plan;
        sf_error err;
        try_plan(*state, cases[k].factors, false, &plan, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part) || !strstr(err.text, "plan.cfg:"))
            fail_msg("%zu: \"%s\" expected in: %s", k, cases[k].part, err.text);
        sf_plan_free(&plan);
    }
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
         "pad.geo has no parameter \"thicknes\"; its DefineConstant parameters are: "},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_plan plan;
        sf_error err = SF_ERROR_INIT;
        uint64_t hash;
        read_plan(*state, cases[k].factors, &plan);
        sf_sweep_check_inputs(&plan, &hash, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part) || !strstr(err.text, "plan.cfg:2"))
            fail_msg("%zu: \"%s\" expected in: %s", k, cases[k].part, err.text);
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
        read_plan(*state, text, &plan);
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
        read_plan(p, "{ key = \"material\"; files = [\"foam.cfg\"]; }", &plan);
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
    read_plan(p, "{ key = \"geometry.file\"; files = [\"one/pad.geo\", \"two/pad.geo\"]; }", &plan);
    assert_int_equal(sf_sweep_check_inputs(&plan, &hash, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "one/pad.geo and two/pad.geo have the same text in different folders"));
    sf_plan_free(&plan);
    err = (sf_error)SF_ERROR_INIT;
    program_shell(p, "cp one/pad.geo one/copy.geo; echo '// two' >>two/pad.geo");
    read_plan(p, "{ key = \"geometry.file\"; files = [\"one/pad.geo\", \"one/copy.geo\", \"two/pad.geo\"]; }",
              &plan);
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
    assert_non_null(strstr(err.text, "at most 40 coordinates, not 41"));
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
    read_plan(*state,
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

/* ---- what is computed ---- */

static double ishigami(const double *x) {
    return sin(x[0]) + 7 * sin(x[1]) * sin(x[1]) + 0.1 * pow(x[2], 4) * sin(x[0]);
}

/* The indices in closed form, of a = 7 and b = 0.1. */
static void assert_indices_of_ishigami(uint64_t seed) {
    enum { N = 1024, D = 3 };
    const double pi = acos(-1), a = 7, b = 0.1, v1 = 0.5 * pow(1 + b * pow(pi, 4) / 5, 2), v2 = a * a / 8,
                 v13 = b * b * pow(pi, 8) * (1.0 / 18 - 1.0 / 50), v = v1 + v2 + v13;
    const double first[D] = {v1 / v, v2 / v, 0}, total[D] = {(v1 + v13) / v, v2 / v, v13 / v};
    double *u = malloc(N * (D + 2) * D * sizeof *u), *y = malloc(N * (D + 2) * sizeof *y);
    sf_index index[D];
    sf_error err = SF_ERROR_INIT;
    int64_t used = 0;
    sf_sample(SF_SAMPLING_SALTELLI, D, N, seed, u, &err);
    for (int k = 0; k < N * (D + 2); k++) {
        double x[D];
        for (int i = 0; i < D; i++)
            x[i] = pi * (2 * u[k * D + i] - 1);
        y[k] = 1000 + ishigami(x); /* the mean must not matter */
    }
    y[N + 5] = NAN; /* a run that failed takes its sample with it */
    assert_int_equal(sf_indices(D, N, y, 1, index, &used, &err), SF_OK);
    assert_int_equal(used, N - 1);
    for (int i = 0; i < D; i++) {
        assert_true(index[i].first_low <= first[i] && first[i] <= index[i].first_high);
        assert_true(index[i].total_low <= total[i] && total[i] <= index[i].total_high);
        assert_true(index[i].first_high - index[i].first_low < 0.25);
        assert_true(index[i].total_high - index[i].total_low < 0.25);
        assert_close(index[i].first, first[i], 0.03);
        assert_close(index[i].total, total[i], 0.03);
    }
    for (int k = 0; k < N; k++) /* a tenth of the samples, not at random */
        if (y[k] > 1007)
            y[k] = NAN;
    sf_indices(D, N, y, 1, index, &used, &err);
    assert_true(used < N - N / 20 && used > N / 2);
    assert_true(isnan(index[0].first) && isnan(index[2].total_high));
    for (int k = 0; k < N * (D + 2); k++)
        y[k] = 3;
    sf_indices(D, N, y, 1, index, &used, &err);
    assert_true(isnan(index[0].first)); /* nothing varies */
    free(u);
    free(y);
}

/* The sequence, and the sequence moved. */
static void indices_of_ishigami_lie_in_their_intervals(void **state) {
    (void)state;
    assert_indices_of_ishigami(1);
    assert_indices_of_ishigami(7);
}

static double quadratic(const double *x) {
    return 3 - 0.5 * x[0] + 0.02 * x[1] + 0.1 * x[0] * x[0] - 0.003 * x[1] * x[1] + 0.04 * x[0] * x[1] +
           5 * x[2];
}

enum { SURFACE_ROWS = 30 };

/* Two numbers and a column of 0 and 1. */
static void fill_surface(double *x, double *y, double noise) {
    uint64_t seed = 3;
    for (int k = 0; k < SURFACE_ROWS; k++) {
        x[3 * k] = 4 + fixture_random(&seed);
        x[3 * k + 1] = 50 + 20 * fixture_random(&seed);
        x[3 * k + 2] = k % 2;
        y[k] = quadratic(x + 3 * k) + noise * fixture_random(&seed);
    }
}

static void a_response_surface_is_exact_for_a_quadratic(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS];
    const double elsewhere[3] = {4.3, 61, 1};
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0);
    assert_int_equal(sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_string_equal(s.problem, "");
    assert_int_equal(s.terms, 7);
    assert_relative(sf_quadratic_at(&s, elsewhere), quadratic(elsewhere), 1e-9);
    assert_true(s.rms < 1e-9 && s.left_out_rms < 1e-9);
    assert_true(s.q2 > 1 - 1e-12);
}

/* Against surfaces that are fitted without each row. */
static void the_error_at_rows_left_out_is_that_of_surfaces_without_them(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS], left_out[SURFACE_ROWS], press = 0;
    sf_quadratic whole, part;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0.5);
    sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &whole, left_out, &err);
    for (int out = 0; out < SURFACE_ROWS; out++) {
        double fewer_x[3 * SURFACE_ROWS], fewer_y[SURFACE_ROWS];
        int n = 0;
        for (int k = 0; k < SURFACE_ROWS; k++)
            if (k != out) {
                memcpy(fewer_x + 3 * n, x + 3 * k, 3 * sizeof *x);
                fewer_y[n++] = y[k];
            }
        sf_quadratic_fit(2, 1, n, fewer_x, fewer_y, &part, NULL, &err);
        double value = sf_quadratic_at(&part, x + 3 * out);
        assert_relative(left_out[out], value, 1e-8);
        press += (y[out] - value) * (y[out] - value) / SURFACE_ROWS;
    }
    assert_relative(whole.left_out_rms, sqrt(press), 1e-8);
    assert_true(whole.left_out_rms > whole.rms);
}

/* Rows of one x are left out together: each row twice, with other noise. */
static void repeated_rows_are_left_out_together(void **state) {
    (void)state;
    double x[6 * SURFACE_ROWS], y[2 * SURFACE_ROWS], left_out[2 * SURFACE_ROWS];
    uint64_t seed = 5;
    sf_quadratic whole, part;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0.5);
    memcpy(x + 3 * SURFACE_ROWS, x, 3 * SURFACE_ROWS * sizeof *x);
    for (int k = 0; k < SURFACE_ROWS; k++)
        y[SURFACE_ROWS + k] = y[k] + 0.5 * fixture_random(&seed);
    sf_quadratic_fit(2, 1, 2 * SURFACE_ROWS, x, y, &whole, left_out, &err);
    for (int out = 0; out < SURFACE_ROWS; out++) {
        double fewer_x[6 * SURFACE_ROWS], fewer_y[2 * SURFACE_ROWS];
        int n = 0;
        for (int k = 0; k < 2 * SURFACE_ROWS; k++)
            if (k % SURFACE_ROWS != out) {
                memcpy(fewer_x + 3 * n, x + 3 * k, 3 * sizeof *x);
                fewer_y[n++] = y[k];
            }
        sf_quadratic_fit(2, 1, n, fewer_x, fewer_y, &part, NULL, &err);
        double value = sf_quadratic_at(&part, x + 3 * out);
        assert_relative(left_out[out], value, 1e-8);
        assert_relative(left_out[out + SURFACE_ROWS], value, 1e-8);
    }
}

/* Two places, many rows: a straight line needs both. */
static void a_surface_that_needs_every_place_has_no_known_error(void **state) {
    (void)state;
    double x[SURFACE_ROWS], y[SURFACE_ROWS];
    uint64_t seed = 7;
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < SURFACE_ROWS; k++) {
        x[k] = 3 + k % 2;
        y[k] = x[k] + 0.1 * fixture_random(&seed);
    }
    assert_int_equal(sf_quadratic_fit(1, 0, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_int_equal(s.terms, 2);
    assert_true(isnan(s.left_out_rms) && isnan(s.q2));
    assert_non_null(strstr(s.problem, "its error at runs left out is not known"));
}

static void a_surface_that_the_rows_do_not_determine_says_so(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS];
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0);
    assert_int_equal(sf_quadratic_fit(2, 1, 8, x, y, &s, NULL, &err), SF_OK);
    assert_non_null(strstr(s.problem, "7 terms need at least 9 runs"));
    for (int k = 0; k < SURFACE_ROWS; k++)
        x[3 * k + 1] = 10 * x[3 * k];
    assert_int_equal(sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_non_null(strstr(s.problem, "do not determine"));
}

/* Intervals of Clopper and Pearson: none of ten has the closed form 1 - 0.025^(1/10); three of ten is
 * tabulated. */
static void probabilities_have_the_interval_of_their_counts(void **state) {
    (void)state;
    sf_probability none = {.above = 10}, all = {.below = 10}, some = {.below = 3, .above = 7},
                   unknown = {.below = 3, .above = 6, .unknown = 1};
    sf_probability_judge(&none, INFINITY);
    sf_probability_judge(&all, INFINITY);
    sf_probability_judge(&some, INFINITY);
    sf_probability_judge(&unknown, INFINITY);
    assert_close(none.low, 0, 0);
    assert_close(none.high, 1 - pow(0.025, 0.1), 1e-9);
    assert_close(all.low, pow(0.025, 0.1), 1e-9);
    assert_close(all.high, 1, 0);
    assert_close(some.low, 0.06674, 5e-6);
    assert_close(some.high, 0.65245, 5e-6);
    sf_probability crossed = {.below = 30, .above = 70}; /* ten draws, each with ten others */
    sf_probability_judge(&crossed, 10);
    assert_close(crossed.share, 0.3, 1e-12);
    assert_close(crossed.high, some.high, 1e-12);
    assert_close(unknown.share, 0.3, 1e-12);    /* an unknown one is not shown to be below */
    assert_close(unknown.low, some.low, 1e-12); /* the unknown one above */
    assert_true(unknown.high > some.high);      /* and below */
}

/* ---- campaigns, with a formula in place of the drops ---- */

typedef struct formula {
    int64_t calls;    /* rows so far */
    int64_t stop_at;  /* interrupted before that many; 0: not */
    int64_t fails;    /* this row fails; -1: none */
    bool changed;     /* whatever was there is not used again */
    int64_t other;    /* from this row on; 0: none */
    int64_t dies_at;  /* the process ends after that many; 0: not */
    int64_t edits_at; /* the inputs change after that many; 0: not */
    int64_t stale;    /* this row is no longer what its geometry's files give; -1: none */
} formula;

static uint64_t present_inputs;

static sf_status look_at_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err) {
    (void)plan;
    *hash = present_inputs;
    return err->status;
}

static sf_status evaluate(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh,
                          sf_error *err) {
    formula *f = context;
    *fresh = 0;
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        bool there = runs->state[row[k]] == SF_SWEEP_DONE;
        if (there && !f->changed && (f->other == 0 || row[k] < f->other))
            continue;
        if (f->stop_at > 0 && f->calls == f->stop_at)
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted");
        f->calls++;
        *fresh += 1;
        if (f->dies_at > 0 && f->calls == f->dies_at)
            _exit(0);
        if (f->edits_at > 0 && f->calls == f->edits_at)
            present_inputs = 99;
        if (row[k] == f->fails) {
            sf_runs_failed(runs, row[k], "it failed, and said \"no\"; see log", err);
            continue;
        }
        double *place = sf_runs_place(runs, row[k]), x = sf_plan_value(runs->plan, 0, row[k]);
        place[sf_runs_figure("a_max_g")] = 100 * sqrt(x) + sf_plan_value(runs->plan, 1, row[k]) / 3;
        place[sf_runs_figure("hic")] = 900 + 100 * x / 3;
        char folder[32];
        snprintf(folder, sizeof folder, "drop-%lld", (long long)row[k] % 6);
        sf_runs_done(runs, row[k], SF_GRADE_VALID, folder, NULL, err);
    }
    return err->status;
}

static bool is_current(void *context, const sf_runs *runs, int64_t row) {
    const formula *f = context;
    return runs->state[row] == SF_SWEEP_DONE && row != f->stale;
}

static const char *const GRID = "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 10; },"
                                "{ key = \"a.y\"; uncertain = true; values = (1, 2, 3, 4, 5, 6); }";

static sf_status campaign(const program_place *p, const sf_plan *plan, formula *f, bool retry,
                          uint64_t inputs, sf_runs *runs, sf_error *err) {
    const sf_sweep_engine engine = {evaluate, f, 7, NULL};
    const sf_sweep_campaign c = {
        .plan = plan, .folder = p->folder, .inputs = inputs, .look = look_at_inputs, .retry = retry};
    present_inputs = inputs;
    *err = (sf_error)SF_ERROR_INIT;
    f->calls = 0;
    if (sf_runs_create(plan, runs, err) == SF_OK)
        sf_sweep_campaign_run(&c, &engine, runs, err);
    return err->status;
}

static int64_t rows_done(const program_place *p, const sf_plan *plan, formula *f, bool retry,
                         uint64_t inputs) {
    sf_runs runs;
    sf_error err;
    if (campaign(p, plan, f, retry, inputs, &runs, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_runs_free(&runs);
    return f->calls;
}

/* A campaign of GRID that is finished. */
static void finish_grid(const program_place *p, sf_plan *plan, formula *f) {
    read_plan(p, GRID, plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    rows_done(p, plan, f, false, 1);
}

static void an_interrupted_campaign_goes_on_with_the_same_table(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.fails = 3};
    read_plan(p, GRID, &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
    program_bytes whole = program_read_file(program_path(p, "runs.csv"));
    program_shell(p, "rm -f runs.csv sweep.key");
    f.stop_at = 25;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
    sf_runs_free(&runs);
    f.stop_at = 0;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 35);
    program_assert_unchanged(program_path(p, "runs.csv"), &whole);
    sf_plan_free(&plan);
}

static void a_failed_run_keeps_its_sentence_and_is_done_again_on_request(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(f.calls, 0);
    assert_int_equal(runs.state[3], SF_SWEEP_FAILED);
    assert_string_equal(runs.message[3], "it failed, and said \"no\"; see log");
    sf_runs_free(&runs);
    assert_int_equal(rows_done(p, &plan, &f, true, 1), 1);
    assert_int_equal(rows_done(p, &plan, &f, true, 1), 0);
    sf_plan_free(&plan);
}

static void runs_are_looked_at_again_when_what_they_read_has_changed(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60); /* contents of a file */
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 0);
    f.changed = true; /* what only the engine sees */
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 61);
    sf_plan_free(&plan);
}

/* The report of the rows as they were goes before the table turns to other inputs or another plan, or begins
 * anew, also if the campaign is then interrupted; it stays while nothing changes. */
static void an_old_report_does_not_stand_beside_another_table(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", "sweep.json", NULL};
    static const struct {
        const char *removed;
        uint64_t inputs;
        bool other, stays;
        int64_t calls;
    } steps[] = {
        {"", 1, false, true, 0},           {"", 2, false, false, 60},          {"", 2, false, true, 0},
        {"runs.csv", 2, false, false, 60}, {"sweep.key", 2, false, false, 60}, {"", 2, true, false, 1}};
    sf_plan plan, other;
    formula f = {.fails = -1};
    const sf_sweep_engine engine = {evaluate, &f, 7, NULL};
    finish_grid(p, &plan, &f);
    read_plan(p, "{ key = \"a.x\"; values = [1, 2]; }, { key = \"a.y\"; values = [1]; }", &other);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        const sf_sweep_campaign c = {.plan = steps[k].other ? &other : &plan,
                                     .folder = p->folder,
                                     .inputs = steps[k].inputs,
                                     .report = report,
                                     .force = steps[k].other};
        f.calls = 0;
        f.stop_at = steps[k].other ? 1 : 0;
        program_shell(p, "touch report.html sweep.json; rm -f ./%s", steps[k].removed);
        assert_int_equal(sf_runs_create(c.plan, &runs, &err), SF_OK);
        assert_int_equal(sf_sweep_campaign_run(&c, &engine, &runs, &err),
                         steps[k].other ? SF_INTERRUPTED : SF_OK);
        assert_int_equal(f.calls, steps[k].calls);
        for (int r = 0; r < 2; r++)
            assert_int_equal(access(program_path(p, report[r]), F_OK) == 0, steps[k].stays);
        sf_runs_free(&runs);
    }
    sf_plan_free(&other);
    sf_plan_free(&plan);
}

/* Of the sixth folder, which ten rows name; without all of them nothing begins. */
static void results_that_were_removed_are_made_again(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *made;
        sf_status status;
        int64_t calls;
    } steps[] = {{"0 1 2 3 4 5", SF_OK, 0}, {"0 1 2 3 4", SF_OK, 10}, {"", SF_ERR_INPUT, 0}};
    sf_plan plan;
    formula f = {.fails = -1};
    const sf_sweep_engine engine = {evaluate, &f, 7, NULL};
    char drops[600];
    snprintf(drops, sizeof drops, "%s/drops", p->folder);
    finish_grid(p, &plan, &f);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        const sf_sweep_campaign c = {.plan = &plan, .folder = p->folder, .inputs = 1, .drops = drops};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        f.calls = 0;
        program_shell(
            p,
            "rm -rf drops; for d in %s; do mkdir -p drops/drop-$d; touch drops/drop-$d/results.h5; done; mkdir -p drops",
            steps[k].made);
        assert_int_equal(sf_runs_create(&plan, &runs, &err), SF_OK);
        assert_int_equal(sf_sweep_campaign_run(&c, &engine, &runs, &err), steps[k].status);
        assert_true(!err.text[0] || strstr(err.text, "drops has the results of none of them"));
        assert_int_equal(f.calls, steps[k].calls);
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

/* The first sample had to be simulated, the second could not: neither the other rows nor the report are those
 * of the files as they are. The same if the inputs change while the campaign runs. */
static void a_campaign_that_ends_early_after_a_change_leaves_no_row_and_no_report(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", NULL};
    for (int k = 0; k < 2; k++) {
        sf_plan plan;
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        formula f = {.fails = -1};
        const sf_sweep_engine engine = {evaluate, &f, 7, NULL};
        read_plan(p, "{ key = \"geometry.x\"; values = [1, 2, 3]; }, { key = \"a.y\"; values = [1, 2]; }",
                  &plan);
        program_shell(p, "rm -f runs.csv sweep.key");
        rows_done(p, &plan, &f, false, 1);
        const sf_sweep_campaign c = {.plan = &plan,
                                     .folder = p->folder,
                                     .inputs = 1,
                                     .look = k == 1 ? look_at_inputs : NULL,
                                     .report = report};
        f = (formula){.fails = -1, .changed = k == 0, .stop_at = k == 0 ? 1 : 0};
        present_inputs = k == 1 ? 99 : 1;
        program_shell(p, "touch report.html");
        assert_int_equal(sf_runs_create(&plan, &runs, &err), SF_OK);
        assert_int_equal(sf_sweep_campaign_run(&c, &engine, &runs, &err),
                         k == 0 ? SF_INTERRUPTED : SF_ERR_IO);
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), 6);
        assert_int_equal(access(program_path(p, "report.html"), F_OK), -1);
        assert_int_equal(program_shell(p, "grep -c ',open,' runs.csv").out[0], '6');
        sf_runs_free(&runs);
        sf_plan_free(&plan);
    }
}

/* A run that failed may have read what has changed, too. */
static void a_failed_run_is_looked_at_again_when_what_only_the_geometry_reads_has_changed(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    f.changed = true;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(runs.state[3], SF_SWEEP_DONE);
    assert_int_equal(sf_runs_count(&runs, SF_SWEEP_DONE), 60);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* There is no finished run by which a change of its files would show. */
static void failed_runs_of_a_geometry_without_a_finished_one_are_looked_at_again(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = 1};
    read_plan(p,
              "{ key = \"geometry.parameters.thickness\"; values = [40, 50, 60]; },"
              "{ key = \"a.y\"; values = [1]; }",
              &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 3);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 1);
    f.fails = -1;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 1);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 0);
    sf_plan_free(&plan);
}

/* Rows before and after the change are not mixed, also where the inputs are put back before the next start,
 * and where the campaign was interrupted meanwhile. */
static void inputs_that_change_while_it_runs_leave_no_row(void **state) {
    const program_place *p = *state;
    for (int64_t stop_at = 0; stop_at < 80; stop_at += 40) {
        sf_plan plan;
        sf_runs runs;
        sf_error err;
        formula f = {.fails = 3, .edits_at = 25, .stop_at = stop_at};
        read_plan(p, GRID, &plan);
        program_shell(p, "rm -f runs.csv sweep.key");
        assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), stop_at ? SF_INTERRUPTED : SF_ERR_IO);
        if (!stop_at)
            assert_non_null(strstr(err.text, "the inputs of the campaign changed while it ran"));
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), 60);
        sf_runs_free(&runs);
        f.edits_at = f.stop_at = 0;
        assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
        sf_plan_free(&plan);
    }
}

/* As a spreadsheet saves it: rows in another order, a figure or a level with fewer digits. */
/* Of each geometry the first and the last row that is done: a failed one is none. */
static void a_geometry_that_changes_while_it_runs_leaves_no_row(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", NULL};
    static const struct {
        int64_t stale;
        sf_status status;
    } steps[] = {{-1, SF_OK}, {6, SF_ERR_IO}, {10, SF_ERR_IO}, {11, SF_OK}, {8, SF_OK}};
    sf_plan plan;
    read_plan(p,
              "{ key = \"geometry.parameters.x\"; from = 1.0; to = 4.0; count = 10; },"
              "{ key = \"a.y\"; uncertain = true; values = (1, 2, 3, 4, 5, 6); }",
              &plan);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        formula f = {.fails = 11, .stale = steps[k].stale};
        const sf_sweep_engine engine = {evaluate, &f, 7, is_current};
        const sf_sweep_campaign c = {.plan = &plan, .folder = p->folder, .inputs = 1, .report = report};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        program_shell(p, "rm -f runs.csv sweep.key; touch report.html");
        assert_int_equal(sf_runs_create(&plan, &runs, &err), SF_OK);
        assert_int_equal(sf_sweep_campaign_run(&c, &engine, &runs, &err), steps[k].status);
        assert_true(!err.text[0] || strstr(err.text, "includes or merges, or its result, changed while"));
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), err.text[0] ? 60 : 0);
        assert_int_not_equal(access(program_path(p, "report.html"), F_OK), 0);
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

static void a_table_that_was_edited_is_not_believed(void **state) {
    const program_place *p = *state;
    static const char *const edits[] = {
        "(head -1 runs.csv; tail -n +2 runs.csv | sort -r) > new", "sed '5s/933.333333/933/' runs.csv > new",
        "sed '8s/1.33333333333/1.33/' runs.csv > new", "sed '$d' runs.csv > new"};
    for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++) {
        sf_plan plan;
        formula f = {.fails = -1};
        finish_grid(p, &plan, &f);
        program_bytes whole = program_read_file(program_path(p, "runs.csv"));
        assert_int_equal(program_shell(p, "%s && ! cmp new runs.csv && mv new runs.csv", edits[k]).code, 0);
        if (rows_done(p, &plan, &f, false, 1) != 60)
            fail_msg("after %s rows are believed", edits[k]);
        program_assert_unchanged(program_path(p, "runs.csv"), &whole);
        sf_plan_free(&plan);
    }
}

/* Few drops for each job would leave processors idle at the end of each piece. */
static void a_piece_has_as_many_rows_for_each_job(void **state) {
    (void)state;
    sf_runner runner = {.threads = 1};
    assert_int_equal(sf_sweep_drops(&runner, 1).piece, 32);
    assert_int_equal(sf_sweep_drops(&runner, 64).piece, 64 * 32);
}

/* In a process of its own, which may write files of so many bytes (0: any). */
static void run_in_child(const program_place *p, const sf_plan *plan, formula f, uint64_t inputs,
                         rlim_t most) {
    pid_t child = fork();
    if (child == 0) {
        const struct rlimit limit = {most, most};
        sf_runs runs;
        sf_error err;
        signal(SIGXFSZ, SIG_IGN);
        if (most > 0)
            setrlimit(RLIMIT_FSIZE, &limit);
        campaign(p, plan, &f, false, inputs, &runs, &err);
        _exit(0);
    }
    waitpid(child, NULL, 0);
}

/* Killed after it has found that what only the engine sees has changed, in the sample or in the first run
 * after it: the sample is there now, the other rows are not. */
static void a_killed_look_leaves_no_old_figures(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    read_plan(p, GRID, &plan);
    for (int dies_at = 1; dies_at < 3; dies_at++) {
        program_shell(p, "rm -f runs.csv sweep.key");
        formula f = {.fails = -1};
        rows_done(p, &plan, &f, false, 1);
        run_in_child(p, &plan, (formula){.fails = -1, .changed = true, .dies_at = dies_at}, 1, 0);
        f.other = 1;
        assert_true(rows_done(p, &plan, &f, false, 1) >= 60);
    }
    sf_plan_free(&plan);
}

/* Equal rows have one folder. While the sample (row 0) is looked at, 6 and 12, which find its folder, are
 * open with it, as are 1, 7 and 13 with that of the second geometry: the next start takes others. */
static void a_killed_look_leaves_no_row_by_whose_folder_nothing_would_show(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    read_plan(p,
              "{ key = \"geometry.x\"; values = [1, 2]; },"
              "{ key = \"a.y\"; values = [1, 2, 3, 4, 5, 6, 7]; }",
              &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 14);
    run_in_child(p, &plan, (formula){.fails = -1, .changed = true, .dies_at = 1}, 1, 0);
    assert_string_equal(program_shell(p, "grep ',open,' runs.csv | cut -d, -f1 | paste -sd' '").out,
                        "1 2 7 8 13 14\n");
    sf_plan_free(&plan);
}

/* The key of new inputs is small enough for the disk, the table is not. */
static void a_table_that_cannot_be_written_is_not_that_of_new_inputs(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    run_in_child(p, &plan, f, 2, 400);
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60);
    sf_plan_free(&plan);
}

/* Only 64 were looked at. */
static void each_geometry_is_looked_at(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    read_plan(p,
              "{ key = \"geometry.parameters.thickness\"; from = 40.0; to = 60.0; count = 90; },"
              "{ key = \"a.y\"; values = [1, 2]; }",
              &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 180);
    f.other = 178;
    assert_true(rows_done(p, &plan, &f, false, 1) >= 180);
    f.other = 180;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 0);
    sf_plan_free(&plan);
}

static void the_folder_of_another_plan_is_refused(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    sf_plan_free(&plan);
    program_bytes before = program_read_file(program_path(p, "runs.csv"));
    read_plan(p, "{ key = \"a.x\"; values = [1.0, 2.0]; }, { key = \"a.y\"; values = [1]; }", &plan);
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "holds the runs of another plan"));
    sf_runs_free(&runs);
    sf_plan_free(&plan);
    program_assert_unchanged(program_path(p, "runs.csv"), &before);
}

/* Counts: below at x <= 3 (hic 1000 at 3), all of y alike. */
static void the_probability_is_over_what_is_uncertain(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    sf_error err;
    formula f = {.fails = 3};
    read_plan(p, GRID, &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(sf_analysis_make(&runs, &a, &err), SF_OK);
    assert_int_equal(a.probability.cells, 10);
    for (int k = 0; k < 10; k++) {
        const sf_probability *hic = &a.probability.cell[a.probability.cells + k];
        double x = 1 + 3 * k / 9.0;
        assert_int_equal(hic->unknown, k == 0);
        assert_int_equal(hic->below, x < 3 - 1e-9 ? 6 - (k == 0) : 0);
        assert_int_equal(hic->above, x < 3 - 1e-9 ? 0 : 6);
    }
    sf_analysis_free(&a);
    sf_runs_free(&runs);
    f.fails = -1; /* whole, so that means are over the same rows: a_max moves by 100 with x, by 5/3 with y */
    assert_int_equal(campaign(p, &plan, &f, true, 1, &runs, &err), SF_OK);
    assert_int_equal(sf_analysis_make(&runs, &a, &err), SF_OK);
    assert_relative(a.effect[0][0].last - a.effect[0][0].first, 100, 1e-8);
    assert_relative(a.effect[0][1].high - a.effect[0][1].low, 5.0 / 3, 1e-6);
    assert_true(a.surface[1].fit.q2 > 0.999999); /* hic is linear */
    sf_analysis_free(&a);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* Of 40,000 rows every second one would be of the same level of the factor that changes fastest. */
static void a_surface_of_very_many_rows_has_every_level(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    sf_error err;
    formula f = {.fails = -1};
    read_plan(p,
              "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }",
              &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(sf_analysis_make(&runs, &a, &err), SF_OK);
    assert_string_equal(a.surface[1].fit.problem, "");
    assert_int_equal(a.surface[1].rows, SF_SURFACE_ROWS);
    assert_int_equal(a.surface[1].of, 40000);
    assert_true(a.surface[1].fit.q2 > 0.999999); /* hic is linear */
    sf_analysis_free(&a);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* softfall-fit writes draws model by model: some of them must not be the first ones. */
static void draws_are_taken_from_the_whole_posterior(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    static const char *const expected[4] = {"draw-002.cfg", "draw-004.cfg", "draw-007.cfg", "draw-009.cfg"};
    program_shell(p,
                  "mkdir -p ten && for k in 01 02 03 04 05 06 07 08 09 10; do sed 's|eva35.csv|%s|' '%s' > "
                  "ten/draw-0$k.cfg; done",
                  "../eva35.csv", fixture_source("examples/materials/eva35.cfg"));
    program_shell(p, "cp '%s' eva35.csv", fixture_source("examples/materials/eva35.csv"));
    read_plan(p, "{ key = \"material\"; posterior = \"ten\"; draws = 4; }", &plan);
    assert_int_equal(plan.rows, 4);
    for (int64_t row = 0; row < 4; row++) {
        assert_int_equal(sf_plan_overrides(&plan, row, text), 1);
        assert_non_null(strstr(text[0], expected[row]));
    }
    sf_plan_free(&plan);
    read_plan(p, "{ key = \"material\"; posterior = \"ten\"; }", &plan);
    assert_int_equal(plan.rows, 10);
    sf_plan_free(&plan);
}

static const char *const SAMPLED_DRAWS = "{ sample = \"latin_hypercube\"; count = 40; of = ("
                                         "{ key = \"a.x\"; low = 1.0; high = 4.0; },"
                                         "{ key = \"a.y\"; values = [1, 2]; },"
                                         "{ key = \"material\"; posterior = \"ten\"; } ); }";

static void evaluate_plan(const program_place *p, const char *factors, sf_plan *plan, sf_runs *runs,
                          sf_analysis *a) {
    formula f = {.fails = -1};
    sf_error err;
    read_plan(p, factors, plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    if (campaign(p, plan, &f, false, 1, runs, &err) != SF_OK || sf_analysis_make(runs, a, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static void free_evaluated(sf_plan *plan, sf_runs *runs, sf_analysis *a) {
    sf_analysis_free(a);
    sf_runs_free(runs);
    sf_plan_free(plan);
}

/* Ten draws in 40 rows, over the folder of the test before: the means of four runs each are mostly scatter of
 * the other factors. */
static void draws_that_are_sampled_with_others_have_no_main_effect(void **state) {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    evaluate_plan(*state, SAMPLED_DRAWS, &plan, &runs, &a);
    assert_true(isnan(a.effect[0][2].low) && isnan(a.effect[0][2].high));
    assert_true(a.effect[0][0].high > a.effect[0][0].low);
    assert_true(sf_effect_is_scatter(&plan, 2));
    plan.block[plan.block_of[2]].rows = SF_EFFECT_RUNS * plan.factor[2].count; /* so many have a mean */
    assert_false(sf_effect_is_scatter(&plan, 2));
    plan.block[plan.block_of[2]].rows = 40;
    free_evaluated(&plan, &runs, &a);
    evaluate_plan(*state, "{ key = \"a.x\"; values = [1, 2]; }, { key = \"material\"; posterior = \"ten\"; }",
                  &plan, &runs, &a); /* crossed: a_max moves by 9/3 with the index of the draw */
    assert_relative(a.effect[0][1].high - a.effect[0][1].low, 0.9 * 3, 1e-6);
    free_evaluated(&plan, &runs, &a);
}

/* Ten draws in 40 rows are ten foams. */
static void draws_that_are_sampled_count_once_in_the_interval(void **state) {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    evaluate_plan(*state, SAMPLED_DRAWS, &plan, &runs, &a);
    assert_int_equal(a.probability.cells, 1);
    sf_probability ten = a.probability.cell[1];
    assert_int_equal(ten.below + ten.above, 40);
    sf_probability_judge(&ten, 10);
    assert_close(a.probability.cell[1].low, ten.low, 1e-12);
    assert_close(a.probability.cell[1].high, ten.high, 1e-12);
    free_evaluated(&plan, &runs, &a);
}

/* What an estimate counts: rows of other inputs and, on request, those that failed. */
static void an_estimate_counts_the_rows_that_are_done_again(void **state) {
    const program_place *p = *state;
    static const struct {
        uint64_t inputs;
        bool retry;
        int64_t open;
    } cases[] = {{1, false, 0}, {1, true, 1}, {2, false, 60}};
    sf_plan plan;
    formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const sf_sweep_campaign c = {
            .plan = &plan, .folder = p->folder, .inputs = cases[k].inputs, .retry = cases[k].retry};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        int64_t open = -1;
        if (sf_runs_create(&plan, &runs, &err) != SF_OK ||
            sf_sweep_campaign_look(&c, &runs, &open, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_int_equal(open, cases[k].open);
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_DONE), 59); /* they tell the time of a run */
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

/* Six rows of three words. */
static void a_word_that_a_zip_repeats_is_one_level(void **state) {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    evaluate_plan(*state,
                  "{ zip = ( { key = \"a.x\"; values = [1, 1, 1, 4, 4, 4]; },"
                  "{ key = \"pad.base\"; values = [\"glued\", \"glued\", \"smooth\", \"smooth\", \"glued\","
                  " \"resting\"]; } ); }",
                  &plan, &runs, &a);
    static const int level[] = {0, 0, 1, 1, 0, 2};
    assert_int_equal(plan.rows, 6);
    assert_int_equal(plan.factor[1].count, 3);
    for (int64_t row = 0; row < 6; row++)
        assert_int_equal((int)sf_plan_value(&plan, 1, row), level[row]);
    sf_plan_overrides(&plan, 5, text);
    assert_string_equal(text[1], "pad.base=\"resting\"");
    /* of a_max: glued 100, 100, 200; smooth 100 + 1/3, 200 + 1/3; resting 200 + 2/3 */
    assert_relative(a.effect[0][1].low, 400.0 / 3, 1e-8);
    assert_relative(a.effect[0][1].high, 200 + 2.0 / 3, 1e-8);
    free_evaluated(&plan, &runs, &a);
}

/* An array of libconfig has whole or fractional numbers, not both. */
static void a_vector_with_whole_and_fractional_numbers_is_a_value(void **state) {
    sf_plan plan;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    read_plan(*state,
              "{ key = \"missile.direction\"; values = ([0.0, 0.0, -1.0], [0.1, 0.0, -1.0], (0, 0.2, -1)); }",
              &plan);
    sf_plan_overrides(&plan, 1, text);
    assert_string_equal(text[0], "missile.direction=[0.1, 0.0, -1.0]");
    sf_factor_text(&plan.factor[0], 1, text[0], sizeof text[0]);
    assert_string_equal(text[0], "[0.1, 0, -1]"); /* in tables as before */
    if (sf_sweep_check_inputs(&plan, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_plan_free(&plan);
}

/* Scripts and pictures of a campaign, beside runs.csv. */
static void draw(const program_place *p, const sf_analysis *a) {
    static const char *const names[] = {"factors.gp",     "factors.png",     "curves.gp",  "curves.png",
                                        "effects.gp",     "effects.png",     "surface.gp", "surface.png",
                                        "probability.gp", "probability.png", NULL};
    char warning[320];
    sf_staging output = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_staging_begin(program_path(p, "drawn"), names, true, &output, &err) != SF_OK ||
        sf_sweep_plot(&output, a, p->folder, warning, sizeof warning, &err) != SF_OK ||
        sf_staging_commit(&output, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_staging_end(&output);
    assert_string_equal(warning, "");
}

/* Of one run there is no effect, and a figure may be of no run: gnuplot ends where all of a panel is NaN. */
static void panels_without_data_are_left_out(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    evaluate_plan(p, "{ key = \"a.x\"; values = [1]; }, { key = \"a.y\"; values = [1]; }", &plan, &runs, &a);
    draw(p, &a);
    assert_int_equal(program_shell(p, "test -s drawn/factors.png && test ! -e drawn/effects.gp").code, 0);
    free_evaluated(&plan, &runs, &a);
    static const char *const chosen[] = {"", "{ key = \"a.z\"; values = [1, 2]; },"}; /* intervals, a map */
    for (int k = 0; k < 2; k++) {
        char factors[512];
        snprintf(
            factors, sizeof factors,
            "{ key = \"a.x\"; values = [1, 2, 3]; }, %s { key = \"a.y\"; uncertain = true; values = [1, 2]; } );"
            "figures = ( { key = \"peak_stress_kPa\"; limit = 9.0; }, { key = \"hic\"; limit = 1000.0; }",
            chosen[k]);
        evaluate_plan(p, factors, &plan, &runs, &a);
        draw(p, &a);
        assert_int_equal(program_shell(p,
                                       "test -s drawn/factors.png && test -s drawn/effects.png && "
                                       "test -s drawn/probability.png && ! grep peak_stress drawn/effects.gp")
                             .code,
                         0);
        free_evaluated(&plan, &runs, &a);
    }
}

/* Every 14th of 40,000 rows would be of the first level of the factor that changes fastest. */
static void the_points_of_a_picture_are_of_every_level(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    evaluate_plan(
        p, "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }",
        &plan, &runs, &a);
    draw(p, &a);
    int of_one = atoi(program_shell(p, "grep -c '^1,' drawn/factors.gp").out),
        of_two = atoi(program_shell(p, "grep -c '^2,' drawn/factors.gp").out);
    if (of_one + of_two < 2900 || of_one + of_two > 3100 || abs(of_one - of_two) > 300)
        fail_msg("%d and %d points", of_one, of_two);
    free_evaluated(&plan, &runs, &a);
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
    read_plan(p,
              "{ key = \"missile.velocity\"; values = [\"4 m/s\"]; } );"
              "set = ( \"pad.base=glued\", \"material=@foam.cfg\"",
              &plan);
    assert_int_equal(sf_plan_overrides(&plan, 0, text), 3);
    snprintf(expected, sizeof expected, "material=@%s/foam.cfg", p->folder);
    assert_string_equal(text[0], "pad.base=glued");
    assert_string_equal(text[1], expected);
    if (sf_sweep_check_inputs(&plan, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_plan_free(&plan);
}

/* A factor of one number is as good as one of the case. */
static void a_factor_of_one_value_is_not_in_the_surface(void **state) {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    char term[100];
    evaluate_plan(*state,
                  "{ key = \"a.z\"; from = 1.0; to = 4.0; count = 10; }, { key = \"a.y\"; values = [5]; },"
                  "{ key = \"a.x\"; values = [1, 2, 3]; }",
                  &plan, &runs, &a);
    const sf_quadratic *fit = &a.surface[1].fit;
    assert_string_equal(fit->problem, "");
    assert_int_equal(fit->d, 2);
    assert_true(fit->q2 > 0.999999); /* hic is linear */
    sf_analysis_term(&a, fit, 2, term, sizeof term);
    assert_string_equal(term, "a.x");
    free_evaluated(&plan, &runs, &a);
}

static void a_disk_that_is_too_small_is_refused(void **state) {
    const program_place *p = *state;
    sf_sweep_cost cost = {.seconds = 1, .bytes = 1e6, .work_bytes = 1e7, .open = 10};
    sf_error err = SF_ERROR_INIT;
    char folder[600];
    snprintf(folder, sizeof folder, "%s/not/there/yet", p->folder);
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_OK);
    cost.open = INT64_C(1000000000000);
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the runs need about 1e+09 GB and the disk of "));
    err = (sf_error)SF_ERROR_INIT;
    cost.there = cost.open - 10; /* they may be drops of another plan */
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_ERR_INPUT);
}

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Plans, runs, interrupts, resumes and evaluates; the drops themselves cost nothing. */
static void a_hundred_thousand_runs_take_less_than_a_minute_and_a_gigabyte(void **state) {
    const program_place *p = *state;
    double begin = seconds();
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    sf_error err;
    formula f = {.fails = 77, .stop_at = 50000};
    struct rusage usage;
    read_plan(p,
              "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 100; },"
              "{ sample = \"sobol\"; count = 1000; of = ( { key = \"a.y\"; low = 0.0; high = 9.0; },"
              "{ key = \"a.z\"; low = \"1 mm\"; high = \"2 mm\"; } ); }",
              &plan);
    program_shell(p, "rm -f runs.csv sweep.key");
    assert_int_equal(plan.rows, 100000);
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
    sf_runs_free(&runs);
    f.stop_at = 0;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(f.calls, 50000);
    assert_int_equal(sf_analysis_make(&runs, &a, &err), SF_OK);
    assert_int_equal(a.done, 99999);
    assert_int_equal(a.probability.cells, 100);
    getrusage(RUSAGE_SELF, &usage);
    print_message("100000 runs: %.1f s, %.0f MB\n", seconds() - begin, (double)usage.ru_maxrss / 1e3);
    assert_true(seconds() - begin < 60);
    assert_true(usage.ru_maxrss < 1000000);
    sf_analysis_free(&a);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_order_is_another_plan),
        cmocka_unit_test(the_last_block_is_the_fastest_and_zipped_lists_go_together),
        cmocka_unit_test(a_material_comes_before_its_keys_and_ranges_hold_both_ends),
        cmocka_unit_test(plans_that_cannot_be_meant_are_refused),
        cmocka_unit_test(keys_and_units_that_a_case_does_not_take_are_refused),
        cmocka_unit_test(values_that_are_zipped_are_checked_together),
        cmocka_unit_test(the_inputs_are_known_by_their_contents),
        cmocka_unit_test(geometries_of_one_text_in_two_folders_are_refused),
        cmocka_unit_test(a_latin_hypercube_has_one_point_in_each_stratum),
        cmocka_unit_test(the_sobol_sequence_begins_as_it_is_known_and_has_its_limit),
        cmocka_unit_test(a_sample_of_saltelli_mixes_two_samples),
        cmocka_unit_test(a_seed_moves_the_sobol_sequence),
        cmocka_unit_test(distributions_have_their_quantiles),
        cmocka_unit_test(indices_of_ishigami_lie_in_their_intervals),
        cmocka_unit_test(a_response_surface_is_exact_for_a_quadratic),
        cmocka_unit_test(the_error_at_rows_left_out_is_that_of_surfaces_without_them),
        cmocka_unit_test(repeated_rows_are_left_out_together),
        cmocka_unit_test(a_surface_that_needs_every_place_has_no_known_error),
        cmocka_unit_test(a_surface_that_the_rows_do_not_determine_says_so),
        cmocka_unit_test(probabilities_have_the_interval_of_their_counts),
        cmocka_unit_test(an_interrupted_campaign_goes_on_with_the_same_table),
        cmocka_unit_test(a_failed_run_keeps_its_sentence_and_is_done_again_on_request),
        cmocka_unit_test(an_old_report_does_not_stand_beside_another_table),
        cmocka_unit_test(results_that_were_removed_are_made_again),
        cmocka_unit_test(a_campaign_that_ends_early_after_a_change_leaves_no_row_and_no_report),
        cmocka_unit_test(runs_are_looked_at_again_when_what_they_read_has_changed),
        cmocka_unit_test(a_failed_run_is_looked_at_again_when_what_only_the_geometry_reads_has_changed),
        cmocka_unit_test(failed_runs_of_a_geometry_without_a_finished_one_are_looked_at_again),
        cmocka_unit_test(inputs_that_change_while_it_runs_leave_no_row),
        cmocka_unit_test(a_geometry_that_changes_while_it_runs_leaves_no_row),
        cmocka_unit_test(a_table_that_was_edited_is_not_believed),
        cmocka_unit_test(a_piece_has_as_many_rows_for_each_job),
        cmocka_unit_test(the_folder_of_another_plan_is_refused),
        cmocka_unit_test(the_probability_is_over_what_is_uncertain),
        cmocka_unit_test(a_killed_look_leaves_no_old_figures),
        cmocka_unit_test(a_killed_look_leaves_no_row_by_whose_folder_nothing_would_show),
        cmocka_unit_test(a_table_that_cannot_be_written_is_not_that_of_new_inputs),
        cmocka_unit_test(each_geometry_is_looked_at),
        cmocka_unit_test(a_surface_of_very_many_rows_has_every_level),
        cmocka_unit_test(draws_are_taken_from_the_whole_posterior),
        cmocka_unit_test(draws_that_are_sampled_with_others_have_no_main_effect),
        cmocka_unit_test(draws_that_are_sampled_count_once_in_the_interval),
        cmocka_unit_test(an_estimate_counts_the_rows_that_are_done_again),
        cmocka_unit_test(a_word_that_a_zip_repeats_is_one_level),
        cmocka_unit_test(a_vector_with_whole_and_fractional_numbers_is_a_value),
        cmocka_unit_test(panels_without_data_are_left_out),
        cmocka_unit_test(the_points_of_a_picture_are_of_every_level),
        cmocka_unit_test(a_file_of_set_is_relative_to_the_plan),
        cmocka_unit_test(a_factor_of_one_value_is_not_in_the_surface),
        cmocka_unit_test(a_disk_that_is_too_small_is_refused),
        cmocka_unit_test(a_hundred_thousand_runs_take_less_than_a_minute_and_a_gigabyte),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
