/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities with their units (libsoftfall). */
#pragma once
#include "softfall/status.h"

/* Reads a quantity with its unit, such as "10 mph", into SI; `*unit` is the SI unit of its kind ("m s-1"),
 * static. */
SOFTFALL_API softfall_status softfall_units_read(const char *text, double *value, const char **unit,
                                                 softfall_error *error);
