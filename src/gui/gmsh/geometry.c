/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/gmsh/geometry.h"

#include "io/plain_file.h"
#include <gmshc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first error among gmsh's lines since gmshLoggerStart, which this ends. */
static sf_status take_error(const char *path, sf_error *err) {
    char **line = NULL;
    size_t count = 0;
    int ierr = 0;
    gmshLoggerGet(&line, &count, &ierr);
    for (size_t k = 0; k < count; k++) {
        if (strncmp(line[k], "Error", 5) == 0) /* as softfall-pre says it */
            SF_FAIL(err, SF_ERR_INPUT, "%s: gmsh, reading: %s", path,
                    line[k] + 5 + strspn(line[k] + 5, " :"));
        gmshFree(line[k]);
    }
    gmshFree(line);
    gmshLoggerStop(&ierr);
    return err->status;
}

sf_status sf_geometry_show(const char *path, sf_error *err) {
    int ierr = 0, failed = 0;
    if (sf_plain_check(path, "geometry", err) != SF_OK)
        return err->status;
    gmshLoggerStart(&ierr);
    gmshOpen(path, &failed);
    take_error(path, err);
    if (err->status == SF_OK && failed != 0)
        SF_FAIL(err, SF_ERR_INPUT, "gmsh cannot read the geometry %s", path);
    return err->status;
}

void sf_geometry_box(double low[3], double high[3]) {
    int ierr = 0;
    gmshModelGetBoundingBox(-1, -1, &low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &ierr);
}

static void measure(sf_triangles *s) {
    for (int c = 0; c < 3; c++) {
        s->low[c] = INFINITY;
        s->high[c] = -INFINITY;
    }
    for (int64_t k = 0; k < 3 * s->count; k++)
        for (int c = 0; c < 3; c++) {
            s->low[c] = fmin(s->low[c], s->corner[3 * k + c]);
            s->high[c] = fmax(s->high[c], s->corner[3 * k + c]);
        }
}

/* The triangles (element type 2) of the model's surfaces. */
static sf_status take_triangles(sf_triangles *out, sf_error *err) {
    size_t *element = NULL, *node = NULL, *corner = NULL, elements = 0, nodes = 0, corners = 0,
           parameters = 0, positions = 0;
    size_t largest = 0;
    double *position = NULL, *parameter = NULL;
    int ierr = 0;
    gmshModelMeshGetElementsByType(2, &element, &elements, &corner, &corners, -1, 0, 1, &ierr);
    gmshModelMeshGetNodes(&node, &nodes, &position, &positions, &parameter, &parameters, -1, -1, 0, 0, &ierr);
    for (size_t k = 0; k < nodes; k++)
        largest = node[k] > largest ? node[k] : largest;
    double *place = sf_alloc(err, 3 * (largest + 1), sizeof *place, "the missile's picture");
    out->corner = sf_alloc(err, 3 * corners, sizeof *out->corner, "the missile's picture");
    for (size_t k = 0; k < nodes && err->status == SF_OK; k++)
        memcpy(&place[3 * node[k]], &position[3 * k], 3 * sizeof *place);
    for (size_t k = 0; k < corners && err->status == SF_OK; k++)
        if (corner[k] <= largest)
            memcpy(&out->corner[3 * k], &place[3 * corner[k]], 3 * sizeof *place);
    out->count = err->status == SF_OK ? (int64_t)(corners / 3) : 0;
    free(place);
    gmshFree(element);
    gmshFree(corner);
    gmshFree(node);
    gmshFree(position);
    gmshFree(parameter);
    measure(out);
    return err->status;
}

sf_status sf_geometry_read_surface(const char *path, sf_triangles *surface, sf_error *err) {
    int ierr = 0;
    *surface = (sf_triangles){0};
    if (sf_geometry_show(path, err) != SF_OK)
        return err->status;
    gmshModelMeshGenerate(2, &ierr);
    if (ierr == 0)
        take_triangles(surface, err);
    gmshModelRemove(&ierr);
    return err->status;
}

void sf_geometry_clear(void) {
    int ierr = 0;
    gmshClear(&ierr);
}
