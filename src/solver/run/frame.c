/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/frame.h"

#include "io/h5_data.h"
#include "solver/field/domain_stress.h"
#include "solver/field/stabilisation.h"
#include "base/sets.h"
#include "base/mat3.h"

enum { SLAB = 64 * SF_LANES }; /* nodes: more would be felt in the memory of a run */

/* sigma = P F^T / J of one domain, with the stabilisation's couple taken out of the stored stress. */
static void take_stress(const sf_model *m, const sf_state *s, const sf_pair_sums *pairs, int64_t i,
                        double sigma[9], double *mises) {
    double p[9];
    const double *f = &s->f[9 * i];
    double j = sf_triple3(f, f + 3, f + 6), square = 0, mean;
    for (int k = 0; k < 9; k++)
        p[k] = (s->stress[9 * i + k] - pairs->couple[i % SF_GROUP][k % 3][k / 3]) / m->volume[i];
    if (m->axisymmetric) { /* as in sf_state.stress */
        p[4] = p[1];
        p[1] = 0;
    }
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            sigma[3 * r + c] =
                (p[3 * r] * f[3 * c] + p[3 * r + 1] * f[3 * c + 1] + p[3 * r + 2] * f[3 * c + 2]) / j;
    mean = (sigma[0] + sigma[4] + sigma[8]) / 3;
    for (int k = 0; k < 9; k++) {
        double deviator = sigma[k] - (k % 4 == 0 ? mean : 0);
        square += deviator * deviator;
    }
    *mises = sqrt(1.5 * square);
}

static void sort_stretches(const sf_law_batch *b, int lane, double out[3]) {
    double x = b->stretch[0][lane], y = b->stretch[1][lane], z = b->stretch[2][lane];
    out[0] = fmin(x, fmin(y, z));
    out[1] = fmax(fmin(x, y), fmin(fmax(x, y), z));
    out[2] = fmax(x, fmax(y, z));
}

/* The approximation of a coefficient field at node i, with a second one if it is not NULL. */
static void take_value(const sf_model *m, const double *one, const double *two, int64_t i, double out[3]) {
    double sum[3] = {0};
    for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++)
        for (int c = 0; c < 3; c++)
            sum[c] += m->phi_value[k] * (one[3 * (int64_t)m->phi_node[k] + c] +
                                         (two ? two[3 * (int64_t)m->phi_node[k] + c] : 0));
    memcpy(out, sum, sizeof sum);
}

/* Cauchy or von Mises stress of nodes of one group. */
static void take_stresses(const sf_model *m, const sf_operators *op, const sf_state *s, sf_frame_field kind,
                          int64_t first, int64_t end, double *out) {
    sf_pair_sums pairs;
    double sigma[9], mises;
    const sf_pair_field field = {s->d,
                                 s->f,
                                 s->pair_stiffness,
                                 s->pair_stiffness,
                                 s->pair_offset,
                                 s->group_has_offsets}; /* nothing changes */
    sf_stabilisation_group(m, &op->pairs, &field, first / SF_GROUP, &pairs);
    for (int64_t i = first; i < end; i++) {
        take_stress(m, s, &pairs, i, sigma, &mises);
        if (kind == SF_FRAME_CAUCHY_STRESS)
            memcpy(&out[9 * (i - first)], sigma, sizeof sigma);
        else
            out[i - first] = mises;
    }
}

/* A field of the law of nodes from the first of a block. */
static void take_law_field(const sf_model *m, const sf_operators *op, const sf_state *s, sf_frame_field kind,
                           int64_t first, int64_t end, double *out) {
    sf_law_batch b;
    double stretch[3];
    for (int64_t i = first; i < end; i++) {
        const sf_material_law *law = &op->law[m->node_material[i]];
        int lane = (int)(i % SF_LANES);
        if (lane == 0)
            sf_domain_law(m, op, s, i / SF_LANES, &b);
        sort_stretches(&b, lane, stretch);
        if (kind == SF_FRAME_PRINCIPAL_STRETCHES)
            memcpy(&out[3 * (i - first)], stretch, sizeof stretch);
        else if (kind == SF_FRAME_SOFTENING)
            out[i - first] = law->law->softening(law->numbers, b.history, lane);
        else if (kind == SF_FRAME_LARGEST_COMPRESSION)
            out[i - first] = 1 - stretch[0];
        else
            out[i - first] = kind == SF_FRAME_ENERGY_DENSITY ? b.energy[lane] : b.factor[lane];
    }
}

static void take_pressure(const sf_model *m, const sf_state *s, int64_t first, int64_t end, double *out) {
    memset(out, 0, (size_t)(end - first) * sizeof *out);
    for (int64_t c = sf_list_find(m->contact_node, 0, m->contact_count, first);
         c < m->contact_count && m->contact_node[c] < end; c++) {
        const double *force = &sf_state_load(m, s)[3 * c];
        if (m->contact_area[c] > 0 && sf_dot3(force, force) > 0) /* a normal without a force may be any */
            out[m->contact_node[c] - first] = sf_dot3(force, &s->contact.normal[3 * c]) / m->contact_area[c];
    }
}

/* One field of `count` nodes from node `start`, the first of a group. */
static void take_field(const sf_model *m, const sf_operators *op, const sf_state *s, sf_frame_field kind,
                       int64_t start, int64_t count, double *out) {
    int columns = sf_frame_field_get(kind)->components;
#pragma omp parallel for default(none) schedule(static) shared(m, op, s, kind, start, count, columns, out)
    for (int64_t first = start; first < start + count; first += SF_GROUP) {
        int64_t end = first + SF_GROUP < start + count ? first + SF_GROUP : start + count;
        double *rows = &out[(first - start) * columns];
        switch (kind) {
        case SF_FRAME_DISPLACEMENT:
        case SF_FRAME_VELOCITY:
            for (int64_t i = first; i < end; i++)
                take_value(m, kind == SF_FRAME_DISPLACEMENT ? s->d : s->v,
                           kind == SF_FRAME_DISPLACEMENT ? m->set : NULL, i, &rows[3 * (i - first)]);
            break;
        case SF_FRAME_CAUCHY_STRESS:
        case SF_FRAME_VON_MISES:
            take_stresses(m, op, s, kind, first, end, rows);
            break;
        case SF_FRAME_PRINCIPAL_STRETCHES:
        case SF_FRAME_LARGEST_COMPRESSION:
        case SF_FRAME_ENERGY_DENSITY:
        case SF_FRAME_HYSTERESIS_FACTOR:
        case SF_FRAME_SOFTENING:
            take_law_field(m, op, s, kind, first, end, rows);
            break;
        case SF_FRAME_CONTACT_PRESSURE:
            take_pressure(m, s, first, end, rows);
            break;
        case SF_FRAME_FIELDS:
            break;
        }
    }
}

/* Writes `count` numbers, or with 0 a scalar, as `item` of the group. */
static sf_status write_item(sf_h5 *file, const char *group, const sf_h5_info *item, int64_t count,
                            const double *data, sf_error *err) {
    SF_PRINTED(path, 128, "%s/%s", group, item->path);
    sf_h5_info info = {path, item->units, item->description};
    return sf_h5_write(file, &info, SF_H5_F64, count > 0, &count, data, err);
}

void sf_frame_layers(const sf_model *m, const sf_operators *op, const sf_state *s, double *sums) {
    int64_t count = m->material_count;
    double whole = sf_model_whole(m);
    sf_law_batch b;
    memset(sums, 0, 4 * (size_t)count * sizeof *sums);
    for (int64_t i = 0; i < m->node_count; i++) {
        int lane = (int)(i % SF_LANES);
        double *own = &sums[m->node_material[i]];
        if (lane == 0)
            sf_domain_law(m, op, s, i / SF_LANES, &b);
        own[0] += whole * m->volume[i] * b.stored[lane];
        own[count] += whole * m->volume[i] * (b.lost[lane] - s->lost_before[i]);
        own[2 * count] += whole * s->viscous_work[i];
        own[3 * count] = fmax(own[3 * count], s->compressed[i]);
    }
}

/* By layer, if the pad has several. */
static sf_status write_layers(const sf_model *m, const sf_operators *op, const sf_state *s, const char *path,
                              sf_h5 *file, sf_error *err) {
    static const sf_h5_info rows[] = {
        {"layer_stored", "J", "recoverable energy of each layer"},
        {"layer_hysteresis", "J", "lost by the unloading rule in each layer"},
        {"layer_viscous", "J", "viscous work in each layer to date"},
        {"layer_compression", "1", "largest compression in each layer to date"}};
    int64_t count = m->material_count;
    if (count < 2)
        return SF_OK;
    SF_OWNED double *sums = sf_alloc(err, 4 * count, sizeof *sums, "sums of the layers");
    if (sums)
        sf_frame_layers(m, op, s, sums);
    for (int k = 0; k < 4 && err->status == SF_OK; k++)
        write_item(file, path, &rows[k], count, &sums[k * count], err);
    return err->status;
}

/* The data of a frame beside its fields. */
static sf_status write_head(const sf_model *m, const sf_state *s, const char *path, sf_h5 *file,
                            sf_error *err) {
    static const sf_h5_info time = {"time", "s", "time"},
                            reading = {"acceleration", "m s-2",
                                       "specific force on the missile, against its direction of motion"},
                            translation = {"missile_displacement", "m",
                                           "translation of the missile's centre since t = 0"},
                            quaternion = {"missile_quaternion", "1",
                                          "orientation of the missile, w, x, y, z"},
                            base = {"base_reaction", "N", "force of the base on the pad"};
    double acceleration = sf_missile_reading(m, &s->missile), displacement[3], reaction[3];
    sf_missile_translation(m, &s->missile, displacement);
    for (int c = 0; c < 3; c++)
        reaction[c] = sf_model_whole(m) * s->base_reaction[c];
    SF_TRY(write_item(file, path, &time, 0, &s->time, err));
    SF_TRY(write_item(file, path, &reading, 0, &acceleration, err));
    SF_TRY(write_item(file, path, &translation, 3, displacement, err));
    SF_TRY(write_item(file, path, &quaternion, 4, s->missile.quaternion, err));
    return write_item(file, path, &base, 3, reaction, err);
}

/* One field of all nodes, through a buffer for a slab. */
static sf_status write_field(const sf_model *m, const sf_operators *op, const sf_state *s,
                             sf_frame_field kind, const char *path, sf_h5 *file, sf_error *err) {
    SF_OWNED double *buffer = sf_alloc(err, SLAB, 9 * sizeof *buffer, "fields of a frame");
    char name[128];
    const sf_frame_field_info *field = sf_frame_field_get(kind);
    const int64_t dims[2] = {m->node_count, field->components};
    sf_h5_info info = {name, field->units, field->description};
    sf_h5_rows rows;
    snprintf(name, sizeof name, "%s/%s", path, field->name);
    sf_h5_rows_begin(file, &info, SF_H5_F64, dims[1] > 1 ? 2 : 1, dims, &rows, err);
    for (int64_t start = 0; start < m->node_count && err->status == SF_OK; start += SLAB) {
        int64_t count = start + SLAB < m->node_count ? SLAB : m->node_count - start;
        take_field(m, op, s, kind, start, count, buffer);
        sf_h5_rows_add(&rows, count, buffer, err);
    }
    return sf_h5_rows_end(&rows, err);
}

sf_status sf_frame_write(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t wanted,
                         const char *path, sf_h5 *file, sf_error *err) {
    if (write_head(m, s, path, file, err) == SF_OK)
        write_layers(m, op, s, path, file, err);
    for (int k = 0; k < SF_FRAME_FIELDS && err->status == SF_OK; k++)
        if ((wanted >> k & 1) && (k != SF_FRAME_SOFTENING || s->drop > 1))
            write_field(m, op, s, (sf_frame_field)k, path, file, err);
    return err->status;
}

void sf_frame_take(const sf_model *m, const sf_operators *op, const sf_state *s, sf_frame_field field,
                   double *values) {
    take_field(m, op, s, field, 0, m->node_count, values);
}
