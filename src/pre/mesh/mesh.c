/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh.h"

#include "base/mat3.h"
#include "base/sets.h"
#include <string.h>

enum { MAX_VERTICES = 8 };

int sf_face_compare(const void *one, const void *other) {
    const int32_t *a = one, *b = other;
    for (int k = 0; k < 4; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

int sf_cell_face_compare(const void *a, const void *b) {
    const sf_cell_face *x = a, *y = b;
    int keys = sf_face_compare(x->key, y->key);
    return keys ? keys : SF_ORDER(x->cell, y->cell);
}

void sf_mesh_middle(const sf_mesh *mesh, const int32_t *node, int64_t count, double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int64_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            out[c] += mesh->position[3 * (int64_t)node[k] + c] / (double)count;
}

void sf_mesh_free(sf_mesh *mesh) {
    for (int s = 0; s < mesh->set_count; s++)
        SF_FREE(mesh->set[s].name, mesh->set[s].node, mesh->set[s].face);
    SF_CLEAR(mesh, mesh->position, mesh->cell_type, mesh->cell_ptr, mesh->cell_node, mesh->cell_layer,
             mesh->set);
}

bool sf_mesh_is_section(const sf_mesh *mesh) {
    return mesh->cell_count > 0 && sf_cell_is_plane(sf_cell_shape_of(mesh->cell_type[0]));
}

void sf_surface_free(sf_surface *surface) {
    SF_CLEAR(surface, surface->position, surface->triangle, surface->solid, surface->hull_position,
             surface->hull_triangle);
}

const sf_node_set *sf_mesh_find_set(const sf_mesh *mesh, const char *name) {
    for (int s = 0; s < mesh->set_count; s++)
        if (strcmp(mesh->set[s].name, name) == 0)
            return &mesh->set[s];
    return NULL;
}

/* Checks that the background mesh can carry smoothing domains. */

/* Cells smaller than this share of the mean make time steps useless and gradients meaningless. */
static const double TINY_CELL = 1e-6;
/* Nodes nearer than this share of the mesh's diagonal count as one point. */
static const double SAME_POINT = 1e-10;

/* Positions of the cell's vertices relative to its first one: no digits are lost far from the origin. */
static int local_vertices(const sf_mesh *mesh, int64_t cell, double x[MAX_VERTICES][3]) {
    const int32_t *node = mesh->cell_node + mesh->cell_ptr[cell];
    int count = (int)(mesh->cell_ptr[cell + 1] - mesh->cell_ptr[cell]);
    const double *origin = mesh->position + 3 * (int64_t)node[0];
    for (int a = 0; a < count; a++)
        sf_sub3(&mesh->position[3 * (int64_t)node[a]], origin, x[a]);
    return count;
}

/* Twice the area of a triangle in the half plane with a corner at the origin, m2. */
static double twice_area(const double a[3], const double b[3]) {
    return a[0] * b[2] - a[2] * b[0];
}

/* Volume of the ring, by Pappus: triangles from the first vertex, each with the radius of its middle. */
static double ring_volume(double radius, int vertices, double x[MAX_VERTICES][3]) {
    double sum = 0;
    for (int k = 1; k + 1 < vertices; k++)
        sum += twice_area(x[k], x[k + 1]) * (radius + (x[k][0] + x[k + 1][0]) / 3);
    return M_PI * sum;
}

double sf_mesh_cell_volume(const sf_mesh *mesh, int64_t cell) {
    double x[MAX_VERTICES][3];
    local_vertices(mesh, cell, x);
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[cell]);
    if (sf_cell_is_plane(shape))
        return ring_volume(mesh->position[3 * (int64_t)mesh->cell_node[mesh->cell_ptr[cell]]],
                           shape->vertices, x);
    double six = 0.0;
    for (int f = 0; f < shape->faces; f++) {
        const int *v = shape->face[f];
        if (sf_cell_face_size(shape, f) == 3) {
            six += sf_triple3(x[v[0]], x[v[1]], x[v[2]]);
            continue;
        }
        double centre[3];
        for (int i = 0; i < 3; i++)
            centre[i] = 0.25 * (x[v[0]][i] + x[v[1]][i] + x[v[2]][i] + x[v[3]][i]);
        for (int a = 0; a < 4; a++)
            six += sf_triple3(centre, x[v[a]], x[v[(a + 1) % 4]]);
    }
    return six / 6.0;
}

/* Largest and smallest of the corners' triple products. */
static void corner_range(const sf_mesh *mesh, int64_t cell, double *low, double *high) {
    double x[MAX_VERTICES][3];
    local_vertices(mesh, cell, x);
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[cell]);
    *low = INFINITY;
    *high = -INFINITY;
    for (int k = 0; k < shape->corners; k++) {
        const int *v = shape->corner[k];
        double e[3][3] = {{0}};
        for (int a = 0; a < 3 && v[a + 1] >= 0; a++)
            sf_sub3(x[v[a + 1]], x[v[0]], e[a]);
        double jacobian = v[3] < 0 ? twice_area(e[0], e[1]) : sf_triple3(e[0], e[1], e[2]);
        *low = fmin(*low, jacobian);
        *high = fmax(*high, jacobian);
    }
}

static void centroid(const sf_mesh *mesh, int64_t cell, double c[3]) {
    int64_t begin = mesh->cell_ptr[cell];
    sf_mesh_middle(mesh, &mesh->cell_node[begin], mesh->cell_ptr[cell + 1] - begin, c);
}

int64_t sf_mesh_orient(sf_mesh *mesh) {
    int64_t flipped = 0;
    for (int64_t k = 0; k < mesh->cell_count; k++) {
        double low, high;
        corner_range(mesh, k, &low, &high);
        if (!(high < 0.0))
            continue;
        int32_t *node = mesh->cell_node + mesh->cell_ptr[k], old[MAX_VERTICES] = {0};
        size_t count = (size_t)(mesh->cell_ptr[k + 1] - mesh->cell_ptr[k]);
        memcpy(old, node, count * sizeof *node);
        for (size_t a = 0; a < count; a++)
            node[a] = old[sf_cell_shape_of(mesh->cell_type[k])->mirror[a]];
        flipped++;
    }
    return flipped;
}

static sf_status check_positions(const sf_mesh *mesh, sf_error *err) {
    for (int64_t n = 0; n < mesh->node_count; n++) {
        const double *x = mesh->position + 3 * n;
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            return SF_FAIL(err, SF_ERR_MODEL, "node %lld has the position (%g, %g, %g) m", (long long)n, x[0],
                           x[1], x[2]);
    }
    return SF_OK;
}

/* A node by its distance along a direction that no lattice has. */
typedef struct sorted_node {
    double along;
    int64_t node;
} sorted_node;

SF_ORDER_BY(compare_along, sorted_node, along, node)

/* Coinciding nodes are an invisible crack: a mesh of parts that were not joined. Near nodes are near along
 * any direction; along an oblique one few others are, unlike along an axis, where a lattice has whole
 * planes. */
static sf_status check_coinciding(const sf_mesh *mesh, sf_error *err) {
    static const double direction[3] = {0.540302305868, 0.614787296915, 0.574617168265};
    size_t n = (size_t)mesh->node_count;
    double low[3], high[3];
    sf_box3(mesh->node_count, mesh->position, low, high);
    double tolerance = SAME_POINT * hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    SF_OWN(sorted_node, order, n, "sorted nodes", err);
    for (size_t k = 0; k < n; k++) {
        const double *x = mesh->position + 3 * k;
        order[k] = (sorted_node){0.0, (int64_t)k};
        for (int i = 0; i < 3; i++)
            order[k].along += direction[i] * (x[i] - low[i]);
    }
    qsort(order, n, sizeof *order, compare_along);
    for (size_t a = 0; a < n && err->status == SF_OK; a++) {
        for (size_t b = a + 1; b < n && order[b].along - order[a].along <= tolerance; b++) {
            const double *x = mesh->position + 3 * order[a].node, *y = mesh->position + 3 * order[b].node;
            if (hypot(hypot(x[0] - y[0], x[1] - y[1]), x[2] - y[2]) > tolerance)
                continue;
            SF_FAIL(err, SF_ERR_MODEL,
                    "nodes %lld and %lld coincide at (%g, %g, %g) m: the parts of the mesh are not joined: "
                    "fuse the volumes (in gmsh BooleanFragments or Coherence)",
                    (long long)order[a].node, (long long)order[b].node, x[0], x[1], x[2]);
            break;
        }
    }
    return err->status;
}

static sf_status check_cells(const sf_mesh *mesh, double *volume, sf_error *err) {
    double sum = 0.0, carry = 0.0, smallest = INFINITY, c[3];
    int64_t smallest_cell = 0;
    for (int64_t k = 0; k < mesh->cell_count; k++) {
        double low, high, v = sf_mesh_cell_volume(mesh, k);
        corner_range(mesh, k, &low, &high);
        if (!(low > 0.0) || !(v > 0.0)) {
            centroid(mesh, k, c);
            return SF_FAIL(err, SF_ERR_MODEL,
                           "cell %lld (%s) at (%g, %g, %g) m is inverted or flat: its volume is %g m3 and "
                           "its smallest corner Jacobian %g m3; both must be above 0",
                           (long long)k, sf_cell_shape_of(mesh->cell_type[k])->name, c[0], c[1], c[2], v,
                           low);
        }
        if (v < smallest) {
            smallest = v;
            smallest_cell = k;
        }
        /* Kahan's sum: with 1e5 cells a plain one loses the digits that show whether the volume is exact. */
        double y = v - carry, t = sum + y;
        carry = (t - sum) - y;
        sum = t;
    }
    double mean = sum / (double)mesh->cell_count;
    if (smallest < TINY_CELL * mean) {
        centroid(mesh, smallest_cell, c);
        return SF_FAIL(err, SF_ERR_MODEL,
                       "cell %lld (%s) at (%g, %g, %g) m is tiny: its volume %g m3 is below %g of the mean "
                       "%g m3",
                       (long long)smallest_cell, sf_cell_shape_of(mesh->cell_type[smallest_cell])->name, c[0],
                       c[1], c[2], smallest, TINY_CELL, mean);
    }
    *volume = sum;
    return SF_OK;
}

sf_status sf_mesh_check(const sf_mesh *mesh, double *volume, sf_error *err) {
    *volume = 0.0;
    if (mesh->cell_count <= 0 || mesh->node_count <= 0)
        return SF_FAIL(err, SF_ERR_MODEL, "the mesh has %lld cells and %lld nodes",
                       (long long)mesh->cell_count, (long long)mesh->node_count);
    if (check_positions(mesh, err) != SF_OK || check_cells(mesh, volume, err) != SF_OK)
        return err->status;
    return check_coinciding(mesh, err);
}
