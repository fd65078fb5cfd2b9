/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/table_csv.h"

#include "base/text.h"
#include "io/table_heading.h"
#include "io/table_text.h"
#include <ctype.h>
#include <math.h>
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
    char *end;   /* where the table ends: another one or the end of the file */
    int line;    /* number of the last one */
    int64_t row; /* rows so far, lost samples too */
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
    SF_CLEAR(table, table->value[0], table->value[1], table->line);
}

/* ---- lines ---- */

/* The next line, ended in place; NULL after the last. */
static char *next_line(csv *file) {
    char *line = file->next;
    if (!line || !*line || (file->end && line >= file->end))
        return NULL;
    char *end = line + strcspn(line, "\r\n");
    file->next = *end == '\r' && end[1] == '\n' ? end + 2 : *end ? end + 1 : end;
    *end = '\0';
    file->line++;
    return line;
}

/* The next line that is neither empty nor a comment. */
static char *next_content(csv *file) {
    char *line;
    while ((line = next_line(file)) && sf_table_line_is_empty(line))
        ;
    return line;
}

/* ---- heading ---- */

/* The separator by which numbers begin the line, one where samples are counted and two elsewhere; 0: it is no
 * line of data. */
static char data_separator(const csv *file, const char *line) {
    char found = 0;
    for (const char *s = SEPARATORS; *s && !found; s++) {
        sf_table_cells cells;
        SF_OWNED char *copy = strdup(line);
        if (!copy)
            return 0;
        sf_table_split(copy, *s, false, &cells);
        bool data = cells.count > !file->layout->counted && cells.count <= SF_TABLE_COLUMNS &&
                    sf_table_number(cells.cell[0], NULL) &&
                    (cells.count < 2 || sf_table_number(cells.cell[1], NULL));
        found = data ? *s : 0;
    }
    return found;
}

/* Reads the line as a heading of the layout, split at the separator. */
static sf_status try_heading(csv *file, const char *line, const char *below, char separator,
                             const sf_table_layout *layout, sf_table_heading *heading, sf_error *err) {
    sf_table_cells cells, below_cells = {0};
    SF_OWNED char *text = sf_table_utf8_copy(line), *under = sf_table_utf8_copy(below);
    *heading = (sf_table_heading){.place = {-1, -1}, .part = {-1, -1}};
    if (!text || (below && !under)) {
        SF_NO_MEMORY(err, "the %s %s", file->layout->what, file->path);
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
    return err->status;
}

static bool is_good(const sf_table_heading *heading) {
    return heading->found == 2 && !heading->problem[0];
}

/* The best heading that the line can be, of any layout and separator; `rest` is the text below it. */
static sf_status try_line(csv *file, const char *line, const char *rest, const sf_table_layout *layouts,
                          int count, int *which, sf_table_heading *best, char *separator, sf_error *err) {
    SF_OWNED char *below = sf_table_content_copy(rest);
    *best = (sf_table_heading){.found = -1};
    for (const char *s = SEPARATORS; *s && err->status == SF_OK; s++)
        for (int k = 0; k < count && err->status == SF_OK; k++) {
            sf_table_heading heading;
            if (*s != ',' && !strchr(line, *s) && !(*s == ' ' && strchr(line, '\t')))
                continue;
            if (try_heading(file, line, below, *s, &layouts[k], &heading, err) != SF_OK)
                break;
            if (heading.found > best->found ||
                (heading.found == best->found && is_good(&heading) && !is_good(best))) {
                *best = heading;
                *which = k;
                *separator = *s;
            }
        }
    return err->status;
}

/* Every cell is as short as a unit. */
static bool is_short(const char *line) {
    enum { UNIT = 6 };
    size_t longest = 0;
    for (; *line; line += strspn(line, ";\t,\"")) {
        size_t length = strcspn(line, ";\t,\"");
        longest = length > longest ? length : longest;
        line += length;
    }
    return longest <= UNIT;
}

static sf_status refuse_headless(const csv *file, sf_error *err) {
    const char *option = file->layout->heading_option;
    return SF_REFUSE(err,
                     "%s:%d: numbers begin here without a heading, which names the columns %s and %s and "
                     "their units: write one above them%s%s",
                     file->path, file->line, file->layout->column[0], file->layout->column[1],
                     option ? ", or give it with " : "", option ? option : "");
}

/* The first line that is a heading; a table of results may stand above it, with an empty line between. Else
 * what is wrong with the line that is most like one: the last before the data among those that hold as many
 * of the columns. */
static sf_status find_heading(csv *file, const sf_table_layout *layouts, int count, int *which,
                              sf_error *err) {
    sf_table_heading best = {.found = -1};
    int best_line = 0, lines = 0;
    bool below_data = false, any_data = false; /* the line follows on one of numbers; on any */
    char *line;
    while (lines++ < PREAMBLE && (line = next_content(file))) {
        sf_table_heading heading;
        bool data = data_separator(file, line) != 0;
        SF_TRY(try_line(file, line, file->next, layouts, count, which, &heading, &file->separator, err));
        if (is_good(&heading) && below_data)
            break;
        if (is_good(&heading) && !data) {
            file->heading = heading;
            file->layout = &layouts[*which];
            file->passed = lines > 1;
            file->separator = heading.columns == 1 ? ';' : file->separator;
            return SF_OK;
        }
        if (lines == 1 && heading.found <= 0 && (data || sf_table_number(line, NULL)))
            return refuse_headless(file, err);
        any_data = any_data || data;
        if (heading.found > best.found || (heading.found == best.found && !any_data && !is_short(line))) {
            best = heading;
            best_line = file->line;
        }
        below_data = data && file->next && !strchr("\r\n", *file->next);
    }
    return best_line ? SF_REFUSE(err, "%s:%d: %s", file->path, best_line, best.problem) : SF_OK;
}

/* The user's heading, of a file that begins with numbers after lines that are none. */
static sf_status take_heading(csv *file, const sf_table_layout *layouts, int count, int *which,
                              sf_error *err) {
    const char *text = layouts[0].heading, *option = layouts[0].heading_option, *at = file->next;
    SF_TRY(try_line(file, text, NULL, layouts, count, which, &file->heading, &file->separator, err));
    if (!is_good(&file->heading))
        return SF_REFUSE(err, "%s \"%.200s\": %s", option, text,
                         file->heading.found < 0 ? "names no columns" : file->heading.problem);
    file->layout = &layouts[*which];
    for (int lines = 0; lines < PREAMBLE; lines++) {
        const char *line = at;
        SF_OWNED char *copy = sf_table_line_copy(&at);
        sf_table_heading own;
        sf_table_cells cells;
        char separator = 0;
        int other;
        if (!copy)
            break;
        file->separator = sf_table_line_is_empty(copy) ? 0 : data_separator(file, copy);
        if (!file->separator && !sf_table_line_is_empty(copy))
            try_line(file, copy, at, layouts, count, &other, &own, &separator, err);
        if (file->separator)
            sf_table_split(copy, file->separator, false, &cells);
        if (separator && is_good(&own))
            return SF_REFUSE(err, "%s:%d: the file has a heading of its own: leave %s out", file->path,
                             file->line + 1, option);
        if (file->separator && cells.count != file->heading.columns)
            return SF_REFUSE(err, "%s:%d: %d values where %s names %d columns", file->path, file->line + 1,
                             cells.count, option, file->heading.columns);
        if (file->separator) {
            file->next = file->text + (line - file->text);
            return SF_OK;
        }
        file->line++;
    }
    return SF_REFUSE(err, "%s: no line begins with numbers", file->path);
}

/* ---- parts of a file that holds several ---- */

enum { MOST_PARTS = 64, PART_TEXT = 24, MOST_ROWS_ALONE = 8 };

/* A letter begins the line, after a quote perhaps: no number. */
static bool begins_with_letter(const char *line) {
    const char *first = line + strspn(line, " \t\"");
    return (unsigned char)*first >= 0x80 || isalpha((unsigned char)*first);
}

/* The headings below the first table. Starts the chosen table, and ends it where the next begins. */
static sf_status choose_table(csv *file, const sf_table_layout *layouts, int count, int *which,
                              sf_error *err) {
    const char *chosen = file->layout->part[SF_TABLE_SPECIMEN],
               *option = file->layout->part_option[SF_TABLE_SPECIMEN];
    double number = 0;
    int tables = 1, wanted = chosen && sf_table_number(chosen, &number) ? (int)fmin(number, 1e6) : 0;
    int line_number = file->line, second = 0, found = 0;
    bool data = false;
    const char *start = file->next;
    char *copy;
    for (const char *rest = file->next, *line = rest; (copy = sf_table_line_copy(&rest)); line = rest) {
        sf_table_heading heading = {.found = -1};
        char separator;
        line_number++;
        if (data && begins_with_letter(copy))
            try_line(file, copy, rest, layouts, count, &found, &heading, &separator, err);
        data = data ||
               (!sf_table_line_is_empty(copy) && !begins_with_letter(copy) && data_separator(file, copy));
        free(copy);
        SF_TRY(err->status);
        if (!is_good(&heading))
            continue;
        data = false;
        second = second ? second : line_number;
        if (tables == wanted || (tables == 1 && wanted == 0))
            file->end = file->text + (line - file->text);
        if (++tables == wanted) {
            file->heading = heading;
            file->separator = heading.columns == 1 ? ';' : separator;
            *which = found;
            file->layout = &layouts[found];
            file->line = line_number;
            start = rest;
        }
    }
    if (tables == 1)
        return SF_OK;
    if (!chosen)
        return SF_REFUSE(err, "%s:%d: another table begins here, the file holds %d: %s%s", file->path, second,
                         tables, option ? "choose one with " : "give each a file of its own",
                         option ? option : "");
    if (wanted < 1 || wanted > tables || number != wanted)
        return SF_REFUSE(err, "%s: specimen %s was asked for; the file holds %d tables", file->path, chosen,
                         tables);
    file->next = file->text + (start - file->text);
    file->table->part_taken[SF_TABLE_SPECIMEN] = true;
    return SF_OK;
}

/* The same text, or the same number. */
static bool is_part(const char *cell, const char *chosen) {
    double a, b;
    return strcmp(cell, chosen) == 0 || (sf_table_number(cell, &a) && sf_table_number(chosen, &b) && a == b);
}

/* The cell of column `c` is a number, or the number of its row. */
static bool holds_number(const csv *file, const sf_table_cells *cells, int c) {
    int place = file->heading.place[c];
    return place == SF_TABLE_ROW || (cells->count > place && cells->count <= SF_TABLE_COLUMNS &&
                                     sf_table_number(cells->cell[place], NULL));
}

/* Lists what the column holds, each text once, in the rows of the other chosen part; -1 if it numbers no
 * parts: numbers that are no counts, or another one in every second row, as of a logger. */
static int list_parts(const csv *file, int k, char list[MOST_PARTS][PART_TEXT]) {
    int listed = 0, rows = 0, other = !k, place = file->heading.part[k];
    const char *chosen = file->layout->part[other];
    char *copy;
    for (const char *rest = file->next;
         (!file->end || rest < file->end) && (copy = sf_table_line_copy(&rest));) {
        sf_table_cells cells;
        double number = 0;
        bool known = false;
        sf_table_split(copy, file->separator, false, &cells);
        bool use = !sf_table_line_is_empty(copy) && cells.count <= SF_TABLE_COLUMNS && cells.count > place &&
                   cells.cell[place][0] && holds_number(file, &cells, 0) && holds_number(file, &cells, 1) &&
                   (!chosen || file->heading.part[other] < 0 || cells.count <= file->heading.part[other] ||
                    is_part(cells.cell[file->heading.part[other]], chosen));
        bool count = !use || !sf_table_number(cells.cell[place], &number) || number == floor(number);
        for (int i = 0; use && i < listed; i++)
            known = known || is_part(cells.cell[place], list[i]);
        rows += use;
        if (use && !known && listed < MOST_PARTS)
            snprintf(list[listed++], PART_TEXT, "%s", cells.cell[place]);
        free(copy);
        if (!count)
            return -1;
    }
    return listed == MOST_PARTS || (rows > MOST_ROWS_ALONE && 2 * listed > rows) ? -1 : listed;
}

/* Checks the choice against the columns that number specimens and cycles. */
static sf_status choose_rows(csv *file, sf_error *err) {
    static const char *const names[SF_TABLE_PARTS] = {"specimens", "cycles"};
    char list[MOST_PARTS][PART_TEXT], line[256] = "";
    for (int k = 0; k < SF_TABLE_PARTS; k++) {
        const char *chosen = file->layout->part[k], *option = file->layout->part_option[k];
        int *place = &file->heading.part[k];
        if (*place < 0 || *place == file->heading.place[0] || *place == file->heading.place[1]) {
            *place = -1;
            continue;
        }
        int listed = list_parts(file, k, list);
        bool there = false;
        *line = '\0';
        if (listed < 0)
            *place = -1;
        for (int i = 0; i < listed; i++) {
            there = there || (chosen && is_part(list[i], chosen));
            sf_text_add(line, sizeof line, "%s%s", i ? ", " : "", list[i]);
        }
        if (listed > 1 && !chosen)
            return SF_REFUSE(err, "%s holds the %s %s: %s%s", file->path, names[k], line,
                             option ? "choose one with " : "give each a file of its own",
                             option ? option : "");
        if (listed > 0 && chosen && !there)
            return SF_REFUSE(err, "%s: %s \"%.40s\" was asked for; it holds the %s %s", file->path,
                             k == SF_TABLE_CYCLE ? "cycle" : "specimen", chosen, names[k], line);
        file->table->part_taken[k] = file->table->part_taken[k] || (listed > 0 && chosen);
    }
    return SF_OK;
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
                   ? SF_REFUSE(err,
                               "%s:%d: %s \"%s\" has a decimal point after numbers with a "
                               "decimal comma (line %d, \"%s\")",
                               file->path, file->line, name, text, file->comma_line, file->comma_text)
                   : SF_OK;
    if (file->separator == ',')
        return SF_REFUSE(err,
                         "%s:%d: %s \"%s\" holds a comma, which separates the columns here: write a decimal "
                         "point, or separate by semicolons",
                         file->path, file->line, name, text);
    if (file->point)
        return SF_REFUSE(err,
                         "%s:%d: %s \"%s\" has a comma where the file has decimal points: it could be a "
                         "decimal comma or a mark of thousands",
                         file->path, file->line, name, text);
    if (!file->comma) {
        file->comma_line = file->line;
        snprintf(file->comma_text, sizeof file->comma_text, "%.31s", text);
    }
    file->comma = true;
    file->decimal = file->decimal || is_decimal(text);
    return SF_OK;
}

static sf_status read_number(csv *file, const char *name, const char *text, double *value, sf_error *err) {
    char plain[64];
    if (sf_table_has_thousands(text, file->separator == ',' && file->point, plain, sizeof plain))
        text = plain;
    if (!sf_table_number(text, value))
        return SF_REFUSE(err, "%s:%d: %s \"%s\" is not a number%s", file->path, file->line, name, text,
                         *text ? " (expected a number such as 12.5)" : " (the cell is empty)");
    SF_TRY(check_mark(file, name, text, err));
    if (!isfinite(*value))
        return SF_REFUSE(err, "%s:%d: %s \"%s\" is not finite", file->path, file->line, name, text);
    return SF_OK;
}

static sf_status append(csv *file, const double value[2], sf_error *err) {
    sf_table *table = file->table;
    if (!sf_grow(&table->value[0], (size_t)table->count, sizeof *value) ||
        !sf_grow(&table->value[1], (size_t)table->count, sizeof *value) ||
        !sf_grow(&table->line, (size_t)table->count, sizeof *table->line))
        return SF_NO_MEMORY(err, "the %s %s", file->layout->what, file->path);
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
    return SF_REFUSE(err, "%s:%d: %d values where the header has %d columns%s", file->path, file->line, count,
                     file->heading.columns,
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
    SF_TRY(check_count(file, count_cells(file, &cells), err));
    for (int k = 0; k < SF_TABLE_PARTS; k++)
        if (file->heading.part[k] >= 0 && file->layout->part[k] && cells.count > file->heading.part[k] &&
            !is_part(cells.cell[file->heading.part[k]], file->layout->part[k]))
            return SF_OK;
    int64_t row = file->row++;
    if (file->layout->ragged && strcasecmp(cells.cell[file->heading.place[1]], "nan") == 0) {
        file->lost++;
        return SF_OK;
    }
    for (int c = 0; c < 2; c++) {
        double scale = file->heading.scale[c];
        bool counted = file->heading.place[c] == SF_TABLE_ROW;
        point.value[c] = (double)row;
        point.text[c] = counted ? "" : cells.cell[file->heading.place[c]];
        if (!counted &&
            read_number(file, file->layout->column[c], point.text[c], &point.value[c], err) != SF_OK)
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

static bool holds_point(const csv *file, char *line) {
    sf_table_cells cells;
    sf_table_split(line, file->separator, false, &cells);
    return holds_number(file, &cells, 0) && holds_number(file, &cells, 1);
}

/* A line that begins with a letter, holds no number in the first column, and after which no line holds a
 * point: results or remarks of the laboratory below the data, or the title of the next table. */
static bool ends_table(const csv *file, const char *line) {
    sf_table_cells cells;
    int c = file->heading.place[0] == SF_TABLE_ROW;
    char *copy = strdup(line);
    if (!copy)
        return false;
    sf_table_split(copy, file->separator, false, &cells);
    bool text = cells.count > 0 && begins_with_letter(line) && !holds_number(file, &cells, c);
    free(copy);
    for (const char *rest = file->next;
         text && (!file->end || rest < file->end) && (copy = sf_table_line_copy(&rest)); free(copy))
        text = !holds_point(file, copy);
    return text;
}

static void describe(const csv *file) {
    const sf_table_heading *h = &file->heading;
    const char *separator = file->separator == '\t' ? "tab" : file->separator == ' ' ? "blanks" : NULL;
    char *out = file->table->interpretation;
    size_t size = SF_TABLE_INTERPRETATION;
    if (separator)
        snprintf(out, size, "separator %s", separator);
    else
        snprintf(out, size, "separator \"%c\"", file->separator);
    sf_text_add(out, size, ", decimal %s", file->comma ? "comma" : "point");
    for (int c = 0; c < 2; c++) {
        sf_text_add(out, size, ", %s", file->layout->column[c]);
        if (h->unit[c][0])
            sf_text_add(out, size, " in %s", h->unit[c]);
        if (h->title[c][0])
            sf_text_add(out, size, " (\"%s\")", h->title[c]);
    }
}

static sf_status read_all(csv *file, const sf_table_layout *layouts, int count, int *which, sf_error *err) {
    char *line;
    SF_TRY(sf_table_text_read(file->path, file->layout->what, &file->text, err));
    file->next = file->text + (strncmp(file->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0); /* byte order mark */
    SF_TRY((layouts[0].heading ? take_heading : find_heading)(file, layouts, count, which, err));
    file->table->part_taken[SF_TABLE_SPECIMEN] = file->heading.side_by_side > 1;
    if (!layouts[0].heading && file->heading.side_by_side < 2 && file->heading.part[SF_TABLE_SPECIMEN] < 0)
        SF_TRY(choose_table(file, layouts, count, which, err));
    int heading_line = file->line;
    if (file->heading.unit_line)
        next_content(file);
    SF_TRY(choose_rows(file, err));
    for (int c = 0; c < 2; c++)
        file->table->scale[c] = file->heading.scale[c];
    while ((line = next_content(file))) {
        if (file->table->count > 0 && ends_table(file, line))
            break;
        SF_TRY(read_point(file, line, err));
    }
    int footer = line ? file->line : 0;
    if (file->comma && !file->decimal)
        return SF_REFUSE(err,
                         "%s:%d: \"%s\" and every other number with a comma could hold a decimal comma or a "
                         "mark of thousands: write decimal points",
                         file->path, file->comma_line, file->comma_text);
    const sf_table_heading *h = &file->heading;
    file->table->plain =
        file->separator == ',' && h->exact[0] && h->exact[1] && !file->passed && !h->unit_line;
    if (h->columns > 0)
        describe(file);
    char *told = file->table->interpretation;
    if (file->passed)
        sf_text_add(told, SF_TABLE_INTERPRETATION, ", heading in line %d", heading_line);
    if (footer)
        sf_text_add(told, SF_TABLE_INTERPRETATION, ", without what stands from line %d on", footer);
    if (file->lost)
        sf_text_add(told, SF_TABLE_INTERPRETATION, ", %d lost samples (NaN)", file->lost);
    return SF_OK;
}

sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err) {
    memset(table, 0, sizeof *table);
    *which = 0;
    csv file = {.path = path, .layout = layouts, .table = table, .heading = {.part = {-1, -1}}};
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
