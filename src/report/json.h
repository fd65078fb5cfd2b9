/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes strictly valid JSON (RFC 8259): a number that is not finite becomes null, texts are escaped and
 * bytes that are not UTF-8 become U+FFFD. A key of NULL stands for an element of an array. No text holds a '<', so that the whole may
 * stand in a script element of a page. */
#ifndef SF_IO_JSON_H
#define SF_IO_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct sf_json {
    FILE *file;
    int depth;
    bool empty; /* nothing yet in the innermost object or array */
} sf_json;

void sf_json_open(sf_json *json, const char *key, char bracket); /* bracket: '{' or '[' */
void sf_json_close(sf_json *json, char bracket);                 /* '}' or ']' */
void sf_json_number(sf_json *json, const char *key, double value);
void sf_json_integer(sf_json *json, const char *key,
                     int64_t value); /* negative: null (all of ours are counts) */
void sf_json_bool(sf_json *json, const char *key, bool value);
void sf_json_text(sf_json *json, const char *key, const char *text); /* NULL: null */
void sf_json_base64(sf_json *json, const char *key, const unsigned char *data, size_t size);

#endif
