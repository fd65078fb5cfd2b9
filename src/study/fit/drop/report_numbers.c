/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

double sf_report_half_width(const sf_drop_fit *fit) {
    return fit->result.scale > 1 ? gsl_cdf_tdist_Pinv(0.975, fit->result.freedom)
                                 : gsl_cdf_ugaussian_Pinv(0.975);
}

sf_estimate_shown sf_report_estimate(const sf_drop_fit *fit, int k) {
    const sf_mapping_result *r = &fit->result;
    double sd = sqrt(r->covariance[k][k]);
    return (sf_estimate_shown){.about = sf_parameter_get(fit->input->unknown[k]),
                               .value = exp(r->u[k]),
                               .low = exp(r->u[k] - sf_report_half_width(fit) * sd),
                               .high = exp(r->u[k] + sf_report_half_width(fit) * sd),
                               .prior = fit->input->prior[k],
                               .shrinkage = sd / fit->input->prior_sd[k]};
}

double sf_report_response(const sf_drop_fit *fit, int d, int which) {
    return exp(fit->y[fit->row[d] + which]);
}

double sf_report_response_sd(const sf_drop_fit *fit, int d, int which) {
    return fit->response_sd[fit->row[d] + which];
}

bool sf_report_shows(const sf_drop_fit *fit, int d, int kind) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    return sf_drop_kind_get(kind)->always || !isnan(drop->value[kind]);
}

const char *sf_report_heading(int kind, char *text, size_t size) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    snprintf(text, size, *about->unit ? "%s (%s)" : "%s", about->name, about->unit);
    return text;
}

double sf_report_curve_rmse(const sf_drop_fit *fit, int d) {
    const sf_fit_drop *drop = &fit->input->drop[d];
    double sum = 0;
    for (int k = 0; k < drop->samples; k++) {
        int row = fit->row[d] + SF_FIT_SAMPLES + k;
        sum += pow(drop->sample_scale * (fit->y[row] - fit->measured[row]), 2);
    }
    return drop->samples > 0 ? sqrt(sum / drop->samples) : NAN;
}

void sf_report_informed_strains(const sf_drop_fit *fit, double *low, double *high) {
    double sum = 0, part = 0;
    *low = *high = 0;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        double before = part;
        part += fit->information[b];
        if (before < 0.05 * sum && part >= 0.05 * sum)
            *low = 0.05 * b;
        if (before < 0.95 * sum && part >= 0.95 * sum)
            *high = 0.05 * (b + 1);
    }
}

void sf_report_put_difference(sf_html_table *table, double scaled, double measured) {
    if (isnan(measured) || isnan(scaled))
        sf_html_cell(table, "–");
    else
        sf_html_cell(table, "%+.1f %%", 100 * (exp(scaled) / measured - 1));
}
