/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/runs.h"

#include "base/hash.h"
#include "base/text.h"
#include "io/plain_file.h"
#include "io/replace.h"

static const char *const states[] = {[SF_SWEEP_OPEN] = "open",
                                     [SF_SWEEP_DONE] = "done",
                                     [SF_SWEEP_FAILED] = "failed",
                                     [SF_SWEEP_PREDICTED] = "predicted"};

sf_status sf_runs_create(const sf_plan *plan, sf_runs *r, sf_error *err) {
    *r = (sf_runs){.plan = plan, .count = plan->rows};
    for (int k = 0; k < plan->figure_count; k++)
        r->column[k] = sf_runs_figure(plan->figure[k].figure);
    r->state = sf_alloc(err, plan->rows, 1, "the runs");
    r->grade = sf_alloc(err, plan->rows, 1, "the runs");
    r->folder = sf_alloc(err, plan->rows, sizeof *r->folder, "the runs");
    r->message = sf_alloc(err, plan->rows, sizeof *r->message, "the runs");
    r->value = sf_alloc(err, plan->rows, SF_FIGURE_TOTAL * sizeof *r->value, "the figures of the runs");
    if (sf_plan_is_adaptive(plan))
        r->half =
            sf_alloc(err, plan->rows, (unsigned long)plan->figure_count * sizeof *r->half, "predictions");
    for (int64_t k = 0; r->value && k < r->count * SF_FIGURE_TOTAL; k++)
        r->value[k] = NAN;
    return err->status;
}

void sf_runs_free(sf_runs *r) {
    sf_free_all((size_t)r->count, r->folder);
    sf_free_all((size_t)r->count, r->message);
    SF_CLEAR(r, r->state, r->grade, r->folder, r->message, r->value, r->half);
}

double *sf_runs_place(const sf_runs *r, int64_t row) {
    return r->value + row * SF_FIGURE_TOTAL;
}

size_t sf_runs_figure(const char *key) {
    return (size_t)(sf_figure_find(key) - sf_figure_at);
}

/* ---- states ---- */

/* The number of a text, entered if it is new; NaN: no place is left. */
static double text_number(sf_runs *r, const char *text) {
    for (int k = 0; k < r->text_count; k++)
        if (strncmp(r->text[k], text, sizeof r->text[k] - 1) == 0)
            return k;
    if (r->text_count == SF_RUNS_TEXTS)
        return NAN;
    snprintf(r->text[r->text_count], sizeof r->text[0], "%s", text);
    return r->text_count++;
}

void sf_runs_take(sf_runs *r, int64_t row, const double *figure, const char *status) {
    double *place = sf_runs_place(r, row);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        place[k] = sf_figure_at[k].row.type != SF_ROW_TEXT ? figure[k]
                   : *status                               ? text_number(r, status)
                                                           : NAN;
}

static double to_nine_digits(double value) {
    if (!isfinite(value))
        return NAN;
    SF_PRINTED(text, 32, "%.9g", value);
    return strtod(text, NULL);
}

static sf_status keep_text(char **place, const char *text, sf_error *err) {
    free(*place);
    *place = text && *text ? strdup(text) : NULL;
    return !text || !*text || *place ? SF_OK : SF_NO_MEMORY(err, "the runs");
}

sf_status sf_runs_done(sf_runs *r, int64_t row, sf_grade grade, const char *folder, const char *message,
                       sf_error *err) {
    double *place = sf_runs_place(r, row);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        place[k] = to_nine_digits(place[k]);
    r->state[row] = SF_SWEEP_DONE;
    r->grade[row] = (unsigned char)grade;
    keep_text(&r->message[row], message, err);
    return keep_text(&r->folder[row], folder, err);
}

sf_status sf_runs_failed(sf_runs *r, int64_t row, const char *message, sf_error *err) {
    sf_runs_open(r, row);
    r->state[row] = SF_SWEEP_FAILED;
    return keep_text(&r->message[row], message, err);
}

void sf_runs_open(sf_runs *r, int64_t row) {
    double *place = sf_runs_place(r, row);
    r->state[row] = SF_SWEEP_OPEN;
    SF_FREE(r->message[row], r->folder[row]);
    r->message[row] = r->folder[row] = NULL;
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        place[k] = NAN;
    for (int k = 0; k < r->plan->figure_count && r->half; k++)
        r->half[row * r->plan->figure_count + k] = 0;
}

sf_status sf_runs_leave(sf_runs *r, int64_t row, const char *message, sf_error *err) {
    return keep_text(&r->message[row], message, err);
}

void sf_runs_predicted(sf_runs *r, int64_t row, const double *value, const double *half) {
    sf_runs_open(r, row);
    r->state[row] = SF_SWEEP_PREDICTED;
    for (int k = 0; k < r->plan->figure_count; k++) {
        sf_runs_place(r, row)[r->column[k]] = to_nine_digits(value[k]);
        r->half[row * r->plan->figure_count + k] = half[k];
    }
}

double sf_runs_half(const sf_runs *r, int64_t row, int figure) {
    return r->half ? r->half[row * r->plan->figure_count + figure] : 0;
}

int64_t sf_runs_count(const sf_runs *r, sf_sweep_state state) {
    int64_t count = 0;
    for (int64_t k = 0; k < r->count; k++)
        count += r->state[k] == state;
    return count;
}

bool sf_runs_usable(const sf_runs *r, int64_t row) {
    return r->state[row] == SF_SWEEP_PREDICTED ||
           (r->state[row] == SF_SWEEP_DONE && r->grade[row] != SF_GRADE_DO_NOT_USE);
}

double sf_runs_value(const sf_runs *r, int64_t row, int figure) {
    return sf_runs_usable(r, row) ? sf_runs_place(r, row)[r->column[figure]] : NAN;
}

/* ---- rows of two meshes ---- */

#define REFINED(key, k, name, unit)                                                                          \
    {key "_refined", name, unit, SF_ROW_OF(NUMBER, sf_runs_pair, figure[k][0])}, {                           \
        key "_refined_error", "±", unit, "%.2g", SF_ROW_OF(NUMBER, sf_runs_pair, figure[k][1])               \
    }
static const sf_row pair_rows[] = {{"id", "run", SF_ROW_OF(COUNT, sf_runs_pair, id)},
                                   REFINED("a_max_g", 0, "a_max", "g"),
                                   REFINED("hic", 1, "HIC", NULL),
                                   REFINED("max_indentation_mm", 2, "indentation", "mm"),
                                   REFINED("v_rebound_m_s", 3, "rebound", "m/s"),
                                   {"refined_note", "no value because", SF_ROW_OF(TEXT, sf_runs_pair, note)}};
const sf_rows sf_runs_pair_rows = SF_ROWS(pair_rows);

sf_runs_pair sf_runs_refine(const sf_runs *r, int64_t row) {
    static const char *const keys[SF_REFINED] = {"a_max_g", "hic", "max_indentation_mm", "v_rebound_m_s"};
    const bool own = sf_runs_usable(r, row), both = own && r->coarse && sf_runs_usable(r->coarse, row);
    const sf_runs *bad = own ? r->coarse : r;
    const size_t cells = sf_runs_figure("cells");
    sf_runs_pair pair = {.id = row + 1};
    if (!both)
        snprintf(pair.note, sizeof pair.note, "%s drop: %s", own ? "its coarse" : "its",
                 bad && bad->message[row] ? bad->message[row] : "not simulated");
    for (int k = 0; k < SF_REFINED; k++) {
        const size_t at = sf_runs_figure(keys[k]);
        sf_error err = SF_ERROR_INIT;
        pair.figure[k][0] = pair.figure[k][1] = NAN;
        if (!both)
            continue;
        const double *fine = sf_runs_place(r, row), *coarse = sf_runs_place(r->coarse, row);
        if (sf_figure_refine(fine[at], coarse[at], SF_SWEEP_RATIO, fine[cells] / coarse[cells],
                             pair.figure[k], &err) != SF_OK)
            sf_text_add(pair.note, sizeof pair.note, "%s%s: %s", *pair.note ? "; " : "", keys[k], err.text);
    }
    return pair;
}

/* ---- runs.csv ---- */

static void put_heading(sf_csv *csv, const sf_runs *r) {
    char text[SF_FACTOR_KEY_SIZE + SF_FACTOR_UNIT_SIZE + 8];
    sf_csv_print(csv, "id");
    for (int f = 0; f < r->plan->factor_count; f++)
        sf_csv_text(csv, sf_factor_heading(&r->plan->factor[f], text, sizeof text));
    sf_csv_print(csv, "run_status,grade,message,folder");
    sf_figure_csv_keys(csv);
    for (int k = 0; k < r->plan->figure_count && r->half; k++)
        sf_csv_print(csv, "%s_low,%s_high", r->plan->figure[k].figure, r->plan->figure[k].figure);
    for (size_t k = 1; k < sf_runs_pair_rows.count && r->plan->refine; k++)
        sf_csv_print(csv, "%s", pair_rows[k].key);
    sf_csv_end(csv);
}

static void put_figure(sf_csv *csv, const sf_runs *r, const sf_figure *figure, double value) {
    if (figure->row.type == SF_ROW_TEXT && !isnan(value))
        sf_csv_text(csv, r->text[(int)value]);
    else
        SF_CSV_NUMBERS(csv, value);
}

/* The 95 % interval of a figure of a predicted row; of others two empty cells. */
static void put_interval(sf_csv *csv, const sf_runs *r, int64_t row, int figure) {
    double value = r->state[row] == SF_SWEEP_PREDICTED ? sf_runs_value(r, row, figure) : NAN;
    double half = sf_runs_half(r, row, figure);
    SF_CSV_NUMBERS(csv, value * exp(-half), value * exp(half));
}

static void put_pair(sf_csv *csv, const sf_runs *r, int64_t row) {
    const sf_runs_pair pair = sf_runs_refine(r, row);
    for (int k = 0; k < SF_REFINED; k++)
        sf_csv_numbers(csv, 2, pair.figure[k]);
    sf_csv_text(csv, pair.note);
}

static void put_row(sf_csv *csv, const sf_runs *r, int64_t row) {
    char text[SF_SWEEP_OVERRIDE_SIZE];
    sf_csv_print(csv, "%lld", (long long)row + 1);
    for (int f = 0; f < r->plan->factor_count; f++)
        sf_csv_text(csv,
                    sf_factor_text(&r->plan->factor[f], sf_plan_value(r->plan, f, row), text, sizeof text));
    bool done = r->state[row] == SF_SWEEP_DONE;
    sf_csv_print(csv, "%s,%s", states[r->state[row]], done ? sf_verdict_phrase(r->grade[row]) : "");
    sf_csv_text(csv, r->message[row]);
    sf_csv_text(csv, r->folder[row]);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        put_figure(csv, r, &sf_figure_at[k], sf_runs_place(r, row)[k]);
    for (int k = 0; k < r->plan->figure_count && r->half; k++)
        put_interval(csv, r, row, k);
    if (r->plan->refine)
        put_pair(csv, r, row);
    sf_csv_end(csv);
}

sf_status sf_runs_write(const sf_runs *r, const char *path, uint64_t *hash, sf_error *err) {
    sf_replacement out;
    FILE *file = sf_replace_open(path, &out, err);
    SF_TRY(err->status);
    sf_csv csv = {.file = file};
    put_heading(&csv, r);
    for (int64_t row = 0; row < r->count; row++)
        put_row(&csv, r, row);
    if (fflush(file) != 0)
        SF_FAIL(err, SF_ERR_IO, SF_NOT_WRITTEN, path);
    else /* under the partial name, before another program knows the file */
        sf_plain_hash(out.partial, "table of the runs", SF_PLAIN_ANY, hash, err);
    return sf_replace_close(&out, err);
}

/* The next cell in place, its quotes taken away; `*at` moves behind it. NULL at the end of the line. */
static char *next_cell(char **at) {
    char *cell = *at, *to = *at, *from = *at;
    if (!from)
        return NULL;
    bool quoted = *from == '"';
    from += quoted;
    while (*from && (quoted || *from != ',')) {
        if (quoted && *from == '"' && from[1] != '"')
            quoted = false, from++;
        else {
            from += quoted && *from == '"';
            *to++ = *from++;
        }
    }
    *at = *from == ',' ? from + 1 : NULL;
    *to = '\0';
    return *cell == '\'' && sf_csv_is_formula(cell + 1) ? cell + 1 : cell;
}

static int find_word(const char *cell, const char *const *words, int count) {
    for (int k = 0; k < count; k++)
        if (cell && strcmp(cell, words[k]) == 0)
            return k;
    return -1;
}

static void take_figures(sf_runs *r, int64_t row, char *rest) {
    double *place = sf_runs_place(r, row);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++) {
        const char *cell = next_cell(&rest);
        if (!cell || !*cell)
            continue;
        place[k] = sf_figure_at[k].row.type == SF_ROW_TEXT ? text_number(r, cell) : strtod(cell, NULL);
    }
}

static sf_status take_row(sf_runs *r, int64_t row, char *line, sf_error *err) {
    const char *const grades[] = {sf_verdict_phrase(SF_GRADE_VALID), sf_verdict_phrase(SF_GRADE_REMARKS),
                                  sf_verdict_phrase(SF_GRADE_DO_NOT_USE)};
    for (int k = 0; k <= r->plan->factor_count; k++)
        next_cell(&line);
    int state = find_word(next_cell(&line), states, 3), grade = find_word(next_cell(&line), grades, 3);
    const char *message = next_cell(&line), *folder = next_cell(&line);
    if (state == SF_SWEEP_FAILED && message)
        return sf_runs_failed(r, row, message, err);
    if (state != SF_SWEEP_DONE || grade < 0 || !folder)
        return SF_OK;
    take_figures(r, row, line);
    return sf_runs_done(r, row, (sf_grade)grade, folder, message, err);
}

/* The heading that belongs to the table; from malloc. */
static char *own_heading(const sf_runs *r) {
    SF_TEXT_STREAM(out, text, size);
    if (out)
        put_heading(&(sf_csv){.file = out}, r);
    return sf_text_close(out, &text);
}

sf_status sf_runs_read(sf_runs *r, const char *path, uint64_t hash, sf_error *err) {
    SF_OWNED char *text = NULL, *heading = own_heading(r);
    size_t size = 0;
    if (!heading)
        SF_NO_MEMORY(err, "the runs");
    else if (sf_plain_read(path, "table of the runs", SF_PLAIN_ANY, &text, &size, err) == SF_OK &&
             sf_hash_bytes(SF_HASH_START, text, size) == hash &&
             strncmp(text, heading, strlen(heading)) == 0) {
        char *rest = text + strlen(heading), *line;
        for (int64_t row = 0; row < r->count && (line = strsep(&rest, "\n")) && *line; row++)
            if (take_row(r, row, line, err) != SF_OK)
                break;
    }
    return err->status;
}
