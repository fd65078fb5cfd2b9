/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `--set group.key=value`: puts values from the command line into the configuration before it is read. */
#include "pre/case_keys.h"

#include <stdlib.h>
#include <string.h>

/* Copies a scalar or, item by item, an aggregate. Every copy is marked with its command-line text. */
static bool copy_setting(const config_setting_t *from, config_setting_t *parent, const char *name,
                         const char *text) {
    int type = config_setting_type(from);
    config_setting_t *to = config_setting_add(parent, name, type);
    if (!to)
        return false;
    config_setting_set_hook(to, (void *)text);
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
        if (!copy_setting(item, to, config_setting_name(item), text))
            return false;
    }
    return true;
}

/* libconfig syntax if it is that, else a text as it stands, so that shells need no second layer of quotes. */
static bool put_value(config_setting_t *parent, const char *name, const char *value, const char *text) {
    config_t scratch;
    config_init(&scratch);
    bool done = false, parsed = false;
    char *line = NULL;
    if (asprintf(&line, "value = %s;", value) >= 0) {
        parsed = config_read_string(&scratch, line) && config_setting_length(scratch.root) == 1;
        free(line);
    }
    if (parsed) {
        done = copy_setting(config_setting_get_elem(scratch.root, 0), parent, name, text);
    } else {
        config_setting_t *to = config_setting_add(parent, name, CONFIG_TYPE_STRING);
        if (to) {
            config_setting_set_hook(to, (void *)text);
            done = config_setting_set_string(to, value);
        }
    }
    config_destroy(&scratch);
    return done;
}

/* The group named by the next component of the key, made if it is absent; NULL if it cannot be a group. */
static config_setting_t *enter_group(config_setting_t *parent, const char *name, const char *text) {
    config_setting_t *group = config_setting_get_member(parent, name);
    if (!group) {
        group = config_setting_add(parent, name, CONFIG_TYPE_GROUP);
        if (group)
            config_setting_set_hook(group, (void *)text);
    }
    return group && config_setting_is_group(group) ? group : NULL;
}

sf_status sf_case_override(config_t *config, const char *text, sf_error *err) {
    const char *equals = strchr(text, '=');
    const char *first_dot = strchr(text, '.');
    if (!equals || !first_dot || first_dot > equals)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "--set %s: expected group.key=value, for example --set missile.velocity=\"5.2 m/s\"",
                       text);
    char path[256];
    if ((size_t)(equals - text) >= sizeof path)
        return SF_FAIL(err, SF_ERR_INPUT, "--set %.40s...: the key is longer than %zu characters", text,
                       sizeof path - 1);
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
            return SF_FAIL(err, SF_ERR_INPUT, "--set %s: \"%s\" is not a group", text, name);
    }
    config_setting_remove(parent, name);
    if (!put_value(parent, name, value, text))
        return SF_FAIL(err, SF_ERR_INPUT, "--set %s: \"%s\" is not a valid key", text, name);
    return SF_OK;
}
