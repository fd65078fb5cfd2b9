/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/domains.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "pre/cloud/mls.h"
#include <string.h>

enum { MAX_ENLARGEMENTS = 12 };
static const double ENLARGEMENT = 1.15;

/* phi_J integrated over the facets of one edge, for every J that reaches them. */
typedef struct edge_integral {
    int count;
    int32_t *node; /* [count] ascending; one block with sum */
    double *sum;   /* [count][columns] m2, from the low node to the high node; see COLUMNS */
    double flux;   /* m3, integral of X . N / 3 */
    double
        part[2]; /* m3, volume of the parts of the domains of the low and the high node; only in a section */
} edge_integral;

/* Columns of an edge's sums: phi N; of a section then phi integrated over the parts of the domains of the low
 * and the high node in the edge's cells. */
enum { COLUMNS = 3, SECTION_COLUMNS = 5 };

typedef struct builder {
    const sf_mesh *mesh;
    const sf_dual *dual;
    sf_mls_cloud cloud;
    sf_grid grid;
    double *edge_reach; /* [edges] m, farthest point of integration on the facets from the edge's midpoint */
    double *reach;      /* [nodes] m, the same from a node, of all its edges */
    sf_hidden *hidden;  /* [nodes] with the present supports */
    double condition_limit;
    bool section;
    int columns;
    edge_integral *edge; /* [edges] */
    uint8_t *poor;       /* [nodes] 1: support must grow */
    sf_domains *out;
} builder;

typedef struct workspace {
    int32_t candidate[SF_MLS_MAX_NODES];
    double sum[SF_MLS_MAX_NODES][SECTION_COLUMNS];
    uint8_t used[SF_MLS_MAX_NODES];
    sf_mls_point point;
    double condition, position[3]; /* the worst seen */
    bool failed;                   /* out of memory */
} workspace;

/* Evaluates phi and keeps the worst conditioning; false if the point is not good enough. */
static bool evaluate(const builder *b, workspace *w, const double x[3], int64_t count) {
    if (sf_mls_evaluate(&b->cloud, x, count, w->candidate, &w->point) != 0 ||
        w->point.condition > b->condition_limit)
        return false;
    if (w->point.condition > w->condition) {
        w->condition = w->point.condition;
        memcpy(w->position, x, sizeof w->position);
    }
    return true;
}

/* The nodes of a cell already reach it: what helps is that those around them reach farther. */
static void mark_around(const builder *b, int32_t node) {
#pragma omp atomic write
    b->poor[node] = 1;
    for (int64_t k = b->dual->edge_ptr[node]; k < b->dual->edge_ptr[node + 1]; k++) {
#pragma omp atomic write
        b->poor[b->dual->edge_node[k]] = 1;
    }
}

static void edge_middle(const builder *b, int64_t e, double middle[3]) {
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (b->mesh->position[3 * b->dual->edge[2 * e] + k] +
                           b->mesh->position[3 * b->dual->edge[2 * e + 1] + k]);
}

static void measure_reach(builder *b) {
#pragma omp parallel for schedule(static)
    for (int64_t e = 0; e < b->dual->edge_count; e++) {
        double middle[3];
        edge_middle(b, e, middle);
        for (int64_t u = b->dual->use_ptr[e]; u < b->dual->use_ptr[e + 1]; u++) {
            sf_facet_triangle t[2];
            sf_dual_facet(b->mesh, &b->dual->use[u], t);
            for (int s = 0; s < 2; s++)
                b->edge_reach[e] = fmax(b->edge_reach[e], sf_distance3(t[s].centroid, middle));
            if (!b->section)
                continue;
            double place[2][3], weight[2];
            sf_dual_fan(b->mesh, &b->dual->use[u], place, weight);
            for (int end = 0; end < 2; end++)
                b->edge_reach[e] = fmax(b->edge_reach[e], sf_distance3(place[end], middle));
        }
        b->edge_reach[e] *= 1 + 1e-12;
    }
    for (int64_t e = 0; e < b->dual->edge_count; e++) {
        const int32_t *end = &b->dual->edge[2 * e];
        double half = 0.5 * sf_distance3(&b->mesh->position[3 * (int64_t)end[0]],
                                         &b->mesh->position[3 * (int64_t)end[1]]);
        for (int k = 0; k < 2; k++)
            b->reach[end[k]] = fmax(b->reach[end[k]], (b->edge_reach[e] + half) * (1 + 1e-12));
    }
}

/* The nodes that reach the facets of an edge and that both its ends see. */
static int64_t edge_candidates(const builder *b, workspace *w, int64_t e) {
    double middle[3];
    edge_middle(b, e, middle);
    int64_t count = sf_grid_query(&b->grid, middle, b->edge_reach[e], SF_MLS_MAX_NODES, w->candidate);
    for (int k = 0; k < 2 && count <= SF_MLS_MAX_NODES; k++)
        count = sf_visibility_filter(&b->hidden[b->dual->edge[2 * e + k]], count, w->candidate);
    return count;
}

static void store_edge(workspace *w, int64_t count, int columns, edge_integral *edge) {
    size_t used = 0, width = (size_t)columns * sizeof *edge->sum;
    for (int64_t k = 0; k < count; k++)
        used += w->used[k];
    edge->count = (int)used;
    edge->sum = malloc(used * (width + sizeof *edge->node) + 1);
    if (!edge->sum) {
        w->failed = true;
        return;
    }
    edge->node = (int32_t *)(edge->sum + (size_t)columns * used);
    used = 0;
    for (int64_t k = 0; k < count; k++) {
        if (!w->used[k])
            continue;
        edge->node[used] = w->candidate[k];
        memcpy(&edge->sum[(size_t)columns * used++], w->sum[k], width);
    }
}

/* Adds phi times `weight` at x to the `count` columns of the sums from `first` on; false: the approximation
 * is not good enough there. */
static bool add_place(const builder *b, workspace *w, const double x[3], int64_t candidates, int first,
                      int count, const double *weight) {
    if (!evaluate(b, w, x, candidates))
        return false;
    for (int p = 0, k = 0; p < w->point.count; p++) {
        while (w->candidate[k] != w->point.node[p])
            k++;
        w->used[k] = 1;
        for (int c = 0; c < count; c++)
            w->sum[k][first + c] += w->point.value[p] * weight[c];
    }
    return true;
}

/* The facets of one use of an edge, and in a section the parts of its domains. */
static bool add_use(const builder *b, workspace *w, int64_t e, int64_t u, int64_t count) {
    sf_facet_triangle t[2];
    bool good = true;
    sf_dual_facet(b->mesh, &b->dual->use[u], t);
    for (int s = 0; s < 2; s++) {
        good = add_place(b, w, t[s].centroid, count, 0, COLUMNS, t[s].area) && good;
        for (int c = 0; c < 3; c++)
            b->edge[e].flux += t[s].centroid[c] * t[s].area[c] / 3;
    }
    if (!b->section)
        return good;
    double place[2][3], weight[2];
    sf_dual_fan(b->mesh, &b->dual->use[u], place, weight);
    for (int end = 0; end < 2; end++) {
        good = add_place(b, w, place[end], count, COLUMNS + end, 1, &weight[end]) && good;
        b->edge[e].part[end] += weight[end] * place[end][0];
    }
    return good;
}

/* Integrates phi over all facets of an edge. Marks cells where the approximation is not good enough. */
static void integrate_edge(const builder *b, workspace *w, int64_t e) {
    int64_t count = edge_candidates(b, w, e);
    bool good = count <= SF_MLS_MAX_NODES;
    if (!good)
        count = SF_MLS_MAX_NODES;
    memset(w->sum, 0, (size_t)count * sizeof w->sum[0]);
    memset(w->used, 0, (size_t)count);
    b->edge[e].flux = 0;
    b->edge[e].part[0] = b->edge[e].part[1] = 0;
    for (int64_t u = b->dual->use_ptr[e]; u < b->dual->use_ptr[e + 1]; u++)
        if (!add_use(b, w, e, u, count)) {
            mark_around(b, b->dual->edge[2 * e]);
            mark_around(b, b->dual->edge[2 * e + 1]);
            good = false;
        }
    if (good)
        store_edge(w, count, b->columns, &b->edge[e]);
}

/* phi at a node, left in w->point. */
static bool evaluate_node(const builder *b, workspace *w, int64_t i) {
    const double *x = &b->mesh->position[3 * i];
    int64_t count = sf_grid_query(&b->grid, x, 0, SF_MLS_MAX_NODES, w->candidate);
    return count <= SF_MLS_MAX_NODES &&
           evaluate(b, w, x, sf_visibility_filter(&b->hidden[i], count, w->candidate));
}

static void clear_edges(const builder *b) {
    for (int64_t e = 0; e < b->dual->edge_count; e++)
        free(b->edge[e].sum);
    memset(b->edge, 0, (size_t)b->dual->edge_count * sizeof *b->edge);
}

static void merge_worst(sf_domains *out, const workspace *w) {
    if (w->condition <= out->figures.worst_condition)
        return;
    out->figures.worst_condition = w->condition;
    memcpy(out->figures.worst_position, w->position, sizeof w->position);
}

/* All edges, and the nodes' own points, once; returns true if some support must grow. */
static bool integrate_all(builder *b, sf_error *err) {
    bool failed = false;
    b->out->figures.worst_condition = 0;
#pragma omp parallel
    {
        workspace *w = calloc(1, sizeof *w);
#pragma omp for schedule(dynamic, 256)
        for (int64_t e = 0; e < b->dual->edge_count; e++)
            if (w)
                integrate_edge(b, w, e);
#pragma omp for schedule(dynamic, 256)
        for (int64_t i = 0; i < b->mesh->node_count; i++)
            if (w && !evaluate_node(b, w, i))
                mark_around(b, (int32_t)i);
#pragma omp critical
        {
            failed = failed || !w || w->failed;
            if (w)
                merge_worst(b->out, w);
        }
        free(w);
    }
    if (failed)
        SF_NO_MEMORY(err, "the shape functions of %lld edges", (long long)b->dual->edge_count);
    for (int64_t i = 0; i < b->mesh->node_count; i++)
        if (b->poor[i])
            return true;
    return false;
}

/* Grid and visibility for the present supports. */
static sf_status look_around(builder *b, const double *support, sf_error *err) {
    sf_visibility_free(b->hidden, b->mesh->node_count);
    b->hidden = NULL;
    sf_grid_free(&b->grid);
    if (sf_grid_build(&b->grid, b->mesh->node_count, b->mesh->position, support, err) == SF_OK)
        b->hidden = sf_visibility_build(b->mesh, b->dual, &b->grid, b->reach, err);
    return err->status;
}

static sf_status integrate_with_growth(builder *b, double *support, sf_error *err) {
    int64_t n = b->mesh->node_count;
    SF_OWN(double, first, n, "supports", err);
    memcpy(first, support, (size_t)n * sizeof *first);
    for (int round = 0; err->status == SF_OK; round++) {
        memset(b->poor, 0, (size_t)n);
        if (look_around(b, support, err) != SF_OK || !integrate_all(b, err) || err->status != SF_OK)
            break;
        clear_edges(b);
        for (int64_t i = 0; i < n && err->status == SF_OK; i++) {
            if (b->poor[i] && round == MAX_ENLARGEMENTS) {
                const double *x = &b->mesh->position[3 * i];
                SF_FAIL(err, SF_ERR_MODEL,
                        "the shape functions near (%.6g, %.6g, %.6g) m stay ill-conditioned (above %.3g) "
                        "although the support was enlarged %.2f times: the cloud is too flat or too sparse "
                        "there",
                        x[0], x[1], x[2], b->condition_limit, support[i] / first[i]);
            } else if (b->poor[i]) {
                support[i] *= ENLARGEMENT;
            }
        }
    }
    b->out->figures.largest_enlargement = 1;
    for (int64_t i = 0; i < n; i++) {
        b->out->figures.enlarged_count += support[i] > first[i];
        b->out->figures.largest_enlargement =
            fmax(b->out->figures.largest_enlargement, support[i] / first[i]);
    }
    return err->status;
}

/* Finds the narrowest gap that hides nodes from each other. */
static void find_gap(builder *b) {
    sf_domains *out = b->out;
    out->figures.hidden_distance = INFINITY;
    for (int64_t i = 0; i < b->mesh->node_count; i++) {
        const double *x = &b->mesh->position[3 * i];
        out->figures.hidden_count += b->hidden[i].count > 0;
        for (int64_t k = 0; k < b->hidden[i].count; k++) {
            const double *y = &b->mesh->position[3 * (int64_t)b->hidden[i].node[k]];
            double gap = sf_distance3(x, y);
            if (gap >= out->figures.hidden_distance)
                continue;
            out->figures.hidden_distance = gap;
            for (int c = 0; c < 3; c++)
                out->figures.hidden_position[c] = 0.5 * (x[c] + y[c]);
        }
    }
}

/* phi at every node, with the last supports. */
static sf_status shape_at_nodes(builder *b, sf_error *err) {
    int64_t n = b->mesh->node_count, capacity = 64 * n, used = 0;
    sf_domains *out = b->out;
    SF_OWNED workspace *w = calloc(1, sizeof *w);
    SF_ALLOC_ALL(err, "shape functions", SF_ROOM(out->phi_ptr, n + 1), SF_ROOM(out->phi_node, capacity),
                 SF_ROOM(out->phi_value, capacity));
    if (!w)
        SF_NO_MEMORY(err, "the shape functions at the nodes");
    for (int64_t i = 0; i < n && err->status == SF_OK; i++) {
        if (!evaluate_node(b, w, i)) /* integrate_all found it good with the same supports */
            SF_FAIL(err, SF_ERR_MODEL, "the shape functions at node %lld cannot be evaluated", (long long)i);
        else if (used + w->point.count > capacity)
            SF_FAIL(err, SF_ERR_MODEL,
                    "more than %lld nodes on average reach a node: support_ratio is too large",
                    (long long)(capacity / n));
        else {
            memcpy(&out->phi_node[used], w->point.node, (size_t)w->point.count * sizeof *out->phi_node);
            memcpy(&out->phi_value[used], w->point.value, (size_t)w->point.count * sizeof *out->phi_value);
            used += w->point.count;
            out->phi_ptr[i + 1] = used;
        }
    }
    if (w)
        merge_worst(out, w);
    return err->status;
}

/* Calls `add` for every contribution phi_J N of one boundary face's corner. */
static void boundary_corner(const sf_mesh *mesh, const sf_boundary_face *face, int corner,
                            const sf_domains *d, double *flux, void (*add)(void *, int32_t, const double[3]),
                            void *target) {
    sf_facet_triangle t[2];
    double weight[2][4];
    sf_dual_boundary(mesh, face, corner, t, weight);
    for (int s = 0; s < 2; s++) {
        for (int c = 0; c < 3; c++)
            *flux += t[s].centroid[c] * t[s].area[c] / 3;
        for (int v = 0; v < face->size; v++)
            for (int64_t k = d->phi_ptr[face->node[v]]; k < d->phi_ptr[face->node[v] + 1]; k++) {
                double part[3];
                for (int c = 0; c < 3; c++)
                    part[c] = weight[s][v] * d->phi_value[k] * t[s].area[c];
                add(target, d->phi_node[k], part);
            }
    }
}

/* A sparse row under construction: `slot` [n] maps a node to its place (or -1). */
typedef struct row_sum {
    int32_t *slot;
    int64_t count;
    int32_t *node; /* [n] */
    double *sum;   /* [n][3] */
} row_sum;

static void row_add(void *target, int32_t node, const double part[3]) {
    row_sum *row = target;
    if (row->slot[node] < 0) {
        row->slot[node] = (int32_t)row->count;
        row->node[row->count] = node;
        memset(&row->sum[3 * row->count++], 0, 3 * sizeof *row->sum);
    }
    double *sum = &row->sum[3 * row->slot[node]];
    for (int c = 0; c < 3; c++)
        sum[c] += part[c];
}

/* The boundary corners of each node: [corner_ptr[i], corner_ptr[i+1]) are 4 * face + corner. */
static int64_t *list_corners(const builder *b, int64_t **corner, sf_error *err) {
    int64_t n = b->mesh->node_count;
    int64_t *ptr = sf_alloc(err, n + 2, sizeof *ptr, "boundary corners");
    *corner = sf_alloc(err, 4 * b->dual->face_count, sizeof **corner, "boundary corners");
    if (err->status != SF_OK)
        return ptr;
    for (int64_t f = 0; f < b->dual->face_count; f++)
        for (int v = 0; v < b->dual->face[f].size; v++)
            ptr[b->dual->face[f].node[v] + 2]++;
    for (int64_t i = 0; i < n; i++)
        ptr[i + 2] += ptr[i + 1];
    for (int64_t f = 0; f < b->dual->face_count; f++)
        for (int v = 0; v < b->dual->face[f].size; v++)
            (*corner)[ptr[b->dual->face[f].node[v] + 1]++] = 4 * f + v;
    return ptr;
}

static void domain_row(const builder *b, const int64_t *corner_ptr, const int64_t *corner, int64_t i,
                       row_sum *row, double *volume) {
    row->count = 0;
    *volume = 0;
    row_add(row, (int32_t)i, (const double[3]){0, 0, 0});
    for (int64_t k = b->dual->edge_ptr[i]; k < b->dual->edge_ptr[i + 1]; k++) {
        const edge_integral *edge = &b->edge[b->dual->edge_id[k]];
        bool low = b->dual->edge_node[k] > i;
        double sign = low ? 1 : -1;
        *volume += b->section ? edge->part[!low] : sign * edge->flux;
        for (int p = 0; p < edge->count; p++) {
            const double *sum = &edge->sum[b->columns * p];
            row_add(
                row, edge->node[p],
                (const double[3]){sign * sum[0], b->section ? sum[3 + !low] : sign * sum[1], sign * sum[2]});
        }
    }
    double aside = 0, *flux = b->section ? &aside : volume;
    for (int64_t k = corner_ptr[i]; k < corner_ptr[i + 1]; k++)
        boundary_corner(b->mesh, &b->dual->face[corner[k] / 4], (int)(corner[k] % 4), b->out, flux, row_add,
                        row);
    for (int64_t k = 0; b->section && k < row->count; k++)
        row->sum[3 * k] -= row->sum[3 * k + 1];
}

/* Writes row i (sorted, divided by the volume) or, when `node` is NULL, only clears the slots. */
static void finish_row(row_sum *row, double volume, int32_t *node, double *gradient) {
    if (node) {
        memcpy(node, row->node, (size_t)row->count * sizeof *node);
        qsort(node, (size_t)row->count, sizeof *node, sf_by_number);
        for (int64_t k = 0; k < row->count; k++)
            for (int c = 0; c < 3; c++)
                gradient[3 * k + c] = row->sum[3 * row->slot[node[k]] + c] / volume;
    }
    for (int64_t k = 0; k < row->count; k++)
        row->slot[row->node[k]] = -1;
}

/* Two passes over the rows: lengths first, then entries. */
static sf_status assemble_rows(builder *b, sf_error *err) {
    int64_t n = b->mesh->node_count;
    sf_domains *out = b->out;
    SF_OWNED int64_t *corner = NULL, *corner_ptr = list_corners(b, &corner, err);
    SF_OWNED int32_t *slot = sf_alloc(err, n, sizeof *slot, "row"),
                     *node = sf_alloc(err, n, sizeof *node, "row");
    SF_OWNED double *sum = sf_alloc(err, 3 * n, sizeof *sum, "row");
    row_sum row = {slot, 0, node, sum};
    out->volume = sf_alloc(err, n, sizeof *out->volume, "volumes");
    out->ptr = sf_alloc(err, n + 1, sizeof *out->ptr, "domains");
    SF_TRY(err->status);
    for (int64_t i = 0; i < n; i++)
        slot[i] = -1;
    for (int64_t i = 0; i < n; i++) {
        domain_row(b, corner_ptr, corner, i, &row, &out->volume[i]);
        finish_row(&row, 1, NULL, NULL);
        out->ptr[i + 1] = out->ptr[i] + row.count;
        if (!(out->volume[i] > 0)) {
            const double *x = &b->mesh->position[3 * i];
            return SF_FAIL(err, SF_ERR_MODEL,
                           "the smoothing domain of the node at (%.6g, %.6g, %.6g) m has volume %.3g m3",
                           x[0], x[1], x[2], out->volume[i]);
        }
    }
    SF_ALLOC_ALL(err, "domains", SF_ROOM(out->node, out->ptr[n]), SF_ROOM(out->b, 3 * out->ptr[n]));
    for (int64_t i = 0; i < n && err->status == SF_OK; i++) {
        domain_row(b, corner_ptr, corner, i, &row, &out->volume[i]);
        finish_row(&row, out->volume[i], &out->node[out->ptr[i]], &out->b[3 * out->ptr[i]]);
    }
    return err->status;
}

sf_status sf_domains_build(const sf_mesh *mesh, const sf_dual *dual, double condition_limit, double *support,
                           sf_domains *out, sf_error *err) {
    memset(out, 0, sizeof *out);
    builder b = {.mesh = mesh,
                 .dual = dual,
                 .cloud = {mesh->position, support, sf_mesh_is_section(mesh)},
                 .condition_limit = condition_limit,
                 .section = sf_mesh_is_section(mesh),
                 .columns = sf_mesh_is_section(mesh) ? SECTION_COLUMNS : COLUMNS,
                 .out = out};
    b.edge = sf_alloc(err, dual->edge_count, sizeof *b.edge, "edge integrals");
    b.poor = sf_alloc(err, mesh->node_count, sizeof *b.poor, "node marks");
    SF_ALLOC_ALL(err, "reaches", SF_ROOM(b.edge_reach, dual->edge_count), SF_ROOM(b.reach, mesh->node_count));
    if (err->status == SF_OK)
        measure_reach(&b);
    if (err->status == SF_OK && integrate_with_growth(&b, support, err) == SF_OK &&
        shape_at_nodes(&b, err) == SF_OK) {
        find_gap(&b);
        assemble_rows(&b, err);
    }
    if (b.edge)
        clear_edges(&b);
    sf_visibility_free(b.hidden, mesh->node_count);
    sf_grid_free(&b.grid);
    SF_FREE(b.edge, b.poor, b.edge_reach, b.reach);
    if (err->status != SF_OK)
        sf_domains_free(out);
    return err->status;
}

sf_status sf_domains_find_gaps(const sf_mesh *mesh, const sf_dual *dual, const double *support,
                               sf_domains *out, sf_error *err) {
    memset(out, 0, sizeof *out);
    builder b = {.mesh = mesh, .dual = dual, .section = sf_mesh_is_section(mesh), .out = out};
    SF_ALLOC_ALL(err, "reaches", SF_ROOM(b.edge_reach, dual->edge_count), SF_ROOM(b.reach, mesh->node_count));
    if (err->status == SF_OK) {
        measure_reach(&b);
        if (look_around(&b, support, err) == SF_OK)
            find_gap(&b);
    }
    sf_visibility_free(b.hidden, mesh->node_count);
    sf_grid_free(&b.grid);
    SF_FREE(b.edge_reach, b.reach);
    return err->status;
}

void sf_domains_free(sf_domains *d) {
    SF_CLEAR(d, d->volume, d->ptr, d->node, d->b, d->phi_ptr, d->phi_node, d->phi_value);
}

static void sum_add(void *target, int32_t node, const double part[3]) {
    double *sum = target;
    for (int c = 0; c < 3; c++)
        sum[3 * node + c] += part[c];
}

void sf_domains_boundary_integral(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains,
                                  double *sum) {
    double flux = 0;
    for (int64_t f = 0; f < dual->face_count; f++)
        for (int v = 0; v < dual->face[f].size; v++)
            boundary_corner(mesh, &dual->face[f], v, domains, &flux, sum_add, sum);
}

/* ---- invariants ---- */

static const double INVARIANT_BOUND = 1e-10;

/* Both completeness conditions of one domain, with coordinates taken from the node itself. */
static void measure_domain(const sf_mesh *mesh, const sf_domains *d, int64_t i, double spacing,
                           sf_invariants *out) {
    const bool section = sf_mesh_is_section(mesh);
    const double *x = &mesh->position[3 * i];
    double unity[3] = {0}, linear[3][3] = {{0}};
    for (int64_t k = d->ptr[i]; k < d->ptr[i + 1]; k++)
        for (int c = 0; c < 3; c++) {
            unity[c] += d->b[3 * k + c];
            for (int r = 0; r < 3; r++)
                linear[r][c] += (mesh->position[3 * (int64_t)d->node[k] + r] - x[r]) * d->b[3 * k + c];
        }
    if (section) { /* the hoop row is no gradient: of a uniform stretch it gives 1 */
        linear[1][1] = linear[0][1] + x[0] * unity[1];
        unity[1] = linear[0][1] = linear[2][1] = 0;
    }
    for (int c = 0; c < 3; c++) {
        out->unity = fmax(out->unity, fabs(unity[c]) * spacing);
        for (int r = 0; r < 3; r++)
            out->linear = fmax(out->linear, fabs(linear[r][c] - (r == c)));
    }
}

static void measure_shape(const sf_mesh *mesh, const sf_domains *d, int64_t i, double spacing,
                          sf_invariants *out) {
    double sum = -1, moment[3] = {0};
    for (int64_t k = d->phi_ptr[i]; k < d->phi_ptr[i + 1]; k++) {
        sum += d->phi_value[k];
        for (int c = 0; c < 3; c++)
            moment[c] += d->phi_value[k] *
                         (mesh->position[3 * (int64_t)d->phi_node[k] + c] - mesh->position[3 * i + c]);
    }
    out->shape = fmax(out->shape, fabs(sum));
    for (int c = 0; c < 3; c++)
        out->shape = fmax(out->shape, fabs(moment[c]) / spacing);
}

sf_status sf_invariants_measure(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *d,
                                const double *spacing, double volume, sf_invariants *out, sf_error *err) {
    int64_t n = mesh->node_count;
    const bool section = sf_mesh_is_section(mesh);
    SF_OWNED double *balance = sf_alloc(err, 3 * n, sizeof *balance, "invariants");
    double total = 0;
    SF_TRY(err->status);
    sf_domains_boundary_integral(mesh, dual, d, balance);
    for (int64_t i = 0; i < n; i++) {
        measure_domain(mesh, d, i, spacing[i], out);
        measure_shape(mesh, d, i, spacing[i], out);
        total += d->volume[i];
        for (int64_t k = d->ptr[i]; k < d->ptr[i + 1]; k++)
            for (int c = 0; c < 3; c++)
                balance[3 * (int64_t)d->node[k] + (section && c == 1 ? 0 : c)] -=
                    d->volume[i] * d->b[3 * k + c];
    }
    for (int64_t k = 0; k < 3 * n; k++)
        out->telescope = fmax(out->telescope, fabs(balance[k]) / (spacing[k / 3] * spacing[k / 3]));
    double off = fabs(total / volume - 1);
    out->volume = off <= out->volume ? out->volume : off; /* NaN stays */
    return SF_OK;
}

sf_status sf_invariants_check(const sf_invariants *v, sf_error *err) {
    const struct {
        const char *name;
        double value;
    } item[] = {
        {"sum of B", v->unity},
        {"sum of X B", v->linear},
        {"sum of V", v->volume},
        {"sum of V B against the boundary", v->telescope},
        {"completeness of phi", v->shape},
    };
    for (size_t k = 0; k < sizeof item / sizeof item[0]; k++)
        if (!(item[k].value <= INVARIANT_BOUND))
            return SF_FAIL(err, SF_ERR_MODEL,
                           "the discretisation breaks an invariant: %s is off by %.3g (bound %.0e)",
                           item[k].name, item[k].value, INVARIANT_BOUND);
    return SF_OK;
}
