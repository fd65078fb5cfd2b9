/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data of a foam beside its drops that need no simulation: compression tests, at the material point of the
 * law, and cushion curves (ASTM D1596: peak deceleration against static stress), each point one column of
 * foam under a flat mass. Their responses stand before those of the drops, and are exact: space mapping
 * corrects nothing there.
 *
 * Responses: nominal stress over the largest measured one, at strains 0.05 apart (neighbours closer than that
 * deviate alike), loading then unloading; ln of a cushion's peak deceleration in g (F/m, CFC 1000). */
#pragma once
#include "study/config.h"
#include "material/laws.h"

enum { SF_JOINT_MOST = 8, SF_JOINT_POINTS = 48, SF_JOINT_NAME = 64, SF_JOINT_INTERPRETATION = 768 };

typedef struct sf_joint_test {
    char name[SF_JOINT_NAME];
    uint64_t file;                                /* hash of its text */
    double rate;                                  /* s-1, nominal */
    double turn;                                  /* -, largest strain */
    int count, loading;                           /* points; the first of them are loading */
    double strain[SF_JOINT_POINTS];               /* in the order of the test */
    double stress[SF_JOINT_POINTS];               /* Pa */
    double scale;                                 /* Pa, the largest measured stress */
    double sd;                                    /* relative; at low stress of 2 % of the scale */
    char interpretation[SF_JOINT_INTERPRETATION]; /* how the file was read; "": no file */
} sf_joint_test;

typedef struct sf_joint_cushion {
    char name[SF_JOINT_NAME];
    uint64_t file;            /* hash of its text; 0: no file */
    double thickness, height; /* m; of free fall */
    int count;
    double static_stress[SF_JOINT_POINTS]; /* Pa, weight over area */
    double peak_g[SF_JOINT_POINTS];
    double sd; /* relative */
    char interpretation[SF_JOINT_INTERPRETATION];
} sf_joint_cushion;

typedef struct sf_joint {
    int test_count, cushion_count;
    sf_joint_test test[SF_JOINT_MOST];
    sf_joint_cushion cushion[SF_JOINT_MOST];
    int rows; /* of all */
} sf_joint;

/* The lists `compressions` and `cushions` of a fit file; absent: none. SF_ERR_INPUT names file, line and
 * key; data that are there twice are refused. */
sf_status sf_joint_read(const sf_config *config, sf_config_item *root, sf_joint *joint, sf_error *err);

/* Data and their standard deviations, [rows] each. */
void sf_joint_data(const sf_joint *joint, double *measured, double *sd);
/* Responses [rows] of a foam. SF_ERR_NUMERIC: it collapses. */
sf_status sf_joint_respond(const sf_joint *joint, const sf_material_law *law, double *y, sf_error *err);
/* Hashes everything that the responses depend on. */
uint64_t sf_joint_hash(uint64_t hash, const sf_joint *joint);

/* Root mean square of the deviations of a branch, over the largest stress; `first`: its first row. NaN
 * without points. */
double sf_joint_rms(const sf_joint_test *test, bool unloading, const double *y);
