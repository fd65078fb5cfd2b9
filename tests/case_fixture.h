/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case of which every file is there, its faults, and the sentences that they get. */
#ifndef SF_TESTS_CASE_FIXTURE_H
#define SF_TESTS_CASE_FIXTURE_H

#include "case/case.h"

#define GEOMETRY "geometry: { file = \"pad.geo\"; length_unit = \"mm\"; };\n"
#define MATERIAL "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curve = \"foam.csv\"; };\n"
#define MISSILE "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"
#define SOLVER "solver: { end_time = \"40 ms\"; };\n"
#define GOOD GEOMETRY MATERIAL MISSILE SOLVER

/* The folder of the group of tests, with the files that GOOD names. */
int case_set_up(void **state);
int case_tear_down(void **state);
/* The path of a file there. */
const char *case_path(const char *name);
void case_write(const char *name, const char *text);

/* Reads `text` as case.cfg with up to one override. */
sf_status case_read_text(const char *text, const char *override, sf_case *c, sf_error *err);
/* The same; the test fails if it is refused. */
void case_read_good(const char *text, const char *override, sf_case *c);
/* The case must be refused with a sentence that holds every one of the parts (up to NULL). */
void case_assert_refused(const char *text, const char *override, ...);

#endif
