/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pictures of report.html as SVG: the deformed pad, the mid-section at three instants, curves and
 * energies. */
#pragma once
#include "post/figures/figures.h"

enum { SF_INSTANTS = 3 };

/* A picture of report.html. */
typedef struct sf_report_picture {
    char *svg;      /* the SVG element, owned; NULL: it cannot be made */
    char text[400]; /* what it shows, or why there is none */
} sf_report_picture;

typedef struct sf_report_pictures {
    sf_report_picture before, pad, instants, profile, force, energies;
} sf_report_pictures;

/* The pad before a later drop of a series, as its foam is softened; none if the file does not hold it, or on
 * failure. `*picture` is zero before. */
void sf_report_picture_before(const sf_results *results, sf_report_picture *picture, sf_error *err);

/* After history.csv. Release with sf_report_pictures_free, also after a failure (of memory or of a file). */
sf_status sf_report_pictures_make(const sf_staging *output, const sf_results *results,
                                  const sf_figures *figures, sf_report_pictures *pictures, sf_error *err);
void sf_report_pictures_free(sf_report_pictures *pictures);
