/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/units.h"

#include "base/text.h"
#include "base/unit_text.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

typedef struct quantity_info {
    const char *phrase;
    const char *unit;
    const char *example;
} quantity_info;

static const quantity_info quantities[SF_QUANTITY_COUNT] = {
    [SF_LENGTH] = {"a length", "m", "5 mm"},
    [SF_MASS] = {"a mass", "kg", "4.6 kg"},
    [SF_TIME] = {"a time", "s", "40 ms"},
    [SF_SPEED] = {"a speed", "m s-1", "4.5 m/s"},
    [SF_ACCELERATION] = {"an acceleration", "m s-2", SF_STANDARD_GRAVITY_TEXT},
    [SF_DENSITY] = {"a density", "kg m-3", "35 kg/m3"},
    [SF_PRESSURE] = {"a pressure or modulus", "Pa", "0.4136 MPa"},
    [SF_RATE] = {"a rate", "s-1", "5000 1/s"},
    [SF_VISCOSITY] = {"a viscosity", "Pa s", "690 Pa s"},
    [SF_AREA] = {"an area", "m2", "25 cm2"},
    [SF_INERTIA] = {"a moment of inertia", "kg m2", "0.012 kg m2"},
    [SF_ANGULAR_VELOCITY] = {"an angular velocity", "rad s-1", "20 rad/s"},
    [SF_FORCE] = {"a force", "N", "2.5 kN"},
};

struct sf_units {
    ut_system *system;
    ut_unit *si[SF_QUANTITY_COUNT];
    ut_error_message_handler previous;
    bool borrowed; /* of the one that is held */
};

const char *sf_quantity_phrase(sf_quantity kind) {
    return quantities[kind].phrase;
}

const char *sf_quantity_unit(sf_quantity kind) {
    return quantities[kind].unit;
}

const char *sf_quantity_example(sf_quantity kind) {
    return quantities[kind].example;
}

static sf_units *held;
static int holders;

sf_status sf_units_hold(sf_error *err) {
    sf_units *units = NULL;
    if (holders == 0 && sf_units_open(&units, err) != SF_OK)
        return err->status;
    if (holders++ == 0)
        held = units;
    return SF_OK;
}

void sf_units_let_go(void) {
    if (--holders == 0) {
        sf_units *last = held;
        held = NULL;
        sf_units_close(&last);
    }
}

sf_status sf_units_open(sf_units **units, sf_error *err) {
    *units = sf_alloc(err, 1, sizeof **units, "the unit system");
    if (!*units)
        return err->status;
    if (held) {
        **units = *held;
        (*units)->borrowed = true;
        return SF_OK;
    }
    (*units)->previous = ut_set_error_message_handler(ut_ignore);
    (*units)->system = ut_read_xml(NULL);
    if (!(*units)->system) {
        sf_units_close(units);
        return SF_FAIL(err, SF_ERR_LIBRARY,
                       "the UDUNITS-2 database cannot be read (package libudunits2-data)");
    }
    for (int k = 0; k < SF_QUANTITY_COUNT; k++) {
        (*units)->si[k] = ut_parse((*units)->system, quantities[k].unit, UT_ASCII);
        if (!(*units)->si[k]) {
            sf_units_close(units);
            return SF_FAIL(err, SF_ERR_LIBRARY, "the UDUNITS-2 database lacks the unit \"%s\"",
                           quantities[k].unit);
        }
    }
    return SF_OK;
}

void sf_units_close(sf_units **units) {
    if (!*units)
        return;
    if ((*units)->borrowed) {
        free(*units);
        *units = NULL;
        return;
    }
    for (int k = 0; k < SF_QUANTITY_COUNT; k++)
        ut_free((*units)->si[k]);
    ut_free_system((*units)->system);
    ut_set_error_message_handler((*units)->previous);
    free(*units);
    *units = NULL;
}

/* UDUNITS calls a unit and its reciprocal convertible; a period is no rate, so only the quotient decides. */
static bool same_dimension(const ut_unit *a, const ut_unit *b) {
    ut_unit *quotient = ut_divide(a, b);
    bool same = quotient && ut_is_dimensionless(quotient);
    ut_free(quotient);
    return same;
}

/* Describes the unit: the phrase of a known kind, or its base units. */
static void describe_unit(const sf_units *units, const ut_unit *unit, char *out, size_t size) {
    for (int k = 0; k < SF_QUANTITY_COUNT; k++) {
        if (same_dimension(unit, units->si[k])) {
            snprintf(out, size, "is %s", quantities[k].phrase);
            return;
        }
    }
    char base[128];
    int length = ut_format(unit, base, sizeof base - 1, UT_ASCII | UT_DEFINITION);
    base[length > 0 && (size_t)length < sizeof base ? length : 0] = '\0';
    if (ut_is_dimensionless(unit))
        snprintf(out, size, "has no dimension");
    else
        snprintf(out, size, "is measured in %s", length > 0 ? base : "something else");
}

/* The product of the factors; NULL if the database lacks one. */
static ut_unit *make_unit(const sf_units *units, const sf_unit_text *text) {
    ut_unit *product = ut_get_dimensionless_unit_one(units->system);
    for (int k = 0; k < text->count && product; k++) {
        ut_unit *name = ut_parse(units->system, text->factor[k].name, UT_ASCII);
        ut_unit *power = name ? ut_raise(name, text->factor[k].power) : NULL;
        ut_unit *next = power ? ut_multiply(product, power) : NULL;
        ut_free(name);
        ut_free(power);
        ut_free(product);
        product = next;
    }
    return product;
}

static sf_status convert(const sf_units *units, const char *text, double number, const ut_unit *unit,
                         sf_quantity kind, double *si, sf_error *err) {
    const quantity_info *want = &quantities[kind];
    if (!same_dimension(unit, units->si[kind])) {
        char found[192];
        describe_unit(units, unit, found, sizeof found);
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\" %s; expected %s, for example \"%s\"%s", text, found,
                       want->phrase, want->example,
                       kind == SF_ACCELERATION && same_dimension(unit, units->si[SF_MASS])
                           ? " (g is the gram; standard gravity is " SF_STANDARD_GRAVITY_TEXT ")"
                           : "");
    }
    cv_converter *converter = ut_get_converter((ut_unit *)unit, units->si[kind]);
    if (!converter)
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\" cannot be converted to %s", text, want->unit);
    double zero = cv_convert_double(converter, 0.0);
    *si = cv_convert_double(converter, number);
    cv_free(converter);
    if (zero != 0.0 || !isfinite(*si))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "\"%s\" has no finite value on a scale that begins at zero; expected %s, for example \"%s\"",
            text, want->phrase, want->example);
    return SF_OK;
}

sf_status sf_units_parse(const sf_units *units, const char *text, sf_quantity kind, double *si,
                         sf_error *err) {
    const quantity_info *want = &quantities[kind];
    *si = 0.0;
    double number = 0;
    const char *rest = sf_decimal_read(text + strspn(text, " \t"), &number);
    if (!rest)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "\"%s\" does not begin with a number; expected %s, for example \"%s\"", text,
                       want->phrase, want->example);
    if (!isfinite(number))
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\" is not finite; expected %s, for example \"%s\"", text,
                       want->phrase, want->example);
    char name[96];
    rest += strspn(rest, " \t");
    bool fits = snprintf(name, sizeof name, "%s", rest) < (int)sizeof name;
    for (size_t end = strlen(name); end > 0 && strchr(" \t", name[end - 1]);)
        name[--end] = '\0';
    if (name[0] == '\0')
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\" has no unit; expected %s, for example \"%s\"", text,
                       want->phrase, want->example);
    const sf_unit_text factors = sf_unit_text_read(name);
    ut_unit *unit = fits && !factors.reason[0] ? make_unit(units, &factors) : NULL;
    if (!unit)
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\": \"%s\" is not a unit%s%s; expected %s, for example \"%s\"",
                       text, name, *factors.reason ? ": " : "", factors.reason, want->phrase, want->example);
    sf_status status = convert(units, text, number, unit, kind, si, err);
    ut_free(unit);
    return status;
}
