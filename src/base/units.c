/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/units.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <udunits2.h>

#include "base/text.h"

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
    [SF_VOLTAGE] = {"a voltage", "V", "10 mV"},
    [SF_TEMPERATURE] = {"a temperature", "K", "23 degC"},
    [SF_MOLAR_ENERGY] = {"an activation energy", "J mol-1", "80 kJ/mol"},
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

/* ---- the text of a unit ---- */

/* The text of a unit, "m/s2", as factors: names of one table with powers. Numbers, offsets and every other
 * name are refused, so that nothing in the text can change the value unseen. */

enum { FACTORS = 8, NAME = 16, POWER = 4, REASON = 96 };

typedef struct unit_factor {
    char name[NAME]; /* of UDUNITS: "mm", "us" */
    int power;       /* -POWER to POWER, not 0 */
} unit_factor;

typedef struct unit_text {
    int count;
    unit_factor factor[FACTORS];
    char reason[REASON]; /* empty: the text is a unit; else what is wrong with it */
} unit_text;

/* Prefixes are listed by unit: a typing error in a prefix (Mm for mm, mPa for MPa) is refused. "u" also
 * stands for the micro signs. No hertz or becquerel: a rate of strain is 1/s. */
static const struct {
    const char *kind, *names, *prefixes; /* names "a|b", each with every prefix and without one */
} unit_names[] = {
    {"length", "m", "numcdk"},
    {"length",
     "metre|metres|meter|meters|centimetre|centimetres|centimeter|centimeters|millimetre|millimetres", ""},
    {"length",
     "millimeter|millimeters|micrometre|micrometres|micrometer|micrometers|in|inch|inches|ft|foot|feet|mil",
     ""},
    {"mass", "g", "umk"},
    {"mass", "gram|grams|milligram|milligrams|kilogram|kilograms|t|tonne|tonnes|lb|lbm|pound|pounds", ""},
    {"mass", "oz|ounce|ounces", ""},
    {"time", "s", "num"},
    {"time", "sec|second|seconds|msec|millisecond|milliseconds|usec|microsecond|microseconds", ""},
    {"temperature", "K", ""},
    {"time", "min|minute|minutes|h|hour|hours", ""},
    {"force", "N", "mkM"},
    {"force", "daN|newton|newtons|kilonewton|kilonewtons|kgf|lbf", ""},
    {"pressure", "Pa", "hkMG"},
    {"pressure", "pascal|pascals|kilopascal|kilopascals|megapascal|megapascals|psi|ksi", ""},
    {"pressure", "bar", "mk"},
    {"pressure", "psf", ""},
    {"density", "pcf", ""},
    {"speed", "mph", ""},
    {"voltage", "V", "umk"},
    {"energy", "J", "k"},
    {"amount", "mol", ""},
    {"angle", "rad|radian|radians", ""},
};
enum { UNITS = sizeof unit_names / sizeof *unit_names, DEEPEST = 4 };

typedef struct reader {
    const char *at;
    unit_text *out;
    int depth;
} reader;

static bool fail(const reader *r, const char *format, const char *text) {
    if (!r->out->reason[0])
        snprintf(r->out->reason, sizeof r->out->reason, format, text);
    return false;
}

static bool starts(const char *text, const char *with) {
    return strncmp(text, with, strlen(with)) == 0;
}

static bool is_name(const char *name) {
    for (int k = 0; k < UNITS; k++)
        if (sf_word_find(unit_names[k].names, name) >= 0 ||
            (*name && strchr(unit_names[k].prefixes, *name) &&
             sf_word_find(unit_names[k].names, name + 1) >= 0))
            return true;
    return false;
}

/* Letters; the micro sign and the Greek mu become "u". */
static bool read_name(reader *r, char name[NAME]) {
    size_t used = 0;
    const char *from = r->at;
    while (isalpha((unsigned char)*r->at) || starts(r->at, "\xC2\xB5") || starts(r->at, "\xCE\xBC")) {
        bool letter = isalpha((unsigned char)*r->at) != 0;
        if (used + 1 < NAME)
            name[used++] = letter ? *r->at : 'u';
        r->at += letter ? 1 : 2;
    }
    name[used] = '\0';
    if (is_name(name))
        return true;
    SF_PRINTED(shown, NAME + 24, "%.*s", (int)(r->at - from), from);
    if (used > 0)
        return fail(r, "unknown unit \"%.24s\" (softfall-pre --keys lists them)", shown);
    if (isdigit((unsigned char)*r->at))
        return fail(r, "a second number \"%.24s\" follows", r->at);
    return fail(r, "a unit's name is missing before \"%.24s\"", r->at);
}

/* "2", "-1", "^2", "²", "⁻¹"; 1 if none follows. */
static bool read_power(reader *r, int *power) {
    static const struct {
        const char *text;
        int value;
    } raised[] = {{"\xC2\xB9", 1}, {"\xC2\xB2", 2}, {"\xC2\xB3", 3}, {"\xE2\x81\xB4", 4}};
    bool caret = *r->at == '^', up_minus = !caret && starts(r->at, "\xE2\x81\xBB");
    const char *from = r->at;
    r->at += 1 * caret + 3 * up_minus;
    bool minus = !up_minus && *r->at == '-';
    r->at += minus;
    *power = 0;
    for (size_t k = 0; !caret && !minus && k < sizeof raised / sizeof *raised && !*power; k++)
        if (starts(r->at, raised[k].text)) {
            *power = raised[k].value;
            r->at += strlen(raised[k].text);
        }
    if (!*power && !up_minus && isdigit((unsigned char)*r->at))
        *power = *r->at++ - '0';
    bool given = r->at > from;
    if (given && (*power < 1 || *power > POWER || isdigit((unsigned char)*r->at)))
        return fail(r, "\"%.24s\" is not a power from 1 to 4 or -1 to -4", from);
    if (!given)
        *power = 1;
    else if (minus || up_minus)
        *power = -*power;
    return true;
}

static bool read_product(reader *r);

static bool read_bracket(reader *r) {
    if (++r->depth > DEEPEST)
        return fail(r, "brackets are nested too deep at \"%.24s\"", r->at);
    r->at += 1 + strspn(r->at + 1, " \t");
    if (!read_product(r))
        return false;
    if (*r->at != ')')
        return fail(r, "a bracket is not closed%s", "");
    r->at++;
    r->depth--;
    return true;
}

/* One factor, of the power `sign`. */
static bool read_factor(reader *r, int sign) {
    int first = r->out->count, power = 1;
    char name[NAME] = "";
    bool bracket = *r->at == '(';
    if (bracket ? !read_bracket(r) : !read_name(r, name))
        return false;
    if (!read_power(r, &power))
        return false;
    if (!bracket) {
        if (first == FACTORS)
            return fail(r, "it has too many factors: \"%.24s\"", name);
        r->out->count++;
        memcpy(r->out->factor[first].name, name, sizeof name);
        r->out->factor[first].power = 1;
    }
    for (int k = first; k < r->out->count; k++) {
        r->out->factor[k].power *= sign * power;
        if (abs(r->out->factor[k].power) > POWER)
            return fail(r, "the power of \"%.24s\" is too large", r->out->factor[k].name);
    }
    return true;
}

/* The sign between two factors: 1, -1, or 0 at the end of the product. */
static int read_operator(reader *r) {
    const char *blanks = r->at;
    r->at += strspn(r->at, " \t");
    const char *sign = r->at;
    bool dot = starts(sign, "\xC2\xB7");
    if (*sign == '/' || *sign == '.' || *sign == '*' || dot) {
        r->at += dot ? 2 : 1;
        r->at += strspn(r->at, " \t");
        return *sign == '/' ? -1 : 1;
    }
    return *sign && *sign != ')' && sign > blanks ? 1 : 0;
}

static bool read_product(reader *r) {
    int sign = 1;
    const char *slash = r->at + 1 + strspn(r->at + (*r->at != '\0'), " \t");
    if (*r->at == '1' && *slash == '/') {
        r->at++;
        sign = read_operator(r);
    }
    do {
        if (!read_factor(r, sign))
            return false;
    } while ((sign = read_operator(r)) != 0);
    return true;
}

/* Grammar: product = factor { ("/" | "." | "*" | "·" | blanks) factor }, from left to right (kg/m s is (kg/m)
 * s); factor = (name | "(" product ")") [power], power = ["^"] ["-"] digit, or ², ³, ⁻¹; the first factor of
 * a product may be 1 if "/" follows. */
static unit_text read_unit(const char *text) {
    unit_text out = {0};
    reader r = {text, &out, 0};
    if (read_product(&r) && *r.at)
        fail(&r, isdigit((unsigned char)*r.at) ? "a second number \"%.24s\" follows" : "\"%.24s\" follows it",
             r.at);
    return out;
}

/* ---- the database ---- */

static sf_units *held;

sf_status sf_units_hold(sf_error *err) {
    sf_units *units = NULL;
    if (!held && sf_units_open(&units, err) == SF_OK)
        held = units;
    return err->status;
}

sf_status sf_units_open(sf_units **units, sf_error *err) {
    *units = sf_alloc(err, 1, sizeof **units, "the unit system");
    SF_TRY(err->status);
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
    if (!(*units)->borrowed) {
        for (int k = 0; k < SF_QUANTITY_COUNT; k++)
            ut_free((*units)->si[k]);
        ut_free_system((*units)->system);
        ut_set_error_message_handler((*units)->previous);
    }
    sf_release(units);
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

/* Returns how the database knows a name: its own oz is a fluid ounce, others it lacks. */
static const char *database_name(const char *name) {
    static const struct {
        const char *names, *known;
    } other[] = {{"oz|ounce|ounces", "0.0625 lb"},
                 {"lbm", "lb"},
                 {"psf", "lbf/ft2"},
                 {"pcf", "lb/ft3"},
                 {"mph", "international_mile/hour"}};
    for (size_t k = 0; k < sizeof other / sizeof *other; k++)
        if (sf_word_find(other[k].names, name) >= 0)
            return other[k].known;
    return name;
}

/* The product of the factors; NULL if the database lacks one. */
static ut_unit *make_unit(const sf_units *units, const unit_text *text) {
    ut_unit *product = ut_get_dimensionless_unit_one(units->system);
    for (int k = 0; k < text->count && product; k++) {
        ut_unit *name = ut_parse(units->system, database_name(text->factor[k].name), UT_ASCII);
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
        return SF_REFUSE(err, "\"%s\" %s; expected %s, for example \"%s\"%s", text, found, want->phrase,
                         want->example,
                         kind == SF_ACCELERATION && same_dimension(unit, units->si[SF_MASS])
                             ? " (g is the gram; standard gravity is " SF_STANDARD_GRAVITY_TEXT ")"
                             : "");
    }
    cv_converter *converter = ut_get_converter((ut_unit *)unit, units->si[kind]);
    if (!converter)
        return SF_REFUSE(err, "\"%s\" cannot be converted to %s", text, want->unit);
    double zero = cv_convert_double(converter, 0.0);
    *si = cv_convert_double(converter, number);
    cv_free(converter);
    if (zero != 0.0 || !isfinite(*si))
        return SF_REFUSE(
            err, "\"%s\" has no finite value on a scale that begins at zero; expected %s, for example \"%s\"",
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
        return SF_REFUSE(err, "\"%s\" does not begin with a number; expected %s, for example \"%s\"", text,
                         want->phrase, want->example);
    if (!isfinite(number))
        return SF_REFUSE(err, "\"%s\" is not finite; expected %s, for example \"%s\"", text, want->phrase,
                         want->example);
    char name[96];
    rest += strspn(rest, " \t");
    bool fits = snprintf(name, sizeof name, "%s", rest) < (int)sizeof name;
    for (size_t end = strlen(name); end > 0 && strchr(" \t", name[end - 1]);)
        name[--end] = '\0';
    if (*name == ',' && sf_decimal_read(name + 1, NULL))
        return SF_REFUSE(err, "\"%s\" has a decimal comma; write a decimal point, for example \"%s\"", text,
                         want->example);
    if (name[0] == '\0')
        return SF_REFUSE(err, "\"%s\" has no unit; expected %s, for example \"%s\"", text, want->phrase,
                         want->example);
    if (kind == SF_TEMPERATURE &&
        strcmp(name, "degC") == 0) { /* the only scale that does not begin at zero */
        *si = number + SF_CELSIUS;
        return SF_OK;
    }
    const unit_text factors = read_unit(name);
    ut_unit *unit = fits && !factors.reason[0] ? make_unit(units, &factors) : NULL;
    if (!unit)
        return SF_REFUSE(err, "\"%s\": \"%s\" is not a unit%s%s; expected %s, for example \"%s\"", text, name,
                         *factors.reason ? ": " : "", factors.reason, want->phrase, want->example);
    sf_status status = convert(units, text, number, unit, kind, si, err);
    ut_free(unit);
    return status;
}

sf_status sf_units_read(const char *text, sf_quantity kind, double *si, sf_error *err) {
    sf_units *units = NULL;
    if (sf_units_open(&units, err) == SF_OK)
        sf_units_parse(units, text, kind, si, err);
    sf_units_close(&units);
    return err->status;
}

static void print_names(FILE *file, const char *names, const char *prefixes) {
    for (const char *at = names; *at;) {
        size_t length = strcspn(at, "|");
        fprintf(file, " `%.*s`", (int)length, at);
        for (const char *p = prefixes; *p; p++)
            fprintf(file, " `%c%.*s`", *p, (int)length, at);
        at += length + (at[length] == '|');
    }
}

void sf_unit_text_print(FILE *file) {
    fputs("| kind | names |\n|---|---|\n", file);
    for (int k = 0; k < UNITS; k++) {
        bool same = k > 0 && strcmp(unit_names[k].kind, unit_names[k - 1].kind) == 0;
        if (!same)
            fprintf(file, "%s| %s |", k ? " |\n" : "", unit_names[k].kind);
        print_names(file, unit_names[k].names, unit_names[k].prefixes);
    }
    fputs(" |\n\nThe `u` of a micrometre, microgram or microsecond may be `µ`.\n", file);
}
