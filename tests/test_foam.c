/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rate-independent foam law: eigenvalues, loading, hysteresis, tension, tangent bound. */
#include "material/low_density_foam.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "foam_fixture.h"
#include "post_check.h"

/* ---- eigenvalues ---- */

static void sort3(double x[3]) {
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (x[j] > x[j + 1]) {
                double swap = x[j];
                x[j] = x[j + 1];
                x[j + 1] = swap;
            }
}

/* Q diag(values) Qt as (xx, yy, zz, xy, yz, xz). */
static void symmetric_from(const double values[3], const double q[9], double a[6]) {
    static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int k = 0; k < 6; k++) {
        a[k] = 0;
        for (int m = 0; m < 3; m++)
            a[k] += values[m] * q[3 * pair[k][0] + m] * q[3 * pair[k][1] + m];
    }
}

/* Eigenvalues and vectors of lane l reproduce `a` and `values` to `tolerance` of the largest value. */
static void assert_decomposes(double out[6][SF_LANES], double v[9][SF_LANES], int l, const double a[6],
                              const double values[3], double tolerance) {
    double found[3] = {out[0][l], out[1][l], out[2][l]}, sorted[3], vectors[9], turned[9], square[9],
           again[6];
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    foam_get(v, l, vectors);
    point_transpose(vectors, turned);
    point_product(turned, vectors, square);
    assert_close(point_distance(9, square, identity), 0, 1e-14);
    symmetric_from(found, vectors, again);
    double scale = fmax(fabs(values[0]), fmax(fabs(values[1]), fabs(values[2])));
    assert_close(point_distance(6, again, a), 0, tolerance * scale);
    memcpy(sorted, values, sizeof sorted);
    sort3(sorted);
    sort3(found);
    assert_close(point_distance(3, found, sorted), 0, tolerance * scale);
}

/* Distinct, repeated, nearly repeated, widely spread, in random axes, all in one batch. */
static void eigen_finds_given_values_and_orthogonal_vectors(void **state) {
    (void)state;
    const double cases[SF_LANES][3] = {{1, 2, 3},
                                       {0.04, 1, 1},
                                       {1, 1, 1},
                                       {0.25, 0.25, 1.2},
                                       {1, 1 + 1e-8, 1 - 1e-8},
                                       {1, 1 + 1e-14, 0.3},
                                       {1e-4, 1, 4},
                                       {0.7, 0.7 + 1e-12, 0.7 + 1e-5}};
    uint64_t seed = 2;
    for (int trial = 0; trial < 500; trial++) {
        double given[6][SF_LANES], a[6][SF_LANES], v[9][SF_LANES];
        for (int l = 0; l < SF_LANES; l++) {
            double q[9], s[6];
            point_rotation(&seed, q);
            symmetric_from(cases[l], q, s);
            for (int k = 0; k < 6; k++)
                given[k][l] = a[k][l] = s[k];
        }
        sf_foam_eigen(a, v);
        for (int l = 0; l < SF_LANES; l++) {
            double s[6];
            for (int k = 0; k < 6; k++)
                s[k] = given[k][l];
            assert_decomposes(a, v, l, s, cases[l], 1e-14);
        }
    }
}

/* One off-diagonal entry: mean +- sqrt(half difference^2 + off^2). Diagonal: unchanged, whatever the order.
 */
static void eigen_matches_closed_forms_of_plane_and_diagonal_matrices(void **state) {
    (void)state;
    double a[6][SF_LANES] = {{0}}, v[9][SF_LANES], given[6][SF_LANES];
    for (int l = 0; l < SF_LANES; l++) {
        a[0][l] = 1 + 0.1 * l;
        a[1][l] = 1;
        a[2][l] = 0.5;
        a[3 + l % 3][l] = l < 6 ? 0.2 : 0;
    }
    memcpy(given, a, sizeof a);
    sf_foam_eigen(a, v);
    static const int plane[3][3] = {{0, 1, 2}, {1, 2, 0}, {0, 2, 1}};
    for (int l = 0; l < SF_LANES; l++) {
        double x = given[plane[l % 3][0]][l], y = given[plane[l % 3][1]][l], off = given[3 + l % 3][l], s[6];
        double root = sqrt(0.25 * (x - y) * (x - y) + off * off);
        const double expected[3] = {0.5 * (x + y) + root, 0.5 * (x + y) - root, given[plane[l % 3][2]][l]};
        for (int k = 0; k < 6; k++)
            s[k] = given[k][l];
        assert_decomposes(a, v, l, s, expected, 4e-16 * 4);
    }
}

/* ---- loading ---- */

static void make_foam(sf_foam *foam, double hu, double shape) {
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 60, 0.8, 1);
    card.card.shared.hysteresis_hu = hu;
    card.card.shared.hysteresis_shape = shape;
    foam_build(&card, foam);
}

static double curve_stress(const sf_foam *foam, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, &energy);
    return stress;
}

static double curve_energy(const sf_foam *foam, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, &energy);
    return energy;
}

static void uniaxial_compression_is_the_curve_in_every_direction(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 0.01, 1);
    for (int axis = 0; axis < 3; axis++)
        for (double strain = 0.01; strain < 0.95; strain += 0.03) {
            double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, expected[9] = {0};
            f[4 * axis] = 1 - strain;
            expected[4 * axis] = -curve_stress(&foam, strain);
            foam_point point = foam_elastic(&foam, f, 0);
            assert_close(point_distance(9, point.p, expected), 0, 1e-9 * fabs(expected[4 * axis]));
            assert_relative(point.energy, curve_energy(&foam, strain), 1e-10);
            assert_close(point.factor, 1, 0);
        }
    sf_foam_free(&foam);
}

/* No Poisson effect: each direction has its own curve, and the energies add up. */
static void directions_are_uncoupled(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 1, 1);
    const double f[9] = {0.5, 0, 0, 0, 0.8, 0, 0, 0, 1.1};
    const double expected[9] = {
        -curve_stress(&foam, 0.5), 0, 0, 0, -curve_stress(&foam, 0.2), 0, 0, 0, 0.4e5};
    foam_point point = foam_elastic(&foam, f, 0);
    assert_close(point_distance(9, point.p, expected), 0, 1e-8 * fabs(expected[0]));
    assert_relative(point.energy, curve_energy(&foam, 0.5) + curve_energy(&foam, 0.2) + 0.5 * 0.4e6 * 0.01,
                    1e-10);
    assert_relative(point.stiffness,
                    fmax(0.4e6, (curve_stress(&foam, 0.5001) - curve_stress(&foam, 0.4999)) / 2e-4), 1e-4);
    sf_foam_free(&foam);
}

/* P(Q F) = Q P(F) and P(F Q) = P(F) Q, loading and unloading; stretches and energy do not notice. */
static void law_is_objective_and_isotropic(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 0.1, 2);
    uint64_t seed = 3;
    for (int trial = 0; trial < 400; trial++) {
        double f[9], q[9], moved[9], expected[9];
        point_deformation(&seed, 0.15, 1.3, f);
        point_rotation(&seed, q);
        double peak = trial % 2 ? 2 * foam_elastic(&foam, f, 0).energy : 0;
        foam_point point = foam_elastic(&foam, f, peak);
        double scale = point_norm(9, point.p);
        for (int side = 0; side < 2; side++) {
            point_product(side ? f : q, side ? q : f, moved);
            point_product(side ? point.p : q, side ? q : point.p, expected);
            foam_point turned = foam_elastic(&foam, moved, peak);
            assert_close(point_distance(9, turned.p, expected), 0, 1e-11 * scale);
            assert_relative(turned.energy, point.energy, 1e-11);
        }
        assert_true((point.factor < 1) == (peak > 0));
    }
    sf_foam_free(&foam);
}

static void rigid_rotation_makes_no_stress(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 0.01, 1);
    uint64_t seed = 4;
    for (int trial = 0; trial < 200; trial++) {
        double q[9];
        point_rotation(&seed, q);
        foam_point point = foam_elastic(&foam, q, 0);
        assert_close(point_norm(9, point.p), 0, 1e-14 * 0.4e6 * 10);
        assert_close(point.energy, 0, 1e-20);
    }
    sf_foam_free(&foam);
}

static void stress_is_derivative_of_energy_while_loading(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 0.01, 1);
    uint64_t seed = 5;
    for (int trial = 0; trial < 200; trial++) {
        double f[9], h = 1e-6;
        point_deformation(&seed, 0.15, 1.3, f);
        foam_point point = foam_elastic(&foam, f, 0);
        for (int k = 0; k < 9; k++) {
            double moved[9];
            memcpy(moved, f, sizeof moved);
            moved[k] = f[k] + h;
            double up = foam_elastic(&foam, moved, 0).energy;
            moved[k] = f[k] - h;
            double down = foam_elastic(&foam, moved, 0).energy;
            assert_close((up - down) / (2 * h), point.p[k], 1e-7 * point_norm(9, point.p));
        }
    }
    sf_foam_free(&foam);
}

/* ---- hysteresis ---- */

/* Loads along `path`(s), s = 0 .. 1, and unloads back; work done and work returned (J m-3). */
static void cycle(const sf_foam *foam, void (*path)(double s, double f[9]), double *done, double *returned) {
    enum { STEPS = 4000 };
    sf_law_batch batch;
    double old_p[9] = {0}, old_f[9];
    foam_reset(&batch);
    path(0, old_f);
    *done = *returned = 0;
    for (int k = 1; k <= 2 * STEPS; k++) {
        double f[9], p[9], work = 0;
        path((k <= STEPS ? k : 2 * STEPS - k) / (double)STEPS, f);
        foam_step(foam, 0, f, &batch);
        foam_get(batch.p, 0, p);
        for (int i = 0; i < 9; i++)
            work += 0.5 * (p[i] + old_p[i]) * (f[i] - old_f[i]);
        *(k <= STEPS ? done : returned) += k <= STEPS ? work : -work;
        memcpy(old_p, p, sizeof p);
        memcpy(old_f, f, sizeof f);
    }
}

static void compress_axially(double s, double f[9]) {
    foam_uniaxial(1 - 0.75 * s, f);
}

/* Compression in two directions, tension in the third, in oblique axes, while the point turns by 1 rad. */
static void compress_and_turn(double s, double f[9]) {
    const double axis[3] = {0.6, 0, 0.8}, other[3] = {0, 0.28, 0.96};
    const double stretch[9] = {1 - 0.6 * s, 0, 0, 0, 1 - 0.3 * s * s, 0, 0, 0, 1 + 0.1 * s};
    double turn[9], lay[9], part[9];
    point_rotation_about(axis, s, turn);
    point_rotation_about(other, 0.7, lay);
    point_product(turn, stretch, part);
    point_product(part, lay, f);
}

static void returned_energy_fraction_depends_on_hu_and_shape_only(void **state) {
    (void)state;
    const double hu[5] = {0.01, 0.01, 0.2, 0.5, 1}, shape[5] = {1, 4, 0.5, 2, 3};
    for (int k = 0; k < 5; k++)
        for (int curve = 0; curve < 2; curve++)
            for (int path = 0; path < 2; path++) {
                point_card card;
                sf_foam foam;
                double done, returned;
                point_card_init(&card);
                card.card.shared.hysteresis_hu = hu[k];
                card.card.shared.hysteresis_shape = shape[k];
                if (curve == 0)
                    point_card_add_eva(&card, 0, 60, 0.6, 1); /* into the densification */
                else
                    point_card_add_line(&card, 3e5, 0.8);
                foam_build(&card, &foam);
                cycle(&foam, path ? compress_and_turn : compress_axially, &done, &returned);
                assert_close(returned / done, hu[k] + (1 - hu[k]) / (1 + shape[k]), 1e-4);
                if (k == 0)
                    assert_close(returned / done, 0.505, 1e-4); /* the EVA of the paper */
                sf_foam_free(&foam);
            }
}

static void unloading_follows_the_factor_and_reloading_retraces_it(void **state) {
    (void)state;
    const double hu = 0.05, shape = 1.5;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], unloading[50];
    make_foam(&foam, hu, shape);
    foam_reset(&batch);
    foam_uniaxial(0.3, f);
    foam_step(&foam, 0, f, &batch);
    double peak = curve_energy(&foam, 0.7);
    assert_relative(batch.history[SF_FOAM_PEAK][0], peak, 1e-10);
    for (int k = 0; k < 50; k++) {
        double strain = 0.69 * (49 - k) / 49;
        foam_uniaxial(1 - strain, f);
        foam_step(&foam, 0, f, &batch);
        unloading[k] = batch.p[0][0];
        double factor = 1 - (1 - hu) * (1 - pow(curve_energy(&foam, strain) / peak, shape));
        assert_relative(batch.factor[0], factor, 1e-9);
        assert_close(unloading[k], -factor * curve_stress(&foam, strain), 1e-9 * curve_stress(&foam, strain));
        assert_relative(batch.history[SF_FOAM_PEAK][0], peak, 1e-10);
    }
    for (int k = 49; k >= 0; k--) {
        foam_uniaxial(1 - 0.69 * (49 - k) / 49, f);
        foam_step(&foam, 0, f, &batch);
        assert_close(batch.p[0][0], unloading[k], 0);
    }
    foam_uniaxial(0.25, f); /* beyond the old maximum: the curve again */
    foam_step(&foam, 0, f, &batch);
    assert_relative(batch.p[0][0], -curve_stress(&foam, 0.75), 1e-9);
    assert_relative(batch.history[SF_FOAM_PEAK][0], curve_energy(&foam, 0.75), 1e-9);
    sf_foam_free(&foam);
}

/* Load, unload partly, reload beyond, unload fully: stored + lost is the work done at every instant. */
static void stored_and_lost_energy_is_the_work_done(void **state) {
    (void)state;
    enum { STEPS = 3000 };
    const double turn[5] = {0, 0.7, 0.2, 1, 0};
    sf_foam foam;
    sf_law_batch batch;
    double old_p[9] = {0}, old_f[9], work = 0, stored = 0, lost = 0, old_lost = 0;
    make_foam(&foam, 0.1, 1.7);
    foam_reset(&batch);
    compress_and_turn(1, old_f);
    double peak = foam_elastic(&foam, old_f, 0).energy;
    compress_and_turn(0, old_f);
    for (int k = 1; k <= 4 * STEPS; k++) {
        int leg = (k - 1) / STEPS;
        double x = (double)(k - leg * STEPS) / STEPS, f[9], p[9];
        compress_and_turn(turn[leg] + x * (turn[leg + 1] - turn[leg]), f);
        foam_step(&foam, 0, f, &batch);
        foam_get(batch.p, 0, p);
        for (int i = 0; i < 9; i++)
            work += 0.5 * (p[i] + old_p[i]) * (f[i] - old_f[i]);
        sf_foam_energies(&foam, batch.energy[0], batch.history[SF_FOAM_PEAK][0], &stored, &lost);
        assert_close(stored + lost, work, 2e-6 * peak);
        assert_true(lost >= old_lost && stored >= 0);
        old_lost = lost;
        memcpy(old_p, p, sizeof p);
        memcpy(old_f, f, sizeof f);
    }
    assert_relative(batch.history[SF_FOAM_PEAK][0], peak, 1e-12);
    assert_close(stored, 0, 1e-9 * peak);
    assert_relative(lost / peak, (1 - 0.1) * 1.7 / 2.7, 1e-12);
    sf_foam_energies(&foam, 0, 0, &stored, &lost); /* never loaded */
    assert_close(stored, 0, 0);
    assert_close(lost, 0, 0);
    sf_foam_free(&foam);
}

/* ---- tension ---- */

static void tension_has_the_modulus_up_to_the_cutoff(void **state) {
    (void)state;
    point_card card;
    sf_foam foam;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 60, 0.8, 1);
    card.card.tension_cutoff = 3e4; /* reached at a strain of 0.075 */
    foam_build(&card, &foam);
    double first_slope, none;
    sf_curve_evaluate(&foam.curve[0], 0, &none, &first_slope, &none);
    for (double strain = 0.005; strain < 0.3; strain += 0.01) {
        double f[9];
        foam_uniaxial(1 + strain, f);
        foam_point point = foam_elastic(&foam, f, 0);
        assert_relative(point.p[0], fmin(0.4e6 * strain, 3e4), 1e-12);
        double energy = strain < 0.075 ? 0.2e6 * strain * strain : 3e4 * (strain - 0.0375);
        assert_relative(point.energy, energy, 1e-11);
        assert_true(point.stiffness == fmax(0.4e6, first_slope));
    }
    sf_foam_free(&foam);
}

/* ---- tangent ---- */

/* Random F; history of twice its energy where `unloading`. Compares the largest eigenvalue of the numerical
 * tangent. */
static void assert_tangent_bounds(const sf_foam *foam, uint64_t *seed, bool unloading) {
    sf_law_batch batch;
    double f[9], tangent[81];
    point_deformation(seed, 0.12, 1.3, f);
    double peak = unloading ? point_random(seed, 1.05, 10) * foam_elastic(foam, f, 0).energy : 0;
    foam_reset(&batch);
    foam_step(foam, 0, f, &batch);
    batch.history[SF_FOAM_PEAK][0] = peak;
    foam_tangent(foam, 0, &batch, tangent);
    sf_law_batch after = batch;
    sf_foam_update(foam, 0, &after);
    foam_assert_bounds(&after, tangent);
    if (!unloading) /* nothing is lost in the bound: the largest of slopes, differences and sums is an
                       eigenvalue */
        assert_relative(point_largest_eigenvalue(9, tangent), after.tangent[0], 1e-6);
}

static void tangent_bounds_the_numerical_tangent(void **state) {
    (void)state;
    const double shape[4] = {1, 0.5, 2, 8};
    uint64_t seed = 6;
    for (int k = 0; k < 4; k++) {
        sf_foam foam;
        make_foam(&foam, 0.01, shape[k]);
        if (k == 0)
            foam.cutoff = 8e3; /* reached at a strain of 0.02: no slope beyond, but shear moduli */
        for (int trial = 0; trial < 400; trial++)
            assert_tangent_bounds(&foam, &seed, trial % 2);
        sf_foam_free(&foam);
    }
}

/* In uniaxial unloading the steepest direction carries all the stress: sigma' f + f' sigma^2 is exact. */
static void tangent_of_uniaxial_unloading_is_exact(void **state) {
    (void)state;
    sf_foam foam;
    make_foam(&foam, 0.01, 2);
    for (double strain = 0.5013; strain < 0.9; strain += 0.05) { /* between the table's ends of pieces */
        double f[9], h = 1e-6;
        double peak = 1.3 * curve_energy(&foam, strain);
        foam_uniaxial(1 - strain - h, f);
        double up = foam_elastic(&foam, f, peak).p[0];
        foam_uniaxial(1 - strain + h, f);
        double down = foam_elastic(&foam, f, peak).p[0];
        foam_uniaxial(1 - strain, f);
        assert_relative(foam_elastic(&foam, f, peak).tangent, (down - up) / (2 * h), 1e-6);
    }
    sf_foam_free(&foam);
}

/* At rest the next step may go either way: the bound covers the moduli of tension and of compression. */
static void undeformed_point_has_the_larger_of_both_moduli(void **state) {
    (void)state;
    for (int soft = 0; soft < 2; soft++) {
        sf_foam foam;
        double identity[9], stress, slope, energy;
        make_foam(&foam, 0.01, 1);
        foam.modulus = soft ? 1e4 : 1e6;
        foam_uniaxial(1, identity);
        sf_curve_evaluate(&foam.curve[0], 0, &stress, &slope, &energy);
        foam_point point = foam_elastic(&foam, identity, 0);
        assert_relative(point.tangent, fmax(foam.modulus, slope), 1e-12);
        assert_close(point_norm(9, point.p), 0, 0);
        assert_close(point.energy, 0, 0);
        point = foam_elastic(&foam, identity, 1e5); /* fully unloaded */
        assert_true(point.tangent > 0 && point.tangent <= fmax(foam.modulus, slope) * (1 + 1e-12));
        assert_relative(point.factor, 0.01, 1e-12);
        sf_foam_free(&foam);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eigen_finds_given_values_and_orthogonal_vectors),
        cmocka_unit_test(eigen_matches_closed_forms_of_plane_and_diagonal_matrices),
        cmocka_unit_test(uniaxial_compression_is_the_curve_in_every_direction),
        cmocka_unit_test(directions_are_uncoupled),
        cmocka_unit_test(law_is_objective_and_isotropic),
        cmocka_unit_test(rigid_rotation_makes_no_stress),
        cmocka_unit_test(stress_is_derivative_of_energy_while_loading),
        cmocka_unit_test(returned_energy_fraction_depends_on_hu_and_shape_only),
        cmocka_unit_test(unloading_follows_the_factor_and_reloading_retraces_it),
        cmocka_unit_test(stored_and_lost_energy_is_the_work_done),
        cmocka_unit_test(tension_has_the_modulus_up_to_the_cutoff),
        cmocka_unit_test(tangent_bounds_the_numerical_tangent),
        cmocka_unit_test(tangent_of_uniaxial_unloading_is_exact),
        cmocka_unit_test(undeformed_point_has_the_larger_of_both_moduli),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
