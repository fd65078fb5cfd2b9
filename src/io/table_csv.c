/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/table_csv.h"

#include "io/plain_file.h"
#include "io/table_heading.h"
#include <ctype.h>
#include <iconv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { PREAMBLE = 200 }; /* lines among which the heading must stand */
static const char SEPARATORS[] = ";\t, ";

/* The file being read: its text, data for the messages and the growing arrays. */
typedef struct csv {
    const char *path;
    const sf_table_layout *layout;
    char *text;  /* whole file, zero-terminated; owned */
    char *next;  /* the line that follows */
    int line;    /* number of the last one */
    bool passed; /* lines without a column stand before the heading */
    char separator;
    sf_table_heading heading;
    bool point, comma; /* marks that numbers held */
    bool decimal;      /* a comma that can only be a decimal one */
    int comma_line;    /* first number with a comma */
    char comma_text[32];
    int lost;        /* rows whose value is NaN: samples that were lost */
    sf_units *units; /* NULL until needed; owned */
    sf_table *table;
} csv;

void sf_table_free(sf_table *table) {
    free(table->value[0]);
    free(table->value[1]);
    free(table->line);
    memset(table, 0, sizeof *table);
}

/* ---- lines ---- */

/* UTF-16 with a byte order mark, as spreadsheets save "Unicode text", becomes UTF-8. */
static sf_status convert_utf16(csv *file, size_t *length, sf_error *err) {
    const char *mark = file->text;
    bool little = *length > 1 && memcmp(mark, "\xFF\xFE", 2) == 0,
         big = *length > 1 && memcmp(mark, "\xFE\xFF", 2) == 0;
    if (!little && !big)
        return SF_OK;
    iconv_t converter = iconv_open("UTF-8", little ? "UTF-16LE" : "UTF-16BE");
    size_t left = *length - 2, room = 2 * *length + 4, whole = room;
    char *from = file->text + 2, *text = malloc(room + 1), *to = text;
    if (!text || converter == (iconv_t)-1 || iconv(converter, &from, &left, &to, &room) == (size_t)-1) {
        SF_FAIL(err, SF_ERR_INPUT, "the %s %s begins like UTF-16, but is not: save it as CSV UTF-8",
                file->layout->what, file->path);
        free(text);
    } else {
        *length = whole - room;
        text[*length] = '\0';
        free(file->text);
        file->text = text;
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
static sf_status convert_mme(csv *file, sf_error *err) {
    char name[SF_TABLE_TITLE] = "channel", unit[SF_TABLE_UNIT] = "", *out = NULL, *next = NULL;
    double step = NAN, first = 0, said = NAN, number;
    size_t size = 0;
    int64_t samples = 0;
    if (strncasecmp(file->text, "Test object number", 18) != 0)
        return SF_OK;
    FILE *table = open_memstream(&out, &size);
    if (!table)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what, file->path);
    for (char *line = file->text; line && *line; line = next) {
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
    free(file->text);
    file->text = out;
    if (!whole)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what, file->path);
    if (!(step > 0) || !unit[0] || said != (double)samples)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: its ISO-MME header gives a sampling interval of %g s, the unit \"%s\" and %g samples; it "
            "holds %lld samples",
            file->path, step, unit, said, (long long)samples);
    return SF_OK;
}

static sf_status load(csv *file, sf_error *err) {
    const char *what = file->layout->what;
    size_t length = 0;
    SF_TRY(sf_plain_read(file->path, what, SF_PLAIN_TEXT, &file->text, &length, err));
    SF_TRY(convert_utf16(file, &length, err));
    if (strlen(file->text) < length)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "the %s %s holds zero bytes: it is not a text in UTF-8 (save it as CSV UTF-8)", what,
                       file->path);
    SF_TRY(convert_mme(file, err));
    file->next = file->text + (strncmp(file->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0); /* byte order mark */
    return SF_OK;
}

/* The next line, ended in place; NULL after the last. */
static char *next_line(csv *file) {
    char *line = file->next;
    if (!line || !*line)
        return NULL;
    char *end = line + strcspn(line, "\r\n");
    file->next = *end == '\r' && end[1] == '\n' ? end + 2 : *end ? end + 1 : end;
    *end = '\0';
    file->line++;
    return line;
}

static bool is_empty(const char *line) {
    const char *text = line + strspn(line, " \t");
    return *text == '\0' || *text == '#';
}

/* The next line that is neither empty nor a comment. */
static char *next_content(csv *file) {
    char *line;
    while ((line = next_line(file)) && is_empty(line))
        ;
    return line;
}

/* A copy of the next such line, which stays. */
static char *peek_content(const csv *file) {
    for (const char *line = file->next; line && *line;) {
        size_t length = strcspn(line, "\r\n");
        char *copy = strndup(line, length);
        if (!copy || !is_empty(copy))
            return copy;
        free(copy);
        line += length + (line[length] != '\0');
    }
    return NULL;
}

/* ---- heading ---- */

static bool is_utf8(const char *text) {
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        int more = *c < 0x80                 ? 0
                   : *c >= 0xC2 && *c < 0xE0 ? 1
                   : *c >= 0xE0 && *c < 0xF0 ? 2
                   : *c >= 0xF0 && *c < 0xF5 ? 3
                                             : -1;
        if (more < 0)
            return false;
        for (c++; more > 0; more--, c++)
            if ((*c & 0xC0) != 0x80)
                return false;
    }
    return true;
}

/* A copy in UTF-8: what is not is taken for Latin-1. NULL of NULL, and without memory. */
static char *copy_utf8(const char *text) {
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

/* Two numbers begin the line: data. */
static bool is_data(const char *line) {
    bool data = false;
    for (const char *s = SEPARATORS; *s && !data; s++) {
        sf_table_cells cells;
        double number;
        char *copy = strdup(line);
        if (!copy)
            return false;
        sf_table_split(copy, *s, false, &cells);
        data = cells.count > 1 && cells.count <= SF_TABLE_COLUMNS &&
               sf_table_number(cells.cell[0], &number) && sf_table_number(cells.cell[1], &number);
        free(copy);
    }
    return data;
}

/* Reads the line as a heading of the layout, split at the separator. */
static sf_status try_heading(csv *file, const char *line, const char *below, char separator,
                             const sf_table_layout *layout, sf_table_heading *heading, sf_error *err) {
    sf_table_cells cells, below_cells = {0};
    char *text = copy_utf8(line), *under = copy_utf8(below);
    *heading = (sf_table_heading){.place = {-1, -1}};
    if (!text || (below && !under)) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what, file->path);
    } else {
        sf_table_split(text, separator, true, &cells);
        if (under)
            sf_table_split(under, separator, false, &below_cells);
        if (cells.count > SF_TABLE_COLUMNS)
            snprintf(heading->problem, sizeof heading->problem, "more than %d columns", SF_TABLE_COLUMNS);
        else
            sf_table_heading_read(layout, &cells, below_cells.count <= SF_TABLE_COLUMNS ? &below_cells : NULL,
                                  &file->units, heading, err);
    }
    free(text);
    free(under);
    return err->status;
}

/* The best heading that the line can be, of any layout and separator. */
static sf_status try_line(csv *file, const char *line, const sf_table_layout *layouts, int count, int *which,
                          sf_table_heading *best, char *separator, sf_error *err) {
    char *below = peek_content(file);
    *best = (sf_table_heading){.found = -1};
    for (const char *s = SEPARATORS; *s && err->status == SF_OK; s++)
        for (int k = 0; k < count && err->status == SF_OK; k++) {
            sf_table_heading heading;
            if (*s != ',' && !strchr(line, *s) && !(*s == ' ' && strchr(line, '\t')))
                continue;
            if (try_heading(file, line, below, *s, &layouts[k], &heading, err) != SF_OK)
                break;
            bool good = heading.found == 2 && !heading.problem[0];
            bool best_good = best->found == 2 && !best->problem[0];
            if (heading.found > best->found || (heading.found == best->found && good && !best_good)) {
                *best = heading;
                *which = k;
                *separator = *s;
            }
        }
    free(below);
    return err->status;
}

/* The first line that is a heading; a table of results may stand above it, with an empty line between. Else
 * what is wrong with the line that is most like one. */
static sf_status find_heading(csv *file, const sf_table_layout *layouts, int count, int *which,
                              sf_error *err) {
    sf_table_heading best = {.found = -1};
    int best_line = 0, lines = 0;
    bool below_data = false; /* the line follows on one of numbers */
    char *line;
    while (lines++ < PREAMBLE && (line = next_content(file))) {
        sf_table_heading heading;
        if (try_line(file, line, layouts, count, which, &heading, &file->separator, err) != SF_OK)
            return err->status;
        if (heading.found == 2 && !heading.problem[0] && below_data)
            break;
        if (heading.found == 2 && !heading.problem[0]) {
            file->heading = heading;
            file->layout = &layouts[*which];
            file->passed = lines > 1;
            return SF_OK;
        }
        if (heading.found > best.found) {
            best = heading;
            best_line = file->line;
        }
        below_data = is_data(line) && file->next && !strchr("\r\n", *file->next);
    }
    return best_line ? SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s", file->path, best_line, best.problem) : SF_OK;
}

/* ---- numbers and rows ---- */

/* A comma with other than three digits after it, or none but zeros before it, is no mark of thousands. */
static bool is_decimal(const char *text) {
    const char *comma = strchr(text, ','), *first = text + strspn(text, "+-");
    return first == comma || *first == '0' || strspn(comma + 1, "0123456789") != 3 || comma - first > 3;
}

/* Takes the mark of the number, a decimal point or a comma, into account. */
static sf_status check_mark(csv *file, const char *name, const char *text, sf_error *err) {
    file->point = file->point || strchr(text, '.');
    if (!strchr(text, ','))
        return file->point && file->comma
                   ? SF_FAIL(err, SF_ERR_INPUT,
                             "%s:%d: %s \"%s\" has a decimal point after numbers with a "
                             "decimal comma (line %d, \"%s\")",
                             file->path, file->line, name, text, file->comma_line, file->comma_text)
                   : SF_OK;
    if (file->separator == ',')
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%d: %s \"%s\" holds a comma, which separates the columns here: write a decimal point, "
            "or separate by semicolons",
            file->path, file->line, name, text);
    if (file->point)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%d: %s \"%s\" has a comma where the file has decimal points: it could be a decimal "
            "comma or a mark of thousands",
            file->path, file->line, name, text);
    if (!file->comma) {
        file->comma_line = file->line;
        snprintf(file->comma_text, sizeof file->comma_text, "%.31s", text);
    }
    file->comma = true;
    file->decimal = file->decimal || is_decimal(text);
    return SF_OK;
}

/* "1,017.76" or "1.017,76": groups of three digits and another decimal mark. In a file with decimal points
 * whose commas separate columns, a quoted "1,017" is of thousands too. Writes the number without the groups.
 */
static bool has_thousands(const csv *file, const char *text, char *plain, size_t size) {
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
    bool known = *mark == decimal || (*mark == '\0' && group == ',' && file->separator == ',' && file->point);
    if (!known || (*mark && mark[1 + strspn(mark + 1, "0123456789")] != '\0'))
        return false;
    snprintf(plain + used, size - used, "%s", mark);
    return true;
}

static sf_status read_number(csv *file, const char *name, const char *text, double *value, sf_error *err) {
    char plain[64];
    if (has_thousands(file, text, plain, sizeof plain))
        text = plain;
    if (!sf_table_number(text, value))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s \"%s\" is not a number", file->path, file->line, name,
                       text);
    if (check_mark(file, name, text, err) != SF_OK)
        return err->status;
    if (!isfinite(*value))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s \"%s\" is not finite", file->path, file->line, name,
                       text);
    return SF_OK;
}

static sf_status append(csv *file, const double value[2], sf_error *err) {
    sf_table *table = file->table;
    if (table->count == table->capacity) {
        int64_t capacity = table->capacity ? 2 * table->capacity : 64;
        for (int c = 0; c < 2; c++) {
            double *grown = realloc(table->value[c], (size_t)capacity * sizeof *grown);
            if (!grown)
                return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what,
                               file->path);
            table->value[c] = grown;
        }
        int *lines = realloc(table->line, (size_t)capacity * sizeof *lines);
        if (!lines)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what, file->path);
        table->line = lines;
        table->capacity = capacity;
    }
    for (int c = 0; c < 2; c++)
        table->value[c][table->count] = value[c];
    table->line[table->count] = file->line;
    table->count++;
    return SF_OK;
}

/* Empty cells at the end of a row do not count beyond the heading. */
static int count_cells(const csv *file, const sf_table_cells *cells) {
    int count = cells->count <= SF_TABLE_COLUMNS ? cells->count : SF_TABLE_COLUMNS + 1;
    while (count > file->heading.columns && count <= SF_TABLE_COLUMNS && !cells->cell[count - 1][0])
        count--;
    return count;
}

static bool is_blank_row(const sf_table_cells *cells) {
    for (int i = 0; i < cells->count && i < SF_TABLE_COLUMNS; i++)
        if (cells->cell[i][0])
            return false;
    return cells->count > 1;
}

static sf_status check_count(const csv *file, int count, sf_error *err) {
    const int *place = file->heading.place;
    int needed = place[0] > place[1] ? place[0] : place[1];
    if (count == file->heading.columns ||
        (file->layout->ragged && count > needed && count < file->heading.columns))
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %d values where the header has %d columns%s", file->path,
                   file->line, count, file->heading.columns,
                   file->separator == ',' && count > file->heading.columns
                       ? " (with decimal commas, separate the columns by semicolons)"
                       : "");
}

static sf_status read_point(csv *file, char *line, sf_error *err) {
    sf_table_cells cells;
    const sf_table *table = file->table;
    sf_table_point point = {.path = file->path, .line = file->line, .index = table->count};
    sf_table_split(line, file->separator, false, &cells);
    if (is_blank_row(&cells))
        return SF_OK;
    if (check_count(file, count_cells(file, &cells), err) != SF_OK)
        return err->status;
    if (file->layout->ragged && strcasecmp(cells.cell[file->heading.place[1]], "nan") == 0) {
        file->lost++;
        return SF_OK;
    }
    for (int c = 0; c < 2; c++) {
        double scale = file->heading.scale[c];
        point.text[c] = cells.cell[file->heading.place[c]];
        if (read_number(file, file->layout->column[c], point.text[c], &point.value[c], err) != SF_OK)
            return err->status;
        point.value[c] *= scale;
        if (table->count == 0)
            continue;
        point.before[c] = table->value[c][table->count - 1];
        point.last[c] = point.before[c] / scale;
    }
    if (file->layout->check && file->layout->check(&point, err) != SF_OK)
        return err->status;
    return append(file, point.value, err);
}

/* ---- the whole ---- */

static bool holds_point(const csv *file, const char *line) {
    sf_table_cells cells;
    double number;
    const int *place = file->heading.place;
    char *copy = strdup(line);
    if (!copy)
        return true;
    sf_table_split(copy, file->separator, false, &cells);
    bool point = cells.count > place[0] && cells.count > place[1] && cells.count <= SF_TABLE_COLUMNS &&
                 sf_table_number(cells.cell[place[0]], &number) &&
                 sf_table_number(cells.cell[place[1]], &number);
    free(copy);
    return point;
}

/* A line that begins with a letter, holds no number in the first column, and after which no line holds a
 * point: results or remarks of the laboratory below the data. */
static bool ends_table(const csv *file, const char *line) {
    sf_table_cells cells;
    double number;
    char *copy = strdup(line);
    if (!copy)
        return false;
    sf_table_split(copy, file->separator, false, &cells);
    int place = file->heading.place[0];
    bool text = cells.count > 0 && cells.count <= SF_TABLE_COLUMNS &&
                ((unsigned char)cells.cell[0][0] >= 0x80 || isalpha((unsigned char)cells.cell[0][0])) &&
                (cells.count <= place || !sf_table_number(cells.cell[place], &number));
    free(copy);
    for (char *rest = file->next; text && rest && *rest;) {
        size_t length = strcspn(rest, "\r\n");
        char *after = strndup(rest, length);
        text = after && !holds_point(file, after);
        free(after);
        rest += length + (rest[length] != '\0');
    }
    return text;
}

static void describe(const csv *file) {
    const sf_table_heading *h = &file->heading;
    const char *separator = file->separator == '\t' ? "tab" : file->separator == ' ' ? "blanks" : NULL;
    char *out = file->table->interpretation;
    size_t size = SF_TABLE_INTERPRETATION;
    int used = separator ? snprintf(out, size, "separator %s", separator)
                         : snprintf(out, size, "separator \"%c\"", file->separator);
    used += snprintf(out + used, size - (size_t)used, ", decimal %s", file->comma ? "comma" : "point");
    for (int c = 0; c < 2; c++) {
        used += snprintf(out + used, size - (size_t)used, ", %s", file->layout->column[c]);
        if (h->unit[c][0])
            used += snprintf(out + used, size - (size_t)used, " in %s", h->unit[c]);
        if (h->title[c][0])
            used += snprintf(out + used, size - (size_t)used, " (\"%s\")", h->title[c]);
    }
}

static sf_status read_all(csv *file, const sf_table_layout *layouts, int count, int *which, sf_error *err) {
    char *line;
    if (load(file, err) != SF_OK || find_heading(file, layouts, count, which, err) != SF_OK)
        return err->status;
    int heading_line = file->line;
    if (file->heading.unit_line)
        next_content(file);
    for (int c = 0; c < 2; c++)
        file->table->scale[c] = file->heading.scale[c];
    while ((line = next_content(file))) {
        if (file->table->count > 0 && ends_table(file, line))
            break;
        if (read_point(file, line, err) != SF_OK)
            return err->status;
    }
    int footer = line ? file->line : 0;
    if (file->comma && !file->decimal)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%d: \"%s\" and every other number with a comma could hold a decimal comma or a mark of "
            "thousands: write decimal points",
            file->path, file->comma_line, file->comma_text);
    const sf_table_heading *h = &file->heading;
    file->table->plain =
        file->separator == ',' && h->exact[0] && h->exact[1] && !file->passed && !h->unit_line;
    if (h->columns > 0)
        describe(file);
    size_t used = strlen(file->table->interpretation);
    if (file->passed)
        used += (size_t)snprintf(file->table->interpretation + used, SF_TABLE_INTERPRETATION - used,
                                 ", heading in line %d", heading_line);
    if (footer && used < SF_TABLE_INTERPRETATION)
        used += (size_t)snprintf(file->table->interpretation + used, SF_TABLE_INTERPRETATION - used,
                                 ", without what stands from line %d on", footer);
    if (file->lost && used < SF_TABLE_INTERPRETATION)
        snprintf(file->table->interpretation + used, SF_TABLE_INTERPRETATION - used,
                 ", %d lost samples (NaN)", file->lost);
    return SF_OK;
}

sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err) {
    memset(table, 0, sizeof *table);
    *which = 0;
    csv file = {.path = path, .layout = layouts, .table = table};
    sf_status status = read_all(&file, layouts, count, which, err);
    sf_units_close(&file.units);
    free(file.text);
    if (status != SF_OK)
        sf_table_free(table);
    return status;
}

sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err) {
    int which;
    return sf_table_read_any(path, layout, 1, &which, table, err);
}
