/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/json.h"

#include <math.h>

/* Length of the well-formed UTF-8 sequence at `s`, 0 if there is none (RFC 3629). */
static int utf8_length(const unsigned char *s) {
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

static void put_text(FILE *file, const char *text) {
    fputc('"', file);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        int length = utf8_length(s);
        if (length == 0) {
            fputs("\\ufffd", file);
            length = 1;
        } else if (*s == '"' || *s == '\\') {
            fprintf(file, "\\%c", *s);
        } else if (*s < 0x20 || *s == 0x7f) {
            fprintf(file, "\\u%04x", *s);
        } else {
            fwrite(s, 1, (size_t)length, file);
        }
        s += length;
    }
    fputc('"', file);
}

static void begin(sf_json *json, const char *key) {
    if (json->depth > 0)
        fprintf(json->file, "%s\n%*s", json->empty ? "" : ",", 2 * json->depth, "");
    json->empty = false;
    if (key) {
        put_text(json->file, key);
        fputs(": ", json->file);
    }
}

void sf_json_open(sf_json *json, const char *key, char bracket) {
    begin(json, key);
    fputc(bracket, json->file);
    json->depth++;
    json->empty = true;
}

void sf_json_close(sf_json *json, char bracket) {
    json->depth--;
    if (!json->empty)
        fprintf(json->file, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->file);
    if (json->depth == 0)
        fputc('\n', json->file);
    json->empty = false;
}

void sf_json_number(sf_json *json, const char *key, double value) {
    begin(json, key);
    if (isfinite(value))
        fprintf(json->file, "%.9g", value);
    else
        fputs("null", json->file);
}

void sf_json_integer(sf_json *json, const char *key, int64_t value) {
    begin(json, key);
    if (value >= 0)
        fprintf(json->file, "%lld", (long long)value);
    else
        fputs("null", json->file);
}

void sf_json_bool(sf_json *json, const char *key, bool value) {
    begin(json, key);
    fputs(value ? "true" : "false", json->file);
}

void sf_json_text(sf_json *json, const char *key, const char *text) {
    begin(json, key);
    if (text)
        put_text(json->file, text);
    else
        fputs("null", json->file);
}
