/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/self_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/grid.h"
#include "base/mat3.h"
#include "base/lanes.h"

/* Partners of a node: a facet, or one of these. */
enum { NOTHING = -1, FIRST_PLANE = -2 }; /* plane k: FIRST_PLANE - k */
enum { CANDIDATES = SF_SELF_CANDIDATES, MAX_SWEEPS = 60 };
static const double NEAR = 1.2;     /* spacings: reach of the candidates */
static const double DEEPEST = 0.5;  /* of the spacing: no deeper does it go on */
static const double RETURN = 0.1;   /* m s-1: no faster is a depth taken back */
static const double OPPOSED = -0.5; /* largest cosine of the normals of a node and the face that it touches */
static const double FACING = -0.7;  /* largest cosine, at rest, of neighbours that look at each other */
static const double EDGE = 0.05;    /* of a face, in its barycentric coordinates: it reaches so far beyond */
/* Largest change of a force, relative to the largest force, at which the sweeps end, and beyond which it is
 * told that they did not settle. */
static const double SWEEP_TOLERANCE = 1e-5, UNSETTLED = 1e-3;

/* ---- positions ---- */

/* Position, motion in the last step, and motion in the next one without these forces, of the nodes listed. */
static void move_nodes(const sf_model *m, const sf_skin *skin, sf_state *s, double dt_v, int64_t count,
                       const int32_t *list) {
#pragma omp parallel for if (count > SF_FEW_POINTS) default(none) shared(m, skin, s, dt_v, count, list)      \
    schedule(static)
    for (int64_t k = 0; k < count; k++) {
        int64_t p = list[k];
        double now[3] = {0}, last[3] = {0}, change[3] = {0};
        for (int64_t e = skin->rows.ptr[p]; e < skin->rows.ptr[p + 1]; e++) {
            int64_t i = skin->rows.node[e];
            double phi = skin->rows.value[e], inverse = phi * dt_v / m->mass[i];
            for (int r = 0; r < 3; r++) {
                now[r] += phi * s->d[3 * i + r];
                last[r] += phi * s->v[3 * i + r];
                change[r] += inverse * (s->force[3 * i + r] - s->reaction[3 * i + r]) +
                             phi * dt_v * s->self_push[3 * i + r];
            }
        }
        for (int r = 0; r < 3; r++) {
            s->self_position[3 * p + r] = skin->rest[3 * p + r] + now[r];
            s->self_motion[3 * p + r] = s->dt_old * last[r];
            s->self_step[3 * p + r] = s->dt * (last[r] + change[r]);
        }
    }
}

static void facet_normal(const sf_skin *skin, const sf_state *s, int64_t f, double normal[3]) {
    const int32_t *n = &skin->facet[3 * f];
    double side[2][3];
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < 3; r++)
            side[k][r] =
                s->self_position[3 * (int64_t)n[k + 1] + r] - s->self_position[3 * (int64_t)n[0] + r];
    sf_cross3(side[0], side[1], normal);
}

/* True if plane k may stop the node: not if it is held there, or rests on the anvil already. */
static bool is_stopped(const sf_skin *skin, int64_t p, int k) {
    return skin->plane[k].side != 0 && !sf_skin_is_rigid(skin, p) &&
           !((skin->held[p] >> skin->plane[k].axis) & 1) && !(k == SF_SKIN_ANVIL && skin->rests[p]);
}

/* Height (m) of the node over plane k. */
static double height_over(const sf_skin *skin, const sf_state *s, int64_t p, int k) {
    const sf_skin_plane *plane = &skin->plane[k];
    return plane->side * (s->self_position[3 * p + plane->axis] - plane->place);
}

/* ---- candidates ---- */

/* The neighbourhood of a node on the skin: the nodes within RINGS facets of it. Its facets are no candidates
 * but where they look at the node from rest on, as those beside the tip of a slit do: a crease of a smooth
 * surface or of a corner that is narrower lies below the resolution of the cloud, and the foam's own stress
 * keeps its sides apart. */
enum { RINGS = 1 };
typedef struct neighbourhood {
    uint8_t *is_near; /* [count] of the skin */
    int32_t *list;    /* [count] those with 1 in it */
    int64_t count;
} neighbourhood;

static void find_neighbourhood(const sf_skin *skin, int64_t p, neighbourhood *n) {
    while (n->count > 0)
        n->is_near[n->list[--n->count]] = 0;
    n->list[n->count++] = (int32_t)p;
    n->is_near[p] = 1;
    for (int64_t ring = 0, first = 0; ring < RINGS; ring++) {
        int64_t last = n->count;
        for (; first < last; first++)
            for (int64_t k = skin->ring_ptr[n->list[first]]; k < skin->ring_ptr[n->list[first] + 1]; k++)
                for (int c = 0; c < 3; c++) {
                    int32_t other = skin->facet[3 * (int64_t)skin->ring[k] + c];
                    if (!n->is_near[other])
                        n->list[n->count++] = other;
                    n->is_near[other] = 1;
                }
    }
}

static bool is_candidate(const sf_skin *skin, const neighbourhood *n, int64_t p, int64_t f) {
    const int32_t *facet = &skin->facet[3 * f];
    if (facet[0] == p || facet[1] == p || facet[2] == p)
        return false;
    if (!n->is_near[facet[0]] && !n->is_near[facet[1]] && !n->is_near[facet[2]])
        return true;
    return sf_dot3(&skin->normal[3 * p], &skin->facet_normal[3 * f]) < FACING;
}

/* The facets of pad and support as they lie now, each with its grid. */
typedef struct facets {
    double *centre, *radius; /* [facet_count] m, of a ball round each */
    sf_grid pad, support;
    int64_t first_rigid; /* the support's first facet */
    int32_t *found;      /* [facet_count] room */
} facets;

static void facets_free(facets *f) {
    sf_grid_free(&f->pad);
    sf_grid_free(&f->support);
    free(f->centre);
    free(f->radius);
    free(f->found);
}

static void surround(const sf_skin *skin, const sf_state *s, int64_t f, double centre[3], double *radius) {
    double corner[3][3], square = 0;
    for (int k = 0; k < 3; k++)
        memcpy(corner[k], &s->self_position[3 * (int64_t)skin->facet[3 * f + k]], sizeof corner[k]);
    for (int r = 0; r < 3; r++)
        centre[r] = (corner[0][r] + corner[1][r] + corner[2][r]) / 3;
    for (int k = 0; k < 3; k++) {
        for (int r = 0; r < 3; r++)
            corner[k][r] -= centre[r];
        square = fmax(square, sf_dot3(corner[k], corner[k]));
    }
    *radius = sqrt(square);
}

static sf_status facets_find(const sf_skin *skin, const sf_state *s, facets *f, sf_error *err) {
    unsigned long count = (unsigned long)skin->facet_count;
    *f = (facets){.centre = sf_alloc(err, 3 * count, sizeof *f->centre, "candidates of contact"),
                  .radius = sf_alloc(err, count, sizeof *f->radius, "candidates of contact"),
                  .found = sf_alloc(err, count, sizeof *f->found, "candidates of contact")};
    for (int64_t k = 0; err->status == SF_OK && k < skin->facet_count; k++) {
        surround(skin, s, k, &f->centre[3 * k], &f->radius[k]);
        f->first_rigid += !sf_skin_is_rigid(skin, skin->facet[3 * k]);
    }
    int64_t rigid = skin->facet_count - f->first_rigid;
    if (err->status == SF_OK)
        sf_grid_build(&f->pad, f->first_rigid, f->centre, f->radius, err);
    if (err->status == SF_OK && rigid > 0)
        sf_grid_build(&f->support, rigid, &f->centre[3 * f->first_rigid], &f->radius[f->first_rigid], err);
    return err->status;
}

/* The nearest of facets, by distance (m). */
typedef struct nearest {
    int count, room;
    int32_t facet[CANDIDATES];
    double distance[CANDIDATES];
    double left_out; /* m, distance of the nearest that has no place */
} nearest;

static void insert(nearest *n, int32_t facet, double distance) {
    int k = n->count < n->room ? n->count++ : n->room;
    if (k == n->room)
        n->left_out = fmin(n->left_out, fmax(distance, n->distance[k - 1]));
    if (k == n->room && distance >= n->distance[--k])
        return;
    for (; k > 0 && n->distance[k - 1] > distance; k--) {
        n->distance[k] = n->distance[k - 1];
        n->facet[k] = n->facet[k - 1];
    }
    n->distance[k] = distance;
    n->facet[k] = facet;
}

/* Adds the facets across the gap between pad and support, those of a grid whose first is `first`, that node p
 * can reach; what has no place makes the lists due earlier. */
static int add_across(const sf_skin *skin, sf_state *s, int64_t p, double reach, const facets *f,
                      const sf_grid *grid, int64_t first, int count) {
    const double *x = &s->self_position[3 * p];
    nearest n = {.room = CANDIDATES - count, .left_out = INFINITY};
    int64_t found = sf_grid_query(grid, x, reach, skin->facet_count, f->found);
    for (int64_t k = 0; k < found; k++) {
        const int32_t *node = &skin->facet[3 * (first + f->found[k])];
        double point[3], square = 0;
        int feature;
        sf_triangle_nearest(&s->self_position[3 * (int64_t)node[0]], &s->self_position[3 * (int64_t)node[1]],
                            &s->self_position[3 * (int64_t)node[2]], x, point, &feature);
        for (int r = 0; r < 3; r++)
            square += (x[r] - point[r]) * (x[r] - point[r]);
        if (square < reach * reach)
            insert(&n, (int32_t)first + f->found[k], sqrt(square));
    }
    memcpy(&s->self_candidate[CANDIDATES * p + count], n.facet, (size_t)n.count * sizeof *n.facet);
    s->self_room = fmin(s->self_room, n.left_out);
    return count + n.count;
}

/* Keeps the candidates of node p: facets in reach but for those of its own neighbourhood; and lists the nodes
 * that have some, or can reach a plane, with the nodes of their facets, as 1 in `used`. */
static void choose_candidates(const sf_skin *skin, sf_state *s, int64_t p, double reach, const facets *f,
                              neighbourhood *n, uint8_t *used) {
    enum { MOST = 256, OF_PAD = CANDIDATES / 2 };
    int32_t *own = &s->self_candidate[CANDIDATES * p], near[MOST];
    bool across = skin->moving < skin->count, rigid = sf_skin_is_rigid(skin, p), stopped = false;
    int count = 0, most = across ? OF_PAD : CANDIDATES;
    int64_t found =
        skin->alone || rigid ? 0 : sf_grid_query(&f->pad, &s->self_position[3 * p], reach, MOST, near);
    if (found > 0)
        find_neighbourhood(skin, p, n);
    for (int64_t k = 0; k < found && k < MOST && count < most; k++)
        if (is_candidate(skin, n, p, near[k]))
            own[count++] = near[k];
    if (across && !skin->passive[p])
        count = rigid ? add_across(skin, s, p, reach, f, &f->pad, 0, count)
                      : add_across(skin, s, p, reach, f, &f->support, f->first_rigid, count);
    for (int k = 0; k < count; k++)
        for (int a = 0; a < 3; a++)
            used[skin->facet[3 * (int64_t)own[k] + a]] = 1;
    for (int k = 0; k < SF_SKIN_PLANES; k++)
        stopped = stopped || (is_stopped(skin, p, k) && height_over(skin, s, p, k) < reach);
    used[p] |= count > 0 || stopped;
    for (int k = count; k < CANDIDATES; k++)
        own[k] = NOTHING;
}

/* The lists of nodes whose positions and normals a step needs, from those that are used. */
static void list_nodes(const sf_skin *skin, sf_state *s, uint8_t *used) {
    s->self_close_count = s->self_near_count = 0;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            s->self_close[s->self_close_count++] = (int32_t)p;
    for (int64_t k = 0; k < s->self_close_count; k++)
        for (int64_t e = skin->ring_ptr[s->self_close[k]]; e < skin->ring_ptr[s->self_close[k] + 1]; e++)
            for (int c = 0; c < 3; c++)
                used[skin->facet[3 * (int64_t)skin->ring[e] + c]] = 1;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            s->self_near[s->self_near_count++] = (int32_t)p;
}

static sf_status list_candidates(const sf_skin *skin, sf_state *s, sf_error *err) {
    facets f;
    uint8_t *used = sf_alloc(err, (unsigned long)skin->count, 1, "candidates of contact");
    neighbourhood n = {sf_alloc(err, (unsigned long)skin->count, 1, "candidates of contact"),
                       sf_alloc(err, (unsigned long)skin->count, sizeof *n.list, "candidates of contact"), 0};
    double reach = s->self_room = NEAR * skin->spacing;
    if (facets_find(skin, s, &f, err) == SF_OK) {
        for (int64_t p = 0; p < skin->count; p++)
            choose_candidates(skin, s, p, reach, &f, &n, used);
        list_nodes(skin, s, used);
    }
    facets_free(&f);
    free(used);
    free(n.is_near);
    free(n.list);
    return err->status;
}

/* Subtracts what node and facet travel towards each other in a step. False: the list must be made anew. */
static bool has_room(const sf_skin *skin, sf_state *s) {
    double travel = 2 * skin->spread * s->fastest;
    s->self_room -= s->dt_old * travel;
    return s->step > 0 && s->self_room > fmax(0.3 * NEAR * skin->spacing, 2 * s->dt * travel);
}

/* ---- gaps ---- */

/* Outward normals of the nodes that may touch, weighted by the areas of their facets. */
static void find_normals(const sf_skin *skin, sf_state *s) {
    for (int64_t k = 0; k < s->self_close_count; k++) {
        int64_t p = s->self_close[k];
        double one[3], *own = &s->self_normal[3 * p];
        memset(own, 0, 3 * sizeof *own);
        for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1]; e++) {
            facet_normal(skin, s, skin->ring[e], one);
            for (int r = 0; r < 3; r++)
                own[r] += one[r];
        }
        for (int r = 0; r < 3; r++) /* the other half lies beyond a symmetry plane */
            own[r] *= !((skin->held[p] >> r) & 1);
        sf_unit3(own);
    }
}

/* A node and what it touches. */
typedef struct touch {
    int64_t node, facet; /* facet: FIRST_PLANE - k for plane k */
    double weight[3];    /* of the facet's nodes; zeros for a plane */
    double normal[3];    /* outward from the facet */
    double gap;          /* m, now; of a depth the part that the step takes back */
} touch;

/* The weights of a facet's nodes at a point of its plane, `normal` (twice its area long) being its own. */
static void weigh_point(const sf_skin *skin, const sf_state *s, int64_t f, const double point[3],
                        const double normal[3], double weight[3]) {
    const int32_t *n = &skin->facet[3 * f];
    double square = sf_dot3(normal, normal);
    for (int k = 0; k < 3; k++) {
        double from[3], along[3], moment[3];
        const double *b = &s->self_position[3 * (int64_t)n[(k + 1) % 3]],
                     *c = &s->self_position[3 * (int64_t)n[(k + 2) % 3]];
        for (int r = 0; r < 3; r++) {
            from[r] = point[r] - b[r];
            along[r] = c[r] - b[r];
        }
        sf_cross3(along, from, moment);
        weight[k] = sf_dot3(moment, normal) / square;
    }
}

/* Weights that are rounding cost as much as others: they become zero, and the sum stays one. */
static void drop_traces(double weight[3]) {
    static const double TRACE = 1e-9;
    int largest = weight[1] > weight[0] ? 1 : 0;
    largest = weight[2] > weight[largest] ? 2 : largest;
    for (int k = 0; k < 3; k++)
        weight[k] = k != largest && fabs(weight[k]) < TRACE ? 0 : weight[k];
    weight[largest] = 1 - weight[(largest + 1) % 3] - weight[(largest + 2) % 3];
}

/* The pair of node and facet, if the node lies before or behind the facet and its own surface looks against
 * it. The normal is the mean of both surfaces: smooth over the facets, and the same seen from either side,
 * where facets that are tilted against each other would interlock; of a rigid facet it is that of the
 * support. The gap is along it, so that the forces on node and facet lie on one line. */
static bool meet_facet(const sf_skin *skin, const sf_state *s, int64_t p, int64_t f, touch *out) {
    const int32_t *n = &skin->facet[3 * f];
    const double *x = &s->self_position[3 * p], *a = &s->self_position[3 * (int64_t)n[0]];
    double own[3], arm[3], point[3];
    facet_normal(skin, s, f, own);
    double area = sqrt(sf_dot3(own, own));
    bool rigid = sf_skin_is_rigid(skin, n[0]);
    *out = (touch){.node = p, .facet = f};
    if (!(area > 0) || sf_dot3(&s->self_normal[3 * p], own) >= OPPOSED * area)
        return false;
    weigh_point(skin, s, f, x, own, out->weight);
    for (int k = 0; k < 3; k++)
        if (out->weight[k] < -EDGE)
            return false;
    for (int r = 0; r < 3; r++) {
        arm[r] = x[r] - a[r];
        out->normal[r] = rigid ? 0 : -s->self_normal[3 * p + r];
        for (int k = 0; k < 3; k++)
            out->normal[r] += out->weight[k] * s->self_normal[3 * (int64_t)n[k] + r];
    }
    for (int r = 0; r < 3; r++)
        out->normal[r] *= !((skin->held[p] >> r) & 1);
    sf_unit3(out->normal);
    double across = sf_dot3(out->normal, own);
    if (!(across > 0.5 * area))
        return false;
    out->gap = sf_dot3(arm, own) / across;
    for (int r = 0; r < 3; r++)
        point[r] = x[r] - out->gap * out->normal[r];
    weigh_point(skin, s, f, point, own, out->weight);
    drop_traces(out->weight);
    return true;
}

/* Displacement of the node relative to its partner, of a field over the skin's nodes. */
static void relative(const sf_skin *skin, const touch *q, const double *field, double out[3]) {
    memcpy(out, &field[3 * q->node], 3 * sizeof *out);
    for (int k = 0; k < 3 && q->facet >= 0; k++)
        for (int r = 0; r < 3; r++)
            out[r] -= q->weight[k] * field[3 * (int64_t)skin->facet[3 * q->facet + k] + r];
}

/* True if facet f is the last partner or meets it: the same contact goes on. */
static bool goes_on(const sf_skin *skin, int64_t last, int64_t f) {
    for (int a = 0; a < 3 && last >= 0; a++)
        for (int b = 0; b < 3; b++)
            if (skin->facet[3 * last + a] == skin->facet[3 * f + b])
                return true;
    return false;
}

/* The partner that node p touches at the end of the step: of those that it may touch, the nearest. */
static bool find_partner(const sf_skin *skin, const sf_state *s, int64_t p, touch *out) {
    const int32_t *own = &s->self_candidate[CANDIDATES * p];
    double spacing = skin->size[p], best = INFINITY, back = -RETURN * s->dt, ahead[3];
    for (int k = 0; k < CANDIDATES && own[k] != NOTHING; k++) {
        touch q;
        double deepest = goes_on(skin, (int64_t)s->self_partner[p], own[k]) ? DEEPEST : SF_CONTACT_ENTRY;
        if (!meet_facet(skin, s, p, own[k], &q) || q.gap < -deepest * spacing || fabs(q.gap) >= best)
            continue;
        relative(skin, &q, s->self_step, ahead);
        if (fmax(q.gap, back) + sf_dot3(ahead, q.normal) >= 0)
            continue;
        best = fabs(q.gap);
        *out = q;
    }
    for (int k = 0; k < SF_SKIN_PLANES; k++) {
        if (!is_stopped(skin, p, k))
            continue;
        const sf_skin_plane *plane = &skin->plane[k];
        double height = height_over(skin, s, p, k);
        if (height + plane->side * s->self_step[3 * p + plane->axis] >= 0 || fabs(height) >= best)
            continue;
        *out = (touch){.node = p, .facet = FIRST_PLANE - k, .gap = height};
        out->normal[plane->axis] = plane->side;
        best = fabs(height);
    }
    return best < INFINITY;
}

/* ---- forces ---- */

/* Adds the row of the pair over the coefficients, times `q`, to `out`; `accelerate`: over the masses. */
static void scatter(const sf_model *m, const sf_skin *skin, const touch *pair, const double q[3],
                    bool accelerate, double *out) {
    for (int k = -1; k < (pair->facet >= 0 ? 3 : 0); k++) {
        int64_t p = k < 0 ? pair->node : skin->facet[3 * pair->facet + k];
        double weight = k < 0 ? 1 : -pair->weight[k];
        for (int64_t e = skin->rows.ptr[p]; e < skin->rows.ptr[p + 1] && weight != 0; e++) {
            int64_t i = skin->rows.node[e];
            double phi = weight * skin->rows.value[e] / (accelerate ? m->mass[i] : 1);
            for (int r = 0; r < 3; r++)
                out[3 * i + r] += phi * q[r];
        }
    }
}

/* The row of the pair times a field over the coefficients. */
static void gather(const sf_skin *skin, const touch *pair, const double *field, double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (int k = -1; k < (pair->facet >= 0 ? 3 : 0); k++) {
        int64_t p = k < 0 ? pair->node : skin->facet[3 * pair->facet + k];
        double weight = k < 0 ? 1 : -pair->weight[k];
        for (int64_t e = skin->rows.ptr[p]; e < skin->rows.ptr[p + 1] && weight != 0; e++)
            for (int r = 0; r < 3; r++)
                out[r] += weight * skin->rows.value[e] * field[3 * (int64_t)skin->rows.node[e] + r];
    }
}

/* Acceleration of the pair's node relative to its partner by a unit force; `push` is zero, and left so. */
static double mobility_of(const sf_model *m, const sf_skin *skin, const touch *pair, double *push) {
    static const double unit[3] = {1, 0, 0}, back[3] = {-1, 0, 0};
    double out[3];
    scatter(m, skin, pair, unit, true, push);
    gather(skin, pair, push, out);
    scatter(m, skin, pair, back, true, push);
    return out[0];
}

/* The pairs of a step, their mobilities and motions without forces. */
typedef struct solve {
    int64_t count;
    touch *pair;
    double *mobility;  /* kg-1 */
    double (*step)[3]; /* m */
    double shift;      /* s2, dt times the distance of the half steps */
} solve;

/* The mirror image moves along a symmetry plane as the pad does. */
static double friction_of(const sf_model *m, const sf_skin *skin, const touch *pair) {
    if (pair->facet < FIRST_PLANE - SF_SKIN_ANVIL)
        return 0;
    bool on_support = sf_skin_is_rigid(skin, pair->node) ||
                      (pair->facet >= 0 && sf_skin_is_rigid(skin, skin->facet[3 * pair->facet]));
    return on_support ? m->support_friction : m->skin_friction;
}

/* One Gauss-Seidel update of the force on a pair's node; returns the size of its change. */
static double relax_pair(const sf_model *m, const sf_skin *skin, sf_state *s, const solve *w, int64_t a) {
    const touch *pair = &w->pair[a];
    double *q = &s->self_force[3 * pair->node], moved[3], next[3], change[3], largest = 0;
    double mobility = w->shift * w->mobility[a], friction = friction_of(m, skin, pair);
    gather(skin, pair, s->self_push, moved);
    for (int r = 0; r < 3; r++)
        moved[r] = w->step[a][r] + w->shift * moved[r];
    double across = sf_dot3(moved, pair->normal), old = sf_dot3(q, pair->normal),
           p = fmax(0, old - (pair->gap + across) / mobility), size = 0;
    for (int r = 0; r < 3; r++) {
        next[r] = friction > 0 && p > 0
                      ? q[r] - old * pair->normal[r] - (moved[r] - across * pair->normal[r]) / mobility
                      : 0;
        size += next[r] * next[r];
    }
    double bound = size > 0 ? fmin(1, friction * p / sqrt(size)) : 0;
    for (int r = 0; r < 3; r++) {
        next[r] = p * pair->normal[r] + bound * next[r];
        change[r] = next[r] - q[r];
        q[r] = next[r];
        largest = fmax(largest, fabs(change[r]));
    }
    if (largest > 0)
        scatter(m, skin, pair, change, true, s->self_push);
    return largest;
}

static void relax(const sf_model *m, const sf_skin *skin, sf_state *s, const solve *w) {
    double change = 0, largest = 0;
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        change = largest = 0;
        for (int64_t a = 0; a < w->count; a++) {
            int64_t k = sweep % 2 ? w->count - 1 - a : a;
            change = fmax(change, relax_pair(m, skin, s, w, k));
            largest = fmax(largest, sf_dot3(&s->self_force[3 * w->pair[k].node], w->pair[k].normal));
        }
        if (change <= SWEEP_TOLERANCE * largest)
            return;
    }
    s->contact_unsettled += change > UNSETTLED * largest;
}

/* Half of the work of the force on a pair in the last step: each step's force works over the steps before and
 * after it. */
static void book(const sf_model *m, const sf_skin *skin, sf_state *s, const touch *pair,
                 const double force[3]) {
    double motion[3];
    relative(skin, pair, s->self_motion, motion);
    double lost = -0.5 * sf_dot3(force, motion),
           normal = friction_of(m, skin, pair) > 0
                        ? -0.5 * sf_dot3(force, pair->normal) * sf_dot3(motion, pair->normal)
                        : lost;
    s->ledger.contact += normal;
    s->ledger.friction += lost - normal;
    if (pair->facet == FIRST_PLANE - SF_SKIN_ANVIL)
        s->ledger.anvil += lost;
}

/* The pair of node p in the last step; its normal is that of the present. */
static touch last_pair(const sf_skin *skin, const sf_state *s, int64_t p) {
    touch q = {.node = p, .facet = (int64_t)s->self_partner[p]};
    memcpy(q.weight, &s->self_weight[3 * p], sizeof q.weight);
    if (q.facet < 0) {
        q.normal[skin->plane[FIRST_PLANE - q.facet].axis] = 1;
    } else {
        facet_normal(skin, s, q.facet, q.normal);
        double size = sqrt(sf_dot3(q.normal, q.normal));
        for (int r = 0; r < 3; r++)
            q.normal[r] /= size > 0 ? size : 1;
    }
    return q;
}

/* Books the last step's pairs, finds those of this step, and carries their forces over. */
static void find_pairs(const sf_model *m, const sf_skin *skin, sf_state *s, solve *w) {
    s->self_penetration = 0;
    for (int64_t k = 0; k < s->self_close_count; k++) {
        int64_t p = s->self_close[k];
        double *q = &s->self_force[3 * p];
        if (s->self_partner[p] != NOTHING) {
            const touch last = last_pair(skin, s, p);
            book(m, skin, s, &last, q);
        }
        touch *found = &w->pair[w->count];
        double old = sqrt(sf_dot3(q, q));
        if (!find_partner(skin, s, p, found)) {
            s->self_partner[p] = NOTHING;
            memset(q, 0, 3 * sizeof *q);
            continue;
        }
        if (s->self_partner[p] != (double)found->facet && friction_of(m, skin, found) == 0)
            for (int r = 0; r < 3; r++)
                q[r] = old * found->normal[r];
        s->self_partner[p] = (double)found->facet;
        memcpy(&s->self_weight[3 * p], found->weight, sizeof found->weight);
        s->self_penetration = fmax(s->self_penetration, -found->gap);
        found->gap = fmax(found->gap, -RETURN * s->dt);
        w->mobility[w->count] = mobility_of(m, skin, found, s->self_push);
        relative(skin, found, s->self_step, w->step[w->count]);
        w->count++;
    }
}

/* Accelerations by the last step's forces of missile and anvil into self_push: a cover below the missile
 * would else meet the foam without the missile's load. All points are read, as the list of near points is
 * empty after a restart. */
static void push_from_outside(const sf_model *m, const sf_contact_rows *rows, sf_state *s) {
    for (int64_t c = 0; c < sf_model_points(m); c++) {
        const double *q = &s->contact_force[3 * c];
        for (int64_t e = rows->ptr[c]; e < rows->ptr[c + 1] && sf_dot3(q, q) > 0; e++) {
            int64_t i = rows->node[e];
            for (int r = 0; r < 3; r++)
                s->self_push[3 * i + r] += rows->value[e] / m->mass[i] * q[r];
        }
    }
}

sf_status sf_self_contact_solve(const sf_model *m, const sf_operators *op, sf_state *s, sf_error *err) {
    const sf_skin *skin = &op->skin;
    if (skin->count == 0)
        return SF_OK;
    double dt_v = 0.5 * (s->dt_old + s->dt);
    size_t bytes = 3 * (size_t)m->node_count * sizeof *s->self_push;
    push_from_outside(m, &op->rows, s);
    if (!has_room(skin, s)) {
        for (int64_t p = 0; p < skin->count; p++)
            s->self_near[p] = (int32_t)p;
        move_nodes(m, skin, s, dt_v, skin->count, s->self_near);
        SF_TRY(list_candidates(skin, s, err));
    } else {
        move_nodes(m, skin, s, dt_v, s->self_near_count, s->self_near);
    }
    memset(s->self_push, 0, bytes);
    find_normals(skin, s);
    unsigned long most = (unsigned long)s->self_close_count;
    solve w = {.shift = s->dt * dt_v,
               .pair = sf_alloc(err, most, sizeof *w.pair, "pairs in contact"),
               .mobility = sf_alloc(err, most, sizeof *w.mobility, "pairs in contact"),
               .step = sf_alloc(err, most, sizeof *w.step, "pairs in contact")};
    if (err->status == SF_OK)
        find_pairs(m, skin, s, &w);
    if (w.count > 0) {
        for (int64_t a = 0; a < w.count; a++)
            scatter(m, skin, &w.pair[a], &s->self_force[3 * w.pair[a].node], true, s->self_push);
        relax(m, skin, s, &w);
        memset(s->self_push, 0, bytes);
    }
    for (int64_t a = 0; a < w.count; a++) {
        const double *q = &s->self_force[3 * w.pair[a].node];
        scatter(m, skin, &w.pair[a], q, false, s->force);
        book(m, skin, s, &w.pair[a], q);
    }
    free(w.pair);
    free(w.mobility);
    free(w.step);
    return err->status;
}

void sf_self_contact_outside(const sf_skin *skin, const sf_state *s, bool symmetry, sf_wrench *outside) {
    for (int64_t k = 0; skin->count > 0 && k < s->self_close_count; k++) {
        int64_t p = s->self_close[k], facet = (int64_t)s->self_partner[p];
        const double *q = &s->self_force[3 * p];
        bool symmetric = facet < FIRST_PLANE - SF_SKIN_ANVIL;
        if (facet != NOTHING && sf_skin_is_rigid(skin, p)) /* on the facet's nodes */
            for (int c = 0; c < 3; c++) {
                double weight = s->self_weight[3 * p + c];
                const double back[3] = {-weight * q[0], -weight * q[1], -weight * q[2]};
                sf_wrench_add(outside, &s->self_position[3 * (int64_t)skin->facet[3 * facet + c]], back);
            }
        else if (facet < 0 ? facet != NOTHING && (symmetry || !symmetric)
                           : sf_skin_is_rigid(skin, skin->facet[3 * facet]))
            sf_wrench_add(outside, &s->self_position[3 * p], q);
    }
}
