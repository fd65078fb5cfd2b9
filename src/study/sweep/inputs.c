/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/inputs.h"

#include "study/run_folder.h"
#include "base/hash.h"
#include "pre/mesh/geo_parameters.h"
#include <stdlib.h>
#include <string.h>

sf_status sf_sweep_read_case(const sf_plan *plan, int64_t row, sf_case *c, sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    const char *list[SF_RUNNER_OVERRIDES];
    int count = sf_plan_overrides(plan, row, text);
    for (int k = 0; k < count; k++)
        list[k] = text[k];
    return sf_case_read(plan->case_path, count, list, NULL, c, err);
}

/* True if an entry of `set` alone gives this sentence. */
static bool is_of_set(const sf_plan *p, const char *sentence) {
    bool found = false;
    for (int k = 0; k < p->set_count && !found; k++) {
        char text[SF_SWEEP_OVERRIDE_SIZE];
        const char *const list[] = {text};
        sf_case c;
        sf_error err = SF_ERROR_INIT;
        sf_plan_set(p, k, text);
        if (sf_case_read(p->case_path, 1, list, NULL, &c, &err) == SF_OK)
            sf_case_free(&c);
        found = strcmp(err.text, sentence) == 0;
    }
    return found;
}

/* Enters the key of a row, which is 0 if its case is refused, into the hash. The sentence names the line of
 * the factor, or of `set`. */
static sf_status check(const sf_plan *p, int64_t row, const sf_factor *f, uint64_t *hash, uint64_t *own,
                       sf_error *err) {
    sf_case c;
    sf_error inner = SF_ERROR_INIT;
    *own = 0;
    if (sf_sweep_read_case(p, row, &c, &inner) == SF_OK) {
        if (sf_geo_parameters_check_alone(&c.pad, &inner) == SF_OK &&
            sf_geo_parameters_check_alone(&c.missile, &inner) == SF_OK)
            sf_campaign_key(&c, own, &inner);
        sf_case_free(&c);
    }
    *hash = sf_hash_bytes(*hash, own, sizeof *own);
    if (inner.status == SF_OK)
        return SF_OK;
    return SF_FAIL(err, inner.status, "%s: %.900s", is_of_set(p, inner.text) ? p->set_where : f->where,
                   inner.text);
}

/* Rows that the plan has: what stands beside a value in a zip or a sample belongs to it. All other blocks are
 * at their first value. */
static sf_status check_extremes(const sf_plan *p, int factor, uint64_t *hash, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    int64_t least = 0, greatest = 0;
    for (int64_t k = 1; k < b->rows; k++) {
        least = f->value[k] < f->value[least] ? k : least;
        greatest = f->value[k] > f->value[greatest] ? k : greatest;
    }
    uint64_t key;
    SF_TRY(check(p, least * b->stride, f, hash, &key, err));
    return check(p, greatest * b->stride, f, hash, &key, err);
}

static size_t folder_length(const char *path) {
    const char *last = strrchr(path, '/');
    return last ? (size_t)(last - path) : 0;
}

static bool is_same_folder(const char *a, const char *b) {
    return folder_length(a) == folder_length(b) && strncmp(a, b, folder_length(a)) == 0;
}

/* The key of a run knows a geometry by its own text; what that merges lies beside it. */
static sf_status refuse_double(const sf_factor *f, const uint64_t *key, int64_t k, sf_error *err) {
    for (int64_t i = 0; i < k && strncmp(f->key, "geometry.", 9) == 0; i++)
        if (key[i] == key[k] && !is_same_folder(f->text[i], f->text[k]))
            return SF_FAIL(err, SF_ERR_INPUT, "%s: %.300s and %.300s have " SF_CAMPAIGN_SAME_TEXT, f->where,
                           f->label[i], f->label[k]);
    return SF_OK;
}

static sf_status check_words(const sf_plan *p, int factor, uint64_t *hash, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    uint64_t *key = sf_alloc(err, (unsigned long)f->count, sizeof *key, "keys");
    for (int64_t k = 0; k < f->count && err->status == SF_OK; k++) {
        int64_t row = 0;
        while (row < b->rows && f->value[row] != (double)k)
            row++;
        if (row < b->rows && check(p, row * b->stride, f, hash, &key[k], err) == SF_OK) /* or never drawn */
            refuse_double(f, key, k, err);
    }
    free(key);
    return err->status;
}

sf_status sf_sweep_check_inputs(const sf_plan *p, uint64_t *hash, sf_error *err) {
    *hash = SF_HASH_START;
    for (int f = 0; f < p->factor_count && err->status == SF_OK; f++) {
        if (p->factor[f].words)
            check_words(p, f, hash, err);
        else
            check_extremes(p, f, hash, err);
    }
    return err->status;
}
