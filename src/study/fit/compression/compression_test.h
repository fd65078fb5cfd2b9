/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A compression test from a CSV file (io/table_csv.h): loading, then perhaps unloading, at a constant nominal
 * rate. Strain and stress (engineering strain, nominal stress), or displacement or force of a specimen of
 * known thickness or area; positive in compression, with the scatter of a measurement. Where the file holds
 * all four, strain and stress are taken.
 *
 * Toe correction (ISO 844, ASTM D1621): the steepest straight part at small strains is extended to zero
 * stress; strain counts from there. The points before that part are left out.
 *
 * What is no loading or unloading of the law is left out, and told in `interpretation`: cycles but one, rests
 * at constant strain during which the stress relaxes, tension at the end of unloading. A stress at the start,
 * of a preload, is corrected with the toe, and told without.
 *
 * Of a branch with more than SF_COMPRESSION_BRANCH_POINTS points the means of neighbours are kept: they hold
 * as much about the law, and the fit stays quick. The turn is kept as it is. */
#pragma once
#include "base/error.h"

enum { SF_COMPRESSION_LOADING_POINTS = 20, SF_COMPRESSION_UNLOADING_POINTS = 8 }; /* the least of them */
enum { SF_COMPRESSION_BRANCH_POINTS = 500 };

enum { SF_COMPRESSION_INTERPRETATION = 1024 };

/* Which channels have the other sign. */
typedef enum sf_inversion { SF_INVERT_NONE, SF_INVERT_STRAIN, SF_INVERT_STRESS, SF_INVERT_BOTH } sf_inversion;

/* The facts about a test that its file does not state. */
typedef struct sf_compression_source {
    const char *path; /* borrowed */
    double rate;      /* s-1 */
    double area;      /* m2, of the specimen; 0: unknown */
    double thickness; /* m; 0: unknown */
    bool toe;         /* correct the toe */
    sf_inversion invert;
    double contact_force; /* N, displacement is zero where the force rises to it; 0: as in the file */
    const char *cycle;    /* number of the cycle of the strain; NULL: the first */
} sf_compression_source;

typedef struct sf_compression_test {
    char *path;            /* owned */
    double rate;           /* s-1, nominal, of loading and of unloading */
    double temperature;    /* K, of the foam; 0: the file does not say */
    int count;             /* points */
    int loading;           /* the first of them are loading, the rest unloading */
    double *strain;        /* [count] -, not falling while loading, not rising while unloading; owned */
    double *stress;        /* [count] Pa; owned */
    int *line;             /* [count] in the file; owned */
    double largest_strain; /* - */
    double largest_stress; /* Pa */
    int sorted;            /* points that jitter of the strain had put out of order */
    double toe;            /* -, strain that the correction took away; negative: that a preload hid */
    int cycle, cycles;     /* the cycle that was taken, of those in the strain; 0: there is one */
    int dwell;             /* points of rests under strain that were left out */
    int tension;           /* points at the end of unloading whose stress below zero was taken for zero */
    double preload;        /* -, strain that the stress at the start stands for, if it was not corrected */
    char interpretation[SF_COMPRESSION_INTERPRETATION]; /* how the file was read, for the report */
} sf_compression_test;

/* Reads and checks a test. SF_ERR_INPUT names file, line and value: negative strain or stress, strain of 1 or
 * more, a cycle that is not there, stress that falls by more than a tenth while loading, unloading above
 * loading, too few points, too small a compression; displacement and force without area and thickness; a toe
 * that cannot be found or is longer than a tenth of the thickness. On failure `*test` is zeroed. */
sf_status sf_compression_test_read(const sf_compression_source *source, sf_compression_test *test,
                                   sf_error *err);
void sf_compression_test_free(sf_compression_test *test);

/* Interpolates y over `count` places x, ascending or descending; beyond the ends it returns the end value. */
double sf_compression_at(int count, const double *x, const double *y, double place);

/* Stress of loading at a strain, by interpolation; below the first strain that of the first point. */
double sf_compression_loading_stress(const sf_compression_test *test, double strain);
