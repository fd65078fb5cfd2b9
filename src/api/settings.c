/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: files in the syntax of a case, for a host that has inputs of its own. */
#include "api/api.h"
#include "base/text.h"
#include "case/grammar.h"
#include "report/row.h"

#include <libconfig.h>

/* Writes one setting and those in it. */
static void put(sf_json *json, const sf_case_source *source, const config_setting_t *s) {
    static const char *const kinds[] = {
        [CONFIG_TYPE_GROUP] = "group", [CONFIG_TYPE_INT] = "int",     [CONFIG_TYPE_INT64] = "int",
        [CONFIG_TYPE_FLOAT] = "float", [CONFIG_TYPE_STRING] = "text", [CONFIG_TYPE_BOOL] = "bool",
        [CONFIG_TYPE_ARRAY] = "array", [CONFIG_TYPE_LIST] = "list"};
    const int type = config_setting_type(s);
    int line = 0;
    const char *path = sf_case_source_find(source, (int)config_setting_source_line(s), &line);
    SF_PRINTED(place, SF_CASE_WHERE_SIZE, "%.480s:%d", path, line);
    SF_JSON_OBJECT(json, NULL);
    SF_JSON_TEXTS(json, {"name", config_setting_name(s)}, {"place", place}, {"kind", kinds[type]});
    if (type == CONFIG_TYPE_STRING)
        sf_json_text(json, "value", config_setting_get_string(s));
    else if (type == CONFIG_TYPE_BOOL)
        sf_json_bool(json, "value", config_setting_get_bool(s));
    else if (type == CONFIG_TYPE_INT || type == CONFIG_TYPE_INT64)
        sf_json_integer(json, "value", config_setting_get_int64(s));
    else if (type == CONFIG_TYPE_FLOAT) { /* with all digits */
        SF_PRINTED(number, 40, "%.17g", config_setting_get_float(s));
        sf_json_text(json, "value", number);
    } else {
        SF_JSON_ARRAY(json, "value");
        for (int k = 0; k < config_setting_length(s); k++)
            put(json, source, config_setting_get_elem(s, (unsigned)k));
    }
}

static char *read_settings(const char *path, sf_error *err) {
    sf_case_source source = {0};
    config_t config;
    char *made = NULL;
    config_init(&config);
    SF_OWNED char *text = sf_case_load_text(path, false, 0, NULL, &source, err);
    if (text && !config_read_string(&config, text)) {
        int line = 0;
        const char *file = sf_case_source_find(&source, config_error_line(&config), &line);
        SF_REFUSE(err, "%s:%d: %s", file, line,
                  sf_case_syntax_phrase(config_error_text(&config), text, config_error_line(&config)));
    } else if (text) {
        SF_TEXT_STREAM(out, buffer, size);
        if (out)
            put(&(sf_json){.file = out}, &source, config_root_setting(&config));
        if (!(made = sf_text_close(out, &buffer)))
            SF_NO_MEMORY(err, "the settings of %s", path);
    }
    config_destroy(&config);
    sf_case_source_free(&source);
    return made;
}

softfall_status softfall_settings_read(const char *path, char **json, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *json = read_settings(path, &err);
    return softfall_return(&err, error);
}

void softfall_text_free(char *text) {
    free(text);
}
