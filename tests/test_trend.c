/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns of few drops on coarse pads that predict rows: columns that are learnt from the drops, and coarse
 * drops in place of columns. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include "base/units.h"
#include "study/sweep/adaptive.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define FIGURE(key) "{ key = \"" key "\"; accuracy = 0.04; }"
#define COARSE                                                                                               \
    "coarse = [\"geometry.parameters.fine_spacing=30.0\", \"geometry.parameters.outer_spacing=40.0\"];\n"

/* Thickness, speed and mass of a pad with a spacing of 20 mm; `more`: further keys. */
static void write_plan(const program_place *p, const char *name, const char *more, const char *figures) {
    char text[2048];
    snprintf(text, sizeof text,
             "case = \"%s\";\n"
             "set = [\"geometry.parameters.fine_spacing=20.0\", \"geometry.parameters.outer_spacing=40.0\","
             " \"pad.mesh_error_limit=9.0\"];\n%s"
             "factors = ( { sample = \"latin_hypercube\"; count = 60; seed = 2; of = (\n"
             "{ key = \"geometry.parameters.thickness\"; low = 50.0; high = 80.0; },\n"
             "{ key = \"missile.velocity\"; low = \"3 m/s\"; high = \"4.5 m/s\"; },\n"
             "{ key = \"missile.mass\"; low = \"3.5 kg\"; high = \"5.5 kg\"; } ); } );\n"
             "figures = ( %s );\n",
             fixture_source("examples/eva50-v4.5/case.cfg"), more, figures);
    program_write_text(p, name, text);
}

static int set_up(void **state) {
    sf_error err = SF_ERROR_INIT;
    int result = program_group_folder(state) != 0 || sf_units_hold(&err) != SF_OK;
    write_plan(*state, "plan.cfg", COARSE, FIGURE("a_max_g") ", " FIGURE("hic") ", " FIGURE("v_rebound_m_s"));
    write_plan(*state, "all.cfg", "",
               "{ key = \"a_max_g\"; }, { key = \"hic\"; }, { key = \"v_rebound_m_s\"; }");
    return result;
}

static void refuse(const program_place *p, const char *words) {
    program_result r = program_run(p, "sweep", "wrong.cfg -o wrong --dry-run");
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("%d, not \"%s\": %s", r.code, words, r.err);
}

static void coarse_drops_that_are_none_are_refused(void **state) {
    static const char *const wrong[][2] = {
        {"coarse = [\"geometry.parameters.fine_spacing=20.0\"];\n", "coarse changes nothing of the drops"},
        {"coarse = [];\n", "coarse changes nothing of the drops"},
        {"coarse = [\"geometry.parameters.no_spacing=30.0\"];\n", "no_spacing"},
        {"coarse = [\"missile.velocity=3 m/s\"];\n", "wrong.cfg:3: coarse: missile.velocity is a factor"},
        {"coarse = [\"output.fields=true\"];\n", "coarse: output.fields has no effect in a campaign"},
        {"coarse = \"no list\";\n", "coarse must be a list"}};
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        write_plan(p, "wrong.cfg", wrong[k][0], FIGURE("a_max_g"));
        refuse(p, wrong[k][1]);
    }
    write_plan(p, "wrong.cfg", COARSE, "{ key = \"a_max_g\"; }");
    refuse(p, "give each figure its accuracy");
    assert_int_equal(program_shell(p, "test -e wrong").code, 1);
}

static void a_plan_is_predicted_from_its_coarse_drops(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --dry-run --jobs 2");
    assert_non_null(strstr(r.out, "Coarse drops, from which the rows are predicted: 60 open runs of about "));
    assert_non_null(strstr(r.out, "as accurately as half of what the plan asks)\n60 open runs of about "));
    assert_int_equal(program_shell(p, "test -e out").code, 1);
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, " coarse drops simulated, 0 were there\n"));
    assert_non_null(strstr(r.out, "rows are predicted without columns: coarse drops stand in their place"));
    program_assert_page(p, "out/report.html", "What is predicted is the ratio to coarse drops");
    assert_true(program_file_number(p, "out/sweep.json", "coarse_drops") >= 32);
    assert_in_range((int)program_file_number(p, "out/sweep.json", "predicted"), 5, 16);
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "\n0 coarse drops simulated, 0 were there"));
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
    program_shell(
        p, "sed 's/fine_spacing=30/fine_spacing=35/' plan.cfg > wrong.cfg; cp out/runs.csv predicted.csv");
    r = program_run(p, "sweep", "wrong.cfg -o out");
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "out/coarse holds the runs of another plan"));
}

/* Reads plan and runs of a campaign that has ended, and learns its columns. */
static void learn(const program_place *p, const char *name, sf_plan *plan, sf_runs *runs, sf_sweep_trend *t) {
    static char path[600];
    sf_error err = SF_ERROR_INIT;
    int64_t open;
    snprintf(path, sizeof path, "%s/%s.cfg", p->folder, name);
    if (sf_plan_read(path, false, false, plan, &err) == SF_OK && sf_runs_create(plan, runs, &err) == SF_OK)
        sf_sweep_campaign_status(&(sf_sweep_campaign){.plan = plan, .folder = program_path(p, "out")}, runs,
                                 &open, &err);
    if (err.status == SF_OK)
        sf_sweep_trend_learn(runs, program_path(p, "out/runs"), t, &err);
    if (err.status != SF_OK)
        fail_msg("%s", err.text);
}

/* All rows of the test before are simulated: the predictions are as accurate as asked, and columns know most
 * of how figures change from row to row. */
static void predictions_and_columns_are_near_the_drops(void **state) {
    static const char *const names[] = {"a_max_g", "hic", "v_rebound_m_s", "max_mean_strain",
                                        "max_indentation_mm"};
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_sweep_trend trend;
    sf_error err = SF_ERROR_INIT;
    program_succeed(p, "sweep", "all.cfg -o out --jobs 2");
    program_write_text(
        p, "check.py",
        "import csv\n"
        "for row, drop in zip(csv.DictReader(open('predicted.csv')), csv.DictReader(open('out/runs.csv'))):\n"
        "    for key in ('a_max_g', 'hic', 'v_rebound_m_s') if row['run_status'] == 'predicted' else ():\n"
        "        assert abs(float(row[key]) / float(drop[key]) - 1) < 0.04, (key, row['id'])\n");
    program_result r = program_shell(p, "python3 check.py");
    if (r.code != 0)
        fail_msg("%s", r.err);
    learn(p, "all", &plan, &runs, &trend);
    assert_null(trend.problem);
    assert_true(fabs(trend.thickness[0]) < 1e-4 && fabs(trend.thickness[1] - 1e-3) < 1e-5);
    for (int k = 0; k < 5; k++) {
        double of_drops[3] = {0}, of_ratios[3] = {0}, expected[SF_TRENDS];
        for (int64_t row = 0; row < runs.count; row++) {
            assert_int_equal(sf_sweep_trend_at(&trend, row, expected, &err), SF_OK);
            assert_true(fabs(exp(expected[SF_TREND_TIME]) - 40) < 1e-9);
            double drop = log(sf_runs_place(&runs, row)[sf_runs_figure(names[k])]),
                   ratio = drop - expected[sf_sweep_trend_find(names[k])];
            if (!isfinite(drop)) /* no rebound within 40 ms */
                continue;
            for (int power = 0; power < 3; power++) {
                of_drops[power] += pow(drop, power);
                of_ratios[power] += pow(ratio, power);
            }
        }
        double n = of_drops[0], variance = of_drops[2] / n - pow(of_drops[1] / n, 2),
               left = of_ratios[2] / n - pow(of_ratios[1] / n, 2);
        printf("%s: of a deviation of %.3f columns leave %.4f\n", names[k], sqrt(variance), sqrt(left));
        assert_true(n > 45 && left < variance / 6);
    }
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* Columns follow the diameter of the missile: the area of a sphere below a height h is pi (D h - h^2). */
static void columns_follow_the_diameter_of_the_missile(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_sweep_trend trend;
    program_shell(
        p,
        "sed -e '/^factors/,/^figures/d' all.cfg > sizes.cfg; echo 'factors = ( { key = "
        "\"geometry.missile_parameters.diameter\"; values = [120.0, 140.0, 160.0, 180.0, 200.0]; } );' >> sizes.cfg");
    program_succeed(p, "sweep", "sizes.cfg -o out --jobs 2 --force");
    learn(p, "sizes", &plan, &runs, &trend);
    assert_null(trend.problem);
    assert_true(trend.step > 0 && trend.numbers == 1);
    for (double diameter = 130; diameter < 200; diameter += 20) {
        double area = 0, height = 0;
        for (int k = 0; k < SF_COLUMNS; k++) {
            height += trend.step;
            area += trend.profile[k][0] + trend.profile[k][1] * diameter;
            double sphere = M_PI * (1e-3 * diameter * height - height * height);
            if (height > 0.01)
                assert_true(fabs(area / sphere - 1) < 0.04);
        }
    }
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* LEAP is informed up to a strain of 0.6: columns tell how much of the energy is beyond. */
static void columns_know_the_energy_beyond_the_data(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_sweep_trend trend;
    sf_error err = SF_ERROR_INIT;
    double largest = 0, expected[SF_TRENDS];
    program_shell(
        p,
        "sed -e '/^factors/,/^figures/d' -e \"s,set = .,&\\\"material=@$SF_SOURCE_DIR/examples/materials/leap.cfg\\\"\\,,\" "
        "all.cfg > leap.cfg; echo 'factors = ( { key = \"missile.velocity\"; from = \"3 m/s\"; to = "
        "\"5.5 m/s\"; count = 6; } );' >> leap.cfg");
    program_succeed(p, "sweep", "leap.cfg -o out --jobs 2 --force");
    learn(p, "leap", &plan, &runs, &trend);
    for (int64_t row = 0; row < runs.count; row++) {
        double drop = sf_runs_place(&runs, row)[sf_runs_figure("energy_beyond_data")];
        assert_int_equal(sf_sweep_trend_at(&trend, row, expected, &err), SF_OK);
        print_message("of the energy %.3f is beyond the data, by columns %.3f\n", drop,
                      expected[SF_TREND_BEYOND]);
        assert_true(fabs(drop - expected[SF_TREND_BEYOND]) < 0.15);
        assert_true(expected[SF_TREND_NARROWER + SF_TREND_STRAIN] > 0); /* a smaller area sinks deeper */
        assert_true(expected[SF_TREND_WIDER + SF_TREND_STRAIN] < 0);
        largest = larger(largest, drop);
    }
    assert_true(largest > 0.4);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* The first pad is thinner than the missile is high: the profile is that of the thickest one. */
static void columns_reach_through_the_thickest_pad(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_sweep_trend trend;
    double area = 0;
    program_shell(p, "sed -e '/^factors/,/^figures/d' all.cfg > thick.cfg; echo 'factors = ( { key = "
                     "\"geometry.parameters.thickness\"; values = [50.0, 65.0, 80.0]; } );' >> thick.cfg");
    program_succeed(p, "sweep", "thick.cfg -o out --jobs 2 --force");
    learn(p, "thick", &plan, &runs, &trend);
    assert_null(trend.problem);
    assert_true(trend.step == 0);
    for (int k = 0; k < trend.columns.count; k++)
        area += trend.columns.area[k];
    assert_true(fabs(area / (M_PI * 0.08 * 0.08) - 1) < 0.02);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coarse_drops_that_are_none_are_refused),
        cmocka_unit_test(a_plan_is_predicted_from_its_coarse_drops),
        cmocka_unit_test(predictions_and_columns_are_near_the_drops),
        cmocka_unit_test(columns_follow_the_diameter_of_the_missile),
        cmocka_unit_test(columns_reach_through_the_thickest_pad),
        cmocka_unit_test(columns_know_the_energy_beyond_the_data),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
