/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The entry of the hyperfoam: its parameters, files and words. */
#include "study/fit/compression/compression_kind.h"

#include "material/unloading.h"
#include "report/row.h"
#include "study/fit/compression/hyperfoam_fit.h"
#include <math.h>

enum { MISFIT_SIZE = 256 };
static const char AT_BOUND[] = " (at its bound)";
static const char *const outputs[] = {"fit.csv", "fit.json", "material.cfg", NULL};

typedef struct fitted {
    const sf_compression_config *config;
    sf_hyperfoam_data data; /* its arrays are the configuration's */
    sf_hyperfoam_fit fit;
} fitted;

static sf_status run(const sf_compression_config *config, void *place, sf_error *err) {
    fitted *f = place;
    const sf_hyperfoam_request *r = &config->hyperfoam;
    const sf_hyperfoam_card card = {.density = config->density,
                                    .damp = config->damp,
                                    .hysteresis_hu = 1,
                                    .hysteresis_shape = 1,
                                    .hysteresis_alpha = 1,
                                    .maxwell_rate = 5000,
                                    .rate_reference = 0.01,
                                    .rate_filter_time = 1e-4,
                                    .stable_to = 0.9,
                                    .informed_strain = config->test[0].largest_strain};
    *f = (fitted){.config = config,
                  .data = {.test = config->test[0],
                           .lateral_count = r->lateral_count,
                           .lateral_at = r->lateral_at,
                           .lateral = r->lateral}};
    return sf_hyperfoam_fit_run(&f->data, &card, r->terms, r->nu, &f->fit, err);
}

static void release(void *place) {
    (void)place; /* the fit owns nothing */
}

static sf_material material_of(const void *place) {
    return sf_hyperfoam_material(&((const fitted *)place)->fit.card);
}

/* ---- words ---- */

static void put_error(FILE *out, double error, bool at_bound) {
    if (at_bound)
        fputs(AT_BOUND, out);
    else if (isfinite(error))
        fprintf(out, " +- %.2g", error);
}

static void put_term(FILE *out, const sf_hyperfoam_fit *fit, int k) {
    const sf_hyperfoam_term *t = &fit->card.term[k];
    fprintf(out, "  term %d: mu %.5g kPa +- %.2g %%, alpha %.4g", k + 1, 1e-3 * t->mu, 100 * fit->error[k][0],
            t->alpha);
    put_error(out, fit->error[k][1], fit->at_bound[k][1]);
    fprintf(out, ", nu %.4g", t->nu);
    put_error(out, fit->error[k][2], fit->at_bound[k][2]);
    fputs("\n", out);
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

static void title(FILE *out, const void *place) {
    const fitted *f = place;
    int terms = f->config->hyperfoam.terms;
    fprintf(out, "%s: hyperfoam of %d term%s\n", f->config->name, terms, terms > 1 ? "s" : "");
}

static void describe(FILE *out, const void *place, bool comments) {
    const fitted *f = place;
    const sf_compression_test *t = &f->data.test;
    const sf_hyperfoam_fit *fit = &f->fit;
    const bool *at_bound = fit->unloading_at_bound;
    char misfit[MISFIT_SIZE];
    if (comments)
        fprintf(out, " from\n  %s at %.6g 1/s, to a strain of %.4g\n", t->path, t->rate, t->largest_strain);
    if (comments && sf_hyperfoam_fit_is_poor(fit)) {
        describe_misfit(fit, misfit);
        fprintf(out, "WARNING: %s\n", misfit);
    }
    for (int k = 0; k < f->config->hyperfoam.terms; k++)
        put_term(out, fit, k);
    fprintf(out, "  -ln(lateral stretch)/ln(axial stretch): %.3g at 1 %% strain, %.3g at %.3g %%\n",
            fit->poisson[0], fit->poisson[1], 100 * t->largest_strain);
    fprintf(out, "  rms while loading: stress %.2g %% of the largest", 100 * fit->stress_rms);
    if (isfinite(fit->lateral_rms))
        fprintf(out, ", lateral strain %.2g %% of the largest", 100 * fit->lateral_rms);
    fputs("\n", out);
    if (isfinite(fit->unloading_rms))
        fprintf(out,
                "  unloading: HU %.4g%s, SHAPE %.4g%s, ALPHA %.4g%s; rms %.2g %% of the largest stress\n",
                fit->card.hysteresis_hu, at_bound[0] ? AT_BOUND : "", fit->card.hysteresis_shape,
                at_bound[1] ? AT_BOUND : "", fit->card.hysteresis_alpha, at_bound[2] ? AT_BOUND : "",
                100 * fit->unloading_rms);
    if (comments)
        fprintf(out, "Beyond that strain and at other rates it is extrapolation. +-: standard errors.\n");
}

static void warn(const void *place, const sf_sink *sink) {
    const fitted *f = place;
    char misfit[MISFIT_SIZE];
    describe_misfit(&f->fit, misfit);
    if (sf_hyperfoam_fit_is_poor(&f->fit))
        sf_sink_tell(sink, SF_WARNING, "%s", misfit);
}

/* ---- files ---- */

static void put_points(FILE *file, const void *place) {
    const fitted *f = place;
    const sf_compression_test *t = &f->data.test;
    const sf_hyperfoam_card *card = &f->fit.card;
    sf_hyperfoam foam = sf_hyperfoam_build(card);
    double side = 0, energy, peak = 0;
    fputs("quantity,branch,strain,measured,fit\n", file);
    sf_hyperfoam_free_stress(&foam, t->largest_strain, &side, &peak);
    side = 0;
    for (int i = 0; i < t->count; i++) {
        bool back = i >= t->loading;
        double stress = sf_hyperfoam_free_stress(&foam, t->strain[i], &side, &energy);
        if (back)
            stress *= sf_unloading_factor(card->hysteresis_hu, card->hysteresis_shape, card->hysteresis_alpha,
                                          fmin(1, energy / peak));
        fprintf(file, "stress_kPa,%s,%.9g,%.9g,%.9g\n", back ? "unloading" : "loading", t->strain[i],
                1e-3 * t->stress[i], 1e-3 * stress);
    }
    side = 0;
    for (int i = 0; i < f->data.lateral_count; i++) {
        sf_hyperfoam_free_stress(&foam, f->data.lateral_at[i], &side, &energy);
        fprintf(file, "lateral_strain,loading,%.9g,%.9g,%.9g\n", f->data.lateral_at[i], f->data.lateral[i],
                side);
    }
}

static sf_value is_good(const void *record) {
    return sf_value_flag(!sf_hyperfoam_fit_is_poor(&((const fitted *)record)->fit));
}

static const sf_row head_rows[] = {
    {.key = "test", SF_ROW_OF(STRING, fitted, data.test.path)},
    {.key = "rate_1_s", SF_ROW_OF(NUMBER, fitted, data.test.rate)},
    {.key = "largest_strain", SF_ROW_OF(NUMBER, fitted, data.test.largest_strain)},
};
static const sf_row tail_rows[] = {
    {.key = "poisson_at_1_percent", SF_ROW_OF(NUMBER, fitted, fit.poisson[0])},
    {.key = "poisson_at_largest_strain", SF_ROW_OF(NUMBER, fitted, fit.poisson[1])},
    {.key = "stress_rms", SF_ROW_OF(NUMBER, fitted, fit.stress_rms)},
    {.key = "lateral_rms", SF_ROW_OF(NUMBER, fitted, fit.lateral_rms)},
    {.key = "describes_the_test", .value = is_good},
    {.key = "HU", SF_ROW_OF(NUMBER, fitted, fit.card.hysteresis_hu)},
    {.key = "SHAPE", SF_ROW_OF(NUMBER, fitted, fit.card.hysteresis_shape)},
    {.key = "ALPHA", SF_ROW_OF(NUMBER, fitted, fit.card.hysteresis_alpha)},
    {.key = "HU_at_bound", SF_ROW_OF(FLAG, fitted, fit.unloading_at_bound[0])},
    {.key = "SHAPE_at_bound", SF_ROW_OF(FLAG, fitted, fit.unloading_at_bound[1])},
    {.key = "ALPHA_at_bound", SF_ROW_OF(FLAG, fitted, fit.unloading_at_bound[2])},
    {.key = "unloading_rms", SF_ROW_OF(NUMBER, fitted, fit.unloading_rms)},
};

static void put_json(sf_json *json, const void *place, const char *path) {
    const fitted *f = place;
    (void)path;
    sf_json_text(json, "law", "hyperfoam");
    sf_json_text(json, "name", f->config->name);
    sf_rows_json(json, SF_ROWS(head_rows), f);
    sf_json_open(json, "terms", '[');
    for (int k = 0; k < f->config->hyperfoam.terms; k++) {
        const sf_hyperfoam_term *t = &f->fit.card.term[k];
        sf_json_open(json, NULL, '{');
        sf_json_number(json, "mu_Pa", t->mu);
        sf_json_number(json, "mu_relative_error", f->fit.error[k][0]);
        sf_json_number(json, "alpha", t->alpha);
        sf_json_number(json, "alpha_error", f->fit.error[k][1]);
        sf_json_number(json, "nu", t->nu);
        sf_json_number(json, "nu_error", f->fit.error[k][2]);
        sf_json_bool(json, "alpha_at_bound", f->fit.at_bound[k][1]);
        sf_json_bool(json, "nu_at_bound", f->fit.at_bound[k][2]);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
    sf_rows_json(json, SF_ROWS(tail_rows), f);
}

const sf_compression_kind sf_compression_hyperfoam = {.label = "hyperfoam",
                                                      .files = "material.cfg, fit.json, fit.csv",
                                                      .outputs = outputs,
                                                      .size = sizeof(fitted),
                                                      .run = run,
                                                      .free = release,
                                                      .material = material_of,
                                                      .title = title,
                                                      .describe = describe,
                                                      .points = put_points,
                                                      .json = put_json,
                                                      .warn = warn};
