/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sampling of densities whose answers are known in closed form. */
#include "study/fit/posterior/posterior.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { TEN = 10 };

#define assert_close(value, expected, tolerance) assert_true(fabs((value) - (expected)) <= (tolerance))

/* ---- targets ---- */

/* Normal with mean i and covariance sd_i sd_j 0.9^|i-j|, sd_i = 10^(i/5), by the autoregression of its
 * scaled variables; its integral is exp(LOG_INTEGRAL). */
static const double LOG_INTEGRAL = -3.7;

static double deviation_of(int i) {
    return pow(10, i / 5.);
}

static double normal(const void *context, const double *u, const double *y) {
    (void)y;
    int n = *(const int *)context;
    double sum = 0, before = 0, log_norm = 0;
    for (int i = 0; i < n; i++) {
        double z = (u[i] - i) / deviation_of(i), sd = i == 0 ? 1 : sqrt(1 - 0.81);
        sum += pow((z - (i == 0 ? 0 : 0.9 * before)) / sd, 2);
        log_norm += log(sd * deviation_of(i)) + 0.5 * log(2 * M_PI);
        before = z;
    }
    return LOG_INTEGRAL - log_norm - 0.5 * sum;
}

/* Its first variable, and the square of its last about the mean. */
static void observe_normal(const void *context, const double *u, uint64_t seed, double *quantity) {
    int n = *(const int *)context;
    (void)seed;
    quantity[0] = u[0];
    quantity[1] = pow((u[n - 1] - (n - 1)) / deviation_of(n - 1), 2);
}

/* The same, but the first has no value beyond 2.5 standard deviations, and the second never has one. */
static void observe_gaps(const void *context, const double *u, uint64_t seed, double *quantity) {
    observe_normal(context, u, seed, quantity);
    quantity[0] = u[0] > 2.5 * deviation_of(0) ? NAN : u[0];
    quantity[1] = NAN;
}

/* x normal, y normal about 0.5 x^2: mean of y 0.5, its variance 0.1^2 + 0.5, integral 1. */
static double banana(const void *context, const double *u, const double *y) {
    (void)context;
    (void)y;
    double across = (u[1] - 0.5 * u[0] * u[0]) / 0.1;
    return -0.5 * (u[0] * u[0] + across * across) - log(2 * M_PI * 0.1);
}

/* Two normal modes of deviation 1 at -AWAY and AWAY in each of two variables. */
static const double AWAY = 15;

static double modes(const void *context, const double *u, const double *y) {
    (void)y;
    (void)context;
    double low = 0, high = 0;
    for (int i = 0; i < 2; i++) {
        low += pow(u[i] + AWAY, 2);
        high += pow(u[i] - AWAY, 2);
    }
    return -0.5 * fmin(low, high);
}

/* Three narrow ridges, told by their responses: u[2k] normal, u[2k+1] normal about exp(u[2k] / 2) with
 * deviation THIN. The mean of u[2k] is 0, that of 2 log u[2k+1] almost so. */
enum { RIDGES = 3, RIDGE_PARAMETERS = 2 * RIDGES };
static const double THIN = 0.1;

static bool respond_ridges(const void *context, const double *u, double *y) {
    (void)context;
    for (int k = 0; k < RIDGES; k++) {
        y[2 * k] = u[2 * k];
        y[2 * k + 1] = u[2 * k + 1] - exp(0.5 * u[2 * k]);
    }
    return true;
}

static double ridges(const void *context, const double *u, const double *y) {
    double own[RIDGE_PARAMETERS], sum = -RIDGES * log(2 * M_PI * THIN);
    if (!y)
        respond_ridges(context, u, own);
    y = y ? y : own;
    for (int k = 0; k < RIDGES; k++)
        sum -= 0.5 * (y[2 * k] * y[2 * k] + pow(y[2 * k + 1] / THIN, 2));
    return sum;
}

static void fill_start(int n, double factor, double *start, double *covariance) {
    memset(covariance, 0, (size_t)(n * n) * sizeof *covariance);
    for (int i = 0; i < n; i++) {
        start[i] = i + deviation_of(i);
        covariance[i * n + i] = pow(factor * deviation_of(i), 2);
    }
}

typedef void observer(const void *context, const double *u, uint64_t seed, double *quantity);

static sf_chains run_observed(const int *n, observer *observe, sf_chains_options options) {
    double start[TEN], covariance[TEN * TEN];
    const sf_target target = {
        .parameters = *n, .log_density = normal, .context = n, .quantities = 2, .observe = observe};
    sf_error err = SF_ERROR_INIT;
    sf_chains chains;
    fill_start(*n, 0.5, start, covariance);
    assert_int_equal(sf_chains_run(&target, start, covariance, &options, &chains, &err), SF_OK);
    return chains;
}

static sf_chains run_normal(const int *n, sf_chains_options options) {
    return run_observed(n, observe_normal, options);
}

/* ---- tests ---- */

/* Mean, deviations and correlations within four standard errors by the effective size. */
static void test_correlated_normal(void **state) {
    (void)state;
    const int n = TEN;
    sf_chains c = run_normal(&n, sf_chains_defaults(1));
    int count = c.chains * c.kept;
    assert_true(c.converged);
    for (int i = 0; i < n + 2; i++) {
        assert_true(c.rhat[i] < 1.02);
        assert_true(c.effective[i] > 400);
    }
    for (int i = 0; i < n; i++) {
        double mean = 0, square = 0, product = 0;
        for (int k = 0; k < count; k++) {
            double z = (c.sample[k * n + i] - i) / deviation_of(i);
            mean += z / count;
            square += z * z / count;
            if (i > 0)
                product += z * (c.sample[k * n + i - 1] - (i - 1)) / deviation_of(i - 1) / count;
        }
        assert_close(mean, 0, 4 / sqrt(c.effective[i]));
        assert_close(square, 1, 4 * sqrt(2 / c.effective[i]));
        if (i > 0)
            assert_close(product, 0.9, 4 * sqrt(2 / c.effective[i]));
    }
    sf_chains_free(&c);
}

/* A few states without a value of a quantity do not keep the chains from their criteria. */
static void test_missing_values(void **state) {
    (void)state;
    const int n = 4;
    sf_chains c = run_observed(&n, observe_gaps, sf_chains_defaults(1));
    int missing = 0;
    for (int k = 0; k < c.chains * c.kept; k++)
        missing += isnan(c.quantity[2 * k]); /* what was observed stays */
    assert_in_range(missing, 1, c.chains * c.kept / 20);
    assert_true(c.converged);
    assert_true(c.rhat[n] < 1.02 && c.effective[n] > 400);
    assert_true(isnan(c.rhat[n + 1]) && isnan(c.effective[n + 1])); /* no state has it */
    sf_chains_free(&c);
}

/* The integral lies within four of its own standard errors, which are small, for three kinds of density. */
static void test_evidence(void **state) {
    (void)state;
    const int sizes[] = {1, 4, TEN};
    for (int k = 0; k < 3; k++) {
        sf_chains c = run_normal(&sizes[k], sf_chains_defaults(3));
        const sf_target target = {.parameters = sizes[k], .log_density = normal, .context = &sizes[k]};
        sf_evidence e;
        sf_mixture m;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_mixture_fit(sizes[k], c.chains * c.kept, c.sample, 5, &m, &err), SF_OK);
        assert_int_equal(sf_evidence_estimate(&target, &m, 2000, 9, &e, &err), SF_OK);
        assert_true(e.trusted);
        assert_true(e.error < 0.04);
        assert_close(e.log_value, LOG_INTEGRAL, 4 * e.error);
        sf_chains_free(&c);
    }
}

static void test_banana(void **state) {
    (void)state;
    const double start[] = {1, 1}, covariance[] = {0.1, 0, 0, 0.1};
    const sf_target target = {.parameters = 2, .log_density = banana};
    sf_chains_options options = sf_chains_defaults(4);
    options.most_steps = 12000;
    sf_chains c;
    sf_mixture m;
    sf_evidence e;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_chains_run(&target, start, covariance, &options, &c, &err), SF_OK);
    assert_true(c.converged);
    double mean = 0, square = 0;
    int count = c.chains * c.kept;
    for (int k = 0; k < count; k++) {
        mean += c.sample[2 * k + 1] / count;
        square += pow(c.sample[2 * k + 1] - 0.5, 2) / count;
    }
    assert_close(mean, 0.5, 5 * sqrt(0.51 / c.effective[1]));
    assert_close(square, 0.51,
                 0.3); /* heavy tail: its standard error is 1.9 over the root of the effective size */
    assert_int_equal(sf_mixture_fit(2, count, c.sample, 5, &m, &err), SF_OK);
    assert_int_equal(sf_evidence_estimate(&target, &m, 4000, 9, &e, &err), SF_OK);
    assert_true(e.trusted);
    assert_close(e.log_value, 0, 4 * e.error + 0.01);
    sf_chains_free(&c);
}

/* Importance sampling from the wrong place says that it cannot be trusted. */
static void test_evidence_is_marked(void **state) {
    (void)state;
    const int n = 4;
    double start[TEN], covariance[TEN * TEN];
    const sf_target target = {.parameters = n, .log_density = normal, .context = &n};
    sf_mixture m;
    sf_evidence e;
    sf_error err = SF_ERROR_INIT;
    fill_start(n, 0.02, start, covariance);
    assert_int_equal(sf_mixture_single(n, start, covariance, 5, &m, &err), SF_OK);
    assert_int_equal(sf_evidence_estimate(&target, &m, 500, 9, &e, &err), SF_OK);
    assert_false(e.trusted);
}

/* Two modes found by different chains: only if they mix is the result called converged. */
static void test_modes(void **state) {
    (void)state;
    const double start[] = {0, 0}, covariance[] = {200, 199, 199, 200};
    const sf_target target = {.parameters = 2, .log_density = modes};
    int marked = 0;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        sf_chains_options options = sf_chains_defaults(seed);
        sf_chains c;
        sf_error err = SF_ERROR_INIT;
        int high = 0;
        options.burn_in_rounds = 1;
        options.round = 100;
        options.most_steps = 600;
        assert_int_equal(sf_chains_run(&target, start, covariance, &options, &c, &err), SF_OK);
        int count = c.chains * c.kept;
        for (int k = 0; k < count; k++)
            high += c.sample[2 * k] > 0;
        if (c.converged)
            assert_close((double)high / count, 0.5, 0.1);
        else
            marked++;
        sf_chains_free(&c);
    }
    assert_true(marked > 0);
}

static void test_rhat_and_effective_size(void **state) {
    (void)state;
    enum { CHAINS = 4, COUNT = 1000 };
    double *x = calloc(CHAINS * COUNT, sizeof *x);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    for (int k = 0; k < CHAINS * COUNT; k++)
        x[k] = gsl_ran_ugaussian(random);
    assert_true(sf_split_rhat(CHAINS, COUNT, x) < 1.005);
    assert_in_range((int)sf_effective_size(CHAINS, COUNT, x), 3000, 5500);
    for (int c = 0; c < CHAINS; c++) /* correlation 0.9: a nineteenth of the samples counts */
        for (int k = 1; k < COUNT; k++)
            x[c * COUNT + k] = 0.9 * x[c * COUNT + k - 1] + sqrt(0.19) * gsl_ran_ugaussian(random);
    assert_in_range((int)sf_effective_size(CHAINS, COUNT, x), 4000 / 19 * 2 / 3, 4000 / 19 * 3 / 2);
    for (int k = 0; k < CHAINS * COUNT; k++) /* one chain elsewhere */
        x[k] = gsl_ran_ugaussian(random) + (k < COUNT ? 1 : 0);
    assert_true(sf_split_rhat(CHAINS, COUNT, x) > 1.05);
    assert_true(sf_effective_size(CHAINS, COUNT, x) < 100);
    for (int k = 0; k < CHAINS * COUNT; k++) /* all chains drift alike: seen by the halves only */
        x[k] = gsl_ran_ugaussian(random) + 2. * (k % COUNT) / COUNT;
    assert_true(sf_split_rhat(CHAINS, COUNT, x) > 1.05);
    for (int k = 0; k < CHAINS * COUNT; k++)
        x[k] = k / COUNT;
    assert_true(isinf(sf_split_rhat(CHAINS, COUNT, x)));
    assert_true(sf_effective_size(CHAINS, COUNT, x) == 0);
    gsl_rng_free(random);
    free(x);
}

/* The same bits with 1, 2 and 4 threads; other bits with another seed. */
static void test_threads_and_seeds(void **state) {
    (void)state;
    const int n = 4;
    sf_chains_options options = sf_chains_defaults(7);
    sf_evidence e[3];
    sf_chains c[3];
    sf_error err = SF_ERROR_INIT;
    const sf_target target = {.parameters = n, .log_density = normal, .context = &n};
    for (int k = 0; k < 3; k++) {
        omp_set_num_threads(1 << k);
        c[k] = run_normal(&n, options);
        assert_int_equal(sf_evidence_estimate(&target, &c[k].proposal, 300, 9, &e[k], &err), SF_OK);
        assert_int_equal(c[k].kept, c[0].kept);
        assert_memory_equal(c[k].sample, c[0].sample, (size_t)(c[0].chains * c[0].kept * n) * sizeof(double));
        assert_memory_equal(&e[k].log_value, &e[0].log_value, sizeof(double));
    }
    omp_set_num_threads(1);
    options.seed = 8;
    sf_chains other = run_normal(&n, options);
    assert_true(other.sample[0] != c[0].sample[0]);
    sf_chains_free(&other);
    for (int k = 0; k < 3; k++)
        sf_chains_free(&c[k]);
}

/* A limit that is too low: the result says so. */
static void test_limit_is_marked(void **state) {
    (void)state;
    const int n = TEN;
    sf_chains_options options = sf_chains_defaults(1);
    options.burn_in_rounds = 1;
    options.round = options.most_steps = 40;
    sf_chains c = run_normal(&n, options);
    assert_false(c.converged);
    assert_int_equal(c.kept, 40);
    assert_true(isfinite(c.effective[n])); /* the quantities are observed all the same */
    sf_chains_free(&c);
}

/* Chains that know the responses walk along narrow, bent ridges, where those that do not know them stand
 * still; the emulator, a polynomial, is not the exponential, and the moments are right all the same. */
static void test_delayed_steps(void **state) {
    (void)state;
    double start[RIDGE_PARAMETERS] = {0}, covariance[RIDGE_PARAMETERS * RIDGE_PARAMETERS] = {0};
    sf_target target = {.parameters = RIDGE_PARAMETERS,
                        .log_density = ridges,
                        .responses = RIDGE_PARAMETERS,
                        .shape = RIDGE_PARAMETERS,
                        .respond = respond_ridges};
    for (int i = 0; i < RIDGE_PARAMETERS; i++) {
        start[i] = i % 2;
        covariance[i * RIDGE_PARAMETERS + i] = 0.01;
    }
    sf_error err = SF_ERROR_INIT;
    sf_chains c, again, blind;
    sf_chains_options options = sf_chains_defaults(5);
    assert_int_equal(sf_chains_run(&target, start, covariance, &options, &c, &err), SF_OK);
    assert_true(c.converged);
    for (int i = 0; i < RIDGE_PARAMETERS; i++) {
        double mean = 0, square = 0;
        int count = c.chains * c.kept;
        for (int k = 0; k < count; k++) {
            double u = c.sample[k * RIDGE_PARAMETERS + i], z = i % 2 ? 2 * log(u) : u;
            mean += z / count;
            square += z * z / count;
        }
        assert_close(mean, 0, 4 / sqrt(c.effective[i]));
        if (i % 2 == 0)
            assert_close(square, 1, 4 * sqrt(2 / c.effective[i]));
    }
    omp_set_num_threads(4); /* the same bits */
    assert_int_equal(sf_chains_run(&target, start, covariance, &options, &again, &err), SF_OK);
    omp_set_num_threads(1);
    assert_int_equal(again.kept, c.kept);
    assert_memory_equal(again.sample, c.sample,
                        (size_t)(c.chains * c.kept * RIDGE_PARAMETERS) * sizeof(double));
    sf_chains_free(&again);
    target.responses = 0;
    options.most_steps = (int)(c.evaluations / options.chains);
    assert_int_equal(sf_chains_run(&target, start, covariance, &options, &blind, &err), SF_OK);
    assert_false(blind.converged);
    sf_chains_free(&c);
    sf_chains_free(&blind);
}

/* ---- leave one out: mean of normal data with unit deviation and a prior N(0, 10^2) ---- */

enum { GROUPS = 4 };
typedef struct mean_of {
    double y[GROUPS];
} mean_of;

static double split_mean(const void *context, const double *u, const double *y, double *conditional) {
    const mean_of *m = context;
    (void)y;
    double sum = -0.5 * u[0] * u[0] / 100 - log(10 * sqrt(2 * M_PI));
    for (int g = 0; g < GROUPS; g++) {
        double one = -0.5 * pow(m->y[g] - u[0], 2) - 0.5 * log(2 * M_PI);
        if (conditional)
            conditional[g] = one;
        sum += one;
    }
    return sum;
}

static double mean_density(const void *context, const double *u, const double *y) {
    return split_mean(context, u, y, NULL);
}

/* The second case has an outlier, whose weights cannot be used. */
static void test_leave_one_out(void **state) {
    (void)state;
    const mean_of cases[] = {{{0.3, -0.4, 0.9, 0.1}}, {{0.3, -0.4, 6, 0.1}}};
    for (int k = 0; k < 4; k++) { /* without and with draws of a wider mixture */
        const double start = 0, variance = 1;
        const sf_grouped grouped = {
            .target = {.parameters = 1, .log_density = mean_density, .context = &cases[k % 2]},
            .groups = GROUPS,
            .split = split_mean};
        sf_leave_options leave = {
            .draws = k < 2 ? 0 : 2000, .effective = 300, .chains = sf_chains_defaults(1)};
        sf_left_out out[GROUPS];
        sf_chains c;
        sf_error err = SF_ERROR_INIT;
        bool sampled = false;
        assert_int_equal(sf_chains_run(&grouped.target, &start, &variance, &leave.chains, &c, &err), SF_OK);
        assert_int_equal(sf_leave_one_out(&grouped, &c, &leave, out, &err), SF_OK);
        for (int g = 0; g < GROUPS; g++) {
            double precision = 1. / 100 + GROUPS - 1, sum = 0;
            for (int h = 0; h < GROUPS; h++)
                sum += h == g ? 0 : cases[k % 2].y[h];
            double spread = 1 + 1 / precision, away = cases[k % 2].y[g] - sum / precision,
                   exact = -0.5 * (away * away / spread + log(2 * M_PI * spread));
            assert_true(out[g].converged);
            sampled = sampled || out[g].sampled;
            assert_close(out[g].log_density, exact, k % 2 == 1 && g == 2 ? 0.5 : 0.1);
        }
        assert_true(k == 1 ? sampled : k == 3 || !sampled);
        sf_chains_free(&c);
    }
}

/* Pareto-distributed weights give their shape back. */
static void test_pareto_shape(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    double *weight = calloc(COUNT, sizeof *weight);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_error err = SF_ERROR_INIT;
    for (int k = 2; k <= 10; k += 4) {
        for (int i = 0; i < COUNT; i++)
            weight[i] = -0.1 * k * log(gsl_rng_uniform_pos(random)) + 700;
        assert_close(sf_pareto_smooth(COUNT, weight, &err), 0.1 * k, 0.2);
    }
    gsl_rng_free(random);
    free(weight);
}

/* ---- weights of models ---- */

static void test_weights(void **state) {
    (void)state;
    const double density[3][3] = {{1, 2, 3}, {1, 2, 3}, {-9, -8, -NAN}};
    const double mixed[2][3] = {{5, 0, 0}, {0, 1, 1}}; /* one group for the first, two for the second */
    double weight[3], sum[] = {-1000, -1000 + log(3), -INFINITY};
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_predictive_weights(3, 3, &density[0][0], 1, weight, &err), SF_OK);
    assert_close(weight[0], 0.5, 1e-12);
    assert_true(weight[2] == 0);
    assert_int_equal(sf_predictive_weights(2, 3, &mixed[0][0], 1, weight, &err), SF_OK);
    assert_in_range((int)(100 * weight[0]), 60, 94); /* exp(3) would leave 0.95: the bootstrap doubts */
    sf_evidence_weights(3, sum, weight);
    assert_close(weight[1], 0.75, 1e-12);
    assert_true(weight[2] == 0);
}

/* ---- discrepancy ---- */

/* Two data, three places: density and conditional mean against the formulas with 2 x 2 matrices. */
static void test_discrepancy(void **state) {
    (void)state;
    enum { DRAWS = 20000 };
    const double place[] = {0.1, 0.2, 0.5}, jacobian[] = {1, 0.5, 0, 0, 0.3, 0.2},
                 base[] = {0.04, 0.01, 0.01, 0.09}, r[] = {0.5, -0.2}, tau = 0.3;
    const double effect[] = {0.1, 0, 0, 0.2}; /* of each datum its own error */
    const sf_discrepancy_size size = {tau, 1.5};
    double kernel[9], c[4], kj[6] = {0}, delta[3], x[2], sum[3] = {0}, sum_x[2] = {0};
    sf_discrepancy d;
    sf_error err = SF_ERROR_INIT;
    sf_kernel_fill(3, place, 0.12, kernel);
    assert_close(kernel[1], exp(-0.5 / 1.44), 1e-12);
    assert_int_equal(sf_discrepancy_build(2, 3, jacobian, kernel, 2, effect, base, &d, &err), SF_OK);
    for (int b = 0; b < 3; b++)
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++)
                kj[2 * b + i] += tau * tau * kernel[3 * b + k] * jacobian[3 * i + k];
    for (int i = 0; i < 4; i++) {
        c[i] = base[i] + 2.25 * effect[i] * effect[i];
        for (int b = 0; b < 3; b++)
            c[i] += jacobian[3 * (i / 2) + b] * kj[2 * b + i % 2];
    }
    double det = c[0] * c[3] - c[1] * c[2],
           s[] = {(c[3] * r[0] - c[1] * r[1]) / det, (c[0] * r[1] - c[2] * r[0]) / det};
    assert_close(sf_discrepancy_log_density(&d, r, size),
                 -0.5 * (r[0] * s[0] + r[1] * s[1] + log(det)) - log(2 * M_PI), 1e-10);
    /* With as many variables as data, or fewer, the other matrix is factorised: the same density. */
    sf_discrepancy few;
    const double none[] = {0};
    double one = kernel[0] * 0.09, c2[] = {base[0] + one, base[1] + 0.5 * one, base[3] + 0.25 * one},
           det2 = c2[0] * c2[2] - c2[1] * c2[1];
    assert_int_equal(sf_discrepancy_build(2, 1, (const double[]){1, 0.5}, kernel, 0, none, base, &few, &err),
                     SF_OK);
    assert_null(few.spread[0]);
    assert_close(
        sf_discrepancy_log_density(&few, r, size),
        -0.5 * ((c2[2] * r[0] * r[0] - 2 * c2[1] * r[0] * r[1] + c2[0] * r[1] * r[1]) / det2 + log(det2)) -
            log(2 * M_PI),
        1e-10);
    sf_discrepancy_free(&few);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    for (int k = 0; k < DRAWS; k++) {
        sf_discrepancy_draw(&d, r, size, random, delta, x);
        for (int i = 0; i < 2; i++)
            sum_x[i] += x[i] / DRAWS;
        for (int b = 0; b < 3; b++)
            sum[b] += delta[b] / DRAWS;
    }
    for (int b = 0; b < 3; b++)
        assert_close(sum[b], kj[2 * b] * s[0] + kj[2 * b + 1] * s[1], 4 * tau / sqrt(DRAWS));
    for (int i = 0; i < 2; i++)
        assert_close(sum_x[i], 2.25 * effect[3 * i] * s[i], 4 * 1.5 / sqrt(DRAWS));
    gsl_rng_free(random);
    sf_discrepancy_free(&d);
    assert_close(sf_half_normal(0, 0.1), 0.067449, 1e-6);
    assert_true(sf_half_normal(-8, 0.1) >= 0 && sf_half_normal(-8, 0.1) < 1e-10);
    assert_close(sf_half_normal(3, 1), 3.205, 1e-3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rhat_and_effective_size),
        cmocka_unit_test(test_correlated_normal),
        cmocka_unit_test(test_missing_values),
        cmocka_unit_test(test_evidence),
        cmocka_unit_test(test_banana),
        cmocka_unit_test(test_evidence_is_marked),
        cmocka_unit_test(test_modes),
        cmocka_unit_test(test_limit_is_marked),
        cmocka_unit_test(test_delayed_steps),
        cmocka_unit_test(test_threads_and_seeds),
        cmocka_unit_test(test_leave_one_out),
        cmocka_unit_test(test_pareto_shape),
        cmocka_unit_test(test_weights),
        cmocka_unit_test(test_discrepancy),
    };
    gsl_set_error_handler_off();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
