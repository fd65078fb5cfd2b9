/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/frame_field.h"

const sf_frame_field_info *sf_frame_field_get(sf_frame_field field) {
    static const sf_frame_field_info fields[SF_FRAME_FIELDS] = {
#define FIELD(constant, name, components, units, array, description, remark)                                 \
    {#name, components, units, array, description, remark},
        SF_FRAME_FIELD_LIST(FIELD, )
#undef FIELD
    };
    return &fields[field];
}
