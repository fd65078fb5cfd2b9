/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <stdarg.h>
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
    double ignored;
    size_t word = not_finite(at);
    value = value ? value : &ignored;
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

bool sf_text_contradicts(const char *one, const char *other) {
    one += strspn(one, " \t");
    other += strspn(other, " \t");
    size_t length = strcspn(one, "= \t");
    if (strncmp(one, other, length) != 0 || strcspn(other, "= \t") != length)
        return false;
    one += length + strspn(one + length, " \t");
    other += length + strspn(other + length, " \t");
    return *one == '=' && *other == '=' && strcmp(one, other) != 0;
}

int sf_word_find(const char *list, const char *word) {
    size_t length = strlen(word);
    int place = 0;
    for (const char *at = list; at; at = strchr(at, '|'), place++) {
        at += *at == '|';
        if (length > 0 && strcspn(at, "|") == length && strncmp(at, word, length) == 0)
            return place;
    }
    return -1;
}

const char *sf_word_at(const char *list, int place, int *length) {
    for (; place > 0 && strchr(list, '|'); place--)
        list = strchr(list, '|') + 1;
    *length = (int)strcspn(list, "|");
    return list;
}

char *sf_line_take(char **rest, const char *name, char separator) {
    char *line = *rest ? strsep(rest, "\n") : NULL;
    size_t length = strlen(name);
    return line && strncmp(line, name, length) == 0 && line[length] == separator ? line + length + 1 : NULL;
}

const char *sf_blanks_pass(const char *text, bool hash) {
    for (;;) {
        text += strspn(text, " \t\r\n\v\f");
        if ((hash && *text == '#') || strncmp(text, "//", 2) == 0) {
            text += strcspn(text, "\n");
        } else if (strncmp(text, "/*", 2) == 0) {
            const char *end = strstr(text + 2, "*/");
            text = end ? end + 2 : text + strlen(text);
        } else {
            return text;
        }
    }
}

int sf_utf8_length(const unsigned char *s) {
    static const struct {
        unsigned char first_low, first_high, second_low, second_high;
        int length;
    } forms[] = {
        {0x00, 0x7f, 0, 0, 1},       {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
        {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
        {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
    };
    for (size_t k = 0; k < sizeof forms / sizeof forms[0]; k++) {
        if (s[0] < forms[k].first_low || s[0] > forms[k].first_high)
            continue;
        if (forms[k].length > 1 && (s[1] < forms[k].second_low || s[1] > forms[k].second_high))
            return 0;
        for (int j = 2; j < forms[k].length; j++)
            if ((s[j] & 0xc0) != 0x80)
                return 0;
        return forms[k].length;
    }
    return 0;
}

int sf_utf8_cut(const char *text, int size) {
    int length = (int)strnlen(text, (size_t)size + 1);
    if (length <= size)
        return length;
    for (length = size; length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80;)
        length--;
    return length;
}

void sf_text_add(char *text, size_t size, const char *format, ...) {
    size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

char *sf_text_close(FILE *stream, char **text) {
    if (stream && fclose(stream) == 0)
        return *text;
    free(*text);
    return *text = NULL;
}
