/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/laws.h"

#include <math.h>

/* The laws, the default first. */
#define LIST(LAW) LAW(sf_low_density_foam) LAW(sf_hyperfoam_law)
#define DECLARE(name) extern const sf_law name;
#define PLACE(name) &name,
LIST(DECLARE)
static const sf_law *const laws[] = {LIST(PLACE)};
enum { LAWS = sizeof laws / sizeof laws[0] };

const sf_law *sf_law_get(int number) {
    return number >= 0 && number < LAWS ? laws[number] : NULL;
}

const sf_law *sf_law_find(const char *name) {
    for (int k = 0; k < LAWS; k++)
        if (strcmp(laws[k]->name, name) == 0)
            return laws[k];
    return NULL;
}

static void place_history(const sf_material *m, sf_material_law *out) {
    for (int k = 0; k < m->law->history_count; k++) {
        const sf_history_variable *v = &m->law->history[k];
        int end = v->first + v->components;
        out->row_end = end > out->row_end ? end : out->row_end;
        for (int c = 0; c < v->components && (!v->needed || v->needed(m->card)); c++)
            out->row[out->rows++] = v->first + c;
    }
}

sf_status sf_material_law_build(const sf_material *m, sf_material_law *out, sf_error *err) {
    *out = (sf_material_law){.law = m->law, .length = sf_material_length(m, 0)};
    place_history(m, out);
    if (m->law->build(m->card, &out->numbers, err) != SF_OK)
        *out = (sf_material_law){0};
    return err->status;
}

void sf_material_law_free(sf_material_law *law) {
    if (law->numbers)
        law->law->release(law->numbers);
    *law = (sf_material_law){0};
}

bool sf_material_has_memory(const sf_material *m) {
    bool found = false;
    for (int k = 0; k < m->law->history_count; k++) {
        const sf_history_variable *v = &m->law->history[k];
        found |= strcmp(v->name, "memory") == 0 && (!v->needed || v->needed(m->card));
    }
    return found;
}

int sf_material_history_rows(const sf_material *m) {
    sf_material_law place = {0};
    place_history(m, &place);
    return place.rows;
}

void sf_material_load_history(const sf_material_law *law, const double *from, sf_law_batch *batch) {
    int next = 0;
    for (int k = 0; k < law->row_end; k++) {
        bool kept = next < law->rows && law->row[next] == k;
        if (kept)
            memcpy(batch->history[k], &from[SF_LANES * next++], sizeof batch->history[k]);
        else
            memset(batch->history[k], 0, sizeof batch->history[k]);
    }
}

void sf_material_store_history(const sf_material_law *law, const sf_law_batch *batch, double *to) {
    for (int k = 0; k < law->rows; k++)
        memcpy(&to[SF_LANES * k], batch->history[law->row[k]], sizeof batch->history[0]);
}

void sf_material_point_stretch(double f[9][SF_LANES], double stretch) {
    memset(f, 0, 9 * sizeof *f);
    for (int l = 0; l < SF_LANES; l++) {
        f[0][l] = f[4][l] = 1;
        f[8][l] = stretch;
    }
}

void sf_material_point_drive(const sf_material_law *law, double rate, double step, int count,
                             const double *strain, double *stress) {
    sf_law_batch batch;
    double at = 0, last = 0;
    memset(&batch, 0, sizeof batch);
    sf_material_point_stretch(batch.f, 1);
    for (int i = 0; i < count; i++) {
        int steps = (int)ceil(fabs(strain[i] - at) / step);
        double from = at;
        for (int k = 1; k <= steps; k++) {
            double next = from + (strain[i] - from) * k / steps;
            memcpy(batch.f_old, batch.f, sizeof batch.f);
            sf_material_point_stretch(batch.f, 1 - next);
            law->law->update(law->numbers, fabs(next - at) / rate, &batch);
            at = next;
            last = -batch.p[8][0];
        }
        stress[i] = last;
    }
}

/* Sets F of every lane to `strain` along z. */
static void strain_point(const sf_material_law *law, bool is_free, double strain, double f[9][SF_LANES]) {
    double side = is_free && law->law->lateral ? law->law->lateral(law->numbers, strain) : 1;
    sf_material_point_stretch(f, 1 - strain);
    for (int l = 0; l < SF_LANES; l++)
        f[0][l] = f[4][l] = side;
}

sf_status sf_material_point_follow(const sf_material_law *law, const sf_point_path *path, double *stress,
                                   sf_error *err) {
    static const double STEP = 1e-3; /* of strain */
    sf_law_batch batch;
    memset(&batch, 0, sizeof batch);
    strain_point(law, path->is_free, 0, batch.f);
    for (int64_t i = 0; i < path->count; i++) {
        double from = i ? path->strain[i - 1] : 0, change = path->strain[i] - from;
        int steps = (int)fmax(1, ceil(fabs(change) / STEP));
        for (int k = 1; i > 0 && k <= steps; k++) {
            memcpy(batch.f_old, batch.f, sizeof batch.f);
            strain_point(law, path->is_free, from + change * k / steps, batch.f);
            law->law->update(law->numbers, (path->time[i] - path->time[i - 1]) / steps, &batch);
        }
        stress[i] = 0 - batch.p[8][0]; /* not -0 */
        if (!isfinite(stress[i]))
            return SF_FAIL(err, SF_ERR_NUMERIC, "the law %s has no stress at a strain of %g", law->law->name,
                           path->strain[i]);
    }
    return SF_OK;
}

void sf_material_point_rest(const sf_material_law *law, double pause, sf_uniaxial *point) {
    double rows[SF_LAW_HISTORY][SF_LANES] = {{0}};
    law->law->uniaxial(law->numbers, 1, 0, point);
    for (int k = 0; k < SF_LAW_HISTORY; k++)
        rows[k][0] = point->history[k];
    law->law->rest(law->numbers, pause, rows);
    for (int k = 0; k < SF_LAW_HISTORY; k++)
        point->history[k] = rows[k][0];
}
