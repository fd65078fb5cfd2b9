/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <libconfig.h>
#include <stdio.h>

#include "case/case.h"

/* The keys of a case with their values as texts, for who lets a user change them. Of the table of keys
 * (case/keys.c), which is internal to src/case. */

/* The kinds of entry that the window has for a value. */
typedef enum sf_case_value_kind {
    SF_CASE_VALUE_TEXT,   /* "4.5 m/s", or a name */
    SF_CASE_VALUE_LIST,   /* ["10 mm", "0 mm"] */
    SF_CASE_VALUE_NUMBER, /* 0.5 */
    SF_CASE_VALUE_FLAG,   /* true or false */
    SF_CASE_VALUE_WORD,   /* one of `words` */
    SF_CASE_VALUE_FILE,   /* a path, as the case has it */
    SF_CASE_VALUE_OTHER,  /* a group, or what cannot be entered in one line */
} sf_case_value_kind;

/* Strings are valid during the call only, but those of the table: group, name, words, help. */
typedef struct sf_case_value {
    const char *group, *name;
    const char *text; /* as --set takes it; "": absent */
    bool given;       /* in the case or by an override; else the default */
    sf_case_value_kind kind;
    bool of_material; /* a parameter of the law */
    const char *words, *help;
} sf_case_value;

typedef struct sf_case_listener {
    void (*hear)(void *user, const sf_case_value *value);
    void *user; /* borrowed */
} sf_case_listener;

/* sf_case_read of a drop of the case's series, from 1, with what the list `series.drops` changes of the
 * missile in it; sf_case_read reads the first. Tells the listener (NULL: none) each value of the table that
 * it has read, in its order, also those before a failure. */
sf_status sf_case_read_values(const char *path, int drop, int count, const char *const *overrides,
                              const sf_sink *sink, const sf_case_listener *listener, sf_case *out,
                              sf_error *err);

/* True if the value of "group.key" is the name of a file, of some law; also of a file in a list of curves. */
bool sf_case_key_is_file(const char *path);

/* Settings in libconfig syntax. Internal to src/case; the list of keys is printed by case.h's
 * sf_case_print_keys. */

/* Writes a setting's value in libconfig syntax on one line. */
void sf_case_print_setting(FILE *file, const config_setting_t *setting);
