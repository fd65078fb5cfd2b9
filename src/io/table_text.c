/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a table's file, its lines and its numbers with groups of digits. */
#include "io/table_text.h"

#include "base/text.h"
#include "io/plain_file.h"
#include "io/table_heading.h"

#include <iconv.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* ---- the text of a file ---- */

/* UTF-16 with a byte order mark, as spreadsheets save "Unicode text", becomes UTF-8. */
static sf_status convert_utf16(const char *path, const char *what, char **whole_text, size_t *length,
                               sf_error *err) {
    const char *mark = *whole_text;
    bool little = *length > 1 && memcmp(mark, "\xFF\xFE", 2) == 0,
         big = *length > 1 && memcmp(mark, "\xFE\xFF", 2) == 0;
    if (!little && !big)
        return SF_OK;
    iconv_t converter = iconv_open("UTF-8", little ? "UTF-16LE" : "UTF-16BE");
    size_t left = *length - 2, room = 2 * *length + 4, whole = room;
    char *from = *whole_text + 2, *text = malloc(room + 1), *to = text;
    if (!text || converter == (iconv_t)-1 || iconv(converter, &from, &left, &to, &room) == (size_t)-1) {
        SF_REFUSE(err, "the %s %s begins like UTF-16, but is not: save it as CSV UTF-8", what, path);
        free(text);
    } else {
        *length = whole - room;
        text[*length] = '\0';
        free(*whole_text);
        *whole_text = text;
    }
    if (converter != (iconv_t)-1)
        iconv_close(converter);
    return err->status;
}

/* The value of a line "KEY   :value" of an ISO-MME header; NULL if the line has another key. */
static const char *mme_value(const char *line, const char *key) {
    size_t length = strlen(key);
    const char *colon = strchr(line, ':');
    if (!colon || strncasecmp(line, key, length) != 0 ||
        strspn(line + length, " \t") != (size_t)(colon - line) - length)
        return NULL;
    return colon + 1 + strspn(colon + 1, " \t");
}

/* A channel in ISO-MME (ISO/TS 13499: a header of lines "key :value", then a sample a line) becomes a table
 * of time and channel, each sample in its own line. */
static sf_status convert_mme(const char *path, const char *what, char **text, sf_error *err) {
    char name[SF_TABLE_TITLE] = "channel", unit[SF_TABLE_UNIT] = "", *next = NULL;
    double step = NAN, first = 0, said = NAN, number;
    int64_t samples = 0;
    if (strncasecmp(*text, "Test object number", 18) != 0)
        return SF_OK;
    SF_TEXT_STREAM(table, out, size);
    if (!table)
        return SF_NO_MEMORY(err, "the %s %s", what, path);
    for (char *line = *text; line && *line; line = next) {
        const char *value;
        next = line + strcspn(line, "\r\n");
        size_t ends = next[0] == '\r' && next[1] == '\n' ? 2 : next[0] != '\0';
        *next = '\0';
        next += ends;
        line += strspn(line, " \t");
        if (strchr(line, ':')) {
            if ((value = mme_value(line, "Name of the channel")))
                snprintf(name, sizeof name, "%.60s", value);
            else if ((value = mme_value(line, "Unit")))
                snprintf(unit, sizeof unit, "%.31s", strcmp(value, "m/(s*s)") == 0 ? "m/s2" : value);
            else if ((value = mme_value(line, "Sampling interval")) && sf_table_number(value, &number))
                step = number;
            else if ((value = mme_value(line, "Time of first sample")) && sf_table_number(value, &number))
                first = number;
            else if ((value = mme_value(line, "Number of samples")) && sf_table_number(value, &number))
                said = number;
            if (!mme_value(line, "Number of samples")) {
                fputs("#\n", table);
                continue;
            }
            for (char *c = name; *c; c++) /* no separator, no bracket */
                *c = strchr(";()[]<>,/", *c) ? ' ' : *c;
            fprintf(table, "Time (s);%s (%s)\n", name, unit);
        } else if (*line) {
            fprintf(table, "%.9g;%s\n", first + (double)samples++ * step,
                    strcasecmp(line, "NOVALUE") == 0 ? "NaN" : line);
        } else {
            fputs("\n", table);
        }
    }
    bool whole = fclose(table) == 0 && out;
    free(*text);
    *text = out;
    if (!whole)
        return SF_NO_MEMORY(err, "the %s %s", what, path);
    if (!(step > 0) || !unit[0] || said != (double)samples)
        return SF_REFUSE(err,
                         "%s: its ISO-MME header gives a sampling interval of %g s, the unit \"%s\" and %g "
                         "samples; it holds %lld samples",
                         path, step, unit, said, (long long)samples);
    return SF_OK;
}

sf_status sf_table_text_read(const char *path, const char *what, char **text, sf_error *err) {
    size_t length = 0;
    SF_TRY(sf_plain_read(path, what, SF_PLAIN_TEXT, text, &length, err));
    if (convert_utf16(path, what, text, &length, err) == SF_OK && strlen(*text) < length)
        SF_REFUSE(err, "the %s %s holds zero bytes: it is not a text in UTF-8 (save it as CSV UTF-8)", what,
                  path);
    if (err->status == SF_OK)
        convert_mme(path, what, text, err);
    *text = sf_keep(*text, err);
    return err->status;
}

/* ---- lines ---- */

bool sf_table_line_is_empty(const char *line) {
    const char *text = line + strspn(line, " \t");
    return *text == '\0' || *text == '#';
}

char *sf_table_line_copy(const char **rest) {
    const char *line = *rest;
    if (!line || !*line)
        return NULL;
    size_t length = strcspn(line, "\r\n");
    *rest = line + length + (line[length] == '\r' && line[length + 1] == '\n' ? 2 : line[length] != '\0');
    return strndup(line, length);
}

char *sf_table_content_copy(const char *rest) {
    char *copy;
    while ((copy = sf_table_line_copy(&rest)) && sf_table_line_is_empty(copy))
        free(copy);
    return copy;
}

static bool is_utf8(const char *text) {
    for (int length = 1; *text && length > 0; text += length)
        if ((length = sf_utf8_length((const unsigned char *)text)) == 0)
            return false;
    return true;
}

char *sf_table_utf8_copy(const char *text) {
    if (!text || is_utf8(text))
        return text ? strdup(text) : NULL;
    char *copy = malloc(2 * strlen(text) + 1), *to = copy;
    for (const unsigned char *c = (const unsigned char *)text; copy && *c; c++) {
        if (*c >= 0x80)
            *to++ = (char)(0xC0 | *c >> 6);
        *to++ = (char)(*c < 0x80 ? *c : 0x80 | (*c & 0x3F));
    }
    if (copy)
        *to = '\0';
    return copy;
}

/* ---- numbers ---- */

bool sf_table_has_thousands(const char *text, bool quoted, char *plain, size_t size) {
    const char *digits = text + strspn(text, "+-"), *mark = strpbrk(digits, ",.");
    size_t used = (size_t)(digits - text);
    if (!mark || *digits == '0' || mark - digits < 1 || mark - digits > 3 || strlen(text) >= size)
        return false;
    char group = *mark, decimal = group == ',' ? '.' : ',';
    memcpy(plain, text, (size_t)(mark - text));
    used = (size_t)(mark - text);
    while (*mark == group) {
        if (strspn(mark + 1, "0123456789") != 3)
            return false;
        memcpy(plain + used, mark + 1, 3);
        used += 3;
        mark += 4;
    }
    bool known = *mark == decimal || (*mark == '\0' && group == ',' && quoted);
    if (!known || (*mark && mark[1 + strspn(mark + 1, "0123456789")] != '\0'))
        return false;
    snprintf(plain + used, size - used, "%s", mark);
    return true;
}
