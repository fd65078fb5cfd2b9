/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdbool.h>

#include "base/error.h"
#include "case/case.h"
#include "pre/mesh/broker.h"

/* The parameters that a .geo file offers: gmsh itself accepts a value for any name without a message, so that
 * a misspelt parameter would keep its default unnoticed. */

/* Refuses a parameter of the source that no DefineConstant of the texts that the geometry read defines; the
 * sentence lists those that exist. `complete`: `read` holds all of them; else the named file is read here,
 * and the others are not. */
sf_status sf_geo_parameters_check(const sf_geo_source *source, const sf_broker *read, bool complete,
                                  sf_error *err);

/* The same before anything is meshed, for a .geo file that includes and merges no other: it defines all that
 * there is. Of every other geometry nothing is said. */
sf_status sf_geo_parameters_check_alone(const sf_geo_source *source, sf_error *err);
