/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char DIGITS[] = "0123456789";

/* Length of a word of C for a number that is not finite. */
static size_t not_finite(const char *text) {
    static const char *const words[] = {"infinity", "inf", "nan"};
    for (int k = 0; isalpha((unsigned char)*text) && k < 3; k++)
        if (strncasecmp(text, words[k], strlen(words[k])) == 0)
            return strlen(words[k]);
    return 0;
}

const char *sf_decimal_read(const char *text, double *value) {
    const char *at = text + (*text == '+' || *text == '-');
    size_t word = not_finite(at);
    if (word > 0) {
        *value = NAN;
        return at + word;
    }
    size_t whole = strspn(at, DIGITS), part = 0;
    char *end = NULL;
    bool hexadecimal = whole == 1 && *at == '0' && (at[1] == 'x' || at[1] == 'X');
    if (at[whole] == '.')
        part = strspn(at + whole + 1, DIGITS);
    if (whole + part == 0 || hexadecimal)
        return NULL;
    *value = strtod(text, &end);
    return end;
}

bool sf_decimal_is(const char *text, double *value) {
    const char *end = sf_decimal_read(text, value);
    return end && *end == '\0' && isfinite(*value);
}

bool sf_whole_is(const char *text, long low, long high, int *value) {
    char *end;
    errno = 0;
    long number = strtol(text, &end, 10);
    if (strspn(text, "0123456789") == 0 || *end != '\0' || errno != 0 || number < low || number > high)
        return false;
    *value = (int)number;
    return true;
}
