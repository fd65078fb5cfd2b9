/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Input files of your own in the syntax of a case (libsoftfall-build). */
#pragma once
#include "softfall/status.h"

/* Reads a file in the syntax of a case (libconfig, with @include) and gives its settings as JSON: of each
 * "name", "place" ("file:line"), "kind" (group, list, array, int, float, bool or text) and "value", for a
 * group, list or array its settings. `json` is the caller's (softfall_text_free). */
SOFTFALL_API softfall_status softfall_settings_read(const char *path, char **json, softfall_error *error);
SOFTFALL_API void softfall_text_free(char *text);
