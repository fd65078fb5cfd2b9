/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/group_check.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double IN_PLANE = 1e-9; /* of the group's extent */

typedef struct face_key {
    int32_t node[4]; /* ascending; the first is -1 for a triangle */
} face_key;

static int compare_key(const void *a, const void *b) {
    const face_key *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p->node[k] != q->node[k])
            return p->node[k] < q->node[k] ? -1 : 1;
    return 0;
}

static int by_value(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* The faces of one cell and those of two, each ascending; owned. */
typedef struct face_lists {
    int64_t outer_count, inner_count;
    face_key *outer, *inner;
} face_lists;

static sf_status list_faces(const sf_dual *dual, face_lists *lists, sf_error *err) {
    lists->outer_count = dual->face_count;
    lists->inner_count = dual->inner_count;
    lists->outer = sf_alloc(err, (unsigned long)dual->face_count, sizeof *lists->outer, "boundary faces");
    lists->inner = sf_alloc(err, (unsigned long)dual->inner_count, sizeof *lists->inner, "inner faces");
    for (int64_t f = 0; lists->outer && f < dual->face_count; f++) {
        memcpy(lists->outer[f].node, dual->face[f].node, sizeof dual->face[f].node);
        qsort(lists->outer[f].node, 4, sizeof(int32_t), by_value);
    }
    for (int64_t f = 0; lists->inner && f < dual->inner_count; f++)
        memcpy(lists->inner[f].node, dual->inner[f].node, sizeof dual->inner[f].node);
    if (err->status == SF_OK) {
        qsort(lists->outer, (size_t)lists->outer_count, sizeof *lists->outer, compare_key);
        qsort(lists->inner, (size_t)lists->inner_count, sizeof *lists->inner, compare_key);
    }
    return err->status;
}

static bool has(const face_key *list, int64_t count, const void *key) {
    return bsearch(key, list, (size_t)count, sizeof *list, compare_key) != NULL;
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
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: %lld of the %lld faces of the surface group \"%s\" lie on no cell of the volume group "
            "\"%s\": does it lack a volume, or has the group faces of the missile?",
            key, (long long)bare, (long long)all, set->name, c->pad_group);
    if (bare > 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: %lld of the %lld faces of the surface group \"%s\" lie on no cell of the volume group "
            "\"%s\", one at (%.4g, %.4g, %.4g) mm: cells of the pad are missing there",
            key, (long long)bare, (long long)all, set->name, c->pad_group, 1e3 * bare_at[0], 1e3 * bare_at[1],
            1e3 * bare_at[2]);
    if (within > 0 && !inside)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: %lld of the %lld faces of the surface group \"%s\" lie inside the pad, one at (%.4g, %.4g, "
            "%.4g) mm: it may hold the pad's surface only",
            key, (long long)within, (long long)all, set->name, 1e3 * within_at[0], 1e3 * within_at[1],
            1e3 * within_at[2]);
    return SF_OK;
}

/* The plane x or y = place of a set; false if it has none. */
static bool find_plane(const sf_mesh *mesh, const sf_node_set *set, int *axis, double *place, double *slack) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, extent = 0;
    for (int64_t k = 0; k < set->count; k++)
        for (int i = 0; i < 3; i++) {
            double x = mesh->position[3 * (int64_t)set->node[k] + i];
            low[i] = fmin(low[i], x);
            high[i] = fmax(high[i], x);
            extent = fmax(extent, high[i] - low[i]);
        }
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
    uint8_t *member = sf_alloc(err, (unsigned long)mesh->node_count, 1, "nodes of a symmetry plane");
    for (int g = 0; member && g < c->symmetry_count; g++) { /* a plane may be that of several groups */
        const sf_node_set *any = sf_mesh_find_set(mesh, c->symmetry_group[g]);
        for (int64_t k = 0; any && k < any->count; k++)
            member[any->node[k]] = 1;
    }
    for (int64_t f = 0; member && f < dual->face_count && err->status == SF_OK; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool in_plane = true, in_set = true;
        for (int k = 0; k < face->size; k++) {
            in_plane = in_plane && fabs(mesh->position[3 * (int64_t)face->node[k] + axis] - place) <= slack;
            in_set = in_set && member[face->node[k]];
        }
        const double *x = &mesh->position[3 * (int64_t)face->node[0]];
        if (in_plane && !in_set)
            SF_FAIL(
                err, SF_ERR_INPUT,
                "pad.symmetry: the pad's surface at (%.4g, %.4g, %.4g) mm lies in the plane of the group \"%s\" but "
                "in none of these groups: it would be free (a crack in a symmetry plane cannot be modelled)",
                1e3 * x[0], 1e3 * x[1], 1e3 * x[2], set->name);
    }
    free(member);
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
    face_lists lists = {0};
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
    free(lists.outer);
    free(lists.inner);
    return err->status;
}
