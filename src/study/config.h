/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input file of a campaign: libconfig syntax, dimensional values as texts with units. Every sentence of
 * an error begins with "file:line: group.key". File names are relative to the file that holds them. */
#pragma once
#include "base/units.h"
#include "case/grammar.h"
#include <libconfig.h>
#include <limits.h>

typedef struct sf_config {
    const char *path; /* borrowed */
    char *folder;     /* that holds the file; owned */
    sf_units *units;
    config_t config;
    sf_case_source source; /* of its lines */
} sf_config;

typedef const config_setting_t sf_config_item; /* of libconfig */

/* Reads the file. Release with sf_config_close, also on failure. */
sf_status sf_config_open(const char *path, sf_config *config, sf_error *err);
void sf_config_close(sf_config *config);

/* Refuses every name in the group that is not in `names` ("density|drops"). */
sf_status sf_config_names(const sf_config *config, const config_setting_t *group, const char *names,
                          sf_error *err);

/* One key of a group into `*out`, which must hold the default and is left alone if the key is absent. Bounds
 * are inclusive. */
sf_status sf_config_number(const sf_config *config, const config_setting_t *group, const char *name,
                           double low, double high, double *out, sf_error *err);
/* SI value above zero; an absent key is refused if it is `required`. */
sf_status sf_config_quantity(const sf_config *config, const config_setting_t *group, const char *name,
                             sf_quantity kind, bool required, double *out, sf_error *err);
/* true or false; `*out` is left alone if the key is absent. */
sf_status sf_config_flag(const sf_config *config, const config_setting_t *group, const char *name, bool *out,
                         sf_error *err);
/* Borrowed from the configuration. */
sf_status sf_config_text(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, const char **out, sf_error *err);
/* The index of the text among `words` ("auto|H1|H2"). */
sf_status sf_config_choice(const sf_config *config, const config_setting_t *group, const char *name,
                           const char *words, int *out, sf_error *err);
/* The name of a file that can be read, resolved against the file's folder; owned by the caller. */
sf_status sf_config_file(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, char **out, sf_error *err);
/* A list of groups, `( { ... }, { ... } )`, with at most `most` entries; NULL if it is absent and not
 * required. */
sf_status sf_config_list(const sf_config *config, const config_setting_t *group, const char *name,
                         bool required, int most, const config_setting_t **out, sf_error *err);

/* Records SF_ERR_INPUT: "file:line: sentence". */
sf_status sf_config_refuse(const sf_config *config, const config_setting_t *setting, sf_error *err,
                           const char *format, ...) __attribute__((format(printf, 4, 5)));
