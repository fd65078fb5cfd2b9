/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/history.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROWS = 4096 };

static const sf_h5_info columns[SF_HISTORY_COLUMNS] = {
    {"/history/time", "s", "end of the step"},
    {"/history/time_step", "s", "step that follows"},
    {"/history/acceleration", "m s-2", "missile, against its direction of motion"},
    {"/history/velocity", "m s-1", "missile, along its direction of motion"},
    {"/history/displacement", "m", "missile, along its direction of motion"},
    {"/history/indentation", "m", "depth of the missile's first touching point below the undeformed top"},
    {"/history/contact_force", "N", "on the missile, against its direction of motion"},
    {"/history/friction_force", "N", "tangential part of it"},
    {"/history/base_reaction", "N", "force of the base on the pad, z"},
    {"/history/energy_kinetic_missile", "J", "kinetic energy of the missile"},
    {"/history/energy_kinetic_pad", "J", "kinetic energy of the pad"},
    {"/history/energy_stored", "J", "recoverable energy of the foam"},
    {"/history/energy_hysteresis", "J", "lost by the unloading rule"},
    {"/history/energy_viscous", "J", "work of DAMP, Maxwell, Kelvin and rate overstress"},
    {"/history/energy_stabilisation", "J", "work of the stabilisation"},
    {"/history/energy_contact", "J", "lost in normal contact"},
    {"/history/energy_friction", "J", "lost in friction"},
    {"/history/energy_external", "J", "work of gravity on the missile, or of its prescribed motion"},
    {"/history/energy_error", "1",
     "error of the energy balance, over the initial energy or the largest external work"},
    {"/history/momentum_error", "1",
     "momentum change minus impulses, over mass x speed or the impulse of contact"},
    {"/history/largest_compression", "1", "1 - smallest principal stretch of all domains"},
    {"/history/smallest_jacobian", "1", "smallest det F"},
    {"/history/contact_nodes", "1", "points in contact, modelled part"},
    {"/history/penetration", "m", "deepest penetration of a point"},
    {"/history/constraint_residual", "m s-1", "largest |G v|, measured every 16 steps"},
};

/* Room for one row more. */
static sf_status grow(sf_history *h, sf_error *err) {
    if (h->rows < h->room)
        return SF_OK;
    int64_t room = h->room > 0 ? 2 * h->room : FIRST_ROWS;
    for (int k = 0; k < SF_HISTORY_COLUMNS; k++) {
        double *grown = realloc(h->column[k], (size_t)room * sizeof *grown);
        if (!grown)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a history of %lld rows", (long long)room);
        h->column[k] = grown;
    }
    h->room = room;
    return SF_OK;
}

sf_status sf_history_add(sf_history *h, const sf_model *m, const sf_state *s, sf_error *err) {
    const sf_ledger *l = &s->ledger;
    double whole = sf_model_whole(m);
    const double row[SF_HISTORY_COLUMNS] = {
        s->time,
        s->dt,
        sf_missile_deceleration(m, &s->missile),
        s->missile.velocity_now,
        s->missile.displacement,
        fmax(0, sf_missile_depth(m, &s->missile)),
        whole * sf_missile_contact_force(m, &s->missile),
        whole * s->missile.friction,
        whole * s->base_reaction[2],
        whole * l->kinetic_missile,
        whole * l->kinetic_pad,
        whole * l->stored,
        whole * l->hysteresis,
        whole * l->viscous,
        whole * l->stabilisation,
        whole * l->contact,
        whole * l->friction,
        whole * l->external,
        l->error,
        l->momentum_error,
        s->largest_compression,
        s->smallest_jacobian,
        (double)s->contact_count,
        s->penetration,
        s->constraint_residual,
    };
    if (grow(h, err) != SF_OK)
        return err->status;
    for (int k = 0; k < SF_HISTORY_COLUMNS; k++)
        h->column[k][h->rows] = row[k];
    h->rows++;
    return SF_OK;
}

sf_status sf_history_write(const sf_history *h, sf_h5 *file, sf_error *err) {
    for (int k = 0; k < SF_HISTORY_COLUMNS; k++)
        if (sf_h5_write(file, &columns[k], SF_H5_F64, 1, &h->rows, h->column[k], err) != SF_OK)
            return err->status;
    return SF_OK;
}

sf_status sf_history_read(sf_history *h, const sf_h5 *file, sf_error *err) {
    int64_t rows = -1;
    for (int k = 0; k < SF_HISTORY_COLUMNS; k++) {
        void *data = NULL;
        if (sf_h5_read(file, columns[k].path, SF_H5_F64, 1, &rows, &data, err) != SF_OK) {
            sf_history_free(h);
            return err->status;
        }
        h->column[k] = data;
    }
    h->rows = h->room = rows;
    return SF_OK;
}

void sf_history_free(sf_history *h) {
    for (int k = 0; k < SF_HISTORY_COLUMNS; k++)
        free(h->column[k]);
    memset(h, 0, sizeof *h);
}
