/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hyperfoam at material points: closed forms, energy, objectivity, tangent bounds, stability; and
 * unloading with three numbers, of both laws. */
#include "extreme.h"
#include "foam_fixture.h"
#include "material/hyperfoam.h"
#include "base/lanes.h"

#include <gsl/gsl_integration.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* One term of nu, in the range of foams; no hysteresis, no viscosity. */
static sf_hyperfoam_card simple_card(double alpha, double nu) {
    return (sf_hyperfoam_card){
        .shared = point_elastic_foam(100), .stable_to = 0.9, .term = {{.mu = 2e5, .alpha = alpha, .nu = nu}}};
}

/* Six terms, one of them softening. */
static sf_hyperfoam_card rich_card(void) {
    sf_hyperfoam_card card = simple_card(9, 0.25);
    card.term[1] = (sf_hyperfoam_term){.mu = 8e4, .alpha = -1.5, .beta = 0.05};
    card.term[2] = (sf_hyperfoam_term){.mu = -3e4, .alpha = 3, .nu = 0};
    card.term[3] = (sf_hyperfoam_term){.mu = 2e4, .alpha = 16, .nu = 0.1};
    card.term[4] = (sf_hyperfoam_term){.mu = 1e4, .alpha = -4, .nu = 0.02};
    card.term[5] = (sf_hyperfoam_term){.mu = 5e3, .alpha = 2, .beta = 0.3};
    return card;
}

static point_law law_of(const sf_hyperfoam *foam) {
    return (point_law){sf_hyperfoam_law.update, foam, foam->options.maxwell, false};
}

/* The batch at F, without viscosity, when the largest W so far was `peak`. */
static void at(const sf_hyperfoam *foam, const double f[9], double peak, sf_law_batch *b) {
    const point_law law = law_of(foam);
    foam_reset(b);
    for (int l = 0; l < SF_LANES; l++)
        b->history[SF_FOAM_PEAK][l] = peak;
    point_law_step(&law, 0, f, b);
}

static void diagonal(const double x[3], double f[9]) {
    const double d[9] = {x[0], 0, 0, 0, x[1], 0, 0, 0, x[2]};
    memcpy(f, d, sizeof d);
}

/* ---- functions of lanes ---- */

static void logarithm_and_exponential_are_those_of_the_library(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int k = 0; k < 200000; k++) {
        double x = exp(point_random(&seed, -30, 30)), near = 1 + point_random(&seed, -1e-3, 1e-3) * (k % 7);
        double y = point_random(&seed, -40, 40) * (k % 2 ? 1 : pow(10, -(k % 9))), rest;
        assert_close(sf_lane_log(x), log(x), 4e-16 * fabs(log(x)));
        assert_close(sf_lane_log(near), log(near), 1e-15 * fabs(log(near)));
        assert_close(sf_lane_expm1(y, &rest), expm1(y), 6e-16 * fabs(expm1(y)));
        long double z = y, exact = expm1l(z) - z;
        if (fabs(y) < 1e-2)
            exact = z * z / 2 * (1 + z / 3 * (1 + z / 4 * (1 + z / 5 * (1 + z / 6 * (1 + z / 7)))));
        assert_close(rest, (double)exact, 1e-14 * fabs((double)exact));
    }
    double rest;
    assert_true(sf_lane_log(1) == 0 && sf_lane_expm1(0, &rest) == 0 && rest == 0);
    assert_true(isfinite(sf_lane_expm1(1e9, &rest)) && isfinite(sf_lane_expm1(-1e9, &rest)));
}

/* ---- loading ---- */

/* dW by stretch i, as the formula stands in the books; nu not 0. */
static double book_stress(const sf_hyperfoam_card *card, const double x[3], int i) {
    double sum = 0, volume = x[0] * x[1] * x[2];
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++) {
        const sf_hyperfoam_term *t = &card->term[k];
        if (t->mu != 0)
            sum += 2 * t->mu / t->alpha / x[i] *
                   (pow(x[i], t->alpha) - pow(volume, -t->alpha * (t->beta + t->nu / (1 - 2 * t->nu))));
    }
    return sum;
}

static double book_energy(const sf_hyperfoam_card *card, const double x[3]) {
    double sum = 0, volume = x[0] * x[1] * x[2];
    for (int k = 0; k < SF_HYPERFOAM_TERMS; k++) {
        const sf_hyperfoam_term *t = &card->term[k];
        double a = t->alpha, beta = t->beta + t->nu / (1 - 2 * t->nu);
        if (t->mu != 0)
            sum += 2 * t->mu / (a * a) *
                   (pow(x[0], a) + pow(x[1], a) + pow(x[2], a) - 3 +
                    (beta == 0 ? -a * log(volume) : (pow(volume, -a * beta) - 1) / beta));
    }
    return sum;
}

static void stress_and_energy_are_the_formula_in_every_direction(void **state) {
    (void)state;
    sf_hyperfoam_card cards[] = {simple_card(8, 0.25), simple_card(-3, 0.1), simple_card(5, 0),
                                 simple_card(4, -0.2), rich_card()};
    uint64_t seed = 2;
    for (size_t c = 0; c < sizeof cards / sizeof *cards; c++) {
        sf_hyperfoam foam = sf_hyperfoam_build(&cards[c]);
        for (int trial = 0; trial < 300; trial++) {
            double x[3], f[9], expected[9] = {0}, p[9];
            for (int i = 0; i < 3; i++)
                x[i] = point_random(&seed, 0.1, 1.8);
            if (trial % 3 == 0)
                x[1] = x[0];
            if (trial % 9 == 0)
                x[2] = x[0]; /* all three */
            diagonal(x, f);
            sf_law_batch b;
            at(&foam, f, 0, &b);
            foam_get(b.p, 0, p);
            for (int i = 0; i < 3; i++)
                expected[4 * i] = book_stress(&cards[c], x, i);
            assert_close(point_distance(9, p, expected), 0, 1e-12 * point_norm(9, expected) + 1e-8);
            assert_close(b.energy[0], book_energy(&cards[c], x), 1e-11 * b.energy[0] + 1e-9);
            sf_hyperfoam_point one = sf_hyperfoam_evaluate(&foam, x);
            assert_close(b.energy[0], one.energy, 1e-12 * one.energy);
            for (int i = 0; i < 3; i++)
                assert_close(one.t[i], expected[4 * i], 1e-12 * point_norm(9, expected) + 1e-8);
        }
    }
}

/* nu = 0 is the limit: no jump, and the first order in nu is what a difference shows. */
static void poisson_ratio_goes_to_zero_smoothly(void **state) {
    (void)state;
    const double x[3] = {0.4, 1.1, 0.9};
    double last = 0;
    for (int k = 4; k <= 14; k++) {
        sf_hyperfoam_card none = simple_card(7, 0), little = simple_card(7, pow(10, -k));
        sf_hyperfoam a = sf_hyperfoam_build(&none), b = sf_hyperfoam_build(&little);
        sf_hyperfoam_point p = sf_hyperfoam_evaluate(&a, x), q = sf_hyperfoam_evaluate(&b, x);
        double change = (q.energy - p.energy) / pow(10, -k);
        if (k > 4 && k < 8)
            assert_relative(change, last, 3e-3);
        last = change;
        assert_close(q.energy, p.energy, 10 * pow(10, -k) * p.energy + 1e-14 * p.energy);
        assert_close(q.t[0], p.t[0], 20 * pow(10, -k) * fabs(p.t[0]) + 1e-14 * fabs(p.t[0]));
    }
}

/* Free sides: lateral stretch l^-nu, and the stress of one term follows. */
static void free_sides_move_by_the_power_minus_nu(void **state) {
    (void)state;
    static const double nus[] = {0, 0.1, 0.25, 0.4};
    for (int c = 0; c < 4; c++)
        for (double alpha = -4; alpha <= 12; alpha += 3.7) {
            sf_hyperfoam_card card = simple_card(alpha, nus[c]);
            sf_hyperfoam foam = sf_hyperfoam_build(&card);
            double x[3] = {1, 1, 1};
            for (double stretch = 0.98; stretch > 0.08; stretch -= 0.05) {
                x[0] = stretch;
                assert_true(sf_hyperfoam_release(&foam, 1, x));
                double side = pow(stretch, -nus[c]);
                assert_relative(x[1], side, 1e-12);
                double t = 2 * 2e5 / alpha / stretch * (pow(stretch, alpha) - pow(side, alpha)), f[9], p[9];
                diagonal(x, f);
                sf_law_batch b;
                at(&foam, f, 0, &b);
                foam_get(b.p, 0, p);
                assert_relative(p[0], t, 1e-11);
                assert_close(p[4], 0, 1e-10 * fabs(t));
            }
        }
}

static void law_is_objective_and_isotropic(void **state) {
    (void)state;
    sf_hyperfoam_card card = rich_card();
    card.shared.hysteresis_hu = 0.1;
    card.shared.hysteresis_alpha = 0.4;
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    uint64_t seed = 3;
    for (int trial = 0; trial < 300; trial++) {
        double f[9], q[9], moved[9], expected[9], p[9], turned[9];
        sf_law_batch b, c;
        point_deformation(&seed, 0.15, 1.3, f);
        point_rotation(&seed, q);
        at(&foam, f, 0, &b);
        double peak = trial % 2 ? 2 * b.energy[0] : 0;
        at(&foam, f, peak, &b);
        foam_get(b.p, 0, p);
        for (int side = 0; side < 2; side++) {
            point_product(side ? f : q, side ? q : f, moved);
            point_product(side ? p : q, side ? q : p, expected);
            at(&foam, moved, peak, &c);
            foam_get(c.p, 0, turned);
            assert_close(point_distance(9, turned, expected), 0, 1e-10 * point_norm(9, p));
            assert_relative(c.energy[0], b.energy[0], 1e-10);
        }
        assert_true((b.factor[0] < 1) == (peak > 0));
    }
}

static void stress_is_derivative_of_energy(void **state) {
    (void)state;
    sf_hyperfoam_card card = rich_card();
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    uint64_t seed = 5;
    for (int trial = 0; trial < 100; trial++) {
        double f[9], p[9], h = 1e-6;
        sf_law_batch b;
        point_deformation(&seed, 0.15, 1.3, f);
        at(&foam, f, 0, &b);
        foam_get(b.p, 0, p);
        for (int k = 0; k < 9; k++) {
            double moved[9], side[2];
            for (int s = 0; s < 2; s++) {
                memcpy(moved, f, sizeof moved);
                moved[k] += s ? h : -h;
                at(&foam, moved, 0, &b);
                side[s] = b.energy[0];
            }
            assert_close((side[1] - side[0]) / (2 * h), p[k], 2e-7 * point_norm(9, p));
        }
    }
}

/* Small strains: Hooke's law with mu = sum mu_i and lambda = sum 2 mu_i beta_i. */
static void small_strains_are_linear_elastic(void **state) {
    (void)state;
    sf_hyperfoam_card card = rich_card();
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    double mu = 0, lame = 0;
    for (int k = 0; k < foam.count; k++) {
        mu += foam.mu[k];
        lame += 2 * foam.mu[k] * foam.beta[k];
    }
    for (double e = 1e-9; e < 1e-5; e *= 10) {
        const double f[9] = {1 + e, 2 * e, 0, 2 * e, 1 - 3 * e, 0, 0, 0, 1};
        double p[9], expected[9] = {0}, trace = -2 * e;
        sf_law_batch b;
        at(&foam, f, 0, &b);
        foam_get(b.p, 0, p);
        for (int k = 0; k < 9; k++)
            expected[k] = 2 * mu * (f[k] - (k % 4 == 0)) + (k % 4 == 0 ? lame * trace : 0);
        assert_close(point_distance(9, p, expected), 0, (30 * e + 1e-6 * 1e-9 / e) * point_norm(9, expected));
        double energy = 0.5 * lame * trace * trace + mu * (1 + 9 + 8) * e * e;
        assert_close(b.energy[0], energy, (100 * e + 1e-5 * 1e-9 / e) * energy);
    }
}

/* ---- tangent ---- */

static void bounds_cover_the_numerical_tangent(void **state) {
    (void)state;
    uint64_t seed = 6;
    static const double nus[] = {0, 0.1, 0.25, 0.4};
    for (int c = 0; c < 5; c++)
        for (int variant = 0; variant < 3; variant++) {
            sf_hyperfoam_card card = c < 4 ? simple_card(6, nus[c]) : rich_card();
            card.shared.hysteresis_hu = variant ? 0.05 : 1;
            card.shared.hysteresis_shape = variant ? 1.4 : 1;
            card.shared.hysteresis_alpha = variant == 2 ? 0.35 : 1;
            if (variant) {
                card.shared.maxwell_modulus = 2e6;
                card.shared.rate_factor = 0.4;
            }
            sf_hyperfoam foam = sf_hyperfoam_build(&card);
            point_law law = law_of(&foam);
            law.away = variant == 2;
            for (int trial = 0; trial < 150; trial++)
                point_law_assert_bounds(&law, &seed, 0.1, 1.3, variant ? 1e-5 : 0);
        }
}

/* Equal stretches of nu > 0: the sum of a row is the bulk stiffness, an eigenvalue. */
static void bound_of_equal_stretches_is_exact(void **state) {
    (void)state;
    sf_hyperfoam_card card = simple_card(6, 0.25);
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    for (double x = 0.1; x < 1.3; x += 0.1) {
        const double stretch[3] = {x, x, x};
        double f[9], tangent[81];
        const point_law law = law_of(&foam);
        sf_law_batch b;
        diagonal(stretch, f);
        at(&foam, f, 0, &b);
        point_law_tangent(&law, 0, &b, tangent);
        assert_relative(point_largest_eigenvalue(9, tangent), b.tangent[0], 2e-5);
    }
}

/* 90 % compression in one, two and three directions, with shear: numbers, and the bound holds. */
static void deep_compression_has_finite_stress(void **state) {
    (void)state;
    sf_hyperfoam_card cards[] = {simple_card(8, 0.25), simple_card(20, 0.4), rich_card()};
    for (int c = 0; c < 3; c++) {
        sf_hyperfoam foam = sf_hyperfoam_build(&cards[c]);
        for (int pressed = 1; pressed <= 3; pressed++) {
            double f[9] = {1, 0.3, 0, 0.1, 1, 0.2, 0, 0, 1};
            sf_law_batch b;
            for (int i = 0; i < pressed; i++)
                f[4 * i] *= 0.1;
            f[1] *= pressed == 1;
            f[3] *= pressed == 1;
            at(&foam, f, 0, &b);
            for (int k = 0; k < 9; k++)
                assert_true(isfinite(b.p[k][0]));
            assert_true(isfinite(b.tangent[0]) && b.tangent[0] > 0 && b.energy[0] > 0 && b.jacobian[0] > 0);
        }
    }
}

/* ---- unloading ---- */

static double integrand(double w, void *data) {
    const sf_unloading *u = data;
    return pow(1 - pow(w, u->shape), u->alpha);
}

/* By quadrature over t, w = 1 - t^6: smooth at both ends for the exponents of the test. */
static double integrand_of_t(double t, void *data) {
    return 6 * pow(t, 5) * integrand(1 - pow(t, 6), data);
}

static void integral_of_unloading_is_that_of_quadrature(void **state) {
    (void)state;
    static const double shapes[] = {0.06, 0.5, 1, 2.3, 40}, alphas[] = {0.1, 0.35, 1, 2.5, 9};
    gsl_integration_cquad_workspace *work = gsl_integration_cquad_workspace_alloc(200);
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++) {
            sf_unloading u;
            sf_unloading_build(0.1, shapes[i], alphas[j], &u);
            double whole, error;
            gsl_function f = {integrand_of_t, &u};
            gsl_integration_cquad(&f, 0, 1, 1e-15, 1e-13, work, &whole, &error, NULL);
            assert_close(u.whole, whole, 2e-12);
            assert_relative(
                u.whole,
                exp(lgamma(1 / shapes[i]) + lgamma(alphas[j] + 1) - lgamma(1 / shapes[i] + alphas[j] + 1)) /
                    shapes[i],
                1e-11);
            for (double w = 0.02; w < 1; w += 0.0731) {
                double part;
                gsl_integration_cquad(&f, pow(1 - w, 1. / 6), 1, 1e-15, 1e-13, work, &part, &error, NULL);
                assert_close(sf_unloading_integral(&u, w), part, 2e-12);
            }
            assert_relative(sf_unloading_integral(&u, 1), u.whole, 1e-14);
        }
    gsl_integration_cquad_workspace_free(work);
}

/* ALPHA = 1 has the closed form of before, and 1 + 1e-9 is its neighbour. */
static void alpha_of_one_is_the_old_law(void **state) {
    (void)state;
    sf_unloading old, near;
    double energy[SF_LANES], peak[2][SF_LANES];
    sf_unloaded out[2];
    sf_unloading_build(0.05, 1.7, 1, &old);
    sf_unloading_build(0.05, 1.7, 1 + 1e-9, &near);
    for (int l = 0; l < SF_LANES; l++) {
        energy[l] = 1e3 * l;
        peak[0][l] = peak[1][l] = 12.5e3;
    }
    sf_unloading_lanes(&old, energy, peak[0], &out[0]);
    sf_unloading_lanes(&near, energy, peak[1], &out[1]);
    for (int l = 0; l < SF_LANES; l++) {
        double w = fmin(1, energy[l] / 12.5e3), most = fmax(energy[l], 12.5e3);
        assert_relative(out[0].factor[l], 1 - 0.95 * (1 - pow(w, 1.7)), 1e-14);
        assert_close(out[0].stored[l], energy[l] * (0.05 + 0.95 * pow(w, 1.7) / 2.7), 1e-11 * most);
        assert_relative(out[0].lost[l], most * 0.95 * 1.7 / 2.7, 1e-14);
        assert_close(out[1].factor[l], out[0].factor[l], 3e-8);
        assert_close(out[1].softening[l], out[0].softening[l], 2e-8 * out[0].softening[l] + 1e-8);
        assert_close(out[1].stored[l], out[0].stored[l], 2e-8 * out[0].stored[l] + 1e-8);
        assert_close(out[1].lost[l], out[0].lost[l], 2e-8 * out[0].lost[l] + 1e-8);
        assert_true(peak[0][l] == most && peak[1][l] == most);
    }
}

/* Recoverable and lost energy are the work done, at every instant of a cycle within a cycle, for both laws.
 */
static void stored_and_lost_energy_is_the_work_done(void **state) {
    (void)state;
    enum { STEPS = 4000 };
    const double turn[5] = {0, 0.7, 0.2, 1, 0};
    sf_hyperfoam_card soft = simple_card(6, 0.25);
    point_card hard;
    sf_foam foam;
    point_card_init(&hard);
    point_card_add_eva(&hard, 0, 60, 0.8, 1);
    soft.shared.hysteresis_hu = hard.card.shared.hysteresis_hu = 0.1;
    soft.shared.hysteresis_shape = hard.card.shared.hysteresis_shape = 1.3;
    soft.shared.hysteresis_alpha = hard.card.shared.hysteresis_alpha = 0.3;
    foam_build(&hard, &foam);
    sf_hyperfoam hyper = sf_hyperfoam_build(&soft);
    const point_law laws[2] = {law_of(&hyper), {sf_low_density_foam.update, &foam, 0, false}};
    for (int n = 0; n < 2; n++) {
        sf_law_batch b;
        double old_p[9] = {0}, old_f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, work = 0, most = 0, lost = 0;
        foam_reset(&b);
        for (int k = 1; k <= 4 * STEPS; k++) {
            int leg = (k - 1) / STEPS;
            /* cosine steps: fine at the reversals, where the factor falls at once */
            double x = 0.5 - 0.5 * cos(M_PI * (k - leg * STEPS) / STEPS), p[9];
            double s = turn[leg] + x * (turn[leg + 1] - turn[leg]);
            const double f[9] = {1 - 0.7 * s, 0.2 * s, 0, 0, 1 - 0.2 * s, 0, 0, 0.1 * s, 1};
            point_law_step(&laws[n], 0, f, &b);
            foam_get(b.p, 0, p);
            for (int i = 0; i < 9; i++)
                work += 0.5 * (p[i] + old_p[i]) * (f[i] - old_f[i]);
            most = larger(most, work);
            assert_close(b.stored[0] + b.lost[0], work, 1e-4 * most);
            assert_true(b.stored[0] >= -1e-12 * most && b.lost[0] >= lost);
            lost = b.lost[0];
            memcpy(old_p, p, sizeof p);
            memcpy(old_f, f, sizeof f);
        }
        sf_unloading u;
        sf_unloading_build(0.1, 1.3, 0.3, &u);
        assert_relative(b.lost[0], 0.9 * u.whole * b.history[SF_FOAM_PEAK][0], 1e-12);
        assert_close(b.stored[0], 0, 1e-9 * most);
    }
    sf_foam_free(&foam);
}

/* The bound on f' is exact but within a part of 1e-3 of the reversal, and no mean over that part is above. */
static void bound_on_the_reversal_is_a_secant(void **state) {
    (void)state;
    sf_unloading u;
    sf_unloading_build(0.02, 1.5, 0.3, &u);
    for (int k = 0; k < 60; k++) {
        double gap = pow(10, -9 + 0.15 * k), energy[SF_LANES], peak[SF_LANES], h = 1e-4 * gap;
        sf_unloaded out;
        for (int l = 0; l < SF_LANES; l++) {
            energy[l] = 1 - gap;
            peak[l] = 1;
        }
        sf_unloading_lanes(&u, energy, peak, &out);
        double slope = (sf_unloading_factor(0.02, 1.5, 0.3, 1 - gap + h) -
                        sf_unloading_factor(0.02, 1.5, 0.3, 1 - gap - h)) /
                       (2 * h);
        if (gap > 1e-3)
            assert_relative(out.softening[0], slope, 1e-5);
        else
            assert_true(out.softening[0] >= fmin(slope * (1 - 1e-4), u.steepest));
        double width = 1e-3, high = 1 - gap, low = high - width;
        if (low > 0)
            assert_true(sf_unloading_factor(0.02, 1.5, 0.3, high) -
                            sf_unloading_factor(0.02, 1.5, 0.3, low) <=
                        u.steepest * width * (1 + 1e-9));
    }
}

/* ---- stability ---- */

static void positive_terms_are_stable(void **state) {
    (void)state;
    sf_hyperfoam_failure failure;
    for (double alpha = -8; alpha <= 30; alpha += 3.8)
        for (double nu = 0; nu < 0.49; nu += 0.12) {
            sf_hyperfoam_card card = simple_card(alpha, nu);
            sf_hyperfoam foam = sf_hyperfoam_build(&card);
            assert_false(sf_hyperfoam_fails(&foam, 0.9, &failure));
        }
}

/* Two terms with nu = 0: D is diagonal, mu1 l^a1 + mu2 l^a2 = 0 where it fails. */
static void unstable_term_is_named_with_its_strain(void **state) {
    (void)state;
    sf_hyperfoam_card card = simple_card(8, 0);
    card.term[2] = (sf_hyperfoam_term){.mu = -2e4, .alpha = 2};
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    sf_hyperfoam_failure failure;
    double limit = 1 - pow(0.1, 1. / 6);
    assert_false(sf_hyperfoam_fails(&foam, limit - 0.01, &failure));
    assert_true(sf_hyperfoam_fails(&foam, 0.9, &failure));
    assert_string_equal(failure.path, "uniaxial compression");
    assert_int_equal(failure.term, 1);
    assert_close(failure.strain, limit, 0.0046);
    sf_error err = SF_ERROR_INIT;
    const sf_material material = sf_hyperfoam_material(&card);
    assert_int_equal(sf_material_check(&material, 0, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "material.term_3 (mu = -20 kPa, alpha = 2) makes the law unstable in "
                                     "uniaxial compression from a strain of 0.3"));
}

static void terms_that_mean_nothing_are_refused(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        static const char *const words[] = {"has no stress", "alpha is 0", "both nu", "unstable"};
        sf_hyperfoam_card card = simple_card(8, 0.2);
        sf_error err = SF_ERROR_INIT;
        card.term[0].mu = k == 0 ? 0 : k == 3 ? -1e4 : 1e4;
        card.term[0].alpha = k == 1 ? 0 : 8;
        card.term[0].beta = k == 2 ? 0.1 : 0;
        const sf_material material = sf_hyperfoam_material(&card);
        assert_int_equal(sf_material_check(&material, 0, &err), SF_ERR_MODEL);
        if (!strstr(err.text, words[k]))
            fail_msg("%s", err.text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(logarithm_and_exponential_are_those_of_the_library),
        cmocka_unit_test(stress_and_energy_are_the_formula_in_every_direction),
        cmocka_unit_test(poisson_ratio_goes_to_zero_smoothly),
        cmocka_unit_test(free_sides_move_by_the_power_minus_nu),
        cmocka_unit_test(law_is_objective_and_isotropic),
        cmocka_unit_test(stress_is_derivative_of_energy),
        cmocka_unit_test(small_strains_are_linear_elastic),
        cmocka_unit_test(bounds_cover_the_numerical_tangent),
        cmocka_unit_test(bound_of_equal_stretches_is_exact),
        cmocka_unit_test(deep_compression_has_finite_stress),
        cmocka_unit_test(integral_of_unloading_is_that_of_quadrature),
        cmocka_unit_test(alpha_of_one_is_the_old_law),
        cmocka_unit_test(stored_and_lost_energy_is_the_work_done),
        cmocka_unit_test(bound_on_the_reversal_is_a_secant),
        cmocka_unit_test(positive_terms_are_stable),
        cmocka_unit_test(unstable_term_is_named_with_its_strain),
        cmocka_unit_test(terms_that_mean_nothing_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
