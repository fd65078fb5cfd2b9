/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the forms of the loading curve (fit/form): their parameters, files and words. */
#include "study/fit/compression/compression_kind.h"

#include "material/low_density_foam.h"
#include "study/fit/compression/form_fit.h"

static const char *const outputs[] = {"fit.csv", "fit.json", "material.csv", "material.cfg", NULL};
static const char AT_BOUND[] = " (at its bound)", UNDETERMINED[] = " (these tests do not determine it)",
                  BELOW_REFERENCE[] = " (below rate_reference, where the law has no effect of the rate)";
static const char *const unloading_names[3] = {"HU", "SHAPE", "ALPHA"};
static const char POOR_WARNING[] =
    "the form does not describe these tests: a deviation exceeds 10 % of the largest stress";

static sf_status run(const sf_compression_config *config, void *fit, sf_error *err) {
    SF_TRY(sf_form_fit_run(config, fit, err));
    return sf_cycle_fit_run(fit, err);
}

static void release(void *fit) {
    sf_form_fit_free(fit);
}

static sf_material material_of(const void *fit) {
    return sf_foam_material(&((const sf_form_fit *)fit)->card);
}

/* ---- words ---- */

static void put_unknowns(FILE *out, const sf_form_fit *fit) {
    const sf_form_request *r = &fit->config->form;
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        fprintf(out, "  %s %.5g%s%s", about->name, fit->value[r->unknown[k]] / about->per_unit,
                *about->unit ? " " : "", about->unit);
        if (fit->at_bound[k])
            fputs(AT_BOUND, out);
        else if (isfinite(fit->error[k]))
            fprintf(out, " +- %.2g %%", 100 * fit->error[k]);
        if (!sf_form_fit_determines(fit, k) && !fit->at_bound[k])
            fputs(UNDETERMINED, out);
        fprintf(out, ", %s\n", about->description);
    }
}

static void put_unloading(FILE *out, const sf_form_unloading *u) {
    fputs("  unloading:", out);
    for (int k = 0; k < 3; k++)
        fprintf(out, "%s %s %.4g%s", k ? "," : "", unloading_names[k], u->fit.value[k],
                u->fit.at_bound[k] ? AT_BOUND : "");
    fprintf(out, "; rms %.2g %% of the largest stress", 100 * u->fit.rms);
    fprintf(out, isfinite(u->factor_rms) ? ", rms of the factor %.2g\n" : " (in the first of the cycles)\n",
            u->factor_rms);
}

static void put_test(FILE *out, const sf_form_fit *fit, const sf_compression_test *t, const sf_form_test *f,
                     const char *how) {
    fprintf(out, "  %s %s at %.4g 1/s%s: rms of loading %.2g %% of the largest stress", how, t->path, t->rate,
            sf_form_fit_is_below_reference(fit, t) ? BELOW_REFERENCE : "", 100 * f->loading_rms);
    if (isfinite(f->unloading_rms))
        fprintf(out, ", of unloading %.2g %%; energy returned: %.3g %% measured, %.3g %% by the law",
                100 * f->unloading_rms, 100 * f->returned_measured, 100 * f->returned_fitted);
    fputs("\n", out);
}

static void put_cycles(FILE *out, const sf_form_fit *fit) {
    fputs("  memory, by the fitted cycles:", out);
    for (int k = 0; k < SF_CYCLE_MEMORY; k++)
        if (isfinite(fit->memory_width[k]))
            fprintf(out, "%s %s %.3g +- %.2g", k ? "," : "", sf_cycle_parameter(k)->name,
                    fit->value[SF_PARAMETER_RELOAD + k], fit->memory_width[k]);
        else
            fprintf(out, "%s %s %.3g (at its bound, or no record tells it)", k ? "," : "",
                    sf_cycle_parameter(k)->name, fit->value[SF_PARAMETER_RELOAD + k]);
    if (isfinite(fit->set))
        fprintf(out,
                "\n  set, not written: reloads take up stress %.2g +- %.1g of the largest strain late, after "
                "%.3g s without load",
                fit->set, fit->set_width, fit->set_time);
    for (int n = 0; n < fit->config->record_count; n++) {
        const sf_cycle_record *r = &fit->config->cycles[n];
        const sf_cycle_result *c = &fit->cycles[n];
        fprintf(out,
                "\n  cycles 1 to %d of %s: largest rms of a cycle, of the largest stress: loading %.2g %%, "
                "unloading %.2g %%",
                r->fitted, r->path, 100 * sf_cycle_fit_worst(c, 0, 0, r->fitted),
                100 * sf_cycle_fit_worst(c, 1, 0, r->fitted));
        if (r->fitted < r->cycles)
            fprintf(out, "; predicted, cycles %d to %d: loading %.2g %%, unloading %.2g %%", r->fitted + 1,
                    r->cycles, 100 * sf_cycle_fit_worst(c, 0, r->fitted, r->cycles),
                    100 * sf_cycle_fit_worst(c, 1, r->fitted, r->cycles));
    }
    fputs("\n  Not in the law: permanent set within a test, and the fall of the stress at the largest strain.\n", out);
}

static void describe(FILE *out, const void *place, bool comments) {
    const sf_form_fit *fit = place;
    const sf_compression_config *c = fit->config;
    if (comments)
        fputc('\n', out);
    else
        fprintf(out, "%s: curve_form = \"%s\"\n", c->name, c->form.form.curve->name);
    if (comments && sf_form_fit_is_poor(fit))
        fprintf(out, "WARNING: %s\n", POOR_WARNING);
    fprintf(out, "Curve: %s.\nRate: %s.\n", c->form.form.curve->formula, sf_form_rate_names[c->form.rate]);
    fprintf(out, "rms of loading %.2g %% of the largest stress, with %d parameters:\n",
            100 * fit->loading_rms, c->form.unknown_count);
    put_unknowns(out, fit);
    if (fit->has_unloading) {
        if (c->record_count == 0)
            put_unloading(out, &fit->unloading_of_one);
        put_unloading(out, &fit->unloading);
    }
    if (c->record_count > 0)
        put_cycles(out, fit);
    for (int k = 0; k < c->test_count; k++)
        put_test(out, fit, &c->test[k], &fit->test[k], "fitted");
    for (int k = 0; k < c->predicted_count; k++)
        put_test(out, fit, &c->predicted[k], &fit->predicted[k], "predicted");
    if (comments)
        fprintf(out,
                "Beyond the strain %.4g and outside these rates it is extrapolation. +-: standard errors.\n",
                fit->card.informed_strain);
}

static void warn(const void *place, const sf_sink *sink) {
    const sf_form_fit *fit = place;
    const sf_compression_config *c = fit->config;
    if (sf_form_fit_is_poor(fit))
        sf_sink_tell(sink, SF_WARNING, "%s", POOR_WARNING);
    for (int k = 0; k < c->form.unknown_count; k++) {
        sf_foam_parameter p = c->form.unknown[k];
        if (sf_form_rate_of(p) && !sf_form_fit_determines(fit, k))
            sf_sink_tell(sink, SF_WARNING,
                         "these tests do not determine %s: its standard error exceeds 100 %%, or it is at "
                         "its bound",
                         sf_parameter_get(p)->name);
    }
    for (int k = 0; k < c->predicted_count; k++)
        if (sf_form_fit_is_below_reference(fit, &c->predicted[k]))
            sf_sink_tell(sink, SF_WARNING,
                         "the predicted test %s at %g 1/s is below rate_reference = %g 1/s, where the law "
                         "has no effect of the rate",
                         c->predicted[k].path, c->predicted[k].rate, fit->value[SF_PARAMETER_RATE_REFERENCE]);
}

/* ---- files ---- */

static void put_test_points(sf_csv *csv, int number, const sf_compression_test *t, const double *stress,
                            const char *how) {
    for (int i = 0; i < t->count; i++) {
        sf_csv_print(csv, "%d,%s,%.9g,%s", number, how, t->rate, i < t->loading ? "loading" : "unloading");
        SF_CSV_LINE(csv, t->strain[i], 1e-3 * t->stress[i], 1e-3 * stress[i]);
    }
}

static void put_cycle_points(sf_csv *csv, const sf_form_fit *fit, int record) {
    const sf_cycle_record *r = &fit->config->cycles[record];
    for (int k = 0; k < 2 * r->cycles; k++)
        for (int i = r->turn[k] + (k > 0); i <= r->turn[k + 1]; i++) {
            sf_csv_print(csv, "record %d cycle %d,%s,,%s", record + 1, k / 2 + 1,
                         k / 2 < r->fitted ? "fitted" : "predicted", k % 2 ? "unloading" : "loading");
            SF_CSV_LINE(csv, r->strain[i], 1e-3 * r->stress[i], 1e-3 * fit->cycles[record].stress[i]);
        }
}

static void put_points(sf_csv *csv, const void *place) {
    const sf_form_fit *fit = place;
    const sf_compression_config *c = fit->config;
    SF_CSV_PRINT_LINE(csv, "test,use,rate_1_s,branch,strain,measured_kPa,law_kPa");
    for (int k = 0; k < c->test_count; k++)
        put_test_points(csv, k + 1, &c->test[k], fit->test[k].stress, "fitted");
    for (int k = 0; k < c->predicted_count; k++)
        put_test_points(csv, c->test_count + k + 1, &c->predicted[k], fit->predicted[k].stress, "predicted");
    for (int k = 0; k < c->record_count; k++)
        put_cycle_points(csv, fit, k);
}

static void json_record(sf_json *json, const sf_cycle_record *r, const sf_cycle_result *c) {
    static const char *const branch[] = {"loading_rms", "unloading_rms"};
    SF_JSON_OBJECT(json, NULL);
    sf_json_text(json, "file", r->path);
    SF_JSON_NUMBERS(json, {"cycles", r->cycles}, {"fitted", r->fitted}, {"pauses", r->pauses});
    for (int b = 0; b < 2; b++) {
        SF_JSON_ARRAY(json, branch[b]);
        for (int k = 0; k < r->cycles; k++)
            sf_json_number(json, NULL, c->rms[b][k]);
    }
}

static void json_cycles(sf_json *json, const sf_form_fit *fit) {
    SF_JSON_OBJECT(json, "memory");
    for (int k = 0; k < SF_CYCLE_MEMORY; k++) {
        char key[64];
        sf_json_number(json, sf_cycle_parameter(k)->name, fit->value[SF_PARAMETER_RELOAD + k]);
        snprintf(key, sizeof key, "%s_half_width", sf_cycle_parameter(k)->name);
        sf_json_number(json, key, fit->memory_width[k]);
    }
    SF_JSON_NUMBERS(json, {"set", fit->set}, {"set_half_width", fit->set_width},
                    {"set_time_s", fit->set_time});
    SF_JSON_ARRAY(json, "records");
    for (int k = 0; k < fit->config->record_count; k++)
        json_record(json, &fit->config->cycles[k], &fit->cycles[k]);
}

static void json_unknowns(sf_json *json, const sf_form_fit *fit) {
    const sf_form_request *r = &fit->config->form;
    SF_JSON_ARRAY(json, "parameters");
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        SF_JSON_OBJECT(json, NULL);
        SF_JSON_TEXTS(json, {"name", about->name}, {"unit", about->unit});
        SF_JSON_NUMBERS(json, {"value", fit->value[r->unknown[k]] / about->per_unit},
                        {"relative_error", fit->error[k]});
        sf_json_bool(json, "at_bound", fit->at_bound[k]);
        sf_json_bool(json, "determined", sf_form_fit_determines(fit, k));
    }
}

static void json_unloading(sf_json *json, const char *key, const sf_form_unloading *u) {
    SF_JSON_OBJECT(json, key);
    for (int k = 0; k < 3; k++)
        sf_json_number(json, unloading_names[k], u->fit.value[k]);
    sf_json_open(json, "at_bound", '[');
    for (int k = 0; k < 3; k++)
        if (u->fit.at_bound[k])
            sf_json_text(json, NULL, unloading_names[k]);
    sf_json_close(json);
    SF_JSON_NUMBERS(json, {"rms", u->fit.rms}, {"factor_rms", u->factor_rms});
}

static void json_tests(sf_json *json, const sf_form_fit *fit, const char *key, int count,
                       const sf_compression_test *tests, const sf_form_test *fits) {
    SF_JSON_ARRAY(json, key);
    for (int k = 0; k < count; k++) {
        SF_JSON_OBJECT(json, NULL);
        sf_json_text(json, "file", tests[k].path);
        sf_json_number(json, "rate_1_s", tests[k].rate);
        sf_json_bool(json, "below_rate_reference", sf_form_fit_is_below_reference(fit, &tests[k]));
        SF_JSON_NUMBERS(json, {"largest_strain", tests[k].largest_strain},
                        {"largest_stress_Pa", tests[k].largest_stress}, {"loading_rms", fits[k].loading_rms},
                        {"unloading_rms", fits[k].unloading_rms},
                        {"returned_energy_measured", fits[k].returned_measured},
                        {"returned_energy_fitted", fits[k].returned_fitted});
    }
}

static void put_json(sf_json *json, const void *place, const char *path) {
    const sf_form_fit *fit = place;
    const sf_compression_config *c = fit->config;
    (void)path;
    SF_JSON_TEXTS(json, {"law", "low_density_foam"}, {"name", c->name},
                  {"curve_form", c->form.form.curve->name}, {"rate_model", sf_form_rate_names[c->form.rate]});
    SF_JSON_NUMBERS(json, {"parameter_count", c->form.unknown_count}, {"loading_rms", fit->loading_rms});
    sf_json_bool(json, "describes_the_tests", !sf_form_fit_is_poor(fit));
    json_unknowns(json, fit);
    if (fit->has_unloading) {
        json_unloading(json, "unloading_with_ALPHA_1", &fit->unloading_of_one);
        json_unloading(json, "unloading", &fit->unloading);
    }
    if (c->record_count > 0)
        json_cycles(json, fit);
    json_tests(json, fit, "tests", c->test_count, c->test, fit->test);
    json_tests(json, fit, "predicted", c->predicted_count, c->predicted, fit->predicted);
}

const sf_compression_kind sf_compression_form_kind = {.label = "",
                                                      .files =
                                                          "material.cfg, material.csv, fit.json, fit.csv",
                                                      .size = sizeof(sf_form_fit),
                                                      .free = release,
                                                      SF_COMPRESSION_PARTS};
