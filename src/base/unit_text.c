/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/unit_text.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Prefixes are listed by unit: a typing error in a prefix (Mm for mm, mPa for MPa) is refused. "u" also
 * stands for the micro signs. No hertz or becquerel: a rate of strain is 1/s. */
static const struct {
    const char *kind, *names, *prefixes; /* names "a|b", each with every prefix and without one */
} units[] = {
    {"length", "m", "numcdk"},
    {"length",
     "metre|metres|meter|meters|centimetre|centimetres|centimeter|centimeters|millimetre|millimetres", ""},
    {"length",
     "millimeter|millimeters|micrometre|micrometres|micrometer|micrometers|in|inch|inches|ft|foot|feet", ""},
    {"mass", "g", "umk"},
    {"mass", "gram|grams|milligram|milligrams|kilogram|kilograms|t|tonne|tonnes|lb|pound|pounds", ""},
    {"time", "s", "num"},
    {"time", "sec|second|seconds|msec|millisecond|milliseconds|usec|microsecond|microseconds", ""},
    {"time", "min|minute|minutes|h|hour|hours", ""},
    {"force", "N", "mkM"},
    {"force", "daN|newton|newtons|kilonewton|kilonewtons|kgf|lbf", ""},
    {"pressure", "Pa", "hkMG"},
    {"pressure", "pascal|pascals|kilopascal|kilopascals|megapascal|megapascals|psi|ksi", ""},
    {"pressure", "bar", "mk"},
    {"angle", "rad|radian|radians", ""},
};
enum { UNITS = sizeof units / sizeof *units, DEEPEST = 4 };

typedef struct reader {
    const char *at;
    sf_unit_text *out;
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

/* Does the name stand in the list "a|b"? */
static bool is_listed(const char *name, const char *list) {
    size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, '|')) {
        at += *at == '|';
        if (length > 0 && strncmp(at, name, length) == 0 && (at[length] == '|' || at[length] == '\0'))
            return true;
    }
    return false;
}

static bool is_name(const char *name) {
    for (int k = 0; k < UNITS; k++)
        if (is_listed(name, units[k].names) ||
            (*name && strchr(units[k].prefixes, *name) && is_listed(name + 1, units[k].names)))
            return true;
    return false;
}

/* Letters; the micro sign and the Greek mu become "u". */
static bool read_name(reader *r, char name[SF_UNIT_NAME]) {
    size_t used = 0;
    const char *from = r->at;
    while (isalpha((unsigned char)*r->at) || starts(r->at, "\xC2\xB5") || starts(r->at, "\xCE\xBC")) {
        bool letter = isalpha((unsigned char)*r->at) != 0;
        if (used + 1 < SF_UNIT_NAME)
            name[used++] = letter ? *r->at : 'u';
        r->at += letter ? 1 : 2;
    }
    name[used] = '\0';
    if (is_name(name))
        return true;
    char shown[SF_UNIT_NAME + 24];
    snprintf(shown, sizeof shown, "%.*s", (int)(r->at - from), from);
    return used > 0 ? fail(r, "there is no unit \"%.24s\" here (softfall-pre --keys lists them)", shown)
           : isdigit((unsigned char)*r->at) ? fail(r, "a second number \"%.24s\" follows", r->at)
                                            : fail(r, "a unit's name is missing before \"%.24s\"", r->at);
}

/* "2", "-1", "^2", "²", "⁻¹"; 1 if none follows. */
static bool read_power(reader *r, int *power) {
    static const struct {
        const char *text;
        int value;
    } raised[] = {{"\xC2\xB9", 1}, {"\xC2\xB2", 2}, {"\xC2\xB3", 3}, {"\xE2\x81\xB4", 4}};
    bool caret = *r->at == '^', up_minus = !caret && starts(r->at, "\xE2\x81\xBB");
    const char *from = r->at;
    r->at += caret ? 1 : up_minus ? 3 : 0;
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
    if (given && (*power < 1 || *power > SF_UNIT_POWER || isdigit((unsigned char)*r->at)))
        return fail(r, "\"%.24s\" is not a power from 1 to 4 or -1 to -4", from);
    *power = !given ? 1 : minus || up_minus ? -*power : *power;
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
    char name[SF_UNIT_NAME] = "";
    bool bracket = *r->at == '(';
    if (bracket ? !read_bracket(r) : !read_name(r, name))
        return false;
    if (!read_power(r, &power))
        return false;
    if (!bracket) {
        if (first == SF_UNIT_FACTORS)
            return fail(r, "it has too many factors: \"%.24s\"", name);
        r->out->count++;
        memcpy(r->out->factor[first].name, name, sizeof name);
        r->out->factor[first].power = 1;
    }
    for (int k = first; k < r->out->count; k++) {
        r->out->factor[k].power *= sign * power;
        if (abs(r->out->factor[k].power) > SF_UNIT_POWER)
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

sf_unit_text sf_unit_text_read(const char *text) {
    sf_unit_text out = {0};
    reader r = {text, &out, 0};
    if (read_product(&r) && *r.at)
        fail(&r, isdigit((unsigned char)*r.at) ? "a second number \"%.24s\" follows" : "\"%.24s\" follows it",
             r.at);
    return out;
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
        bool same = k > 0 && strcmp(units[k].kind, units[k - 1].kind) == 0;
        if (!same)
            fprintf(file, "%s| %s |", k ? " |\n" : "", units[k].kind);
        print_names(file, units[k].names, units[k].prefixes);
    }
    fputs(" |\n\nThe `u` of a micrometre, microgram or microsecond may be `µ`.\n", file);
}
