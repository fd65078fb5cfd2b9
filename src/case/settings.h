/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_CASE_SETTINGS_H
#define SF_CASE_SETTINGS_H
#include <stddef.h>

#include "base/error.h"

/* A file of a case's text (case/parts.h). */

typedef struct sf_case_part {
    char *path;        /* where it stands, from / */
    char *included_as; /* the name in its include; NULL: the case file, or one of a --set text */
    char *text;        /* its includes are @include "#INDEX of the part" until sf_case_parts_finish */
    char *name;        /* where it goes, from the new folder; NULL: no longer part of the case */
} sf_case_part;

typedef struct sf_case_parts {
    int count, capacity;
    sf_case_part *part; /* [count], the case file first */
} sf_case_parts;

/* The places of the settings of a case in its text. Internal to src/case. */

enum { SF_SETTING_PATH_SIZE = 256 };

/* The value of a setting: text[begin, end) of a part; with the brackets of a group, list or array, whose end
 * may stand in another part than its begin. */
typedef struct sf_setting {
    char path[SF_SETTING_PATH_SIZE]; /* "group.key"; within a list that of the list, and the names below it */
    char kind; /* '"', '{', '(', '[', or 'w': a number or a word; '@': the include of `end_part`, without a
                  path */
    int part, end_part;
    size_t begin, end;
} sf_setting;

typedef struct sf_settings {
    int count, capacity;
    sf_setting
        *setting; /* [count] the includes, then in the order of the text; a group before what is in it */
} sf_settings;

/* Finds the settings of the present text. Release with sf_settings_free, also on failure. */
sf_status sf_settings_find(const sf_case_parts *parts, sf_settings *settings, sf_error *err);
void sf_settings_free(sf_settings *settings);

/* NULL: none. */
const sf_setting *sf_settings_get(const sf_settings *settings, const char *path);

/* The text that the setting of kind '"' means; from malloc, NULL on failure. */
char *sf_setting_text(const sf_case_parts *parts, const sf_setting *setting, sf_error *err);

/* If the line [line, end) is an include of a part: which; else -1. */
int sf_settings_include(const char *line, const char *end);
#endif
