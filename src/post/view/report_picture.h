/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/figures.h"
#include "io/staging.h"

enum { SF_INSTANTS = 3 };

/* The pictures of report.html as SVG elements, owned; one that cannot be made is NULL, and its text says why;
 * else the text says what it shows. */
typedef struct sf_report_pictures {
    char *pad, *instants, *profile, *force, *energies;
    char pad_text[400], instants_text[400], profile_text[400], force_text[400], energies_text[400];
} sf_report_pictures;

/* After history.csv. Release with sf_report_pictures_free, also after a failure (of memory or of a file). */
sf_status sf_report_pictures_make(const sf_staging *output, const sf_results *results,
                                  const sf_figures *figures, sf_report_pictures *pictures, sf_error *err);
void sf_report_pictures_free(sf_report_pictures *pictures);
