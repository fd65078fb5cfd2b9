/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading of one setting of each kind of key, and of the group response_error of a material, which belongs to
 * no law: softfall fit writes it into the draws of a posterior, `softfall cfh` uses it, the other
 * programs check it and leave it. Internal to src/case. */
#pragma once
#include "case/reader.h"

/* Reads one setting into the case. `detail` receives the SI value for the listing. */
sf_status sf_case_read_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err);

#define SF_RESPONSE_ERROR "response_error"

/* True if this is the group `response_error` in the group of the reader's material. */
bool sf_case_is_response_error(const sf_case_reader *reader, const char *group, const char *name);

/* Reads it into the case, if the material has it. SF_ERR_INPUT: no group, an unknown key, a value that is no
 * number or out of bounds, an error without its standard deviation. Of a layer it is checked only. */
sf_status sf_case_read_response_error(sf_case_reader *reader, sf_error *err);
