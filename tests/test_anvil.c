/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad that rests on the anvil: it stays where it lies, slides and sticks by Coulomb's law, flies and lands,
 * rocks, and every impulse on it is that of missile, anvil or weight. */
#include "extreme.h"
#include "resting_fixture.h"

#include "base/mat3.h"
#include "case/read.h"
#include "solver/step.h"
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double G = SF_STANDARD_GRAVITY;

static void the_loads_carry_the_weight_below_its_centre(void **state) {
    (void)state;
    static const resting_symmetry kinds[] = {WHOLE, HALF, QUARTER};
    for (size_t k = 0; k < 3; k++) {
        fixture f;
        resting_start(&f, &(resting){.gap = 1, .symmetry = kinds[k]});
        const sf_model *m = &f.model;
        double sum = 0, moment[2] = {0}, mass = 0, first[2] = {0};
        for (int64_t c = 0; c < m->rest_count; c++) {
            assert_true(m->rest_load[c] > 0);
            sum += m->rest_load[c];
            for (int r = 0; r < 2; r++)
                moment[r] += m->rest_load[c] * m->position[3 * (int64_t)m->rest_node[c] + r];
        }
        for (int64_t i = 0; i < m->node_count; i++) {
            mass += m->mass[i];
            for (int r = 0; r < 2; r++)
                first[r] += m->mass[i] * m->position[3 * i + r];
        }
        assert_relative(sum, G * mass, 1e-13);
        for (int r = kinds[k] == HALF; r < 2 && kinds[k] != QUARTER; r++) /* x = 0 carries that along x */
            assert_relative(moment[r], G * first[r], 1e-12);
        assert_int_equal(m->rest_count, 6 * 5);
        assert_relative(m->anvil.depth, 0.03, 1e-12);
        fixture_free(&f);
    }
}

/* The bound is 3e-10 of the settlement, g rho H^2 / 2 E = 0.37 um: rounding. */
static void a_resting_block_keeps_still(void **state) {
    (void)state;
    static const resting_symmetry kinds[] = {WHOLE, HALF, QUARTER};
    for (size_t k = 0; k < 3; k++) {
        fixture f;
        resting_start(&f, &(resting){.gap = 1, .friction = k ? 0 : 0.5, .symmetry = kinds[k]});
        double weight = G * resting_mass(&f.model);
        while (f.state.time < 0.02) {
            fixture_step(&f);
            assert_relative(f.state.base_reaction[2], weight, 1e-6);
            assert_int_equal(f.state.anvil_count, f.model.rest_count);
            sf_step_advance(&f.model, &f.state);
        }
        assert_true(largest_of(f.state.d, 3 * f.model.node_count) < 1e-16);
        assert_true(f.state.ledger.largest_error < 1e-4); /* the falling missile's first step */
        assert_true(fabs(f.state.ledger.friction) < 1e-18);
        fixture_free(&f);
    }
}

/* v0 = 0.1 m/s on friction mu: v0 / mu g and v0^2 / 2 mu g to rest, 34 ms and 1.7 mm with 0.3. */
static void a_sliding_block_comes_to_rest(void **state) {
    static const double frictions[] = {0.2, 0.3, 0.4};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double speed = 0.1, friction = frictions[k], time = speed / (friction * G),
                     way = 0.5 * speed * time;
        fixture f;
        double place[3];
        resting_start(&f, &(resting){.gap = 1, .friction = friction});
        resting_throw(&f, speed, 0);
        resting_advance_to(&f, 0.6 * time);
        resting_centre(&f, place);
        double t = f.state.time;
        assert_relative(place[0], speed * t - 0.5 * friction * G * t * t, 2e-3);
        resting_advance_to(&f, 1.2 * time);
        resting_centre(&f, place);
        assert_relative(place[0], way, 2e-3);
        assert_true(fabs(place[1]) < 1e-3 * way);
        assert_relative(f.state.ledger.friction, 0.5 * resting_mass(&f.model) * speed * speed, 2e-3);
        assert_relative(f.state.ledger.anvil, f.state.ledger.friction + f.state.ledger.contact, 1e-12);
        double before = place[0];
        resting_advance_to(&f, 1.4 * time);
        resting_centre(&f, place);
        assert_true(fabs(place[0] - before) < 1e-4 * way); /* it sticks */
        resting_advance_to(&f, 2.3 * time);
        resting_centre(&f, place);
        assert_true(fabs(place[0] - before) < 1e-6); /* and creeps by less than 1 um, m */
        fixture_free(&f);
    }
}

/* A pull of `slope` times the weight along x, on every node. */
static void tilt(fixture *f, double slope) {
    const sf_model *m = &f->model;
    sf_weight *a = &f->operators.weight;
    double(*pull)[3] = calloc((size_t)m->node_count, sizeof *pull);
    int32_t *node = malloc((size_t)m->node_count * sizeof *node);
    assert_true(pull && node);
    for (int64_t k = 0; k < a->count; k++)
        pull[a->node[k]][2] = a->pull[k][2];
    for (int64_t i = 0; i < m->node_count; i++) {
        node[i] = (int32_t)i;
        pull[i][0] = slope * G * m->mass[i];
    }
    free(a->pull);
    free(a->node);
    a->pull = pull;
    a->node = node;
    a->count = m->node_count;
}

static void below_the_friction_angle_it_sticks_and_above_it_slides(void **state) {
    (void)state;
    const double slopes[] = {0.1, 0.7}, friction = 0.4;
    for (int k = 0; k < 2; k++) {
        fixture f;
        double place[3], slip = 0;
        resting_start(&f, &(resting){.gap = 1, .friction = friction});
        tilt(&f, slopes[k]);
        resting_advance_to(&f, 0.02);
        resting_centre(&f, place);
        for (int64_t c = f.model.contact_count; c < sf_model_points(&f.model); c++) {
            int64_t node = sf_model_point_node(&f.model, c);
            slip = larger(slip, fabs(f.state.contact.position[3 * c] - f.model.position[3 * node]));
        }
        double t = f.state.time, slides = 0.5 * fmax(0, slopes[k] - friction) * G * t * t;
        if (k == 0) {
            assert_true(slip < 1e-12);
            assert_true(fabs(place[0]) < 1e-6); /* shear */
        } else {
            assert_relative(place[0], slides, 5e-3);
        }
        fixture_free(&f);
    }
}

/* Thrown up it flies like any body, and lands. */
static void a_thrown_block_flies_and_lands(void **state) {
    (void)state;
    const double speed = 0.05, flight = 2 * speed / G;
    fixture f;
    double place[3];
    resting_start(&f, &(resting){.gap = 1});
    resting_throw(&f, 0, speed);
    fixture_advance(&f);
    while (f.state.time < 0.9 * flight) {
        fixture_step(&f);
        assert_int_equal(f.state.anvil_count, 0);
        assert_true(f.state.base_reaction[2] == 0);
        resting_centre(&f, place);
        assert_close(f.state.ledger.weight, -G * resting_mass(&f.model) * place[2], 1e-8); /* it stretches */
        sf_step_advance(&f.model, &f.state);
        double t = f.state.time;
        resting_centre(&f, place);
        assert_close(place[2], speed * t - 0.5 * G * t * t, 2e-7); /* the first half step: g dt t / 2 */
    }
    resting_advance_to(&f, 6 * flight);
    resting_centre(&f, place);
    assert_close(place[2], 0, 1e-5);
    assert_int_equal(f.state.anvil_count, f.model.rest_count);
    assert_true(f.state.ledger.largest_error < 1e-3);
    fixture_free(&f);
}

typedef struct balance {
    double linear[3], angular[3]; /* kg m/s, kg m2/s */
} balance;

static void add_moment(balance *b, const double x[3], const double f[3], double factor) {
    double moment[3];
    sf_cross3(x, f, moment);
    for (int r = 0; r < 3; r++) {
        b->linear[r] += factor * f[r];
        b->angular[r] += factor * moment[r];
    }
}

static void place_of(const fixture *f, int64_t node, double x[3]) {
    for (int r = 0; r < 3; r++)
        x[r] = f->model.position[3 * node + r] + f->state.d[3 * node + r];
}

/* Momenta of the pad at the half step. */
static balance momenta(const fixture *f) {
    balance b = {0};
    double x[3];
    for (int64_t i = 0; i < f->model.node_count; i++) {
        place_of(f, i, x);
        add_moment(&b, x, &f->state.v[3 * i], f->model.mass[i]);
    }
    return b;
}

/* Impulses of this step on the pad, by point. */
static void add_impulses(const fixture *f, balance *b) {
    const sf_state *s = &f->state;
    const sf_weight *a = &f->operators.weight;
    double dt = 0.5 * (s->dt + s->dt_old), x[3];
    for (int64_t c = 0; c < sf_model_points(&f->model); c++)
        add_moment(b, &s->contact.position[3 * c], &s->contact.force[3 * c], dt);
    for (int64_t k = 0; k < a->count; k++) {
        place_of(f, a->node[k], x);
        add_moment(b, x, a->pull[k], dt);
    }
}

/* An off-centre drop tips the pad: it lifts off on one side and comes back. */
static void a_rocking_pad_conserves_momentum_with_the_anvil(void **state) {
    (void)state;
    fixture f;
    balance impulse = {0};
    int64_t fewest = 1000, most_after = 0;
    double size = 0, highest = 0;
    resting_start(&f, &(resting){.friction = 0.3, .across = 0.018, .speed = 0.5});
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    while (s->time < 0.15) {
        fixture_step(&f);
        add_impulses(&f, &impulse);
        size = larger(size, fabs(s->missile.force[2]) * s->time);
        if (s->anvil_count < fewest) {
            fewest = s->anvil_count;
            most_after = 0;
        }
        most_after = s->anvil_count > most_after ? s->anvil_count : most_after;
        balance now = momenta(&f);
        for (int r = 0; r < 3; r++) {
            assert_true(fabs(now.linear[r] - impulse.linear[r]) <=
                        1e-12 * m->missile.mass * m->missile.speed);
            assert_true(fabs(now.angular[r] - impulse.angular[r]) <=
                        1e-12 * m->missile.mass * m->missile.speed * 0.05);
        }
        sf_step_advance(m, s);
        for (int64_t c = m->contact_count; c < sf_model_points(m); c++)
            highest = larger(highest, s->contact.position[3 * c + 2]);
    }
    assert_true(fewest <= m->rest_count / 2 && most_after > fewest); /* lifts off, comes back */
    assert_true(highest > 5e-4);
    assert_true(s->ledger.vector_error < 1e-12 && s->ledger.angular_error < 1e-12);
    assert_true(fabs(s->ledger.momentum_error) < 1e-12);
    assert_true(s->ledger.largest_error < 0.01);
    fixture_free(&f);
}

/* The missile's reach follows the points that it can touch, not those on the anvil. */
static void the_reach_is_that_of_the_top(void **state) {
    fixture f;
    double finest = INFINITY;
    (void)state;
    resting_start(&f, &(resting){.gap = 1});
    for (int64_t c = 0; c < f.model.contact_count; c++)
        finest = smaller(finest, f.model.spacing[f.model.contact_node[c]]);
    for (int64_t k = 0; k < f.model.rest_count; k++)
        f.model.spacing[f.model.rest_node[k]] = 0.5 * finest;
    fixture_start(&f);
    assert_true(f.operators.contact.spacing == finest);
    fixture_free(&f);
}

/* One layer of cells: nodes of top and base share their kernels, and neither surface is penetrated. */
static void a_thin_pad_is_outside_both(void **state) {
    (void)state;
    fixture f;
    resting_start(&f, &(resting){.friction = 0.2, .layers = 1});
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    int64_t both = 0;
    for (int step = 0; step < 60; step++) {
        fixture_step(&f);
        both += s->contact_count > 0 && s->anvil_count > 0;
        sf_step_advance(m, s);
        assert_true(s->penetration <= 1e-6 * s->dt * m->missile.speed);
        assert_true(fabs(s->ledger.momentum_error) < 1e-12);
    }
    assert_true(both > 50);
    assert_int_equal(s->contact_unsettled, 0);
    fixture_free(&f);
}

static void same_bits_for_any_number_of_threads(void **state) {
    (void)state;
    int threads = omp_get_max_threads();
    double *first = NULL;
    for (int k = 1; k <= 3; k++) {
        fixture f;
        omp_set_num_threads(k);
        resting_start(&f, &(resting){.friction = 0.3, .across = 0.018});
        for (int step = 0; step < 300; step++)
            fixture_advance(&f);
        size_t bytes = 3 * (size_t)f.model.node_count * sizeof *first;
        if (k == 1) {
            first = malloc(bytes);
            assert_non_null(first);
            memcpy(first, f.state.d, bytes);
        }
        assert_memory_equal(first, f.state.d, bytes);
        fixture_free(&f);
    }
    omp_set_num_threads(threads);
    free(first);
}

static void contradictions_of_a_case_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *set[3], *words;
    } rows[] = {
        {{"pad.base=resting", "pad.gravity=0 m/s2"}, "a resting pad without weight"},
        {{"pad.base=resting", "pad.friction=-0.1"}, "pad.friction"},
        {{"pad.friction=0.3"}, "pad.base is not \"resting\""},
        {{"pad.base=smooth", "pad.gravity=9.81 m/s2"}, "pad.base is not \"resting\""},
        {{"pad.base=resting", "pad.fixed=[]", "pad.sliding=[\"base\"]"}, "pad.fixed names no surface"},
        {{"pad.base=resting", "pad.fixed=[\"top\"]"}, "in pad.fixed and in pad.contact"},
        {{"pad.base=resting", "pad.sliding=[\"base\"]"}, "in pad.fixed and in pad.sliding"},
        {{"pad.base=glued", "pad.fixed=[\"base\", \"symmetry_x\"]"}, "in pad.fixed and in pad.symmetry"},
        {{"pad.base=floating"}, "glued"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        sf_case c;
        sf_error err = SF_ERROR_INIT;
        int count = 0;
        while (count < 3 && rows[k].set[count])
            count++;
        assert_int_equal(
            sf_case_read(fixture_source("examples/eva50-v4.5/case.cfg"), count, rows[k].set, NULL, &c, &err),
            SF_ERR_INPUT);
        if (!strstr(err.text, rows[k].words))
            fail_msg("\"%s\" does not say \"%s\"", err.text, rows[k].words);
    }
}

/* A block whose base is only a part of its underside, or is not the underside at all. */
static void a_base_that_cannot_carry_the_pad_is_refused(void **state) {
    (void)state;
    static const struct {
        const char *base, *words;
        double from;   /* m: nodes of the base with less x are left out */
        double raised; /* m: these nodes lie higher */
    } rows[] = {
        {"sides", "must lie in the plane of the pad's lowest nodes", 0, 0},
        {"base", "does not rest on the whole of its base", 0.0345, 0.002},
        {"base", "20 nodes in the plane of the anvil, the first at (", 0.0345, 0},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        const fixture_block block = {.cells = {5, 4, 3}, .spacing = 0.01};
        sf_case c;
        sf_mesh mesh;
        sf_surface surface;
        sf_model m;
        sf_build_report report;
        sf_error err = SF_ERROR_INIT;
        fixture_case(&c, NULL);
        fixture_hold(&c, (const char *const[]){rows[k].base, NULL});
        c.base_rule = SF_BASE_RESTING;
        fixture_block_mesh(&block, &mesh);
        sf_node_set *set = &mesh.set[0];
        int64_t kept = 0;
        for (int64_t i = 0; i < set->count; i++)
            if (mesh.position[3 * (int64_t)set->node[i]] >= rows[k].from)
                set->node[kept++] = set->node[i];
            else
                mesh.position[3 * (int64_t)set->node[i] + 2] += rows[k].raised;
        set->count = kept;
        fixture_plate(0.1, 0.02, 0.02, &surface);
        assert_int_equal(sf_model_build(&c, &mesh, &surface, &m, &report, NULL, &err), SF_ERR_INPUT);
        if (!strstr(err.text, rows[k].words))
            fail_msg("\"%s\" does not say \"%s\"", err.text, rows[k].words);
        sf_surface_free(&surface);
        sf_mesh_free(&mesh);
        sf_case_free(&c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_loads_carry_the_weight_below_its_centre),
        cmocka_unit_test(a_resting_block_keeps_still),
        cmocka_unit_test(a_sliding_block_comes_to_rest),
        cmocka_unit_test(below_the_friction_angle_it_sticks_and_above_it_slides),
        cmocka_unit_test(a_thrown_block_flies_and_lands),
        cmocka_unit_test(a_rocking_pad_conserves_momentum_with_the_anvil),
        cmocka_unit_test(the_reach_is_that_of_the_top),
        cmocka_unit_test(a_thin_pad_is_outside_both),
        cmocka_unit_test(same_bits_for_any_number_of_threads),
        cmocka_unit_test(contradictions_of_a_case_are_refused),
        cmocka_unit_test(a_base_that_cannot_carry_the_pad_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
