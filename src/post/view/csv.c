/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/csv.h"

#include "model/cells.h"
#include "post/view/axis.h"

sf_status sf_csv_write_history(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                               sf_error *err) {
    SF_CSV_FILE(csv, output, "history.csv", err);
    const sf_history *h = &results->history;
    for (int c = 0; c < SF_HISTORY_COUNT; c++) {
        const sf_history_column *column = sf_history_column_get(c);
        if (column->csv)
            sf_csv_print(&csv, "%s", column->csv);
        else
            sf_csv_print(&csv, "acceleration_raw_g,acceleration_cfc%.0f_g", figures->cfc);
    }
    sf_csv_end(&csv);
    for (int64_t i = 0; i < h->rows; i++) {
        for (int c = 0; c < SF_HISTORY_COUNT; c++) {
            const sf_history_column *column = sf_history_column_get(c);
            if (column->csv)
                SF_CSV_NUMBERS(&csv, h->column[c][i] * column->factor);
            else
                SF_CSV_NUMBERS(&csv, figures->raw.value[i], sf_series_at(&figures->filtered, h->time[i]));
        }
        sf_csv_end(&csv);
    }
    return sf_csv_close(&csv, err);
}

sf_status sf_csv_write_acceleration(const sf_staging *output, const sf_figures *figures, sf_error *err) {
    const sf_series *curve = &figures->filtered;
    SF_CSV_FILE(csv, output, "acceleration.csv", err);
    SF_CSV_PRINT_LINE(&csv, "time_ms,acceleration_cfc%.0f_g", figures->cfc);
    for (int64_t i = 0; i < curve->count; i++)
        SF_CSV_LINE(&csv, curve->time[i] * 1e3, curve->value[i]);
    return sf_csv_close(&csv, err);
}

sf_status sf_csv_write_compression(const sf_staging *output, const sf_results *results,
                                   const sf_figures *figures, sf_error *err) {
    SF_CSV_FILE(csv, output, "compression.csv", err);
    SF_CSV_PRINT_LINE(&csv, "time_ms,strain_1,stress_kPa,force_N");
    for (int64_t i = 0; i < results->history.rows; i++) {
        double force = results->history.contact_force[i];
        SF_CSV_LINE(&csv, results->history.time[i] * 1e3,
                    results->history.indentation[i] / results->thickness, force / figures->area * 1e-3,
                    force);
    }
    return sf_csv_close(&csv, err);
}

sf_status sf_csv_write_reference(const sf_staging *output, const sf_comparison *comparison,
                                 const sf_figures *figures, sf_error *err) {
    const sf_series *raw = &comparison->measured.raw, *model = &figures->filtered;
    SF_CSV_FILE(csv, output, "reference.csv", err);
    SF_CSV_PRINT_LINE(&csv,
                      "time_ms,acceleration_measured_g,acceleration_cfc%.0f_g,acceleration_measured_raw_g",
                      figures->cfc);
    for (int64_t i = 0; i < raw->count; i++) {
        double time = raw->time[i] + comparison->shift;
        bool covered = time >= model->time[0] && time <= model->time[model->count - 1];
        SF_CSV_LINE(&csv, time * 1e3, sf_series_at(&comparison->measured.curve, raw->time[i]),
                    covered ? sf_series_at(model, time) : NAN, raw->value[i]);
    }
    return sf_csv_close(&csv, err);
}

/* ---- the mid-section ---- */

enum { STATIONS = 41 }; /* points under the axis */

/* A point of the section: the mean of up to 4 nodes with barycentric weights. */
typedef struct section_point {
    int32_t node[4];
    double weight[4];
    double fit; /* smallest weight: 0 or more inside the tetrahedron, the best so far while searching */
} section_point;

/* Barycentric weights of `x` in the tetrahedron; false if that is flat. */
static bool tetrahedron_weights(const double *const p[4], const double x[3], double weight[4]) {
    double e[3][3], b[3], size = 0;
    for (int k = 0; k < 3; k++) {
        b[k] = x[k] - p[0][k];
        for (int j = 0; j < 3; j++) {
            e[j][k] = p[j + 1][k] - p[0][k];
            size = fmax(size, fabs(e[j][k]));
        }
    }
    double volume = sf_triple3(e[0], e[1], e[2]);
    if (fabs(volume) < 1e-9 * size * size * size)
        return false;
    weight[1] = sf_triple3(b, e[1], e[2]) / volume;
    weight[2] = sf_triple3(e[0], b, e[2]) / volume;
    weight[3] = sf_triple3(e[0], e[1], b) / volume;
    weight[0] = 1 - weight[1] - weight[2] - weight[3];
    return true;
}

static void offer_tetrahedron(const sf_results *r, const int32_t *cell, const int corner[4],
                              const double x[3], section_point *point) {
    const double *p[4];
    double weight[4];
    for (int k = 0; k < 4; k++)
        p[k] = &r->position[3 * (int64_t)cell[corner[k]]];
    if (!tetrahedron_weights(p, x, weight))
        return;
    double fit = fmin(fmin(weight[0], weight[1]), fmin(weight[2], weight[3]));
    if (fit <= point->fit)
        return;
    point->fit = fit;
    for (int k = 0; k < 4; k++) {
        point->node[k] = cell[corner[k]];
        point->weight[k] = weight[k];
    }
}

/* Finds the tetrahedron of each station under the axis; those in no cell keep a negative fit. */
static void locate_stations(const sf_results *r, const double axis[2], double bottom, double top,
                            section_point *station) {
    for (int s = 0; s < STATIONS; s++)
        station[s] = (section_point){.fit = -INFINITY};
    for (int64_t c = 0; c < r->cell_count; c++) {
        const int32_t *cell = &r->cell_node[r->cell_ptr[c]];
        double low[3], high[3];
        sf_box3(0, NULL, low, high);
        for (int64_t v = 0; v < r->cell_ptr[c + 1] - r->cell_ptr[c]; v++)
            sf_box3_add(&r->position[3 * (int64_t)cell[v]], low, high);
        double slack = 1e-6 * (high[2] - low[2]);
        if (axis[0] < low[0] - slack || axis[0] > high[0] + slack || axis[1] < low[1] - slack ||
            axis[1] > high[1] + slack)
            continue;
        const sf_cell_shape *shape = sf_cell_shape_of(r->cell_type[c]);
        for (int s = 0; s < STATIONS; s++) {
            double z = top + (bottom - top) * s / (STATIONS - 1);
            const double x[3] = {axis[0], axis[1], z};
            for (int t = 0; t < shape->tetrahedra && z >= low[2] - slack && z <= high[2] + slack; t++)
                offer_tetrahedron(r, cell, shape->tetrahedron[t], x, &station[s]);
        }
    }
}

/* Finds the points under the axis, top to bottom, evenly spaced; returns the height of the top (m). */
static double find_stations(const sf_results *r, section_point station[STATIONS]) {
    double axis[2], low[3], high[3];
    sf_box3(r->node_count, r->position, low, high);
    sf_axis_find(r, axis);
    locate_stations(r, axis, low[2], high[2], station);
    return high[2];
}

/* True if the point lies in a cell; otherwise its mean has no meaning. */
static bool is_inside(const section_point *point) {
    return point->fit >= -1e-6;
}

/* Returns a component of a field ([node_count][components]) there. */
static double mean_at(const double *field, int components, int component, const section_point *point) {
    double sum = 0;
    for (int k = 0; k < 4; k++)
        sum += point->weight[k] * field[components * (int64_t)point->node[k] + component];
    return sum;
}

/* Means of `count` components from `first` on; empty cells if there is no such field. */
static void put_means(sf_csv *csv, double factor, const double *field, int components, int first, int count,
                      const section_point *p) {
    for (int k = first; k < first + count; k++)
        SF_CSV_NUMBERS(csv, field ? factor * mean_at(field, components, k, p) : NAN);
}

static void put_point(sf_csv *csv, const sf_results *r, const sf_frame *frame, double top,
                      const section_point *p) {
    put_means(csv, 1e3, r->position, 3, 0, 3, p);
    SF_CSV_NUMBERS(csv, 1e3 * (top - mean_at(r->position, 3, 2, p)));
    put_means(csv, 1e3, frame->field[SF_FRAME_DISPLACEMENT], 3, 0, 3, p);
    put_means(csv, 1e-3, frame->field[SF_FRAME_VON_MISES], 1, 0, 1, p);
    put_means(csv, 1e-3, frame->field[SF_FRAME_CAUCHY_STRESS], 9, 8, 1, p);
    put_means(csv, 1, frame->field[SF_FRAME_LARGEST_COMPRESSION], 1, 0, 1, p);
    sf_csv_end(csv);
}

/* Top to bottom, then along x. */
static int by_depth(const void *a, const void *b, void *positions) {
    const double *x = (const double *)positions + 3 * (int64_t) * (const int32_t *)a;
    const double *y = (const double *)positions + 3 * (int64_t) * (const int32_t *)b;
    if (x[2] != y[2])
        return x[2] > y[2] ? -1 : 1;
    return (x[0] > y[0]) - (x[0] < y[0]);
}

static sf_status write_rows(sf_csv *csv, const sf_results *r, const sf_frame *frame, sf_error *err) {
    double axis[2], top;
    section_point station[STATIONS];
    SF_OWNED int32_t *nodes = sf_alloc(err, r->node_count, sizeof *nodes, "the nodes of the section");
    size_t count = 0;
    SF_TRY(err->status);
    sf_axis_find(r, axis);
    top = find_stations(r, station);
    for (int64_t i = 0; i < r->node_count; i++) {
        double off = fabs(r->position[3 * i + 1] - axis[1]);
        if (r->axisymmetric ? off == 0 : off < 0.499 * cbrt(r->volume[i])) /* the section itself */
            nodes[count++] = (int32_t)i;
    }
    qsort_r(nodes, count, sizeof *nodes, by_depth, r->position);
    for (size_t i = 0; i < count; i++) {
        section_point point = {.node = {nodes[i]}, .weight = {1}};
        sf_csv_print(csv, "section,%d", r->axisymmetric ? r->revolution.node[nodes[i]] : nodes[i]);
        put_point(csv, r, frame, top, &point);
    }
    for (int s = 0; s < STATIONS; s++) {
        if (!is_inside(&station[s]))
            continue;
        sf_csv_print(csv, "axis,");
        put_point(csv, r, frame, top, &station[s]);
    }
    return SF_OK;
}

sf_status sf_section_write(const sf_staging *output, const sf_results *results, bool *written,
                           sf_error *err) {
    const sf_frame_head *head = results->has_peak ? &results->peak : sf_frame_of_peak(results);
    SF_OWNED_BY(sf_frame_free) sf_frame frame = {0};
    *written = false;
    if (!head)
        return SF_OK;
    if (sf_frame_read(results, head, SF_FIELD_ALL, &frame, err) != SF_OK || !frame.field[SF_FRAME_VON_MISES])
        return err->status;
    SF_CSV_FILE(csv, output, "section.csv", err);
    SF_CSV_PRINT_LINE(
        &csv, "set,node,x_mm,y_mm,z_mm,depth_mm,displacement_x_mm,displacement_y_mm,displacement_z_mm,"
              "von_mises_kPa,stress_zz_kPa,largest_compression_1");
    write_rows(&csv, results, &frame, err);
    *written = sf_csv_close(&csv, err) == SF_OK;
    return err->status;
}
