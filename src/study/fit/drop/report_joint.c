/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/report_parts.h"

#include <math.h>

/* Does the rate of the test say nothing of the rate factor? */
static bool is_below_reference(const sf_drop_fit *fit, const sf_joint_test *test) {
    const double *start = fit->input->start;
    return start[SF_PARAMETER_RATE_FACTOR] > 0 && test->rate < start[SF_PARAMETER_RATE_REFERENCE];
}

/* Compression tests and cushion curves. */
void sf_report_joint_html(FILE *f, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    if (joint->rows == 0)
        return;
    sf_html_heading(f, "Compression tests and cushion curves");
    sf_html_note(
        f,
        "The law at a material point, and as one column of foam under a flat mass. Deviations of a "
        "test are root mean squares over its largest stress. Below rate_reference the law has no effect of "
        "the rate.");
    sf_html_table table =
        sf_html_table_begin(f, "dense", "test|>rate (1/s)|>± %|>loading|>unloading|>largest strain");
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        sf_html_row(&table);
        sf_html_cell(&table, "%s", test->name);
        sf_html_cell(&table, "%.3g%s", test->rate,
                     is_below_reference(fit, test) ? ", below rate_reference" : "");
        sf_html_number(&table, 1, 100 * test->sd);
        sf_html_cell(&table, "%.1f %%", 100 * sf_joint_rms(test, false, y));
        sf_html_number(&table, 3, sf_joint_rms(test, true, y));
        sf_html_number(&table, 3, test->turn);
    }
    sf_html_table_end(&table);
    table = sf_html_table_begin(
        f, "dense", "cushion|>static stress (kPa)|>peak measured (g)|>± %|>of the foam (g)|>difference");
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++, y++) {
            const sf_joint_cushion *cushion = &joint->cushion[c];
            sf_html_row(&table);
            sf_html_cell(&table, "%s", cushion->name);
            sf_html_cell(&table, "%.4g", 1e-3 * cushion->static_stress[k]);
            sf_html_number(&table, 1, cushion->peak_g[k]);
            sf_html_number(&table, 1, 100 * cushion->sd);
            sf_html_number(&table, 1, exp(*y));
            sf_report_put_difference(&table, *y, cushion->peak_g[k]);
        }
    sf_html_table_end(&table);
}

void sf_report_joint_json(sf_json *j, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    sf_json_open(j, "compressions", '[');
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        sf_json_open(j, NULL, '{');
        sf_json_text(j, "name", test->name);
        sf_json_text(j, "understood", test->understood);
        sf_json_number(j, "rate_1_s", test->rate);
        sf_json_bool(j, "below_rate_reference", is_below_reference(fit, test));
        sf_json_integer(j, "points", test->count);
        sf_json_number(j, "loading_rms", sf_joint_rms(test, false, y));
        sf_json_number(j, "unloading_rms", sf_joint_rms(test, true, y));
        sf_json_close(j, '}');
    }
    sf_json_close(j, ']');
    sf_json_open(j, "cushions", '[');
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++) {
            sf_json_open(j, NULL, '{');
            sf_json_text(j, "name", joint->cushion[c].name);
            sf_json_number(j, "static_stress_Pa", joint->cushion[c].static_stress[k]);
            sf_json_number(j, "peak_measured_g", joint->cushion[c].peak_g[k]);
            sf_json_number(j, "peak_g", exp(*y++));
            sf_json_close(j, '}');
        }
    sf_json_close(j, ']');
}

void sf_report_joint_print(FILE *f, const sf_drop_fit *fit) {
    const sf_joint *joint = &fit->input->joint;
    const double *y = fit->y;
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count) {
        const sf_joint_test *test = &joint->test[t];
        fprintf(f, "  %-20s  deviation %.1f %% of the largest stress in loading", test->name,
                100 * sf_joint_rms(test, false, y));
        if (test->count > test->loading)
            fprintf(f, ", %.1f %% in unloading", 100 * sf_joint_rms(test, true, y));
        if (is_below_reference(fit, test))
            fputs(" (below rate_reference, where the law has no effect of the rate)", f);
        fputc('\n', f);
    }
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++)
            fprintf(f, "  %-20s  %.4g kPa: peak %.1f g (measured %.4g)\n", joint->cushion[c].name,
                    1e-3 * joint->cushion[c].static_stress[k], exp(*y++), joint->cushion[c].peak_g[k]);
}
