/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/hyperfoam_command.h"

#include "study/config.h"
#include "study/material_file.h"
#include "study/fit/compression/hyperfoam_fit.h"
#include "report/json.h"
#include "io/staging.h"
#include "io/table_csv.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const output_names[] = {"fit.csv", "fit.json", "material.cfg", NULL};
enum { LAW_HYPERFOAM = 1, NAME_SIZE = 64, LEAST_LATERAL = 6, MISFIT_SIZE = 256 };
static const char AT_BOUND[] = " (at its bound)";
#define LAW_WORDS "low_density_foam|hyperfoam"

typedef struct input {
    char name[NAME_SIZE];
    int terms;
    double nu;
    sf_hyperfoam_card card; /* density, DAMP and the defaults */
    sf_hyperfoam_data data;
    char *lateral_path; /* owned */
} input;

static void input_free(input *in) {
    sf_hyperfoam_data_free(&in->data);
    free(in->lateral_path);
}

sf_status sf_hyperfoam_fit_asked(const char *path, bool *asked, sf_error *err) {
    sf_config file;
    int law = 0;
    if (sf_config_open(path, &file, err) == SF_OK)
        sf_config_choice(&file, config_root_setting(&file.config), "law", LAW_WORDS, &law, err);
    sf_config_close(&file);
    *asked = law == LAW_HYPERFOAM;
    return err->status;
}

/* ---- lateral strain ---- */

static sf_status check_lateral(const sf_table_point *p, sf_error *err) {
    if (p->value[0] >= 1 || p->value[1] <= -1 || p->value[1] >= 1)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s and lateral strain %s: both must be between -1 and 1; columns in "
                       "percent are named strain_percent and lateral_strain_percent",
                       p->path, p->line, p->text[0], p->text[1]);
    return SF_OK;
}

static sf_table_layout lateral_layout(void) {
    static const sf_table_name names[] = {{"strain", 0, 1, "1"},
                                          {"strain_percent", 0, 0.01, "%"},
                                          {"lateral_strain", 1, 1, "1"},
                                          {"lateral_strain_percent", 1, 0.01, "%"},
                                          {"transverse_strain", 1, 1, "1"},
                                          {"transverse_strain_percent", 1, 0.01, "%"}};
    return (sf_table_layout){
        .what = "test",
        .column = {"strain", "lateral strain"},
        .wanted = {"\"strain\" or \"strain_percent\"", "\"lateral_strain\" or \"lateral_strain_percent\""},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .check = check_lateral};
}

/* Rows up to the largest strain: loading. Ascending afterwards. */
static sf_status read_lateral(const char *path, sf_hyperfoam_data *data, sf_error *err) {
    const sf_table_layout layout = lateral_layout();
    sf_table table = {0};
    if (sf_table_read(path, &layout, &table, err) != SF_OK)
        return err->status;
    int64_t end = 0;
    for (int64_t i = 1; i < table.count; i++)
        end = table.value[0][i] > table.value[0][end] ? i : end;
    data->lateral_count = (int)(end + 1);
    data->lateral_at = table.value[0];
    data->lateral = table.value[1];
    table.value[0] = table.value[1] = NULL;
    sf_table_free(&table);
    for (int i = 1; i < data->lateral_count; i++)
        for (int k = i; k > 0 && data->lateral_at[k] < data->lateral_at[k - 1]; k--) {
            double at = data->lateral_at[k], side = data->lateral[k];
            data->lateral_at[k] = data->lateral_at[k - 1];
            data->lateral[k] = data->lateral[k - 1];
            data->lateral_at[k - 1] = at;
            data->lateral[k - 1] = side;
        }
    if (data->lateral_count < LEAST_LATERAL)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %d points of lateral strain while loading; %d are needed",
                       path, data->lateral_count, LEAST_LATERAL);
    return SF_OK;
}

/* ---- the file ---- */

static sf_status read_test(const sf_config *file, const config_setting_t *root, input *in, sf_error *err) {
    const config_setting_t *tests, *entry;
    sf_compression_source source = {0};
    char *path = NULL;
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_config_list(file, root, "tests", true, 8, &tests, err));
    entry = config_setting_get_elem(tests, 0);
    if (config_setting_length(tests) != 1)
        return sf_config_refuse(
            file, tests, err,
            "the hyperfoam is fitted to one test, at one rate; fit the others in files of "
            "their own, and compare nu and mu");
    SF_TRY(sf_config_names(file, entry, "file|rate|lateral", err));
    SF_TRY(sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, &source.rate, err));
    SF_TRY(sf_config_file(file, entry, "lateral", false, &in->lateral_path, err));
    if (sf_config_file(file, entry, "file", true, &path, err) == SF_OK) {
        source.path = path;
        if (sf_compression_test_read(&source, &in->data.test, &inner) == SF_OK && in->lateral_path)
            read_lateral(in->lateral_path, &in->data, &inner);
        if (inner.status != SF_OK)
            SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                    config_setting_source_line(entry));
    }
    free(path);
    return err->status;
}

static sf_status read_root(const sf_config *file, input *in, sf_error *err) {
    const config_setting_t *root = config_root_setting(&file->config);
    const char *name = in->name;
    double terms = 2;
    SF_TRY(sf_config_names(file, root, "law|name|density|tests|DAMP|terms|nu", err));
    SF_TRY(sf_config_quantity(file, root, "density", SF_DENSITY, true, 0, &in->card.density, err));
    SF_TRY(sf_config_text(file, root, "name", false, &name, err));
    if (name != in->name)
        snprintf(in->name, sizeof in->name, "%s", name);
    SF_TRY(sf_config_number(file, root, "DAMP", false, 0, 10, &in->card.damp, err));
    SF_TRY(sf_config_number(file, root, "terms", false, 1, SF_HYPERFOAM_TERMS, &terms, err));
    SF_TRY(sf_config_number(file, root, "nu", false, 0, 0.45, &in->nu, err));
    in->terms = (int)terms;
    if (in->terms != terms)
        return sf_config_refuse(file, config_setting_get_member(root, "terms"), err,
                                "terms is %g; it must be 1, 2 or 3", terms);
    SF_TRY(read_test(file, root, in, err));
    bool given = config_setting_get_member(root, "nu") != NULL, measured = in->data.lateral_count > 0;
    if (given == measured)
        return sf_config_refuse(file, root, err,
                                given ? "nu is given, and lateral strain is measured; one of them says it"
                                      : "give the test a table of lateral strain (lateral = \"FILE\", which "
                                        "may be its own file), or nu for all terms");
    return SF_OK;
}

/* ---- output ---- */

static void put_error(FILE *out, double error, bool at_bound) {
    if (at_bound)
        fputs(AT_BOUND, out);
    else if (isfinite(error))
        fprintf(out, " +- %.2g", error);
}

static void put_unloading(FILE *out, const sf_hyperfoam_fit *fit) {
    const bool *at_bound = fit->unloading_at_bound;
    fprintf(out, "  unloading: HU %.4g%s, SHAPE %.4g%s, ALPHA %.4g%s; rms %.2g %% of the largest stress\n",
            fit->card.hysteresis_hu, at_bound[0] ? AT_BOUND : "", fit->card.hysteresis_shape,
            at_bound[1] ? AT_BOUND : "", fit->card.hysteresis_alpha, at_bound[2] ? AT_BOUND : "",
            100 * fit->unloading_rms);
}

static void put_terms(FILE *out, const input *in, const sf_hyperfoam_fit *fit) {
    for (int k = 0; k < in->terms; k++) {
        const sf_hyperfoam_term *t = &fit->card.term[k];
        const double *e = fit->error[k];
        fprintf(out, "  term %d: mu %.5g kPa +- %.2g %%, alpha %.4g", k + 1, 1e-3 * t->mu, 100 * e[0],
                t->alpha);
        put_error(out, e[1], fit->at_bound[k][1]);
        fprintf(out, ", nu %.4g", t->nu);
        put_error(out, e[2], fit->at_bound[k][2]);
        fputs("\n", out);
    }
    fprintf(out, "  -ln(lateral stretch)/ln(axial stretch): %.3g at 1 %% strain, %.3g at %.3g %%\n",
            fit->poisson[0], fit->poisson[1], 100 * in->data.test.largest_strain);
    fprintf(out, "  rms while loading: stress %.2g %% of the largest", 100 * fit->stress_rms);
    if (isfinite(fit->lateral_rms))
        fprintf(out, ", lateral strain %.2g %% of the largest", 100 * fit->lateral_rms);
    fputs("\n", out);
    if (isfinite(fit->unloading_rms))
        put_unloading(out, fit);
}

/* Writes the deviations of a poor fit. */
static void describe_misfit(const sf_hyperfoam_fit *fit, char text[MISFIT_SIZE]) {
    const struct {
        const char *name;
        double rms;
    } parts[] = {{"stress while loading", fit->stress_rms},
                 {"lateral strain", fit->lateral_rms},
                 {"stress of unloading", fit->unloading_rms}};
    int used =
        snprintf(text, MISFIT_SIZE, "the fit does not describe this test, rms over the largest value:");
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++)
        if (isfinite(parts[k].rms))
            used += snprintf(text + used, MISFIT_SIZE - (size_t)used, "%s %s %.2g %%", k > 0 ? "," : "",
                             parts[k].name, 100 * parts[k].rms);
}

static sf_status write_material(const sf_staging *output, const input *in, const sf_hyperfoam_fit *fit,
                                sf_error *err) {
    char *text = NULL, misfit[MISFIT_SIZE];
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the comments of the material file");
    fprintf(out, "Identified by softfall-fit compression from\n  %s at %.6g 1/s, to a strain of %.4g\n",
            in->data.test.path, in->data.test.rate, in->data.test.largest_strain);
    if (sf_hyperfoam_fit_is_poor(fit)) {
        describe_misfit(fit, misfit);
        fprintf(out, "WARNING: %s\n", misfit);
    }
    put_terms(out, in, fit);
    fprintf(out, "Beyond that strain and at other rates it is extrapolation. +-: standard errors.\n");
    fclose(out);
    const sf_material_text comments = {.title = in->name, .provenance = text};
    const sf_material material = sf_hyperfoam_material(&fit->card);
    sf_material_write_checked(output->aside, "material", &material, &comments, err);
    free(text);
    return err->status;
}

static sf_status write_points(const sf_staging *output, const input *in, const sf_hyperfoam_fit *fit,
                              sf_error *err) {
    const sf_compression_test *t = &in->data.test;
    sf_hyperfoam foam = sf_hyperfoam_build(&fit->card);
    double side = 0, energy, peak = 0;
    FILE *file = sf_staging_open(output, "fit.csv", err);
    if (!file)
        return err->status;
    fputs("quantity,branch,strain,measured,fit\n", file);
    sf_hyperfoam_free_stress(&foam, t->largest_strain, &side, &peak);
    side = 0;
    for (int i = 0; i < t->count; i++) {
        bool back = i >= t->loading;
        double stress = sf_hyperfoam_free_stress(&foam, t->strain[i], &side, &energy);
        if (back)
            stress *= sf_unloading_factor(fit->card.hysteresis_hu, fit->card.hysteresis_shape,
                                          fit->card.hysteresis_alpha, fmin(1, energy / peak));
        fprintf(file, "stress_kPa,%s,%.9g,%.9g,%.9g\n", back ? "unloading" : "loading", t->strain[i],
                1e-3 * t->stress[i], 1e-3 * stress);
    }
    side = 0;
    for (int i = 0; i < in->data.lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, in->data.lateral_at[i], &side, &energy);
        fprintf(file, "lateral_strain,loading,%.9g,%.9g,%.9g\n", in->data.lateral_at[i], in->data.lateral[i],
                side);
    }
    return sf_staging_close(file, "fit.csv", err);
}

static sf_status write_json(const sf_staging *output, const input *in, const sf_hyperfoam_fit *fit,
                            sf_error *err) {
    FILE *file = sf_staging_open(output, "fit.json", err);
    if (!file)
        return err->status;
    sf_json json = {.file = file, .empty = true};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "law", "hyperfoam");
    sf_json_text(&json, "name", in->name);
    sf_json_text(&json, "test", in->data.test.path);
    sf_json_number(&json, "rate_1_s", in->data.test.rate);
    sf_json_number(&json, "largest_strain", in->data.test.largest_strain);
    sf_json_open(&json, "terms", '[');
    for (int k = 0; k < in->terms; k++) {
        sf_json_open(&json, NULL, '{');
        sf_json_number(&json, "mu_Pa", fit->card.term[k].mu);
        sf_json_number(&json, "mu_relative_error", fit->error[k][0]);
        sf_json_number(&json, "alpha", fit->card.term[k].alpha);
        sf_json_number(&json, "alpha_error", fit->error[k][1]);
        sf_json_number(&json, "nu", fit->card.term[k].nu);
        sf_json_number(&json, "nu_error", fit->error[k][2]);
        sf_json_bool(&json, "alpha_at_bound", fit->at_bound[k][1]);
        sf_json_bool(&json, "nu_at_bound", fit->at_bound[k][2]);
        sf_json_close(&json, '}');
    }
    sf_json_close(&json, ']');
    sf_json_number(&json, "poisson_at_1_percent", fit->poisson[0]);
    sf_json_number(&json, "poisson_at_largest_strain", fit->poisson[1]);
    sf_json_number(&json, "stress_rms", fit->stress_rms);
    sf_json_number(&json, "lateral_rms", fit->lateral_rms);
    sf_json_bool(&json, "describes_the_test", !sf_hyperfoam_fit_is_poor(fit));
    sf_json_number(&json, "HU", fit->card.hysteresis_hu);
    sf_json_number(&json, "SHAPE", fit->card.hysteresis_shape);
    sf_json_number(&json, "ALPHA", fit->card.hysteresis_alpha);
    sf_json_bool(&json, "HU_at_bound", fit->unloading_at_bound[0]);
    sf_json_bool(&json, "SHAPE_at_bound", fit->unloading_at_bound[1]);
    sf_json_bool(&json, "ALPHA_at_bound", fit->unloading_at_bound[2]);
    sf_json_number(&json, "unloading_rms", fit->unloading_rms);
    sf_json_close(&json, '}');
    fputs("\n", file);
    return sf_staging_close(file, "fit.json", err);
}

static sf_status write_all(const input *in, const sf_hyperfoam_fit *fit, const char *directory, bool force,
                           sf_error *err) {
    sf_staging output;
    if (sf_staging_begin(directory, output_names, force, &output, err) != SF_OK)
        return err->status;
    if (write_points(&output, in, fit, err) == SF_OK && write_json(&output, in, fit, err) == SF_OK &&
        write_material(&output, in, fit, err) == SF_OK)
        sf_staging_commit(&output, err);
    sf_staging_end(&output);
    return err->status;
}

sf_status sf_hyperfoam_fit_file(const char *path, const char *directory, bool force, FILE *log,
                                const sf_sink *sink, sf_error *err) {
    input in = {.name = "foam",
                .card = {.hysteresis_hu = 1,
                         .hysteresis_shape = 1,
                         .hysteresis_alpha = 1,
                         .maxwell_rate = 5000,
                         .rate_reference = 0.01,
                         .rate_filter_time = 1e-4,
                         .stable_to = 0.9}};
    sf_config file;
    sf_hyperfoam_fit fit;
    char misfit[MISFIT_SIZE];
    if (sf_staging_check(directory, output_names, force, err) == SF_OK) {
        if (sf_config_open(path, &file, err) == SF_OK)
            read_root(&file, &in, err);
        sf_config_close(&file);
    }
    if (err->status == SF_OK) {
        in.card.informed_strain = in.data.test.largest_strain;
        fprintf(log, "test %s: %s, %d points of lateral strain\n", in.data.test.path,
                in.data.test.interpretation, in.data.lateral_count);
        if (sf_hyperfoam_fit_run(&in.data, &in.card, in.terms, in.nu, &fit, err) == SF_OK &&
            write_all(&in, &fit, directory, force, err) == SF_OK) {
            fprintf(log, "%s: hyperfoam of %d term%s\n", in.name, in.terms, in.terms > 1 ? "s" : "");
            put_terms(log, &in, &fit);
            fprintf(log, "Files in %s: material.cfg, fit.json, fit.csv\n", directory);
            fflush(log);
            describe_misfit(&fit, misfit);
            if (sf_hyperfoam_fit_is_poor(&fit))
                sf_sink_tell(sink, SF_WARNING, "%s", misfit);
        }
    }
    input_free(&in);
    return err->status;
}
