/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.md */
#include "fit/compression/report.h"

#include "build_info.h"
#include "fit/compression/phrase.h"
#include <math.h>

static void put_tests(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    const sf_compression_config *c = fit->data.config;
    fputs("## Tests\n\n", out);
    if (c->specimen.area > 0 && c->specimen.thickness > 0)
        fprintf(out, "Specimen of %.5g mm2, %.4g mm thick, %.4g kg/m3.\n\n", 1e6 * c->specimen.area,
                1e3 * c->specimen.thickness, c->density);
    fputs("Deviation: root mean square of data less fit, over the scatter (1: nothing but scatter) and in "
          "percent of the stress (counted as a hundredth of the largest at least).\n\n"
          "| file | rate (1/s) | points, loading + unloading | largest strain | largest stress (kPa) | "
          "deviation / scatter, loading | unloading | deviation, loading (%) | unloading (%) |\n"
          "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
          out);
    for (int k = 0; k < c->test_count; k++) {
        const sf_compression_test *t = &c->test[k];
        fprintf(out, "| %s | %.4g | %d + %d | %.4g | %.4g |", t->path, t->rate, t->loading,
                t->count - t->loading, t->largest_strain, 1e-3 * t->largest_stress);
        const double *numbers[2] = {check->rms[k], check->percent[k]};
        for (int n = 0; n < 2; n++)
            for (int side = 0; side < 2; side++)
                if (isnan(numbers[n][side]))
                    fputs(" - |", out);
                else
                    fprintf(out, " %.3g |", numbers[n][side]);
        fputc('\n', out);
    }
    fputs("\nHow the files were read:\n\n", out);
    for (int k = 0; k < c->test_count; k++)
        fprintf(out, "- %s: %s\n", c->test[k].path, c->test[k].understood);
}

static void put_parameters(FILE *out, const sf_compression_fit *fit) {
    fprintf(out,
            "\n## Parameters\n\n| parameter | value | standard error | %g %% interval | note |\n"
            "| --- | ---: | ---: | ---: | --- |\n",
            100 * fit->data.config->confidence);
    for (int k = 0; k < SF_ESTIMATES; k++) {
        const sf_estimate *e = &fit->estimate[k];
        char value[64], error[64], low[64], high[64];
        if (!e->present)
            continue;
        sf_compression_text(e, e->value, value, sizeof value);
        sf_compression_text(e, e->error, error, sizeof error);
        sf_compression_text(e, e->low, low, sizeof low);
        sf_compression_text(e, e->high, high, sizeof high);
        fprintf(out, "| %s | %s | %s | ", e->name, value, error);
        if (isfinite(e->low))
            fprintf(out, "%s to %s", low, high);
        else
            fputc('-', out);
        fprintf(out, " | %s |\n", e->note);
    }
    fprintf(out,
            "\nE is the slope of a straight line through the loading of the slowest test below a strain of "
            "%g; where the curve bends within that range the slope at rest is steeper. The loading curve "
            "with its interval is in loading_curve.csv.\n",
            fit->data.config->modulus_range);
}

static void put_row(FILE *out, const char *phrase, const sf_candidate *c, double lowest, bool chosen) {
    if (c->tried)
        fprintf(out, "| %s | %d | %.6g | %.1f |%s\n", phrase, c->parameters, c->chi2, c->bic - lowest,
                chosen ? " chosen |" : " |");
}

static double lowest_bic(const sf_candidate *c, int count) {
    double lowest = INFINITY;
    for (int k = 0; k < count; k++)
        lowest = c[k].tried ? fmin(lowest, c[k].bic) : lowest;
    return lowest;
}

static void put_choice(FILE *out, const sf_compression_fit *fit) {
    static const char head[] =
        "| form | parameters | chi2 | BIC above the lowest | |\n| --- | ---: | ---: | ---: | --- |\n";
    double rate = lowest_bic(fit->rate, SF_RATE_MODELS), rule = lowest_bic(fit->rule, SF_RULES);
    fprintf(out, "\n## Choice of the law\n\nRate dependence: %s.\n\n",
            sf_compression_rate_phrase(fit->model.form.rate));
    if (isfinite(rate)) {
        fputs(head, out);
        for (int k = 0; k < SF_RATE_MODELS; k++)
            put_row(out, sf_compression_rate_phrase((sf_rate_model)k), &fit->rate[k], rate,
                    k == (int)fit->model.form.rate);
    } else {
        fputs(fit->data.config->test_count > 1 ? "It was prescribed.\n" : "One test says nothing about it.\n",
              out);
    }
    fprintf(out, "\nDensification from the strain %.4g on: %s.\n\n", fit->data.start,
            sf_compression_rule_phrase(fit->model.form.rule));
    if (isfinite(rule)) {
        fputs(head, out);
        for (int k = 0; k < SF_RULES; k++)
            put_row(out, sf_compression_rule_phrase((sf_rule)k), &fit->rule[k], rule,
                    k == (int)fit->model.form.rule);
    } else {
        fputs("It was prescribed.\n", out);
    }
    fputs("\nBIC = n ln(chi2/n) + p ln n; a form that is 10 above the lowest has the data clearly against "
          "it, one within 2 is as good.\n",
          out);
}

static void put_quality(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    fprintf(out,
            "\n## How good it is\n\n"
            "- Scatter of the data about a free smooth curve: %.3g kPa and %.3g %% of the stress.\n"
            "- Misfit chi2/(n - p) = %.3g with n = %d points and p = %d parameters (%d coefficients for each "
            "loading curve). 1: the law leaves nothing but scatter; above it the law misses the data, and "
            "the standard errors are widened by its root.\n"
            "- Correlation of neighbouring deviations %.3g; the variances are multiplied by %.3g for it.\n"
            "- The written card, in the solver's own law, differs from the fit by at most %.2g %%.\n\n"
            "![Data and fit](fit.png)\n",
            1e-3 * fit->data.scatter.absolute, 100 * fit->data.scatter.relative, fit->misfit, fit->data.count,
            fit->model.parameter_count, fit->model.spline.count - 1, fit->correlation, fit->serial,
            check->card_percent);
}

static void put_simulation(FILE *out, const sf_compression_fit *fit, const sf_compression_check *check) {
    if (!check->simulated)
        return;
    fputs("\n## The simulated test\n\nA cube of the fitted material between platens (softfall-solve), in a "
          "time that runs faster with everything that depends on the rate, against the material point of the "
          "fit; means over blocks of time. Differences in percent of the stress, counted as a hundredth of "
          "the largest at least. simulation.csv holds the curves.\n\n"
          "| rate (1/s) | speed-up | largest difference, loading (%) | unloading (%) | energy error |\n"
          "| ---: | ---: | ---: | ---: | ---: |\n",
          out);
    for (int k = 0; k < fit->data.config->test_count; k++)
        fprintf(out, "| %.4g | %.4g | %.2g | %.2g | %.1g |\n", fit->data.config->test[k].rate,
                check->cube[k].speed_up, check->cube[k].percent[0], check->cube[k].percent[1],
                check->cube[k].energy_error);
}

static void put_limits(FILE *out, const sf_compression_fit *fit) {
    const sf_compression_config *c = fit->data.config;
    const sf_estimate *e = fit->estimate;
    double fastest = c->test[c->test_count - 1].rate;
    fprintf(out,
            "\n## Extrapolation\n\n"
            "- Strains beyond %.4g: the densification law extrapolates the last part of the data. Compare "
            "`max_local_strain` of a drop.\n",
            fit->data.end);
    if (fit->model.form.rate == SF_RATE_MAXWELL)
        fprintf(out,
                "- Rates beyond %.3g 1/s: a drop is faster by orders of magnitude, there the branch is a "
                "spring of ED = %.4g kPa.\n",
                fastest, 1e-3 * e[SF_ESTIMATE_ED].value);
    else if (fit->rate_count > 1)
        fprintf(out,
                "- Rates beyond %.3g 1/s: the solver holds the fastest curve; a drop is faster by orders of "
                "magnitude, and the foam may be stiffer there.\n",
                fastest);
    else
        fprintf(out, "- Rates other than those of the tests (to %.3g 1/s): the law has no rate effect.\n",
                fastest);
    fputs("- Unloading faster than in the tests, and reloading: the law unloads on the slowest curve, and "
          "its hysteresis does not depend on the rate.\n"
          "- Tension: it takes the modulus E, which compression does not show.\n"
          "- DAMP is not identified; it is written as given.\n",
          out);
    if (!isfinite(e[SF_ESTIMATE_HU].error))
        fprintf(out, "- HU = %.4g and SHAPE = %.4g: %s.\n", e[SF_ESTIMATE_HU].value,
                e[SF_ESTIMATE_SHAPE].value, e[SF_ESTIMATE_HU].note);
}

sf_status sf_compression_write_report(const sf_staging *output, const sf_compression_fit *fit,
                                      const sf_compression_check *check, const char *path, sf_error *err) {
    FILE *out = sf_staging_open(output, "report.md", err);
    if (!out)
        return err->status;
    fprintf(out,
            "# %s: identification from compression tests\n\nWritten by softfall-fit compression %s (%s) from "
            "%s.\n\n",
            fit->data.config->name, SF_VERSION, SF_GIT_REVISION, path);
    put_tests(out, fit, check);
    put_parameters(out, fit);
    put_choice(out, fit);
    put_quality(out, fit, check);
    put_simulation(out, fit, check);
    put_limits(out, fit);
    return sf_staging_close(out, "report.md", err);
}
