/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sweep/inputs.h"

#include "campaign/key.h"
#include "core/hash.h"
#include "pre/mesh/geo_parameters.h"
#include <string.h>

/* A row of the plan in which one factor has another value. */
typedef struct variant {
    const sf_plan *plan;
    int64_t row;
    int factor; /* -1: none */
    double value;
} variant;

static sf_status read_variant(const variant *v, sf_case *c, sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    const char *list[SF_RUNNER_OVERRIDES];
    int count = sf_plan_overrides(v->plan, v->row, text);
    for (int k = 0; k < count; k++) {
        const sf_factor *f = v->factor >= 0 ? &v->plan->factor[v->factor] : NULL;
        size_t length = f ? strlen(f->key) : 0;
        if (f && strncmp(text[k], f->key, length) == 0 && text[k][length] == '=')
            sf_factor_override(f, v->value, text[k], sizeof text[k]);
        list[k] = text[k];
    }
    return sf_case_read(v->plan->case_path, count, list, NULL, c, err);
}

sf_status sf_sweep_read_case(const sf_plan *plan, int64_t row, sf_case *c, sf_error *err) {
    const variant v = {plan, row, -1, 0};
    return read_variant(&v, c, err);
}

static sf_status check(const variant *v, uint64_t *hash, sf_error *err) {
    sf_case c;
    sf_error inner = SF_ERROR_INIT;
    uint64_t key = 0;
    if (read_variant(v, &c, &inner) == SF_OK) {
        if (sf_geo_parameters_check_alone(&c.pad, &inner) == SF_OK &&
            sf_geo_parameters_check_alone(&c.missile, &inner) == SF_OK)
            sf_campaign_key(&c, &key, &inner);
        sf_case_free(&c);
    }
    *hash = sf_hash_bytes(*hash, &key, sizeof key);
    if (inner.status == SF_OK)
        return SF_OK;
    return SF_FAIL(err, inner.status, "%s: %.900s",
                   v->factor >= 0 ? v->plan->factor[v->factor].where : v->plan->path, inner.text);
}

static sf_status check_extremes(const sf_plan *p, int factor, uint64_t *hash, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    double low = f->value[0], high = f->value[0];
    for (int64_t k = 1; k < b->rows; k++) {
        low = f->value[k] < low ? f->value[k] : low;
        high = f->value[k] > high ? f->value[k] : high;
    }
    const variant least = {p, 0, factor, low}, greatest = {p, 0, factor, high};
    return check(&least, hash, err) == SF_OK ? check(&greatest, hash, err) : err->status;
}

sf_status sf_sweep_check_inputs(const sf_plan *p, uint64_t *hash, sf_error *err) {
    *hash = SF_HASH_START;
    for (int f = 0; f < p->factor_count && err->status == SF_OK; f++) {
        const sf_factor *factor = &p->factor[f];
        for (int64_t k = 0; k < factor->count && factor->words && err->status == SF_OK; k++) {
            const variant v = {p, 0, f, (double)k};
            check(&v, hash, err);
        }
        if (!factor->words)
            check_extremes(p, f, hash, err);
    }
    return err->status;
}
