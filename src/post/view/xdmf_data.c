/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/xdmf_data.h"

#include "base/units.h"
#include "io/provenance.h"
#include "post/figures/figures.h"
#include "post/results/results_check.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const sf_missile_array sf_missile_arrays[SF_MISSILE_ARRAYS] = {
    [SF_MISSILE_SPEED] = {"speed_m_s", "m s-1", "speed of the missile along its direction of motion", 1},
    [SF_MISSILE_ACCELERATION] = {"acceleration_g", "9.80665 m s-2",
                                 "the acceleration that a_max is of, not filtered", 1},
    [SF_MISSILE_FORCE] = {"contact_force_N", "N", "on the missile, against its direction of motion", 1},
    [SF_MISSILE_CENTRE] = {"sphere_centre_m", "m", "centre of the missile's exact sphere", 3},
};

int sf_missile_array_count(const sf_results *r) {
    return r->sphere_radius > 0 ? SF_MISSILE_ARRAYS : SF_MISSILE_CENTRE;
}

/* ---- which frames ---- */

/* Is there a frame of the very step of /peak? */
static bool is_among_frames(const sf_results *r, const sf_frame_head *head) {
    for (int64_t k = 0; k < r->frame_count; k++)
        if (r->frames[k].time == head->time)
            return true;
    return false;
}

sf_status sf_shown_find(const sf_results *r, sf_shown *s, sf_error *err) {
    bool peak = r->frame_count > 0 && r->has_peak && !is_among_frames(r, &r->peak);
    unsigned long room = (unsigned long)r->frame_count + 1;
    *s = (sf_shown){.peak = -1};
    s->head = sf_alloc(err, room, sizeof *s->head, "the frames for ParaView");
    s->fields = sf_alloc(err, room, sizeof *s->fields, "the fields of the frames");
    for (int64_t k = 0; k < r->frame_count && err->status == SF_OK; k++) {
        if (peak && s->peak < 0 && r->peak.time < r->frames[k].time) {
            s->peak = s->count;
            s->head[s->count++] = &r->peak;
        }
        if (r->has_peak && r->frames[k].time == r->peak.time)
            s->peak = s->count;
        s->head[s->count++] = &r->frames[k];
    }
    if (err->status == SF_OK && peak && s->peak < 0) {
        s->peak = s->count;
        s->head[s->count++] = &r->peak;
    }
    return err->status;
}

void sf_shown_free(sf_shown *s) {
    free(s->head);
    free(s->fields);
    *s = (sf_shown){0};
}

/* ---- the file ---- */

/* The file, and how numbers are stored. */
typedef struct store {
    sf_h5 *file;
    const sf_results *results;
    bool full;
} store;

/* Rounds to multiples of a power of two, the largest magnitude to SF_XDMF_BITS of them; below the smallest
 * float all are 0. */
static void round_array(double *value, int64_t count) {
    double largest = 0;
    int exponent;
    for (int64_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(value[i]));
    frexp(largest, &exponent);
    double unit = ldexp(1, exponent - SF_XDMF_BITS);
    for (int64_t i = 0; i < count; i++)
        value[i] = largest < FLT_MIN ? 0 : unit * rint(value[i] / unit);
}

/* Writes an array of the pad or the missile; rounds it in its place. */
static sf_status put(const store *s, const sf_h5_info *info, int64_t rows, int columns, double *value,
                     sf_error *err) {
    const int64_t dims[2] = {rows, columns};
    if (!s->full)
        round_array(value, rows * columns);
    return sf_h5_write_packed(s->file, info, SF_H5_F64, !s->full, columns > 1 ? 2 : 1, dims, value, err);
}

static sf_status put_integers(const store *s, const char *path, const char *description, sf_h5_type type,
                              int64_t rows, int64_t columns, const void *value, sf_error *err) {
    const int64_t dims[2] = {rows, columns};
    const sf_h5_info info = {path, "1", description};
    return sf_h5_write_packed(s->file, &info, type, false, columns > 1 ? 2 : 1, dims, value, err);
}

/* XDMF mixed topology: for each cell its code, then its vertices. */
static sf_status write_topology(const store *s, sf_error *err) {
    const sf_results *r = s->results;
    int64_t length = r->cell_nnz + r->cell_count, k = 0;
    int32_t *mixed = sf_alloc(err, (unsigned long)length, sizeof *mixed, "the topology");
    if (!mixed)
        return err->status;
    for (int64_t c = 0; c < r->cell_count; c++) {
        mixed[k++] = r->cell_type[c];
        for (int64_t v = r->cell_ptr[c]; v < r->cell_ptr[c + 1]; v++)
            mixed[k++] = r->cell_node[v];
    }
    put_integers(s, "/pad/topology", "XDMF mixed topology: code of each cell, then its vertices", SF_H5_I32,
                 length, 1, mixed, err);
    free(mixed);
    if (err->status == SF_OK && r->surface_triangle_count > 0)
        put_integers(s, "/missile/triangle", "triangles of the missile's surface", SF_H5_I32,
                     r->surface_triangle_count, 3, r->surface_triangle, err);
    return err->status;
}

/* Of each cell, and in a pad of layers of each node: a cell belongs to one material as its nodes do. */
static sf_status write_materials(const store *s, sf_error *err) {
    const sf_results *r = s->results;
    uint8_t *material = sf_alloc(err, (unsigned long)r->cell_count, sizeof *material, "materials of cells");
    for (int64_t c = 0; c < r->cell_count && err->status == SF_OK; c++)
        material[c] = r->layer_count > 0 ? r->node_layer[r->cell_node[r->cell_ptr[c]]] : 0;
    if (err->status == SF_OK &&
        put_integers(s, "/pad/material", "number of the material of each cell, as that of the layer",
                     SF_H5_U8, r->cell_count, 1, material, err) == SF_OK &&
        r->layer_count > 0)
        put_integers(s, "/pad/layer", "number of the layer of each node", SF_H5_U8, r->node_count, 1,
                     r->node_layer, err);
    free(material);
    return err->status;
}

static sf_status write_pad(const store *s, const sf_h5_info *info, const double *displacement,
                           sf_error *err) {
    const sf_results *r = s->results;
    double *moved = sf_alloc(err, 3 * (unsigned long)r->node_count, sizeof *moved, info->description);
    if (!moved)
        return err->status;
    for (int64_t i = 0; i < 3 * r->node_count; i++)
        moved[i] = r->position[i] + (displacement ? displacement[i] : 0);
    put(s, info, r->node_count, 3, moved, err);
    free(moved);
    return err->status;
}

static sf_status write_missile(const store *s, const sf_h5_info *info, const sf_frame_head *head,
                               sf_error *err) {
    const sf_results *r = s->results;
    double *moved = sf_alloc(err, 3 * (unsigned long)r->surface_node_count, sizeof *moved, info->description);
    if (!moved)
        return err->status;
    for (int64_t i = 0; i < r->surface_node_count; i++)
        sf_results_place(r, head, &r->surface_position[3 * i], &moved[3 * i]);
    put(s, info, r->surface_node_count, 3, moved, err);
    free(moved);
    return err->status;
}

/* The row of the history of that time, or the last before it. */
static int64_t row_at(const sf_history *h, double time) {
    int64_t low = 0, high = h->rows - 1;
    while (low < high) {
        int64_t middle = (low + high + 1) / 2;
        if (h->time[middle] <= time)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static sf_status write_missile_arrays(const store *s, const sf_frame_head *head, int64_t index,
                                      sf_error *err) {
    const sf_results *r = s->results;
    int64_t row = row_at(&r->history, head->time), n = r->surface_node_count;
    double value[SF_MISSILE_ARRAYS][3] = {[SF_MISSILE_SPEED] = {r->history.velocity[row]},
                                          [SF_MISSILE_ACCELERATION] = {sf_figures_reading(r, row)},
                                          [SF_MISSILE_FORCE] = {r->history.contact_force[row]}};
    sf_results_place(r, head, r->sphere_centre, value[SF_MISSILE_CENTRE]);
    double *all = sf_alloc(err, 3 * (unsigned long)n, sizeof *all, "arrays of the missile");
    for (int k = 0; k < sf_missile_array_count(r) && err->status == SF_OK; k++) {
        const sf_missile_array *a = &sf_missile_arrays[k];
        char path[96];
        snprintf(path, sizeof path, "/frames/%06lld/%s", (long long)index, a->name);
        for (int64_t i = 0; i < n * a->components; i++)
            all[i] = value[k][i % a->components];
        put(s, &(sf_h5_info){path, a->units, a->description}, n, a->components, all, err);
    }
    free(all);
    return err->status;
}

static void note_largest(const sf_results *r, const sf_frame *frame, double largest[SF_FRAME_FIELDS]) {
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        int64_t count =
            frame->field[f] ? r->node_count * sf_frame_field_get((sf_frame_field)f)->components : 0;
        for (int64_t i = 0; i < count; i++)
            largest[f] = fmax(largest[f], fabs(frame->field[f][i]));
    }
}

static sf_status write_fields(const store *s, sf_frame *frame, int64_t index, sf_error *err) {
    for (int f = 0; f < SF_FRAME_FIELDS && err->status == SF_OK; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        char path[96];
        snprintf(path, sizeof path, "/frames/%06lld/%s", (long long)index, info->array);
        if (frame->field[f])
            put(s, &(sf_h5_info){path, info->units, info->description}, s->results->node_count,
                info->components, frame->field[f], err);
    }
    return err->status;
}

static sf_status write_frame(const store *s, const sf_frame_head *head, sf_frame *frame, int64_t index,
                             sf_error *err) {
    char path[96];
    snprintf(path, sizeof path, "/frames/%06lld/pad_position", (long long)index);
    if (write_pad(s, &(sf_h5_info){path, "m", "positions of the pad's nodes, deformed"},
                  frame->field[SF_FRAME_DISPLACEMENT], err) != SF_OK)
        return err->status;
    snprintf(path, sizeof path, "/frames/%06lld/missile_position", (long long)index);
    if (write_missile(s, &(sf_h5_info){path, "m", "positions of the missile's surface nodes"}, head, err) !=
            SF_OK ||
        write_missile_arrays(s, head, index, err) != SF_OK)
        return err->status;
    return write_fields(s, frame, index, err);
}

/* ---- all frames ---- */

static int fields_of(const sf_frame *frame) {
    int fields = 0;
    for (int f = 0; f < SF_FRAME_FIELDS; f++)
        fields |= (frame->field[f] != NULL) << f;
    return fields;
}

/* The fields to read of frame k: /peak holds all of them, and shows those of the frames. */
static int fields_wanted(const sf_results *r, const sf_shown *shown, int64_t k) {
    const char *group = r->frames[0].group;
    int fields = 0;
    if (shown->head[k] != &r->peak)
        return SF_FIELD_ALL;
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        char path[80];
        snprintf(path, sizeof path, "%s/%s", group, sf_frame_field_get((sf_frame_field)f)->name);
        fields |= sf_h5_exists(r->file, path) << f;
    }
    return fields;
}

/* Every frame that can be read. */
static sf_status write_frames(const store *s, sf_results *r, sf_shown *shown, sf_error *err) {
    bool moved = true;
    for (int64_t k = 0; k < shown->count; k++) {
        const sf_frame_head *head = shown->head[k];
        sf_frame frame = {0};
        sf_error problem = SF_ERROR_INIT;
        if (sf_frame_read_fields(r, head, fields_wanted(r, shown, k), &frame, &problem) != SF_OK) {
            if (sf_results_ended_well(r))
                return SF_FAIL(err, problem.status, "%s", problem.text);
            sf_results_note(r, "frames from %.9g s on are left out: %.150s", head->time, problem.text);
            shown->count = k;
            break;
        }
        moved = moved && frame.field[SF_FRAME_DISPLACEMENT];
        shown->fields[k] = fields_of(&frame);
        note_largest(r, &frame, shown->largest);
        write_frame(s, head, &frame, k, err);
        sf_frame_free(&frame);
        if (err->status != SF_OK)
            return err->status;
    }
    if (!moved)
        sf_results_note(r, "the frames hold no displacement: ParaView shows the pad undeformed");
    return SF_OK;
}

sf_status sf_xdmf_write_data(const char *path, sf_results *r, const sf_xdmf_options *options, sf_shown *shown,
                             sf_error *err) {
    const sf_provenance provenance = {.program = "softfall-post", .command_line = options->command_line};
    sf_error ignored = SF_ERROR_INIT;
    store s = {.results = r, .full = options->full};
    if (sf_h5_create(path, &s.file, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(s.file, "softfall-paraview", &provenance, err) == SF_OK &&
        write_topology(&s, err) == SF_OK && write_materials(&s, err) == SF_OK)
        write_frames(&s, r, shown, err);
    sf_h5_close(&s.file, err->status == SF_OK ? err : &ignored);
    return err->status;
}
