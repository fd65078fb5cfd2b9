/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post_fixture.h"

#include "base/units.h"
#include "io/h5_data.h"
#include "io/provenance.h"
#include "io/replace.h"
#include "model/columns.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct cloud {
    double position[FIXTURE_NODES][3];
    uint8_t type[FIXTURE_CELLS];
    int64_t ptr[FIXTURE_CELLS + 1];
    int32_t node[8 * 8 + 5 + 4];
} cloud;

static int32_t lattice(int i, int j, int k) {
    return (int32_t)(i + 3 * j + 9 * k);
}

static void cloud_build(cloud *c, bool bad_cell) {
    int64_t cell = 0, at = 0;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 3; i++) {
                double *x = c->position[lattice(i, j, k)];
                x[0] = 0.1 * (i - 1);
                x[1] = 0.1 * (j - 1);
                x[2] = 0.025 * (k - 2);
            }
    const double apex[2][3] = {{0.15, 0.05, -0.0125}, {0.15, 0.05, 0}};
    memcpy(c->position[27], apex, sizeof apex);
    for (int k = 0; k < 2; k++)
        for (int j = 0; j < 2; j++)
            for (int i = 0; i < 2; i++) {
                const int32_t hexahedron[8] = {
                    lattice(i, j, k),
                    lattice(i + 1, j, k),
                    lattice(i + 1, j + 1, k),
                    lattice(i, j + 1, k),
                    lattice(i, j, k + 1),
                    lattice(i + 1, j, k + 1),
                    lattice(i + 1, j + 1, k + 1),
                    lattice(i, j + 1, k + 1),
                };
                c->type[cell++] = 9;
                memcpy(&c->node[at], hexahedron, sizeof hexahedron);
                at += 8;
                c->ptr[cell] = at;
            }
    const int32_t rest[9] = {lattice(2, 1, 1),
                             lattice(2, 1, 2),
                             lattice(2, 2, 2),
                             lattice(2, 2, 1),
                             27, /* pyramid */
                             lattice(2, 1, 2),
                             lattice(2, 2, 2),
                             27,
                             bad_cell ? FIXTURE_NODES : 28};
    memcpy(&c->node[at], rest, sizeof rest);
    c->type[cell++] = 7;
    c->ptr[cell] = at + 5;
    c->type[cell++] = 6;
    c->ptr[cell] = at + 9;
}

static sf_status put(sf_h5 *file, const char *path, sf_h5_type type, int64_t rows, int64_t columns,
                     const void *data, sf_error *err) {
    int64_t dims[2] = {rows, columns};
    sf_h5_info info = {path, "1", "fixture"};
    return sf_h5_write(file, &info, type, columns > 1 ? 2 : 1, dims, data, err);
}

static sf_status put_scalar(sf_h5 *file, const char *path, double value, sf_error *err) {
    sf_h5_info info = {path, "1", "fixture"};
    return sf_h5_write_scalar(file, &info, value, err);
}

static sf_status put_integer(sf_h5 *file, const char *path, int64_t value, sf_error *err) {
    sf_h5_info info = {path, "1", "fixture"};
    return sf_h5_write(file, &info, SF_H5_I64, 0, NULL, &value, err);
}

static sf_status put_model(sf_h5 *file, const cloud *c, const fixture_options *o, sf_error *err) {
    static const double surface[5][3] = {
        {0, 0, 0}, {0.08, 0.08, 0.08}, {-0.08, 0.08, 0.08}, {-0.08, -0.08, 0.08}, {0.08, -0.08, 0.08}};
    static const int32_t triangle[FIXTURE_TRIANGLES][3] = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}};
    static const double direction[3] = {0, 0, -1};
    double volume[FIXTURE_NODES];
    for (int i = 0; i < FIXTURE_NODES; i++)
        volume[i] = 0.2 * 0.2 * FIXTURE_THICKNESS / FIXTURE_NODES;
    put(file, "/model/position", SF_H5_F64, FIXTURE_NODES, 3, c->position, err);
    put(file, "/model/volume", SF_H5_F64, FIXTURE_NODES, 1, volume, err);
    put(file, "/model/cell_type", SF_H5_U8, FIXTURE_CELLS, 1, c->type, err);
    put(file, "/model/cell_ptr", SF_H5_I64, FIXTURE_CELLS + 1, 1, c->ptr, err);
    put(file, "/model/cell_node", SF_H5_I32, c->ptr[FIXTURE_CELLS], 1, c->node, err);
    put(file, "/model/surface_position", SF_H5_F64, 5, 3, surface, err);
    put(file, "/model/surface_triangle", SF_H5_I32, FIXTURE_TRIANGLES, 3, triangle, err);
    put_integer(file, "/model/symmetry_factor", o->part > 0 ? o->part : 1, err);
    put_scalar(file, "/model/thickness", FIXTURE_THICKNESS, err);
    put_scalar(file, "/model/density", 35, err);
    put_scalar(file, "/model/missile_mass", FIXTURE_MASS, err);
    put_scalar(file, "/model/missile_speed", FIXTURE_SPEED, err);
    put_scalar(file, "/model/expected_mesh_error", 0, err);
    put_scalar(file, "/model/gravity_along", SF_STANDARD_GRAVITY, err);
    put_integer(file, "/model/kinematic", o->kinematic, err);
    const double centre[3] = {0, 0, 0}, sphere[3] = {0, 0, o->sphere_radius};
    if (o->sphere_radius > 0) {
        put_scalar(file, "/model/sphere_radius", o->sphere_radius, err);
        put(file, "/model/sphere_centre", SF_H5_F64, 3, 1, sphere, err);
    }
    put_integer(file, "/model/missile_driven", 0, err);
    put_integer(file, "/model/missile_free", 0, err);
    put(file, "/model/missile_centre", SF_H5_F64, 3, 1, centre, err);
    return put(file, "/model/missile_direction", SF_H5_F64, 3, 1, direction, err);
}

/* Writes row i of all columns but the time, which is there; values that are not set here are zero. */
static void fill_row(sf_history *h, int64_t i, bool untouched) {
    double time = h->time[i], peak = untouched ? 0 : FIXTURE_PEAK_G * SF_STANDARD_GRAVITY;
    double x = M_PI * fmin(time / FIXTURE_DURATION, 1), scale = FIXTURE_DURATION / M_PI;
    double contact = !untouched && time > 0 && time < FIXTURE_DURATION ? 1 : 0;
    h->acceleration[i] = contact * peak * sin(x);
    h->velocity[i] = FIXTURE_SPEED - peak * scale * (1 - cos(x));
    h->indentation[i] = untouched ? -0.01 : 0.03 * sin(x);
    h->energy_stored[i] = contact * 80 * sin(x);
    h->energy_viscous[i] = contact * 16 * sin(x);
    h->energy_stabilisation[i] = contact * 0.8 * sin(x);
    h->energy_contact[i] = contact * 0.5 * sin(x);
    h->energy_error[i] = -0.002 * sin(x);
    h->largest_compression[i] = untouched ? 0 : 0.7 * sin(x);
    h->smallest_jacobian[i] = 1 - 0.5 * sin(x);
    h->contact_nodes[i] = contact * 9;
    h->contact_area[i] = contact * FIXTURE_CONTACT_AREA * sin(x);
}

static sf_status put_history(sf_h5 *file, const fixture_options *o, sf_error *err) {
    double end = o->end_time > 0 ? o->end_time : FIXTURE_DURATION + 2e-3;
    int64_t rows = (int64_t)(end / 1e-5);
    sf_history h = {0};
    for (int c = 0; c < SF_HISTORY_COUNT; c++)
        h.column[c] = sf_alloc(err, (unsigned long)rows, sizeof *h.column[c], "a column");
    for (int64_t i = 0; i < rows && err->status == SF_OK; i++) { /* steps that grow and shrink by a fifth */
        h.time[i] =
            end * (double)i / (double)(rows - 1) + (i > 0 && i < rows - 1 ? 1e-6 * sin((double)i) : 0);
        fill_row(&h, i, o->untouched);
    }
    if (err->status == SF_OK && o->nan_row > 0)
        h.acceleration[o->nan_row] = NAN;
    for (int c = 0; c < SF_HISTORY_COUNT && err->status == SF_OK; c++) {
        char path[64];
        int64_t lost = h.column[c] == h.velocity ? o->lost_rows : 0;
        snprintf(path, sizeof path, "/history/%s", sf_history_column_get(c)->name);
        put(file, path, SF_H5_F64, rows - lost, 1, h.column[c], err);
    }
    sf_history_free(&h);
    return err->status;
}

static sf_status put_frame(sf_h5 *file, const cloud *c, const char *group, int k, const fixture_options *o,
                           sf_error *err) {
    double field[FIXTURE_NODES * 9];
    const double lowered[3] = {0, 0, -0.005 * k};
    bool last = k == FIXTURE_FRAMES - 1;
    char path[80];
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        if (f == SF_FRAME_VON_MISES && o->no_stress)
            continue;
        for (int i = 0; i < FIXTURE_NODES; i++)
            for (int j = 0; j < info->components; j++)
                field[i * info->components + j] = 1000 * k + 10 * i + j;
        for (int i = 0; i < FIXTURE_NODES && f == SF_FRAME_LARGEST_COMPRESSION; i++)
            field[i] = 0.7 - 1e-3 * i;
        for (int i = 0; i < FIXTURE_NODES && f == SF_FRAME_DISPLACEMENT; i++) {
            field[3 * i] = field[3 * i + 1] = 0;
            field[3 * i + 2] = lowered[2] * (c->position[i][2] + FIXTURE_THICKNESS) / FIXTURE_THICKNESS;
        }
        if (f == SF_FRAME_VON_MISES && last && o->bad_frame)
            field[7] = NAN;
        snprintf(path, sizeof path, "%s/%s", group, info->name);
        put(file, path, SF_H5_F64, FIXTURE_NODES, info->components, field, err);
    }
    snprintf(path, sizeof path, "%s/time", group);
    if (!(last && o->headless_frame))
        put_scalar(file, path,
                   strcmp(group, "/peak") == 0 && o->peak_time > 0 ? o->peak_time : k * FIXTURE_DURATION / 4,
                   err);
    snprintf(path, sizeof path, "%s/acceleration", group);
    put_scalar(file, path, FIXTURE_PEAK_G * SF_STANDARD_GRAVITY * sin(M_PI * k / 4), err);
    const double upright[4] = {1, 0, 0, 0};
    snprintf(path, sizeof path, "%s/missile_quaternion", group);
    put(file, path, SF_H5_F64, 4, 1, upright, err);
    snprintf(path, sizeof path, "%s/missile_displacement", group);
    return put(file, path, SF_H5_F64, 3, 1, lowered, err);
}

static sf_status put_summary(sf_h5 *file, const fixture_options *o, sf_error *err) {
    sf_h5_info status = {"/summary/status", "1", "how the run ended"};
    sf_h5_info notes = {"/summary/notes", "1", "notes of the solver"};
    sf_h5_write_text(file, &status, o->status ? o->status : "rebound", err);
    if (o->notes)
        sf_h5_write_text(file, &notes, o->notes, err);
    put_integer(file, "/summary/steps", 4199, err);
    put_integer(file, "/summary/threads", 2, err);
    put_integer(file, "/summary/nodes", FIXTURE_NODES, err);
    put_integer(file, "/summary/interactions", 500, err);
    put_scalar(file, "/summary/wall_time", 12.5, err);
    return put_scalar(file, "/summary/contact_time", o->untouched ? NAN : 0, err);
}

sf_status fixture_write(const char *path, const fixture_options *o, sf_error *err) {
    sf_h5 *file = NULL;
    cloud c = {0};
    cloud_build(&c, o->bad_cell);
    remove(path);
    if (sf_h5_create(path, &file, err) != SF_OK)
        return err->status;
    sf_h5_set_attribute(file, "format", o->format ? o->format : "softfall-results", err);
    sf_h5_set_attribute_i64(file, "format_version", SF_FORMAT_VERSION, err);
    put_model(file, &c, o, err);
    if (o->informed_strain > 0)
        put_scalar(file, "/model/informed_strain", o->informed_strain, err);
    if (o->anvil_depth > 0)
        put_scalar(file, "/model/anvil_depth", o->anvil_depth, err);
    put_history(file, o, err);
    for (int k = 0; k < FIXTURE_FRAMES; k++) {
        char group[32];
        snprintf(group, sizeof group, "/frames/%06d", k);
        put_frame(file, &c, group, k, o, err);
    }
    if (!o->no_peak)
        put_frame(file, &c, "/peak", 2, o, err);
    if (!o->no_summary)
        put_summary(file, o, err);
    return sf_h5_close(&file, err) == SF_OK && err->status == SF_OK ? sf_seal_add(path, err) : err->status;
}
