/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/rigid_surface.h"

#include "base/mat3.h"
#include "base/sets.h"

/* Behind the rim of an open surface a point counts as inside only straight behind it: the part of its ray
 * across the rim's normal may be this much of the part along it, as on the rim of a quarter missile, whose
 * normal is tilted by half the angle between facets, and this much of the reach, as predicted positions waver
 * about a symmetry plane. */
static const double RIM_TILT = 0.2, RIM_WIDTH = 0.01;

static const double *vertex(const sf_missile_surface *s, int64_t triangle, int corner) {
    return &s->position[3 * (int64_t)s->triangle[3 * triangle + corner]];
}

/* Face normals, and the angle-weighted sums at the vertices. */
static void build_normals(sf_missile_surface *s, int64_t triangles) {
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

static sf_status build_edge_normals(sf_missile_surface *s, int64_t triangles, sf_error *err) {
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

static int64_t clamp_bin(const sf_missile_surface *s, int axis, double x) {
    double b = floor((x - s->low[axis]) / s->reach);
    return b < 0 ? 0 : b >= (double)s->bins[axis] ? s->bins[axis] - 1 : (int64_t)b;
}

/* Bins of width `reach` over the plan; each triangle goes to every bin its grown box meets. */
static sf_status build_bins(sf_missile_surface *s, int64_t nodes, int64_t triangles, sf_error *err) {
    sf_box3(nodes, s->position, s->low, s->high);
    for (int a = 0; a < 2; a++)
        s->bins[a] = (int64_t)((s->high[a] - s->low[a]) / s->reach) + 1;
    int64_t bins = s->bins[0] * s->bins[1];
    s->start = sf_alloc(err, bins + 2, sizeof *s->start, "missile bins");
    for (int pass = 0; pass < 2 && err->status == SF_OK; pass++) {
        for (int64_t t = 0; t < triangles; t++) {
            int64_t range[2][2];
            for (int a = 0; a < 2; a++) {
                double x = vertex(s, t, 0)[a], y = vertex(s, t, 1)[a], z = vertex(s, t, 2)[a];
                range[a][0] = clamp_bin(s, a, fmin(x, fmin(y, z)) - s->reach);
                range[a][1] = clamp_bin(s, a, fmax(x, fmax(y, z)) + s->reach);
            }
            for (int64_t i = range[0][0]; i <= range[0][1]; i++)
                for (int64_t j = range[1][0]; j <= range[1][1]; j++) {
                    if (pass == 0)
                        s->start[i * s->bins[1] + j + 2]++;
                    else
                        s->member[s->start[i * s->bins[1] + j + 1]++] = (int32_t)t;
                }
        }
        if (pass == 0) {
            for (int64_t b = 0; b < bins; b++)
                s->start[b + 2] += s->start[b + 1];
            s->member = sf_alloc(err, (unsigned long)s->start[bins + 1], sizeof *s->member, "missile bins");
        }
    }
    return err->status;
}

sf_status sf_missile_surface_build(const sf_model *m, const double axis[3], sf_missile_surface *s,
                                   sf_error *err) {
    memset(s, 0, sizeof *s);
    s->shape = m->missile.shape;
    s->radius = m->missile.sphere_radius;
    s->cap_cosine = m->missile.sphere_cap_cosine;
    memcpy(s->centre, m->missile.sphere_centre, sizeof s->centre);
    memcpy(s->axis, axis, sizeof s->axis);
    s->spacing = INFINITY;
    for (int64_t c = 0; c < m->contact_count; c++) {
        s->spacing = fmin(s->spacing, m->spacing[m->contact_node[c]]);
        s->reach = fmax(s->reach, m->spacing[m->contact_node[c]]);
    }
    if (s->shape == SF_SHAPE_SPHERE)
        return SF_OK;
    int64_t triangles = m->surface_triangle_count;
    s->position = m->surface_position;
    s->triangle = m->surface_triangle;
    SF_ALLOC_ALL(err, "missile normals", SF_ROOM(s->normal, 3 * triangles),
                 SF_ROOM(s->edge_normal, 9 * triangles),
                 SF_ROOM(s->vertex_normal, 3 * m->surface_node_count));
    SF_ALLOC_ALL(err, "missile rim", SF_ROOM(s->rim_edge, 3 * triangles),
                 SF_ROOM(s->rim_vertex, m->surface_node_count));
    if (err->status == SF_OK) {
        build_normals(s, triangles);
        if (build_edge_normals(s, triangles, err) == SF_OK)
            build_bins(s, m->surface_node_count, triangles, err);
    }
    if (err->status != SF_OK)
        sf_missile_surface_free(s);
    return err->status;
}

void sf_missile_surface_free(sf_missile_surface *s) {
    SF_CLEAR(s, s->normal, s->vertex_normal, s->edge_normal, s->rim_edge, s->rim_vertex, s->start, s->member);
}

static bool sphere_gap(const sf_missile_surface *s, const double x[3], double *gap, double normal[3]) {
    double r[3];
    sf_sub3(x, s->centre, r);
    double distance = sqrt(sf_dot3(r, r));
    if (!(distance > 0) || sf_dot3(r, s->axis) < (s->cap_cosine - 1e-9) * distance)
        return false;
    *gap = distance - s->radius;
    for (int k = 0; k < 3; k++)
        normal[k] = r[k] / distance;
    return true;
}

static const double *feature_normal(const sf_missile_surface *s, int64_t triangle, int feature) {
    if (feature == 6)
        return &s->normal[3 * triangle];
    if (feature >= 3)
        return &s->edge_normal[3 * (3 * triangle + feature - 3)];
    return &s->vertex_normal[3 * (int64_t)s->triangle[3 * triangle + feature]];
}

static bool feature_on_rim(const sf_missile_surface *s, int64_t triangle, int feature) {
    if (feature == 6)
        return false;
    return feature >= 3 ? s->rim_edge[3 * triangle + feature - 3]
                        : s->rim_vertex[s->triangle[3 * triangle + feature]];
}

static bool triangles_gap(const sf_missile_surface *s, const double x[3], double *gap, double normal[3]) {
    double best = s->reach * s->reach, ray[3] = {0};
    const double *outward = NULL;
    bool rim = false;
    for (int a = 0; a < 2; a++)
        if (x[a] < s->low[a] - s->reach || x[a] > s->low[a] + s->reach * (double)(s->bins[a] + 1))
            return false;
    int64_t bin = clamp_bin(s, 0, x[0]) * s->bins[1] + clamp_bin(s, 1, x[1]);
    for (int64_t k = s->start[bin]; k < s->start[bin + 1]; k++) {
        double point[3], r[3];
        int feature;
        int64_t t = s->member[k];
        sf_triangle_nearest(vertex(s, t, 0), vertex(s, t, 1), vertex(s, t, 2), x, point, &feature);
        sf_sub3(x, point, r);
        if (sf_dot3(r, r) >= best)
            continue;
        best = sf_dot3(r, r);
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

bool sf_missile_surface_near(const sf_missile_surface *s, const double x[3], double margin) {
    double r[3];
    if (s->shape == SF_SHAPE_SPHERE) {
        sf_sub3(x, s->centre, r);
        return sf_dot3(r, r) <= (s->radius + margin) * (s->radius + margin);
    }
    margin += s->reach; /* as deep behind an open surface a point can be */
    for (int a = 0; a < 3; a++)
        if (x[a] < s->low[a] - margin || x[a] > s->high[a] + margin)
            return false;
    return true;
}

bool sf_missile_surface_gap(const sf_missile_surface *s, const double x[3], double *gap, double normal[3]) {
    return s->shape == SF_SHAPE_SPHERE ? sphere_gap(s, x, gap, normal) : triangles_gap(s, x, gap, normal);
}

/* load [node_count] += Phi^T q0. */
static void add_loads(const sf_model *m, const sf_contact_rows *rows, double *load) {
    for (int64_t c = 0; c < m->rest_count; c++)
        for (int64_t k = rows->ptr[m->contact_count + c]; k < rows->ptr[m->contact_count + c + 1]; k++)
            load[rows->node[k]] += rows->value[k] * m->rest_load[c];
}

sf_status sf_anvil_build(const sf_model *m, const sf_contact_rows *rows, sf_anvil *anvil, sf_error *err) {
    int64_t count = 0;
    memset(anvil, 0, sizeof *anvil);
    if (m->rest_count == 0)
        return SF_OK;
    SF_OWNED double *load = sf_alloc(err, m->node_count, sizeof *load, "weight of the pad");
    if (load)
        add_loads(m, rows, load);
    for (int64_t i = 0; load && i < m->node_count; i++)
        count += load[i] != 0;
    SF_ALLOC_ALL(err, "weight of the pad", SF_ROOM(anvil->node, count), SF_ROOM(anvil->pull, count));
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++)
        if (load[i] != 0) {
            anvil->node[anvil->count] = (int32_t)i;
            anvil->pull[anvil->count++][2] = -load[i];
        }
    if (err->status != SF_OK)
        sf_anvil_free(anvil);
    return err->status;
}

void sf_anvil_free(sf_anvil *anvil) {
    SF_CLEAR(anvil, anvil->node, anvil->pull);
}

void sf_anvil_pull(const sf_anvil *anvil, double *force) {
    for (int64_t k = 0; k < anvil->count; k++)
        for (int r = 0; r < 3; r++)
            force[3 * (int64_t)anvil->node[k] + r] += anvil->pull[k][r];
}

double sf_anvil_work(const sf_anvil *anvil, const double *d) {
    double work = 0;
    for (int64_t k = 0; k < anvil->count; k++)
        work += sf_dot3(anvil->pull[k], &d[3 * (int64_t)anvil->node[k]]);
    return work;
}
