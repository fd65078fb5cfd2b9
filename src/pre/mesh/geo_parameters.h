/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/mesh/broker.h"

/* The parameters that a .geo file offers: gmsh itself accepts a value for any name without a message, so that
 * a misspelt parameter would keep its default unnoticed. */

/* Multiplies the spacings of the source, the parameters with "spacing" in their names, by its factor: those
 * that it gives, and those that it leaves to defaults which are plain numbers of its .geo file. */
sf_status sf_geo_parameters_scale(const sf_geo_source *source, sf_geo_source *scaled, sf_error *err);

/* Refuses a parameter of the source that no DefineConstant of the texts that the geometry read defines; the
 * sentence lists those that exist. Refuses one that is none of the Choices of its DefineConstant. Refuses a
 * factor that a spacing does not follow, or that has none, too. `complete`: `read` holds all texts; else the
 * named file is read here, and the others are not. `read` NULL: nothing is meshed yet, and only of .geo files
 * that include and merge no other anything is said. */
sf_status sf_geo_parameters_check(const sf_geo_source *source, const sf_broker *read, bool complete,
                                  sf_error *err);
