/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of softfall-cfh: cfh.json, cfh.csv, cfh_band.csv, cfh_draws.csv, report.html, and the lines on the
 * terminal. */
#ifndef SF_CFH_REPORT_H
#define SF_CFH_REPORT_H

#include "study/cfh/foams.h"
#include "study/cfh/search.h"
#include "study/cfh/spread.h"
#include "io/staging.h"

typedef struct sf_cfh_report {
    const char *case_path;
    const char *material;               /* file, NULL: the case's own */
    const char *case_text, *parameters; /* of the case, as in sf_case */
    const char *command_line;
    const char *rig_path;  /* NULL: free fall */
    const char *posterior; /* folder of the draws, NULL: none */
    const sf_cfh_plan *plan;
    const sf_cfh_rig *rig;
    const sf_cfh_points *points;
    const sf_cfh_result *result;
    sf_cfh_step ending;
    double mass; /* kg */
    const sf_cfh_foams *foams;
    const sf_cfh_spread *spread;        /* NULL: no interval of the foam is known */
    char no_interval[SF_CFH_NOTE_SIZE]; /* with `posterior`: why there is none; "": there is one */
} sf_cfh_report;

enum { SF_CFH_VERDICT_SIZE = 2 * SF_CFH_NOTE_SIZE + 400 };

/* The critical fall height in a sentence or two. */
void sf_cfh_verdict_text(const sf_cfh_report *report, char *text, size_t size);

sf_status sf_cfh_write_json(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
sf_status sf_cfh_write_csv(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
/* cfh_band.csv and cfh_draws.csv, if there is an interval. */
sf_status sf_cfh_write_draws(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
/* After sf_cfh_plot, whose picture the page takes in. */
sf_status sf_cfh_write_page(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
void sf_cfh_print(FILE *out, const sf_cfh_report *report);

#endif
