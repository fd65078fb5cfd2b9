/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_report.h"

#include "build_info.h"
#include "study/fit/drop/inference_report.h"
#include "study/fit/drop/drop_report_parts.h"
#include "report/chart.h"
#include <stdlib.h>

static void put_misfit(FILE *f, const sf_drop_fit *fit) {
    sf_html_paragraph(
        f,
        "Misfit: %.2f (sum of squared residuals over their standard deviations) with %.1f degrees of "
        "freedom.",
        fit->result.misfit, fit->result.freedom);
    if (fit->result.scale > 1)
        sf_html_paragraph(
            f,
            "The model misses the data by more than their stated standard deviations, so theirs are "
            "multiplied by %.2f in the intervals.",
            fit->result.scale);
}

/* Why the fit has not converged. The marginal standard deviations of the last step can hide a fall of the
 * objective along correlated parameters: what is left of it is said. */
static void describe_end(const sf_drop_fit *fit, char *text, size_t size) {
    static const double LEAST = 0.1;
    const sf_mapping_result *r = &fit->result;
    int used = snprintf(text, size, "%s%s", r->reason ? "; " : "", r->reason ? r->reason : "");
    if (r->gain > LEAST)
        snprintf(&text[used], size - (size_t)used,
                 "; the corrected columns expect the objective to fall by %.2g more", r->gain);
}

static void put_banner(FILE *f, const sf_drop_fit *fit) {
    double low, high;
    bool misses = fit->result.scale > 1;
    char coarse[64] = "", end[192];
    describe_end(fit, end, sizeof end);
    if (fit->coarse_iterations > 0)
        snprintf(coarse, sizeof coarse, " and %d with the coarse mesh of coarse_set", fit->coarse_iterations);
    sf_report_informed_strains(fit, &low, &high);
    sf_html_banner(
        f,
        !fit->result.converged ? "bad"
        : misses               ? "fair"
                               : "good",
        fit->result.converged ? "converged" : "not converged",
        "After %d simulations of every measured drop%s; misfit %.2f with %.1f degrees of freedom%s%s. The drops "
        "inform the curve between strains of %.2f and %.2f.",
        fit->result.iterations, coarse, fit->result.misfit, fit->result.freedom,
        misses ? ", more than the stated standard deviations allow: the intervals are widened" : "", end, low,
        high);
}

static void put_picture(FILE *f, const sf_staging *output) {
    char warning[320];
    char *svg = sf_chart_svg(output, "fit", "softfall-fit", warning, sizeof warning);
    if (svg)
        sf_html_figure(
            f, svg,
            "Identified curve with its 95 %% band, information of the drops about it, and the drops.");
    else
        sf_html_figure(f, NULL, "%s.", warning);
    free(svg);
}

static sf_status write_report(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                              const char *command, const sf_staging *output, sf_error *err) {
    char title[256];
    snprintf(title, sizeof title, "Identification from drops: %s", fit->input->material_name);
    FILE *f = sf_html_begin(output, title, input_path, err);
    if (!f)
        return err->status;
    put_banner(f, fit);
    put_picture(f, output);
    if (average)
        sf_inference_html(f, average, err);
    sf_report_chain_html(f, fit);
    sf_report_drops_html(f, fit);
    sf_report_joint_html(f, fit);
    put_misfit(f, fit);
    sf_report_speeds_html(f, fit);
    sf_report_predictions_html(f, fit);
    sf_report_parameters_html(f, fit);
    sf_report_sensitivities_html(f, fit);
    sf_report_curve_html(f, fit);
    sf_html_heading(f, "The command that repeats this report");
    sf_html_pre(f, command);
    return sf_html_end(f, "softfall-fit drop " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

static sf_status write_json(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                            const sf_staging *output, sf_error *err) {
    FILE *f = sf_staging_open(output, "fit.json", err);
    if (!f)
        return err->status;
    sf_json j = {.file = f, .empty = true};
    sf_json_open(&j, NULL, '{');
    sf_json_text(&j, "program", "softfall-fit drop " SF_VERSION " (" SF_GIT_REVISION ")");
    sf_json_text(&j, "input", input_path);
    sf_json_text(&j, "input_text", fit->input->text);
    sf_json_bool(&j, "converged", fit->result.converged);
    if (fit->result.reason)
        sf_json_text(&j, "reason", fit->result.reason);
    sf_json_integer(&j, "iterations", fit->result.iterations);
    sf_json_integer(&j, "coarse_iterations", fit->coarse_iterations);
    sf_json_number(&j, "expected_gain", fit->result.gain);
    sf_json_number(&j, "misfit", fit->result.misfit);
    sf_json_number(&j, "degrees_of_freedom", fit->result.freedom);
    sf_json_number(&j, "sd_scale", fit->result.scale);
    sf_report_parameters_json(&j, fit);
    sf_report_joint_json(&j, fit);
    sf_report_drops_json(&j, fit);
    if (average)
        sf_inference_json(&j, average, err);
    sf_json_close(&j, '}');
    fputc('\n', f);
    return sf_staging_close(f, "fit.json", err);
}

sf_status sf_drop_report_write(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                               const char *command, const sf_staging *output, char *warning, size_t size,
                               sf_error *err) {
    if (sf_report_curve_csv(fit, output, err) != SF_OK || sf_report_drops_csv(fit, output, err) != SF_OK ||
        sf_report_picture(fit, output, warning, size, err) != SF_OK ||
        sf_report_material(fit, average, input_path, output, err) != SF_OK ||
        write_json(fit, average, input_path, output, err) != SF_OK ||
        (average && sf_inference_csv(average, output, err) != SF_OK))
        return err->status;
    return write_report(fit, average, input_path, command, output, err);
}

void sf_drop_report_print(const sf_drop_fit *fit, FILE *f) {
    double low, high;
    char end[192];
    sf_report_informed_strains(fit, &low, &high);
    describe_end(fit, end, sizeof end);
    fprintf(f, "\n%s after %d iterations", fit->result.converged ? "Converged" : "NOT converged",
            fit->result.iterations);
    if (fit->coarse_iterations > 0)
        fprintf(f, " (and %d with coarse_set)", fit->coarse_iterations);
    fprintf(f, "; misfit %.2f with %.1f degrees of freedom%s\n", fit->result.misfit, fit->result.freedom,
            end);
    sf_report_parameters_print(f, fit);
    sf_report_chain_print(f, fit);
    sf_report_drops_print(f, fit);
    sf_report_joint_print(f, fit);
    fprintf(f, "  the drops see the curve between strains of %.2f and %.2f\n", low, high);
}
