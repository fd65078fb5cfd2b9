/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Later drops of a series as data of softfall-fit drop: what they tell of the memory, by columns and by the
 * program; predictions of them; refusals. */
#include "extreme.h"
#include "fit_fixture.h"
#include "laboratory.h"
#include "post_check.h"
#include "study/fit/drop/inference.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* The case of the fixture as three drops on one pad, whose foam remembers. */
static void put_case(const program_place *place) {
    fit_fixture_put_case(place);
    program_shell(
        place,
        "echo 'series: { drops = ( {}, { interval = \"5 s\"; }, { interval = \"2 hour\"; } ); };' "
        ">> case.cfg; sed -i \"s|4.5 m/s|2 m/s|; s|40 ms|150 ms|\" case.cfg; sed -i \"s|HU = 0.01|HU = 0.15|\" start.cfg; cp start.cfg plain.cfg; echo 'ALPHA = 0.5; memory: { reload = 0.3; "
        "recovery = 0.08; };' >> start.cfg");
}

/* ---- columns as truth ---- */

enum { DROPS = 3, UNKNOWNS = 3, NOISES = 5, ROWS = DROPS * (SF_FIT_SAMPLES + 1) };
static const double truth[UNKNOWNS] = {1.15, 0.45, 0.12}; /* stress_scale, reload, recovery */
static const double SD[2] = {0.01, 0.02}, SPEED = 3;      /* m s-1 */

/* A foam in a laboratory, whose simulation is a set of stiffer and thinner columns than the surrogate. */
typedef struct bench {
    sf_fit_input in;
    sf_drop_fit fit;
    sf_columns real[DROPS];
    double measured[ROWS], sd[ROWS], y[ROWS];
} bench;

static sf_columns hemisphere(const sf_fit_drop *drop, double area, double thinner) {
    sf_columns c = {
        .mass = 4.6, .speed = SPEED, .thickness = 0.07 * thinner, .count = 15, .before = drop->number - 1};
    memcpy(c.pause, drop->pause, sizeof c.pause);
    for (int k = 0; k < c.count; k++) {
        c.gap[k] = 0.07 * (k + 0.5) / c.count;
        c.area[k] = area * 2 * M_PI * (0.08 - c.gap[k]) * 0.07 / c.count;
    }
    return c;
}

static sf_status surrogate(void *context, const double *u, double *y, sf_error *err) {
    const bench *b = context;
    return laboratory_respond(&b->fit, b->fit.columns, DROPS, b->fit.measured_drops, u, y, err);
}

static sf_status simulate(void *context, const double *u, double *y, sf_error *err) {
    const bench *b = context;
    return laboratory_respond(&b->fit, b->real, DROPS, b->fit.measured_drops, u, y, err);
}

/* The first `measured` drops are data. */
static void begin(const program_place *place, int measured, bench *b) {
    sf_error err = SF_ERROR_INIT;
    *b = (bench){.in = {.drop_count = 0}};
    program_write_text(
        place, "fit.cfg",
        "material = \"start.cfg\"; curve_form = \"table\"; unknown = ( { name = \"stress_scale\"; }, "
        "{ name = \"reload\"; }, { name = \"recovery\"; } );\n"
        "drops = ( { case = \"case.cfg\"; drop = 1; HIC = 3.0; }, { case = \"case.cfg\"; drop = 2; "
        "HIC = 3.0; }, { case = \"case.cfg\"; drop = 3; HIC = 3.0; } );\n");
    if (sf_fit_input_read(program_path(place, "fit.cfg"), 0, &b->in, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(b->in.drop[2].number == 3 && b->in.drop[2].pause[0] == 5 && b->in.drop[2].pause[1] == 7200);
    b->fit = (sf_drop_fit){.input = &b->in,
                           .measured_drops = measured,
                           .parameters = UNKNOWNS,
                           .measured = b->measured,
                           .sd = b->sd,
                           .y = b->y};
    for (int d = 0; d < DROPS; d++) {
        sf_fit_drop *drop = &b->in.drop[d];
        b->fit.row[d + 1] = b->fit.row[d] + SF_FIT_SAMPLES + 1;
        b->fit.speed[d] = -1;
        b->fit.columns[d] = hemisphere(drop, 1, 1);
        b->real[d] = hemisphere(drop, 1.1, 0.97);
        drop->predicted = d >= measured;
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            drop->value[kind] = NAN;
    }
}

static void measure_and_map(bench *b, gsl_rng *random) {
    double u[UNKNOWNS], y[ROWS], prior[UNKNOWNS];
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < UNKNOWNS; k++) {
        u[k] = log(truth[k]);
        prior[k] = log(b->in.prior[k]);
    }
    assert_int_equal(laboratory_respond(&b->fit, b->real, DROPS, DROPS, u, y, &err), SF_OK);
    for (int k = 0; k < ROWS; k++)
        b->sd[k] = INFINITY;
    for (int d = 0; d < DROPS; d++)
        for (int kind = 0; kind < 2; kind++) {
            int row = b->fit.row[d] + kind;
            b->measured[row] = y[row] + SD[kind] * gsl_ran_ugaussian(random);
            if (!b->in.drop[d].predicted)
                b->sd[row] = SD[kind];
        }
    const sf_mapping_problem p = {.parameters = UNKNOWNS,
                                  .responses = b->fit.row[b->fit.measured_drops],
                                  .start = prior,
                                  .prior = prior,
                                  .prior_sd = b->in.prior_sd,
                                  .measured = b->measured,
                                  .sd = b->sd,
                                  .surrogate = surrogate,
                                  .simulate = simulate,
                                  .context = b,
                                  .max_iterations = 12,
                                  .tolerance = 0.1};
    if (sf_mapping_solve(&p, &b->fit.result, &err) != SF_OK ||
        laboratory_respond(&b->fit, b->real, DROPS, DROPS, b->fit.result.u, b->y, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* The chains' 95 % interval of a_max of the third drop, predicted from the first two; true if it holds what
 * the true foam has. */
static bool predicts_third(const bench *b, double *width) {
    static const double ends[2] = {0.025, 0.975};
    sf_drop_inference inference;
    sf_drop_average average;
    const sf_drop_inference *list = &inference;
    sf_inference_options o = sf_inference_defaults(1);
    sf_error err = SF_ERROR_INIT;
    double value[2], u[UNKNOWNS], y[ROWS];
    o.chains.burn_in_rounds = 2;
    o.chains.round = o.chains.most_steps = 80;
    o.evidence_draws = 50;
    o.leave_one_out = false;
    for (int k = 0; k < UNKNOWNS; k++)
        u[k] = log(truth[k]);
    if (sf_drop_infer(&b->fit, &o, &inference, &err) != SF_OK ||
        sf_drop_average_build(1, &list, 1, &average, &err) != SF_OK ||
        sf_drop_average_quantiles(&average, -1, 0, 2, ends, value, &err) != SF_OK ||
        laboratory_respond(&b->fit, b->real, DROPS, DROPS, u, y, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(inference.quantity[0].drop == 2 && inference.quantity[0].kind == SF_FIT_A_MAX);
    double held = exp(y[b->fit.row[2]]);
    print_message("third drop: %.2f g, predicted %.2f to %.2f g\n", held, value[0], value[1]);
    *width = log(value[1] / value[0]);
    sf_drop_inference_free(&inference);
    return value[0] < held && held < value[1];
}

/* A hidden reload and recovery are found from three peaks with a short and a long rest between them; the
 * first peak alone tells nothing of them. */
static void later_peaks_tell_the_memory(void **state) {
    const program_place *place = *state;
    bench *b = malloc(sizeof *b);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    double sd[DROPS + 1][UNKNOWNS] = {{0}}, width = 0;
    int inside = 0;
    assert_true(b && random);
    for (int measured = 1; measured <= DROPS; measured++)
        for (int n = 0; n < (measured < DROPS ? 1 : NOISES); n++) {
            begin(place, measured, b);
            gsl_rng_set(random, 1 + (unsigned long)n);
            measure_and_map(b, random);
            for (int k = 0; k < UNKNOWNS; k++) {
                sd[measured][k] = sqrt(b->fit.result.covariance[k][k]);
                inside +=
                    measured == DROPS && fabs(b->fit.result.u[k] - log(truth[k])) < 1.96 * sd[measured][k];
            }
            if (measured == 2)
                assert_true(predicts_third(b, &width));
            sf_mapping_free(&b->fit.result);
            sf_fit_input_free(&b->in);
        }
    print_message("inside %d of %d; sd of reload %.3f, %.3f, %.3f and of recovery %.3f, %.3f, %.3f\n", inside,
                  NOISES * UNKNOWNS, sd[1][1], sd[2][1], sd[3][1], sd[1][2], sd[2][2], sd[3][2]);
    assert_true(inside >= NOISES * UNKNOWNS * 85 / 100);
    assert_true(sd[1][1] > 0.99 * 0.5 && sd[1][2] > 0.99); /* the priors */
    assert_true(sd[3][1] < 0.3 * sd[1][1] && sd[3][2] < 0.3 * sd[1][2] && sd[3][2] < 0.7 * sd[2][2]);
    assert_true(width > 0 && width < 0.5);
    gsl_rng_free(random);
    free(b);
}

/* ---- program ---- */

static double number(const char *text, int row, int column) {
    for (; row > 0; row--)
        text = strchr(text, '\n') + 1;
    for (; column > 0; column--)
        text = strchr(text, ',') + 1;
    return strtod(text, NULL);
}

/* Two measured drops of a simulated series give its foam back, and the third drop; the series of an iterate
 * is simulated once. */
static void a_simulated_series_is_identified(void **state) {
    const program_place *place = *state;
    char text[1024];
    program_succeed(place, "pre",
                    "case.cfg -o m.h5 --set material=@start.cfg --set material.memory.reload=0.45 --set "
                    "material.E='\"0.47 MPa\"' --set material.curve=stiff.csv");
    program_succeed(place, "solve", "m.h5 -o r.h5 --threads 1");
    program_succeed(place, "post", "series r.h5 -o series");
    program_bytes csv = program_read_file(program_path(place, "series/series.csv"));
    const double peak[DROPS] = {number(csv.data, 1, 2), number(csv.data, 2, 2), number(csv.data, 3, 2)};
    free(csv.data);
    snprintf(
        text, sizeof text,
        "material = \"start.cfg\"; posterior = false; curve_form = \"table\"; unknown = ( { name = \"stress_scale\"; }, { name = "
        "\"reload\"; } ); start: { E = \"0.47 MPa\"; };\n"
        "drops = ( { name = \"first\"; case = \"case.cfg\"; drop = 1; a_max_g = %.9g; a_max_sd = 0.005; },\n"
        "{ name = \"second\"; case = \"case.cfg\"; drop = 2; a_max_g = %.9g; a_max_sd = 0.005; } );\n"
        "predict = ( { name = \"third\"; case = \"case.cfg\"; drop = 3; } );\n",
        peak[0], peak[1]);
    program_write_text(place, "fit.cfg", text);
    program_result r = program_succeed(place, "fit", "drop fit.cfg -o out -t 1");
    print_message("%s", strstr(r.out, "\nConverged"));
    program_bytes json = program_read_file(program_path(place, "out/fit.json"));
    static const double hidden[2] = {1.12, 0.45};
    const char *at = strstr(json.data, "\"parameters\":");
    for (int k = 0; k < 2; k++) {
        double low = program_json_number(at, NULL, "low95_SI"),
               high = program_json_number(at, NULL, "high95_SI");
        assert_true(low < hidden[k] && hidden[k] < high && high < 1.5 * low);
        at = strstr(at, "\"high95_SI\":") + 1;
    }
    const char *third = strstr(json.data, "\"name\": \"third\"");
    assert_true(program_json_number(third, NULL, "drop_of_series") == 3);
    assert_relative(program_json_number(third, NULL, "a_max_g"), peak[2], 0.01);
    assert_true(program_json_number(third, NULL, "a_max_sd_by_parameters") > 1e-4);
    free(json.data);
    assert_int_equal(
        program_shell(place, "grep -q 'reload = 0\\.4[0-9]' out/material.cfg && ! ls -d out/runs/second-* "
                             "out/runs/third-* 2>&1 | grep -v 'No such'")
            .code,
        0);
    r = program_succeed(place, "fit", "drop fit.cfg -o out -t 1 --force");
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
}

static void wrong_series_get_one_sentence(void **state) {
    static const struct {
        const char *drop, *more, *sentence;
    } bad[] = {
        {"case = \"case.cfg\"; ", "", "series.drops = 3: say which of them it is by its number"},
        {"case = \"case.cfg\"; drop = 4; ", "",
         "series.drops = 3: its key drop, the number in the series, is larger"},
        {"case = \"one.cfg\"; drop = 2; ", "", "the case has no series: leave out its key drop"},
        {"case = \"one.cfg\"; drop = 1; ", "", "the case has no series: leave out its key drop"},
        {"case = \"first.cfg\"; drop = 1; ", "",
         "takes a series whose drops have one missile, speed and place"},
        {"case = \"case.cfg\"; drop = 0; ", "", "drop is 0, outside 1 to 20"},
        {"case = \"case.cfg\"; drop = 1.5; ", "", "it must be a whole number"},
        {"case = \"case.cfg\"; drop = \"second\"; ", "", "drop must be a"},
        {"case = \"case.cfg\"; drop = 2; speed_sd = 0.01; ", "", "speed_sd is for single drops only"},
        {"case = \"case.cfg\"; drop = 2; ", "material = \"kept.cfg\";", "the columns know no permanent set"},
        {"case = \"list.cfg\"; drop = 2; ", "",
         "takes a series whose drops have one missile, speed and place"},
        {"case = \"case.cfg\"; drop = 2; ", "material = \"plain.cfg\";", "is of a series, but the foam of"},
        {"case = \"case.cfg\"; drop = 2; ", "unknown = ( { name = \"drift\"; } );",
         "drift is 0 in the start material"},
        {"case = \"case.cfg\"; drop = 2; ", "start: { reload = 1.5; };", "reload is 1.5, outside"},
        {"case = \"case.cfg\"; drop = 2; ", "start: { HU = 1.0; };",
         "HU is 1, but a foam without hysteresis"},
        {"case = \"one.cfg\"; ", "material = \"plain.cfg\"; start: { drift = 0.3; };",
         "drift is the fall of reload"},
    };
    const program_place *place = *state;
    program_shell(
        place,
        "sed 's/^series.*//' case.cfg > one.cfg; sed 's/reload = /set = 0.05; &/' start.cfg > kept.cfg; sed 's/5 s\";/&velocity = \"3 m\\/s\";/' case.cfg > "
        "list.cfg; sed 's/^series.*/series: { drops = ( { velocity = \"3 m\\/s\"; }, { interval = \"5 s\"; } "
        "); };/' case.cfg > first.cfg");
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char text[512];
        snprintf(text, sizeof text, "%s %s drops = ( { name = \"a\"; %s a_max_g = 60.0; } );\n",
                 strstr(bad[k].more, "material") ? "" : "material = \"start.cfg\";", bad[k].more,
                 bad[k].drop);
        program_write_text(place, "bad.cfg", text);
        program_result r = program_run(place, "fit", "drop bad.cfg -o bad");
        if (r.code == 0 || !strstr(r.err, bad[k].sentence) || strchr(r.err, '\n') != strrchr(r.err, '\n'))
            fail_msg("%s\nexit code %d, expected \"%s\", got: %s", text, r.code, bad[k].sentence, r.err);
    }
}

static int set_up(void **state) {
    const program_place *place = program_group_set_up(state);
    put_case(place);
    program_shell(place, "awk -F, 'NR > 1 { $0 = $1 \",\" 1.12 * $2 } 1' start.csv > stiff.csv");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_series_get_one_sentence),
        cmocka_unit_test(later_peaks_tell_the_memory),
        cmocka_unit_test(a_simulated_series_is_identified),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
