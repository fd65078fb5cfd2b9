/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The keys material.curve and material.curves. Internal to src/case. */
#ifndef SF_CASE_MATERIAL_H
#define SF_CASE_MATERIAL_H

#include "case/reader.h"

/* The readers of SF_KEY_CURVE and SF_KEY_CURVES. */
sf_status sf_case_read_curves(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);

#endif
