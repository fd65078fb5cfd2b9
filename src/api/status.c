/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: its version. */
#include "api/api.h"
#include "build_info.h"

const char *softfall_version(void) {
    return SF_VERSION;
}

const char *softfall_revision(void) {
    return SF_GIT_REVISION;
}
