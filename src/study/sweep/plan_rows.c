/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/plan.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "pre/mesh/geo_parameters.h"
#include "pre/steps.h"

/* Parameters of the geometry that are doubled. */
static const char *const spacings[SF_SWEEP_DOUBLED - 1] = {"fine_spacing", "outer_spacing", "spacing"};
/* The largest expected error of a_max of a doubled mesh: that of two spacings across the thickness. */
static const double COARSEST = SF_MESH_ERROR_THICKNESS / 4;

/* ---- values and overrides ---- */

double sf_plan_value(const sf_plan *p, int factor, int64_t row) {
    const sf_block *b = &p->block[p->block_of[factor]];
    return p->factor[factor].value[row / b->stride % b->rows];
}

/* True if the overrides of this factor replace a whole group; they come first. */
static bool is_group(const sf_factor *f) {
    return f->words && f->text[0][0] == '@';
}

/* A file in place of a group is relative to the plan. */
static void set_override(const sf_plan *p, int k, char *text) {
    const char *set = p->set[k];
    const char *file = sf_case_override_file(set);
    if (file && *file != '/')
        snprintf(text, SF_SWEEP_OVERRIDE_SIZE, "%.*s%s/%s", (int)(file - set), set, p->folder, file);
    else
        snprintf(text, SF_SWEEP_OVERRIDE_SIZE, "%s", set);
}

static sf_status read_case(const sf_plan *p, int count, char (*text)[SF_SWEEP_OVERRIDE_SIZE], sf_case *c,
                           sf_error *err) {
    const char *list[SF_RUNNER_OVERRIDES];
    for (int k = 0; k < count; k++)
        list[k] = text[k];
    return sf_case_read(p->case_path, count, list, NULL, c, err);
}

/* Returns the parameter of that name, NULL if the case does not give it. */
static const sf_geo_parameter *find_parameter(const sf_geo_source *source, const char *name) {
    for (int k = 0; k < source->parameter_count; k++)
        if (strcmp(source->parameter[k].name, name) == 0)
            return &source->parameter[k];
    return NULL;
}

/* Appends the doubled spacings of the case that the overrides give; of one that is refused none. */
static int add_spacings(const sf_plan *p, int count, char (*text)[SF_SWEEP_OVERRIDE_SIZE]) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error refused = SF_ERROR_INIT;
    read_case(p, count, text, &c, &refused);
    snprintf(text[count++], SF_SWEEP_OVERRIDE_SIZE, "pad.mesh_error_limit=%g", COARSEST);
    for (int k = 0; k < SF_SWEEP_DOUBLED - 1; k++) {
        const sf_geo_parameter *spacing = find_parameter(&c.pad, spacings[k]);
        if (spacing)
            snprintf(text[count++], SF_SWEEP_OVERRIDE_SIZE, "geometry.parameters.%s=%.15g", spacings[k],
                     SF_SWEEP_RATIO * spacing->value);
    }
    return count;
}

int sf_plan_overrides(const sf_plan *p, int64_t row, char (*text)[SF_SWEEP_OVERRIDE_SIZE]) {
    int count = 0;
    for (int groups = 1; groups >= 0; groups--) {
        for (int f = 0; f < p->factor_count; f++)
            if (is_group(&p->factor[f]) == groups)
                sf_factor_override(&p->factor[f], sf_plan_value(p, f, row), text[count++],
                                   SF_SWEEP_OVERRIDE_SIZE);
        for (int k = 0; groups && k < p->set_count; k++)
            set_override(p, k, text[count++]);
    }
    return p->doubled ? add_spacings(p, count, text) : count;
}

uint64_t sf_plan_hash(const sf_plan *p) {
    uint64_t hash = sf_hash_bytes(SF_HASH_START, &p->rows, sizeof p->rows);
    hash = p->doubled ? sf_hash_bytes(hash, spacings[0], strlen(spacings[0])) : hash;
    for (int k = 0; k < p->set_count; k++)
        hash = sf_hash_bytes(hash, p->set[k], strlen(p->set[k]) + 1);
    for (int f = 0; f < p->factor_count; f++) {
        const sf_factor *factor = &p->factor[f];
        const sf_block *b = &p->block[p->block_of[f]];
        hash = sf_hash_bytes(hash, factor->key, strlen(factor->key) + 1);
        hash = sf_hash_bytes(hash, factor->unit, strlen(factor->unit) + 1);
        hash = sf_hash_bytes(hash, factor->name, strlen(factor->name) + 1);
        hash = sf_hash_bytes(hash, &b->stride, sizeof b->stride);
        hash = sf_hash_bytes(hash, factor->value, (size_t)b->rows * sizeof *factor->value);
        for (int64_t k = 0; factor->words && k < factor->count; k++)
            hash = sf_hash_bytes(hash, factor->label[k], strlen(factor->label[k]) + 1);
    }
    return hash;
}

bool sf_plan_is_adaptive(const sf_plan *p) {
    return p->figure[0].accuracy > 0;
}

const sf_block *sf_plan_saltelli(const sf_plan *p) {
    for (int k = 0; k < p->block_count; k++)
        if (p->block[k].kind == SF_BLOCK_SAMPLE && p->block[k].method == SF_SAMPLING_SALTELLI)
            return &p->block[k];
    return NULL;
}

/* ---- inputs of the rows ---- */

sf_status sf_sweep_read_case(const sf_plan *plan, int64_t row, sf_case *c, sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    return read_case(plan, sf_plan_overrides(plan, row, text), text, c, err);
}

/* True if an entry of `set` alone gives this sentence. */
static bool is_of_set(const sf_plan *p, const char *sentence) {
    bool found = false;
    for (int k = 0; k < p->set_count && !found; k++) {
        char text[SF_SWEEP_OVERRIDE_SIZE];
        const char *const list[] = {text};
        SF_OWNED_BY(sf_case_free) sf_case c = {0};
        sf_error err = SF_ERROR_INIT;
        set_override(p, k, text);
        sf_case_read(p->case_path, 1, list, NULL, &c, &err);
        found = strcmp(err.text, sentence) == 0;
    }
    return found;
}

/* Refuses a case that leaves a spacing, which is to be doubled, to its geometry, or has none. */
static sf_status check_spacings(const sf_case *c, sf_error *err) {
    sf_geo_source alone = {.path = c->pad.path, .parameter_count = 1};
    int given = 0;
    for (int k = 0; k < SF_SWEEP_DOUBLED - 1; k++) {
        sf_error missing = SF_ERROR_INIT;
        snprintf(alone.parameter[0].name, sizeof alone.parameter[0].name, "%s", spacings[k]);
        given += find_parameter(&c->pad, spacings[k]) != NULL;
        if (!find_parameter(&c->pad, spacings[k]) &&
            sf_geo_parameters_check(&alone, NULL, false, &missing) == SF_OK)
            return SF_REFUSE(err, "refine doubles geometry.parameters.%s: give it in the case", spacings[k]);
    }
    return given > 0 ? SF_OK
                     : SF_REFUSE(err, "refine doubles spacings in geometry.parameters: there are none");
}

/* Enters the key of a row, which is 0 if its case is refused, into the hash. The sentence names the line of
 * the factor, or of `set`. */
static sf_status check(const sf_plan *p, int64_t row, const sf_factor *f, uint64_t *hash, uint64_t *own,
                       sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error inner = SF_ERROR_INIT;
    *own = 0;
    sf_sweep_read_case(p, row, &c, &inner);
    for (int k = 0; k < SF_GEOMETRIES && inner.status == SF_OK; k++)
        sf_geo_parameters_check_alone(sf_campaign_geometry(&c, k), &inner);
    if (inner.status == SF_OK && c.drops > 1 && (sf_plan_is_adaptive(p) || p->refine))
        SF_REFUSE(&inner, "series.drops = %g: only first drops are %s out", c.drops,
                  p->refine ? "refined; leave `refine`" : "predicted; leave `accuracy`");
    if (inner.status == SF_OK && p->refine)
        check_spacings(&c, &inner);
    if (inner.status == SF_OK)
        sf_campaign_key(&c, own, &inner);
    *hash = sf_hash_bytes(*hash, own, sizeof *own);
    *hash = c.counted > 1 ? sf_hash_bytes(*hash, &c.counted, sizeof c.counted) : *hash;
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

static bool is_same_folder(const char *a, const char *b) {
    size_t length = sf_path_folder_length(a);
    return length == sf_path_folder_length(b) && strncmp(a, b, length) == 0;
}

/* The key of a run knows a geometry by its own text; what that merges lies beside it. */
static sf_status refuse_double(const sf_factor *f, const uint64_t *key, int64_t k, sf_error *err) {
    for (int64_t i = 0; i < k && strncmp(f->key, "geometry.", 9) == 0; i++)
        if (key[i] == key[k] && !is_same_folder(f->text[i], f->text[k]))
            return SF_REFUSE(err, "%s: %.300s and %.300s have " SF_CAMPAIGN_SAME_TEXT, f->where, f->label[i],
                             f->label[k]);
    return SF_OK;
}

static sf_status check_words(const sf_plan *p, int factor, uint64_t *hash, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    SF_OWNED uint64_t *key = sf_alloc(err, (unsigned long)f->count, sizeof *key, "keys");
    for (int64_t k = 0; k < f->count && err->status == SF_OK; k++) {
        int64_t row = 0;
        while (row < b->rows && f->value[row] != (double)k)
            row++;
        if (row < b->rows && check(p, row * b->stride, f, hash, &key[k], err) == SF_OK) /* or never drawn */
            refuse_double(f, key, k, err);
    }
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
