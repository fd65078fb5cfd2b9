/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/members.h"

#include "io/h5_data.h"
#include <string.h>

sf_status sf_members_write(sf_h5 *file, const char *group, const sf_member *member, size_t count,
                           const void *base, sf_error *err) {
    for (size_t k = 0; k < count && err->status == SF_OK; k++) {
        int64_t items = member[k].count;
        SF_PRINTED(path, 128, "%s/%s", group, member[k].name);
        sf_h5_info info = {path, member[k].units, member[k].description};
        sf_h5_write(file, &info, member[k].type, 1, &items, (const char *)base + member[k].offset, err);
    }
    return err->status;
}

sf_status sf_members_read(const sf_h5 *file, const char *group, const sf_member *member, size_t count,
                          void *base, sf_error *err) {
    for (size_t k = 0; k < count && err->status == SF_OK; k++) {
        SF_OWNED void *data = NULL;
        int64_t items = member[k].count;
        SF_PRINTED(path, 128, "%s/%s", group, member[k].name);
        if (sf_h5_read(file, path, member[k].type, 1, &items, &data, err) == SF_OK)
            memcpy((char *)base + member[k].offset, data, (size_t)items * 8);
    }
    return err->status;
}
