/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/view/summary.h"
#include "report/html.h"

/* The material and the case in a report, from their texts (post/results/origin.h). */

/* The section Material: the keys that the case gives, and the comments of the material. */
void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters);

/* A row with the value of a key, without the brackets of the case's syntax; none if the key is absent. */
void sf_origin_put_key(sf_html_table *table, const char *parameters, const char *name, const char *title);

/* The pages of a drop share its title, the findings (why the verdict is not "valid"; `line` has
 * SF_VERDICT_LINE_SIZE bytes) and the kind of sf_html_banner. */
enum { SF_REPORT_TITLE_SIZE = 160 };
void sf_report_title(const sf_results *results, char *title, size_t size);
const char *sf_report_findings(const sf_verdict *verdict, char *line, size_t size);
const char *sf_report_kind(sf_grade grade);

/* report.html: one page to hand on, self-contained, usually two sides of A4: verdict, what was dropped on
 * what, the deformed pad at the peak, the mid-section at three instants, curves, figures, material, mesh and
 * where it all comes from. A picture that cannot be made is replaced by the reason. */

typedef struct sf_report {
    const sf_summary *summary;
    const char *command_line; /* of softfall-post */
} sf_report;

/* After sf_plot_write, whose picture the page takes in. */
sf_status sf_report_write(const sf_staging *output, const sf_report *report, sf_error *err);
