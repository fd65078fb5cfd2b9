/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading of a case file, or of a material file alone. A listener hears the keys with their values as texts,
 * so that a user can change them; the table of keys itself (case/keys.h) is internal to src/case. */
#pragma once
#include "case/case.h"

/* Reads and checks a case. `overrides`: `count` strings "group.key=value" as given to --set (value in
 * libconfig syntax or bare text, which is taken as a string). Refuses unknown groups and keys (naming file,
 * line and what exists), missing keys, wrong types, units of another dimension and values out of bounds.
 * Paths are relative to the file that holds the key (the case, or a file that it includes); @include is
 * relative to the case file's folder. Warnings and notes go to `sink`. On failure `*out` is zeroed. */
sf_status sf_case_read(const char *path, int count, const char *const *overrides, const sf_sink *sink,
                       sf_case *out, sf_error *err);

/* Would a case with this material file (the keys of the group `material`) be refused for it, on a pad of this
 * temperature (K; 0: none is given)? The sentence names file, line and key. */
sf_status sf_case_check_material(const char *path, double temperature, sf_error *err);
/* The material of such a file; owned by the caller (sf_material_free). `parameters`, if not NULL, receives
 * its lines as of sf_case.parameters, from malloc. */
sf_status sf_case_read_material(const char *path, double temperature, sf_material *material,
                                char **parameters, sf_error *err);

/* The kinds of entry that the window has for a value. */
typedef enum sf_case_value_kind {
    SF_CASE_VALUE_OTHER,  /* a group, or what cannot be entered in one line */
    SF_CASE_VALUE_TEXT,   /* "4.5 m/s", or a name */
    SF_CASE_VALUE_LIST,   /* ["10 mm", "0 mm"] */
    SF_CASE_VALUE_NUMBER, /* 0.5 */
    SF_CASE_VALUE_FLAG,   /* true or false */
    SF_CASE_VALUE_WORD,   /* one of `words` */
    SF_CASE_VALUE_FILE,   /* a path, as the case has it */
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

/* The file of a case, and what is read of it. */
typedef struct sf_case_input {
    const char *path;
    int drop;                     /* of the case's series, from 1 */
    int count;                    /* of the overrides */
    const char *const *overrides; /* [count] KEY=VALUE */
} sf_case_input;

/* sf_case_read of any drop, with what the list `series.drops` changes of the missile in it; sf_case_read
 * reads the first. Tells the listener (NULL: none) each value of the table that it has read, in its order,
 * also those before a failure. */
sf_status sf_case_read_values(const sf_case_input *input, const sf_sink *sink,
                              const sf_case_listener *listener, sf_case *out, sf_error *err);
