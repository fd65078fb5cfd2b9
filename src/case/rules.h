/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules that join several keys of a case, or a key with the law of the material. Each refusal is
 * SF_ERR_INPUT with place, key, value and bound. Internal to src/case. */
#pragma once
#include "case/reader.h"

/* Puts an entry of the list `interfaces`, that of the reader, into the case; `group`: its settings. */
sf_status sf_case_add_interface(const sf_case_reader *reader, const config_setting_t *group, sf_error *err);
/* The card of the reader's material, and the law as the solver will build it. */
sf_status sf_case_check_card(const sf_case_reader *reader, sf_error *err);
/* The values as they are given. */
sf_status sf_case_check_given(const sf_case_reader *reader, sf_error *err);
/* The complete case; warnings go to the reader's sink. */
sf_status sf_case_check_complete(const sf_case_reader *reader, sf_error *err);
