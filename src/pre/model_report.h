/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of softfall-pre: size and checks of the model, before a run. It is printed as a table, and
 * stands in model.h5 (/provenance/report) a line for each entry: key, name and value, separated by tabs. */
#pragma once
#include "pre/build.h"

enum { SF_MODEL_REPORT_LINES = 32 + SF_INTERFACES_LISTED, SF_MODEL_REPORT_VALUE = 200 };

typedef struct sf_report_line {
    const char *key, *name; /* static */
    char value[SF_MODEL_REPORT_VALUE];
} sf_report_line;

typedef struct sf_model_report {
    int count;
    sf_report_line line[SF_MODEL_REPORT_LINES];
} sf_model_report;

void sf_model_report_make(const sf_model *model, const sf_build_report *report, sf_model_report *out);
void sf_model_report_print(FILE *out, const sf_model_report *report);

/* The text of /provenance/report; from malloc, owned by the caller; NULL without memory. */
char *sf_model_report_text(const sf_model_report *report, sf_error *err);
