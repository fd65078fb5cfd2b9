/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One setting of each kind of key. Internal to src/case. */
#ifndef SF_CASE_VALUE_H
#define SF_CASE_VALUE_H

#include "case/reader.h"

/* Reads one setting into the case. `detail` receives the SI value for the listing. */
sf_status sf_case_read_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err);

#endif
