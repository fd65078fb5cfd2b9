/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/strain_field.h"

#include "base/sets.h"
#include "model/cells.h"
#include <string.h>

/* The deformed free faces of the pad as triangles, without those in symmetry planes. */
typedef struct faces {
    int64_t count;
    int32_t *node;                 /* [count][3] */
    double *x;                     /* [node_count][3] m */
    double *centre, *radius;       /* [count][3], [count] m */
    double low[3], high[3], least; /* m; least radius */
    int32_t *found;                /* [count] room */
    sf_grid grid;
} faces;

static void faces_free(faces *f) {
    sf_grid_free(&f->grid);
    SF_FREE(f->node, f->x, f->centre, f->radius, f->found);
}

/* Adds a face unless it lies in a symmetry plane. */
static void add_face(const sf_results *r, const int32_t node[3], faces *f) {
    double *centre = &f->centre[3 * f->count], *radius = &f->radius[f->count];
    memmove(&f->node[3 * f->count], node, 3 * sizeof *node);
    memset(centre, 0, 3 * sizeof *centre);
    *radius = 0;
    for (int k = 0; k < 9; k++)
        centre[k % 3] += f->x[3 * (int64_t)node[k / 3] + k % 3] / 3;
    for (int k = 0; k < 3; k++)
        *radius = fmax(*radius, sf_distance3(centre, &f->x[3 * (int64_t)node[k]]));
    if (sf_face_is_mirrored(r, node))
        return;
    f->least = fmin(f->least, *radius);
    f->count++;
}

static sf_status faces_find(const sf_results *r, const double *u, faces *f, sf_error *err) {
    int64_t all = 0;
    SF_TRY(sf_skin_triangles(&SF_CELLS_OF(r), &all, &f->node, NULL, err));
    f->x = sf_alloc(err, 3 * (unsigned long)r->node_count, sizeof *f->x, "faces of the pad");
    f->centre = sf_alloc(err, 3 * (unsigned long)all, sizeof *f->centre, "faces of the pad");
    f->radius = sf_alloc(err, (unsigned long)all, sizeof *f->radius, "faces of the pad");
    f->found = sf_alloc(err, (unsigned long)all, sizeof *f->found, "faces of the pad");
    SF_TRY(err->status);
    for (int64_t k = 0; k < 3 * r->node_count; k++)
        f->x[k] = r->position[k] + u[k];
    sf_box3(r->node_count, f->x, f->low, f->high);
    f->least = INFINITY;
    for (int64_t k = 0; k < all; k++)
        add_face(r, &f->node[3 * k], f);
    return f->count > 0 ? sf_grid_build(&f->grid, f->count, f->centre, f->radius, err) : SF_OK;
}

/* Depth (m) of the point x of a triangle of missile or support, of the normal n, behind the nearest face that
 * looks against it; 0: it is not in the foam. It is inside if the nearest face of any direction says so: of
 * those equally near the one that looks most straight at it. */
static double depth_at(const faces *f, const double x[3], const double n[3], double most, int64_t *face) {
    for (double reach = f->least; reach < most; reach *= 2) {
        double nearest = INFINITY, straight = 0, depth = INFINITY;
        int64_t count = sf_grid_gather(&f->grid, x, reach, f->count, f->found);
        for (int64_t k = 0; k < count; k++) {
            const double *c[3];
            double point[3], normal[3];
            int feature;
            for (int a = 0; a < 3; a++)
                c[a] = &f->x[3 * (int64_t)f->node[3 * (int64_t)f->found[k] + a]];
            sf_triangle_nearest(c[0], c[1], c[2], x, point, &feature);
            sf_triangle_normal(c[0], c[1], c[2], normal);
            sf_unit3(normal);
            double distance = sf_distance3(x, point), along = sf_dot3(x, normal) - sf_dot3(point, normal);
            if (distance < nearest * (1 - 1e-9) ||
                (distance < nearest * (1 + 1e-9) && fabs(along) > fabs(straight)))
                straight = along;
            nearest = fmin(nearest, distance);
            if (along < 0 && sf_dot3(normal, n) < 0 && distance < depth) {
                depth = distance;
                *face = f->found[k];
            }
        }
        if (nearest <= reach && (straight >= 0 || depth <= reach))
            return straight < 0 ? depth : 0;
    }
    return 0;
}

/* Measures the vertices and edges of a body's triangles; head: the missile moves with it, NULL: at rest. */
static void measure_body(const sf_results *r, const faces *f, const sf_frame_head *head, int64_t triangles,
                         const int32_t *triangle, const double *position, sf_rim_cut *cut) {
    enum { MOST = 200 }; /* points along an edge */
    for (int64_t k = 0; f->count > 0 && k < 3 * triangles; k++) {
        double x[3][3], normal[3];
        for (int c = 0; c < 3; c++) { /* the edge from x[0] to x[1] */
            const double *rest = &position[3 * (int64_t)triangle[k - k % 3 + (k + c) % 3]];
            memcpy(x[c], rest, sizeof x[c]);
            if (head)
                sf_results_place(r, head, rest, x[c]);
        }
        sf_triangle_normal(x[0], x[1], x[2], normal);
        double parts = fmin(MOST, ceil(sf_distance3(x[0], x[1]) / f->least));
        for (double part = 0; part < parts; part++) {
            double at[3];
            bool near = true;
            int64_t face = 0;
            for (int c = 0; c < 3; c++) {
                at[c] = x[0][c] + part / parts * (x[1][c] - x[0][c]);
                near = near && at[c] > f->low[c] && at[c] < f->high[c];
            }
            double depth = near ? depth_at(f, at, normal, r->thickness, &face) : 0;
            if (depth > cut->depth)
                memcpy(cut->place, &r->position[3 * (int64_t)f->node[3 * face]], sizeof cut->place);
            cut->depth = fmax(cut->depth, depth);
        }
    }
}

sf_status sf_rim_cut_measure(const sf_results *r, const sf_frame_head *head, const double *displacement,
                             sf_rim_cut *cut, sf_error *err) {
    SF_OWNED_BY(faces_free) faces f = {0};
    *cut = (sf_rim_cut){0};
    SF_TRY(faces_find(r, displacement, &f, err));
    measure_body(r, &f, head, r->surface_triangle_count, r->surface_triangle, r->surface_position, cut);
    measure_body(r, &f, NULL, r->support_triangle_count, r->support_triangle, r->support_position, cut);
    return SF_OK;
}
