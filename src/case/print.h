/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Settings in libconfig syntax. Internal to src/case; the list of keys is printed by case.h's
 * sf_case_print_keys. */
#ifndef SF_CASE_PRINT_H
#define SF_CASE_PRINT_H

#include <libconfig.h>
#include <stdio.h>

/* Writes a setting's value in libconfig syntax on one line. */
void sf_case_print_setting(FILE *file, const config_setting_t *setting);

#endif
