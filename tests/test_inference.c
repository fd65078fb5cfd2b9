/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Posterior and average of models fitted to the drops of a foam that is of none of the forms; the coverage of
 * many foams is in verify/study_coverage_drop.c. */
#include "laboratory.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static laboratory_tally identify(int threads, unsigned long seed) {
    laboratory *lab = malloc(sizeof *lab);
    laboratory_tally tally = {.foams = 0};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_inference_options o = sf_inference_defaults(1);
    o.chains.burn_in_rounds = o.without.chains.burn_in_rounds = 1;
    o.chains.round = o.chains.most_steps = 60;
    o.without.draws = 0;
    o.without.chains.round = o.without.chains.most_steps = 40;
    o.evidence_draws = 60;
    omp_set_num_threads(threads);
    gsl_rng_set(random, seed);
    assert_non_null(lab);
    laboratory_init(lab);
    laboratory_measure(lab, random);
    laboratory_identify(lab, &o, &tally);
    gsl_rng_free(random);
    free(lab);
    return tally;
}

static void test_average(void **state) {
    (void)state;
    laboratory_tally one = identify(1, 1), two = identify(2, 1);
    double sum = 0;
    assert_memory_equal(&one, &two, sizeof one); /* the same bits */
    assert_int_equal(one.failed, 0);
    assert_int_equal(one.reached, 0); /* such short chains are marked */
    for (int m = 0; m < LAB_MODELS; m++)
        sum += one.weight[m];
    assert_true(fabs(sum - 1) < 1e-12);
    /* The thinner pad sees strains that the measured drops do not: its a_max is less certain. */
    assert_true(one.width[3][SF_FIT_A_MAX] > 1.3 * one.width[4][SF_FIT_A_MAX]);
    for (int d = LAB_MEASURED; d < LAB_DROPS; d++)
        assert_true(one.miss[d][SF_FIT_A_MAX] < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_average)};
    gsl_set_error_handler_off();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
