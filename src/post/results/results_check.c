/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/results/results_check.h"

#include "model/model.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* s; a run ends at 1000 s at the latest (sf_model_check), and resampling to 100 kHz must fit into memory. */
static const double LONGEST_TIME = 1001;

bool sf_results_ended_well(const sf_results *r) {
    return strcmp(r->status, "finished") == 0 || strcmp(r->status, "rebound") == 0 ||
           strcmp(r->status, "interrupted") == 0;
}

void sf_results_note(sf_results *r, const char *format, ...) {
    if (r->note_count == SF_RESULTS_NOTES)
        return;
    va_list args;
    va_start(args, format);
    vsnprintf(r->notes[r->note_count++], sizeof r->notes[0], format, args);
    va_end(args);
}

void sf_results_note_ending(sf_results *r, const char *sentence) {
    int k = r->note_count;
    sf_results_note(r, "%s", sentence);
    if (r->note_count > k)
        r->note_of_ending[k] = true;
}

sf_status sf_results_check_finite(const double *values, int64_t count, const char *path, sf_error *err) {
    for (int64_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return SF_FAIL(err, SF_ERR_IO, "%s: value %lld is not finite", path, (long long)i);
    return SF_OK;
}

static int vertices_of(int type) {
    switch (type) {
    case SF_CELL_TETRAHEDRON:
        return 4;
    case SF_CELL_PYRAMID:
        return 5;
    case SF_CELL_PRISM:
        return 6;
    case SF_CELL_HEXAHEDRON:
        return 8;
    default:
        return 0;
    }
}

static sf_status check_indices(const int32_t *index, int64_t count, int64_t limit, const char *path,
                               sf_error *err) {
    for (int64_t i = 0; i < count; i++)
        if (index[i] < 0 || index[i] >= limit)
            return SF_FAIL(err, SF_ERR_IO, "%s: entry %lld is %d, it must be in 0 to %lld", path,
                           (long long)i, index[i], (long long)limit - 1);
    return SF_OK;
}

static sf_status check_cells(const sf_results *r, sf_error *err) {
    if (r->cell_ptr[0] != 0 || r->cell_ptr[r->cell_count] != r->cell_nnz)
        return SF_FAIL(
            err, SF_ERR_IO, "/model/cell_ptr runs from %lld to %lld, /model/cell_node has %lld entries",
            (long long)r->cell_ptr[0], (long long)r->cell_ptr[r->cell_count], (long long)r->cell_nnz);
    for (int64_t c = 0; c < r->cell_count; c++) {
        int vertices = vertices_of(r->cell_type[c]);
        if (vertices == 0)
            return SF_FAIL(err, SF_ERR_IO, "/model/cell_type: cell %lld has type %d, known are 6, 7, 8 and 9",
                           (long long)c, r->cell_type[c]);
        if (r->cell_ptr[c + 1] - r->cell_ptr[c] != vertices)
            return SF_FAIL(
                err, SF_ERR_IO, "/model/cell_ptr: cell %lld of type %d has %lld vertices, expected %d",
                (long long)c, r->cell_type[c], (long long)(r->cell_ptr[c + 1] - r->cell_ptr[c]), vertices);
    }
    return check_indices(r->cell_node, r->cell_nnz, r->node_count, "/model/cell_node", err);
}

static sf_status check_positive(double value, const char *path, sf_error *err) {
    if (!(value > 0) || !isfinite(value))
        return SF_FAIL(err, SF_ERR_IO, "%s is %g, it must be positive", path, value);
    return SF_OK;
}

sf_status sf_results_check_model(const sf_results *r, sf_error *err) {
    if (r->node_count < 1 || r->node_count > INT32_MAX || r->cell_nnz > INT32_MAX - r->cell_count)
        return SF_FAIL(err, SF_ERR_IO, "/model has %lld nodes and %lld cell vertices: 1 to 2^31 are possible",
                       (long long)r->node_count, (long long)r->cell_nnz);
    if (sf_results_check_finite(r->position, 3 * r->node_count, "/model/position", err) != SF_OK ||
        sf_results_check_finite(r->surface_position, 3 * r->surface_node_count, "/model/surface_position",
                                err) ||
        check_cells(r, err) != SF_OK ||
        check_indices(r->surface_triangle, 3 * r->surface_triangle_count, r->surface_node_count,
                      "/model/surface_triangle", err) != SF_OK)
        return err->status;
    if (r->surface_node_count < 1)
        return SF_FAIL(err, SF_ERR_IO, "/model/surface_position is empty: the missile has no surface");
    for (int64_t i = 0; i < r->node_count; i++)
        if (!(r->volume[i] > 0) || !isfinite(r->volume[i]))
            return SF_FAIL(err, SF_ERR_IO, "/model/volume: node %lld has %g m3, it must be positive",
                           (long long)i, r->volume[i]);
    if (r->symmetry_factor != 1 && r->symmetry_factor != 2 && r->symmetry_factor != 4)
        return SF_FAIL(err, SF_ERR_IO, "/model/symmetry_factor is %lld, it must be 1, 2 or 4",
                       (long long)r->symmetry_factor);
    int planes = isfinite(r->symmetry_place[0]) + isfinite(r->symmetry_place[1]);
    if (r->symmetry_factor < 1 << planes)
        return SF_FAIL(err, SF_ERR_IO,
                       "/model/symmetry_factor is %lld, /model/symmetry_x and symmetry_y tell %d plane%s",
                       (long long)r->symmetry_factor, planes, planes > 1 ? "s" : "");
    const double *d = r->missile_direction;
    if (!(fabs(sf_results_along(r, d) - 1) < 1e-6))
        return SF_FAIL(err, SF_ERR_IO, "/model/missile_direction (%g, %g, %g) is not a unit vector", d[0],
                       d[1], d[2]);
    if (sf_results_check_finite(r->missile_centre, 3, "/model/missile_centre", err) != SF_OK)
        return err->status;
    if (r->turns && (r->driven || r->symmetry_factor != 1))
        return SF_FAIL(err, SF_ERR_IO, "/model/missile_free is 1 of a driven missile or of a part of one");
    if (check_positive(r->thickness, "/model/thickness", err) != SF_OK ||
        check_positive(r->density, "/model/density", err) != SF_OK)
        return err->status;
    if (!(fabs(r->gravity_along - sf_results_along(r, r->gravity)) <= 1e-9 * (1 + fabs(r->gravity_along))))
        return SF_FAIL(err, SF_ERR_IO, "/model/gravity_along is %g m/s2, and /model/gravity (%g, %g, %g)",
                       r->gravity_along, r->gravity[0], r->gravity[1], r->gravity[2]);
    if (r->driven)
        return SF_OK;
    if (check_positive(r->missile_mass, "/model/missile_mass", err) != SF_OK ||
        check_positive(r->missile_speed, "/model/missile_speed", err) != SF_OK)
        return err->status;
    return SF_OK;
}

static sf_status check_lengths(sf_results *r, const int64_t *rows, sf_error *err) {
    r->history.rows = rows[0];
    for (int c = 1; c < SF_HISTORY_COUNT; c++) {
        if (rows[c] != rows[0] && sf_results_ended_well(r))
            return SF_FAIL(err, SF_ERR_IO,
                           "/history/%s has %lld rows, /history/time has %lld: the file is damaged",
                           sf_history_column_get(c)->name, (long long)rows[c], (long long)rows[0]);
        if (rows[c] < r->history.rows)
            r->history.rows = rows[c];
    }
    for (int c = 0; c < SF_HISTORY_COUNT; c++) {
        if (rows[c] != r->history.rows) {
            sf_results_note(r, "the columns of /history differ in length: the first %lld rows are used",
                            (long long)r->history.rows);
            break;
        }
    }
    return SF_OK;
}

static sf_status check_row(const sf_results *r, int64_t i, sf_error *err) {
    for (int c = 0; c < SF_HISTORY_COUNT; c++)
        if (!isfinite(r->history.column[c][i]))
            return SF_FAIL(err, SF_ERR_IO, "/history/%s: row %lld is not finite",
                           sf_history_column_get(c)->name, (long long)i);
    const double *time = r->history.time;
    if (!(time[i] >= 0 && time[i] <= LONGEST_TIME))
        return SF_FAIL(err, SF_ERR_IO, "/history/time: %.9g s in row %lld, it must be in 0 to %g s", time[i],
                       (long long)i, LONGEST_TIME);
    if (i > 0 && !(time[i] > time[i - 1]))
        return SF_FAIL(err, SF_ERR_IO, "/history/time: %.9g s in row %lld does not follow %.9g s", time[i],
                       (long long)i, time[i - 1]);
    return SF_OK;
}

sf_status sf_results_check_history(sf_results *r, const int64_t *rows, sf_error *err) {
    if (check_lengths(r, rows, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < r->history.rows; i++) {
        sf_error problem = SF_ERROR_INIT;
        if (check_row(r, i, &problem) == SF_OK)
            continue;
        if (sf_results_ended_well(r))
            return SF_FAIL(err, problem.status, "%s", problem.text);
        sf_results_note(r, "%.180s: the rows before it are used", problem.text);
        r->history.rows = i;
    }
    if (r->history.rows < 3 && r->has_summary && !sf_results_ended_well(r))
        return SF_FAIL(err, SF_ERR_IO, "%s (/history has %lld usable rows, figures need at least 3)",
                       r->status, (long long)r->history.rows);
    if (r->history.rows < 3)
        return SF_FAIL(err, SF_ERR_IO, "/history has %lld usable rows, at least 3 are needed",
                       (long long)r->history.rows);
    return SF_OK;
}
