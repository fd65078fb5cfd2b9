/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules that join several keys of a case, or a key with the law of the material. Each refusal is
 * SF_ERR_INPUT with place, key, value and bound. Internal to src/case. */
#ifndef SF_CASE_RULES_H
#define SF_CASE_RULES_H

#include "case/reader.h"

/* The card of the reader's material, and the law as the solver will build it. */
sf_status sf_case_check_card(const sf_case_reader *reader, sf_error *err);
/* The values as they are given. */
sf_status sf_case_check_given(const sf_case_reader *reader, sf_error *err);
/* The complete case; warnings go to the reader's sink. */
sf_status sf_case_check_complete(const sf_case_reader *reader, sf_error *err);

#endif
