/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/form_command.h"

#include "study/material_file.h"
#include "study/fit/compression/form_fit.h"
#include "report/json.h"
#include "io/staging.h"
#include "material/low_density_foam.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const output_names[] = {"fit.csv", "fit.json", "material.csv", "material.cfg", NULL};
static const char AT_BOUND[] = " (at its bound)", UNDETERMINED[] = " (these tests do not determine it)",
                  BELOW_REFERENCE[] = " (below rate_reference, where the law has no effect of the rate)";
static const char *const unloading_names[3] = {"HU", "SHAPE", "ALPHA"};
static const char POOR_WARNING[] =
    "the form does not describe these tests: a deviation exceeds 10 % of the largest stress";

sf_status sf_form_fit_check(const char *directory, bool force, sf_error *err) {
    return sf_staging_check(directory, output_names, force, err);
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
        fprintf(out, "%s %s %.4g%s", k ? "," : "", unloading_names[k], u->value[k],
                u->at_bound[k] ? AT_BOUND : "");
    fprintf(out, "; rms %.2g %% of the largest stress, rms of the factor %.2g\n", 100 * u->rms,
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

static void put_fit(FILE *out, const sf_form_fit *fit) {
    const sf_compression_config *c = fit->config;
    fprintf(out, "Curve: %s.\nRate: %s.\n", c->form.form.curve->formula, sf_form_rate_name(c->form.rate));
    fprintf(out, "rms of loading %.2g %% of the largest stress, with %d parameters:\n",
            100 * fit->loading_rms, c->form.unknown_count);
    put_unknowns(out, fit);
    if (fit->has_unloading) {
        put_unloading(out, &fit->unloading_of_one);
        put_unloading(out, &fit->unloading);
    }
    for (int k = 0; k < c->test_count; k++)
        put_test(out, fit, &c->test[k], &fit->test[k], "fitted");
    for (int k = 0; k < c->predicted_count; k++)
        put_test(out, fit, &c->predicted[k], &fit->predicted[k], "predicted");
}

/* ---- files ---- */

static sf_status write_material(const sf_staging *output, const sf_form_fit *fit, sf_error *err) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the comments of the material file");
    fputs("Identified by softfall-fit compression\n", out);
    if (sf_form_fit_is_poor(fit))
        fprintf(out, "WARNING: %s\n", POOR_WARNING);
    put_fit(out, fit);
    fprintf(out, "Beyond the strain %.4g and outside these rates it is extrapolation. +-: standard errors.\n",
            fit->card.informed_strain);
    fclose(out);
    const sf_material_text comments = {.title = fit->config->name, .provenance = text};
    const sf_material material = sf_foam_material(&fit->card);
    sf_material_write_checked(output->aside, "material", &material, &comments, err);
    free(text);
    return err->status;
}

static void write_test(FILE *file, int number, const sf_compression_test *t, const double *stress,
                       const char *how) {
    for (int i = 0; i < t->count; i++) {
        fprintf(file, "%d,%s,%.9g,%s,%.9g,%.9g,", number, how, t->rate,
                i < t->loading ? "loading" : "unloading", t->strain[i], 1e-3 * t->stress[i]);
        if (isfinite(stress[i]))
            fprintf(file, "%.9g", 1e-3 * stress[i]);
        fputs("\n", file);
    }
}

static sf_status write_points(const sf_staging *output, const sf_form_fit *fit, sf_error *err) {
    const sf_compression_config *c = fit->config;
    FILE *file = sf_staging_open(output, "fit.csv", err);
    if (!file)
        return err->status;
    fputs("test,use,rate_1_s,branch,strain,measured_kPa,law_kPa\n", file);
    for (int k = 0; k < c->test_count; k++)
        write_test(file, k + 1, &c->test[k], fit->test[k].stress, "fitted");
    for (int k = 0; k < c->predicted_count; k++)
        write_test(file, c->test_count + k + 1, &c->predicted[k], fit->predicted[k].stress, "predicted");
    return sf_staging_close(file, "fit.csv", err);
}

static void json_unknowns(sf_json *json, const sf_form_fit *fit) {
    const sf_form_request *r = &fit->config->form;
    sf_json_open(json, "parameters", '[');
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "name", about->name);
        sf_json_text(json, "unit", about->unit);
        sf_json_number(json, "value", fit->value[r->unknown[k]] / about->per_unit);
        sf_json_number(json, "relative_error", fit->error[k]);
        sf_json_bool(json, "at_bound", fit->at_bound[k]);
        sf_json_bool(json, "determined", sf_form_fit_determines(fit, k));
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void json_unloading(sf_json *json, const char *key, const sf_form_unloading *u) {
    sf_json_open(json, key, '{');
    for (int k = 0; k < 3; k++)
        sf_json_number(json, unloading_names[k], u->value[k]);
    sf_json_open(json, "at_bound", '[');
    for (int k = 0; k < 3; k++)
        if (u->at_bound[k])
            sf_json_text(json, NULL, unloading_names[k]);
    sf_json_close(json, ']');
    sf_json_number(json, "rms", u->rms);
    sf_json_number(json, "factor_rms", u->factor_rms);
    sf_json_close(json, '}');
}

static void json_tests(sf_json *json, const sf_form_fit *fit, const char *key, int count,
                       const sf_compression_test *tests, const sf_form_test *fits) {
    sf_json_open(json, key, '[');
    for (int k = 0; k < count; k++) {
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "file", tests[k].path);
        sf_json_number(json, "rate_1_s", tests[k].rate);
        sf_json_bool(json, "below_rate_reference", sf_form_fit_is_below_reference(fit, &tests[k]));
        sf_json_number(json, "largest_strain", tests[k].largest_strain);
        sf_json_number(json, "largest_stress_Pa", tests[k].largest_stress);
        sf_json_number(json, "loading_rms", fits[k].loading_rms);
        sf_json_number(json, "unloading_rms", fits[k].unloading_rms);
        sf_json_number(json, "returned_energy_measured", fits[k].returned_measured);
        sf_json_number(json, "returned_energy_fitted", fits[k].returned_fitted);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static sf_status write_json(const sf_staging *output, const sf_form_fit *fit, sf_error *err) {
    const sf_compression_config *c = fit->config;
    FILE *file = sf_staging_open(output, "fit.json", err);
    if (!file)
        return err->status;
    sf_json json = {.file = file, .empty = true};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "law", "low_density_foam");
    sf_json_text(&json, "name", c->name);
    sf_json_text(&json, "curve_form", c->form.form.curve->name);
    sf_json_text(&json, "rate_model", sf_form_rate_name(c->form.rate));
    sf_json_integer(&json, "parameter_count", c->form.unknown_count);
    sf_json_number(&json, "loading_rms", fit->loading_rms);
    sf_json_bool(&json, "describes_the_tests", !sf_form_fit_is_poor(fit));
    json_unknowns(&json, fit);
    if (fit->has_unloading) {
        json_unloading(&json, "unloading_with_ALPHA_1", &fit->unloading_of_one);
        json_unloading(&json, "unloading", &fit->unloading);
    }
    json_tests(&json, fit, "tests", c->test_count, c->test, fit->test);
    json_tests(&json, fit, "predicted", c->predicted_count, c->predicted, fit->predicted);
    sf_json_close(&json, '}');
    fputs("\n", file);
    return sf_staging_close(file, "fit.json", err);
}

static sf_status write_all(const sf_form_fit *fit, const char *directory, bool force, sf_error *err) {
    sf_staging output;
    SF_TRY(sf_staging_begin(directory, output_names, force, &output, err));
    if (write_points(&output, fit, err) == SF_OK && write_json(&output, fit, err) == SF_OK &&
        write_material(&output, fit, err) == SF_OK)
        sf_staging_commit(&output, err);
    sf_staging_end(&output);
    return err->status;
}

static bool is_of_rate(sf_foam_parameter p) {
    return p == SF_PARAMETER_RATE_FACTOR || p == SF_PARAMETER_ED || p == SF_PARAMETER_BETA1;
}

static void warn(const sf_form_fit *fit, const sf_sink *sink) {
    const sf_compression_config *c = fit->config;
    if (sf_form_fit_is_poor(fit))
        sf_sink_tell(sink, SF_WARNING, "%s", POOR_WARNING);
    for (int k = 0; k < c->form.unknown_count; k++)
        if (is_of_rate(c->form.unknown[k]) && !sf_form_fit_determines(fit, k))
            sf_sink_tell(
                sink, SF_WARNING,
                "these tests do not determine %s: its standard error exceeds 100 %%, or it is at its bound",
                sf_parameter_get(c->form.unknown[k])->name);
    for (int k = 0; k < c->predicted_count; k++)
        if (sf_form_fit_is_below_reference(fit, &c->predicted[k]))
            sf_sink_tell(
                sink, SF_WARNING,
                "the predicted test %s at %g 1/s is below rate_reference = %g 1/s, where the law has no "
                "effect of the rate",
                c->predicted[k].path, c->predicted[k].rate, fit->value[SF_PARAMETER_RATE_REFERENCE]);
}

sf_status sf_form_fit_write(const sf_compression_config *config, const char *directory, bool force, FILE *log,
                            const sf_sink *sink, sf_error *err) {
    sf_form_fit fit;
    SF_TRY(sf_form_fit_run(config, &fit, err));
    if (write_all(&fit, directory, force, err) == SF_OK) {
        fprintf(log, "%s: curve_form = \"%s\"\n", config->name, config->form.form.curve->name);
        put_fit(log, &fit);
        fprintf(log, "Files in %s: material.cfg, material.csv, fit.json, fit.csv\n", directory);
        fflush(log);
        warn(&fit, sink);
    }
    sf_form_fit_free(&fit);
    return err->status;
}
