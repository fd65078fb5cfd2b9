/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/csv.h"

sf_status sf_csv_write_history(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                               sf_error *err) {
    FILE *file = sf_staging_open(output, "history.csv", err);
    if (!file)
        return err->status;
    const sf_history *h = &results->history;
    for (int c = 0; c < SF_HISTORY_COUNT; c++) {
        const sf_history_column *column = sf_history_column_get(c);
        fputs(c > 0 ? "," : "", file);
        if (column->csv)
            fputs(column->csv, file);
        else
            fprintf(file, "acceleration_raw_g,acceleration_cfc%.0f_g", figures->cfc);
    }
    fputc('\n', file);
    for (int64_t i = 0; i < h->rows; i++) {
        for (int c = 0; c < SF_HISTORY_COUNT; c++) {
            const sf_history_column *column = sf_history_column_get(c);
            fputs(c > 0 ? "," : "", file);
            if (column->csv)
                fprintf(file, "%.9g", h->column[c][i] * column->factor);
            else
                fprintf(file, "%.9g,%.9g", figures->raw.value[i],
                        sf_series_at(&figures->filtered, h->time[i]));
        }
        fputc('\n', file);
    }
    return sf_staging_close(file, "history.csv", err);
}

sf_status sf_csv_write_acceleration(const sf_staging *output, const sf_figures *figures, sf_error *err) {
    const sf_series *curve = &figures->filtered;
    FILE *file = sf_staging_open(output, "acceleration.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "time_ms,acceleration_cfc%.0f_g\n", figures->cfc);
    for (int64_t i = 0; i < curve->count; i++)
        fprintf(file, "%.9g,%.9g\n", curve->time[i] * 1e3, curve->value[i]);
    return sf_staging_close(file, "acceleration.csv", err);
}

sf_status sf_csv_write_compression(const sf_staging *output, const sf_results *results,
                                   const sf_figures *figures, sf_error *err) {
    FILE *file = sf_staging_open(output, "compression.csv", err);
    if (!file)
        return err->status;
    fputs("time_ms,strain_1,stress_kPa,force_N\n", file);
    for (int64_t i = 0; i < results->history.rows; i++) {
        double force = results->history.contact_force[i];
        fprintf(file, "%.9g,%.9g,%.9g,%.9g\n", results->history.time[i] * 1e3,
                results->history.indentation[i] / results->thickness, force / figures->area * 1e-3, force);
    }
    return sf_staging_close(file, "compression.csv", err);
}

sf_status sf_csv_write_reference(const sf_staging *output, const sf_comparison *comparison,
                                 const sf_figures *figures, sf_error *err) {
    const sf_series *raw = &comparison->raw, *model = &figures->filtered;
    FILE *file = sf_staging_open(output, "reference.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "time_ms,acceleration_measured_g,acceleration_cfc%.0f_g,acceleration_measured_raw_g\n",
            figures->cfc);
    for (int64_t i = 0; i < raw->count; i++) {
        double time = raw->time[i] + comparison->shift;
        fprintf(file, "%.9g,%.9g,", time * 1e3, sf_series_at(&comparison->measured, raw->time[i]));
        if (time >= model->time[0] && time <= model->time[model->count - 1])
            fprintf(file, "%.9g", sf_series_at(model, time));
        fprintf(file, ",%.9g\n", raw->value[i]);
    }
    return sf_staging_close(file, "reference.csv", err);
}
