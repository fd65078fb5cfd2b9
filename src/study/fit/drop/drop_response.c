/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The responses of a fit: how a drop's figures and curve become them, those by columns, and the cache of the
 * latter. */
#include "study/fit/drop/drop_fit.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"
#include "material/low_density_foam.h"
#include "post/figures/compare.h"
#include <sys/file.h>
#include <unistd.h>

/* The bound of the indentation lies a little before the check of the anvil refuses the drop; its logarithm
 * has this standard deviation. */
static const double BOUND = 0.99, BOUND_SD = 0.003;

sf_status sf_drop_fit_card(const sf_fit_input *in, const double *u, sf_foam_card *card, sf_error *err) {
    double value[SF_PARAMETER_COUNT];
    memcpy(value, in->start, sizeof value);
    for (int k = 0; k < in->unknown_count; k++)
        value[in->unknown[k]] = exp(u[k]);
    return sf_foam_form_card(&in->form, value, card, err);
}

/* Checks that every measured number is defined. `by`: the source that does not give it, `remedy`: the
 * action of the user. */
static sf_status check_values(const sf_fit_drop *drop, const double *y, const char *by, const char *remedy,
                              sf_error *err) {
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        if (!isnan(drop->value[kind]) && !isfinite(y[kind]))
            return SF_FAIL(
                err, SF_ERR_NUMERIC, "%s of the drop %s was measured, but %s without %s within its time: %s",
                sf_drop_kind_get(kind)->key, drop->name, by, sf_drop_kind_get(kind)->needs, remedy);
    return SF_OK;
}

/* The curve, which has CFC 1000, with the lower class of the measured one. */
static sf_status filter_like_measured(const sf_series *curve, double cfc, sf_series *filtered,
                                      sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series uniform = {0};
    SF_TRY(sf_signal_resample(curve, sf_signal_rate(curve), &uniform, err));
    return sf_signal_filter_cfc(&uniform, cfc, filtered, err);
}

static sf_status take_samples(const sf_fit_drop *drop, const sf_series *curve, double *y, sf_error *err) {
    double contact = 0, end = curve->time[curve->count - 1];
    SF_TRY(sf_contact_instant(curve, drop->name, 0, &contact, err));
    for (int k = 0; k < drop->samples; k++) {
        double time = contact + drop->sample_time[k];
        y[k] = time <= end ? sf_series_at(curve, time) / drop->sample_scale : 0;
    }
    return SF_OK;
}

sf_signal_chain sf_drop_fit_chain(const sf_drop_fit *fit, const double *u) {
    double number[SF_SIGNAL_CHAIN];
    sf_signal_chain chain = fit->input->chain;
    memcpy(number, &chain, sizeof number);
    for (int k = 0; k < SF_SIGNAL_CHAIN && u; k++)
        if (fit->chain[k] >= 0)
            number[k] *= exp(u[fit->chain[k]]);
    memcpy(&chain, number, sizeof number);
    chain.mount_damping = fmin(chain.mount_damping, 0.999);
    chain.mount_frequency *= !fit->rigid;
    return chain;
}

/* Passes the curve through the chain, and evaluates it again. The chain and the filter, which the curve has
 * been through, are linear: their order does not matter. */
static sf_status pass_chain(const sf_signal_chain *chain, const sf_series *curve, sf_columns_figures *figures,
                            sf_series *passed, sf_error *err) {
    SF_TRY(sf_signal_resample(curve, sf_signal_rate(curve), passed, err));
    sf_signal_pass(chain, passed);
    return sf_columns_read(passed, figures, err);
}

sf_status sf_drop_fit_read(const sf_fit_drop *drop, const sf_signal_chain *chain,
                           const sf_columns_figures *figures, const sf_series *curve, const char *by,
                           const char *remedy, double *y, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series filtered = {0}, passed = {0};
    sf_columns_figures read = *figures;
    bool lower = drop->sample_class > 0 && drop->sample_class < 1000;
    if (chain->mount_frequency > 0 || chain->coupling > 0) {
        SF_TRY(pass_chain(chain, curve, &read, &passed, err));
        curve = &passed;
    }
    double scaled[SF_COLUMNS_LOGARITHMS];
    sf_columns_scale(&read, scaled);
    memcpy(y, scaled, SF_FIT_SAMPLES * sizeof *y);
    y[SF_FIT_SAMPLES + drop->samples] = scaled[SF_COLUMNS_STRAIN];
    if (drop->samples > 0 && lower)
        SF_TRY(filter_like_measured(curve, drop->sample_class, &filtered, err));
    if (drop->samples > 0)
        SF_TRY(take_samples(drop, lower ? &filtered : curve, &y[SF_FIT_SAMPLES], err));
    return check_values(drop, y, by, remedy, err);
}

/* ---- surrogate ---- */

/* No value of the drop. */
static void forget(const sf_drop_fit *fit, int d, double *y) {
    for (int k = fit->row[d]; k < fit->row[d + 1]; k++)
        y[k] = NAN;
}

sf_status sf_drop_fit_respond(const sf_drop_fit *fit, int first, int last, const sf_foam_card *card,
                              const double *u, double *y, sf_error *err) {
    const sf_material material = sf_foam_material(card);
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    SF_TRY(sf_material_law_build(&material, &law, err));
    const sf_signal_chain chain = sf_drop_fit_chain(fit, u);
    if (first == 0)
        SF_TRY(sf_joint_respond(&fit->input->joint, &law, y, err));
    for (int d = first; d < last && err->status == SF_OK; d++) {
        const sf_fit_drop *drop = &fit->input->drop[d];
        SF_OWNED_BY(sf_series_free) sf_series curve = {0};
        sf_columns_figures figures;
        sf_columns columns = fit->columns[d];
        if (drop->predicted && columns.count == 0) { /* its simulation failed before the pad was touched */
            forget(fit, d, y);
            continue;
        }
        if (u && fit->speed[d] >= 0)
            columns.speed *= exp(u[fit->speed[d]]);
        if (sf_columns_respond(&columns, &law, &figures, &curve, err) == SF_OK)
            sf_drop_fit_read(drop, &chain, &figures, &curve, "its columns end", "this foam does not let go",
                             &y[fit->row[d]], err);
        if (drop->predicted && err->status == SF_ERR_NUMERIC) { /* the foam may be too soft for this one */
            *err = (sf_error)SF_ERROR_INIT;
            forget(fit, d, y);
        }
    }
    return err->status;
}

/* Hashes the program, the start material with the form of its curve, and the samples. */
static uint64_t hash_inputs(const sf_drop_fit *fit) {
    const sf_fit_input *in = fit->input;
    sf_foam_card base = in->form.base;
    const sf_material material = sf_foam_material(&base);
    uint64_t hash = sf_hash_identity(SF_HASH_START, &fit->memory->program, sizeof fit->memory->program);
    hash = sf_material_hash(hash, &material);
    hash = sf_hash_identity(hash, in->form.curve->name, strlen(in->form.curve->name));
    hash = sf_hash_identity(hash, &in->form.solid_density, sizeof in->form.solid_density);
    hash = sf_hash_identity(hash, in->start, sizeof in->start);
    hash = sf_hash_identity(hash, in->unknown, (size_t)in->unknown_count * sizeof *in->unknown);
    hash = sf_joint_hash(hash, &in->joint);
    hash = sf_hash_identity(hash, &in->chain, sizeof in->chain);
    hash = sf_hash_identity(hash, fit->chain, sizeof fit->chain);
    for (int d = 0; d < in->drop_count; d++) {
        const sf_fit_drop *drop = &in->drop[d];
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) { /* which must be defined */
            bool known = !isnan(drop->value[kind]);
            hash = sf_hash_identity(hash, &known, sizeof known);
        }
        hash = sf_hash_identity(hash, &drop->samples, sizeof drop->samples);
        hash = sf_hash_identity(hash, &drop->sample_scale, sizeof drop->sample_scale);
        hash = sf_hash_identity(hash, &drop->sample_class, sizeof drop->sample_class);
        hash = sf_hash_identity(hash, drop->sample_time, (size_t)drop->samples * sizeof *drop->sample_time);
    }
    return hash;
}

sf_status sf_drop_fit_list(sf_drop_fit *fit, sf_error *err) {
    const sf_fit_input *in = fit->input;
    fit->row[0] = in->joint.rows;
    for (int d = 0; d < in->drop_count; d++) {
        fit->row[d + 1] = fit->row[d] + SF_FIT_SAMPLES + in->drop[d].samples + 1;
        fit->measured_drops += !in->drop[d].predicted;
    }
    fit->parameters = in->unknown_count;
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++)
        fit->chain[k] = in->chain_sd[k] > 0 ? fit->parameters++ : -1;
    for (int d = 0; d < in->drop_count; d++)
        fit->speed[d] = in->drop[d].speed_sd > 0 ? fit->parameters++ : -1;
    unsigned long n = (unsigned long)fit->row[in->drop_count];
    SF_TRY(SF_ALLOC_ALL(err, "responses", SF_ROOM(fit->gradient, n * (unsigned long)fit->parameters),
                        SF_ROOM(fit->y, 6 * n)));
    fit->measured = fit->y + n;
    fit->sd = fit->measured + n;
    fit->without = fit->sd + n;
    fit->response_sd = fit->without + n;
    fit->bound_sd = fit->response_sd + n;
    sf_joint_data(&in->joint, fit->measured, fit->sd);
    for (unsigned long k = 0; k < n; k++)
        fit->bound_sd[k] = INFINITY;
    for (int d = 0; d < in->drop_count; d++) {
        const sf_fit_drop *drop = &in->drop[d];
        double *measured = &fit->measured[fit->row[d]], *sd = &fit->sd[fit->row[d]];
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            bool known = !isnan(drop->value[kind]);
            measured[kind] = known ? log(drop->value[kind]) : 0;
            sd[kind] = known ? drop->sd[kind] : INFINITY;
        }
        for (int k = 0; k < drop->samples; k++) {
            measured[SF_FIT_SAMPLES + k] = drop->sample_value[k] / drop->sample_scale;
            sd[SF_FIT_SAMPLES + k] = drop->sample_sd;
        }
        int bound = SF_FIT_SAMPLES + drop->samples;
        measured[bound] = log(BOUND * sf_good_run_rule_get(SF_CHECK_anvil)->refuse);
        sd[bound] = INFINITY;
        fit->bound_sd[fit->row[d] + bound] = BOUND_SD;
    }
    fit->inputs = fit->memory ? hash_inputs(fit) : 0;
    return SF_OK;
}

static uint64_t hash_columns(uint64_t hash, const sf_columns *c) {
    const double missile[] = {c->mass, c->speed, c->thickness};
    hash = sf_hash_identity(hash, missile, sizeof missile);
    hash = sf_hash_identity(hash, &c->count, sizeof c->count);
    hash = sf_hash_identity(hash, c->pause, (size_t)c->before * sizeof *c->pause);
    hash = sf_hash_identity(hash, c->area, (size_t)c->count * sizeof *c->area);
    return sf_hash_identity(hash, c->gap, (size_t)c->count * sizeof *c->gap);
}

/* Key of the responses of drops `first` to `last` - 1; 0 without a memory. */
static uint64_t key_of(const sf_drop_fit *fit, int first, int last, int bin, const double *u) {
    const int which[] = {first, last, bin, fit->parameters, fit->rigid};
    if (!fit->memory)
        return 0;
    uint64_t hash = sf_hash_identity(fit->inputs, which, sizeof which);
    hash = sf_hash_identity(hash, u, (size_t)fit->parameters * sizeof *u);
    hash = sf_hash_identity(hash, &fit->speed[first], (size_t)(last - first) * sizeof *fit->speed);
    for (int d = first; d < last; d++)
        hash = hash_columns(hash, &fit->columns[d]);
    return hash;
}

/* Raises the stress by a hat over one bin. */
static void raise_curve(int bin, sf_foam_card *card) {
    for (int64_t k = 0; k < card->curve_points && bin >= 0; k++) {
        double away = fabs(card->curve_strain[k] - (bin + 0.5) * SF_FIT_BIN_WIDTH) / SF_FIT_BIN_WIDTH;
        card->curve_stress[k] *= 1 + SF_FIT_RAISE * fmax(0, 1 - away);
    }
}

sf_status sf_drop_fit_columns(const sf_drop_fit *fit, int first, int last, int bin, const double *u,
                              double *y, sf_error *err) {
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    bool given = bin == SF_FIT_AS_GIVEN;
    int begin = first == 0 ? 0 : fit->row[first]; /* the joint data stand before the first drop */
    size_t count = (size_t)(fit->row[last] - begin);
    uint64_t key = key_of(fit, first, last, bin, u);
    if (sf_fit_memory_find(fit->memory, key, count, &y[begin]))
        return SF_OK;
    SF_TRY(sf_drop_fit_card(fit->input, u, &card, err));
    if (!given) {
        SF_TRY(sf_foam_card_resample(&card, err));
        raise_curve(bin, &card);
    }
    SF_TRY(sf_drop_fit_respond(fit, first, last, &card, given ? u : NULL, y, err));
    sf_fit_memory_add(fit->memory, key, count, &y[begin]);
    return SF_OK;
}

/* ---- the cache ---- */

/* Largest size of the file, which each run reads as a whole. */
static const size_t LARGEST = (size_t)1 << 28;

typedef struct head {
    uint64_t key, count;
} head;

enum { FRAME = sizeof(head) + sizeof(uint64_t) /* bytes of a record beside its values */ };

static head head_at(const char *record) {
    head h;
    memcpy(&h, record, sizeof h);
    return h;
}

/* Bytes of the record that begins here; 0: it is not whole. */
static size_t measure(const char *record, size_t left) {
    uint64_t hash;
    if (left < FRAME || head_at(record).count > (left - FRAME) / sizeof(double))
        return 0;
    size_t length = sizeof(head) + (size_t)head_at(record).count * sizeof(double);
    memcpy(&hash, record + length, sizeof hash);
    return hash == sf_hash_identity(SF_HASH_START, record, length) ? length + sizeof hash : 0;
}

/* Opened and locked; -1 on failure. */
static int open_locked(const char *path) {
    FILE *made = sf_replace_exists(path) ? NULL : sf_replace_create(path, SF_IGNORED);
    if (made)
        fclose(made);
    int file = sf_replace_reopen(path);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

void sf_fit_memory_open(const char *path, sf_fit_memory *m) {
    char program[PATH_MAX];
    sf_error err = SF_ERROR_INIT;
    size_t size = 0, length;
    *m = (sf_fit_memory){.file = -1};
    if (sf_process_find("softfall-fit", program, sizeof program, &err) != SF_OK ||
        sf_plain_hash(program, NULL, SF_PLAIN_ANY, &m->program, &err) != SF_OK ||
        (m->file = open_locked(path)) < 0)
        return;
    if (sf_plain_read(path, NULL, LARGEST, &m->text, &size, &err) != SF_OK) {
        sf_fit_memory_close(m);
        return;
    }
    while ((length = measure(m->text + m->size, size - m->size)) != 0)
        m->size += length;
    m->end = m->size;
}

void sf_fit_memory_close(sf_fit_memory *m) {
    if (m->file >= 0)
        close(m->file);
    free(m->text);
    *m = (sf_fit_memory){.file = -1};
}

bool sf_fit_memory_find(sf_fit_memory *m, uint64_t key, size_t count, double *value) {
    size_t at = m ? m->next : 0, length;
    for (size_t seen = 0; m && seen < m->size; seen += length, at += length) {
        if (at == m->size)
            at = 0;
        head h = head_at(m->text + at);
        length = FRAME + (size_t)h.count * sizeof *value;
        if (h.key == key && h.count == count) {
            memcpy(value, m->text + at + sizeof h, count * sizeof *value);
            m->next = at + length;
            return true;
        }
    }
    return false;
}

void sf_fit_memory_add(sf_fit_memory *m, uint64_t key, size_t count, const double *value) {
    size_t length = sizeof(head) + count * sizeof *value, size = length + sizeof key;
    if (!m || m->file < 0 || size > LARGEST - m->end)
        return;
    SF_OWNED char *record = sf_alloc(SF_IGNORED, 1, size, "record");
    if (record) {
        const head h = {key, count};
        memcpy(record, &h, sizeof h);
        memcpy(record + sizeof h, value, count * sizeof *value);
        uint64_t hash = sf_hash_identity(SF_HASH_START, record, length);
        memcpy(record + length, &hash, sizeof hash);
    }
    if (record && pwrite(m->file, record, size, (off_t)m->end) == (ssize_t)size) {
        m->end += size;
    } else {
        close(m->file);
        m->file = -1;
    }
}

double sf_drop_fit_scatter(const sf_drop_fit *fit, int d, int kind) {
    return kind == SF_FIT_A_MAX || kind == SF_FIT_HIC ? fit->simulated[d].scatter[kind == SF_FIT_HIC] : NAN;
}
