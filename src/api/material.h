/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foam behind its handle. */
#pragma once
#include "api/api.h"

struct softfall_material {
    sf_material data;
    char *parameters; /* owned */
};

/* Returns a handle of a copy; NULL without memory. */
softfall_material *sf_material_handle(const sf_material *material, sf_error *err);
