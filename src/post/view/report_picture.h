/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/figures.h"
#include "io/staging.h"

enum { SF_INSTANTS = 3 };

/* The pictures of report.html as SVG elements, owned; one that cannot be made is NULL, and its text says why;
 * else the text says what it shows. */
typedef struct sf_report_pictures {
    char *before, *pad, *instants, *profile, *force, *energies;
    char before_text[400], pad_text[400], instants_text[400], profile_text[400], force_text[400],
        energies_text[400];
} sf_report_pictures;

/* The pad before a later drop of a series, as its foam is softened; NULL, and `text` says why, if the file
 * does not hold it, or on failure. */
char *sf_report_picture_before(const sf_results *results, char *text, size_t size, sf_error *err);

/* After history.csv. Release with sf_report_pictures_free, also after a failure (of memory or of a file). */
sf_status sf_report_pictures_make(const sf_staging *output, const sf_results *results,
                                  const sf_figures *figures, sf_report_pictures *pictures, sf_error *err);
void sf_report_pictures_free(sf_report_pictures *pictures);
