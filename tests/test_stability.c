/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bound on the highest frequency against exact eigenvalues of small clouds. */
#include "extreme.h"
#include "model/stability.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdbool.h>
#include <string.h>
#include <cmocka.h>

#include "point_fixture.h"
#include "post_check.h"

enum { NODES = 20, ENTRIES = NODES * NODES };

/* A cloud by hand, and the model that points into it. */
typedef struct cloud {
    sf_model model;
    double mass[NODES], volume[NODES], b[3 * ENTRIES];
    int64_t ptr[NODES + 1];
    int32_t node[ENTRIES];
} cloud;

static void cloud_init(cloud *c, int nodes) {
    memset(c, 0, sizeof *c);
    c->model.node_count = nodes;
    c->model.mass = c->mass;
    c->model.volume = c->volume;
    c->model.domain_ptr = c->ptr;
    c->model.domain_node = c->node;
    c->model.domain_b = c->b;
}

/* Appends node `j` with gradient b to the domain that is being filled. */
static void cloud_add(cloud *c, int j, double x, double y, double z) {
    const double b[3] = {x, y, z};
    memcpy(&c->b[3 * c->model.domain_nnz], b, sizeof b);
    c->node[c->model.domain_nnz++] = j;
}

static void cloud_close(cloud *c, int domain) {
    c->ptr[domain + 1] = c->model.domain_nnz;
}

/* Chain of spacing h and unit section, smoothed gradients (u[i+1] - u[i-1]) / 2h; closed to a ring or with
 * free ends, where the difference is one-sided. */
static void make_chain(cloud *c, int nodes, double h, double density, bool ring) {
    cloud_init(c, nodes);
    for (int i = 0; i < nodes; i++) {
        bool first = i == 0 && !ring, last = i + 1 == nodes && !ring;
        double reach = first || last ? h : 2 * h;
        c->volume[i] = first || last ? h / 2 : h;
        c->mass[i] = density * c->volume[i];
        cloud_add(c, first ? i : (i + nodes - 1) % nodes, -1 / reach, 0, 0);
        cloud_add(c, last ? i : (i + 1) % nodes, 1 / reach, 0, 0);
        cloud_close(c, i);
    }
}

/* Domains that see random nodes with random gradients of very different sizes. */
static void make_random_cloud(cloud *c, uint64_t *seed) {
    cloud_init(c, NODES);
    for (int i = 0; i < NODES; i++) {
        c->volume[i] = pow(10, point_random(seed, -1, 1));
        c->mass[i] = pow(10, point_random(seed, -1, 1));
        double size = pow(10, point_random(seed, -1, 1));
        for (int j = 0; j < NODES; j++)
            if (j == i || point_random(seed, 0, 1) < 0.3)
                cloud_add(c, j, point_random(seed, -size, size), point_random(seed, -size, size),
                          point_random(seed, -size, size));
        cloud_close(c, i);
    }
}

/* Lattice of 3 x 3 x 2 nodes with one-sided and central differences along its axes. */
static void make_lattice(cloud *c) {
    static const int size[3] = {3, 3, 2}, stride[3] = {6, 2, 1};
    cloud_init(c, 18);
    for (int i = 0; i < 18; i++) {
        const int at[3] = {i / 6, i / 2 % 3, i % 2};
        double own[3] = {0};
        c->volume[i] = 1;
        for (int a = 0; a < 3; a++) {
            bool low = at[a] == 0, high = at[a] + 1 == size[a];
            double b[3] = {0};
            b[a] = low || high ? 1 : 0.5;
            c->volume[i] *= low || high ? 0.5 : 1;
            if (high)
                own[a] += b[a];
            else
                cloud_add(c, i + stride[a], b[0], b[1], b[2]);
            if (low)
                own[a] -= b[a];
            else
                cloud_add(c, i - stride[a], -b[0], -b[1], -b[2]);
        }
        cloud_add(c, i, own[0], own[1], own[2]);
        c->mass[i] = 3 * c->volume[i];
        cloud_close(c, i);
    }
}

/* Largest eigenvalue of M^-1/2 sum_L V_L B_L^T D_L B_L M^-1/2, with D = tangent[L] [9][9] over (component,
 * gradient). */
static double exact_largest(const cloud *c, double (*tangent)[81]) {
    static double k[9 * NODES * NODES];
    int n = (int)c->model.node_count, size = 3 * n;
    memset(k, 0, sizeof k);
    for (int l = 0; l < n; l++)
        for (int64_t p = c->ptr[l]; p < c->ptr[l + 1]; p++)
            for (int64_t q = c->ptr[l]; q < c->ptr[l + 1]; q++)
                for (int e = 0; e < 81; e++) {
                    int row = 3 * c->node[p] + e / 27, column = 3 * c->node[q] + e / 3 % 3;
                    double mass = sqrt(c->mass[c->node[p]] * c->mass[c->node[q]]);
                    k[row * size + column] +=
                        c->volume[l] * tangent[l][e] * c->b[3 * p + e / 9 % 3] * c->b[3 * q + e % 3] / mass;
                }
    return point_largest_eigenvalue(size, k);
}

/* a times identity: every direction as stiff as the bound allows. */
static void isotropic_tangent(double a, double tangent[81]) {
    memset(tangent, 0, 81 * sizeof *tangent);
    for (int k = 0; k < 9; k++)
        tangent[10 * k] = a;
}

/* Symmetric, positive semidefinite, of random rank; returns its largest eigenvalue. */
static double random_tangent(uint64_t *seed, double tangent[81]) {
    memset(tangent, 0, 81 * sizeof *tangent);
    int rank = 1 + (int)point_random(seed, 0, 5);
    for (int r = 0; r < rank; r++) {
        double v[9], size = pow(10, point_random(seed, -2, 2));
        for (int k = 0; k < 9; k++)
            v[k] = point_random(seed, -size, size);
        for (int e = 0; e < 81; e++)
            tangent[e] += v[e / 9] * v[e % 9];
    }
    return point_largest_eigenvalue(9, tangent);
}

static void constants_of(const cloud *c, double constant[NODES]) {
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_stability_constants(&c->model, constant, &err), SF_OK);
}

/* The inner domains of a chain: omega^2 = a / (rho h^2), the exact top of the spectrum of a ring. */
static void bound_is_exact_on_a_ring(void **state) {
    (void)state;
    const double h = 0.004, density = 35, a = 0.7e6;
    cloud c;
    double constant[NODES], tangent[NODES][81];
    make_chain(&c, 12, h, density, true); /* a multiple of 4 holds the wave + 0 - 0 */
    constants_of(&c, constant);
    for (int l = 0; l < 12; l++) {
        isotropic_tangent(a, tangent[l]);
        assert_relative(constant[l], 1 / (density * h * h), 1e-12);
    }
    assert_relative(exact_largest(&c, tangent), a / (density * h * h), 1e-12);
}

/* One domain, nothing shared: omega^2 = a V lambda_max(sum B B^T / m). */
static void bound_is_exact_on_a_single_domain(void **state) {
    (void)state;
    uint64_t seed = 30;
    for (int trial = 0; trial < 50; trial++) {
        cloud c;
        double constant[NODES], tangent[NODES][81];
        cloud_init(&c, 6);
        for (int i = 0; i < 6; i++) {
            c.mass[i] = point_random(&seed, 0.1, 10);
            c.volume[i] = point_random(&seed, 0.1, 10);
            if (i == 0)
                for (int j = 0; j < 6; j++)
                    cloud_add(&c, j, point_random(&seed, -1, 1), point_random(&seed, -1, 1),
                              point_random(&seed, -1, 1));
            cloud_close(&c, i);
            isotropic_tangent(2.5, tangent[i]);
        }
        constants_of(&c, constant);
        assert_relative(2.5 * constant[0], exact_largest(&c, tangent), 1e-10);
        for (int l = 1; l < 6; l++)
            assert_close(constant[l], 0, 0); /* sees no node */
    }
}

/* max a c >= omega^2, and not absurdly above it. */
static void assert_bounds(const cloud *c, const double a[NODES], double (*tangent)[81], double slack) {
    double constant[NODES], bound = 0, exact = exact_largest(c, tangent);
    constants_of(c, constant);
    for (int l = 0; l < c->model.node_count; l++)
        bound = larger(bound, a[l] * constant[l]);
    if (!(bound >= exact * (1 - 1e-12)))
        fail_msg("the bound %.9g is below the largest eigenvalue %.9g", bound, exact);
    if (!(bound <= slack * exact))
        fail_msg("the bound %.9g is more than %g times the largest eigenvalue %.9g", bound, slack, exact);
}

static void bound_holds_for_uniform_tangents(void **state) {
    (void)state;
    uint64_t seed = 31;
    cloud c;
    double a[NODES], tangent[NODES][81];
    for (int l = 0; l < NODES; l++) {
        a[l] = 4e5;
        isotropic_tangent(a[l], tangent[l]);
    }
    make_chain(&c, 15, 0.01, 35, false);
    assert_bounds(&c, a, tangent, 2.5);
    make_lattice(&c);
    assert_bounds(&c, a, tangent, 2.5);
    for (int trial = 0; trial < 60; trial++) {
        make_random_cloud(&c, &seed);
        assert_bounds(&c, a, tangent, 6);
    }
}

/* From domain to domain the tangents differ by orders of magnitude, in size and direction. */
static void bound_holds_for_random_tangents(void **state) {
    (void)state;
    uint64_t seed = 32;
    cloud c;
    double a[NODES], tangent[NODES][81];
    for (int trial = 0; trial < 150; trial++) {
        for (int l = 0; l < NODES; l++) {
            if (trial % 2) {
                a[l] = random_tangent(&seed, tangent[l]);
            } else {
                a[l] = pow(10, point_random(&seed, -2, 2));
                isotropic_tangent(a[l], tangent[l]);
            }
        }
        if (trial % 3 == 0)
            make_chain(&c, 15, 0.01, 35, trial % 6 == 0);
        else if (trial % 3 == 1)
            make_lattice(&c);
        else
            make_random_cloud(&c, &seed);
        assert_bounds(&c, a, tangent, INFINITY); /* shares that ignore the tangents can be far too careful */
    }
}

/* With the smallest step of the domains, 2 dt C + dt^2 K <= 4 M. */
static void step_is_stable_with_random_tangents_and_viscosities(void **state) {
    (void)state;
    uint64_t seed = 33;
    for (int trial = 0; trial < 60; trial++) {
        cloud c;
        double constant[NODES], a[NODES], eta[NODES], tangent[NODES][81], dt = INFINITY;
        make_random_cloud(&c, &seed);
        constants_of(&c, constant);
        for (int l = 0; l < NODES; l++) {
            a[l] = pow(10, point_random(&seed, -2, 2));
            eta[l] = pow(10, point_random(&seed, -3, 1));
            dt = smaller(dt, sf_stability_step(constant[l], a[l], eta[l]));
        }
        for (int l = 0; l < NODES; l++)
            isotropic_tangent(2 * dt * eta[l] + dt * dt * a[l], tangent[l]);
        assert_true(exact_largest(&c, tangent) <= 4 * (1 + 1e-12));
    }
}

/* ---- the step ---- */

static void step_solves_its_quadratic(void **state) {
    (void)state;
    uint64_t seed = 34;
    for (int trial = 0; trial < 2000; trial++) {
        double c = pow(10, point_random(&seed, -3, 8)), a = pow(10, point_random(&seed, 2, 9)),
               eta = pow(10, point_random(&seed, -12, 6)), dt = sf_stability_step(c, a, eta);
        assert_true(dt > 0);
        assert_relative(c * (a * dt * dt + 2 * eta * dt), 4, 1e-13);
    }
    assert_relative(sf_stability_step(50, 2e6, 0), 2 / sqrt(50 * 2e6), 1e-15); /* 2 / omega */
    assert_relative(sf_stability_step(50, 0, 30), 2 / (50 * 30.0), 1e-15);     /* diffusion */
}

/* Largest |d| of one oscillator in `steps` central differences, the damping taken from the last half step. */
static double amplitude(double c, double a, double eta, double dt, int steps) {
    double d = 1, v = 0, largest = 0;
    for (int k = 0; k < steps; k++) {
        v -= dt * (c * a * d + c * eta * v);
        d += dt * v;
        largest = larger(largest, fabs(d));
    }
    return largest;
}

static void central_differences_are_stable_just_below_the_step_and_not_above(void **state) {
    (void)state;
    const double damping[4] = {0, 1e-3, 3e-2, 1};
    for (int k = 0; k < 4; k++) {
        double c = 3e4, a = 5e5, eta = damping[k] * sqrt(a / c), dt = sf_stability_step(c, a, eta);
        assert_true(amplitude(c, a, eta, 0.995 * dt, 20000) < 100);
        assert_true(!(amplitude(c, a, eta, 1.005 * dt, 20000) < 1e6)); /* far above, it overflows to NaN */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bound_is_exact_on_a_ring),
        cmocka_unit_test(bound_is_exact_on_a_single_domain),
        cmocka_unit_test(bound_holds_for_uniform_tangents),
        cmocka_unit_test(bound_holds_for_random_tangents),
        cmocka_unit_test(step_is_stable_with_random_tangents_and_viscosities),
        cmocka_unit_test(step_solves_its_quadratic),
        cmocka_unit_test(central_differences_are_stable_just_below_the_step_and_not_above),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
