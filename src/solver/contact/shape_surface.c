/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_surface.h"

#include "base/grid.h"
#include "base/sets.h"
#include "solver/contact/pair.h"

typedef struct surface {
    int64_t triangles;
    const double *position;  /* borrowed from the model */
    const int32_t *triangle; /* borrowed */
    double *normal;          /* [triangles][3] unit, outward */
    double *vertex_normal;   /* [nodes][3] angle-weighted */
    double *edge_normal;     /* [triangles][3 edges][3] sum of both faces' normals, edge k from vertex k on */
    uint8_t *rim_edge;       /* [triangles][3 edges] 1 = no second face */
    uint8_t *rim_vertex;     /* [nodes] 1 = end of such an edge */
    double reach;            /* m, larger gaps are not searched for */
    double low[3], high[3];  /* of all nodes */
    double *centre, *radius; /* [triangles] m, of a ball round each */
    sf_grid grid;            /* of these */
    int32_t *found;          /* [triangles] room of a query: one thread at a time */
} surface;

/* Behind the rim of an open surface a point counts as inside only straight behind it: the part of its ray
 * across the rim's normal may be this much of the part along it, as on the rim of a quarter missile, whose
 * normal is tilted by half the angle between facets, and this much of the reach, as predicted positions waver
 * about a symmetry plane. */
static const double RIM_TILT = 0.2, RIM_WIDTH = 0.01;

static const double *vertex(const surface *s, int64_t triangle, int corner) {
    return &s->position[3 * (int64_t)s->triangle[3 * triangle + corner]];
}

/* Face normals, and the angle-weighted sums at the vertices. */
static void build_normals(surface *s, int64_t triangles) {
    for (int64_t t = 0; t < triangles; t++) {
        double u[3], v[3];
        sf_triangle_normal(vertex(s, t, 0), vertex(s, t, 1), vertex(s, t, 2), &s->normal[3 * t]);
        sf_unit3(&s->normal[3 * t]);
        for (int corner = 0; corner < 3; corner++) {
            sf_sub3(vertex(s, t, (corner + 1) % 3), vertex(s, t, corner), u);
            sf_sub3(vertex(s, t, (corner + 2) % 3), vertex(s, t, corner), v);
            sf_unit3(u);
            sf_unit3(v);
            double angle = acos(fmax(-1, fmin(1, sf_dot3(u, v))));
            for (int k = 0; k < 3; k++)
                s->vertex_normal[3 * (int64_t)s->triangle[3 * t + corner] + k] +=
                    angle * s->normal[3 * t + k];
        }
    }
}

static sf_status build_edge_normals(surface *s, int64_t triangles, sf_error *err) {
    SF_OWNED sf_half_edge *edge = sf_half_edges(triangles, s->triangle, err);
    for (int64_t first = 0, end; edge && first < 3 * triangles; first = end) {
        double sum[3] = {0};
        end = sf_half_edges_end(edge, first, 3 * triangles);
        for (int64_t k = first; k < end; k++)
            for (int c = 0; c < 3; c++)
                sum[c] += s->normal[3 * (edge[k].slot / 3) + c];
        for (int64_t k = first; k < end; k++)
            memcpy(&s->edge_normal[3 * edge[k].slot], sum, sizeof sum);
        if (end == first + 1)
            s->rim_edge[edge[first].slot] = s->rim_vertex[edge[first].low] = s->rim_vertex[edge[first].high] =
                1;
    }
    return err->status;
}

/* The balls round the triangles, in a grid. */
static sf_status build_grid(surface *s, sf_error *err) {
    SF_TRY(SF_ALLOC_ALL(err, "missile grid", SF_ROOM(s->centre, 3 * s->triangles),
                        SF_ROOM(s->radius, s->triangles), SF_ROOM(s->found, s->triangles)));
    for (int64_t t = 0; t < s->triangles; t++)
        sf_grid_ball(s->position, &s->triangle[3 * t], &s->centre[3 * t], &s->radius[t]);
    return sf_grid_build(&s->grid, s->triangles, s->centre, s->radius, err);
}

static void release(void *data) {
    surface *s = data;
    sf_grid_free(&s->grid);
    SF_CLEAR(s, s->normal, s->vertex_normal, s->edge_normal, s->rim_edge, s->rim_vertex, s->centre, s->radius,
             s->found);
    free(s);
}

static sf_shape_triangles triangles_of(const sf_model *m, int body) {
    if (body != SF_BODY_MISSILE || m->missile.shape != SF_SHAPE_SURFACE)
        return (sf_shape_triangles){0};
    return (sf_shape_triangles){m->surface_node_count, m->surface_triangle_count, m->surface_position,
                                m->surface_triangle};
}

static sf_status build(const sf_model *m, int body, double reach, void **data, sf_error *err) {
    const sf_shape_triangles of = triangles_of(m, body);
    int64_t triangles = of.count;
    if (triangles == 0)
        return SF_OK;
    surface *s = *data = sf_alloc(err, 1, sizeof *s, "missile surface");
    SF_TRY(err->status);
    s->reach = reach;
    s->triangles = triangles;
    s->position = of.position;
    s->triangle = of.triangle;
    SF_TRY(SF_ALLOC_ALL(err, "missile normals", SF_ROOM(s->normal, 3 * triangles),
                        SF_ROOM(s->edge_normal, 9 * triangles),
                        SF_ROOM(s->vertex_normal, 3 * of.node_count)));
    SF_TRY(SF_ALLOC_ALL(err, "missile rim", SF_ROOM(s->rim_edge, 3 * triangles),
                        SF_ROOM(s->rim_vertex, of.node_count)));
    sf_box3(of.node_count, s->position, s->low, s->high);
    build_normals(s, triangles);
    SF_TRY(build_edge_normals(s, triangles, err));
    return build_grid(s, err);
}

static const double *feature_normal(const surface *s, int64_t triangle, int feature) {
    if (feature == 6)
        return &s->normal[3 * triangle];
    if (feature >= 3)
        return &s->edge_normal[3 * (3 * triangle + feature - 3)];
    return &s->vertex_normal[3 * (int64_t)s->triangle[3 * triangle + feature]];
}

static bool feature_on_rim(const surface *s, int64_t triangle, int feature) {
    if (feature == 6)
        return false;
    return feature >= 3 ? s->rim_edge[3 * triangle + feature - 3]
                        : s->rim_vertex[s->triangle[3 * triangle + feature]];
}

static bool gap(const void *data, const double x[3], double *gap, double normal[3]) {
    const surface *s = data;
    double best = s->reach * s->reach, ray[3] = {0};
    const double *outward = NULL;
    bool rim = false;
    int64_t nearest = -1, found = sf_grid_gather(&s->grid, x, s->reach, s->triangles, s->found);
    for (int64_t k = 0; k < found; k++) {
        double point[3], r[3];
        int feature;
        int64_t t = s->found[k];
        sf_triangle_nearest(vertex(s, t, 0), vertex(s, t, 1), vertex(s, t, 2), x, point, &feature);
        sf_sub3(x, point, r);
        double square = sf_dot3(r, r);
        if (square > best || (square == best && (nearest < 0 || t > nearest)))
            continue;
        best = square;
        nearest = t;
        memcpy(ray, r, sizeof ray);
        outward = feature_normal(s, t, feature);
        rim = feature_on_rim(s, t, feature);
    }
    if (!outward)
        return false;
    double along = sf_dot3(ray, outward), side = along < 0 ? -1 : 1;
    if (rim && along < 0) {
        double depth = -along / sqrt(sf_dot3(outward, outward)), across = sqrt(fmax(0, best - depth * depth));
        if (across > RIM_TILT * depth + RIM_WIDTH * s->reach)
            return false;
    }
    *gap = side * sqrt(best);
    /* The direction to the nearest point is the normal, except on the surface, where it is rounding noise. */
    bool near = best < 1e-12 * s->reach * s->reach;
    for (int k = 0; k < 3; k++)
        normal[k] = near ? outward[k] : side * ray[k];
    sf_unit3(normal);
    return true;
}

static bool is_near(const void *data, const double x[3], double margin) {
    const surface *s = data;
    margin += s->reach; /* as deep behind an open surface a point can be */
    for (int a = 0; a < 3; a++)
        if (x[a] < s->low[a] - margin || x[a] > s->high[a] + margin)
            return false;
    return true;
}

const sf_shape sf_shape_surface = {.build = build,
                                   .release = release,
                                   .is_near = is_near,
                                   .gap = gap,
                                   .triangles = triangles_of,
                                   .meet = sf_pair_missile,
                                   .entry = 0.1,
                                   .deepest = INFINITY,
                                   .back = INFINITY};
