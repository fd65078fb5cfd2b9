/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/plain_file.h"
#include "study/fit/compression/compression_kind.h"
#include "study/material_file.h"
#include "study/setup.h"

static const sf_option options[] = {
    {"simulate", 0, "CASE",
     "press a cube of the fitted material between platens too, as CASE says "
     "(examples/compression/case.cfg), and compare it with the material point",
     .member = offsetof(sf_compression_job, case_path), .group = 1},
    {"friction", 0, "MU", "of the upper platen in --simulate (default: that of CASE)",
     .member = offsetof(sf_compression_job, friction), .group = 1},
    {0},
};

/* Refuses what cannot be done before anything is computed or made. */
static sf_status check_job(const sf_compression_job *job, const sf_compression_kind *kind,
                           const sf_compression_config *config, sf_error *err) {
    const sf_curve_form *form = config->form.form.curve;
    uint64_t ignored; /* the case can be read */
    if (kind->label && job->case_path)
        return SF_REFUSE(err, "--simulate does not work with %s = \"%s\" in %s", form ? "curve_form" : "law",
                         form ? form->name : kind->label, job->study->input);
    if (config->thermal && job->case_path)
        return SF_REFUSE(err, "--simulate does not work with tests at several temperatures, in %s",
                         job->study->input);
    SF_TRY(sf_study_check(job->study, kind->outputs, err));
    return job->case_path ? sf_plain_hash(job->case_path, "case file", SF_PLAIN_TEXT, &ignored, err) : SF_OK;
}

static void print_tests(const sf_compression_config *config) {
    for (int k = 0; k < config->test_count; k++) {
        printf("test %s: %s", config->test[k].path, config->test[k].interpretation);
        if (config->hyperfoam.terms > 0)
            printf(", %d points of lateral strain", config->hyperfoam.lateral_count);
        putchar('\n');
    }
    fflush(stdout);
}

static sf_status write_material(const sf_staging *output, const sf_compression_kind *kind, const void *fit,
                                const char *title, bool thermal, sf_error *err) {
    SF_OWNED SF_TEXT_STREAM(out, text, size);
    if (out) {
        fputs("Identified by softfall-fit compression", out);
        kind->describe(out, fit, true);
    }
    if (!out || fclose(out) != 0)
        return SF_NO_MEMORY(err, "the comments of the material file");
    const sf_material_text comments = {.title = title, .provenance = text, .temperatures = thermal};
    const sf_material material = kind->material(fit);
    return sf_material_write_checked(output->aside, "material", &material, &comments, err);
}

static sf_status write_all(const sf_compression_job *job, const sf_compression_kind *kind, void *fit,
                           const sf_compression_config *config, char *warning, size_t size, sf_error *err) {
    sf_staging *output = &job->study->output;
    SF_TRY(sf_staging_begin(job->study->directory, kind->outputs, job->study->force, output, err));
    SF_CSV_FILE(points, output, "fit.csv", err);
    kind->points(&points, fit);
    SF_TRY(sf_csv_close(&points, err));
    if (kind->more)
        SF_TRY(kind->more(job, fit, warning, size, err));
    SF_JSON_FILE(json, output, "fit.json", err);
    kind->json(&json, fit, job->study->input);
    sf_json_close(&json);
    SF_TRY(sf_staging_close(json.file, "fit.json", err));
    SF_TRY(write_material(output, kind, fit, config->name, config->thermal, err));
    return sf_staging_commit(output, err);
}

static sf_status fit_and_write(const sf_compression_job *job, const sf_compression_kind *kind,
                               const sf_compression_config *config, void *fit, sf_error *err) {
    char warning[512] = "";
    SF_TRY(kind->run(config, fit, err));
    SF_TRY(write_all(job, kind, fit, config, warning, sizeof warning, err));
    kind->describe(stdout, fit, false);
    sf_study_close(job->study, kind->files, warning);
    kind->warn(fit, &job->study->sink);
    return SF_OK;
}

static sf_status run(sf_study *study, void *own, sf_error *err) {
    sf_compression_job *job = own;
    SF_OWNED_BY(sf_compression_config_free) sf_compression_config config = {0};
    job->study = study;
    if (job->friction && !job->case_path)
        return SF_REFUSE(err, "--friction needs --simulate");
    SF_TRY(sf_compression_config_read(study->input, &config, err));
    const sf_compression_kind *kind = config.hyperfoam.terms > 0 ? &sf_compression_hyperfoam
                                      : config.form.form.curve   ? &sf_compression_form_kind
                                                                 : &sf_compression_tables;
    SF_TRY(check_job(job, kind, &config, err));
    SF_OWNED void *fit = sf_alloc(err, 1, kind->size, "the fit");
    SF_TRY(err->status);
    print_tests(&config);
    fit_and_write(job, kind, &config, fit, err);
    if (kind->free)
        kind->free(fit);
    return err->status;
}

int sf_fit_compression_main(int argc, char **argv) {
    static const sf_study_program program = {
        .name = "softfall-fit",
        .word = "compression",
        .argument = "FIT.cfg",
        .doc = "A material file from compression tests of a foam.\vWrites material.cfg with its curves, "
               "report.html, fit.json, fit.png (and .gp), fit.csv and loading_curve.csv. "
               "docs/identification.md explains FIT.cfg and the report.",
        .options = options,
        .run = run,
    };
    sf_compression_job job = {0};
    return sf_study_main(argc, argv, &program, &job);
}
