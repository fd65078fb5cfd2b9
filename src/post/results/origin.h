/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The texts of /provenance in results.h5 about its case, for a report. */
#pragma once
#include "post/results/results.h"

/* A text of the file ("/provenance/model/case_text"); from malloc, owned by the caller; "" if the file does
 * not hold it, NULL only without memory. */
char *sf_origin_text(const sf_results *results, const char *path);

enum { SF_ORIGIN_NAME_SIZE = 160 };

/* A line of /provenance/model/parameters. */
typedef struct sf_origin_key {
    char name[SF_ORIGIN_NAME_SIZE];
    char value[512]; /* as used, a text without its quotes */
    char si[64];     /* in SI units, or what was read; "-": the same */
    bool given;      /* in the case; else the default */
} sf_origin_key;

/* The keys of the group `report` of a case, words about the test. */
enum { SF_ORIGIN_REPORT_KEYS = 3 };
extern const char *const sf_origin_report_keys[SF_ORIGIN_REPORT_KEYS];
/* The line of report.NAME; false if the case does not give it. */
bool sf_origin_find_report(const char *parameters, const char *name, sf_origin_key *key);
