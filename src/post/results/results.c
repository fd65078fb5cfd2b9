/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/results/results.h"

#include "base/text.h"
#include "io/h5_data.h"
#include "io/replace.h"
#include "model/cells.h"
#include "model/model.h"

/* ---- checks ---- */

/* s; a run ends at 1000 s at the latest (sf_model_check), and resampling to 100 kHz must fit into memory. */
static const double LONGEST_TIME = 1001;

bool sf_results_ended_well(const sf_results *r) {
    return sf_word_find("finished|rebound|interrupted", r->status) >= 0;
}

void sf_results_note(sf_results *r, const char *format, ...) {
    if (r->note_count == SF_RESULTS_NOTES)
        return;
    SF_PRINT_INTO(r->notes[r->note_count++], format);
}

/* The same of a sentence that only says how the run ended. */
static void note_ending(sf_results *r, const char *sentence) {
    int k = r->note_count;
    sf_results_note(r, "%s", sentence);
    if (r->note_count > k)
        r->note_of_ending[k] = true;
}

void sf_results_note_run(sf_results *r, const char *sentence) {
    if (strcmp(sentence, "the missile never touched the pad") == 0) /* solver/run/run.c */
        note_ending(r, sentence);
    else
        sf_results_note(r, "%s", sentence);
}

/* Refuses with SF_ERR_IO and a sentence naming the dataset, the value and the bound. */
static sf_status check_finite(const double *values, int64_t count, const char *path, sf_error *err) {
    for (int64_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return SF_FAIL(err, SF_ERR_IO, "%s: value %lld is not finite", path, (long long)i);
    return SF_OK;
}

static sf_status check_indices(const int32_t *index, int64_t count, int64_t limit, const char *path,
                               sf_error *err) {
    for (int64_t i = 0; i < count; i++)
        if (index[i] < 0 || index[i] >= limit)
            return SF_FAIL(err, SF_ERR_IO, "%s: entry %lld" SF_OUTSIDE("%d", "0", "%lld"), path, (long long)i,
                           index[i], (long long)limit - 1);
    return SF_OK;
}

static sf_status check_cells(const sf_results *r, sf_error *err) {
    if (r->cell_ptr[0] != 0 || r->cell_ptr[r->cell_count] != r->cell_nnz)
        return SF_FAIL(
            err, SF_ERR_IO, "/model/cell_ptr runs from %lld to %lld, /model/cell_node has %lld entries",
            (long long)r->cell_ptr[0], (long long)r->cell_ptr[r->cell_count], (long long)r->cell_nnz);
    for (int64_t c = 0; c < r->cell_count; c++) {
        const sf_cell_shape *shape = sf_cell_shape_of(r->cell_type[c]);
        if (!shape || sf_cell_is_plane(shape) != r->axisymmetric)
            return SF_FAIL(err, SF_ERR_IO, "/model/cell_type: cell %lld has type %d, known are %s",
                           (long long)c, r->cell_type[c],
                           r->axisymmetric ? "4 and 5 of an axisymmetric model" : "6, 7, 8 and 9");
        if (r->cell_ptr[c + 1] - r->cell_ptr[c] != shape->vertices)
            return SF_FAIL(err, SF_ERR_IO,
                           "/model/cell_ptr: cell %lld of type %d has %lld vertices, expected %d",
                           (long long)c, r->cell_type[c], (long long)(r->cell_ptr[c + 1] - r->cell_ptr[c]),
                           shape->vertices);
    }
    return check_indices(r->cell_node, r->cell_nnz, r->node_count, "/model/cell_node", err);
}

static sf_status check_positive(double value, const char *path, sf_error *err) {
    if (!(value > 0) || !isfinite(value))
        return SF_FAIL(err, SF_ERR_IO, "%s: %g" SF_NOT_ABOVE_0, path, value);
    return SF_OK;
}

/* Cells, indices, positions, and the missile. */
static sf_status check_model(const sf_results *r, sf_error *err) {
    if (r->node_count < 1 || r->node_count > INT32_MAX || r->cell_nnz > INT32_MAX - r->cell_count)
        return SF_FAIL(err, SF_ERR_IO, "/model has %lld nodes and %lld cell vertices: 1 to 2^31 are possible",
                       (long long)r->node_count, (long long)r->cell_nnz);
    SF_TRY(check_finite(r->position, 3 * r->node_count, "/model/position", err));
    SF_TRY(check_finite(r->surface_position, 3 * r->surface_node_count, "/model/surface_position", err));
    SF_TRY(check_cells(r, err));
    SF_TRY(check_indices(r->surface_triangle, 3 * r->surface_triangle_count, r->surface_node_count,
                         "/model/surface_triangle", err));
    SF_TRY(check_finite(r->support_position, 3 * r->support_node_count, "/model/support_position", err));
    SF_TRY(check_indices(r->support_triangle, 3 * r->support_triangle_count, r->support_node_count,
                         "/model/support_triangle", err));
    if (r->surface_node_count < 1)
        return SF_FAIL(err, SF_ERR_IO, "/model/surface_position is empty: the missile has no surface");
    for (int64_t i = 0; i < r->node_count; i++)
        if (!(r->volume[i] > 0) || !isfinite(r->volume[i]))
            return SF_FAIL(err, SF_ERR_IO, "/model/volume: node %lld: %g m3" SF_NOT_ABOVE_0, (long long)i,
                           r->volume[i]);
    if (r->symmetry_factor != 1 && r->symmetry_factor != 2 && r->symmetry_factor != 4)
        return SF_FAIL(err, SF_ERR_IO, "/model/symmetry_factor is %lld, it must be 1, 2 or 4",
                       (long long)r->symmetry_factor);
    for (int64_t i = 0; r->axisymmetric && i < r->node_count; i++)
        if (!(r->position[3 * i] >= 0 && r->position[3 * i + 1] == 0))
            return SF_FAIL(
                err, SF_ERR_IO,
                "/model/position: node %lld of an axisymmetric model is at x = %g, y = %g m: x must "
                "be 0 or more, y 0",
                (long long)i, r->position[3 * i], r->position[3 * i + 1]);
    if (r->axisymmetric && r->symmetry_factor != 1)
        return SF_FAIL(err, SF_ERR_IO, "/model/symmetry_factor of an axisymmetric model is %lld, not 1",
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
    SF_TRY(check_finite(r->missile_centre, 3, "/model/missile_centre", err));
    if (r->turns && (r->driven || r->symmetry_factor != 1))
        return SF_FAIL(err, SF_ERR_IO, "/model/missile_free is 1 of a driven missile or of a part of one");
    SF_TRY(check_positive(r->thickness, "/model/thickness", err));
    SF_TRY(check_positive(r->density, "/model/density", err));
    if (!(fabs(r->gravity_along - sf_results_along(r, r->gravity)) <= 1e-9 * (1 + fabs(r->gravity_along))))
        return SF_FAIL(err, SF_ERR_IO, "/model/gravity_along is %g m/s2, and /model/gravity (%g, %g, %g)",
                       r->gravity_along, r->gravity[0], r->gravity[1], r->gravity[2]);
    if (r->driven)
        return SF_OK;
    SF_TRY(check_positive(r->missile_mass, "/model/missile_mass", err));
    SF_TRY(check_positive(r->missile_speed, "/model/missile_speed", err));
    return SF_OK;
}

static sf_status check_lengths(sf_results *r, const int64_t *rows, sf_error *err) {
    bool differ = false;
    r->history.rows = rows[0];
    for (int c = 1; c < SF_HISTORY_COUNT; c++) {
        differ = differ || rows[c] != rows[0];
        if (rows[c] != rows[0] && sf_results_ended_well(r))
            return SF_FAIL(err, SF_ERR_IO,
                           "/history/%s has %lld rows, /history/time has %lld: the file is damaged",
                           sf_history_column_get(c)->name, (long long)rows[c], (long long)rows[0]);
        if (rows[c] < r->history.rows)
            r->history.rows = rows[c];
    }
    if (differ)
        sf_results_note(r, "the columns of /history differ in length: the first %lld rows are used",
                        (long long)r->history.rows);
    return SF_OK;
}

static sf_status check_row(const sf_results *r, int64_t i, sf_error *err) {
    for (int c = 0; c < SF_HISTORY_COUNT; c++)
        if (!isfinite(r->history.column[c][i]))
            return SF_FAIL(err, SF_ERR_IO, "/history/%s: row %lld is not finite",
                           sf_history_column_get(c)->name, (long long)i);
    const double *time = r->history.time;
    if (!(time[i] >= 0 && time[i] <= LONGEST_TIME))
        return SF_FAIL(err, SF_ERR_IO, "/history/time: row %lld" SF_OUTSIDE("%.9g s", "0", "%g s"),
                       (long long)i, time[i], LONGEST_TIME);
    if (i > 0 && !(time[i] > time[i - 1]))
        return SF_FAIL(err, SF_ERR_IO, "/history/time: %.9g s in row %lld does not follow %.9g s", time[i],
                       (long long)i, time[i - 1]);
    return SF_OK;
}

/* Sets history.rows from the lengths of the columns, `rows` [SF_HISTORY_COUNT]: equal lengths, finite values,
 * times ascending; of a run that did not end well the longest part of which that holds. */
static sf_status check_history(sf_results *r, const int64_t *rows, sf_error *err) {
    SF_TRY(check_lengths(r, rows, err));
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
        return SF_FAIL(err, SF_ERR_IO, "%s (/history has %lld usable rows" SF_AT_LEAST("3") ")", r->status,
                       (long long)r->history.rows);
    if (r->history.rows < 3)
        return SF_FAIL(err, SF_ERR_IO, "/history has %lld usable rows" SF_AT_LEAST("3"),
                       (long long)r->history.rows);
    return SF_OK;
}

/* ---- reading ---- */

void sf_results_place(const sf_results *r, const sf_frame_head *head, const double x[3], double out[3]) {
    double arm[3];
    sf_sub3(x, r->missile_centre, arm);
    sf_rotate(head->missile_quaternion, arm, out);
    for (int k = 0; k < 3; k++)
        out[k] = (r->turns ? out[k] + r->missile_centre[k] : x[k]) + head->missile_displacement[k];
}

double sf_results_whole(const sf_results *r) {
    return (double)r->symmetry_factor;
}

double sf_results_cross_section(const sf_results *r) {
    double volume = 0, low[3], high[3];
    for (int64_t i = 0; i < r->node_count; i++)
        volume += r->volume[i];
    sf_box3(r->node_count, r->position, low, high);
    return sf_results_whole(r) * volume / (high[2] - low[2]);
}

static sf_status read_array(const sf_results *r, const char *path, sf_h5_type type, int64_t *rows,
                            int64_t columns, void *array, sf_error *err) {
    int64_t dims[2] = {*rows, columns};
    void *data = NULL;
    SF_TRY(sf_h5_read(r->file, path, type, columns > 1 ? 2 : 1, dims, &data, err));
    *rows = dims[0];
    *(void **)array = data;
    return SF_OK;
}

static sf_status read_numbers(const sf_results *r, const char *path, int64_t count, double *numbers,
                              sf_error *err) {
    SF_OWNED double *data = NULL;
    SF_TRY(read_array(r, path, SF_H5_F64, &count, 1, &data, err));
    memcpy(numbers, data, (size_t)count * sizeof *numbers);
    return SF_OK;
}

static sf_status read_flag(const sf_results *r, const char *path, bool *flag, sf_error *err) {
    int64_t value = 0;
    sf_h5_read_one(r->file, path, SF_H5_I64, &value, err);
    *flag = value != 0;
    return err->status;
}

/* A scalar that a file of an earlier version does not hold; NaN: likewise, or not finite. */
static sf_status read_optional(const sf_results *r, const char *path, double *value, sf_error *err) {
    *value = NAN;
    if (sf_h5_exists(r->file, path))
        sf_h5_read_scalar(r->file, path, value, err);
    if (!isfinite(*value))
        *value = NAN;
    return err->status;
}

/* It is of a new pad: a later drop has none. */
static sf_status read_section(sf_results *r, sf_error *err) {
    int64_t drop = 1;
    if (sf_h5_exists(r->file, "/summary/drop"))
        SF_TRY(sf_h5_read_one(r->file, "/summary/drop", SF_H5_I64, &drop, err));
#define READ(member, ...) SF_TRY(read_optional(r, "/model/section/" #member, &r->section.member, err));
    SF_SECTION_DROP(READ)
#undef READ
    if (drop > 1)
        r->section.a_max_g = NAN;
    return SF_OK;
}

/* Files of earlier versions have it along -z only. */
static sf_status read_gravity(sf_results *r, sf_error *err) {
    SF_TRY(sf_h5_read_scalar(r->file, "/model/gravity_along", &r->gravity_along, err));
    if (sf_h5_exists(r->file, "/model/gravity"))
        return read_numbers(r, "/model/gravity", 3, r->gravity, err);
    r->gravity[2] = r->gravity_along / r->missile_direction[2];
    return SF_OK;
}

/* The exact sphere that contact takes for the missile, if it does. */
static sf_status read_sphere(sf_results *r, sf_error *err) {
    SF_TRY(read_optional(r, "/model/sphere_radius", &r->sphere_radius, err));
    if (!(r->sphere_radius > 0))
        r->sphere_radius = NAN;
    else if (read_numbers(r, "/model/sphere_centre", 3, r->sphere_centre, err) == SF_OK)
        check_finite(r->sphere_centre, 3, "/model/sphere_centre", err);
    return err->status;
}

/* The names of the layers, a line each. */
static sf_status read_layer_names(sf_results *r, sf_error *err) {
    char *rest = NULL;
    int count = 0;
    r->layer_name = sf_alloc(err, r->layer_count, sizeof *r->layer_name, "names of layers");
    if (!r->layer_name || sf_h5_read_text(r->file, "/model/layer_names", &r->layer_names, err) != SF_OK)
        return err->status;
    for (char *line = strtok_r(r->layer_names, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        sf_error_clean(line);
        if (count < r->layer_count)
            r->layer_name[count] = line;
        count++;
    }
    if (count != r->layer_count)
        return SF_FAIL(err, SF_ERR_IO, "/model/layer_names: %d names for %d layers", count, r->layer_count);
    return SF_OK;
}

/* The layers of a pad of several materials. */
static sf_status read_layers(sf_results *r, sf_error *err) {
    int64_t count = -1, nodes = r->node_count;
    if (!sf_h5_exists(r->file, "/model/node_layer"))
        return SF_OK;
    SF_TRY(read_array(r, "/model/node_layer", SF_H5_U8, &nodes, 1, &r->node_layer, err));
    SF_TRY(read_array(r, "/model/layer_density", SF_H5_F64, &count, 1, &r->layer_density, err));
    if (count < 1 || count > SF_MATERIAL_MAX)
        return SF_FAIL(err, SF_ERR_IO,
                       "/model/layer_density: the number of layers" SF_OUTSIDE("%lld", "1", "%d"),
                       (long long)count, SF_MATERIAL_MAX);
    r->layer_count = (int)count;
    SF_TRY(read_array(r, "/model/layer_informed_strain", SF_H5_F64, &count, 1, &r->layer_informed, err));
    for (int64_t i = 0; i < r->node_count; i++)
        if (r->node_layer[i] >= count)
            return SF_FAIL(err, SF_ERR_IO,
                           "/model/node_layer: the layer of node %lld" SF_OUTSIDE("%d", "0", "%lld"),
                           (long long)i, r->node_layer[i], (long long)count - 1);
    for (int64_t k = 0; k < count; k++)
        if (!(r->layer_density[k] > 0) || isnan(r->layer_informed[k]))
            return SF_FAIL(err, SF_ERR_IO, "/model/layer_density, /model/layer_informed_strain: %g, %g",
                           r->layer_density[k], r->layer_informed[k]);
    return read_layer_names(r, err);
}

/* Reads the sums by layer of the frame; none if the frame has none. */
static sf_status read_layer_sums(sf_results *r, const sf_frame_head *head, sf_error *err) {
    static const char *const names[SF_LAYER_SUMS] = {"layer_stored", "layer_hysteresis", "layer_viscous",
                                                     "layer_compression"};
    for (int k = 0; k < SF_LAYER_SUMS; k++) {
        int64_t count = r->layer_count;
        SF_PRINTED(path, 80, "%s/%s", head->group, names[k]);
        SF_TRY(read_array(r, path, SF_H5_F64, &count, 1, &r->layer_sum[k], err));
        SF_TRY(check_finite(r->layer_sum[k], count, path, err));
    }
    return SF_OK;
}

sf_status sf_results_revolve(sf_results *r, sf_error *err) {
    sf_revolution *v = &r->revolution;
    sf_cell_lists cells = {r->cell_count, r->cell_nnz, r->cell_type, r->cell_ptr, r->cell_node};
    SF_TRY(sf_revolution_build(r->node_count, r->position, v, err));
    SF_OWNED double *volume = sf_alloc(err, v->nodes, sizeof *volume, "volumes");
    SF_OWNED uint8_t *layer = r->node_layer ? sf_alloc(err, v->nodes, 1, "layers") : NULL;
    SF_TRY(err->status);
    for (int64_t i = 0; i < v->nodes; i++) {
        volume[i] = sf_revolution_share(v, i) * r->volume[v->node[i]];
        if (layer)
            layer[i] = r->node_layer[v->node[i]];
    }
    SF_FREE(r->volume, r->node_layer);
    r->volume = volume;
    r->node_layer = layer;
    volume = NULL;
    layer = NULL;
    r->node_count = v->nodes;
    r->symmetry_factor = 4;
    r->symmetry_place[0] = r->symmetry_place[1] = 0;
    SF_TRY(sf_revolution_field(v, 3, true, &r->position, err));
    SF_TRY(sf_revolution_cells(v, &cells, err));
    r->cell_count = cells.count;
    r->cell_nnz = cells.entries;
    r->cell_type = cells.type;
    r->cell_ptr = cells.ptr;
    r->cell_node = cells.node;
    return SF_OK;
}

static sf_status read_model(sf_results *r, sf_error *err) {
    int64_t pointers = -1;
    r->node_count = r->cell_count = r->cell_nnz = r->surface_node_count = r->surface_triangle_count = -1;
    SF_TRY(read_array(r, "/model/position", SF_H5_F64, &r->node_count, 3, &r->position, err));
    SF_TRY(read_array(r, "/model/volume", SF_H5_F64, &r->node_count, 1, &r->volume, err));
    SF_TRY(read_array(r, "/model/cell_type", SF_H5_U8, &r->cell_count, 1, &r->cell_type, err));
    pointers = r->cell_count + 1;
    SF_TRY(read_array(r, "/model/cell_ptr", SF_H5_I64, &pointers, 1, &r->cell_ptr, err));
    SF_TRY(read_array(r, "/model/cell_node", SF_H5_I32, &r->cell_nnz, 1, &r->cell_node, err));
    SF_TRY(read_array(r, "/model/surface_position", SF_H5_F64, &r->surface_node_count, 3,
                      &r->surface_position, err));
    SF_TRY(read_array(r, "/model/surface_triangle", SF_H5_I32, &r->surface_triangle_count, 3,
                      &r->surface_triangle, err));
    if (sf_h5_exists(r->file, "/model/support_position")) {
        r->support_node_count = r->support_triangle_count = -1;
        SF_TRY(read_array(r, "/model/support_position", SF_H5_F64, &r->support_node_count, 3,
                          &r->support_position, err));
        SF_TRY(read_array(r, "/model/support_triangle", SF_H5_I32, &r->support_triangle_count, 3,
                          &r->support_triangle, err));
    }
    SF_TRY(sf_h5_read_one(r->file, "/model/symmetry_factor", SF_H5_I64, &r->symmetry_factor, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/model/thickness", &r->thickness, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/model/density", &r->density, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/model/missile_mass", &r->missile_mass, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/model/missile_speed", &r->missile_speed, err));
    SF_TRY(read_numbers(r, "/model/missile_direction", 3, r->missile_direction, err));
    SF_TRY(read_gravity(r, err));
    SF_TRY(read_flag(r, "/model/kinematic", &r->kinematic, err));
    SF_TRY(read_flag(r, "/model/missile_driven", &r->driven, err));
    SF_TRY(read_flag(r, "/model/missile_free", &r->turns, err));
    SF_TRY(read_numbers(r, "/model/missile_centre", 3, r->missile_centre, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/model/expected_mesh_error", &r->expected_mesh_error, err));
    if (!(r->expected_mesh_error > 0))
        r->expected_mesh_error = NAN; /* the law of the mesh error does not apply */
    SF_TRY(read_section(r, err));
    SF_TRY(read_optional(r, "/model/informed_strain", &r->informed_strain, err));
    SF_TRY(read_optional(r, "/model/impact_x", &r->impact_x, err));
    SF_TRY(read_optional(r, "/model/impact_y", &r->impact_y, err));
    SF_TRY(read_optional(r, "/model/anvil_depth", &r->anvil_depth, err));
    SF_TRY(read_optional(r, "/model/air", &r->air, err));
    SF_TRY(read_optional(r, "/model/speed_scatter", &r->speed_scatter, err));
    SF_TRY(read_optional(r, "/model/thickness_tolerance", &r->thickness_tolerance, err));
    SF_TRY(read_optional(r, "/model/lock_up", &r->lock_up, err));
    SF_TRY(read_optional(r, "/model/lock_begin", &r->lock_begin, err));
    SF_TRY(read_optional(r, "/model/slit_fraction", &r->slit_fraction, err));
    SF_TRY(read_optional(r, "/model/symmetry_x", &r->symmetry_place[0], err));
    SF_TRY(read_optional(r, "/model/symmetry_y", &r->symmetry_place[1], err));
    SF_TRY(read_sphere(r, err));
    SF_TRY(read_layers(r, err));
    if (sf_h5_exists(r->file, "/model/axisymmetric"))
        SF_TRY(read_flag(r, "/model/axisymmetric", &r->axisymmetric, err));
    SF_TRY(check_model(r, err));
    r->modelled_parts = r->symmetry_factor;
    r->modelled_nodes = r->node_count;
    r->modelled_cells = r->cell_count;
    return r->axisymmetric ? sf_results_revolve(r, err) : SF_OK;
}

/* The solver's notes, a sentence per line; files of earlier versions have none. */
static sf_status read_notes(sf_results *r, sf_error *err) {
    SF_OWNED char *notes = NULL;
    char *rest = NULL;
    if (!sf_h5_exists(r->file, "/summary/notes"))
        return SF_OK;
    SF_TRY(sf_h5_read_text(r->file, "/summary/notes", &notes, err));
    for (char *line = strtok_r(notes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        sf_error_clean(line);
        sf_results_note_run(r, line);
    }
    return SF_OK;
}

static sf_status read_summary(sf_results *r, sf_error *err) {
    r->steps = r->threads = r->interactions = -1;
    r->contact_time = r->wall_time = r->given_back = r->vibration = r->set = r->set_largest = NAN;
    r->has_summary = sf_h5_exists(r->file, "/summary/status");
    if (!r->has_summary) {
        note_ending(
            r, "there is no /summary: the run still runs or was killed; the data written so far are used");
        return SF_OK;
    }
    SF_OWNED char *status = NULL;
    SF_TRY(sf_h5_read_text(r->file, "/summary/status", &status, err));
    snprintf(r->status, sizeof r->status, "%s", status);
    SF_TRY(sf_h5_read_one(r->file, "/summary/steps", SF_H5_I64, &r->steps, err));
    SF_TRY(sf_h5_read_one(r->file, "/summary/threads", SF_H5_I64, &r->threads, err));
    SF_TRY(sf_h5_read_one(r->file, "/summary/interactions", SF_H5_I64, &r->interactions, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/summary/wall_time", &r->wall_time, err));
    SF_TRY(sf_h5_read_scalar(r->file, "/summary/contact_time", &r->contact_time, err));
    SF_TRY(read_optional(r, "/summary/given_back", &r->given_back, err));
    SF_TRY(read_optional(r, "/summary/vibration", &r->vibration, err));
    SF_TRY(read_optional(r, "/summary/set", &r->set, err));
    SF_TRY(read_optional(r, "/summary/set_largest", &r->set_largest, err));
    SF_TRY(read_notes(r, err));
    if (!sf_results_ended_well(r))
        sf_results_note(r, "the run stopped with: %s", r->status);
    else if (strcmp(r->status, "interrupted") == 0)
        note_ending(r, "the run was interrupted: the figures are those of the part that was computed");
    return SF_OK;
}

static sf_status read_history(sf_results *r, sf_error *err) {
    int64_t rows[SF_HISTORY_COUNT];
    for (int c = 0; c < SF_HISTORY_COUNT; c++) {
        SF_PRINTED(path, 64, "/history/%s", sf_history_column_get(c)->name);
        rows[c] = -1;
        SF_TRY(read_array(r, path, SF_H5_F64, &rows[c], 1, &r->history.column[c], err));
    }
    return check_history(r, rows, err);
}

static sf_status read_head(const sf_results *r, sf_frame_head *head, sf_error *err) {
    SF_PRINTED(path, 64, "%s/time", head->group);
    SF_TRY(sf_h5_read_scalar(r->file, path, &head->time, err));
    snprintf(path, sizeof path, "%s/acceleration", head->group);
    SF_TRY(sf_h5_read_scalar(r->file, path, &head->acceleration, err));
    snprintf(path, sizeof path, "%s/missile_displacement", head->group);
    SF_TRY(read_numbers(r, path, 3, head->missile_displacement, err));
    snprintf(path, sizeof path, "%s/missile_quaternion", head->group);
    SF_TRY(read_numbers(r, path, 4, head->missile_quaternion, err));
    const double *u = head->missile_displacement, *q = head->missile_quaternion;
    if (!(fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-6))
        return SF_FAIL(err, SF_ERR_IO, "%s: its missile_quaternion is not of unit length", head->group);
    if (!isfinite(head->time) || !isfinite(head->acceleration) || !isfinite(u[0] + u[1] + u[2]))
        return SF_FAIL(err, SF_ERR_IO, "%s: its time, acceleration or missile_displacement is not finite",
                       head->group);
    return SF_OK;
}

/* Passes the error on; of a run that did not end well it becomes a note. */
static sf_status keep_error(sf_results *r, const sf_error *problem, sf_error *err) {
    if (sf_results_ended_well(r))
        return SF_FAIL(err, problem->status, "%s", problem->text);
    sf_results_note(r, "left out: %.200s", problem->text);
    return SF_OK;
}

static sf_status read_frame_list(sf_results *r, sf_error *err) {
    int64_t count = sf_h5_group_size(r->file, "/frames");
    r->frames =
        sf_alloc(err, (unsigned long)(count > 0 ? count : 0), sizeof *r->frames, "the list of frames");
    SF_TRY(err->status);
    for (int64_t k = 0; k < count; k++) {
        char name[16];
        sf_error problem = SF_ERROR_INIT;
        sf_frame_head *head = &r->frames[r->frame_count];
        SF_TRY(sf_h5_group_member(r->file, "/frames", k, name, sizeof name, err));
        snprintf(head->group, sizeof head->group, "/frames/%s", name);
        if (read_head(r, head, &problem) == SF_OK && k > 0 && r->frame_count > 0 &&
            !(head->time > head[-1].time))
            SF_FAIL(&problem, SF_ERR_IO, "%s: its time %.9g s does not follow %.9g s of the frame before",
                    head->group, head->time, head[-1].time);
        if (problem.status == SF_OK)
            r->frame_count++;
        else
            SF_TRY(keep_error(r, &problem, err));
    }
    sf_error problem = SF_ERROR_INIT;
    if (r->frame_count > 0 && r->layer_count > 0 &&
        read_layer_sums(r, &r->frames[r->frame_count - 1], &problem) != SF_OK) {
        sf_free_all(SF_LAYER_SUMS, r->layer_sum);
        SF_TRY(keep_error(r, &problem, err));
    }
    if (r->frame_count == 0)
        sf_results_note(r, "there are no frames: nothing to show in ParaView");
    snprintf(r->peak.group, sizeof r->peak.group, "/peak");
    if (!sf_h5_exists(r->file, "/peak"))
        return SF_OK;
    problem = (sf_error)SF_ERROR_INIT;
    r->has_peak = read_head(r, &r->peak, &problem) == SF_OK;
    if (!r->has_peak)
        keep_error(r, &problem, err);
    return err->status;
}

sf_status sf_results_open(const char *path, sf_results *results, sf_error *err) {
    *results = (sf_results){0};
    if (sf_h5_open(path, &results->file, err) != SF_OK ||
        sf_provenance_check(results->file, path, "softfall-results", err) != SF_OK ||
        read_model(results, err) != SF_OK || read_summary(results, err) != SF_OK ||
        read_history(results, err) != SF_OK || read_frame_list(results, err) != SF_OK ||
        sf_seal_check(path, err) != SF_OK)
        sf_results_close(results);
    return err->status;
}

void sf_results_close(sf_results *results) {
    sf_h5_drop(&results->file);
    sf_history_free(&results->history);
    sf_revolution_free(&results->revolution);
    sf_free_all(SF_LAYER_SUMS, results->layer_sum);
    SF_CLEAR(results, results->position, results->volume, results->cell_type, results->cell_ptr,
             results->cell_node, results->surface_position, results->surface_triangle,
             results->support_position, results->support_triangle, results->node_layer, results->layer_name,
             results->layer_names, results->layer_density, results->layer_informed, results->frames);
}

/* Copies the fields of a frame in memory. */
static sf_status copy_frame(const sf_results *r, const sf_frame_head *head, int fields, sf_frame *frame,
                            sf_error *err) {
    const int64_t rows = r->axisymmetric ? r->revolution.section_nodes : r->node_count;
    for (int f = 0; f < SF_FRAME_FIELDS && err->status == SF_OK; f++) {
        const int components = sf_frame_field_get((sf_frame_field)f)->components;
        const bool vector = f == SF_FRAME_DISPLACEMENT || f == SF_FRAME_VELOCITY;
        if (!(fields >> f & 1) || !head->field[f])
            continue;
        frame->field[f] = sf_alloc(err, rows * components, sizeof(double), "a field of a frame");
        if (frame->field[f])
            memcpy(frame->field[f], head->field[f], (size_t)(rows * components) * sizeof(double));
        if (frame->field[f] && r->axisymmetric)
            sf_revolution_field(&r->revolution, components, vector, &frame->field[f], err);
    }
    if (err->status != SF_OK)
        sf_frame_free(frame);
    return err->status;
}

sf_status sf_frame_read(const sf_results *results, const sf_frame_head *head, int fields, sf_frame *frame,
                        sf_error *err) {
    *frame = (sf_frame){0};
    if (head->field)
        return copy_frame(results, head, fields, frame, err);
    for (int f = 0; f < SF_FRAME_FIELDS; f++) {
        const sf_frame_field_info *info = sf_frame_field_get((sf_frame_field)f);
        SF_PRINTED(path, 80, "%s/%s", head->group, info->name);
        if (!(fields >> f & 1))
            continue;
        if (!sf_h5_exists(results->file, path)) {
            if (sf_h5_exists(results->file, head->group))
                continue; /* not among output.fields */
            sf_frame_free(frame);
            return SF_FAIL(err, SF_ERR_IO,
                           "%s is no longer where results.h5 named it: the run has gone on or ended "
                           "meanwhile; read the results again",
                           head->group);
        }
        int64_t rows = results->axisymmetric ? results->revolution.section_nodes : results->node_count;
        bool vector = f == SF_FRAME_DISPLACEMENT || f == SF_FRAME_VELOCITY;
        if (read_array(results, path, SF_H5_F64, &rows, info->components, &frame->field[f], err) != SF_OK ||
            check_finite(frame->field[f], rows * info->components, path, err) != SF_OK ||
            (results->axisymmetric && sf_revolution_field(&results->revolution, info->components, vector,
                                                          &frame->field[f], err) != SF_OK)) {
            sf_frame_free(frame);
            return err->status;
        }
    }
    return SF_OK;
}

const sf_frame_head *sf_frame_of_peak(const sf_results *r) {
    const sf_frame_head *best = r->frame_count > 0 ? &r->frames[0] : NULL;
    for (int64_t k = 1; k < r->frame_count; k++)
        if (r->frames[k].acceleration > best->acceleration)
            best = &r->frames[k];
    return best;
}

void sf_frame_free(sf_frame *frame) {
    sf_free_all(SF_FRAME_FIELDS, frame->field);
    *frame = (sf_frame){0};
}
