/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/error.h"

/* Quantities with units: "4.5 m/s" to 4.5, "160 mm" to 0.16. UDUNITS-2 knows the size of each unit; only
 * units.c includes its header. Error messages quote the text and name its kind and the kind
 * expected. */

/* m s-2: the g of a_max and of drop heights (CGPM 1901), and as the text of a quantity. */
#define SF_STANDARD_GRAVITY 9.80665
#define SF_CELSIUS 273.15 /* K, of 0 degC */
#define SF_STANDARD_GRAVITY_TEXT SF_UNITS_QUOTE(SF_STANDARD_GRAVITY) " m/s2"
#define SF_UNITS_QUOTE(value) SF_UNITS_QUOTE_AS_IS(value)
#define SF_UNITS_QUOTE_AS_IS(value) #value

/* The kinds of quantity in softfall's inputs. */
typedef enum sf_quantity {
    SF_LENGTH,
    SF_MASS,
    SF_TIME,
    SF_SPEED,
    SF_ACCELERATION,
    SF_DENSITY,
    SF_PRESSURE,
    SF_RATE,
    SF_VISCOSITY,
    SF_FORCE,
    SF_AREA,
    SF_INERTIA,
    SF_VOLTAGE,
    SF_TEMPERATURE,      /* K, or degC of the scale that begins at SF_CELSIUS */
    SF_MOLAR_ENERGY,     /* of an activation */
    SF_ANGULAR_VELOCITY, /* last: UDUNITS takes a radian for 1, so that it has the dimension of a rate */
    SF_QUANTITY_COUNT,
} sf_quantity;

/* The unit system: UDUNITS' database, loaded once. While one is open UDUNITS prints nothing. */
typedef struct sf_units sf_units;

/* Loads the database. `*units` is owned by the caller: release with sf_units_close (which takes NULL as
 * well). SF_ERR_LIBRARY if the database cannot be read. */
sf_status sf_units_open(sf_units **units, sf_error *err);
void sf_units_close(sf_units **units);

/* For a program that reads very many cases: from now on every sf_units_open takes the database that is loaded
 * now (5 ms each otherwise). For programs, in one thread. */
sf_status sf_units_hold(sf_error *err);

/* Reads "number unit" into the SI value of `kind`: one decimal number, one unit in the grammar and of the
 * names of base/units.h, nothing else. SF_ERR_INPUT if the number or the unit is missing or unknown, if
 * the unit belongs to another kind (reciprocals too), or the value is not finite. */
sf_status sf_units_parse(const sf_units *units, const char *text, sf_quantity kind, double *si,
                         sf_error *err);

/* The same by a system of its own. */
sf_status sf_units_read(const char *text, sf_quantity kind, double *si, sf_error *err);

/* "a speed", "m s-1" and "4.5 m/s"; static storage. */
const char *sf_quantity_phrase(sf_quantity kind);
const char *sf_quantity_unit(sf_quantity kind);
const char *sf_quantity_example(sf_quantity kind);

/* The names as Markdown: a table for docs/case.md. */
void sf_unit_text_print(FILE *file);
