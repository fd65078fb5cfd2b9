/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include <math.h>

/* A heading for each unknown parameter after the first one, all of numbers. */
static sf_html_table begin_matrix(FILE *f, const sf_fit_input *in, const char *first) {
    char columns[1024];
    size_t used = (size_t)snprintf(columns, sizeof columns, "%s", first);
    for (int k = 0; k < in->unknown_count && used < sizeof columns; k++)
        used += (size_t)snprintf(columns + used, sizeof columns - used, "|>%s",
                                 sf_parameter_get(in->unknown[k])->name);
    return sf_html_table_begin(f, "dense", columns);
}

static void put_correlations(FILE *f, const sf_drop_fit *fit) {
    sf_html_paragraph(f, "Correlation of their logarithms:");
    sf_html_table table = begin_matrix(f, fit->input, "");
    for (int j = 0; j < fit->input->unknown_count; j++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%s", sf_parameter_get(fit->input->unknown[j])->name);
        for (int k = 0; k < fit->input->unknown_count; k++)
            sf_html_cell(&table, "%+.2f",
                         fit->result.covariance[j][k] /
                             sqrt(fit->result.covariance[j][j] * fit->result.covariance[k][k]));
    }
    sf_html_table_end(&table);
}

void sf_report_parameters_html(FILE *f, const sf_drop_fit *fit) {
    sf_html_heading(f, "Parameters");
    sf_html_note(
        f,
        "95 %% intervals (of the logarithm, linearised). A parameter that keeps 90 %% or more of its prior's "
        "width was hardly seen by the drops.");
    sf_html_table table = sf_html_table_begin(
        f, "dense", "parameter|>value|>95 %|>prior|>prior factor (1 sd)|>width left of the prior|meaning");
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        sf_html_row(&table);
        sf_html_cell(&table, "%s%s%s", e.about->name, *e.about->unit ? ", " : "", e.about->unit);
        sf_html_cell(&table, "%.4g", e.value / s);
        sf_html_cell(&table, "%.4g to %.4g", e.low / s, e.high / s);
        sf_html_cell(&table, "%.4g", e.prior / s);
        sf_html_cell(&table, "%.2f", exp(fit->input->prior_sd[k]));
        sf_html_cell(&table, "%.0f %%", 100 * e.shrinkage);
        sf_html_cell(&table, "%s", e.about->description);
    }
    sf_html_table_end(&table);
    put_correlations(f, fit);
}

void sf_report_sensitivities_html(FILE *f, const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    sf_html_heading(f, "Sensitivity");
    sf_html_note(f, "Change of the response in %% for 1 %% more of the parameter.");
    sf_html_table table = begin_matrix(f, in, "response");
    for (int d = 0; d < in->drop_count; d++)
        for (int which = 0; which < SF_FIT_SAMPLES; which++) {
            if (!sf_report_shows(fit, d, which))
                continue;
            sf_html_row(&table);
            sf_html_cell(&table, "%s, %s", in->drop[d].name, sf_drop_kind_get(which)->name);
            for (int k = 0; k < in->unknown_count; k++)
                sf_html_cell(&table, "%+.3f", fit->gradient[(fit->row[d] + which) * fit->parameters + k]);
        }
    sf_html_table_end(&table);
}

static void json_parameter(sf_json *j, const sf_drop_fit *fit, int k) {
    sf_estimate_shown e = sf_report_estimate(fit, k);
    sf_json_open(j, NULL, '{');
    sf_json_text(j, "name", e.about->name);
    sf_json_number(j, "value_SI", e.value);
    sf_json_number(j, "low95_SI", e.low);
    sf_json_number(j, "high95_SI", e.high);
    sf_json_number(j, "prior_SI", e.prior);
    sf_json_number(j, "prior_sd_of_logarithm", fit->input->prior_sd[k]);
    sf_json_number(j, "sd_of_logarithm", sqrt(fit->result.covariance[k][k]));
    sf_json_close(j, '}');
}

void sf_report_parameters_json(sf_json *j, const sf_drop_fit *fit) {
    sf_json_open(j, "parameters", '[');
    for (int k = 0; k < fit->input->unknown_count; k++)
        json_parameter(j, fit, k);
    sf_json_close(j, ']');
    sf_json_open(j, "covariance_of_logarithms", '[');
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_json_open(j, NULL, '[');
        for (int i = 0; i < fit->input->unknown_count; i++)
            sf_json_number(j, NULL, fit->result.covariance[k][i]);
        sf_json_close(j, ']');
    }
    sf_json_close(j, ']');
}

void sf_report_parameters_print(FILE *f, const sf_drop_fit *fit) {
    for (int k = 0; k < fit->input->unknown_count; k++) {
        sf_estimate_shown e = sf_report_estimate(fit, k);
        double s = e.about->per_unit;
        fprintf(f, "  %-8s %10.4g %-5s 95 %% linearised: %.4g to %.4g  (%.0f %% of the prior's width)\n",
                e.about->name, e.value / s, e.about->unit, e.low / s, e.high / s, 100 * e.shrinkage);
    }
}
