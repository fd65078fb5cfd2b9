/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/connectivity.h"

#include "base/grid.h"
#include "base/mat3.h"
#include "base/sets.h"
#include <gsl/gsl_sort.h>

#define ADVICE                                                                                                 \
    "fuse the volumes, so that their meshes share nodes and faces (in gmsh BooleanUnion, BooleanFragments or " \
    "Coherence)"

/* ---- cells in each other ---- */

/* A point is inside from this share of the way from a cell's face to its centre on. */
static const double DEPTH = 1e-2;

/* Points on the surface: the nodes, then the middles of the faces. */
typedef struct probes {
    int64_t nodes, count;
    int32_t *node;    /* [nodes] which node it is */
    double *position; /* [count][3] m */
    double *zero;     /* [count] radii for the grid */
    int32_t *near;    /* [count] those near a cell */
} probes;

static void free_probes(probes *p) {
    SF_FREE(p->node, p->position, p->zero, p->near);
}

static sf_status take_probes(const sf_mesh *mesh, const sf_dual *dual, probes *p, sf_error *err) {
    unsigned long most = (unsigned long)(mesh->node_count + dual->face_count);
    SF_OWNED uint8_t *surface = sf_alloc(err, mesh->node_count, 1, "surface nodes");
    p->node = sf_alloc(err, mesh->node_count, sizeof *p->node, "surface nodes");
    SF_TRY(SF_ALLOC_ALL(err, "surface points", SF_ROOM(p->position, 3 * most), SF_ROOM(p->zero, most),
                        SF_ROOM(p->near, most)));
    for (int64_t f = 0; f < dual->face_count; f++)
        for (int k = 0; k < dual->face[f].size; k++)
            surface[dual->face[f].node[k]] = 1;
    for (int32_t i = 0; i < mesh->node_count; i++)
        if (surface[i])
            p->node[p->nodes++] = i;
    for (; p->count < p->nodes; p->count++)
        sf_mesh_middle(mesh, &p->node[p->count], 1, &p->position[3 * p->count]);
    for (int64_t f = 0; f < dual->face_count; f++, p->count++)
        sf_mesh_middle(mesh, dual->face[f].node, dual->face[f].size, &p->position[3 * p->count]);
    return err->status;
}

/* True if the point r is inside the tetrahedron of the origin and a, b, c, and not too near the face a b
 * c. */
static bool is_within(const double r[3], const double a[3], const double b[3], const double c[3]) {
    static const double EDGE = -1e-9;
    double volume = sf_triple3(a, b, c), u = sf_triple3(r, b, c) / volume, v = sf_triple3(a, r, c) / volume,
           w = sf_triple3(a, b, r) / volume;
    return u >= EDGE && v >= EDGE && w >= EDGE && 1 - u - v - w >= DEPTH;
}

/* The cell as tetrahedra from its centre to its faces; quadrangles are split at their middles. */
static bool holds_point(const sf_mesh *mesh, int64_t cell, const double centre[3], const double x[3]) {
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[cell]);
    const int32_t *node = &mesh->cell_node[mesh->cell_ptr[cell]];
    double r[3], v[8][3], middle[3];
    sf_sub3(x, centre, r);
    for (int k = 0; k < shape->vertices; k++)
        sf_sub3(&mesh->position[3 * (int64_t)node[k]], centre, v[k]);
    for (int f = 0; f < shape->faces; f++) {
        const int *p = shape->face[f];
        if (sf_cell_face_size(shape, f) == 3 && is_within(r, v[p[0]], v[p[1]], v[p[2]]))
            return true;
        if (sf_cell_face_size(shape, f) == 3)
            continue;
        for (int c = 0; c < 3; c++)
            middle[c] = 0.25 * (v[p[0]][c] + v[p[1]][c] + v[p[2]][c] + v[p[3]][c]);
        for (int k = 0; k < 4; k++)
            if (is_within(r, middle, v[p[k]], v[p[(k + 1) % 4]]))
                return true;
    }
    return false;
}

static bool has_node(const sf_mesh *mesh, int64_t cell, int32_t node) {
    for (int64_t k = mesh->cell_ptr[cell]; k < mesh->cell_ptr[cell + 1]; k++)
        if (mesh->cell_node[k] == node)
            return true;
    return false;
}

static sf_status check_cell(const sf_mesh *mesh, const sf_grid *grid, const probes *p, int64_t cell,
                            sf_error *err) {
    double centre[3], radius = 0;
    sf_mesh_middle(mesh, &mesh->cell_node[mesh->cell_ptr[cell]],
                   mesh->cell_ptr[cell + 1] - mesh->cell_ptr[cell], centre);
    for (int64_t k = mesh->cell_ptr[cell]; k < mesh->cell_ptr[cell + 1]; k++)
        radius = fmax(radius, sf_distance3(&mesh->position[3 * (int64_t)mesh->cell_node[k]], centre));
    int64_t count = sf_grid_gather(grid, centre, (1 - DEPTH) * radius, p->count, p->near);
    for (int64_t k = 0; k < count; k++) {
        int32_t probe = p->near[k];
        const double *x = &p->position[3 * (int64_t)probe];
        if ((probe < p->nodes && has_node(mesh, cell, p->node[probe])) || !holds_point(mesh, cell, centre, x))
            continue;
        return SF_REFUSE(
            err,
            "the pad overlaps itself: its surface at (%.4g, %.4g, %.4g) mm lies inside the cell at (%.4g, "
            "%.4g, %.4g) mm: " ADVICE,
            1e3 * x[0], 1e3 * x[1], 1e3 * x[2], 1e3 * centre[0], 1e3 * centre[1], 1e3 * centre[2]);
    }
    return SF_OK;
}

/* Wherever bodies overlap, the surface of one lies in the other. */
static sf_status check_overlap(const sf_mesh *mesh, const sf_dual *dual, sf_error *err) {
    SF_OWNED_BY(free_probes) probes p = {0};
    SF_OWNED_BY(sf_grid_free) sf_grid grid = {0};
    if (take_probes(mesh, dual, &p, err) == SF_OK &&
        sf_grid_build(&grid, p.count, p.position, p.zero, err) == SF_OK)
        for (int64_t c = 0; c < mesh->cell_count && err->status == SF_OK; c++)
            check_cell(mesh, &grid, &p, c, err);
    return err->status;
}

/* ---- parts ---- */

/* The smallest of several parts, with its place. */
static sf_status refuse_parts(const sf_mesh *mesh, int64_t *parent, sf_error *err) {
    int64_t parts = 0, least = 0;
    double low[3], high[3];
    sf_box3(0, NULL, low, high);
    SF_OWN(int64_t, cells, mesh->cell_count, "connected cells", err);
    for (int64_t c = 0; c < mesh->cell_count; c++)
        cells[sf_sets_find(parent, c)]++;
    for (int64_t c = 0; c < mesh->cell_count; c++) {
        parts += cells[c] > 0;
        least = cells[c] > 0 && (cells[least] == 0 || cells[c] <= cells[least]) ? c : least;
    }
    for (int64_t c = 0; c < mesh->cell_count; c++)
        for (int64_t k = mesh->cell_ptr[c]; sf_sets_find(parent, c) == least && k < mesh->cell_ptr[c + 1];
             k++)
            sf_box3_add(&mesh->position[3 * (int64_t)mesh->cell_node[k]], low, high);
    SF_REFUSE(
        err,
        "the pad is in %lld parts that share no faces of cells: the smallest, of %lld cells, lies between (%.4g, "
        "%.4g, %.4g) and (%.4g, %.4g, %.4g) mm: " ADVICE
        ", or let them be bodies that touch each other (pad.separate = true)",
        (long long)parts, (long long)cells[least], 1e3 * low[0], 1e3 * low[1], 1e3 * low[2], 1e3 * high[0],
        1e3 * high[1], 1e3 * high[2]);
    return err->status;
}

static sf_status check_parts(const sf_mesh *mesh, const sf_dual *dual, sf_error *err) {
    SF_OWNED int64_t *parent = sf_sets_alone(mesh->cell_count, "connected cells", err);
    SF_TRY(err->status);
    for (int64_t f = 0; f < dual->inner_count; f++)
        sf_sets_join(parent, dual->inner[f].cell[0], dual->inner[f].cell[1]);
    for (int64_t c = 0; c < mesh->cell_count && err->status == SF_OK; c++)
        if (sf_sets_find(parent, c) != 0)
            refuse_parts(mesh, parent, err);
    return err->status;
}

/* Place of a node in the cell's list. */
static int64_t corner(const sf_mesh *mesh, int64_t cell, int32_t node) {
    int64_t k = mesh->cell_ptr[cell];
    while (mesh->cell_node[k] != node)
        k++;
    return k;
}

/* Around every node the corners of cells are joined through the faces: bodies that only touch at a point or
 * along an edge would be a hinge. */
static sf_status check_hinges(const sf_mesh *mesh, const sf_dual *dual, sf_error *err) {
    int64_t corners = mesh->cell_ptr[mesh->cell_count];
    SF_OWNED int64_t *parent = sf_sets_alone(corners, "connected cells", err);
    SF_OWN(int64_t, root, mesh->node_count, "connected cells", err);
    for (int64_t f = 0; f < dual->inner_count; f++)
        for (int k = 0; k < 4; k++) {
            const sf_inner_face *face = &dual->inner[f];
            if (face->node[k] >= 0)
                sf_sets_join(parent, corner(mesh, face->cell[0], face->node[k]),
                             corner(mesh, face->cell[1], face->node[k]));
        }
    for (int64_t k = 0; k < corners; k++) { /* roots from 1 on */
        int32_t node = mesh->cell_node[k];
        const double *x = &mesh->position[3 * (int64_t)node];
        if (root[node] == 0)
            root[node] = sf_sets_find(parent, k) + 1;
        else if (root[node] != sf_sets_find(parent, k) + 1) {
            SF_REFUSE(err,
                      "two regions of the pad hang together at an edge or a point only, at (%.4g, %.4g, "
                      "%.4g) mm: let them share faces of cells, or part them",
                      1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
            break;
        }
    }
    return err->status;
}

sf_status sf_connectivity_check(const sf_mesh *mesh, const sf_dual *dual, bool separate, sf_error *err) {
    if ((!sf_mesh_is_section(mesh) && check_overlap(mesh, dual, err) != SF_OK) ||
        (!separate && check_parts(mesh, dual, err) != SF_OK))
        return err->status;
    return check_hinges(mesh, dual, err);
}

static const double IN_PLANE = 1e-9; /* of the group's extent */

/* The faces of one cell and those of two, each ascending, by their ascending nodes (the first is -1 for a
 * triangle); owned. */
typedef struct face_lists {
    int64_t outer_count, inner_count;
    int32_t (*outer)[4], (*inner)[4];
} face_lists;

static void free_lists(face_lists *lists) {
    SF_FREE(lists->outer, lists->inner);
}

static sf_status list_faces(const sf_dual *dual, face_lists *lists, sf_error *err) {
    lists->outer_count = dual->face_count;
    lists->inner_count = dual->inner_count;
    lists->outer = sf_alloc(err, dual->face_count, sizeof *lists->outer, "boundary faces");
    lists->inner = sf_alloc(err, dual->inner_count, sizeof *lists->inner, "inner faces");
    for (int64_t f = 0; lists->outer && f < dual->face_count; f++) {
        memcpy(lists->outer[f], dual->face[f].node, sizeof dual->face[f].node);
        gsl_sort_int(lists->outer[f], 1, 4);
    }
    for (int64_t f = 0; lists->inner && f < dual->inner_count; f++)
        memcpy(lists->inner[f], dual->inner[f].node, sizeof dual->inner[f].node);
    if (err->status == SF_OK) {
        qsort(lists->outer, (size_t)lists->outer_count, sizeof *lists->outer, sf_face_compare);
        qsort(lists->inner, (size_t)lists->inner_count, sizeof *lists->inner, sf_face_compare);
    }
    return err->status;
}

static bool has(int32_t (*list)[4], int64_t count, const int32_t *key) {
    return bsearch(key, list, (size_t)count, sizeof *list, sf_face_compare) != NULL;
}

static const double *place_of(const sf_mesh *mesh, const int32_t *node) {
    return &mesh->position[3 * (int64_t)node[3]];
}

/* Every face on a cell of the pad, and on one only unless `inside` is allowed. */
static sf_status check_faces(const sf_case *c, const sf_mesh *mesh, const face_lists *lists, const char *key,
                             const sf_node_set *set, bool inside, sf_error *err) {
    int64_t bare = set->left_out, within = 0, all = set->face_count + set->left_out;
    const double *bare_at = NULL, *within_at = NULL;
    for (int64_t f = 0; f < set->face_count; f++) {
        const int32_t *node = &set->face[4 * f];
        if (has(lists->outer, lists->outer_count, node))
            continue;
        if (has(lists->inner, lists->inner_count, node)) {
            within++;
            within_at = place_of(mesh, node);
        } else {
            bare++;
            bare_at = place_of(mesh, node);
        }
    }
    if (bare > 0 && !bare_at)
        return SF_REFUSE(err,
                         "%s: %lld of the %lld faces of the surface group \"%s\" lie on no cell of the "
                         "volume group \"%s\": does it lack a volume, or has the group faces of the missile?",
                         key, (long long)bare, (long long)all, set->name, c->pad_group);
    if (bare > 0)
        return SF_REFUSE(err,
                         "%s: %lld of the %lld faces of the surface group \"%s\" lie on no cell of the "
                         "volume group \"%s\", one at (%.4g, %.4g, %.4g) mm: cells of the pad are missing "
                         "there",
                         key, (long long)bare, (long long)all, set->name, c->pad_group, 1e3 * bare_at[0],
                         1e3 * bare_at[1], 1e3 * bare_at[2]);
    if (within > 0 && !inside)
        return SF_REFUSE(err,
                         "%s: %lld of the %lld faces of the surface group \"%s\" lie inside the pad, one at "
                         "(%.4g, %.4g, %.4g) mm: it may hold the pad's surface only",
                         key, (long long)within, (long long)all, set->name, 1e3 * within_at[0],
                         1e3 * within_at[1], 1e3 * within_at[2]);
    return SF_OK;
}

/* The plane x or y = place of a set; false if it has none. */
static bool find_plane(const sf_mesh *mesh, const sf_node_set *set, int *axis, double *place, double *slack) {
    double low[3], high[3], extent = 0;
    sf_box3(0, NULL, low, high);
    for (int64_t k = 0; k < set->count; k++)
        sf_box3_add(&mesh->position[3 * (int64_t)set->node[k]], low, high);
    for (int i = 0; i < 3; i++)
        extent = fmax(extent, high[i] - low[i]);
    *slack = IN_PLANE * extent;
    *axis = high[0] - low[0] <= *slack ? 0 : 1;
    *place = low[*axis];
    return high[*axis] - low[*axis] <= *slack;
}

/* The pad's faces in the plane of a group that no symmetry group holds would be free. */
static sf_status check_plane(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                             const sf_node_set *set, sf_error *err) {
    int axis;
    double place, slack;
    if (!find_plane(mesh, set, &axis, &place, &slack))
        return SF_OK;
    SF_OWNED uint8_t *member = sf_alloc(err, mesh->node_count, 1, "nodes of a symmetry plane");
    for (int g = 0; member && g < c->symmetry_count; g++) { /* a plane may be that of several groups */
        const sf_node_set *any = sf_mesh_find_set(mesh, c->symmetry_group[g]);
        for (int64_t k = 0; any && k < any->count; k++)
            member[any->node[k]] = 1;
    }
    for (int64_t f = 0; member && f < dual->face_count && err->status == SF_OK; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool in_plane = true;
        for (int k = 0; k < face->size; k++)
            in_plane = in_plane && fabs(mesh->position[3 * (int64_t)face->node[k] + axis] - place) <= slack;
        const double *x = &mesh->position[3 * (int64_t)face->node[0]];
        if (in_plane && !sf_surface_has_face(face, member))
            SF_REFUSE(err,
                      "pad.symmetry: the pad's surface at (%.4g, %.4g, %.4g) mm lies in the plane of the "
                      "group \"%s\" but in none of these groups: it would be free (a crack in a symmetry "
                      "plane cannot be modelled)",
                      1e3 * x[0], 1e3 * x[1], 1e3 * x[2], set->name);
    }
    return err->status;
}

sf_status sf_group_check(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_error *err) {
    const struct {
        const char *key;
        int count;
        const char (*name)[SF_CASE_NAME_SIZE];
        bool inside;
    } list[] = {{"pad.contact", 1, &c->contact_group, false},
                {"pad.fixed", c->fixed_count, c->fixed_group, true},
                {"pad.sliding", c->sliding_count, c->sliding_group, true},
                {"pad.symmetry", c->symmetry_count, c->symmetry_group, false}};
    SF_OWNED_BY(free_lists) face_lists lists = {0};
    list_faces(dual, &lists, err);
    for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
        for (int g = 0; g < list[k].count && err->status == SF_OK; g++) {
            const sf_node_set *set = sf_mesh_find_set(mesh, list[k].name[g]);
            if (!set || set->face_count == 0)
                continue;
            if (check_faces(c, mesh, &lists, list[k].key, set, list[k].inside, err) == SF_OK &&
                list[k].name == c->symmetry_group)
                check_plane(c, mesh, dual, set, err);
        }
    return err->status;
}
