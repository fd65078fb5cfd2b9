/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values and keys as texts: the printed table of all keys, settings in libconfig syntax, and the keys that
 * name files. */
#pragma once
#include "base/error.h"
#include <libconfig.h>

/* Writes the table of all keys (value, bounds, default, meaning) as Markdown: `softfall-pre --keys`,
 * docs/case.md. */
void sf_case_print_keys(FILE *file);

/* True if the value of "group.key" is the name of a file, of some law; also of a file in a list of curves. */
bool sf_case_key_is_file(const char *path);

/* Writes a setting's value in libconfig syntax on one line. */
void sf_case_print_setting(FILE *file, const config_setting_t *setting);
