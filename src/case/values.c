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
    fputs(group ? "{ " : type == CONFIG_TYPE_ARRAY ? "[" : "(", file);
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
    fputs(group ? "}" : type == CONFIG_TYPE_ARRAY ? "]" : ")", file);
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

/* `law`: of a law that is not the default, only the keys that it adds; else NULL. */
static void print_list(FILE *file, const sf_key_list *list, const char *law) {
    const char *group = "";
    for (size_t k = 0; k < list->count; k++) {
        const sf_key *key = &list->key[k];
        if (law && !key->in_card)
            continue;
        if (strcmp(group, key->group) != 0) {
            group = key->group;
            fprintf(file, "%s### %s%s%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n",
                    k ? "\n" : "", group, law ? " of law " : "", law ? law : "");
        }
        print_row(file, key);
    }
}

void sf_case_print_keys(FILE *file) {
    sf_key_list list;
    for (int k = 0; sf_law_get(k); k++) {
        sf_case_list_keys(sf_law_get(k), &list);
        print_list(file, &list, k ? sf_law_get(k)->name : NULL);
    }
    fputs("\n### Units\n\n", file);
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
