/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/session.h"

#include <ctype.h>

#include "base/text.h"
#include "case/read.h"
#include "io/plain_file.h"
#include "pre/mesh/geo_parameters.h"

enum { LARGEST = 1 << 22, DEEPEST = 8 };

static bool is(const sf_geo_token *t, const char *text) {
    return t->kind != SF_GEO_TEXT && sf_geo_token_is(*t, text);
}

static void add_name(sf_geo_names *names, const sf_geo_token *variable, const sf_geo_token *name) {
    sf_geo_name *out = &names->name[names->count];
    if (names->count == SF_GEO_NAMES || variable->length >= sizeof out->variable ||
        name->length >= sizeof out->name)
        return;
    snprintf(out->variable, sizeof out->variable, "%.*s", (int)variable->length, variable->begin);
    snprintf(out->name, sizeof out->name, "%.*s", (int)name->length, name->begin);
    names->count++;
}

/* A variable is what stands before "= {" or "= DefineNumber"; its name is the string after the word Name. */
void sf_geo_names_scan(const char *text, sf_geo_names *names) {
    sf_geo_token before = {SF_GEO_MARK, text, 0}, last = before, variable = before;
    for (sf_geo_token t = sf_geo_token_next(&text); t.kind != SF_GEO_END; t = sf_geo_token_next(&text)) {
        if (is(&last, "=") && before.kind == SF_GEO_WORD && (is(&t, "{") || is(&t, "DefineNumber")))
            variable = before;
        if (is(&last, "Name") && t.kind == SF_GEO_TEXT && variable.length > 0) {
            add_name(names, &variable, &t);
            variable.length = 0;
        }
        before = last;
        last = t;
    }
}

static sf_status read_depth(const char *path, sf_geo_names *names, int depth, sf_error *err);

/* The files that the text includes, where they are there; gmsh tells of those that are not. */
static void read_included(const char *path, const char *text, sf_geo_names *names, int depth) {
    sf_geo_token last = {SF_GEO_MARK, text, 0};
    int above = (int)(sf_path_name(path) - path);
    for (sf_geo_token t = sf_geo_token_next(&text); t.kind != SF_GEO_END; t = sf_geo_token_next(&text)) {
        char included[PATH_MAX];
        int folder = t.kind == SF_GEO_TEXT && t.begin[0] != '/' ? above : 0;
        if (is(&last, "Include") && t.kind == SF_GEO_TEXT && depth < DEEPEST &&
            snprintf(included, sizeof included, "%.*s%.*s", folder, path, (int)t.length, t.begin) <
                (int)sizeof included)
            read_depth(included, names, depth + 1, SF_IGNORED);
        last = t;
    }
}

static sf_status read_depth(const char *path, sf_geo_names *names, int depth, sf_error *err) {
    SF_OWNED char *text = NULL;
    SF_TRY(sf_plain_read(path, "geometry", LARGEST, &text, NULL, err));
    sf_geo_names_scan(text, names);
    read_included(path, text, names, depth);
    return SF_OK;
}

sf_status sf_geo_names_read(const char *path, sf_geo_names *names, sf_error *err) {
    const char *dot = strrchr(path, '.');
    names->count = 0;
    if (!dot || strcmp(dot, ".geo") != 0)
        return sf_plain_check(path, "geometry", err);
    return read_depth(path, names, 0, err);
}

static const char WRONG[] = "LightCoral";

/* The branches of the tree, in its order; the groups of the case that are not here (geometry) have none. */
static const struct {
    const char *group, *branch;
    bool closed;
} branches[] = {
    {"missile", "2Case/2missile", false}, {"solver", "2Case/3solver", true},
    {"output", "2Case/4output", true},    {"pad", "2Case/5pad", true},
    {"kernel", "2Case/6kernel", true},
};

static int find_branch(const char *group) {
    for (size_t k = 0; k < sizeof branches / sizeof branches[0]; k++)
        if (strcmp(branches[k].group, group) == 0)
            return (int)k;
    return -1;
}

sf_field *sf_fields_find(const sf_fields *fields, const char *key) {
    for (int k = 0; k < fields->count; k++)
        if (strcmp(fields->field[k].key, key) == 0)
            return (sf_field *)&fields->field[k];
    return NULL;
}

/* ---- from the table of keys ---- */

static const sf_entry_kind entry_kinds[] = {
    [SF_CASE_VALUE_TEXT] = SF_ENTRY_TEXT,   [SF_CASE_VALUE_LIST] = SF_ENTRY_TEXT,
    [SF_CASE_VALUE_NUMBER] = SF_ENTRY_TEXT, [SF_CASE_VALUE_FLAG] = SF_ENTRY_FLAG,
    [SF_CASE_VALUE_WORD] = SF_ENTRY_WORD,   [SF_CASE_VALUE_FILE] = SF_ENTRY_FILE,
};

static sf_field *add(sf_fields *fields) {
    if (fields->count == SF_FIELDS)
        return NULL;
    sf_field *f = &fields->field[fields->count++];
    *f = (sf_field){.kind = SF_ENTRY_TEXT};
    return f;
}

static void hear(void *user, const sf_case_value *value) {
    sf_fields *fields = user;
    int branch = find_branch(value->group);
    if (branch < 0 || value->of_material || value->kind == SF_CASE_VALUE_OTHER)
        return;
    sf_field *f = add(fields);
    if (!f)
        return;
    f->kind = entry_kinds[value->kind];
    f->words = value->words;
    f->help = value->help;
    snprintf(f->key, sizeof f->key, "%s.%s", value->group, value->name);
    snprintf(f->name, sizeof f->name, "%s/%02d%s", branches[branch].branch, fields->count, value->name);
    snprintf(f->given, sizeof f->given, "%s", value->text);
    memcpy(f->now, f->given, sizeof f->now);
}

/* The material is a group: a file may stand in its place. */
static void add_material(sf_fields *fields) {
    sf_field *f = add(fields);
    if (!f)
        return;
    f->kind = SF_ENTRY_FILE;
    f->help =
        "file with the keys of a material, in place of the group material of the case; empty: that of the case";
    snprintf(f->key, sizeof f->key, "material");
    snprintf(f->name, sizeof f->name, "2Case/1material");
}

/* Keeps the changes that the user has made. */
static void keep_changes(const sf_fields *before, sf_fields *fields) {
    for (int k = 0; k < fields->count; k++) {
        sf_field *f = &fields->field[k];
        const sf_field *old = sf_fields_find(before, f->key);
        if (old && strcmp(old->now, old->given) != 0)
            memcpy(f->now, old->now, sizeof f->now);
    }
}

sf_status sf_fields_read(const char *case_path, const sf_fields *before, sf_fields *fields, sf_case *out,
                         sf_error *err) {
    const sf_case_listener listener = {hear, fields};
    fields->count = 0;
    SF_TRY(sf_case_read_values(&(sf_case_input){.path = case_path, .drop = 1}, NULL, &listener, out, err));
    if (out->layer_count == 0)
        add_material(fields);
    keep_changes(before, fields);
    return SF_OK;
}

/* ---- of geometries ---- */

static const sf_geo_parameter *find_parameter(const sf_geo_source *source, const char *variable) {
    for (int k = 0; k < source->parameter_count; k++)
        if (strcmp(source->parameter[k].name, variable) == 0)
            return &source->parameter[k];
    return NULL;
}

void sf_fields_add_geometry(const char *group, const sf_geo_names *names, const sf_geo_source *source,
                            const sf_fields *before, sf_fields *fields) {
    for (int k = 0; k < names->count; k++) {
        const sf_geo_parameter *p = find_parameter(source, names->name[k].variable);
        sf_field *f = add(fields);
        if (!f)
            return;
        f->kind = SF_ENTRY_NUMBER;
        f->of_geometry = true;
        f->in_case = p != NULL;
        snprintf(f->key, sizeof f->key, "%s.%s", group, names->name[k].variable);
        snprintf(f->name, sizeof f->name, "%s", names->name[k].name);
        if (p)
            snprintf(f->given, sizeof f->given, "%.12g", p->value);
        memcpy(f->now, f->given, sizeof f->now);
    }
    keep_changes(before, fields);
}

void sf_fields_take_defaults(sf_fields *fields) {
    for (int k = 0; k < fields->count; k++) {
        sf_field *f = &fields->field[k];
        double value;
        if (!f->of_geometry || *f->now || !sf_window_number(f->name, &value))
            continue;
        snprintf(f->given, sizeof f->given, "%.12g", value);
        memcpy(f->now, f->given, sizeof f->now);
    }
}

/* ---- the tree ---- */

static void show(const sf_field *f) {
    const char *dot = strchr(f->key, '.');
    SF_PRINTED(group, SF_FIELD_KEY_SIZE, "%.*s", dot ? (int)(dot - f->key) : 0, f->key);
    int branch = find_branch(group);
    if (f->of_geometry) {
        if (*f->now)
            sf_window_set_number(f->name, strtod(f->now, NULL));
        else
            sf_window_remove(f->name); /* the geometry's own default, which may have changed */
        return;
    }
    const sf_entry entry = {.name = f->name,
                            .kind = f->kind,
                            .text = f->now,
                            .number = f->kind == SF_ENTRY_WORD ? fmax(sf_word_find(f->words, f->now), 0)
                                                               : strcmp(f->now, "true") == 0,
                            .words = f->words,
                            .help = f->help,
                            .colour = f->wrong ? WRONG : NULL,
                            .closed = branch >= 0 && branches[branch].closed};
    sf_window_put(&entry);
}

void sf_fields_show(const sf_fields *fields) {
    for (int k = 0; k < fields->count; k++)
        show(&fields->field[k]);
}

/* The value as the tree has it now. */
static bool read_field(const sf_field *f, char *text, size_t size) {
    double value = 0;
    int length;
    if (f->kind == SF_ENTRY_TEXT || f->kind == SF_ENTRY_FILE)
        return sf_window_text(f->name, text, size);
    if (!sf_window_number(f->name, &value))
        return false;
    if (f->kind == SF_ENTRY_WORD) {
        const char *word = sf_word_at(f->words, (int)lround(value), &length);
        snprintf(text, size, "%.*s", length, word);
    } else if (f->kind == SF_ENTRY_FLAG)
        snprintf(text, size, "%s", value != 0 ? "true" : "false");
    else
        snprintf(text, size, "%.12g", value);
    return true;
}

void sf_fields_take(sf_fields *fields, bool *case_changed, bool *geometry_changed) {
    *case_changed = *geometry_changed = false;
    for (int k = 0; k < fields->count; k++) {
        sf_field *f = &fields->field[k];
        char text[SF_FIELD_TEXT_SIZE];
        if (!read_field(f, text, sizeof text) || strcmp(text, f->now) == 0)
            continue;
        memcpy(f->now, text, sizeof text);
        *(f->of_geometry ? geometry_changed : case_changed) = true;
    }
}

bool sf_fields_enter(const sf_fields *fields, const char *key, const char *text) {
    const sf_field *f = sf_fields_find(fields, key);
    if (!f)
        return false;
    sf_field entered = *f; /* sf_fields_take notices the change, as of a user's */
    snprintf(entered.now, sizeof entered.now, "%s", text);
    show(&entered);
    return true;
}

/* ---- overrides ---- */

static bool is_same_group(const sf_field *f, const sf_field *g) {
    return strncmp(f->key, g->key, (size_t)(strrchr(f->key, '.') + 1 - f->key)) == 0;
}

/* One entry of the tree can stand for two parameters only if the case gives both the same value: else one of
 * them would be run with the value of the other. */
static sf_status check_names(const sf_fields *fields, sf_error *err) {
    for (int k = 0; k < fields->count; k++)
        for (int j = 0; j < k && fields->field[k].of_geometry; j++) {
            const sf_field *f = &fields->field[k], *g = &fields->field[j];
            bool same = f->in_case && g->in_case && strcmp(f->given, g->given) == 0;
            if (g->of_geometry && !same && strcmp(f->name, g->name) == 0 && !is_same_group(f, g))
                return SF_REFUSE(err,
                                 "%s and %s have one Name, \"%s\": the window cannot tell them apart; give "
                                 "them different ones in the geometry files, or one value in the case",
                                 g->key, f->key, f->name);
        }
    return SF_OK;
}

sf_status sf_fields_overrides(const sf_fields *fields, sf_overrides *out, sf_error *err) {
    *out = (sf_overrides){0};
    SF_TRY(check_names(fields, err));
    for (int k = 0; k < fields->count; k++) {
        const sf_field *f = &fields->field[k];
        if (strcmp(f->now, f->given) == 0)
            continue;
        if (out->count == SF_FIELD_OVERRIDES)
            return SF_REFUSE(err, "more than %d values differ from the case: save it, and go on from there",
                             SF_FIELD_OVERRIDES);
        if (asprintf(&out->text[out->count], "%s=%s%s", f->key, strcmp(f->key, "material") == 0 ? "@" : "",
                     f->now) < 0)
            return SF_NO_MEMORY(err, "the values of the window");
        out->count++;
    }
    return SF_OK;
}

void sf_overrides_free(sf_overrides *o) {
    sf_free_all((size_t)o->count, o->text);
    *o = (sf_overrides){0};
}

static bool is_of_word(int c) {
    return isalnum(c) || c == '_';
}

/* Returns the place at which the sentence has the word by itself; NULL: there is none. */
static const char *find_word_in(const char *sentence, const char *word) {
    size_t length = strlen(word);
    for (const char *at = sentence; (at = strstr(at, word)) != NULL; at += length)
        if ((at == sentence || !is_of_word((unsigned char)at[-1])) && !is_of_word((unsigned char)at[length]))
            return at;
    return NULL;
}

/* Finds the key of the material in the sentence, if a file of the window stands in the material's place. */
static const char *find_key_in(const sf_field *f, const char *sentence) {
    bool plain = strchr(f->key, '.') == NULL;
    return plain && strcmp(f->now, f->given) == 0 ? NULL : find_word_in(sentence, f->key);
}

/* The key that the sentence names first: further ones only explain. */
static const char *find_first_key(const sf_fields *fields, const char *sentence) {
    const char *first = NULL;
    for (int k = 0; k < fields->count; k++) {
        const char *at = find_key_in(&fields->field[k], sentence);
        if (at && (!first || at < first))
            first = at;
    }
    return first;
}

/* A geometry's own checks name its variables. */
static bool is_named(const sf_field *f, const char *sentence, const char *first) {
    const char *dot = strrchr(f->key, '.');
    return first ? find_key_in(f, sentence) == first : f->of_geometry && find_word_in(sentence, dot + 1);
}

void sf_fields_mark(sf_fields *fields, const char *sentence) {
    const char *first = sentence ? find_first_key(fields, sentence) : NULL;
    for (int k = 0; k < fields->count; k++) {
        sf_field *f = &fields->field[k];
        bool wrong = sentence && is_named(f, sentence, first);
        if (wrong == f->wrong)
            continue;
        f->wrong = wrong;
        if (f->of_geometry)
            sf_window_colour_number(f->name, wrong ? WRONG : NULL);
        else
            show(f);
    }
}

static void lock_unknown(void *user, const char *name) {
    static const char *const ours[] = {"ONELAB", "0Modules/", "Gmsh/", "1Drop/", "2Case/", "3Checks/"};
    const sf_fields *fields = user;
    for (size_t k = 0; k < sizeof ours / sizeof ours[0]; k++)
        if (strncmp(name, ours[k], strlen(ours[k])) == 0)
            return;
    for (int k = 0; k < fields->count; k++)
        if (strcmp(fields->field[k].name, name) == 0)
            return;
    sf_window_lock_number(name);
}

void sf_fields_lock_unknown(sf_fields *fields) {
    sf_window_visit_numbers(lock_unknown, fields);
}
