/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/reader.h"

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
    const char *file = reader->path;
    if (origin && origin->line > 0)
        file = origin->text;
    else if (!origin && line > 0)
        file = sf_case_source_find(&reader->source, line, &line);
    SF_OWNED char *folder = sf_case_folder_of(file, err);
    bool below = *path != '/';
    if (folder && asprintf(&out, "%s%s%s", below ? folder : "", below ? "/" : "", path) < 0)
        out = NULL;
    if (!out)
        SF_NO_MEMORY(err, "the path %s", path);
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
    SF_PRINT_INTO(sentence, format);
    return sf_error_set(err, SF_ERR_INPUT, file, line, "%s: %s", sf_case_where(reader, setting, where),
                        sentence);
}

sf_status sf_case_missing_key(const sf_case_reader *reader, const sf_key *key, sf_error *err) {
    const config_setting_t *group = config_lookup(&reader->config, key->group);
    bool quantity = key->kind == SF_KEY_QUANTITY;
    return SF_REFUSE_AT(reader, group, err, "%s.%s is missing%s: %s%s%s%s%s%s", key->group, key->name,
                        group ? "" : " (there is no such group)", key->description,
                        quantity ? ", for example " : "", quantity ? key->name : "", quantity ? " = \"" : "",
                        quantity ? sf_quantity_example(key->quantity) : "", quantity ? "\"" : "");
}

/* ---- overrides ---- */

/* `--set group.key=value`: puts values from the command line into the configuration before it is read. */

/* Marks a setting with where it came from; `line` 0: `text` is a --set text, else the path of a file. */
static bool mark(config_setting_t *setting, const char *text, unsigned line) {
    sf_case_origin *origin = malloc(sizeof *origin + strlen(text) + 1);
    if (!origin)
        return false;
    origin->line = line;
    strcpy(origin->text, text);
    config_setting_set_hook(setting, origin); /* released by the configuration's destructor */
    return true;
}

/* The source of the copies of a setting: a --set text, or (text NULL) the file that holds the setting. */
typedef struct copy_source {
    const char *text;
    const sf_case_source *source; /* of the text that was read */
} copy_source;

static bool mark_copy(const config_setting_t *from, config_setting_t *to, const copy_source *source) {
    const sf_case_origin *origin = config_setting_get_hook(from);
    int line = (int)config_setting_source_line(from);
    if (source->text || origin)
        return mark(to, source->text ? source->text : origin->text, source->text ? 0 : origin->line);
    const char *path = sf_case_source_find(source->source, line, &line);
    return mark(to, path, (unsigned)line);
}

/* Copies a scalar or, item by item, an aggregate. */
static bool copy_setting(const config_setting_t *from, config_setting_t *parent, const char *name,
                         const copy_source *source) {
    int type = config_setting_type(from);
    config_setting_t *to = config_setting_add(parent, name, type);
    if (!to || !mark_copy(from, to, source))
        return false;
    switch (type) {
    case CONFIG_TYPE_INT:
        return config_setting_set_int(to, config_setting_get_int(from));
    case CONFIG_TYPE_INT64:
        return config_setting_set_int64(to, config_setting_get_int64(from));
    case CONFIG_TYPE_FLOAT:
        return config_setting_set_float(to, config_setting_get_float(from));
    case CONFIG_TYPE_BOOL:
        return config_setting_set_bool(to, config_setting_get_bool(from));
    case CONFIG_TYPE_STRING:
        return config_setting_set_string(to, config_setting_get_string(from));
    default:
        break;
    }
    for (int i = 0; i < config_setting_length(from); i++) {
        const config_setting_t *item = config_setting_get_elem(from, (unsigned)i);
        if (!copy_setting(item, to, config_setting_name(item), source))
            return false;
    }
    return true;
}

/* libconfig syntax if it is that, else a text as it stands, so that shells need no second layer of quotes. */
static sf_status put_value(config_setting_t *parent, const char *name, const char *value, const char *text,
                           sf_error *err) {
    config_t scratch;
    config_init(&scratch);
    bool done = false, parsed = false;
    SF_OWNED char *line = NULL;
    if (asprintf(&line, "value = %s;", value) >= 0)
        parsed = !strpbrk(value, "\r\n") && config_read_string(&scratch, line) &&
                 config_setting_length(scratch.root) == 1;
    sf_error fault = SF_ERROR_INIT;
    if (parsed && sf_case_scan_value("", value, &fault) != SF_OK) {
        SF_FAIL(err, fault.status, "--set %s%s", text, fault.text);
    } else if (parsed) {
        const copy_source source = {.text = text};
        done = copy_setting(config_setting_get_elem(scratch.root, 0), parent, name, &source);
    } else {
        config_setting_t *to = config_setting_add(parent, name, CONFIG_TYPE_STRING);
        done = to && mark(to, text, 0) && config_setting_set_string(to, value);
    }
    config_destroy(&scratch);
    if (!done)
        SF_REFUSE(err, "--set %s: \"%s\" is not a valid key", text, name);
    return err->status;
}

/* The group named by the next component of the key, made if it is absent; NULL if it cannot be a group. */
static config_setting_t *enter_group(config_setting_t *parent, const char *name, const char *text) {
    config_setting_t *group = config_setting_get_member(parent, name);
    if (!group) {
        group = config_setting_add(parent, name, CONFIG_TYPE_GROUP);
        if (group && !mark(group, text, 0))
            return NULL;
    }
    return group && config_setting_is_group(group) ? group : NULL;
}

/* Puts the settings of the file `path` in place of everything in the group `name`. */
static sf_status replace_group(config_t *config, const char *name, const char *path, const char *text,
                               sf_error *err) {
    SF_OWNED_BY(config_destroy) config_t scratch;
    config_init(&scratch);
    SF_OWNED_BY(sf_case_source_free) sf_case_source lines = {0};
    SF_OWNED char *whole = sf_case_load_text(path, false, 0, NULL, &lines, err);
    if (whole) {
        const copy_source source = {.source = &lines};
        const char *dot = strchr(name, '.'), *member = dot ? dot + 1 : name;
        config_setting_t *root = config_root_setting(config);
        config_setting_t *parent = dot ? enter_group(root, "materials", text) : root;
        if (!config_read_string(&scratch, whole)) {
            int line = 0;
            const char *file = sf_case_source_find(&lines, config_error_line(&scratch), &line);
            SF_REFUSE(err, "--set %s: %s:%d: %s", text, file, line,
                      sf_case_syntax_phrase(config_error_text(&scratch), whole, config_error_line(&scratch)));
        } else {
            if (parent)
                config_setting_remove(parent, member);
            config_setting_t *group = parent ? config_setting_add(parent, member, CONFIG_TYPE_GROUP) : NULL;
            bool done = group && mark(group, text, 0);
            for (int i = 0; done && i < config_setting_length(scratch.root); i++) {
                const config_setting_t *item = config_setting_get_elem(scratch.root, (unsigned)i);
                done = copy_setting(item, group, config_setting_name(item), &source);
            }
            if (!done)
                SF_REFUSE(err, "--set %s: \"%s\" is not a valid group", text, name);
        }
    }
    return err->status;
}

sf_status sf_case_override(config_t *config, const char *text, sf_error *err) {
    const char *equals = strchr(text, '=');
    const char *first_dot = strchr(text, '.');
    if (sf_case_override_file(text)) {
        SF_PRINTED(name, SF_CASE_NAME_SIZE, "%.*s", (int)(equals - text), text);
        return replace_group(config, name, sf_case_override_file(text), text, err);
    }
    if (!equals || !first_dot || first_dot > equals)
        return SF_REFUSE(err,
                         "--set %s: expected group.key=value, for example --set missile.velocity=\"5.2 "
                         "m/s\", or group=@file",
                         text);
    char path[256];
    if ((size_t)(equals - text) >= sizeof path)
        return SF_REFUSE(err, "--set %.40s...: the key is longer than %zu characters", text, sizeof path - 1);
    memcpy(path, text, (size_t)(equals - text));
    path[equals - text] = '\0';
    for (char *end = path + strlen(path); end > path && (end[-1] == ' ' || end[-1] == '\t');)
        *--end = '\0';
    const char *value = equals + 1 + strspn(equals + 1, " \t");

    config_setting_t *parent = config_root_setting(config);
    char *name = path + strspn(path, " \t");
    for (char *dot = strchr(name, '.'); dot; name = dot + 1, dot = strchr(name, '.')) {
        *dot = '\0';
        parent = enter_group(parent, name, text);
        if (!parent)
            return SF_REFUSE(err, "--set %s: \"%s\" is not a group", text, name);
    }
    config_setting_remove(parent, name);
    return put_value(parent, name, value, text, err);
}

sf_status sf_case_take_drop(sf_case_reader *reader, int drop, sf_error *err) {
    const copy_source source = {.source = &reader->source};
    const config_setting_t *list = config_lookup(&reader->config, "series.drops"),
                           *item = list && config_setting_is_list(list)
                                       ? config_setting_get_elem(list, (unsigned)drop - 1)
                                       : NULL;
    if (!item || !config_setting_is_group(item))
        return SF_OK;
    config_setting_t *missile = enter_group(config_root_setting(&reader->config), "missile", "series.drops");
    for (int k = 0; missile && k < config_setting_length(item); k++) {
        const config_setting_t *own = config_setting_get_elem(item, (unsigned)k);
        const char *name = config_setting_name(own);
        if (strcmp(name, "interval") == 0)
            continue;
        config_setting_remove(missile, name);
        if (!copy_setting(own, missile, name, &source))
            return SF_NO_MEMORY(err, "the drops of a series");
    }
    return SF_OK;
}
