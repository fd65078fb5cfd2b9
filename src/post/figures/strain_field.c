/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/strain_field.h"

#include "base/grid.h"
#include "model/cells.h"
#include "model/ridges.h"
#include <gsl/gsl_sort.h>
#include <string.h>

/* ---- strain over the pad ---- */

static const double SLIP = 1e-6; /* of the thickness: none */
static const double STEEP = 0.7; /* at most of a wall's normal is vertical */

/* The cells of each node: those of node n are cell[first[n]] to cell[first[n + 1] - 1]. */
typedef struct node_cells {
    int64_t *first; /* [node_count + 2] owned */
    int64_t *cell;  /* [cell_nnz] owned */
} node_cells;

static void list_cells(const sf_results *r, node_cells *n) {
    for (int64_t k = 0; k < r->cell_nnz; k++)
        n->first[r->cell_node[k] + 2]++;
    for (int64_t i = 0; i < r->node_count; i++)
        n->first[i + 2] += n->first[i + 1];
    for (int64_t c = 0; c < r->cell_count; c++) /* moves first[i + 1] from the start of node i to its end */
        for (int64_t k = r->cell_ptr[c]; k < r->cell_ptr[c + 1]; k++)
            n->cell[n->first[r->cell_node[k] + 1]++] = c;
}

/* Appends the values of a node's neighbours in its layer, `among` those marked unless it is NULL, to the
 * `count` values in room; room: NULL counts only. */
static int64_t gather(const sf_results *r, const node_cells *n, int64_t node, const bool *among,
                      const double *value, int64_t count, double *room) {
    for (int64_t k = n->first[node]; k < n->first[node + 1]; k++)
        for (int64_t j = r->cell_ptr[n->cell[k]]; j < r->cell_ptr[n->cell[k] + 1]; j++) {
            if (r->cell_node[j] == node || (among && !among[r->cell_node[j]]))
                continue;
            if (room)
                room[count] = value[r->cell_node[j]];
            count++;
        }
    return count;
}

/* ---- nodes of several layers at one place ---- */

static int by_place(const void *a, const void *b, void *positions) {
    int64_t first = *(const int64_t *)a, second = *(const int64_t *)b;
    const double *x = (const double *)positions + 3 * first, *y = (const double *)positions + 3 * second;
    for (int c = 0; c < 3; c++)
        if (x[c] != y[c])
            return x[c] < y[c] ? -1 : 1;
    return (first > second) - (first < second);
}

static bool is_one_place(const sf_results *r, int64_t a, int64_t b) {
    return memcmp(&r->position[3 * a], &r->position[3 * b], 3 * sizeof *r->position) == 0;
}

/* [node_count] the nodes, those at one place one after another; owned by the caller, NULL on failure. */
static int64_t *order_by_place(const sf_results *r, sf_error *err) {
    int64_t *order = sf_alloc(err, r->node_count, sizeof *order, "nodes by place");
    for (int64_t i = 0; order && i < r->node_count; i++)
        order[i] = i;
    if (order)
        qsort_r(order, (size_t)r->node_count, sizeof *order, by_place, r->position);
    return order;
}

/* [node_count] the next node at the same place, in a ring; owned by the caller. */
static int64_t *ring_copies(const sf_results *r, sf_error *err) {
    SF_OWNED int64_t *order = order_by_place(r, err);
    int64_t *next = sf_alloc(err, r->node_count, sizeof *next, "nodes by place");
    for (int64_t k = 0, first = 0; err->status == SF_OK && k < r->node_count; k++) {
        bool last = k + 1 == r->node_count || !is_one_place(r, order[k], order[k + 1]);
        next[order[k]] = last ? order[first] : order[k + 1];
        first = last ? k + 1 : first;
    }
    return next;
}

/* Squared distance (m2) that two nodes at one place have moved apart. */
static double square_apart(const double *displacement, int64_t a, int64_t b) {
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += pow(displacement[3 * a + c] - displacement[3 * b + c], 2);
    return square;
}

/* Nodes at one place have moved together: they are tied, or would be. */
static bool is_together(const sf_results *r, const double *displacement, int64_t a, int64_t b) {
    return square_apart(displacement, a, b) <= pow(SLIP * r->thickness, 2);
}

/* ---- collapse ---- */

/* Returns the upper median: at least half of the values are less than or equal to it. */
static double median(double *value, int64_t count) {
    gsl_sort(value, 1, (size_t)count);
    return value[count / 2];
}

typedef struct collapse_search {
    const sf_results *r;
    const sf_peak_fields *at;
    node_cells cells;
    int64_t *next; /* [node_count] as of ring_copies; NULL: one material; owned */
    bool *wall;    /* [node_count] as of mark_walls; owned */
    double *room;  /* for the neighbours of a node and of its copies; owned */
} collapse_search;

/* True if the three nodes lie in a symmetry plane. */
static bool is_mirrored(const sf_results *r, const int32_t node[3]) {
    double off[2] = {0};
    for (int k = 0; k < 6; k++)
        off[k % 2] += fabs(r->position[3 * (int64_t)node[k / 2] + k % 2] - r->symmetry_place[k % 2]);
    return off[0] < SLIP * r->thickness || off[1] < SLIP * r->thickness;
}

/* Marks the nodes of walls: of steep free faces outside symmetry planes that the missile does not press as a
 * whole. NULL without these fields, or on failure. */
static bool *mark_walls(const sf_results *r, const sf_peak_fields *at, sf_error *err) {
    SF_OWNED int32_t *face = NULL;
    int64_t count = 0;
    if (!at->pressure || sf_skin_triangles(&SF_CELLS_OF(r), &count, &face, NULL, err) != SF_OK)
        return NULL;
    bool *wall = sf_alloc(err, r->node_count, sizeof *wall, "nodes of walls");
    for (int32_t *n = face; wall && n < face + 3 * count; n += 3) {
        double a[3];
        sf_face_normal(r->position, n, a);
        bool is_free = at->pressure[n[0]] <= 0 || at->pressure[n[1]] <= 0 || at->pressure[n[2]] <= 0;
        bool is_wall = is_free && fabs(a[2]) < STEEP * sqrt(sf_dot3(a, a)) && !is_mirrored(r, n);
        for (int c = 0; c < 3 && is_wall; c++)
            wall[n[c]] = true;
    }
    return wall;
}

static int64_t most_neighbours(const collapse_search *s) {
    int64_t most = 0;
    for (int64_t i = 0; i < s->r->node_count; i++) {
        int64_t count = gather(s->r, &s->cells, i, NULL, NULL, 0, NULL);
        for (int64_t j = s->next ? s->next[i] : i; j != i; j = s->next[j])
            count = gather(s->r, &s->cells, j, NULL, NULL, count, NULL);
        most = count > most ? count : most;
    }
    return most;
}

/* Compression of a node above its neighbours, in its layer or in all that are tied there, whichever is less:
 * at a tied interface either side may be the one that carries. The surface of a wall that bends is strained
 * more than what lies behind it: a node of it is compared along the wall, too. */
static double excess_of(const collapse_search *s, int64_t node) {
    const double *value = s->at->compression;
    int64_t own = gather(s->r, &s->cells, node, NULL, value, 0, s->room), all = own;
    if (own == 0)
        return 0;
    for (int64_t j = s->next ? s->next[node] : node; j != node; j = s->next[j])
        if (is_together(s->r, s->at->displacement, node, j))
            all = gather(s->r, &s->cells, j, NULL, value, all, s->room);
    double usual = median(s->room, all); /* sorts the values of all */
    if (all > own) {
        gather(s->r, &s->cells, node, NULL, value, 0, s->room);
        usual = fmax(usual, median(s->room, own));
    }
    if (s->wall && s->wall[node] && !(s->next && s->next[node] != node)) {
        int64_t along = gather(s->r, &s->cells, node, s->wall, value, 0, s->room);
        usual = along > 0 ? fmax(usual, median(s->room, along)) : usual;
    }
    return value[node] - usual;
}

/* Returns the excess that nodes with SF_COLLAPSE_SHARE of the foam's energy reach or exceed; without energies
 * that of a single node. */
static double sustained_excess(const sf_results *r, const double *excess, const double *energy_density,
                               sf_error *err) {
    SF_OWNED size_t *order = sf_alloc(err, r->node_count, sizeof *order, "excess of nodes");
    double all = 0, held = 0;
    if (!order || r->node_count == 0)
        return 0;
    gsl_sort_index(order, excess, 1, (size_t)r->node_count);
    for (int64_t i = 0; energy_density && i < r->node_count; i++)
        all += r->volume[i] * energy_density[i];
    int64_t k = r->node_count - 1;
    while (k > 0 && all > 0 &&
           (held += r->volume[order[k]] * energy_density[order[k]]) < SF_COLLAPSE_SHARE * all)
        k--;
    return fmax(0, excess[order[k]]);
}

sf_status sf_strain_field_collapse(const sf_results *r, const sf_peak_fields *at, double *collapse,
                                   sf_error *err) {
    collapse_search s = {
        .r = r,
        .at = at,
        .cells = {.first = sf_alloc(err, r->node_count + 2, sizeof *s.cells.first, "cells of nodes"),
                  .cell = sf_alloc(err, r->cell_nnz, sizeof *s.cells.cell, "cells of nodes")}};
    SF_OWNED double *excess = sf_alloc(err, r->node_count, sizeof *excess, "excess of nodes");
    *collapse = 0;
    if (err->status == SF_OK) {
        list_cells(r, &s.cells);
        s.next = r->layer_count > 1 && at->displacement ? ring_copies(r, err) : NULL;
        s.wall = mark_walls(r, at, err);
    }
    if (err->status == SF_OK)
        s.room = sf_alloc(err, most_neighbours(&s), sizeof *s.room, "neighbours of a node");
    for (int64_t i = 0; err->status == SF_OK && i < r->node_count; i++)
        excess[i] = at->compression[i] > 0 ? excess_of(&s, i) : 0;
    if (err->status == SF_OK)
        *collapse = sustained_excess(r, excess, at->energy_density, err);
    SF_FREE(s.room, s.next, s.wall, s.cells.first, s.cells.cell);
    return err->status;
}

double sf_strain_field_energy_beyond(const sf_results *r, const double *compression,
                                     const double *energy_density, double strain) {
    double all = 0, beyond = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        double energy = r->volume[i] * energy_density[i];
        all += energy;
        beyond += compression[i] > strain ? energy : 0;
    }
    return all > 0 ? beyond / all : 0;
}

/* ---- layers ---- */

static const double LARGE_SLIP = 0.02; /* of the thickness */

static const sf_row list[] = {{.key = "name",
                               .name = "layer",
                               SF_ROW_OF(STRING, sf_layer_figures, name),
                               .meaning = "of the layer in the case"},
#define ENTRY(member, row_key, row_factor, ...)                                                              \
    {.key = row_key,                                                                                         \
     .factor = row_factor,                                                                                   \
     SF_ROW_OF(NUMBER, sf_layer_figures, member),                                                            \
     .meaning = __VA_ARGS__},
                              SF_LAYER_FIGURES(ENTRY)
#undef ENTRY
};

sf_rows sf_layer_figure_rows(void) {
    return SF_ROWS(list);
}

/* Takes the sums of the solver by layer until the last frame. */
static void take_sums(const sf_results *r, sf_layer_figures *f) {
    for (int k = 0; k < r->layer_count; k++) {
        f[k].max_local_strain = r->layer_sum[SF_LAYER_COMPRESSION][k];
        f[k].stored_energy = r->layer_sum[SF_LAYER_STORED][k];
        f[k].hysteresis_energy = r->layer_sum[SF_LAYER_HYSTERESIS][k];
        f[k].viscous_energy = r->layer_sum[SF_LAYER_VISCOUS][k];
        f[k].absorbed_energy = f[k].stored_energy + f[k].hysteresis_energy + f[k].viscous_energy;
    }
}

/* Adds the energies of the curves at the peak. */
static void add_peak(const sf_results *r, const double *compression, const double *energy_density,
                     sf_layer_figures *f) {
    double all = 0;
    for (int k = 0; k < r->layer_count; k++)
        f[k].energy_share = f[k].energy_beyond_data = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        sf_layer_figures *own = &f[r->node_layer[i]];
        double energy = r->volume[i] * energy_density[i];
        own->energy_share += energy;
        own->energy_beyond_data += compression[i] > own->informed_strain ? energy : 0;
        all += energy;
    }
    for (int k = 0; k < r->layer_count; k++) {
        f[k].energy_beyond_data = f[k].energy_share > 0 ? f[k].energy_beyond_data / f[k].energy_share : 0;
        f[k].energy_share = all > 0 ? f[k].energy_share / all : 0;
    }
}

sf_layer_figures *sf_layer_figures_compute(const sf_results *r, const double *compression,
                                           const double *energy_density, sf_error *err) {
    sf_layer_figures *f =
        r->layer_count > 0 ? sf_alloc(err, r->layer_count, sizeof *f, "the figures of the layers") : NULL;
    if (!f)
        return NULL;
    for (int k = 0; k < r->layer_count; k++) {
        for (size_t q = 0; q < sizeof list / sizeof list[0]; q++)
            if (list[q].type == SF_ROW_NUMBER)
                *(double *)((char *)&f[k] + list[q].offset) = NAN;
        f[k].name = r->layer_name[k];
        f[k].density = r->layer_density[k];
        f[k].informed_strain = r->layer_informed[k];
        f[k].volume = 0;
    }
    for (int64_t i = 0; i < r->node_count; i++)
        f[r->node_layer[i]].volume += sf_results_whole(r) * r->volume[i];
    if (r->layer_sum[0])
        take_sums(r, f);
    if (compression && energy_density)
        add_peak(r, compression, energy_density, f);
    return f;
}

/* Returns the largest distance (m) between nodes that were at one place, and one of them in `at`. */
static double largest_slip(const sf_results *r, const double *displacement, const int64_t *order,
                           int64_t *at) {
    double most = 0;
    for (int64_t k = 1; k < r->node_count; k++) {
        if (!is_one_place(r, order[k], order[k - 1]))
            continue;
        double square = square_apart(displacement, order[k], order[k - 1]);
        if (square > most) {
            most = square;
            *at = order[k];
        }
    }
    return sqrt(most);
}

sf_status sf_layers_note_slip(sf_results *r, sf_error *err) {
    SF_OWNED_BY(sf_frame_free) sf_frame peak = {0};
    if (r->layer_count == 0 || !r->has_peak ||
        sf_frame_read(r, &r->peak, SF_FIELD_DISPLACEMENT, &peak, SF_IGNORED) != SF_OK)
        return SF_OK; /* the figures say what is damaged */
    SF_OWNED int64_t *order = order_by_place(r, err);
    int64_t at = 0;
    double slip = order && peak.field[SF_FRAME_DISPLACEMENT]
                      ? largest_slip(r, peak.field[SF_FRAME_DISPLACEMENT], order, &at)
                      : 0;
    const double *x = &r->position[3 * at];
    if (slip > LARGE_SLIP * r->thickness)
        sf_results_note(r,
                        "layers slide on each other by up to %.3g mm, at (%.4g, %.4g, %.4g) mm: their ties "
                        "hold along the undeformed normal, which is right for small slips",
                        1e3 * slip, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    return err->status;
}

/* ---- the missile in faces between nodes ---- */

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
    if (is_mirrored(r, node))
        return;
    f->least = fmin(f->least, *radius);
    f->count++;
}

static sf_status faces_find(const sf_results *r, const double *u, faces *f, sf_error *err) {
    int64_t all = 0;
    SF_TRY(sf_skin_triangles(&SF_CELLS_OF(r), &all, &f->node, NULL, err));
    SF_TRY(SF_ALLOC_ALL(err, "faces of the pad", SF_ROOM(f->x, 3 * r->node_count),
                        SF_ROOM(f->centre, 3 * all), SF_ROOM(f->radius, all), SF_ROOM(f->found, all)));
    for (int64_t k = 0; k < 3 * r->node_count; k++)
        f->x[k] = r->position[k] + u[k];
    sf_box3(r->node_count, f->x, f->low, f->high);
    f->least = INFINITY;
    for (int64_t k = 0; k < all; k++)
        add_face(r, &f->node[3 * k], f);
    return f->count > 0 ? sf_grid_build(&f->grid, f->count, f->centre, f->radius, err) : SF_OK;
}

/* Depth (m) of the point x in the foam: its distance from the nearest face, of those equally near the one
 * that looks most straight at it; 0: it is outside. */
static double depth_at(const faces *f, const double x[3], double most, int64_t *face) {
    for (double reach = f->least; reach < most; reach *= 2) {
        double nearest = INFINITY, straight = 0;
        int64_t count = sf_grid_gather(&f->grid, x, reach, f->count, f->found);
        for (int64_t k = 0; k < count; k++) {
            const double *c[3];
            double point[3], normal[3];
            int feature;
            sf_corners(f->x, &f->node[3 * (int64_t)f->found[k]], c);
            sf_triangle_nearest(c[0], c[1], c[2], x, point, &feature);
            sf_triangle_normal(c[0], c[1], c[2], normal);
            sf_unit3(normal);
            double distance = sf_distance3(x, point), along = sf_dot3(x, normal) - sf_dot3(point, normal);
            if (distance < nearest * (1 - 1e-9) ||
                (distance < nearest * (1 + 1e-9) && fabs(along) > fabs(straight))) {
                straight = along;
                *face = f->found[k];
            }
            nearest = fmin(nearest, distance);
        }
        if (nearest <= reach)
            return straight < 0 ? nearest : 0;
    }
    return 0;
}

/* Shortest edge (m) of a face at rest. */
static double spacing_at(const sf_results *r, const faces *f, int64_t face) {
    const double *x[3];
    sf_corners(r->position, &f->node[3 * face], x);
    return fmin(sf_distance3(x[0], x[1]), fmin(sf_distance3(x[1], x[2]), sf_distance3(x[2], x[0])));
}

/* Measures points along an edge of a body from a to b, less the depth that is allowed, as a part of the
 * spacing; head: the missile moves with it, NULL: at rest. In a section the edge is the point of the profile
 * where it goes through y = 0. */
static void measure_edge(const sf_results *r, const faces *f, const sf_frame_head *head, const double *a,
                         const double *b, double allowed, sf_rim_cut *cut) {
    enum { MOST = 200 }; /* points along an edge */
    double x[2][3];
    const double middle[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
    if (r->axisymmetric && !(a[1] * b[1] < 0 && middle[0] > 0))
        return;
    a = r->axisymmetric ? middle : a;
    b = r->axisymmetric ? middle : b;
    memcpy(x[0], a, sizeof x[0]);
    memcpy(x[1], b, sizeof x[1]);
    if (head) {
        sf_results_place(r, head, a, x[0]);
        sf_results_place(r, head, b, x[1]);
    }
    double parts = fmin(MOST, ceil(4 * sf_distance3(x[0], x[1]) / f->least - 1e-6)); /* not by a rounding */
    for (double part = 0; part <= parts; part++) {
        double at[3];
        bool near = true;
        int64_t face = 0;
        for (int c = 0; c < 3; c++) {
            at[c] = x[0][c] + (parts > 0 ? part / parts : 0) * (x[1][c] - x[0][c]);
            near = near && at[c] >= f->low[c] && at[c] <= f->high[c];
        }
        double depth = near ? depth_at(f, at, r->thickness, &face) : 0, spacing = spacing_at(r, f, face);
        depth -= allowed * spacing;
        cut->share = fmax(cut->share, depth / spacing);
        if (depth > cut->depth)
            memcpy(cut->place, &r->position[3 * (int64_t)f->node[3 * face]], sizeof cut->place);
        cut->depth = fmax(cut->depth, depth);
    }
}

/* Lists the triangles of a surface that reach as near to y = 0 as those that go through it, with which they
 * may share a node: a section is measured by no other. */
static int64_t list_at_section(int64_t triangles, const int32_t *triangle, const double *position,
                               int32_t *out) {
    double width = 0;
    int64_t count = 0;
    for (int turn = 0; turn < 2; turn++)
        for (int64_t k = 0; k < triangles; k++) {
            const double *x[3];
            sf_corners(position, &triangle[3 * k], x);
            double low = fmin(x[0][1], fmin(x[1][1], x[2][1])), high = fmax(x[0][1], fmax(x[1][1], x[2][1]));
            if (turn == 0 && low < 0 && high > 0)
                width = fmax(width, fmax(-low, high));
            else if (turn == 1 && low <= width && high >= -width)
                memcpy(&out[3 * count++], &triangle[3 * k], 3 * sizeof *out);
        }
    return count;
}

/* The surface of a rigid body; borrowed from the results. */
typedef struct surface {
    int64_t nodes, triangles;
    const int32_t *triangle; /* [triangles][3] */
    const double *position;  /* [nodes][3] m */
} surface;

/* Measures a body: its sharp edges and vertices as they are, and all edges of its triangles beyond the depth
 * that a smooth surface has in chords of the pad (model/ridges.h). */
static sf_status measure_body(const sf_results *r, const faces *f, const sf_frame_head *head, surface body,
                              sf_rim_cut *cut, sf_error *err) {
    SF_OWNED_BY(sf_ridges_free) sf_ridges sharp = {0};
    SF_OWNED int32_t *section = NULL;
    if (f->count == 0 || body.triangles == 0)
        return SF_OK;
    if (r->axisymmetric) {
        section = sf_alloc(err, 3 * (unsigned long)body.triangles, sizeof *section, "edges of a surface");
        SF_TRY(err->status);
        body.triangles = list_at_section(body.triangles, body.triangle, body.position, section);
        body.triangle = section;
    }
    sf_ridge_limits limits = {.spacing = cut->spacing,
                              .depth = r->axisymmetric ? SF_SECTION_DEPTH : SF_SMOOTH_DEPTH};
    memcpy(limits.place, r->symmetry_place, sizeof limits.place);
    SF_TRY(sf_ridges_find(body.nodes, body.position, body.triangles, body.triangle, &limits, &sharp, err));
    for (int64_t k = 0; k < sharp.count; k++)
        measure_edge(r, f, head, &body.position[3 * (int64_t)sharp.ridge[k].node[0]],
                     &body.position[3 * (int64_t)sharp.ridge[k].node[1]], 0, cut);
    for (int64_t k = 0; k < sharp.corner_count; k++) {
        const double *x = &body.position[3 * (int64_t)sharp.corner[k]];
        measure_edge(r, f, head, x, x, 0, cut);
    }
    for (int64_t k = 0; k < 3 * body.triangles; k++)
        measure_edge(r, f, head, &body.position[3 * (int64_t)body.triangle[k]],
                     &body.position[3 * (int64_t)body.triangle[k - k % 3 + (k + 1) % 3]], SF_SMOOTH_DEPTH,
                     cut);
    return SF_OK;
}

sf_status sf_rim_cut_measure(const sf_results *r, const sf_frame_head *head, const double *displacement,
                             sf_rim_cut *cut, sf_error *err) {
    SF_OWNED_BY(faces_free) faces f = {0};
    *cut = (sf_rim_cut){0};
    SF_TRY(faces_find(r, displacement, &f, err));
    cut->spacing = INFINITY;
    for (int64_t k = 0; k < f.count; k++) {
        double spacing = spacing_at(r, &f, k);
        cut->spacing = spacing > 0 ? fmin(cut->spacing, spacing) : cut->spacing;
    }
    const surface missile = {r->surface_node_count, r->surface_triangle_count, r->surface_triangle,
                             r->surface_position},
                  support = {r->support_node_count, r->support_triangle_count, r->support_triangle,
                             r->support_position};
    SF_TRY(measure_body(r, &f, head, missile, cut, err));
    return measure_body(r, &f, NULL, support, cut, err);
}
