/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/csv.h"

typedef struct csv_column {
    sf_history_column column;
    const char *name;
    double factor; /* from SI to the unit of the name */
} csv_column;

/* What follows time and acceleration in history.csv. */
static const csv_column history_columns[] = {
    {SF_HISTORY_VELOCITY, "velocity_m_s", 1},
    {SF_HISTORY_DISPLACEMENT, "displacement_mm", 1e3},
    {SF_HISTORY_INDENTATION, "indentation_mm", 1e3},
    {SF_HISTORY_CONTACT_FORCE, "contact_force_N", 1},
    {SF_HISTORY_FRICTION_FORCE, "friction_force_N", 1},
    {SF_HISTORY_BASE_REACTION, "base_reaction_N", 1},
    {SF_HISTORY_ENERGY_KINETIC_MISSILE, "energy_kinetic_missile_J", 1},
    {SF_HISTORY_ENERGY_KINETIC_PAD, "energy_kinetic_pad_J", 1},
    {SF_HISTORY_ENERGY_STORED, "energy_stored_J", 1},
    {SF_HISTORY_ENERGY_HYSTERESIS, "energy_hysteresis_J", 1},
    {SF_HISTORY_ENERGY_VISCOUS, "energy_viscous_J", 1},
    {SF_HISTORY_ENERGY_STABILISATION, "energy_stabilisation_J", 1},
    {SF_HISTORY_ENERGY_CONTACT, "energy_contact_J", 1},
    {SF_HISTORY_ENERGY_FRICTION, "energy_friction_J", 1},
    {SF_HISTORY_ENERGY_EXTERNAL, "energy_external_J", 1},
    {SF_HISTORY_ENERGY_ERROR, "energy_error_1", 1},
    {SF_HISTORY_MOMENTUM_ERROR, "momentum_error_1", 1},
    {SF_HISTORY_LARGEST_COMPRESSION, "largest_compression_1", 1},
    {SF_HISTORY_SMALLEST_JACOBIAN, "smallest_jacobian_1", 1},
    {SF_HISTORY_CONTACT_NODES, "contact_nodes_1", 1},
    {SF_HISTORY_PENETRATION, "penetration_mm", 1e3},
    {SF_HISTORY_CONSTRAINT_RESIDUAL, "constraint_residual_m_s", 1},
    {SF_HISTORY_TIME_STEP, "time_step_us", 1e6},
};
enum { CSV_COLUMNS = sizeof history_columns / sizeof history_columns[0] };

sf_status sf_csv_write_history(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                               sf_error *err) {
    FILE *file = sf_staging_open(output, "history.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "time_ms,acceleration_raw_g,acceleration_cfc%.0f_g", figures->cfc);
    for (int c = 0; c < CSV_COLUMNS; c++)
        fprintf(file, ",%s", history_columns[c].name);
    fputc('\n', file);
    for (int64_t i = 0; i < results->history_rows; i++) {
        double time = figures->raw.time[i];
        fprintf(file, "%.9g,%.9g,%.9g", time * 1e3, figures->raw.value[i],
                sf_series_at(&figures->filtered, time));
        for (int c = 0; c < CSV_COLUMNS; c++)
            fprintf(file, ",%.9g",
                    results->history[history_columns[c].column][i] * history_columns[c].factor);
        fputc('\n', file);
    }
    return sf_staging_close(file, "history.csv", err);
}

sf_status sf_csv_write_compression(const sf_staging *output, const sf_results *results,
                                   const sf_figures *figures, sf_error *err) {
    FILE *file = sf_staging_open(output, "compression.csv", err);
    if (!file)
        return err->status;
    fputs("time_ms,strain_1,stress_kPa,force_N\n", file);
    for (int64_t i = 0; i < results->history_rows; i++) {
        double force = results->history[SF_HISTORY_CONTACT_FORCE][i];
        fprintf(file, "%.9g,%.9g,%.9g,%.9g\n", results->history[SF_HISTORY_TIME][i] * 1e3,
                results->history[SF_HISTORY_INDENTATION][i] / results->thickness,
                force / figures->area * 1e-3, force);
    }
    return sf_staging_close(file, "compression.csv", err);
}

sf_status sf_csv_write_reference(const sf_staging *output, const sf_comparison *comparison,
                                 const sf_figures *figures, sf_error *err) {
    const sf_series *measured = &comparison->measured, *model = &figures->filtered;
    FILE *file = sf_staging_open(output, "reference.csv", err);
    if (!file)
        return err->status;
    fprintf(file, "time_ms,acceleration_measured_g,acceleration_cfc%.0f_g\n", figures->cfc);
    for (int64_t i = 0; i < measured->count; i++) {
        double time = measured->time[i] + comparison->shift;
        fprintf(file, "%.9g,%.9g,", time * 1e3, measured->value[i]);
        if (time >= model->time[0] && time <= model->time[model->count - 1])
            fprintf(file, "%.9g", sf_series_at(model, time));
        fputc('\n', file);
    }
    return sf_staging_close(file, "reference.csv", err);
}
