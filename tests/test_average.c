/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions of a posterior some of whose draws have no value, as their foam collapses: peaks count as above
 * every value, the HIC window is that of the others, and table, terminal and fit.json say so. */
#include "study/fit/drop/inference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { CHAINS = 3, KEPT = 333, STATES = CHAINS * KEPT, KINDS = 3, PARAMETERS = 2 };

enum { NO_COLUMNS = STATES + 1 };

/* States 1 to STATES, of which the last `collapsed` have no value; the others the logarithm of their number.
 * NO_COLUMNS: none has one. */
typedef struct posterior {
    sf_fit_input input;
    sf_drop_fit fit;
    sf_drop_inference inference;
    sf_drop_average average;
    double quantity[STATES * KINDS], sample[STATES * PARAMETERS], diagnostic[PARAMETERS + KINDS];
} posterior;

static posterior *posterior_new(int collapsed) {
    posterior *p = calloc(1, sizeof *p);
    assert_non_null(p);
    p->input.form.curve = sf_curve_form_find("gas");
    p->input.drop_count = 1;
    p->input.drop[0].predicted = true;
    snprintf(p->input.drop[0].name, sizeof p->input.drop[0].name, "held");
    p->fit.input = &p->input;
    p->fit.columns[0].count = collapsed != NO_COLUMNS;
    p->inference = (sf_drop_inference){.fit = &p->fit,
                                       .parameters = PARAMETERS,
                                       .quantities = KINDS,
                                       .chains = {.parameters = PARAMETERS,
                                                  .quantities = KINDS,
                                                  .chains = CHAINS,
                                                  .kept = KEPT,
                                                  .sample = p->sample,
                                                  .quantity = p->quantity,
                                                  .rhat = p->diagnostic,
                                                  .effective = p->diagnostic,
                                                  .converged = true},
                                       .evidence = {.trusted = true}};
    for (int kind = 0; kind < KINDS; kind++)
        p->inference.quantity[kind] = (sf_drop_quantity){.drop = 0, .kind = kind};
    for (int s = 0; s < STATES; s++)
        for (int kind = 0; kind < KINDS; kind++)
            p->quantity[s * KINDS + kind] = s < STATES - collapsed ? log(s + 1) : NAN;
    p->average = (sf_drop_average){
        .models = 1, .model = {&p->inference}, .weight = {1}, .evidence_weight = {1}, .by_evidence = true};
    return p;
}

static void assert_quantiles(const posterior *p, int kind, double low, double median, double high) {
    static const double probability[] = {0.025, 0.5, 0.975};
    const double expected[] = {low, median, high};
    double value[3];
    sf_error err = SF_ERROR_INIT;
    for (int model = -1; model < 1; model++) { /* the average, and the model alone */
        assert_int_equal(sf_drop_average_quantiles(&p->average, model, kind, 3, probability, value, &err),
                         SF_OK);
        for (int q = 0; q < 3; q++)
            if (!(value[q] == expected[q] || fabs(value[q] / expected[q] - 1) < 1e-9))
                fail_msg("kind %d, quantile %d: %g in place of %g", kind, q, value[q], expected[q]);
    }
}

static void collapsed_draws_are_above_every_peak(void **state) {
    (void)state;
    static const struct {
        int collapsed;
        double low, median, high; /* of a_max and HIC */
    } cases[] = {{0, 25, 500, 975},
                 {20, 25, 500, 975}, /* fewer than the tail */
                 {40, 25, 500, INFINITY},
                 {600, 25, INFINITY, INFINITY},
                 {990, INFINITY, INFINITY, INFINITY}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        posterior *p = posterior_new(cases[k].collapsed);
        double rest = STATES - cases[k].collapsed;
        assert_quantiles(p, SF_FIT_A_MAX, cases[k].low, cases[k].median, cases[k].high);
        assert_quantiles(p, SF_FIT_HIC, cases[k].low, cases[k].median, cases[k].high);
        assert_quantiles(p, SF_FIT_WINDOW, ceil(0.025 * rest), ceil(0.5 * rest), ceil(0.975 * rest));
        assert_true(fabs(sf_drop_average_missing(&p->average, SF_FIT_A_MAX) - 1 + rest / STATES) < 1e-12);
        free(p);
    }
    posterior *p = posterior_new(STATES); /* nothing but collapse: no window at all */
    assert_quantiles(p, SF_FIT_A_MAX, INFINITY, INFINITY, INFINITY);
    double value, half = 0.5;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_drop_average_quantiles(&p->average, -1, SF_FIT_WINDOW, 1, &half, &value, &err),
                     SF_OK);
    assert_true(isnan(value));
    free(p);
}

/* A model's weight is shared by its states, however many it has. */
static void a_model_with_fewer_states_keeps_its_weight(void **state) {
    static const double probability[] = {0.3, 0.5, 0.9};
    const double expected[] = {ceil(0.3 / 0.6 * STATES), ceil(0.5 / 0.6 * STATES), 1e6};
    posterior *many = posterior_new(0), *few = posterior_new(0);
    double value[3];
    sf_error err = SF_ERROR_INIT;
    (void)state;
    few->inference.chains.kept = KEPT / 9;
    for (int s = 0; s < STATES * KINDS; s++)
        few->quantity[s] = log(1e6);
    many->average.models = 2;
    many->average.model[1] = &few->inference;
    many->average.weight[0] = 0.6;
    many->average.weight[1] = 0.4;
    assert_int_equal(sf_drop_average_quantiles(&many->average, -1, SF_FIT_A_MAX, 3, probability, value, &err),
                     SF_OK);
    for (int q = 0; q < 3; q++)
        assert_true(fabs(value[q] / expected[q] - 1) < 2.0 / STATES); /* a state more or less by rounding */
    free(many);
    free(few);
}

/* A single pad and drop has the scatter of thickness and speed beside: of values that are all the same the
 * interval is that of the scatter alone, and of two models the mean of both. Collapse stays above all. */
static void a_single_drop_scatters(void **state) {
    (void)state;
    static const double probability[] = {0.025, 0.5, 0.975};
    posterior *p = posterior_new(0), *other = posterior_new(0);
    double value[3];
    sf_error err = SF_ERROR_INIT;
    p->fit.simulated[0].scatter[0] = 0.2;
    p->fit.simulated[0].scatter[1] = NAN;
    for (int s = 0; s < STATES * KINDS; s++)
        p->quantity[s] = other->quantity[s] = log(100);
    const sf_drop_average *a = &p->average;
    assert_int_equal(sf_drop_average_quantiles(a, SF_SINGLE_DROP, SF_FIT_A_MAX, 3, probability, value, &err),
                     SF_OK);
    assert_true(fabs(log(value[1] / 100)) < 0.02);
    assert_true(fabs(log(value[2] / value[0]) / (2 * 1.96 * 0.2) - 1) < 0.1); /* 999 draws */
    sf_drop_average_quantiles(a, SF_ALL_MODELS, SF_FIT_A_MAX, 3, probability, value, &err);
    assert_true(fabs(value[0] - 100) < 1e-9 && fabs(value[2] - 100) < 1e-9);
    for (int kind = SF_FIT_HIC; kind < KINDS; kind++) { /* not known */
        sf_drop_average_quantiles(a, SF_SINGLE_DROP, kind, 3, probability, value, &err);
        assert_true(isnan(value[0]) && isnan(value[1]) && isnan(value[2]));
    }
    p->average.models = 2; /* the other does not scatter: half of the values stay */
    p->average.model[1] = &other->inference;
    p->average.weight[0] = p->average.weight[1] = 0.5;
    sf_drop_average_quantiles(a, SF_SINGLE_DROP, SF_FIT_A_MAX, 3, probability, value, &err);
    assert_true(fabs(log(value[2] / value[0]) / (2 * 1.645 * 0.2) - 1) < 0.1);
    for (int s = STATES - 40; s < STATES; s++)
        p->quantity[s * KINDS] = NAN;
    p->average.models = 1;
    sf_drop_average_quantiles(a, SF_SINGLE_DROP, SF_FIT_A_MAX, 3, probability, value, &err);
    assert_true(isinf(value[2]) && value[0] > 60);
    assert_int_equal(err.status, SF_OK);
    free(other);
    free(p);
}

/* What a writer writes. */
typedef sf_status write_part(FILE *file, const sf_drop_average *average, sf_error *err);

static sf_status write_json(FILE *file, const sf_drop_average *average, sf_error *err) {
    sf_json json = {.file = file, .empty = true};
    sf_json_open(&json, NULL, '{');
    sf_inference_json(&json, average, err);
    sf_json_close(&json);
    return err->status;
}

static char *text_of(write_part *write, int collapsed) {
    posterior *p = posterior_new(collapsed);
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    sf_error err = SF_ERROR_INIT;
    assert_non_null(file);
    assert_int_equal(write(file, &p->average, &err), SF_OK);
    fclose(file);
    free(p);
    return text;
}

static void assert_says(write_part *write, int collapsed, const char *part) {
    char *text = text_of(write, collapsed);
    if (!strstr(text, part))
        fail_msg("%d collapsed: no \"%s\" in:\n%s", collapsed, part, text);
    free(text);
}

static void every_output_says_open(void **state) {
    (void)state;
    assert_says(sf_inference_print, 0,
                "a_max 500.0 g (95 %: 25.0 to 975.0; of a single pad and drop: 25.0 to 975.0)\n");
    assert_says(
        sf_inference_print, 4,
        "a_max 500.0 g (95 %: 25.0 to 975.0; of a single pad and drop: 25.0 to 975.0); the columns of 0.4 % of the");
    assert_says(sf_inference_print, 40,
                "of a single pad and drop: from 25, open above); the columns of 4 % of the");
    assert_says(sf_inference_print, 600,
                "a_max above what the columns reach  (95 %: from 25.0, open above; of");
    assert_says(sf_inference_print, 0, "HIC window 500.00 ms (95 %: 25.00 to 975.00)\n"); /* not known */
    assert_says(sf_inference_html, 4, "held (the columns of 0.4 % of the draws collapse)");
    assert_says(sf_inference_html, 4, "The HIC window has no such order");
    assert_says(sf_inference_html, 40, "from 25.0, open above");
    assert_says(sf_inference_html, 990, "above what the columns reach");
    assert_says(write_json, 0, "\"high95\": 975,\n        \"open\": \"no\"");
    assert_says(write_json, 40, "\"high95\": null,\n        \"open\": \"above\"");
    assert_says(write_json, 600, "\"median\": null,\n        \"low95\": 25,\n        \"high95\": null");
    assert_says(write_json, STATES, "\"high95\": null,\n        \"open\": null"); /* of the window */
    assert_says(write_json, 4, "\"share_of_draws_without_value\": 0.004004");
    assert_says(sf_inference_print, NO_COLUMNS,
                "a_max –  (95 %: –); no columns, as its simulation failed before");
    assert_says(sf_inference_html, NO_COLUMNS,
                "held (no columns, as its simulation failed before the pad was");
    assert_says(write_json, NO_COLUMNS, "\"median\": null,\n        \"low95\": null");
    char *text = text_of(sf_inference_html, 0);
    assert_null(strstr(text, "collapse"));
    free(text);
    text = text_of(write_json, 40);
    assert_null(strstr(text, "inf,")); /* JSON has no infinity */
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collapsed_draws_are_above_every_peak),
        cmocka_unit_test(a_model_with_fewer_states_keeps_its_weight),
        cmocka_unit_test(a_single_drop_scatters),
        cmocka_unit_test(every_output_says_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
