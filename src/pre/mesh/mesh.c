/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh.h"

#include <stdlib.h>
#include <string.h>

void sf_mesh_free(sf_mesh *mesh) {
    free(mesh->position);
    free(mesh->cell_type);
    free(mesh->cell_ptr);
    free(mesh->cell_node);
    free(mesh->cell_layer);
    for (int s = 0; s < mesh->set_count; s++) {
        free(mesh->set[s].name);
        free(mesh->set[s].node);
        free(mesh->set[s].face);
    }
    free(mesh->set);
    memset(mesh, 0, sizeof *mesh);
}

void sf_surface_free(sf_surface *surface) {
    free(surface->position);
    free(surface->triangle);
    free(surface->solid);
    free(surface->hull_position);
    free(surface->hull_triangle);
    memset(surface, 0, sizeof *surface);
}

const sf_node_set *sf_mesh_find_set(const sf_mesh *mesh, const char *name) {
    for (int s = 0; s < mesh->set_count; s++)
        if (strcmp(mesh->set[s].name, name) == 0)
            return &mesh->set[s];
    return NULL;
}
