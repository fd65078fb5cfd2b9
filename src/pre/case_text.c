/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts about a case: the file with its includes in place, values in libconfig syntax, the list of keys. */
#include "pre/case_keys.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { INCLUDE_DEPTH = 10 }; /* as libconfig's own limit */

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

/* The file name of a line `@include "name"`, in place; NULL for any other line. */
static char *include_name(char *line) {
    char *text = line + strspn(line, " \t");
    if (strncmp(text, "@include", 8) != 0)
        return NULL;
    text += 8 + strspn(text + 8, " \t");
    char *end = *text == '"' ? strchr(text + 1, '"') : NULL;
    if (!end)
        return NULL;
    *end = '\0';
    return text + 1;
}

static sf_status copy_text(const char *path, const char *from, int line, const char *folder, int depth,
                           FILE *out, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE] = "";
    if (from)
        snprintf(where, sizeof where, "%s:%d: ", from, line);
    struct stat info;
    if (depth > INCLUDE_DEPTH)
        return SF_FAIL(err, SF_ERR_INPUT, "%s@include is nested more than %d deep", where, INCLUDE_DEPTH);
    if (stat(path, &info) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s cannot be read: %s", where, path,
                       strerror(errno));
    if (!S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s is not a plain file", where, path);
    FILE *in = fopen(path, "r");
    if (!in)
        return SF_FAIL(err, SF_ERR_INPUT, "%sthe case file %s cannot be read: %s", where, path,
                       strerror(errno));
    char *text = NULL, *copy = NULL;
    size_t size = 0;
    ssize_t length;
    sf_status status = SF_OK;
    for (int number = 1; status == SF_OK && (length = getline(&text, &size, in)) >= 0; number++) {
        if (strlen(text) != (size_t)length) {
            status = SF_FAIL(err, SF_ERR_INPUT, "%s%s:%d: a zero byte: this is not a text file", where, path,
                             number);
            break;
        }
        copy = strdup(text);
        char *name = copy ? include_name(copy) : NULL;
        char *included = NULL;
        if (!copy || (name && asprintf(&included, "%s/%s", folder, name) < 0)) {
            included = NULL;
            status = SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
        } else if (name) {
            fprintf(out, "# from %s:\n", name);
            status = copy_text(included, path, number, folder, depth + 1, out, err);
        } else {
            fputs(text, out);
            if (text[length - 1] != '\n')
                fputc('\n', out);
        }
        free(included);
        free(copy);
    }
    free(text);
    fclose(in);
    return status;
}

/* A file that stands in place of a group, each line as a comment. */
static sf_status copy_as_comment(const char *path, FILE *out, sf_error *err) {
    char *folder = sf_case_folder_of(path, err);
    char *text = folder ? sf_case_load_text(path, folder, 0, NULL, err) : NULL, *rest = text;
    for (char *line = strsep(&rest, "\n"); line && (rest || *line); line = strsep(&rest, "\n"))
        fprintf(out, "#     %s\n", line);
    free(text);
    free(folder);
    return err->status;
}

char *sf_case_load_text(const char *path, const char *folder, int count, const char *const *overrides,
                        sf_error *err) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
        return NULL;
    }
    sf_status status = copy_text(path, NULL, 0, folder, 0, out, err);
    for (int i = 0; i < count && status == SF_OK; i++) {
        const char *file = sf_case_override_file(overrides[i]);
        fprintf(out, "# --set %s\n", overrides[i]);
        if (file)
            status = copy_as_comment(file, out, err);
    }
    if (fclose(out) != 0 && status == SF_OK)
        status = SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the case file %s", path);
    if (status != SF_OK) {
        free(text);
        return NULL;
    }
    return text;
}

/* How a value of the key is written. */
static void print_kind(FILE *file, const sf_key *key) {
    static const char *const phrase[] = {
        [SF_KEY_UNIT] = "unit of length",
        [SF_KEY_NUMBER] = "number",
        [SF_KEY_BOOL] = "true or false",
        [SF_KEY_NAME] = "name",
        [SF_KEY_NAMES] = "array of names",
        [SF_KEY_TIMES] = "array of times",
        [SF_KEY_VECTOR] = "three numbers",
        [SF_KEY_PATH] = "file",
        [SF_KEY_PARAMETERS] = "group of numbers",
        [SF_KEY_CURVE] = "file",
        [SF_KEY_MOTION] = "file",
        [SF_KEY_CURVES] = "list of { rate; file; }",
    };
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
    bool bounded = key->kind == SF_KEY_QUANTITY || key->kind == SF_KEY_NUMBER;
    if (!bounded)
        return;
    fprintf(file, ", %s %g", key->low_open ? "above" : "from", key->low);
    if (key->high != 0.0)
        fprintf(file, " to %g%s%s", key->high, key->kind == SF_KEY_QUANTITY ? " " : "",
                key->kind == SF_KEY_QUANTITY ? sf_quantity_unit(key->quantity) : "");
}

void sf_case_print_keys(FILE *file) {
    size_t count;
    const sf_key *keys = sf_case_keys(&count);
    const char *group = "";
    for (size_t k = 0; k < count; k++) {
        const sf_key *key = &keys[k];
        if (strcmp(group, key->group) != 0) {
            group = key->group;
            fprintf(file, "%s### %s\n\n| key | value | default | meaning |\n|---|---|---|---|\n",
                    k ? "\n" : "", group);
        }
        fprintf(file, "| `%s` | ", key->name);
        print_kind(file, key);
        if (!key->fallback)
            fputs(" | required", file);
        else if (!*key->fallback)
            fputs(" | absent", file);
        else if (key->kind == SF_KEY_FIELDS)
            fputs(" | all", file);
        else
            fprintf(file, " | `%s`", key->fallback);
        fprintf(file, " | %s |\n", key->description);
    }
}
