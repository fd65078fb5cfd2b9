/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values from the command line. Internal to src/case. */
#ifndef SF_CASE_OVERRIDE_H
#define SF_CASE_OVERRIDE_H

#include "base/error.h"
#include <libconfig.h>

/* Puts one --set text into the configuration, whose destructor must be free(). */
sf_status sf_case_override(config_t *config, const char *text, sf_error *err);

#endif
