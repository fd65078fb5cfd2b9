/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_output.h"

#include "study/material_file.h"
#include "study/fit/compression/fit_check.h"
#include "study/fit/compression/compression_json.h"
#include "study/fit/compression/phrase.h"
#include "study/fit/compression/compression_plot.h"
#include "study/fit/compression/compression_report.h"
#include "io/folder.h"
#include "material/low_density_foam.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Every file that may be written; the material file comes last, when the curves it names are there. */
static const char *const output_names[] = {"simulation.csv", "fit.csv",        "loading_curve.csv",
                                           "fit.gp",         "fit.png",        "fit.json",
                                           "report.html",    "material.csv",   "material-1.csv",
                                           "material-2.csv", "material-3.csv", "material-4.csv",
                                           "material-5.csv", "material-6.csv", "material-7.csv",
                                           "material-8.csv", "material.cfg",   NULL};

/* ---- files ---- */

static void put_estimate(FILE *out, const sf_compression_fit *fit, const sf_estimate *e) {
    char value[64], low[64], high[64];
    sf_compression_text(e, e->value, value, sizeof value);
    sf_compression_text(e, e->low, low, sizeof low);
    sf_compression_text(e, e->high, high, sizeof high);
    fprintf(out, "  %-12s %-12s", e->name, value);
    if (isfinite(e->low))
        fprintf(out, " %g %% interval %s to %s", 100 * fit->data.config->confidence, low, high);
    fprintf(out, "%s%s\n", *e->note ? "  " : "", e->note);
}

/* Provenance of the material file; from malloc. */
static char *provenance(const sf_compression_fit *fit, sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the comments of the material file");
        return NULL;
    }
    fprintf(out, "Identified by softfall-fit compression from\n");
    for (int k = 0; k < c->test_count; k++)
        fprintf(out, "  %s at %.6g 1/s, to a strain of %.4g\n", c->test[k].path, c->test[k].rate,
                c->test[k].largest_strain);
    fprintf(out, "Rate dependence %s.\nDensification from the strain %.4g on by %s.\n",
            sf_compression_rate_phrase(fit->model.form.rate), fit->data.start,
            sf_compression_rule_phrase(fit->model.form.rule));
    for (int k = 0; k < SF_ESTIMATES; k++)
        if (fit->estimate[k].present)
            put_estimate(out, fit, &fit->estimate[k]);
    fprintf(out, "Beyond the strain %.4g and outside these rates it is extrapolation.\n", fit->data.end);
    if (fclose(out) != 0) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the comments of the material file");
        free(text);
        text = NULL;
    }
    return text;
}

static sf_status write_material(const sf_staging *output, const sf_compression_fit *fit,
                                const sf_foam_card *card, sf_error *err) {
    char *text = provenance(fit, err);
    if (!text)
        return err->status;
    const sf_material_text comments = {.title = fit->data.config->name, .provenance = text};
    sf_foam_card informed = *card; /* its curves stay the card's */
    informed.informed_strain = fit->data.end;
    const sf_material material = sf_foam_material(&informed);
    sf_material_write_checked(output->aside, "material", &material, &comments, err);
    free(text);
    return err->status;
}

static sf_status write_points(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    const sf_compression_data *d = &fit->data;
    FILE *file = sf_staging_open(output, "fit.csv", err);
    if (!file)
        return err->status;
    fputs("test,branch,strain,measured_kPa,fit_kPa,sigma_kPa,deviation_over_sigma\n", file);
    for (int i = 0; i < d->count; i++)
        fprintf(file, "%d,%s,%.9g,%.9g,%.9g,%.9g,%.6g\n", d->test[i] + 1,
                d->unloading[i] ? "unloading" : "loading", d->strain[i], 1e-3 * d->stress[i],
                1e-3 * fit->stress[i], 1e-3 * d->sigma[i], (d->stress[i] - fit->stress[i]) / d->sigma[i]);
    return sf_staging_close(file, "fit.csv", err);
}

static sf_status write_curves(const sf_staging *output, const sf_compression_fit *fit, sf_error *err) {
    FILE *file = sf_staging_open(output, "loading_curve.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "# Loading curves of the fit with their %g %% intervals; rate 0: one curve for all rates\n",
            100 * fit->data.config->confidence);
    fputs("rate_1_s,strain,stress_kPa,low_kPa,high_kPa\n", file);
    for (int r = 0; r < fit->rate_count; r++)
        for (int k = 0; k < fit->table_count; k++) {
            double stress = fit->table_stress[r][k], width = fit->quantile * fit->table_error[r][k];
            fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g\n",
                    fit->rate_count > 1 ? fit->data.config->test[r].rate : 0, fit->table_strain[k],
                    1e-3 * stress, 1e-3 * fmax(0, stress - width), 1e-3 * (stress + width));
        }
    return sf_staging_close(file, "loading_curve.csv", err);
}

/* Simulates the tests in DIR/simulation, which stays, and writes the curves. */
static sf_status write_simulation(const sf_staging *output, const sf_compression_fit *fit,
                                  const sf_foam_card *card, const sf_cube_options *cube,
                                  sf_compression_check *check, sf_error *err) {
    char folder[PATH_MAX];
    if (!cube->case_path)
        return SF_OK;
    snprintf(folder, sizeof folder, "%s/simulation", output->directory);
    if (sf_folder_own(folder, err) != SF_OK ||
        sf_compression_simulate(fit, card, cube, folder, check->cube, err) != SF_OK)
        return err->status;
    check->simulated = true;
    FILE *file = sf_staging_open(output, "simulation.csv", err);
    if (!file)
        return err->status;
    fputs("test,strain,cube_kPa,point_kPa\n", file);
    for (int k = 0; k < fit->data.config->test_count; k++)
        for (int i = 0; i < check->cube[k].count; i++)
            fprintf(file, "%d,%.9g,%.9g,%.9g\n", k + 1, check->cube[k].strain[i],
                    1e-3 * check->cube[k].cube[i], 1e-3 * check->cube[k].point[i]);
    return sf_staging_close(file, "simulation.csv", err);
}

/* ---- the summary ---- */

static void print_summary(const sf_compression_fit *fit, const sf_compression_check *check,
                          const char *directory, FILE *log) {
    const sf_compression_config *c = fit->data.config;
    fprintf(log, "%s: %d test%s, %d points, strain to %.4g\n", c->name, c->test_count,
            c->test_count > 1 ? "s" : "", fit->data.count, fit->data.end);
    fprintf(log, "  rate dependence  %s\n", sf_compression_rate_phrase(fit->model.form.rate));
    fprintf(log, "  densification    %s, from strain %.4g\n",
            sf_compression_rule_phrase(fit->model.form.rule), fit->data.start);
    for (int k = 0; k < SF_ESTIMATES; k++)
        if (fit->estimate[k].present)
            put_estimate(log, fit, &fit->estimate[k]);
    fprintf(log,
            "  scatter of the data: %.3g kPa and %.3g %% of the stress; misfit (1 is scatter alone) %.3g\n",
            1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative, fit->misfit);
    fprintf(log, "  card in the solver's law against the fit: largest difference %.2g %%\n",
            check->card_percent);
    fprintf(log,
            "Files in %s: material.cfg and its curves, report.html, fit.png, fit.json, fit.csv, "
            "loading_curve.csv\n",
            directory);
    fflush(log);
}

static void warn(const sf_compression_fit *fit, const char *plot, const sf_sink *sink) {
    if (fit->misfit > 2)
        sf_sink_tell(
            sink, SF_WARNING,
            "the law misses the data by %.3g times their scatter (fit.png, lower panel); the intervals "
            "are widened by as much",
            sqrt(fit->misfit));
    if (*plot)
        sf_sink_tell(sink, SF_WARNING, "%s", plot);
}

sf_status sf_compression_output_check(const char *directory, bool force, sf_error *err) {
    return sf_staging_check(directory, output_names, force, err);
}

sf_status sf_compression_output(const sf_compression_fit *fit, const char *path, const char *command,
                                const char *directory, bool force, const sf_cube_options *cube,
                                const sf_sink *sink, sf_error *err) {
    sf_compression_check check = {.card_percent = 0};
    sf_foam_card card;
    sf_staging output;
    char warning[512] = "";
    if (sf_compression_card(fit, &card, err) != SF_OK)
        return err->status;
    if (sf_compression_check_card(fit, &card, &check, err) == SF_OK &&
        sf_staging_begin(directory, output_names, force, &output, err) == SF_OK) {
        if (write_points(&output, fit, err) == SF_OK && write_curves(&output, fit, err) == SF_OK &&
            write_material(&output, fit, &card, err) == SF_OK &&
            write_simulation(&output, fit, &card, cube, &check, err) == SF_OK &&
            sf_compression_write_json(&output, fit, &check, path, err) == SF_OK &&
            sf_compression_write_plot(&output, fit, warning, sizeof warning, err) == SF_OK &&
            sf_compression_write_report(&output, fit, &check, path, command, err) == SF_OK &&
            sf_staging_commit(&output, err) == SF_OK) {
            print_summary(fit, &check, directory, cube->log);
            warn(fit, warning, sink);
        }
        sf_staging_end(&output);
    }
    sf_compression_card_free(&card);
    return err->status;
}
