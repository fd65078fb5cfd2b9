/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop for fits that takes half a second. */
#ifndef FIT_FIXTURE_H
#define FIT_FIXTURE_H

#include "program_fixture.h"

/* Writes case.cfg, 4.6 kg with 4.5 m/s on a coarse quarter of a 70 mm pad, and its foam start.cfg with
 * start.csv. */
void fit_fixture_put_case(const program_place *place);

#endif
