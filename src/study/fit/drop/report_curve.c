/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include "material/foam.h"
#include <math.h>

void sf_report_curve_html(FILE *f, const sf_drop_fit *fit) {
    double low, high, sum = 0;
    sf_report_informed_strains(fit, &low, &high);
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    sf_html_heading(f, "Which strains the drops see");
    sf_html_note(
        f,
        "Nine tenths of the information lie between strains of %.2f and %.2f. Outside, its form and the priors "
        "determine the curve.",
        low, high);
    sf_html_table table = sf_html_table_begin(
        f, "dense", "strain|>part of the information|>standard deviation of the stress|>before the data");
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%.2f to %.2f", 0.05 * b, 0.05 * (b + 1));
        sf_html_cell(&table, "%.1f %%", 100 * fit->information[b] / fmax(sum, 1e-300));
        sf_html_cell(&table, "%.1f %%", 100 * expm1(fit->curve_sd[b]));
        sf_html_cell(&table, "%.0f %%", 100 * expm1(fit->curve_prior_sd[b]));
    }
    sf_html_table_end(&table);
}

sf_status sf_report_curve_csv(const sf_drop_fit *fit, const sf_staging *output, sf_error *err) {
    sf_foam_card card;
    double sum = 0;
    FILE *f = sf_staging_open(output, "fit-curve.csv", err);
    if (!f)
        return err->status;
    for (int b = 0; b < SF_FIT_STRAIN_BINS; b++)
        sum += fit->information[b];
    if (sf_drop_fit_card(fit->input, fit->result.u, &card, err) == SF_OK) {
        sf_curve curve;
        fputs("strain,stress_kPa,low95_kPa,high95_kPa,information\n", f);
        if (sf_curve_build(&card, 0, &curve, err) == SF_OK)
            for (int b = 0; b < SF_FIT_STRAIN_BINS; b++) {
                double strain = 0.05 * (b + 0.5), stress, slope, energy,
                       band = exp(sf_report_half_width(fit) * fit->curve_sd[b]);
                sf_curve_evaluate(&curve, strain, &stress, &slope, &energy);
                fprintf(f, "%.3f,%.6g,%.6g,%.6g,%.6g\n", strain, 1e-3 * stress, 1e-3 * stress / band,
                        1e-3 * stress * band, fit->information[b] / fmax(sum, 1e-300));
            }
        sf_curve_free(&curve);
        sf_foam_card_free(&card);
    }
    return sf_staging_close(f, "fit-curve.csv", err);
}
