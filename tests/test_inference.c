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

/* `whole`: chains of a length that can reach their criteria; else as short as the comparison of bits needs.
 */
static laboratory_tally identify(int threads, bool whole) {
    laboratory *lab = malloc(sizeof *lab);
    laboratory_tally tally = {.foams = 0};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_inference_options o = sf_inference_defaults(1);
    o.chains.burn_in_rounds = o.without.chains.burn_in_rounds = whole ? 3 : 1;
    o.chains.round = o.without.chains.round = whole ? 120 : 40;
    o.chains.most_steps = o.without.chains.most_steps = whole ? 960 : 40;
    o.chains.most_kept = 250;
    o.chains.rhat = o.without.chains.rhat = 1.05;
    o.chains.effective = o.without.chains.effective = 100;
    o.without.effective = 50;
    o.without.draws = whole ? o.without.draws : 0;
    o.evidence_draws = whole ? o.evidence_draws : 60;
    omp_set_num_threads(threads);
    gsl_rng_set(random, 1);
    assert_non_null(lab);
    laboratory_init(lab);
    laboratory_measure(lab, random);
    laboratory_identify(lab, &o, &tally);
    gsl_rng_free(random);
    free(lab);
    return tally;
}

static void test_threads(void **state) {
    (void)state;
    laboratory_tally one = identify(1, false), two = identify(2, false);
    assert_memory_equal(&one, &two, sizeof one); /* the same bits */
    assert_int_equal(one.failed, 0);
    assert_int_equal(one.reached, 0); /* such short chains are marked */
}

static void test_average(void **state) {
    (void)state;
    laboratory_tally t = identify(2, true);
    double sum = 0;
    assert_int_equal(t.failed, 0);
    assert_int_equal(t.reached, 1); /* R-hat and effective size, which need the delayed steps */
    for (int m = 0; m < LAB_MODELS; m++)
        sum += t.weight[m];
    assert_true(fabs(sum - 1) < 1e-12);
    /* The thinner pad sees strains that the measured drops do not: its a_max is less certain. */
    assert_true(t.width[3][SF_FIT_A_MAX] > 1.3 * t.width[4][SF_FIT_A_MAX]);
    for (int d = LAB_MEASURED; d < LAB_DROPS; d++)
        assert_true(t.miss[d][SF_FIT_A_MAX] < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_threads), cmocka_unit_test(test_average)};
    gsl_set_error_handler_off();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
