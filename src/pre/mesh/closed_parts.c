/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/closed_parts.h"

#include <string.h>

#include "base/mat3.h"
#include "base/sets.h"

static const double TOUCHING = 1e-5;                   /* of the extent: files round coordinates */
static const double UP[3] = {0.27183, 0.57722, 0.770}; /* direction of the rays, along no usual edge */

typedef struct box {
    double low[3], high[3]; /* m */
} box;

/* A balanced tree in a list: the middle item of a range is its root, the halves beside it are branches. */
typedef struct item {
    box own, all; /* of the triangle; of all triangles in the range */
    int64_t triangle;
} item;

/* Compares the present part with all others by the centroids of its triangles, from which rays run along z,
 * and by its edges. Arrays have the values of a part at its lowest triangle. */
typedef struct search {
    const sf_closed_parts *s;
    double *position; /* [node_count][3] m, turned so that the rays do not hit edges of drawn shapes */
    item *tree;       /* [count] */
    int64_t count;    /* triangles of closed parts */
    double touching;  /* m */
    int64_t triangle; /* present one */
    double point[3];  /* m, its centroid */
    int64_t parts;
    int64_t *lowest;  /* [parts] triangles */
    int64_t *next;    /* [triangles] next one of its part; 0: none */
    int64_t *last;    /* last triangle of a part */
    uint8_t *is_on;   /* the point lies on the part */
    uint8_t *is_in;   /* the point's ray hits the part an odd number of times */
    int64_t *on, *in; /* points of the present part on this part, and within it */
    uint8_t *crossed; /* an edge of the present part passes through this part */
    int64_t *meeting; /* triangle of the present part that meets this part */
} search;

SF_ORDER_BY(by_x, item, own.low[0], triangle)
SF_ORDER_BY(by_y, item, own.low[1], triangle)
SF_ORDER_BY(by_z, item, own.low[2], triangle)

static void build_tree(item *list, int64_t count, int axis) {
    static int (*const order[3])(const void *, const void *) = {by_x, by_y, by_z};
    int64_t root = count / 2, rest = count - root - 1;
    const int64_t branch[2] = {root / 2, root + 1 + rest / 2};
    if (count == 0)
        return;
    qsort(list, (size_t)count, sizeof *list, order[axis]);
    build_tree(list, root, (axis + 1) % 3);
    build_tree(list + root + 1, rest, (axis + 1) % 3);
    list[root].all = list[root].own;
    for (int k = 0; k < 2; k++)
        if (branch[k] != root && branch[k] < count) {
            sf_box3_add(list[branch[k]].all.low, list[root].all.low, list[root].all.high);
            sf_box3_add(list[branch[k]].all.high, list[root].all.low, list[root].all.high);
        }
}

static bool are_apart(const box *a, const box *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart = apart || a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return apart;
}

/* Calls `meet` with the triangles of other parts than the present one whose boxes meet `around`. */
static void visit(search *f, const item *list, int64_t count, const box *around,
                  void (*meet)(search *, int64_t)) {
    int64_t root = count / 2;
    if (count == 0 || are_apart(&list[root].all, around))
        return;
    if (f->s->part[list[root].triangle] != f->s->part[f->triangle] && !are_apart(&list[root].own, around))
        meet(f, list[root].triangle);
    visit(f, list, root, around, meet);
    visit(f, list + root + 1, count - root - 1, around, meet);
}

static void find_corners(const search *f, int64_t t, const double *x[3]) {
    sf_corners(f->position, &f->s->triangle[3 * t], x);
}

/* ---- points ---- */

/* True if, seen along z, the point lies to the left of the edge. The nodes are taken in the order of their
 * numbers, so that both triangles at an edge agree. */
static bool is_left(const search *f, int32_t from, int32_t to) {
    const double *a = &f->position[3 * (int64_t)(from < to ? from : to)],
                 *b = &f->position[3 * (int64_t)(from < to ? to : from)], *x = f->point;
    return ((b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]) > 0) == (from < to);
}

static void meet_point(search *f, int64_t t) {
    const int32_t *node = &f->s->triangle[3 * t];
    const double *x[3];
    double nearest[3], normal[3], above[3];
    int feature;
    find_corners(f, t, x);
    sf_triangle_nearest(x[0], x[1], x[2], f->point, nearest, &feature);
    if (sf_distance3(f->point, nearest) <= f->touching)
        f->is_on[f->s->part[t]] = 1;
    sf_triangle_normal(x[0], x[1], x[2], normal);
    sf_sub3(x[0], f->point, above);
    bool left = is_left(f, node[0], node[1]);
    if (left == is_left(f, node[1], node[2]) && left == is_left(f, node[2], node[0]) &&
        sf_dot3(normal, above) * normal[2] > 0)
        f->is_in[f->s->part[t]] ^= 1;
}

/* ---- edges ---- */

/* True if the edge passes through the inside of the triangle, by more than a touch. */
static bool passes(const double *from, const double *to, const double *const x[3], double touching) {
    double normal[3], to_from[3], to_to[3], side[3], there[3], inward[3];
    sf_triangle_normal(x[0], x[1], x[2], normal);
    sf_unit3(normal);
    sf_sub3(from, x[0], to_from);
    sf_sub3(to, x[0], to_to);
    double a = sf_dot3(normal, to_from), b = sf_dot3(normal, to_to);
    bool through = a * b < 0 && fmin(fabs(a), fabs(b)) > touching;
    for (int k = 0; through && k < 3; k++) {
        for (int c = 0; c < 3; c++)
            there[c] = from[c] + (to[c] - from[c]) * a / (a - b) - x[k][c];
        sf_sub3(x[(k + 1) % 3], x[k], side);
        sf_cross3(normal, side, inward);
        sf_unit3(inward);
        through = sf_dot3(inward, there) > touching;
    }
    return through;
}

static void meet_edges(search *f, int64_t t) {
    const double *own[3], *x[3];
    find_corners(f, f->triangle, own);
    find_corners(f, t, x);
    for (int k = 0; k < 3; k++)
        if (passes(own[k], own[(k + 1) % 3], x, f->touching))
            f->crossed[f->s->part[t]] = 1;
}

/* ---- parts ---- */

static box box_of(const search *f, int64_t t) {
    box out = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    const double *x[3];
    find_corners(f, t, x);
    for (int k = 0; k < 3; k++)
        sf_box3_add(x[k], out.low, out.high);
    return out;
}

static void compare_triangle(search *f, int64_t t) {
    const box own = box_of(f, t);
    const double *x[3];
    box ray;
    f->triangle = t;
    find_corners(f, t, x);
    for (int c = 0; c < 3; c++) {
        f->point[c] = (x[0][c] + x[1][c] + x[2][c]) / 3;
        ray.low[c] = f->point[c] - f->touching;
        ray.high[c] = c < 2 ? f->point[c] + f->touching : INFINITY;
    }
    visit(f, f->tree, f->count, &ray, meet_point);
    visit(f, f->tree, f->count, &own, meet_edges);
}

/* Adds the present point to the counts. */
static void count_point(search *f) {
    for (int64_t k = 0; k < f->parts; k++) {
        int64_t b = f->lowest[k];
        f->on[b] += f->is_on[b];
        f->in[b] += f->is_in[b] && !f->is_on[b];
        if (f->crossed[b] || f->is_on[b] || f->is_in[b])
            f->meeting[b] = f->triangle;
        f->is_on[b] = f->is_in[b] = 0;
    }
}

static void refuse_overlap(const search *f, int64_t t, bool same, sf_error *overlap) {
    const double *x[3];
    double place[3];
    sf_corners(f->s->position, &f->s->triangle[3 * t], x);
    for (int c = 0; c < 3; c++)
        place[c] = 1e3 * (x[0][c] + x[1][c] + x[2][c]) / 3;
    SF_FAIL(overlap, SF_ERR_MODEL, "two of its closed parts %s at (%.4g, %.4g, %.4g) mm: %s",
            same ? "are the same" : "overlap", place[0], place[1], place[2],
            same ? "leave one of them out" : "draw them as one (in gmsh BooleanUnion)");
}

/* Sets the depth of a part of `points` triangles, and forgets what was found of it. */
static void judge_part(search *f, int64_t lowest, int64_t points, int32_t *depth, sf_error *overlap) {
    for (int64_t k = 0; k < f->parts; k++) {
        int64_t b = f->lowest[k];
        if (f->crossed[b] || f->on[b] == points || (f->in[b] > 0 && f->in[b] < points))
            refuse_overlap(f, f->meeting[b], f->on[b] == points, overlap);
        depth[lowest] += f->in[b] == points;
        f->in[b] = f->on[b] = f->crossed[b] = 0;
    }
}

/* Lists the parts and their triangles, and lays those into the tree. */
static void list_parts(search *f) {
    for (int64_t t = 0; t < f->s->triangle_count; t++) {
        int64_t part = f->s->part[t];
        if (part < 0)
            continue;
        if (part == t)
            f->lowest[f->parts++] = t;
        else
            f->next[f->last[part]] = t;
        f->last[part] = t;
        f->tree[f->count++] = (item){.own = box_of(f, t), .triangle = t};
    }
    build_tree(f->tree, f->count, 0);
}

/* Triangle 0 is the lowest of its part, and follows none. */
static void compare_parts(search *f, int32_t *depth, sf_error *overlap) {
    for (int64_t k = 0; k < f->parts && overlap->status == SF_OK; k++) {
        int64_t points = 0;
        for (int64_t t = f->lowest[k]; points == 0 || t > 0; t = f->next[t], points++) {
            compare_triangle(f, t);
            count_point(f);
        }
        judge_part(f, f->lowest[k], points, depth, overlap);
    }
}

/* Turns a copy of the places, so that the rays run along z. */
static void turn_places(search *f) {
    double up[3] = {UP[0], UP[1], UP[2]}, turn[9], low[3], high[3];
    sf_unit3(up);
    sf_turn_to_z(up, turn);
    memcpy(f->position, f->s->position, 3 * (size_t)f->s->node_count * sizeof *f->position);
    for (int64_t k = 0; k < f->s->node_count; k++)
        sf_mat3_apply(turn, &f->position[3 * k]);
    sf_box3(f->s->node_count, f->position, low, high);
    f->touching = TOUCHING * sf_distance3(low, high);
}

sf_status sf_closed_parts_nest(const sf_closed_parts *s, int32_t *depth, sf_error *overlap, sf_error *err) {
    search f = {.s = s};
    int64_t n = s->triangle_count;
    memset(depth, 0, (size_t)n * sizeof *depth);
    if (SF_ALLOC_ALL(err, "closed parts of a surface", SF_ROOM(f.position, 3 * s->node_count),
                     SF_ROOM(f.tree, n), SF_ROOM(f.lowest, n), SF_ROOM(f.next, n), SF_ROOM(f.last, n),
                     SF_ROOM(f.is_on, n), SF_ROOM(f.is_in, n), SF_ROOM(f.crossed, n), SF_ROOM(f.on, n),
                     SF_ROOM(f.in, n), SF_ROOM(f.meeting, n)) == SF_OK) {
        turn_places(&f);
        list_parts(&f);
        compare_parts(&f, depth, overlap);
    }
    if (overlap->status != SF_OK)
        memset(depth, 0, (size_t)n * sizeof *depth);
    SF_FREE(f.position, f.tree, f.lowest, f.next, f.last, f.is_on, f.is_in, f.crossed, f.on, f.in, f.meeting);
    return err->status;
}
