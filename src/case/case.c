/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/case.h"

#include "base/hash.h"
#include "material/laws.h"

void sf_case_free(sf_case *c) {
    for (int k = 0; k < SF_SUPPORTS; k++)
        free(c->support[k].source.path);
    sf_material_free(&c->material);
    for (int k = 0; c->layer && k < c->layer_count; k++)
        sf_material_free(&c->layer[k]);
    SF_CLEAR(c, c->path, c->text, c->parameters, c->geometry_files, c->pad.path, c->missile.path, c->layer,
             c->motion_time, c->motion_displacement);
}

const sf_case_interface *sf_case_interface_find(const sf_case *c, int layer, int other) {
    for (int k = 0; k < c->interface_count; k++) {
        const int *own = c->interface[k].layer;
        if ((own[0] == layer && own[1] == other) || (own[0] == other && own[1] == layer))
            return &c->interface[k];
    }
    return NULL;
}

bool sf_case_has_name(int count, const char (*list)[SF_CASE_NAME_SIZE], const char *name) {
    for (int g = 0; g < count; g++)
        if (strcmp(list[g], name) == 0)
            return true;
    return false;
}

const sf_geo_source *sf_case_geometry(const sf_case *c, int k) {
    if (k >= 2)
        return &c->support[k - 2].source;
    return k == 0 ? &c->pad : &c->missile;
}

uint64_t sf_case_hash(const sf_case *c) {
    size_t motion = (size_t)c->motion_count * sizeof *c->motion_time;
    uint64_t hash = sf_hash_bytes(SF_HASH_START, &c->values, sizeof c->values);
    if (c->layer_count == 0)
        hash = sf_material_hash(hash, &c->material);
    for (int k = 0; k < c->layer_count; k++)
        hash = sf_material_hash(hash, &c->layer[k]);
    hash = sf_hash_bytes(hash, c->motion_time, motion);
    return sf_hash_bytes(hash, c->motion_displacement, motion);
}

sf_status sf_case_check_memory(const sf_case *c, sf_error *err) {
    bool found = c->layer_count == 0 && sf_material_has_memory(&c->material);
    for (int k = 0; k < c->layer_count; k++)
        found |= sf_material_has_memory(&c->layer[k]);
    if (c->drops == 1 || found)
        return SF_OK;
    return SF_REFUSE(err, "series.drops = %g: the foam has no material.memory: later drops would be too soft",
                     c->drops);
}
