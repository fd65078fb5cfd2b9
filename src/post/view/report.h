/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/view/summary.h"

/* The material and the case in a report, from their texts (post/results/origin.h). */

/* The section Material: the keys that the case gives, and the comments of the material. */
void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters);

/* Rows with the values of keys, each given as key and title, until a key is NULL; without the brackets of the
 * case's syntax, and none for a key that is absent. */
void sf_origin_put_keys(sf_html_table *table, const char *parameters, const sf_named_text *list);
#define SF_ORIGIN_PUT(table, parameters, ...)                                                                \
    sf_origin_put_keys(table, parameters, (const sf_named_text[]){__VA_ARGS__, {0}})

/* The pages of a drop share its title, the findings (why the verdict is not "valid"; `line` has
 * SF_VERDICT_LINE_SIZE bytes) and the kind of sf_html_banner. */
enum { SF_REPORT_TITLE_SIZE = 160 };
void sf_report_title(const sf_results *results, char *title, size_t size);
const char *sf_report_findings(const sf_verdict *verdict, char *line, size_t size);
const char *sf_report_kind(sf_grade grade);

/* report.html: one page to hand on, self-contained, usually two sides of A4: verdict, what was dropped on
 * what, the deformed pad at the peak, the mid-section at three instants, curves, figures, material, mesh and
 * where it all comes from. A picture that cannot be made is replaced by the reason. */

/* After sf_plot_write, whose picture the page takes in. */
sf_status sf_report_write(const sf_staging *output, const sf_summary *summary, sf_error *err);
