/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A compression test that is good, as a file. */
#ifndef SF_TESTS_SHEET_FIXTURE_H
#define SF_TESTS_SHEET_FIXTURE_H

#include "program_fixture.h"

enum { SHEET_POINTS = 60 };

typedef struct sheet {
    const char *header;
    int unloading;
    double strain[2 * SHEET_POINTS], stress[2 * SHEET_POINTS]; /* in the file's units */
} sheet;

/* Loading stress (kPa) at a strain, and its integral. */
double sheet_stress(double strain);
double sheet_energy(double strain);

/* Loads with `factor` times that stress, and unloads by HU = 0.05, SHAPE = 2.5. */
sheet sheet_good(double factor);

/* Writes the file; returns its path, as program_path does. */
const char *sheet_write(const program_place *place, const char *name, const sheet *s);

#define SHEET_TEST_LIST "tests = ( { file = \"slow.csv\"; rate = \"0.1 1/min\"; } );\n"

#endif
