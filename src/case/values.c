/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/values.h"

#include "case/keys.h"

#include "material/laws.h"

static void print_text(FILE *file, const char *text) {
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fputc('\\', file);
        if (*text == '\n')
            fputs("\\n", file);
        else
            fputc(*text, file);
    }
    fputc('"', file);
}

void sf_case_print_setting(FILE *file, const config_setting_t *setting) {
    int type = config_setting_type(setting);
    switch (type) {
    case CONFIG_TYPE_INT:
        fprintf(file, "%d", config_setting_get_int(setting));
        return;
    case CONFIG_TYPE_INT64:
        fprintf(file, "%lld", config_setting_get_int64(setting));
        return;
    case CONFIG_TYPE_FLOAT:
        fprintf(file, "%.12g", config_setting_get_float(setting));
        return;
    case CONFIG_TYPE_BOOL:
        fputs(config_setting_get_bool(setting) ? "true" : "false", file);
        return;
    case CONFIG_TYPE_STRING:
        print_text(file, config_setting_get_string(setting));
        return;
    default:
        break;
    }
    bool group = type == CONFIG_TYPE_GROUP;
    const char *brackets[2] = {"(", ")"};
    if (group) {
        brackets[0] = "{ ";
        brackets[1] = "}";
    } else if (type == CONFIG_TYPE_ARRAY) {
        brackets[0] = "[";
        brackets[1] = "]";
    }
    fputs(brackets[0], file);
    for (int i = 0; i < config_setting_length(setting); i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        if (group)
            fprintf(file, "%s = ", config_setting_name(item));
        else if (i > 0)
            fputs(", ", file);
        sf_case_print_setting(file, item);
        if (group)
            fputs("; ", file);
    }
    fputs(brackets[1], file);
}

/* Prints how a value of the key is written. */
static void print_kind(FILE *file, const sf_key *key) {
    static const char *const phrase[] = {
        [SF_KEY_UNIT] = "unit of length",
        [SF_KEY_NUMBER] = "number",
        [SF_KEY_BOOL] = "true or false",
        [SF_KEY_NAME] = "name",
        [SF_KEY_NAMES] = "array of names",
        [SF_KEY_TIMES] = "array of times",
        [SF_KEY_VECTOR] = "three numbers",
        [SF_KEY_PLACE] = "array of two lengths",
        [SF_KEY_QUANTITIES] = "array",
        [SF_KEY_PATH] = "file",
        [SF_KEY_PARAMETERS] = "group of numbers",
        [SF_KEY_CURVE] = "file",
        [SF_KEY_MOTION] = "file",
        [SF_KEY_DROPS] = "number or list",
        [SF_KEY_COUNTED] = "array of numbers",
        [SF_KEY_CURVES] = "list of { rate or temperature; file; }",
    };
    if (key->kind == SF_KEY_LAW) {
        for (int k = 0; sf_law_get(k); k++)
            fprintf(file, "%s%s", k ? ", " : "", sf_law_get(k)->name);
        return;
    }
    if (key->kind == SF_KEY_CHOICE || key->kind == SF_KEY_FIELDS) {
        fputs(key->kind == SF_KEY_FIELDS ? "array of " : "", file);
        for (const char *w = key->words; *w; w++)
            *w == '|' ? fputs(", ", file) : fputc(*w, file);
        return;
    }
    if (key->kind == SF_KEY_QUANTITY) {
        fprintf(file, "%s", sf_quantity_phrase(key->quantity));
        if (key->words)
            fprintf(file, " or \"%s\"", key->words);
    } else {
        fputs(phrase[key->kind], file);
    }
    if (key->kind == SF_KEY_QUANTITIES) {
        fprintf(file, " of %d", key->lengths[0]);
        if (key->lengths[1])
            fprintf(file, " or %d", key->lengths[1]);
        fprintf(file, ", each %s", sf_quantity_phrase(key->quantity));
    }
    bool bounded = key->kind == SF_KEY_QUANTITY || key->kind == SF_KEY_NUMBER || key->kind == SF_KEY_DROPS;
    if (!bounded)
        return;
    fprintf(file, ", %s %g", key->low_open ? "above" : "from", key->low);
    if (key->high != 0.0)
        fprintf(file, " to %g%s%s", key->high, key->kind == SF_KEY_QUANTITY ? " " : "",
                key->kind == SF_KEY_QUANTITY ? sf_quantity_unit(key->quantity) : "");
}

static void print_row(FILE *file, const sf_key *key) {
    fprintf(file, "| `%s` | ", key->name);
    print_kind(file, key);
    if (!key->fallback)
        fputs(" | required", file);
    else if (key->kind == SF_KEY_LAW)
        fprintf(file, " | `\"%s\"`", sf_law_get(0)->name);
    else if (!*key->fallback)
        fputs(" | absent", file);
    else if (key->kind == SF_KEY_FIELDS)
        fputs(" | all", file);
    else
        fprintf(file, " | `%s`", key->fallback);
    fprintf(file, " | %s |\n", key->description);
}

/* True if both keys are written, bounded and explained alike; their groups may differ. */
static bool are_alike(const sf_key *a, const sf_key *b) {
    return strcmp(a->name, b->name) == 0 && strcmp(a->description, b->description) == 0 &&
           a->kind == b->kind && a->low == b->low && a->high == b->high &&
           strcmp(a->fallback ? a->fallback : "", b->fallback ? b->fallback : "") == 0;
}

/* True if `list` has a key of the same group like this one. */
static bool has_key(const sf_key_list *list, const sf_key *key) {
    const sf_key *other = sf_case_find_key(list, key->group, key->name);
    return other && are_alike(other, key);
}

/* Prints the keys of the group with the number `first` and on that `other` has not. */
static void print_group(FILE *file, const sf_key_list *list, size_t first, const sf_key_list *other,
                        const char *law) {
    const char *group = list->key[first].group;
    fprintf(file, "### %s%s%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n", group,
            law ? " of law " : "", law ? law : "");
    for (size_t k = first; k < list->count; k++)
        if (strcmp(list->key[k].group, group) == 0 && (!other || !has_key(other, &list->key[k])))
            print_row(file, &list->key[k]);
    fputs("\n", file);
}

/* True if an earlier key that is printed has the same group. */
static bool is_printed(const sf_key_list *list, size_t k, const sf_key_list *other) {
    for (size_t j = 0; j < k; j++)
        if (strcmp(list->key[j].group, list->key[k].group) == 0 && (!other || !has_key(other, &list->key[j])))
            return true;
    return false;
}

/* True if the keys of the group that begins at k are those of the group before it. */
static bool repeats_group(const sf_key_list *list, size_t k) {
    size_t n = 0;
    while (k + n < list->count && strcmp(list->key[k + n].group, list->key[k].group) == 0)
        n++;
    for (size_t i = 0; i < n; i++)
        if (k < n || !are_alike(&list->key[k + i], &list->key[k - n + i]))
            return false;
    return true;
}

/* `other`: of a law that is not the default, the keys of the default, which are named only; else NULL. */
static void print_list(FILE *file, const sf_key_list *list, const sf_key_list *other, const char *law) {
    const char *between = "";
    if (other)
        fprintf(file, "The law %s has these keys of the other law, too:", law);
    for (size_t k = 0; other && k < list->count; k++)
        if (list->key[k].in_card && has_key(other, &list->key[k])) {
            fprintf(file, "%s `%s.%s`", between, list->key[k].group, list->key[k].name);
            between = ",";
        }
    fputs(other ? ".\n\n" : "", file);
    for (size_t k = 0; k < list->count; k++) {
        if ((other && (!list->key[k].in_card || has_key(other, &list->key[k]))) || is_printed(list, k, other))
            continue;
        if (repeats_group(list, k))
            fprintf(file, "`%s` has the keys of the group before it.\n\n", list->key[k].group);
        else
            print_group(file, list, k, other, law);
    }
}

void sf_case_print_keys(FILE *file) {
    sf_key_list usual, list;
    sf_case_list_keys(sf_law_get(0), &usual);
    print_list(file, &usual, NULL, NULL);
    for (int k = 1; sf_law_get(k); k++) {
        sf_case_list_keys(sf_law_get(k), &list);
        print_list(file, &list, &usual, sf_law_get(k)->name);
    }
    fputs("### Units\n\n", file);
    sf_unit_text_print(file);
}

/* The key "group.name" of that length; NULL if there is none. */
static const sf_key *key_at(const sf_key_list *list, const char *path, size_t length) {
    SF_PRINTED(group, SF_KEY_GROUP_SIZE, "%.*s", (int)length, path);
    char *dot = strrchr(group, '.');
    if (!dot)
        return NULL;
    *dot = '\0';
    return sf_case_find_key(list, group, dot + 1);
}

bool sf_case_key_is_file(const char *path) {
    sf_key_list list;
    const char *layer = strncmp(path, "materials.", 10) == 0 ? strchr(path + 10, '.') : NULL;
    if (strncmp(path, "supports.", 9) == 0)
        return strcmp(strrchr(path, '.'), ".file") == 0;
    SF_PRINTED(text, SF_KEY_GROUP_SIZE, "%s%s", layer ? "material" : "", layer ? layer : path);
    size_t length = strlen(text), entry = length > 5 && strcmp(text + length - 5, ".file") == 0 ? 5 : 0;
    for (int law = 0; sf_law_get(law); law++) {
        sf_case_list_keys(sf_law_get(law), &list);
        const sf_key *key = key_at(&list, text, length), *of_list = key_at(&list, text, length - entry);
        if ((key && (key->kind == SF_KEY_PATH || key->kind == SF_KEY_CURVE || key->kind == SF_KEY_MOTION)) ||
            (entry && of_list && of_list->kind == SF_KEY_CURVES))
            return true;
    }
    return false;
}
