/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/table_heading.h"

#include "base/text.h"
#include "io/plain_file.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* ---- cells ---- */

static bool is_blank(char c) {
    return isspace((unsigned char)c) != 0;
}

/* The cell's text without blanks and quotes at its ends. */
static char *trim(char *text) {
    while (is_blank(*text) || *text == '"')
        text++;
    for (char *end = text + strlen(text); end > text && (is_blank(end[-1]) || end[-1] == '"');)
        *--end = '\0';
    return text;
}

/* The separator that ends the cell at `text`, or NULL at the line's end. Those in quotes do not count. */
static char *cell_end(char *text, char separator) {
    char *first = text;
    while (is_blank(*first) && *first != separator)
        first++;
    if (*first == '"') {
        char *close = strchr(first + 1, '"');
        while (close && close[1] == '"')
            close = strchr(close + 2, '"');
        if (close)
            text = close;
    }
    return strchr(text, separator);
}

/* Joins "Time" and "(ms)" again, and "t / ms". */
static void join_units(sf_table_cells *cells, char *const *end_of) {
    int count = 0;
    for (int i = 0; i < cells->count; i++) {
        if (i > 0 && (strchr("([/", cells->cell[i][0]) || end_of[i - 1][-1] == '/')) {
            *end_of[i - 1] = ' ';
            continue;
        }
        cells->cell[count++] = cells->cell[i];
    }
    cells->count = count;
}

static void split_blanks(char *line, bool heading, sf_table_cells *cells) {
    char *end_of[SF_TABLE_COLUMNS];
    cells->count = 0;
    for (char *text = line; *(text += strspn(text, " \t")) != '\0'; cells->count++) {
        if (cells->count == SF_TABLE_COLUMNS) {
            cells->count++;
            return;
        }
        char *end = text + strcspn(text, " \t");
        cells->cell[cells->count] = text;
        end_of[cells->count] = end;
        text = *end ? end + 1 : end;
        *end = '\0';
    }
    if (heading)
        join_units(cells, end_of);
    for (int i = 0; i < cells->count; i++)
        cells->cell[i] = trim(cells->cell[i]);
}

void sf_table_split(char *line, char separator, bool heading, sf_table_cells *cells) {
    cells->count = 0;
    if (separator == ' ') {
        split_blanks(line, heading, cells);
        return;
    }
    for (char *rest = line; rest; cells->count++) {
        if (cells->count == SF_TABLE_COLUMNS) {
            cells->count++;
            return;
        }
        char *text = rest;
        rest = cell_end(rest, separator);
        if (rest)
            *rest++ = '\0';
        cells->cell[cells->count] = trim(text);
    }
}

bool sf_table_number(const char *cell, double *value) {
    char copy[64];
    size_t length = strlen(cell);
    if (length >= sizeof copy)
        return false;
    memcpy(copy, cell, length + 1);
    for (char *c = copy; (c = strchr(c, ','));)
        *c = '.';
    const char *end = sf_decimal_read(copy, value);
    return end && *end == '\0';
}

/* ---- units ---- */

typedef struct reading {
    const sf_table_layout *layout;
    const sf_table_cells *cells;
    const sf_table_cells *below; /* NULL unless that line may hold units */
    sf_units **units;
    sf_table_heading *heading;
    sf_error *err;
} reading;

/* SI value of one unit; 0 if the text is no unit of the kind. */
static double unit_value(const reading *r, const char *text, int kind) {
    double value = 0;
    if (!*text || strlen(text) >= SF_TABLE_UNIT)
        return 0;
    if (kind == SF_TABLE_RATIO)
        return sf_word_find("%|percent|pct", text) >= 0 ? 0.01 : sf_word_find("1|-|mm/mm|m/m", text) >= 0;
    if (kind == SF_ACCELERATION && sf_word_find("g|G|gn|g0|g_n", text) >= 0)
        return SF_STANDARD_GRAVITY;
    if (!*r->units && sf_units_open(r->units, r->err) != SF_OK)
        return 0;
    SF_PRINTED(quantity, SF_TABLE_UNIT + 8, "1 %s", text);
    return sf_units_parse(*r->units, quantity, (sf_quantity)kind, &value, SF_IGNORED) == SF_OK ? value : 0;
}

/* The text without brackets around it. */
static void strip_brackets(const char *text, char *out, size_t size) {
    size_t length = strlen(text);
    bool both = length >= 2 &&
                ((text[0] == '(' && text[length - 1] == ')') || (text[0] == '[' && text[length - 1] == ']') ||
                 (text[0] == '<' && text[length - 1] == '>'));
    snprintf(out, size, "%.*s", (int)(length - (both ? 2 : 0)), text + both);
    char *first = trim(out);
    memmove(out, first, strlen(first) + 1);
}

/* A heading in parts. */
typedef struct title {
    char name[SF_TABLE_TITLE];
    char unit[SF_TABLE_TITLE]; /* as written; empty: none */
} title;

/* Cuts the name at `at` and takes the text from `after` on as its unit. */
static bool cut(title *t, char *at, const char *after) {
    SF_PRINTED(unit, SF_TABLE_TITLE, "%s", after);
    *at = '\0';
    strip_brackets(unit, t->unit, sizeof t->unit);
    char *name = trim(t->name);
    memmove(t->name, name, strlen(name) + 1);
    return true;
}

/* "Time (ms)", "Time [ms]", "t / ms", "Time, ms", "Time in ms". */
static bool take_written_unit(title *t) {
    size_t length = strlen(t->name);
    char *at = NULL;
    if (length > 1 && strchr(")]>", t->name[length - 1]))
        at = strrchr(t->name, t->name[length - 1] == ')' ? '(' : t->name[length - 1] == ']' ? '[' : '<');
    if (at && at > t->name && at[-1] == '/') /* a/(m/s2) */
        return cut(t, at - 1, at);
    if (at && at > t->name)
        return cut(t, at, at);
    if ((at = strchr(t->name, '/')))
        return cut(t, at, at + 1);
    if ((at = strrchr(t->name, ',')))
        return cut(t, at, at + 1);
    if ((at = strstr(t->name, " in ")))
        return cut(t, at, at + 4);
    return false;
}

/* "acc_m_s2": what follows an underscore, its next one read as "/", if that is a unit of the kind. */
static void take_suffix(const reading *r, int kind, title *t) {
    for (char *at = strchr(t->name, '_'); at; at = strchr(at + 1, '_')) {
        SF_PRINTED(unit, SF_TABLE_TITLE, "%s", at + 1);
        char *slash = strchr(unit, '_');
        if (slash)
            *slash = '/';
        if (unit_value(r, unit, kind) > 0) {
            snprintf(t->unit, sizeof t->unit, "%s", unit);
            *at = '\0';
            return;
        }
    }
}

static title read_title(const reading *r, int i, int kind) {
    title t = {.unit = ""};
    if (snprintf(t.name, sizeof t.name, "%s", r->cells->cell[i]) >= (int)sizeof t.name)
        return (title){.unit = ""}; /* a heading of this length is prose */
    const title whole = t;
    if (take_written_unit(
            &t)) { /* "Compressive strain (Displacement)" over "(%)": the line below has the unit */
        char under[SF_TABLE_TITLE] = "";
        if (r->below && i < r->below->count)
            strip_brackets(r->below->cell[i], under, sizeof under);
        if (unit_value(r, t.unit, kind) > 0 || !(unit_value(r, under, kind) > 0))
            return t;
        t = whole;
    }
    if (r->below && i < r->below->count)
        strip_brackets(r->below->cell[i], t.unit, sizeof t.unit);
    if (!t.unit[0])
        take_suffix(r, kind, &t);
    return t;
}

/* ---- columns ---- */

static bool is_word_byte(char c) {
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* True if the list "time|t|*zeit" has the word of `length` bytes. */
static bool is_listed(const char *word, size_t length, const char *list) {
    while (*list) {
        size_t size = strcspn(list, "|");
        bool ends = *list == '*';
        size_t bytes = size - ends;
        if ((ends ? length >= bytes : length == bytes) &&
            strncasecmp(word + length - bytes, list + ends, bytes) == 0)
            return true;
        list += size + (list[size] == '|');
    }
    return false;
}

static bool holds_word(const char *name, const char *list) {
    while (*name) {
        size_t length = 0;
        while (is_word_byte(name[length]))
            length++;
        if (length > 0 && is_listed(name, length, list))
            return true;
        name += length > 0 ? length : 1;
    }
    return false;
}

/* True if the user has chosen this cell, by its whole text or by its name without the unit. */
static bool is_chosen(const reading *r, int c, int i) {
    const char *chosen = r->layout->chosen[c];
    title t = {.unit = ""};
    snprintf(t.name, sizeof t.name, "%s", r->cells->cell[i]);
    take_written_unit(&t);
    return strcmp(r->cells->cell[i], chosen) == 0 || strcmp(t.name, chosen) == 0;
}

static bool is_allowed(const reading *r, int c, int i) {
    return !r->layout->chosen[c] || is_chosen(r, c, i);
}

static void take(const reading *r, int c, int i, double scale, const char *unit) {
    r->heading->place[c] = i;
    r->heading->scale[c] = scale;
    snprintf(r->heading->unit[c], sizeof r->heading->unit[c], "%.31s", unit ? unit : "");
}

static void complain(const reading *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void complain(const reading *r, const char *format, ...) {
    if (r->heading->problem[0])
        return;
    SF_PRINT_INTO(r->heading->problem, format);
}

/* The cell `i` fits the column as well as `*count` others do: takes it if it is the only one, or that of the
 * chosen specimen. True if it is taken. */
static bool is_next(const reading *r, int c, int i, int *count) {
    const char *specimen = r->layout->part[SF_TABLE_SPECIMEN];
    double number = 0;
    ++*count;
    if (specimen && sf_table_number(specimen, &number)) {
        if (*count > r->heading->side_by_side)
            r->heading->side_by_side = *count;
        return *count == 1 || *count == number;
    }
    if (*count == 1)
        return true;
    const char *choice = r->layout->choice, *option = r->layout->part_option[SF_TABLE_SPECIMEN];
    complain(r, "two %s columns (\"%.80s\" and \"%.80s\")%s%s%s%s", r->layout->column[c],
             r->cells->cell[r->heading->place[c]], r->cells->cell[i], choice ? ": name one with " : "",
             choice ? choice : "", option ? ": choose a specimen with " : "", option ? option : "");
    return false;
}

/* A heading that is one of the exact names. A line of units below it must agree. */
static bool find_exact(const reading *r, int c) {
    int count = 0;
    for (int i = 0; i < r->cells->count; i++)
        for (int k = 0; k < r->layout->name_count; k++) {
            const sf_table_name *name = &r->layout->names[k];
            if (name->column != c || strcmp(r->cells->cell[i], name->name) != 0 || !is_allowed(r, c, i) ||
                !is_next(r, c, i, &count))
                continue;
            r->heading->exact[c] = true;
            take(r, c, i, name->scale, name->unit);
        }
    return count > 0;
}

static double scale_of(const reading *r, int c, const char *unit) {
    double own = r->layout->unit[c] > 0 ? r->layout->unit[c] : 1;
    return unit_value(r, unit, r->layout->kind[c]) / own;
}

/* True of a heading of another quantity of the same kind: "True stress (MPa)". */
static bool means_other(const reading *r, int c, int i) {
    return r->layout->unfit[c] && holds_word(r->cells->cell[i], r->layout->unfit[c]);
}

/* Takes the only cell that fits: by a word (or the user's choice) and a unit of the kind, or by such a unit
 * alone. False if there is none. */
static bool find_by_unit(const reading *r, int c, bool by_word) {
    int count = 0, kind = r->layout->kind[c];
    for (int i = 0; i < r->cells->count; i++) {
        title t = read_title(r, i, by_word ? kind : SF_TABLE_RATIO);
        bool named = r->layout->chosen[c] ? is_chosen(r, c, i) : holds_word(t.name, r->layout->words[c]);
        double scale = named || !by_word ? scale_of(r, c, t.unit) : 0;
        if ((by_word && !named) || !(scale > 0) || !is_allowed(r, c, i) || means_other(r, c, i) ||
            !is_next(r, c, i, &count))
            continue;
        take(r, c, i, scale, t.unit);
        if (!by_word || r->layout->chosen[c])
            snprintf(r->heading->title[c], sizeof r->heading->title[c], "%s", r->cells->cell[i]);
    }
    return count > 0;
}

/* A column with the word but without a unit of the kind. */
static bool find_unfit(const reading *r, int c) {
    int kind = r->layout->kind[c];
    for (int i = 0; i < r->cells->count; i++) {
        title t = read_title(r, i, kind);
        const char *cell = r->cells->cell[i];
        if (r->layout->chosen[c] ? !is_chosen(r, c, i) : !holds_word(t.name, r->layout->words[c]))
            continue;
        if (means_other(r, c, i))
            complain(r, "\"%.80s\" %s", cell, r->layout->unfit_why);
        else if (t.unit[0])
            complain(r, "the header has no column %s: \"%s\" is in \"%s\", which is not a unit of %s",
                     r->layout->wanted[c], cell, t.unit,
                     kind == SF_TABLE_RATIO ? "a strain (% or 1)" : sf_quantity_phrase((sf_quantity)kind));
        else
            complain(
                r,
                "the header has no column %s: \"%s\" names no unit (write \"%s (%s)\", or the unit in the "
                "next line)",
                r->layout->wanted[c], cell, cell,
                kind == SF_TABLE_RATIO ? "%" : sf_quantity_unit((sf_quantity)kind));
        return true;
    }
    return false;
}

/* True if the cell consists of words of the list, at least one of them, and of words that mean a number. */
static bool is_numbering(const char *cell, const char *list) {
    bool any = false;
    for (; *cell; cell++) {
        size_t length = 0;
        while (is_word_byte(cell[length]))
            length++;
        bool listed = length > 0 && is_listed(cell, length, list);
        if (length > 0 && !listed &&
            !is_listed(cell, length, "no|nr|number|id|index|count|total|elapsed|name"))
            return false;
        any = any || listed;
        cell += length;
        if (!*cell)
            break;
    }
    return any;
}

static int find_numbering(const reading *r, const char *list) {
    for (int i = 0; i < r->cells->count; i++)
        if (is_numbering(r->cells->cell[i], list))
            return i;
    return -1;
}

/* The number of the sample: a column of that name, or the row. */
static void find_count(const reading *r) {
    int place = find_numbering(r, "sample|samples|point|points|scan|n|i|index|messpunkt|punkt");
    take(r, 0, place < 0 ? SF_TABLE_ROW : place, r->layout->unit[0], NULL);
    r->heading->found++;
}

static void find_parts(const reading *r) {
    static const char *const words[SF_TABLE_PARTS] = {
        "specimen|specimens|probe|probekörper|prüfkörper|éprouvette|probeta|provino",
        "cycle|cycles|zyklus|ciclo"};
    for (int k = 0; k < SF_TABLE_PARTS; k++)
        r->heading->part[k] = find_numbering(r, words[k]);
}

static void find_column(const reading *r, int c) {
    r->heading->place[c] = -1;
    if (c == 0 && r->layout->counted) {
        find_count(r);
        return;
    }
    if (find_exact(r, c)) {
        r->heading->found++;
        return;
    }
    if (!r->layout->words[c])
        return;
    r->heading->found += find_by_unit(r, c, true) || find_unfit(r, c) ||
                         (r->layout->kind[c] != SF_TABLE_RATIO && find_by_unit(r, c, false));
}

/* A line without a number that has as many cells as the heading at most: units, if they are. */
static bool may_hold_units(const sf_table_cells *cells, const sf_table_cells *below) {
    bool any = false;
    for (int i = 0; below && i < below->count; i++) {
        any = any || below->cell[i][0];
        if (sf_table_number(below->cell[i], NULL))
            return false;
    }
    return any && below->count <= cells->count;
}

/* Checks the cells below both columns if they hold units: those must be the units of the heading. */
static void check_below(const reading *r, const sf_table_cells *below) {
    sf_table_heading *h = r->heading;
    for (int c = 0; c < 2; c++) {
        char unit[SF_TABLE_TITLE] = "";
        if (h->place[c] >= below->count)
            return;
        if (h->place[c] == SF_TABLE_ROW || (c == 0 && r->layout->counted))
            continue;
        strip_brackets(below->cell[h->place[c]], unit, sizeof unit);
        double scale = r->layout->words[c] ? scale_of(r, c, unit) : 0;
        if (!(scale > 0) && !(r->layout->kind[c] == SF_TABLE_RATIO && !unit[0]))
            return;
        if (scale > 0 && fabs(scale - h->scale[c]) > 1e-9 * scale)
            complain(r, "the heading \"%.80s\" and the line below it (\"%.40s\") give different units",
                     r->cells->cell[h->place[c]], unit);
    }
    h->unit_line = true;
}

sf_status sf_table_heading_read(const sf_table_layout *layout, const sf_table_cells *cells,
                                const sf_table_cells *below, sf_units **units, sf_table_heading *heading,
                                sf_error *err) {
    *heading = (sf_table_heading){.columns = cells->count, .part = {-1, -1}};
    const reading r = {layout, cells, may_hold_units(cells, below) ? below : NULL, units, heading, err};
    while (heading->columns > 0 && !cells->cell[heading->columns - 1][0])
        heading->columns--;
    for (int c = 0; c < 2; c++)
        find_column(&r, c);
    find_parts(&r);
    double specimen = 0;
    if (heading->side_by_side > 1 && sf_table_number(layout->part[SF_TABLE_SPECIMEN], &specimen) &&
        (specimen != floor(specimen) || specimen > heading->side_by_side || specimen < 1))
        complain(&r, "specimen %s was asked for; the heading has columns of %d",
                 layout->part[SF_TABLE_SPECIMEN], heading->side_by_side);
    if (heading->found == 2 && !heading->problem[0] && heading->place[0] == heading->place[1])
        heading->found = 1;
    for (int c = 0; c < 2 && heading->found < 2 && !heading->problem[0]; c++)
        if (heading->place[c] < 0)
            complain(&r, "the header has no column %s", layout->wanted[c]);
    if (heading->found == 2 && !heading->problem[0] && r.below)
        check_below(&r, r.below);
    return err->status;
}
