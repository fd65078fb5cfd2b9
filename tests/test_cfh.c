/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Critical fall height: crossings of laws whose answer is known, the search on such laws, the rig. */
#include "model_fixture.h"

#include "study/cfh/cfh_report.h"
#include "study/cfh/points.h"
#include "study/cfh/spread.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

enum { POINTS = 7 };

static const double heights[POINTS] = {1.2, 1.4, 1.6, 1.7, 1.9, 2.1, 2.3};

/* ln(value) = ln(level) + slope ln(h / at) + bend ln(h / at)^2: reaches `level` at the height `at`. */
typedef struct law {
    double level, at, slope, bend;
} law;

static double evaluate(const law *l, double height) {
    double d = log(height / l->at);
    return l->level * exp(l->slope * d + l->bend * d * d);
}

static double gaussian(uint64_t *seed) {
    double sum = 0;
    for (int k = 0; k < 12; k++)
        sum += 0.5 * fixture_random(seed); /* variance 1/12 each */
    return sum;
}

static void the_crossing_of_an_exact_quadratic_is_exact(void **state) {
    (void)state;
    static const law laws[] = {{200, 1.63, 1.7, 0.34}, {1000, 2.0, 2.8, -0.6}, {5, 1.25, 0.9, 0}};
    for (size_t q = 0; q < sizeof laws / sizeof laws[0]; q++) {
        double value[POINTS];
        sf_error err = SF_ERROR_INIT;
        sf_cfh_crossing c;
        for (int k = 0; k < POINTS; k++)
            value[k] = evaluate(&laws[q], heights[k]);
        assert_int_equal(sf_cfh_cross("a_max", POINTS, heights, value, laws[q].level, &c, &err), SF_OK);
        assert_int_equal(c.side, SF_CFH_CROSSED);
        assert_relative(c.height, laws[q].at, 1e-9);
        assert_close(c.margin, 0, 1e-6);
        assert_close(c.fit.rms, 0, 1e-9);
        assert_relative(sf_cfh_fit_at(&c.fit, 1.77), evaluate(&laws[q], 1.77), 1e-9);
    }
}

/* 95 % of the intervals of noisy points hold the true crossing; 600 trials scatter by 0.9 %. */
static void the_interval_covers_as_often_as_it_says(void **state) {
    (void)state;
    const law truth = {200, 1.65, 1.7, 0.3};
    const double noise = 0.01;
    enum { TRIALS = 600 };
    uint64_t seed = 7;
    int covered = 0;
    double width = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        double value[POINTS];
        sf_error err = SF_ERROR_INIT;
        sf_cfh_crossing c;
        for (int k = 0; k < POINTS; k++)
            value[k] = evaluate(&truth, heights[k]) * exp(noise * gaussian(&seed));
        if (sf_cfh_cross("a_max", POINTS, heights, value, truth.level, &c, &err) != SF_OK)
            fail_msg("%s", err.text);
        covered += c.low <= truth.at && truth.at <= c.high;
        width += c.margin / TRIALS;
    }
    assert_close((double)covered / TRIALS, 0.95, 0.03);
    assert_true(width > 0.2 * noise && width < 2 * noise); /* neither certain nor useless */
}

/* A law whose far ends are bent away from any quadratic: only what is near the crossing enters. */
static void points_far_from_the_crossing_stay_out(void **state) {
    (void)state;
    const double wide[POINTS] = {0.3, 1.4, 1.6, 1.7, 1.9, 2.1, 5};
    const law truth = {200, 1.65, 1.7, 0.3};
    sf_error err = SF_ERROR_INIT;
    sf_cfh_crossing c;
    double value[POINTS];
    for (int k = 0; k < POINTS; k++)
        value[k] = evaluate(&truth, wide[k]);
    value[0] *= 0.5;
    value[POINTS - 1] *= 3;
    assert_int_equal(sf_cfh_cross("a_max", POINTS, wide, value, truth.level, &c, &err), SF_OK);
    assert_int_equal(c.fit.first, 1);
    assert_int_equal(c.fit.count, POINTS - 2);
    assert_relative(c.height, truth.at, 1e-9);
}

static void limits_outside_the_points_are_no_crossing(void **state) {
    (void)state;
    const law l = {200, 1.65, 1.7, 0.3};
    sf_error err = SF_ERROR_INIT;
    sf_cfh_crossing c;
    double value[POINTS];
    for (int k = 0; k < POINTS; k++)
        value[k] = evaluate(&l, heights[k]);
    assert_int_equal(sf_cfh_cross("a_max", POINTS, heights, value, 1.001 * value[6], &c, &err), SF_OK);
    assert_int_equal(c.side, SF_CFH_NOT_REACHED);
    assert_true(isnan(c.height));
    assert_int_equal(sf_cfh_cross("a_max", POINTS, heights, value, 0.999 * value[0], &c, &err), SF_OK);
    assert_int_equal(c.side, SF_CFH_EXCEEDED);
    assert_true(isnan(c.height));
}

static void points_that_give_no_crossing_are_refused(void **state) {
    (void)state;
    static const struct {
        int count;
        double height[5], value[5];
        sf_status status;
        const char *part;
    } cases[] = {
        {0, {0}, {0}, SF_ERR_INPUT, "no points"},
        {3, {1, 1.5, 2}, {100, 150, 250}, SF_ERR_INPUT, "has 3 points"},
        {5, {1, 1.2, 1.4, 1.6, 1.8}, {100, 150, 140, 220, 250}, SF_ERR_NUMERIC, "falls from 150 at 1.2 m"},
        {5, {1, 1.2, 1.4, 1.6, 1.8}, {300, 250, 200, 150, 100}, SF_ERR_NUMERIC, "falls from 300"},
        {5, {1, 1.2, 1.1, 1.6, 1.8}, {100, 150, 180, 220, 250}, SF_ERR_INPUT, "out of order"},
        {5, {1, 1.2, 1.4, 1.6, 1.8}, {100, 150, -1, 220, 250}, SF_ERR_INPUT, "not above 0"},
        {5, {1, 1.2, 1.4, 1.6, 1.8}, {100, 150, NAN, 220, 250}, SF_ERR_INPUT, "not above 0"},
    };
    for (size_t q = 0; q < sizeof cases / sizeof cases[0]; q++) {
        sf_error err = SF_ERROR_INIT;
        sf_cfh_crossing c;
        assert_int_equal(
            sf_cfh_cross("a_max", cases[q].count, cases[q].height, cases[q].value, 200, &c, &err),
            cases[q].status);
        if (!strstr(err.text, cases[q].part))
            fail_msg("\"%s\" is missing in: %s", cases[q].part, err.text);
        assert_true(isnan(c.height));
    }
}

/* A pad whose figures follow two laws; simulations fail above `collapse`. */
typedef struct pad {
    law a_max, hic;
    double collapse;
    double anvil; /* m, > 0: from there the missile reaches the anvil */
    double lock;  /* m, > 0: the foam locks up, and a_max rises with the 50th power of the height over it */
    double sure;  /* of the figures of a drop above `collapse`, which is not to be used */
} pad;

static sf_cfh_plan plan_from(double first, double max_height) {
    return (sf_cfh_plan){
        .limit = {200, 1000}, .first = first, .max_height = max_height, .max_drops = 8, .unit = 1};
}

/* Simulates the heights of a round. */
static void add_round(const pad *p, const sf_cfh_plan *plan, const sf_cfh_round *round,
                      sf_cfh_points *points) {
    for (int k = 0; k < round->count; k++) {
        double height = round->height[k];
        sf_cfh_point point = {.height = height, .failed = height > p->collapse};
        point.value[SF_CFH_A_MAX] = evaluate(&p->a_max, height);
        point.value[SF_CFH_HIC] = evaluate(&p->hic, height);
        if (p->lock > 0)
            point.value[SF_CFH_A_MAX] *= 1 + pow(height / p->lock, 50);
        for (int c = 0; c < SF_CFH_CRITERIA && point.failed; c++)
            point.least[c] = p->sure * point.value[c];
        point.on_anvil = p->anvil > 0 && height >= p->anvil;
        point.failed = point.failed || point.on_anvil;
        assert_true(points->count < (round->divides ? SF_CFH_MAX_POINTS : plan->max_drops) ||
                    plan->list_count > 0);
        assert_true(height > 0 && height <= plan->max_height);
        sf_cfh_points_add(points, &point);
    }
}

static sf_cfh_step search(const pad *p, const sf_cfh_plan *plan, sf_cfh_points *points) {
    sf_cfh_round round;
    sf_cfh_step step;
    *points = (sf_cfh_points){0};
    while ((step = sf_cfh_next(plan, points, &round)) == SF_CFH_SIMULATE) {
        assert_in_range(round.count, 1, plan->list_count > 0 ? plan->list_count : 2);
        add_round(p, plan, &round, points);
    }
    return step;
}
static int count_sides(const sf_cfh_points *points, sf_cfh_criterion c, double limit, bool above) {
    int count = 0;
    for (int k = 0; k < points->count; k++)
        count += !points->point[k].failed && (points->point[k].value[c] >= limit) == above;
    return count;
}

static void the_search_finds_the_criterion_that_is_met_first(void **state) {
    (void)state;
    static const struct {
        pad pad;
        sf_cfh_criterion deciding;
    } cases[] = {
        {{{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, INFINITY, 0, 0, 0}, SF_CFH_HIC},
        {{{200, 1.64, 1.7, 0.3}, {1000, 1.70, 2.8, 0.5}, INFINITY, 0, 0, 0}, SF_CFH_A_MAX},
        {{{200, 0.31, 1.1, 0.1}, {1000, 0.90, 2.0, 0.2}, INFINITY, 0, 0, 0}, SF_CFH_A_MAX},
        {{{200, 9.00, 0.7, 0.1}, {1000, 4.20, 2.0, 0.1}, INFINITY, 0, 0, 0}, SF_CFH_HIC},
        {{{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, 2.0, 0, 0, 0}, SF_CFH_HIC}, /* fails not far above */
    };
    static const double first[] = {0.5, 1.0, 1.65, 3.0};
    for (size_t q = 0; q < sizeof cases / sizeof cases[0]; q++)
        for (size_t f = 0; f < sizeof first / sizeof first[0]; f++) {
            const sf_cfh_plan plan = plan_from(first[f], 10);
            sf_cfh_criterion d = cases[q].deciding;
            sf_cfh_points points;
            sf_cfh_result result;
            search(&cases[q].pad, &plan, &points);
            sf_cfh_evaluate(&points, plan.limit, &result);
            assert_int_equal(result.verdict, SF_CFH_FOUND);
            assert_int_equal(result.deciding, d);
            const law *l = d == SF_CFH_HIC ? &cases[q].pad.hic : &cases[q].pad.a_max;
            assert_relative(result.crossing[d].height, l->at, 1e-6);
            assert_true(points.count >= SF_CFH_MIN_POINTS);
            assert_true(count_sides(&points, d, plan.limit[d], false) > 0);
            assert_true(count_sides(&points, d, plan.limit[d], true) > 0);
        }
}

/* The height at which a_max of a foam that locks up reaches 200 g. */
static double locked_at(const pad *p) {
    double low = 0.1, high = 2.5;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        bool above = evaluate(&p->a_max, middle) * (1 + pow(middle / p->lock, 50)) >= 200;
        *(above ? &high : &low) = middle;
    }
    return low;
}

/* The height lies between two drops 2 % apart, whatever the quadratic says. */
static void a_foam_that_locks_up_is_bracketed(void **state) {
    (void)state;
    static const double first[] = {0.5, 1.0, 1.4, 3.0}, lock[] = {1.2, 1.45, 1.6};
    for (size_t q = 0; q < sizeof lock / sizeof lock[0]; q++)
        for (size_t f = 0; f < sizeof first / sizeof first[0]; f++) {
            sf_cfh_plan plan = plan_from(first[f], 10);
            const pad p = {{200, 2.5, 1.2, 0.1}, {1000, 4, 2.0, 0.1}, INFINITY, 0, lock[q], 0};
            sf_cfh_points points;
            sf_cfh_result result;
            double at = locked_at(&p);
            search(&p, &plan, &points);
            sf_cfh_evaluate(&points, plan.limit, &result);
            const sf_cfh_crossing *c = &result.crossing[SF_CFH_A_MAX];
            assert_int_equal(result.verdict, SF_CFH_FOUND);
            assert_int_equal(result.deciding, SF_CFH_A_MAX);
            assert_true(c->low <= at && at <= c->high);
            assert_true(log(c->high / c->low) < 0.025);
            assert_true(c->low <= c->height && c->height <= c->high);
        }
}

/* Drops beyond the limit are not to be used, but it is sure that they exceed it: "above" alone was the
 * answer. With figures that are sure the bracket is 2 % wide; else it ends where those that are sure begin.
 */
static void a_drop_that_is_not_to_be_used_bounds_the_height(void **state) {
    (void)state;
    static const double first[] = {0.5, 1.4, 3.0}, lock[] = {1.2, 1.6}, sure[] = {1, 0.7};
    for (int q = 0; q < 12; q++) {
        sf_cfh_plan plan = plan_from(first[q % 3], 10);
        pad p = {{200, 2.5, 1.2, 0.1}, {1000, 4, 2.0, 0.1}, 0, 0, lock[q / 3 % 2], sure[q / 6]};
        sf_cfh_points points;
        sf_cfh_result result;
        sf_cfh_report report = {.plan = &plan, .points = &points, .result = &result};
        char text[512], bound[48];
        p.collapse = locked_at(&p);
        search(&p, &plan, &points);
        sf_cfh_evaluate(&points, plan.limit, &result);
        assert_int_equal(result.verdict, SF_CFH_ABOVE);
        assert_non_null(result.exceeding);
        assert_true(result.highest <= p.collapse && p.collapse <= result.exceeding->height);
        print_message("%.3f to %.3f m, %d drops\n", result.highest, result.exceeding->height, points.count);
        assert_true(log(result.exceeding->height / result.highest) < (p.sure < 1 ? 0.3 : 0.02));
        sf_cfh_verdict_text(&report, text, sizeof text);
        snprintf(bound, sizeof bound, " and below %.3f m", result.exceeding->height);
        assert_non_null(strstr(text, bound));
        assert_non_null(strstr(text, "a_max is at least "));
    }
}

/* The pads of the examples, by the figures of their drops: two rounds for the 50 mm, three for the 70 mm. */
static void a_round_has_heights_on_both_sides_of_the_crossing(void **state) {
    (void)state;
    static const pad pads[] = {{{200, 1.686, 1.75, 0.6}, {1000, 1.644, 2.95, 0.7}, INFINITY, 0, 0, 0},
                               {{200, 2.812, 1.6, 0.6}, {1000, 2.455, 2.4, 0.5}, INFINITY, 0, 0, 0}};
    for (int q = 0; q < 2; q++) {
        const sf_cfh_plan plan = plan_from(1.032, 10);
        sf_cfh_points points;
        sf_cfh_round next;
        assert_int_equal(search(&pads[q], &plan, &points), SF_CFH_ENOUGH);
        assert_in_range(points.count, 4, 4 + 2 * q);
        assert_int_equal(sf_cfh_next(&plan, &points, &next), SF_CFH_ENOUGH);
        assert_int_equal(next.count, 0);
        int below = count_sides(&points, SF_CFH_HIC, plan.limit[SF_CFH_HIC], false);
        double at = pads[q].hic.at;
        assert_true(points.point[below - 1].height > 0.86 * at && points.point[below].height < 1.16 * at);
    }
}

static void the_search_ends_at_its_limits_and_says_so(void **state) {
    (void)state;
    const pad soft = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, INFINITY, 0, 0, 0};
    const pad weak = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, 1.3, 0, 0, 0};
    const pad stiff = {{200, 0.001, 1.2, 0}, {1000, 0.002, 2.4, 0}, INFINITY, 0, 0, 0};
    const pad broken = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, 0, 0, 0, 0};
    sf_cfh_plan plan = plan_from(1, 1.5);
    sf_cfh_points points;
    sf_cfh_result result;
    assert_int_equal(search(&soft, &plan, &points), SF_CFH_AT_MAX_HEIGHT);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_ABOVE);
    assert_close(result.highest, 1.5, 1e-12);
    plan = plan_from(1, 10);
    assert_int_equal(search(&weak, &plan, &points), SF_CFH_COLLAPSED);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_ABOVE);
    assert_true(result.highest > 1.1 && result.highest <= 1.3);
    plan = plan_from(0.05, 10);
    assert_int_equal(search(&stiff, &plan, &points), SF_CFH_AT_MIN_HEIGHT);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_BELOW);
    plan.max_drops = 3;
    plan.first = 10;
    assert_int_equal(search(&stiff, &plan, &points), SF_CFH_AT_CAP);
    assert_int_equal(points.count, 3);
    plan = plan_from(1, 10);
    search(&broken, &plan, &points);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_UNKNOWN);
    assert_non_null(strstr(result.problem.text, "no simulation succeeded"));
}

/* "Above 0.1 m, neither reached" was the answer although a drop from 3 m had ended on the anvil. */
static void a_drop_that_reaches_the_anvil_is_worse_than_every_limit(void **state) {
    (void)state;
    const pad thin = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, INFINITY, 1.2, 0, 0};
    const pad hole = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, INFINITY, 0.001, 0, 0};
    sf_cfh_plan plan = plan_from(1, 10);
    sf_cfh_points points;
    sf_cfh_result result;
    sf_cfh_report report = {.plan = &plan, .points = &points, .result = &result};
    char text[512];
    search(&thin, &plan, &points);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_ABOVE);
    assert_true(result.highest < 1.2 && result.exceeding->height >= 1.2 && result.exceeding->height < 1.5);
    sf_cfh_verdict_text(&report, text, sizeof text);
    assert_non_null(strstr(text, "the missile reaches the anvil"));
    assert_non_null(strstr(text, "and below 1."));
    search(&hole, &plan, &points);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_int_equal(result.verdict, SF_CFH_BELOW);
    assert_true(isnan(result.lowest));
    assert_close(result.exceeding->height, points.point[0].height, 0);
    sf_cfh_verdict_text(&report, text, sizeof text);
    assert_non_null(strstr(text, "below 0.0"));
    assert_non_null(strstr(text, "the missile reaches the anvil"));
}

static void a_list_of_heights_is_followed(void **state) {
    (void)state;
    const pad p = {{200, 1.70, 1.7, 0.3}, {1000, 1.64, 2.8, 0.5}, 2.2, 0, 0, 0};
    sf_cfh_plan plan = plan_from(1, 10);
    sf_cfh_points points;
    sf_cfh_result result;
    plan.list_count = POINTS;
    memcpy(plan.list, heights, sizeof heights);
    assert_int_equal(search(&p, &plan, &points), SF_CFH_LIST_DONE);
    assert_int_equal(points.count, POINTS);
    for (int k = 0; k < POINTS; k++)
        assert_close(points.point[k].height, heights[k], 0);
    assert_true(points.point[POINTS - 1].failed);
    sf_cfh_evaluate(&points, plan.limit, &result);
    assert_relative(result.crossing[SF_CFH_HIC].height, 1.64, 1e-6);
}

/* g_eff = sum(2 h v^2) / sum((2 h)^2) of the paper's three drops, worked out by hand. */
static void the_rig_of_the_paper(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_cfh_rig rig;
    if (sf_cfh_rig_read(fixture_source("examples/data/penta2018_table2_70mm.csv"), &rig, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(rig.pairs, 3);
    assert_close(rig.gravity, 7.9668, 5e-4);
    assert_close(rig.standard_error, 0.0736, 5e-4);
    assert_close(rig.margin, 4.3027 * 0.0736 / 7.9668, 5e-4);
    assert_relative(sf_cfh_rig_height(&rig, 1), 9.80665 / rig.gravity, 1e-12);
    /* The fitted rig gives the speeds of the paper back. */
    assert_relative(sf_cfh_speed(1.709 / sf_cfh_rig_height(&rig, 1)), 5.2, 0.01);
    assert_relative(sf_cfh_free_fall_height(sf_cfh_speed(1.3)), 1.3, 1e-12);
}

static void tables_of_the_rig_that_make_no_sense_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } tables[] = {
        {"", "is empty"},
        {"height_m,speed_m_s\n1,4\n", "1 pairs"},
        {"height,speed_m_s\n1,4\n2,5\n", ":1: the heading has no column of height, such as height_m"},
        {"height_m,speed\n1,4\n2,5\n", ":1: the heading has no column of speed, such as speed_m_s"},
        {"height_m,h_m,speed_m_s\n1,1,4\n", "two height columns"},
        {"height_m,speed_m_s\n1,4\n2,fast\n", ":3: speed \"fast\" is not a finite number"},
        {"height_m,speed_m_s\n1,4\n2\n", ":3: 1 values where the heading has 2 columns"},
        {"height_m,speed_m_s\n1,4\n-2,5\n", "pair 2, -2 m and 5 m/s, is not above 0"},
        {"height_m,speed_m_s\n1,4\n1.1,5.5\n", "faster than free fall"},
    };
    char path[] = "/tmp/softfall-rig-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    for (size_t q = 0; q < sizeof tables / sizeof tables[0]; q++) {
        sf_error err = SF_ERROR_INIT;
        sf_cfh_rig rig;
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(tables[q].text, file);
        fclose(file);
        assert_int_equal(sf_cfh_rig_read(path, &rig, &err), SF_ERR_INPUT);
        if (!strstr(err.text, tables[q].part))
            fail_msg("\"%s\" is missing in: %s", tables[q].part, err.text);
    }
    remove(path);
}

/* A drop that is not to be used has no point to interpolate through, and the report says why. */
static void a_drop_that_is_not_to_be_used_is_left_out_with_its_reason(void **state) {
    (void)state;
    static const law a_max = {200, 1.63, 1.7, 0.34};
    sf_cfh_points points = {0};
    sf_cfh_result result;
    const double limit[SF_CFH_CRITERIA] = {200, 1e9};
    const sf_cfh_foams foams = {1, {{"", 0.9, "the compression table ends at"}}};
    for (int k = 0; k < POINTS; k++) {
        sf_runner_result drop = {
            .a_max_g = evaluate(&a_max, heights[k]), .hic = 100 * heights[k], .v_rebound = 1};
        if (k == 3) {
            drop.a_max_g *= 3;
            drop.grade = SF_GRADE_DO_NOT_USE;
            drop.sure = 0.25;
            strcpy(drop.verdict, "do not use: energy error 30 %");
        } else if (k == 4) {
            drop.grade = SF_GRADE_REMARKS;
            strcpy(drop.verdict, "valid with remarks: contact energy 2 %");
        }
        sf_cfh_point point = {.height = heights[k], .speed = 1};
        sf_cfh_take_result(&drop, &foams, &point);
        sf_cfh_points_add(&points, &point);
    }
    assert_true(points.point[3].failed && points.point[3].grade == SF_GRADE_DO_NOT_USE);
    assert_string_equal(points.point[3].note,
                        "do not use: energy error 30 %; yet a_max is at least 161 g and HIC 5");
    assert_close(points.point[3].least[SF_CFH_HIC], 170.0 / 32, 1e-9);
    assert_true(!points.point[4].failed && points.point[4].grade == SF_GRADE_REMARKS);
    assert_string_equal(points.point[4].note, "valid with remarks: contact energy 2 %");
    sf_cfh_evaluate(&points, limit, &result);
    assert_int_equal(result.verdict, SF_CFH_FOUND);
    assert_relative(result.crossing[SF_CFH_A_MAX].height, a_max.at, 1e-6);
}

/* Each layer's strain is held against the end of its own data. */
static void strains_of_layers_are_held_against_their_own_data(void **state) {
    (void)state;
    const sf_cfh_foams foams = {2,
                                {{"core", 0.9, "the terms are known to be stable up to"},
                                 {"cover", 0.6, "the compression table ends at"}}};
    double strain[2] = {0.85, 0.5};
    const sf_runner_result drop = {
        .v_rebound = 1, .max_local_strain = 0.85, .layer_count = 2, .layer_strain = strain};
    sf_cfh_point within = {.height = 1}, cover = {.height = 1}, core = {.height = 1};
    sf_cfh_take_result(&drop, &foams, &within);
    assert_string_equal(within.note, "");
    strain[1] = 0.7;
    sf_cfh_take_result(&drop, &foams, &cover);
    assert_string_equal(
        cover.note,
        "largest local strain of the layer \"cover\" 0.700, the compression table ends at 0.600: extrapolated "
        "curve");
    strain[0] = 0.95;
    strain[1] = 0.5;
    sf_cfh_take_result(&drop, &foams, &core);
    assert_string_equal(
        core.note,
        "largest local strain of the layer \"core\" 0.950, the terms are known to be stable up to 0.900: "
        "extrapolated curve");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_crossing_of_an_exact_quadratic_is_exact),
        cmocka_unit_test(the_interval_covers_as_often_as_it_says),
        cmocka_unit_test(points_far_from_the_crossing_stay_out),
        cmocka_unit_test(limits_outside_the_points_are_no_crossing),
        cmocka_unit_test(points_that_give_no_crossing_are_refused),
        cmocka_unit_test(the_search_finds_the_criterion_that_is_met_first),
        cmocka_unit_test(a_foam_that_locks_up_is_bracketed),
        cmocka_unit_test(a_drop_that_is_not_to_be_used_bounds_the_height),
        cmocka_unit_test(a_round_has_heights_on_both_sides_of_the_crossing),
        cmocka_unit_test(the_search_ends_at_its_limits_and_says_so),
        cmocka_unit_test(a_drop_that_reaches_the_anvil_is_worse_than_every_limit),
        cmocka_unit_test(a_list_of_heights_is_followed),
        cmocka_unit_test(the_rig_of_the_paper),
        cmocka_unit_test(tables_of_the_rig_that_make_no_sense_are_refused),
        cmocka_unit_test(a_drop_that_is_not_to_be_used_is_left_out_with_its_reason),
        cmocka_unit_test(strains_of_layers_are_held_against_their_own_data),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
