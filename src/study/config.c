/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/config.h"

#include "base/text.h"
#include "io/plain_file.h"
#include <math.h>
#include <string.h>

/* Writes "file:line" of the setting, or "file" of NULL. */
static void print_place(const sf_config *config, const config_setting_t *setting, char *text, size_t size) {
    int line = setting ? (int)config_setting_source_line(setting) : 0;
    const char *path = line > 0 ? sf_case_source_find(&config->source, line, &line) : config->path;
    int length = snprintf(text, size, "%.480s", path);
    if (line > 0)
        snprintf(text + length, size - (size_t)length, ":%d", line);
}

sf_status sf_config_refuse(const sf_config *config, const config_setting_t *setting, sf_error *err,
                           const char *format, ...) {
    char sentence[768], place[512];
    SF_PRINT_INTO(sentence, format);
    print_place(config, setting, place, sizeof place);
    return SF_REFUSE(err, "%s: %s", place, sentence);
}

sf_status sf_config_open(const char *path, sf_config *config, sf_error *err) {
    *config = (sf_config){.path = path};
    config_init(&config->config);
    config->folder = sf_case_folder_of(path, err);
    SF_OWNED char *text =
        config->folder ? sf_case_load_text(path, false, 0, NULL, &config->source, err) : NULL;
    if (text && !config_read_string(&config->config, text)) {
        int line = 0;
        const char *file = sf_case_source_find(&config->source, config_error_line(&config->config), &line);
        SF_REFUSE(err, "%s:%d: %s", file, line,
                  sf_case_syntax_phrase(config_error_text(&config->config), text,
                                        config_error_line(&config->config)));
    }
    return err->status == SF_OK ? sf_units_open(&config->units, err) : err->status;
}

void sf_config_close(sf_config *config) {
    sf_units_close(&config->units);
    config_destroy(&config->config);
    sf_case_source_free(&config->source);
    SF_CLEAR(config, config->folder);
}

/* "one, two, three" */
static void list_words(const char *words, char *out, size_t size) {
    *out = '\0';
    for (int length; *words; words += length + (words[length] == '|')) {
        length = (int)strcspn(words, "|");
        sf_text_add(out, size, "%s%.*s", *out ? ", " : "", length, words);
    }
}

/* The command that does what a key of tables did before, "" of other keys. */
static const char *successor(const config_setting_t *group, const config_setting_t *item, char *text,
                             size_t size) {
    static const char keys[] = "specimen_number|heading|curve_heading|curve_scale|curve_rate",
                      options[] = "specimen|heading|heading|scale|rate";
    int place = sf_word_find(keys, config_setting_name(item)), length = 0;
    const char *file = NULL, *value = config_setting_get_string(item);
    *text = '\0';
    if (place < 0 || (!config_setting_lookup_string(group, "file", &file) &&
                      !config_setting_lookup_string(group, "curve", &file)))
        return text;
    const char *option = sf_word_at(options, place, &length);
    snprintf(text, size, "; in its place: softfall read \"%.300s\" --%.*s \"%.100s\" -o clean.csv", file,
             length, option, value ? value : "...");
    return text;
}

sf_status sf_config_names(const sf_config *config, const config_setting_t *group, const char *names,
                          sf_error *err) {
    enum { NAMED = 10 };
    const config_setting_t *first = NULL;
    char list[512], others[400] = "", more[32] = "";
    int unknown = 0;
    for (int k = 0; k < config_setting_length(group); k++) {
        const config_setting_t *item = config_setting_get_elem(group, (unsigned)k);
        if (sf_word_find(names, config_setting_name(item)) >= 0)
            continue;
        if (unknown++ == 0)
            first = item;
        else if (unknown <= NAMED)
            sf_text_add(others, sizeof others, "%s%.24s",
                        *others ? ", " : "; unknown too: ", config_setting_name(item));
    }
    if (unknown == 0)
        return SF_OK;
    list_words(names, list, sizeof list);
    if (unknown > NAMED)
        snprintf(more, sizeof more, " and %d more", unknown - NAMED);
    char command[480];
    return sf_config_refuse(config, first, err, "unknown key \"%.80s\"%s%s; the keys here are %s%s",
                            config_setting_name(first), others, more, list,
                            successor(group, first, command, sizeof command));
}

/* The setting; records the failure if a required one is missing. */
static const config_setting_t *find(const sf_config *config, const config_setting_t *group, const char *name,
                                    bool required, sf_error *err) {
    const config_setting_t *setting = config_setting_get_member(group, name);
    if (!setting && required)
        sf_config_refuse(config, group, err, "%s is missing", name);
    return setting;
}

static bool is_number(const config_setting_t *s, double *out) {
    switch (config_setting_type(s)) {
    case CONFIG_TYPE_FLOAT:
        *out = config_setting_get_float(s);
        return true;
    case CONFIG_TYPE_INT:
        *out = config_setting_get_int(s);
        return true;
    case CONFIG_TYPE_INT64:
        *out = (double)config_setting_get_int64(s);
        return true;
    default:
        return false;
    }
}

sf_status sf_config_number(const sf_config *config, const config_setting_t *group, const char *name,
                           double low, double high, double *out, sf_error *err) {
    const config_setting_t *s = find(config, group, name, false, err);
    if (!s)
        return SF_OK;
    if (!is_number(s, out))
        return sf_config_refuse(config, s, err, "%s must be a number", name);
    if (!(*out >= low && *out <= high))
        return sf_config_refuse(config, s, err, "%s" SF_OUTSIDE("%g", "%g", "%g"), name, *out, low, high);
    return SF_OK;
}

sf_status sf_config_flag(const sf_config *config, const config_setting_t *group, const char *name, bool *out,
                         sf_error *err) {
    const config_setting_t *s = find(config, group, name, false, err);
    if (s && config_setting_type(s) != CONFIG_TYPE_BOOL)
        return sf_config_refuse(config, s, err, "%s must be true or false", name);
    if (s)
        *out = config_setting_get_bool(s);
    return SF_OK;
}

sf_status sf_config_text(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, const char **out, sf_error *err) {
    const config_setting_t *s = find(config, group, name, required, err);
    if (!s)
        return err->status;
    const char *text = config_setting_get_string(s);
    if (!text || !*text)
        return sf_config_refuse(config, s, err, "%s must be a text", name);
    *out = text;
    return SF_OK;
}

sf_status sf_config_quantity(const sf_config *config, const config_setting_t *group, const char *name,
                             sf_quantity kind, bool required, double *out, sf_error *err) {
    const config_setting_t *s = find(config, group, name, required, err);
    sf_error inner = SF_ERROR_INIT;
    if (!s)
        return err->status;
    const char *text = config_setting_get_string(s);
    if (!text)
        return sf_config_refuse(config, s, err, "%s must be a text with its unit, for example \"%s\"", name,
                                sf_quantity_example(kind));
    if (sf_units_parse(config->units, text, kind, out, &inner) != SF_OK)
        return sf_config_refuse(config, s, err, "%s: %s", name, inner.text);
    if (!(*out > 0))
        return sf_config_refuse(config, s, err, "%s is %s; it must be above 0 %s", name, text,
                                sf_quantity_unit(kind));
    return SF_OK;
}

sf_status sf_config_choice(const sf_config *config, const config_setting_t *group, const char *name,
                           const char *words, int *out, sf_error *err) {
    const char *text = NULL;
    char list[256];
    if (sf_config_text(config, group, name, false, &text, err) != SF_OK || !text)
        return err->status;
    int index = sf_word_find(words, text);
    list_words(words, list, sizeof list);
    if (index < 0)
        return sf_config_refuse(config, config_setting_get_member(group, name), err,
                                "%s is \"%.80s\"; it must be one of %s", name, text, list);
    *out = index;
    return SF_OK;
}

static void resolve(const sf_config *config, const char *name, char path[PATH_MAX]) {
    bool below = *name != '/';
    snprintf(path, PATH_MAX, "%s%s%s", below ? config->folder : "", below ? "/" : "", name);
}

sf_status sf_config_file(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, char **out, sf_error *err) {
    const char *text = NULL;
    if (sf_config_text(config, group, name, required, &text, err) != SF_OK || !text)
        return err->status;
    char path[PATH_MAX];
    resolve(config, text, path);
    sf_error inner = SF_ERROR_INIT;
    if (sf_plain_check(path, NULL, &inner) != SF_OK)
        return sf_config_refuse(config, config_setting_get_member(group, name), err, "%s: %s", name,
                                inner.text);
    *out = strdup(path);
    return *out ? SF_OK : SF_NO_MEMORY(err, "the path %s", text);
}

sf_status sf_config_list(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, int most, const config_setting_t **out, sf_error *err) {
    const config_setting_t *s = find(config, group, name, required, err);
    *out = NULL;
    if (!s)
        return err->status;
    if (!config_setting_is_list(s) || config_setting_length(s) == 0)
        return sf_config_refuse(config, s, err, "%s must be a list: %s = ( { ... }, { ... } )", name, name);
    if (config_setting_length(s) > most)
        return sf_config_refuse(config, s, err, "%s has %d entries" SF_AT_MOST("%d"), name,
                                config_setting_length(s), most);
    for (int k = 0; k < config_setting_length(s); k++)
        if (!config_setting_is_group(config_setting_get_elem(s, (unsigned)k)))
            return sf_config_refuse(config, config_setting_get_elem(s, (unsigned)k), err,
                                    "%s: each entry must be a group: { ... }", name);
    *out = s;
    return SF_OK;
}
