/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a case with its includes in place, to be changed and written at another place: its lines stay
 * as they are but for the values of --set texts and the names of files. It works only on cases that
 * sf_case_read has accepted with the same texts; sf_case_load_marked (case/grammar.h) reads them. */
#pragma once
#include "base/error.h"

/* Puts a --set text, "group.key=value" or "group=@file", where it belongs; the names of files in it become
 * paths from /. `*text` is from malloc and may move; `path` is that of the case. */
sf_status sf_case_edit_set(char **text, const char *path, const char *set, sf_error *err);

enum { SF_EDIT_PATH_SIZE = 256 };

/* The value of a setting: text[begin, end), with the brackets of a group, list or array. */
typedef struct sf_edit_setting {
    char path[SF_EDIT_PATH_SIZE]; /* "group.key"; within a list that of the list, and the names below it */
    size_t begin, end;
} sf_edit_setting;

typedef struct sf_edit_settings {
    int count;
    sf_edit_setting *setting; /* [count] in the order of the text, a group before the settings in it; owned */
} sf_edit_settings;

/* Finds the settings, or those that name files. Release with free(settings->setting), also on failure. */
sf_status sf_case_edit_find(const char *text, bool only_files, sf_edit_settings *settings, sf_error *err);

/* Gives files other names. */
typedef struct sf_edit_rename {
    /* The new name of the file that the setting `path` calls `name`; from malloc, NULL on failure. */
    char *(*name)(void *context, const char *path, const char *name, sf_error *err);
    void *context; /* borrowed */
} sf_edit_rename;

/* Writes text[begin, end) with new names of the files. SF_ERR_INPUT: one of the names does not end there. */
sf_status sf_case_edit_write(const char *text, size_t begin, size_t end, const sf_edit_settings *files,
                             const sf_edit_rename *rename, FILE *out, sf_error *err);
