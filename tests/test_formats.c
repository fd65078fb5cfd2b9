/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of docs/formats.md are those of the program: what stands between `<!-- generated: NAME -->` and
 * `<!-- end -->` is written from the lists in src/. With SF_WRITE_DOCS=1 in the environment the document is
 * brought up to date instead. */
#include "model/columns.h"
#include "model/good_run.h"
#include "model/model.h"
#include "post/figures/figures.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Text of a cell: `|` is escaped. */
static void put_text(FILE *f, const char *text) {
    for (; *text; text++)
        *text == '|' ? fputs("\\|", f) : fputc(*text, f);
}

static void put_meaning(FILE *f, const char *description, const char *remark) {
    put_text(f, description);
    fputs(*remark ? "; " : "", f);
    put_text(f, remark);
    fputs(" |\n", f);
}

static void put_history(FILE *f) {
    fputs("| dataset | units | in history.csv | meaning |\n|---|---|---|---|\n", f);
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        const sf_history_column *c = sf_history_column_get(k);
        fprintf(f, "| `%s` | %s | %s%s%s | ", c->name, c->units, c->csv ? "`" : "",
                c->csv ? c->csv : "raw and filtered", c->csv ? "`" : "");
        put_meaning(f, c->description, c->remark);
    }
}

static void put_frame_fields(FILE *f) {
    fputs("| dataset | shape | units | in pad.xdmf | meaning |\n|---|---|---|---|---|\n", f);
    for (int k = 0; k < SF_FRAME_FIELDS; k++) {
        const sf_frame_field_info *i = sf_frame_field_get((sf_frame_field)k);
        fprintf(f, "| `%s` | (n", i->name);
        if (i->components > 1)
            fprintf(f, ", %d", i->components);
        fprintf(f, ") | %s | `%s` | ", i->units, i->array);
        put_meaning(f, i->description, i->remark);
    }
}

static void put_figures(FILE *f) {
    size_t count;
    const sf_figure *figure = sf_figure_list(&count);
    fputs("| key | meaning |\n|---|---|\n", f);
    for (size_t k = 0; k < count; k++) {
        fprintf(f, "| `%s` | ", figure[k].row.key);
        put_meaning(f, figure[k].row.meaning, "");
    }
}

static void put_layer_figures(FILE *f) {
    sf_rows rows = sf_layer_figure_rows();
    fputs("| key | meaning |\n|---|---|\n", f);
    for (size_t k = 0; k < rows.count; k++) {
        fprintf(f, "| `%s` | ", rows.row[k].key);
        put_meaning(f, rows.row[k].meaning, "");
    }
}

static void put_good_run(FILE *f) {
    fputs("| check | value | remark beyond | do not use beyond | why it matters |\n|---|---|---|---|---|\n",
          f);
    for (int k = 0; k < SF_CHECKS; k++) {
        const sf_good_run_rule *r = sf_good_run_rule_get(k);
        fprintf(f, "| `%s` | %s | %g | ", r->key, r->figures, r->remark);
        isfinite(r->refuse) ? fprintf(f, "%g", r->refuse) : fputc('-', f);
        fprintf(f, " | %s |\n", r->why);
    }
}

/* Path of the scalar that counts the rows of an array. */
static const char *count_path(size_t offset) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    for (size_t k = 0; k < count; k++)
        if (field[k].rows_offset == SIZE_MAX && field[k].offset == offset)
            return field[k].path;
    fail_msg("an array of the model has no count");
    return NULL;
}

static void put_model(FILE *f) {
    static const char *const types[] = {
        [SF_MODEL_F64] = "f64", [SF_MODEL_I32] = "i32", [SF_MODEL_I64] = "i64", [SF_MODEL_U8] = "u8"};
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    fputs("| dataset | type | shape | units | meaning |\n|---|---|---|---|---|\n", f);
    for (size_t k = 0; k < count; k++) {
        const sf_model_field *m = &field[k];
        fprintf(f, "| `%s` | %s | ", m->path, types[m->type]);
        if (m->rows_offset == SIZE_MAX) {
            fputs("scalar", f);
        } else {
            fprintf(f, "(`%s`%s", count_path(m->rows_offset), m->rows_extra ? " + 1" : "");
            if (m->columns > 1)
                fprintf(f, ", %d", m->columns);
            fputc(')', f);
        }
        fprintf(f, " | %s | ", m->units);
        put_meaning(f, m->description, m->optional ? "may be absent" : "");
    }
}

static const struct {
    const char *name;
    void (*put)(FILE *f);
} tables[] = {
    {"model", put_model},
    {"history", put_history},
    {"frame fields", put_frame_fields},
    {"figures", put_figures},
    {"layer figures", put_layer_figures},
    {"good run", put_good_run},
};

/* The whole file as text; free it. */
static char *read_text(const char *path) {
    char *text = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "r"), *copy = open_memstream(&text, &size);
    assert_non_null(file);
    for (int c; (c = fgetc(file)) != EOF;)
        fputc(c, copy);
    fclose(file);
    fclose(copy);
    return text;
}

/* The document with what the lists say between its markers; free it. */
static char *bring_up_to_date(const char *document) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    const char *rest = document;
    for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++) {
        char marker[64];
        snprintf(marker, sizeof marker, "<!-- generated: %s -->\n", tables[k].name);
        const char *begin = strstr(rest, marker), *end = begin ? strstr(begin, "<!-- end -->") : NULL;
        if (!end)
            fail_msg("docs/formats.md: \"%s\" is missing, has no end or is out of order", tables[k].name);
        begin += strlen(marker);
        fwrite(rest, 1, (size_t)(begin - rest), out);
        tables[k].put(out);
        rest = end;
    }
    fputs(rest, out);
    fclose(out);
    return text;
}

static void document_has_the_tables_of_the_program(void **state) {
    const char *root = getenv("SF_SOURCE_DIR");
    char path[4096];
    (void)state;
    assert_non_null(root);
    snprintf(path, sizeof path, "%s/docs/formats.md", root);
    char *document = read_text(path), *expected = bring_up_to_date(document);
    bool same = strcmp(document, expected) == 0;
    if (!same && getenv("SF_WRITE_DOCS")) {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        assert_int_not_equal(fputs(expected, file), EOF);
        assert_int_equal(fclose(file), 0);
        same = true;
    }
    free(document);
    free(expected);
    if (!same)
        fail_msg(
            "docs/formats.md is not up to date: run test_formats with SF_WRITE_DOCS=1 in its environment");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(document_has_the_tables_of_the_program)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
