/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of softfall-cfh: cfh.json, cfh.csv, report.html, and the lines on the terminal. */
#ifndef SF_CFH_REPORT_H
#define SF_CFH_REPORT_H

#include "cfh/foams.h"
#include "cfh/search.h"
#include "io/staging.h"

typedef struct sf_cfh_report {
    const char *case_path;
    const char *material;               /* file, NULL: the case's own */
    const char *case_text, *parameters; /* of the case, as in sf_case */
    const char *command_line;
    const char *rig_path; /* NULL: free fall */
    const sf_cfh_plan *plan;
    const sf_cfh_rig *rig;
    const sf_cfh_points *points;
    const sf_cfh_result *result;
    sf_cfh_step ending;
    double mass; /* kg */
    const sf_cfh_foams *foams;
} sf_cfh_report;

/* The critical fall height in one sentence. */
void sf_cfh_verdict_text(const sf_cfh_report *report, char *text, size_t size);

sf_status sf_cfh_write_json(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
sf_status sf_cfh_write_csv(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
/* After sf_cfh_plot, whose picture the page takes in. */
sf_status sf_cfh_write_page(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
void sf_cfh_print(FILE *out, const sf_cfh_report *report);

#endif
