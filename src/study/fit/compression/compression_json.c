/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fit.json */
#include "study/fit/compression/compression_json.h"

#include "build_info.h"
#include "report/json.h"

static void put_tests(sf_json *json, const sf_compression_fit *fit, const sf_compression_check *check) {
    sf_json_open(json, "tests", '[');
    for (int k = 0; k < fit->data.config->test_count; k++) {
        const sf_compression_test *t = &fit->data.config->test[k];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "file", t->path);
        sf_json_text(json, "understood", t->interpretation);
        sf_json_number(json, "toe_strain", t->toe);
        sf_json_number(json, "rate_1_s", t->rate);
        sf_json_integer(json, "points_loading", t->loading);
        sf_json_integer(json, "points_unloading", t->count - t->loading);
        sf_json_number(json, "largest_strain", t->largest_strain);
        sf_json_number(json, "largest_stress_Pa", t->largest_stress);
        sf_json_number(json, "loading_rms_over_sigma", check->rms[k][0]);
        sf_json_number(json, "unloading_rms_over_sigma", check->rms[k][1]);
        sf_json_number(json, "loading_rms_percent", check->percent[k][0]);
        sf_json_number(json, "unloading_rms_percent", check->percent[k][1]);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_candidate(sf_json *json, const char *name, const sf_candidate *c) {
    if (!c->tried)
        return;
    sf_json_open(json, name, '{');
    sf_json_integer(json, "parameters", c->parameters);
    sf_json_number(json, "chi2", c->chi2);
    sf_json_number(json, "bic", c->bic);
    sf_json_close(json, '}');
}

static void put_choice(sf_json *json, const sf_compression_fit *fit) {
    static const char *const rules[SF_RULES] = {"H1_automatic", "H1_free", "H2"};
    sf_json_text(json, "rate_model", sf_rate_model_name(fit->model.form.rate));
    sf_json_open(json, "rate_models_tried", '{');
    for (int k = 0; k < SF_RATE_MODELS; k++)
        put_candidate(json, sf_rate_model_name((sf_rate_model)k), &fit->rate[k]);
    sf_json_close(json, '}');
    sf_json_text(json, "densification", rules[fit->model.form.rule]);
    sf_json_open(json, "densifications_tried", '{');
    for (int k = 0; k < SF_RULES; k++)
        put_candidate(json, rules[k], &fit->rule[k]);
    sf_json_close(json, '}');
    sf_json_number(json, "densification_start", fit->data.start);
}

static void put_estimates(sf_json *json, const sf_compression_fit *fit) {
    static const char *const names[SF_ESTIMATES] = {"E_Pa",  "HU",        "SHAPE",    "log_rate_c",
                                                    "ED_Pa", "BETA1_1_s", "exponent", "limit"};
    sf_json_open(json, "parameters", '{');
    for (int k = 0; k < SF_ESTIMATES; k++) {
        const sf_estimate *e = &fit->estimate[k];
        if (!e->present)
            continue;
        sf_json_open(json, names[k], '{');
        sf_json_number(json, "value", e->value);
        sf_json_number(json, "standard_error", e->error);
        sf_json_number(json, "low", e->low);
        sf_json_number(json, "high", e->high);
        sf_json_text(json, "note", *e->note ? e->note : NULL);
        sf_json_close(json, '}');
    }
    sf_json_close(json, '}');
}

static void put_quality(sf_json *json, const sf_compression_fit *fit, const sf_compression_check *check) {
    sf_json_number(json, "confidence", fit->data.config->confidence);
    sf_json_integer(json, "points", fit->data.count);
    sf_json_integer(json, "fitted_parameters", fit->model.parameter_count);
    sf_json_integer(json, "spline_coefficients", fit->model.spline.count - 1);
    sf_json_number(json, "scatter_absolute_Pa", fit->data.scatter.absolute);
    sf_json_number(json, "scatter_relative", fit->data.scatter.relative);
    sf_json_number(json, "chi2", fit->chi2);
    sf_json_number(json, "misfit", fit->misfit);
    sf_json_number(json, "neighbour_correlation", fit->correlation);
    sf_json_number(json, "variance_factor_for_correlation", fit->serial);
    sf_json_number(json, "card_difference_percent", check->card_percent);
}

static void put_simulation(sf_json *json, const sf_compression_fit *fit, const sf_compression_check *check) {
    sf_json_open(json, "simulation", '[');
    for (int k = 0; check->simulated && k < fit->data.config->test_count; k++) {
        const sf_cube_test *t = &check->cube[k];
        sf_json_open(json, NULL, '{');
        sf_json_number(json, "rate_1_s", fit->data.config->test[k].rate);
        sf_json_number(json, "speed_up", t->speed_up);
        sf_json_number(json, "loading_difference_percent", t->percent[0]);
        sf_json_number(json, "unloading_difference_percent", t->percent[1]);
        sf_json_number(json, "energy_error", t->energy_error);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

sf_status sf_compression_write_json(const sf_staging *output, const sf_compression_fit *fit,
                                    const sf_compression_check *check, const char *path, sf_error *err) {
    sf_json json = {.file = sf_staging_open(output, "fit.json", err)};
    if (!json.file)
        return err->status;
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "program", "softfall-fit compression " SF_VERSION " (" SF_GIT_REVISION ")");
    sf_json_text(&json, "input", path);
    sf_json_text(&json, "name", fit->data.config->name);
    put_tests(&json, fit, check);
    put_choice(&json, fit);
    put_estimates(&json, fit);
    put_quality(&json, fit, check);
    put_simulation(&json, fit, check);
    sf_json_close(&json, '}');
    return sf_staging_close(json.file, "fit.json", err);
}
