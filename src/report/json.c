/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/json.h"

#include "base/text.h"
#include "report/html.h"
#include <math.h>

static void put_text(FILE *file, const char *text) {
    fputc('"', file);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        int length = sf_utf8_length(s);
        if (length == 0) {
            fputs("\\ufffd", file);
            length = 1;
        } else if (*s == '"' || *s == '\\') {
            fprintf(file, "\\%c", *s);
        } else if (*s < 0x20 || *s == 0x7f || *s == '<') {
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

void sf_json_base64(sf_json *json, const char *key, const unsigned char *data, size_t size) {
    begin(json, key);
    fputc('"', json->file);
    sf_html_base64(json->file, data, size);
    fputc('"', json->file);
}

void sf_json_text(sf_json *json, const char *key, const char *text) {
    begin(json, key);
    if (text)
        put_text(json->file, text);
    else
        fputs("null", json->file);
}
