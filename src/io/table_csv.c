/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/table_csv.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "io/plain_file.h"
#include "io/provenance.h"

enum { COLUMNS = 256, TITLE = 96, UNIT = 32, SHOWN = 160, READING_SHOWN = 480 };
static const char READING[] = "# softfall read ";
#define OTHER_FORMS ": %s reads other forms, or says why not"

const sf_table_column
    sf_column_time = {"time", "time|t", SF_TIME, 1, "time_ms"},
    sf_column_acceleration =
        {"acceleration",
         "acceleration|deceleration|a|acceleration_cfc1000|acceleration_cfc600|acceleration_cfc180|acceleration_cfc60",
         SF_ACCELERATION, SF_STANDARD_GRAVITY, "acceleration_g"},
    sf_column_strain = {"strain", "strain", SF_TABLE_RATIO, 1, "strain"},
    sf_column_stress = {"stress", "stress", SF_PRESSURE, 1, "stress_kPa"},
    sf_column_lateral_strain = {"lateral strain",
                                "lateral strain|lateral_strain|transverse strain|transverse_strain",
                                SF_TABLE_RATIO, 1, "lateral_strain"},
    sf_column_displacement = {"displacement", "displacement", SF_LENGTH, 1, "displacement_mm"},
    sf_column_force = {"force", "force", SF_FORCE, 1, "force_N"},
    sf_column_height = {"height", "height|h|h_m", SF_LENGTH, 1, "height_m"},
    sf_column_speed = {"speed", "speed|v|v_test", SF_SPEED, 1, "speed_m_s"},
    sf_column_static_stress = {"static stress", "static stress|static_stress", SF_PRESSURE, 1,
                               "static_stress_kPa"},
    sf_column_peak = {"peak deceleration", "peak|peak deceleration", SF_ACCELERATION, SF_STANDARD_GRAVITY,
                      "peak_g"};

/* The file being read. */
typedef struct csv {
    const char *path;
    const sf_table_layout *layout;
    char *next; /* the line that follows, in the text */
    int line;   /* number of the last one */
    char *cell[COLUMNS];
    int cells;
    int columns;  /* of the heading */
    int place[2]; /* of the two columns */
    char unit[2][UNIT];
    const char *reading; /* what softfall read said; NULL: nothing */
    const char *title;   /* comment above the heading that gives the curve another meaning; NULL: none */
    int title_line;
    const char *remedy; /* command that reads other forms */
    sf_units *units;    /* owned */
    sf_table *table;
} csv;

void sf_table_free(sf_table *table) {
    SF_CLEAR(table, table->value[0], table->value[1], table->line);
}

/* ---- lines and cells ---- */

/* True of a comment without numbers that gives the curve below another meaning, such as "# true stress". */
static bool is_other_title(const char *comment) {
    static const char *const others[] = {"true str",        "cauchy str", "hencky str",
                                         "logarithmic str", "log str",    "plastic str",
                                         "yield str",       "shear str",  "volumetric str"};
    if (strpbrk(comment, "0123456789") || strcasestr(comment, "nominal") ||
        strcasestr(comment, "engineering"))
        return false;
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (strcasestr(comment, others[k]))
            return true;
    return false;
}

/* The next line that is neither empty nor a comment, ended in place; NULL after the last. */
static char *next_content(csv *file) {
    while (*file->next) {
        char *line = file->next, *end = line + strcspn(line, "\r\n");
        file->next = end + (*end != '\0');
        if (*end == '\r' && *file->next == '\n')
            file->next++;
        *end = '\0';
        file->line++;
        if (strncmp(line, READING, sizeof READING - 1) == 0)
            file->reading = line + 2;
        else if (*line == '#' && file->columns == 0 && is_other_title(line)) {
            file->title = line;
            file->title_line = file->line;
        }
        line += strspn(line, " \t");
        if (*line && *line != '#' && line[strspn(line, " \t,")])
            return line;
    }
    return NULL;
}

static char *trim_blanks(char *text) {
    while (isspace((unsigned char)*text))
        text++;
    for (char *end = text + strlen(text); end > text && isspace((unsigned char)end[-1]);)
        *--end = '\0';
    return text;
}

/* Removes blanks and a pair of quotes; of "1,5", which a comma splits, each half keeps its quote. */
static char *trim(char *text) {
    text = trim_blanks(text);
    size_t length = strlen(text);
    if (length < 2 || text[0] != '"' || text[length - 1] != '"')
        return text;
    text[length - 1] = '\0';
    return trim_blanks(text + 1);
}

/* Splits a line into cells; empty ones at its end do not count beyond the heading. */
static void split(csv *file, char *line) {
    file->cells = 0;
    for (char *rest = line; rest && file->cells < COLUMNS;)
        file->cell[file->cells++] = trim(strsep(&rest, ","));
    while (file->cells > file->columns && !*file->cell[file->cells - 1])
        file->cells--;
}

/* ---- heading ---- */

/* SI value of a unit; 0 if the text is no unit of the kind. */
static double unit_value(const csv *file, const char *text, int kind) {
    double value = 0;
    if (kind == SF_TABLE_RATIO)
        return sf_word_find("%|percent", text) >= 0 ? 0.01 : sf_word_find("1|-", text) >= 0;
    if (kind == SF_ACCELERATION && strcmp(text, "g") == 0)
        return SF_STANDARD_GRAVITY;
    SF_PRINTED(quantity, UNIT + 8, "1 %s", text);
    return sf_units_parse(file->units, quantity, (sf_quantity)kind, &value, SF_IGNORED) == SF_OK ? value : 0;
}

/* The SI value of the unit at the end of a heading such as "Name (unit)", which is cut off `name`; else 0. */
static double bracketed_unit(const csv *file, char *name, int kind, char unit[UNIT]) {
    size_t length = strlen(name);
    char *open = NULL;
    if (length > 0 && name[length - 1] == ')')
        open = strrchr(name, '(');
    else if (length > 0 && name[length - 1] == ']')
        open = strrchr(name, '[');
    if (!open || open == name)
        return 0;
    name[length - 1] = '\0';
    snprintf(unit, UNIT, "%.31s", open + 1);
    *open = '\0';
    return unit_value(file, unit, kind);
}

static bool is_named(const char *name, const char *names) {
    char lower[TITLE];
    size_t k = 0;
    for (; name[k] && k + 1 < sizeof lower; k++)
        lower[k] = (char)tolower((unsigned char)name[k]);
    lower[k] = '\0';
    return sf_word_find(names, lower) >= 0;
}

/* True if a heading is the user's choice or, without one, a name of the column. */
static bool is_heading(const char *name, const sf_table_column *column, const char *chosen) {
    return chosen ? strcmp(name, chosen) == 0 : is_named(name, column->names);
}

/* The SI value of the unit of a cell that holds the column, by its names or the user's choice; else 0. */
static double cell_scale(const csv *file, const char *cell, const sf_table_column *column, const char *chosen,
                         char unit[UNIT]) {
    char name[TITLE];
    size_t length = strlen(cell);
    bool whole = chosen && strcmp(cell, chosen) == 0;
    if (length == 0 || length >= sizeof name)
        return 0;
    memcpy(name, cell, length + 1);
    if (strchr(")]", name[length - 1])) {
        double value = bracketed_unit(file, name, column->kind, unit);
        char *plain = trim(name);
        return whole || is_heading(plain, column, chosen) ? value : 0;
    }
    for (char *at = strchr(name, '_'); at; at = strchr(at + 1, '_')) { /* name_unit, its next _ read as / */
        snprintf(unit, UNIT, "%.31s", at + 1);
        char *slash = strchr(unit, '_');
        if (slash)
            *slash = '/';
        *at = '\0';
        bool fits = whole || is_heading(name, column, chosen);
        double value = fits ? unit_value(file, unit, column->kind) : 0;
        *at = '_';
        if (value > 0)
            return value;
    }
    snprintf(unit, UNIT, "1");
    return column->kind == SF_TABLE_RATIO && is_heading(name, column, chosen);
}

/* Finds a column in the heading; `*count`: cells that could be it. */
static sf_status find_column(csv *file, int c, int *count, sf_error *err) {
    const sf_table_column *column = file->layout->column[c];
    const char *chosen = c == 1 ? file->layout->chosen : NULL, *choice = file->layout->choice;
    *count = 0;
    for (int i = 0; i < file->cells; i++) {
        char unit[UNIT];
        double scale = cell_scale(file, file->cell[i], column, chosen, unit);
        if (!(scale > 0))
            continue;
        if (++*count > 1)
            return SF_REFUSE(err, "%s:%d: two %s columns (\"%.80s\" and \"%.80s\"): name one with %s%s",
                             file->path, file->line, column->name, file->cell[file->place[c]], file->cell[i],
                             choice && c == 1 ? choice : file->remedy,
                             choice && c == 1 ? "" : " --column NAME");
        file->place[c] = i;
        file->table->scale[c] = scale / column->unit;
        memcpy(file->unit[c], unit, sizeof unit);
    }
    return SF_OK;
}

/* Refuses a heading whose columns in a unit of the quantity have other names, of which the user may choose.
 */
static sf_status name_choice(const csv *file, const sf_table_layout *layout, sf_error *err) {
    char shown[SHOWN] = "", name[TITLE], unit[UNIT];
    for (int i = 0; i < file->cells && strlen(shown) + 60 < sizeof shown; i++) {
        snprintf(name, sizeof name, "%.95s", file->cell[i]);
        if (bracketed_unit(file, name, layout->column[1]->kind, unit) > 0)
            sf_text_add(shown, sizeof shown, "%s\"%.40s\"", shown[0] ? ", " : "", trim(name));
    }
    return shown[0] ? SF_REFUSE(err, "%s:%d: no column is called %s: name one of %s with %s", file->path,
                                file->line, layout->column[1]->name, shown, layout->choice)
                    : SF_OK;
}

/* Names the headings that the file has. */
static sf_status refuse_heading(const csv *file, const sf_table_layout *layout, int c, sf_error *err) {
    char shown[SHOWN] = "";
    for (int i = 0; i < file->cells && strlen(shown) + 60 < sizeof shown; i++)
        if (*file->cell[i])
            sf_text_add(shown, sizeof shown, "%s\"%.40s\"", shown[0] ? ", " : "", file->cell[i]);
    const char *called = c == 1 ? layout->chosen : NULL;
    if (c == 1 && !called && layout->choice)
        SF_TRY(name_choice(file, layout, err));
    return SF_REFUSE(err, "%s:%d: the heading has no column of %s%s%s, such as %s; it has %s%s%s" OTHER_FORMS,
                     file->path, file->line, layout->column[c]->name, called ? " called " : "",
                     called ? called : "", layout->column[c]->example, shown,
                     layout->means ? ", and what is read is " : "", layout->means ? layout->means : "",
                     file->remedy);
}

/* A curve of nominal stress or strain has no title of another one. */
static sf_status check_title(const csv *file, sf_error *err) {
    const sf_table_layout *layout = file->layout;
    if (!file->title || !layout->means ||
        (layout->column[0] != &sf_column_strain && layout->column[1] != &sf_column_stress))
        return SF_OK;
    return SF_REFUSE(err,
                     "%s:%d: \"%.80s\" stands above the table, but what is read is %s: if the table holds "
                     "that, leave the line out",
                     file->path, file->title_line, file->title + strspn(file->title, "# "), layout->means);
}

/* Reads the first line with content as the heading of the first layout that it fits. */
static sf_status read_heading(csv *file, const sf_table_layout *layouts, int count, int *which,
                              sf_error *err) {
    int found[2] = {0}, best = -1, missing = 0;
    char *line = next_content(file);
    if (!line)
        return SF_REFUSE(err, "%s is empty: it needs a heading and rows of numbers", file->path);
    file->columns = COLUMNS;
    split(file, line);
    file->columns = file->cells;
    for (int k = 0; k < count; k++) {
        file->layout = &layouts[k];
        for (int c = 0; c < 2; c++)
            SF_TRY(find_column(file, c, &found[c], err));
        if (found[0] && found[1]) {
            *which = k;
            return check_title(file, err);
        }
        if (found[0] + found[1] > best) {
            best = found[0] + found[1];
            *which = k;
            missing = found[0] ? 1 : 0;
        }
    }
    return refuse_heading(file, &layouts[*which], missing, err);
}

/* ---- rows ---- */

static sf_status read_number(const csv *file, int c, double *value, sf_error *err) {
    const char *text = file->cell[file->place[c]], *name = file->layout->column[c]->name;
    if (!sf_decimal_is(text, value) || !isfinite(*value))
        return SF_REFUSE(err, "%s:%d: %s \"%.40s\" is not a finite number such as 12.5" OTHER_FORMS,
                         file->path, file->line, name, text, file->remedy);
    return SF_OK;
}

static sf_status append(const csv *file, const double value[2], sf_error *err) {
    sf_table *table = file->table;
    size_t n = (size_t)table->count;
    if (!sf_grow(&table->value[0], n, sizeof *value) || !sf_grow(&table->value[1], n, sizeof *value) ||
        !sf_grow(&table->line, n, sizeof *table->line))
        return SF_NO_MEMORY(err, "the %s %s", file->layout->what, file->path);
    table->value[0][n] = value[0];
    table->value[1][n] = value[1];
    table->line[n] = file->line;
    table->count++;
    return SF_OK;
}

static sf_status read_row(csv *file, char *line, sf_error *err) {
    const sf_table *table = file->table;
    sf_table_point point = {
        .path = file->path, .line = file->line, .index = table->count, .remedy = file->remedy};
    int last = file->place[0] > file->place[1] ? file->place[0] : file->place[1];
    split(file, line);
    if (file->cells != file->columns &&
        !(file->layout->ragged && file->cells > last && file->cells < file->columns))
        return SF_REFUSE(err, "%s:%d: %d values where the heading has %d columns" OTHER_FORMS, file->path,
                         file->line, file->cells, file->columns, file->remedy);
    for (int c = 0; c < 2; c++) {
        point.text[c] = file->cell[file->place[c]];
        SF_TRY(read_number(file, c, &point.value[c], err));
        point.value[c] *= table->scale[c];
        if (table->count > 0) {
            point.before[c] = table->value[c][table->count - 1];
            point.last[c] = point.before[c] / table->scale[c];
        }
    }
    if (file->layout->check)
        SF_TRY(file->layout->check(&point, err));
    return append(file, point.value, err);
}

static void describe(const csv *file) {
    char *out = file->table->interpretation;
    const sf_table_column *const *column = file->layout->column;
    if (file->layout->means)
        sf_text_add(out, SF_TABLE_INTERPRETATION, "%s, columns %d and %d, ", file->layout->means,
                    file->place[0] + 1, file->place[1] + 1);
    sf_text_add(out, SF_TABLE_INTERPRETATION, "%s in %s, %s in %s", column[0]->name, file->unit[0],
                column[1]->name, file->unit[1]);
    if (file->reading)
        sf_text_add(out, SF_TABLE_INTERPRETATION, " (%.*s)", sf_utf8_cut(file->reading, READING_SHOWN),
                    file->reading);
}

static sf_status read_all(csv *file, const sf_table_layout *layouts, int count, int *which, sf_error *err) {
    char *line;
    SF_TRY(sf_units_open(&file->units, err));
    SF_TRY(read_heading(file, layouts, count, which, err));
    while ((line = next_content(file)))
        SF_TRY(read_row(file, line, err));
    describe(file);
    return SF_OK;
}

/* The command that reads other forms of a file. */
static char *remedy_of(const char *path, const char *kind) {
    const char *name = strrchr(path, '/');
    bool same = strcmp(name ? name + 1 : path, "clean.csv") == 0;
    char out[] = "clean2.csv",
         *word[] = {"softfall", "read", (char *)path, "--kind", (char *)kind, "-o", same ? out : "clean.csv"};
    return sf_command_line(sizeof word / sizeof *word, word);
}

sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err) {
    SF_OWNED char *text = NULL;
    size_t length = 0;
    csv file = {.path = path, .table = table};
    memset(table, 0, sizeof *table);
    *which = 0;
    SF_OWNED char *remedy = remedy_of(path, layouts[0].kind);
    if (!remedy)
        return SF_NO_MEMORY(err, "the %s %s", layouts[0].what, path);
    file.remedy = remedy;
    SF_TRY(sf_plain_read(path, layouts[0].what, SF_PLAIN_TEXT, &text, &length, err));
    if (strlen(text) < length)
        return SF_REFUSE(err, "the %s %s holds zero bytes: it is not a text in UTF-8" OTHER_FORMS,
                         layouts[0].what, path, remedy);
    file.next = text + (strncmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0); /* byte order mark */
    sf_status status = read_all(&file, layouts, count, which, err);
    sf_units_close(&file.units);
    if (status != SF_OK)
        sf_table_free(table);
    return status;
}

sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err) {
    int which;
    return sf_table_read_any(path, layout, 1, &which, table, err);
}
