/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/reader.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const char *sf_case_where(const sf_case_reader *reader, const config_setting_t *setting, char *out) {
    const sf_case_origin *origin = setting ? config_setting_get_hook(setting) : NULL;
    int line = setting ? (int)config_setting_source_line(setting) : 0;
    if (origin && origin->line == 0) {
        snprintf(out, SF_CASE_WHERE_SIZE, "--set %s", origin->text);
    } else if (origin) {
        snprintf(out, SF_CASE_WHERE_SIZE, "%.480s:%u", origin->text, origin->line);
    } else if (line > 0) {
        const char *path = sf_case_source_find(&reader->source, line, &line);
        snprintf(out, SF_CASE_WHERE_SIZE, "%.480s:%d", path, line);
    } else {
        snprintf(out, SF_CASE_WHERE_SIZE, "%s", reader->path);
    }
    return out;
}

char *sf_case_resolve(const sf_case_reader *reader, const config_setting_t *setting, const char *path,
                      sf_error *err) {
    char *out = NULL;
    const sf_case_origin *origin = config_setting_get_hook(setting);
    int line = (int)config_setting_source_line(setting);
    const char *file = origin && origin->line > 0 ? origin->text
                       : !origin && line > 0      ? sf_case_source_find(&reader->source, line, &line)
                                                  : reader->path;
    char *folder = sf_case_folder_of(file, err);
    if (folder && *path == '/')
        out = strdup(path);
    else if (folder && asprintf(&out, "%s/%s", folder, path) < 0)
        out = NULL;
    free(folder);
    if (!out)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    return out;
}

bool sf_case_is_given(const sf_case_reader *reader, const char *group, const char *name) {
    char path[SF_CASE_GROUP_SIZE];
    sf_case_material_path(reader->material_group, group, path, sizeof path);
    return reader->given[sf_case_find_key(&reader->keys, path, name) - reader->keys.key];
}

const config_setting_t *sf_case_setting(const sf_case_reader *reader, const char *path) {
    char text[SF_CASE_GROUP_SIZE];
    sf_case_material_path(reader->material_group, path, text, sizeof text);
    const config_setting_t *setting = config_lookup(&reader->config, text);
    for (char *dot = strrchr(text, '.'); !setting && dot; dot = strrchr(text, '.')) {
        *dot = '\0';
        setting = config_lookup(&reader->config, text);
    }
    return setting;
}

sf_status sf_case_refuse(const sf_case_reader *reader, const config_setting_t *setting, sf_error *err,
                         const char *file, int line, const char *format, ...) {
    char where[SF_CASE_WHERE_SIZE], sentence[sizeof err->text];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return sf_error_set(err, SF_ERR_INPUT, file, line, "%s: %s", sf_case_where(reader, setting, where),
                        sentence);
}

sf_status sf_case_missing_key(const sf_case_reader *reader, const sf_key *key, sf_error *err) {
    const config_setting_t *group = config_lookup(&reader->config, key->group);
    bool quantity = key->kind == SF_KEY_QUANTITY;
    return SF_REFUSE(reader, group, err, "%s.%s is missing%s: %s%s%s%s%s%s", key->group, key->name,
                     group ? "" : " (there is no such group)", key->description,
                     quantity ? ", for example " : "", quantity ? key->name : "", quantity ? " = \"" : "",
                     quantity ? sf_quantity_example(key->quantity) : "", quantity ? "\"" : "");
}
