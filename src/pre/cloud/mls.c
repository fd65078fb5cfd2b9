/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/mls.h"

#include "base/sets.h"
#include <math.h>
#include <string.h>

/* A path may lead as far away as this times the distance of its ends: around the tip of a slit, not around
 * the slit. */
static const double DETOUR = 1.5;

enum { MOST = 4096 }; /* candidates; the shape functions allow a quarter */

/* One thread's search about one node. */
typedef struct searcher {
    const sf_mesh *mesh;
    const sf_dual *dual;
    const double *centre;
    int32_t turn;
    int32_t *seen;  /* [nodes] = turn: known to lead to the centre (descend), or queued once (spread) */
    double *level;  /* [nodes] m2, smallest square of a radius that holds a path to the centre */
    int32_t *queue; /* [nodes] ring */
    uint8_t *queued;
    int32_t candidate[MOST];
    bool failed; /* out of memory */
} searcher;

static double square_to(const searcher *s, int32_t node) {
    const double *p = &s->mesh->position[3 * (int64_t)node];
    double dx = p[0] - s->centre[0], dy = p[1] - s->centre[1], dz = p[2] - s->centre[2];
    return dx * dx + dy * dy + dz * dz;
}

/* Steps along edges, each nearer to the centre, until a node that is known to lead there; false at a dead
 * end. In a convex body with a sound mesh there is none. */
static bool descend(searcher *s, int32_t node) {
    double square = square_to(s, node);
    while (s->seen[node] != s->turn) {
        int64_t k = s->dual->edge_ptr[node], end = s->dual->edge_ptr[node + 1];
        s->seen[node] = s->turn;
        for (; k < end; k++) {
            double next = square_to(s, s->dual->edge_node[k]);
            if (next < square) {
                square = next;
                node = s->dual->edge_node[k];
                break;
            }
        }
        if (k == end)
            return false;
    }
    return true;
}

/* Finds the levels of all nodes with paths inside the ball of square radius `limit`. */
static void spread(searcher *s, int32_t start, double limit) {
    int64_t n = s->mesh->node_count, head = 0, count = 1;
    s->turn++;
    s->queue[0] = start;
    s->seen[start] = s->turn;
    s->level[start] = 0;
    while (count > 0) {
        int32_t node = s->queue[head];
        head = (head + 1) % n;
        count--;
        s->queued[node] = 0;
        for (int64_t k = s->dual->edge_ptr[node]; k < s->dual->edge_ptr[node + 1]; k++) {
            int32_t next = s->dual->edge_node[k];
            double own = square_to(s, next), level = own > s->level[node] ? own : s->level[node];
            if (own > limit || (s->seen[next] == s->turn && s->level[next] <= level))
                continue;
            s->seen[next] = s->turn;
            s->level[next] = level;
            if (!s->queued[next])
                s->queue[(head + count++) % n] = next;
            s->queued[next] = 1;
        }
    }
}

/* The candidates with no path near enough. */
static void list_hidden(searcher *s, int32_t node, int64_t count, sf_hidden *out) {
    double far = 0;
    int64_t used = 0;
    for (int64_t k = 0; k < count; k++) {
        double square = square_to(s, s->candidate[k]);
        far = square > far ? square : far;
    }
    spread(s, node, DETOUR * DETOUR * far);
    for (int64_t k = 0; k < count; k++) {
        int32_t other = s->candidate[k];
        if (s->seen[other] != s->turn || s->level[other] > DETOUR * DETOUR * square_to(s, other))
            s->candidate[used++] = other;
    }
    qsort(s->candidate, (size_t)used, sizeof *s->candidate, sf_by_number);
    out->node = used > 0 ? malloc((size_t)used * sizeof *out->node) : NULL;
    s->failed = s->failed || (used > 0 && !out->node);
    if (!out->node)
        return;
    memcpy(out->node, s->candidate, (size_t)used * sizeof *out->node);
    out->count = used;
}

static void look_around(searcher *s, const sf_grid *grid, double reach, int32_t node, sf_hidden *out) {
    bool all = true;
    s->centre = &s->mesh->position[3 * (int64_t)node];
    int64_t count = sf_grid_gather(grid, s->centre, reach, MOST, s->candidate);
    count = count < MOST ? count : MOST;
    s->seen[node] = ++s->turn;
    for (int64_t k = 0; k < count && all; k++)
        all = descend(s, s->candidate[k]);
    if (!all)
        list_hidden(s, node, count, out);
}

static void release(searcher *s) {
    if (!s)
        return;
    SF_FREE(s->seen, s->level, s->queue, s->queued, s);
}

static searcher *make_searcher(const sf_mesh *mesh, const sf_dual *dual) {
    size_t n = (size_t)mesh->node_count;
    searcher *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->mesh = mesh;
    s->dual = dual;
    s->seen = calloc(n, sizeof *s->seen);
    s->level = calloc(n, sizeof *s->level);
    s->queue = calloc(n, sizeof *s->queue);
    s->queued = calloc(n, sizeof *s->queued);
    if (s->seen && s->level && s->queue && s->queued)
        return s;
    release(s);
    return NULL;
}

sf_hidden *sf_visibility_build(const sf_mesh *mesh, const sf_dual *dual, const sf_grid *grid,
                               const double *reach, sf_error *err) {
    sf_hidden *hidden = sf_alloc(err, mesh->node_count, sizeof *hidden, "hidden nodes");
    bool failed = !hidden;
#pragma omp parallel if (hidden != NULL)
    {
        searcher *s = hidden ? make_searcher(mesh, dual) : NULL;
#pragma omp for schedule(dynamic, 256)
        for (int64_t i = 0; i < mesh->node_count; i++)
            if (s)
                look_around(s, grid, reach[i], (int32_t)i, &hidden[i]);
#pragma omp critical
        failed = failed || !s || s->failed;
        release(s);
    }
    if (!failed)
        return hidden;
    SF_NO_MEMORY(err, "what %lld nodes see", (long long)mesh->node_count);
    sf_visibility_free(hidden, mesh->node_count);
    return NULL;
}

void sf_visibility_free(sf_hidden *hidden, int64_t node_count) {
    for (int64_t i = 0; hidden && i < node_count; i++)
        free(hidden[i].node);
    free(hidden);
}

int64_t sf_visibility_filter(const sf_hidden *hidden, int64_t count, int32_t *candidate) {
    int64_t kept = 0;
    for (int64_t k = 0, h = 0; k < count; k++) {
        while (h < hidden->count && hidden->node[h] < candidate[k])
            h++;
        if (h == hidden->count || hidden->node[h] != candidate[k])
            candidate[kept++] = candidate[k];
    }
    return kept;
}

double sf_mls_weight(double q) {
    if (q >= 1)
        return 0;
    if (q <= 0.5)
        return 2.0 / 3 - 4 * q * q + 4 * q * q * q;
    double r = 1 - q;
    return 4.0 / 3 * r * r * r;
}

/* Inverse of a symmetric positive definite 4 x 4 matrix by Cholesky; -1 if it is not. */
static int invert4(const double m[4][4], double inverse[4][4]) {
    double l[4][4] = {{0}}, k[4][4] = {{0}}; /* M = L Lt, K = inverse of L */
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++) {
            double sum = m[i][j];
            for (int p = 0; p < j; p++)
                sum -= l[i][p] * l[j][p];
            if (i == j) {
                if (!(sum > 1e-14 * m[i][i]))
                    return -1;
                l[i][i] = sqrt(sum);
            } else {
                l[i][j] = sum / l[j][j];
            }
        }
    for (int j = 0; j < 4; j++)
        for (int i = j; i < 4; i++) {
            double sum = i == j;
            for (int p = j; p < i; p++)
                sum -= l[i][p] * k[p][j];
            k[i][j] = sum / l[i][i];
        }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            inverse[i][j] = 0;
            for (int p = i > j ? i : j; p < 4; p++)
                inverse[i][j] += k[p][i] * k[p][j];
        }
    return 0;
}

static double norm1(const double m[4][4]) {
    double largest = 0;
    for (int j = 0; j < 4; j++) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            sum += fabs(m[i][j]);
        largest = fmax(largest, sum);
    }
    return largest;
}

int sf_mls_evaluate(const sf_mls_cloud *cloud, const double x[3], int64_t count, const int32_t *candidate,
                    sf_mls_point *out) {
    double basis[SF_MLS_MAX_NODES][4], moment[4][4] = {{0}}, inverse[4][4], scale = 0;
    out->count = 0;
    out->condition = INFINITY;
    for (int64_t k = 0; k < count; k++) {
        int32_t node = candidate[k];
        const double *p = &cloud->position[3 * node];
        double r[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]}, radius = cloud->support[node];
        double weight = sf_mls_weight(sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / radius);
        if (weight <= 0)
            continue;
        if (out->count == SF_MLS_MAX_NODES)
            return -1;
        scale = fmax(scale, radius);
        out->node[out->count] = node;
        out->value[out->count] = weight;
        basis[out->count][0] = 1;
        for (int c = 0; c < 3; c++)
            basis[out->count][c + 1] = r[c];
        out->count++;
    }
    if (out->count < (cloud->is_plane ? 3 : 4))
        return -1;
    for (int k = 0; k < out->count; k++) {
        for (int c = 1; c < 4; c++)
            basis[k][c] /= scale;
        for (int i = 0; i < 4; i++)
            for (int j = 0; j <= i; j++)
                moment[i][j] += out->value[k] * basis[k][i] * basis[k][j];
    }
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            moment[i][j] = moment[j][i];
    if (cloud->is_plane) /* its row is zero but for this */
        moment[2][2] = moment[0][0];
    if (invert4(moment, inverse) != 0)
        return -1;
    out->condition = norm1(moment) * norm1(inverse);
    for (int k = 0; k < out->count; k++) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            sum += inverse[0][i] * basis[k][i];
        out->value[k] *= sum;
    }
    return 0;
}
