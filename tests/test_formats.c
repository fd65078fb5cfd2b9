/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of the documents are those of the program: what stands between `<!-- generated: NAME -->` and
 * `<!-- end -->` is written from the lists in src/. With SF_WRITE_DOCS=1 in the environment the documents are
 * brought up to date instead. */
#include "base/text.h"
#include "model/drop_kind.h"
#include "model/model.h"
#include "post/figures/record.h"
#include "study/fit/form/form.h"
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

/* A component of a vector: the end of a name, behind its last "_", with the name's description. */
typedef struct component {
    const char *name, *end, *description;
} component;

static component component_of(const char *name, const char *description) {
    const char *last = strrchr(name, '_');
    return (component){name, last ? last + 1 : name + strlen(name), description};
}

/* Where the end of c's name stands as the last word of a clause of its description; NULL: nowhere. */
static const char *end_in_meaning(const component *c) {
    char words[32];
    snprintf(words, sizeof words, " %s", c->end);
    const char *at = *c->end ? strstr(c->description, words) : NULL;
    return at && (at[strlen(words)] == '\0' || at[strlen(words)] == ';') ? at : NULL;
}

/* True if the names are components of one vector: the descriptions differ in the component alone, but for
 * what the first one's says behind it. */
static bool are_one_vector(const component *first, const component *next) {
    const char *at = end_in_meaning(first), *there = end_in_meaning(next);
    ptrdiff_t stem = first->end - first->name, before = at ? at - first->description : 0;
    return at && there && stem == next->end - next->name && there - next->description == before &&
           strncmp(first->name, next->name, (size_t)stem) == 0 &&
           strncmp(first->description, next->description, (size_t)before) == 0 &&
           there[1 + strlen(next->end)] == '\0';
}

/* The meaning of `count` components: that of the first one, with the ends of all names. */
static void put_components(FILE *f, const component *of, int count, const char *remark) {
    const char *at = count > 1 ? end_in_meaning(&of[0]) : NULL;
    if (at) {
        fprintf(f, "%.*s", (int)(at - of[0].description), of[0].description);
        for (int k = 0; k < count; k++)
            fprintf(f, "%s %s", k ? "," : "", of[k].end);
        put_meaning(f, at + 1 + strlen(of[0].end), remark);
    } else {
        put_meaning(f, of[0].description, remark);
    }
}

enum { MOST_COMPONENTS = 4 };

static void put_history(FILE *f) {
    fputs("| dataset | units | meaning |\n|---|---|---|\n", f);
    for (int k = 0, count; k < SF_HISTORY_COUNT; k += count) {
        const sf_history_column *c = sf_history_column_get(k);
        component of[MOST_COMPONENTS] = {component_of(c->name, c->description)};
        fprintf(f, "| `%s`", c->name);
        for (count = 1; count < MOST_COMPONENTS && k + count < SF_HISTORY_COUNT; count++) {
            const sf_history_column *next = sf_history_column_get(k + count);
            of[count] = component_of(next->name, next->description);
            if (!are_one_vector(&of[0], &of[count]))
                break;
            fprintf(f, ", `%s`", next->name);
        }
        fprintf(f, " | %s | ", strcmp(c->units, "1") == 0 ? "" : c->units);
        put_components(f, of, count, c->remark);
    }
}

static void put_frame_fields(FILE *f) {
    fputs("| dataset | shape | units | meaning |\n|---|---|---|---|\n", f);
    for (int k = 0; k < SF_FRAME_FIELDS; k++) {
        const sf_frame_field_info *i = sf_frame_field_get((sf_frame_field)k);
        fprintf(f, "| `%s` | (n", i->name);
        if (i->components > 1)
            fprintf(f, ", %d", i->components);
        fprintf(f, ") | %s | ", strcmp(i->units, "1") == 0 ? "" : i->units);
        put_meaning(f, i->description, i->remark);
    }
}

static void put_figures(FILE *f) {
    fputs("| key | meaning |\n|---|---|\n", f);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++) {
        fprintf(f, "| `%s` | ", sf_figure_at[k].row.key);
        put_meaning(f, sf_figure_at[k].row.meaning, "");
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

#define RECORD_ROW(name, remark, refuse, title, how, why)                                                    \
    fprintf(f, "| `%s` | %s | %g | ", #name, how, (double)(remark));                                         \
    isfinite(refuse) ? fprintf(f, "%g", (double)(refuse)) : fputc('-', f);                                   \
    fprintf(f, " | %s |\n", why);

static void put_good_record(FILE *f) {
    fputs("| check | value | remark beyond | do not use beyond | why it matters |\n|---|---|---|---|---|\n",
          f);
    SF_GOOD_RECORD(RECORD_ROW)
}

static void put_model(FILE *f) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    fputs("| dataset | units | meaning |\n|---|---|---|\n", f);
    for (size_t k = 0, n; k < count; k += n) {
        const sf_model_field *m = &field[k];
        component of[MOST_COMPONENTS] = {component_of(m->path, m->description)};
        fprintf(f, "| `%s`", m->path);
        for (n = 1; n < MOST_COMPONENTS && k + n < count; n++) {
            of[n] = component_of(m[n].path, m[n].description);
            if (!are_one_vector(&of[0], &of[n]) || strcmp(m->units, m[n].units) != 0)
                break;
            fprintf(f, ", `_%s`", of[n].end);
        }
        fprintf(f, " | %s | ", strcmp(m->units, "1") == 0 ? "" : m->units);
        put_components(f, of, (int)n, "");
    }
}

/* The words between bars, as a list with commas. */
static void put_words(FILE *f, const char *words) {
    for (; *words; words++)
        *words == '|' ? fputs(", ", f) : fputc(*words, f);
}

/* A value of a parameter with its unit, as people read it. */
static void put_value(FILE *f, const sf_parameter_info *i, double value) {
    fprintf(f, "%.3g%s%s", value / i->per_unit, *i->unit ? " " : "", i->unit);
}

static void put_forms(FILE *f) {
    fputs("| `curve_form` | parameters: median, standard deviation |\n|---|---|\n", f);
    for (int k = 0; k < SF_CURVE_FORMS; k++) {
        const sf_curve_form *form = sf_curve_form_get(k);
        double value[SF_PARAMETER_COUNT] = {[SF_PARAMETER_E] = 1e6, [SF_PARAMETER_SOLID_FRACTION] = 0.05};
        if (form->stress)
            form->start(value);
        fprintf(f, "| `%s` | ", form->name);
        for (int e = 0; e < form->entry_count; e++) {
            const sf_form_entry *entry = &form->entry[e];
            const sf_parameter_info *i = sf_parameter_get(entry->parameter);
            fprintf(f, "%s%s`%s`: ", e ? "; " : "", entry->usual ? "" : "(", i->name);
            form->stress ? put_value(f, i, value[entry->parameter]) : fputs("the start material's", f);
            fprintf(f, ", %g%s", entry->prior_sd, entry->usual ? "" : ")");
        }
        fputs(" |\n", f);
    }
}

/* Neighbours that differ in the last word of their meaning are one row: the bends of the spline. */
static void put_parameters(FILE *f) {
    fputs("| parameter | unit | standard deviation | meaning |\n|---|---|---|---|\n", f);
    for (int k = 0, end; k < SF_PARAMETER_COUNT; k = end) {
        const sf_parameter_info *i = sf_parameter_get((sf_foam_parameter)k);
        char meaning[256];
        size_t same = (size_t)(strrchr(i->description, ' ') + 1 - i->description);
        snprintf(meaning, sizeof meaning, "%s", i->description);
        fprintf(f, "| `%s`", i->name);
        for (end = k + 1; end < SF_PARAMETER_COUNT; end++) {
            const sf_parameter_info *next = sf_parameter_get((sf_foam_parameter)end);
            if (strncmp(next->description, i->description, same) != 0 || next->prior_sd != i->prior_sd)
                break;
            fprintf(f, ", `%s`", next->name);
            sf_text_add(meaning, sizeof meaning, ", %s", next->description + same);
        }
        fprintf(f, " | %s | %g | ", *i->unit ? i->unit : "1", i->prior_sd);
        put_meaning(f, meaning, "");
    }
}

static void put_measured(FILE *f) {
    fputs("| key | standard deviation | default | measured |\n|---|---|---|---|\n", f);
    for (int k = 0; k < SF_FIT_SAMPLES; k++) {
        const sf_drop_kind_info *i = sf_drop_kind_get(k);
        fprintf(f, "| `%s` | `%s` | %g | %s |\n", i->key, i->sd_key, i->sd, i->meaning);
    }
}

/* In each document in their order there. */
static const struct {
    const char *document, *name;
    void (*put)(FILE *f);
} tables[] = {
    {"formats", "model", put_model},
    {"formats", "history", put_history},
    {"formats", "frame fields", put_frame_fields},
    {"formats", "figures", put_figures},
    {"formats", "layer figures", put_layer_figures},
    {"formats", "good run", put_good_run},
    {"formats", "good record", put_good_record},
    {"identification", "measured numbers", put_measured},
    {"identification", "forms", put_forms},
    {"identification", "parameters", put_parameters},
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

/* The text of a document with what the lists say between its markers; free it. */
static char *bring_up_to_date(const char *document, const char *text) {
    char *updated = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&updated, &size);
    const char *rest = text;
    for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++) {
        char marker[64];
        if (strcmp(tables[k].document, document) != 0)
            continue;
        snprintf(marker, sizeof marker, "<!-- generated: %s -->\n", tables[k].name);
        const char *begin = strstr(rest, marker), *end = begin ? strstr(begin, "<!-- end -->") : NULL;
        if (!end)
            fail_msg("docs/%s.md: \"%s\" is missing, has no end or is out of order", document,
                     tables[k].name);
        begin += strlen(marker);
        fwrite(rest, 1, (size_t)(begin - rest), out);
        tables[k].put(out);
        rest = end;
    }
    fputs(rest, out);
    fclose(out);
    return updated;
}

static void check_document(const char *document) {
    const char *root = getenv("SF_SOURCE_DIR");
    char path[4096];
    assert_non_null(root);
    snprintf(path, sizeof path, "%s/docs/%s.md", root, document);
    char *text = read_text(path), *expected = bring_up_to_date(document, text);
    bool same = strcmp(text, expected) == 0;
    if (!same && getenv("SF_WRITE_DOCS")) {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        assert_int_not_equal(fputs(expected, file), EOF);
        assert_int_equal(fclose(file), 0);
        same = true;
    }
    free(text);
    free(expected);
    if (!same)
        fail_msg("%s is not up to date: run test_formats with SF_WRITE_DOCS=1 in its environment", path);
}

static void formats_has_the_tables_of_the_program(void **state) {
    (void)state;
    check_document("formats");
}

static void identification_has_the_tables_of_the_program(void **state) {
    (void)state;
    check_document("identification");
}

/* The key `curve_form` of both commands lists every form. */
static void the_forms_are_named_where_the_key_is(void **state) {
    char path[4096], *words = NULL;
    size_t size = 0;
    (void)state;
    FILE *f = open_memstream(&words, &size);
    put_words(f, sf_curve_form_words());
    fclose(f);
    *strstr(words, ", table") = '\0'; /* of drops only: it has a start material */
    snprintf(path, sizeof path, "%s/docs/identification.md", getenv("SF_SOURCE_DIR"));
    char *text = read_text(path);
    if (!strstr(text, words))
        fail_msg("docs/identification.md does not list the forms \"%s\"", words);
    free(text);
    free(words);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(formats_has_the_tables_of_the_program),
                                       cmocka_unit_test(identification_has_the_tables_of_the_program),
                                       cmocka_unit_test(the_forms_are_named_where_the_key_is)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
