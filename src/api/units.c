/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: quantities with their units. */
#include "api/api.h"
#include "base/units.h"

softfall_status softfall_units_read(const char *text, double *value, const char **unit,
                                    softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_units *units = NULL;
    *unit = NULL;
    if (sf_units_open(&units, &err) != SF_OK)
        return softfall_return(&err, error);
    for (int k = 0; k < SF_QUANTITY_COUNT && !*unit; k++) {
        err = (sf_error)SF_ERROR_INIT;
        if (sf_units_parse(units, text, (sf_quantity)k, value, &err) == SF_OK)
            *unit = sf_quantity_unit((sf_quantity)k);
    }
    sf_units_close(&units);
    return softfall_return(&err, error);
}
