/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/plan.h"

#include "base/hash.h"
#include "base/text.h"
#include "case/read.h"
#include "io/plain_file.h"
#include "pre/mesh/geo_parameters.h"
#include <gsl/gsl_statistics.h>

#define SPACING_FACTOR "geometry.spacing_factor"
#define ERROR_LIMIT "pad.mesh_error_limit"
#define IS_OF_REFINE " is set by `refine`, for the coarse drops: leave it out"
enum { MOST_SAMPLES = 100000000, REFINE_CHANGES = 2 };
static const double COARSE_PART = 0.5; /* of the accuracies: their error is a part of that of the rows */
#define SETS_ITSELF "%s has no effect in a campaign, which keeps the curve of a run and none of its fields"

/* ---- blocks ---- */

/* True if the table has a column of this name beside the factors. */
static bool is_column(const char *name) {
    return sf_word_find("id|run_status|grade|message|folder", name) >= 0 || sf_figure_find(name);
}

static sf_status add_factor(const sf_config *config, const config_setting_t *group, bool sampled, sf_plan *p,
                            sf_error *err) {
    if (p->factor_count == SF_SWEEP_FACTORS)
        return sf_config_refuse(config, group, err, "more than %d factors", SF_SWEEP_FACTORS);
    p->block_of[p->factor_count] = p->block_count;
    sf_factor *f = &p->factor[p->factor_count++];
    SF_TRY(sf_factor_read(config, group, sampled, f, err));
    if (is_column(f->name))
        return sf_config_refuse(config, group, err,
                                "\"%s\" is a column of runs.csv already: give the factor another name",
                                f->name);
    if (sf_runner_sets_key(f->key))
        return sf_config_refuse(config, group, err, SETS_ITSELF, f->key);
    if (config_lookup(&config->config, "refine") &&
        (strcmp(f->key, SPACING_FACTOR) == 0 || strcmp(f->key, ERROR_LIMIT) == 0))
        return sf_config_refuse(config, group, err, "%s" IS_OF_REFINE, f->key);
    for (int k = 0; k < p->factor_count - 1; k++) {
        const sf_factor *other = &p->factor[k];
        if (strcmp(other->key, f->key) == 0)
            return sf_config_refuse(config, group, err, "%s is a factor already, at %s", f->key,
                                    other->where);
        if (strcmp(other->name, f->name) == 0)
            return sf_config_refuse(config, group, err, "two factors have the name \"%s\"", f->name);
    }
    return SF_OK;
}

static sf_status add_members(const sf_config *config, const config_setting_t *list, bool sampled, sf_plan *p,
                             sf_error *err) {
    for (int k = 0; k < config_setting_length(list) && err->status == SF_OK; k++)
        add_factor(config, config_setting_get_elem(list, (unsigned)k), sampled, p, err);
    return err->status;
}

/* A word that the list repeats, as that of a zip may, is one level. */
static void number_words(sf_factor *f) {
    int64_t kept = 0;
    for (int64_t k = 0; k < f->count; k++) {
        char *text = f->text[k], *label = f->label[k];
        int64_t level = 0;
        f->text[k] = f->label[k] = NULL;
        while (level < kept && strcmp(f->text[level], text) != 0)
            level++;
        f->value[k] = (double)level;
        if (level < kept) {
            SF_FREE(text, label);
        } else {
            f->text[kept] = text;
            f->label[kept++] = label;
        }
    }
    f->count = kept;
}

static sf_status copy_levels(sf_factor *f, sf_error *err) {
    f->value = sf_alloc(err, f->count, sizeof *f->value, "the values of a factor");
    SF_TRY(err->status);
    for (int64_t k = 0; k < f->count && !f->words; k++)
        f->value[k] = f->number[k];
    if (f->words)
        number_words(f);
    return SF_OK;
}

static sf_status read_list_block(const sf_config *config, const config_setting_t *group, sf_plan *p,
                                 sf_block *b, sf_error *err) {
    SF_TRY(add_factor(config, group, false, p, err));
    b->rows = p->factor[b->first].count;
    return copy_levels(&p->factor[b->first], err);
}

static sf_status read_zip(const sf_config *config, const config_setting_t *group, sf_plan *p, sf_block *b,
                          sf_error *err) {
    const config_setting_t *list = NULL;
    b->kind = SF_BLOCK_ZIP;
    SF_TRY(sf_config_names(config, group, "zip", err));
    SF_TRY(sf_config_list(config, group, "zip", true, SF_SWEEP_FACTORS, &list, err));
    SF_TRY(add_members(config, list, false, p, err));
    b->rows = p->factor[b->first].count;
    for (int k = b->first; k < p->factor_count; k++) {
        const sf_factor *f = &p->factor[k];
        if (f->count != b->rows)
            return sf_config_refuse(config, list, err,
                                    "zip: %s has %lld values and %s %lld; the lists must have one length",
                                    p->factor[b->first].key, b->rows, f->key, f->count);
        if (f->uncertain != p->factor[b->first].uncertain)
            return sf_config_refuse(config, list, err,
                                    "zip: one of %s and %s is chosen and the other uncertain, so that no "
                                    "probability belongs to a choice: give the chosen one uncertain = true, "
                                    "or cross them",
                                    p->factor[b->first].key, f->key);
        SF_TRY(copy_levels(&p->factor[k], err));
    }
    return SF_OK;
}

/* Samples the unit cube, and maps it to the values of the factors. */
static sf_status draw(const sf_config *config, const config_setting_t *group, sf_plan *p, sf_block *b,
                      sf_error *err) {
    int d = p->factor_count - b->first;
    sf_error inner = SF_ERROR_INIT;
    b->rows = sf_sample_rows(b->method, d, b->samples);
    SF_OWNED double *u = sf_alloc(err, b->rows, (unsigned long)d * sizeof *u, "samples");
    if (u && sf_sample(b->method, d, b->samples, b->seed, u, &inner) != SF_OK)
        sf_config_refuse(config, group, err, "%s", inner.text);
    for (int i = 0; i < d && err->status == SF_OK; i++) {
        sf_factor *f = &p->factor[b->first + i];
        f->value = sf_alloc(err, b->rows, sizeof *f->value, "the values of a factor");
        for (int64_t k = 0; k < b->rows && f->value; k++)
            f->value[k] = sf_factor_quantile(f, u[k * d + i]);
    }
    return err->status;
}

static sf_status read_sample(const sf_config *config, const config_setting_t *group, bool huge, sf_plan *p,
                             sf_block *b, sf_error *err) {
    const config_setting_t *list = NULL;
    int method = 0;
    double count = 0, seed = 1;
    b->kind = SF_BLOCK_SAMPLE;
    SF_TRY(sf_config_names(config, group, "sample|count|seed|of", err));
    SF_TRY(sf_config_choice(config, group, "sample", SF_SAMPLING_WORDS, &method, err));
    SF_TRY(sf_config_whole(config, group, "count", true, 1, MOST_SAMPLES, &count, err));
    SF_TRY(sf_config_whole(config, group, "seed", false, 0, 4294967295.0, &seed, err));
    SF_TRY(sf_config_list(config, group, "of", true, SF_SWEEP_FACTORS, &list, err));
    SF_TRY(add_members(config, list, true, p, err));
    if ((sf_sampling)method == SF_SAMPLING_SALTELLI && count < SF_INDEX_LEAST)
        return sf_config_refuse(config, config_setting_get_member(group, "count"), err,
                                "count: Sobol' indices need %d samples, and some hundreds to tell anything",
                                SF_INDEX_LEAST);
    b->method = (sf_sampling)method;
    b->samples = (int64_t)count;
    b->seed = (uint64_t)seed;
    if (!huge && sf_sample_rows(b->method, p->factor_count - b->first, b->samples) > SF_SWEEP_ROWS)
        return sf_config_refuse(config, group, err,
                                "the sample has more than %d rows: give --yes if it is meant", SF_SWEEP_ROWS);
    return draw(config, group, p, b, err);
}

static sf_status read_block(const sf_config *config, const config_setting_t *group, bool huge, sf_plan *p,
                            sf_error *err) {
    sf_block *b = &p->block[p->block_count];
    *b = (sf_block){.first = p->factor_count};
    if (config_setting_get_member(group, "zip"))
        read_zip(config, group, p, b, err);
    else if (config_setting_get_member(group, "sample"))
        read_sample(config, group, huge, p, b, err);
    else
        read_list_block(config, group, p, b, err);
    b->count = p->factor_count - b->first;
    p->block_count++;
    return err->status;
}

/* ---- the product ---- */

static sf_status multiply(const sf_config *config, const config_setting_t *list, bool huge, sf_plan *p,
                          sf_error *err) {
    double product = 1;
    p->rows = 1;
    for (int k = 0; k < p->block_count; k++)
        product *= (double)p->block[k].rows;
    if (product > SF_SWEEP_ROWS && !huge)
        return sf_config_refuse(config, list, err,
                                "the plan has %.0f runs, more than %d: give --yes if it is meant", product,
                                SF_SWEEP_ROWS);
    if (product > MOST_SAMPLES)
        return sf_config_refuse(config, list, err, "the plan has %.3g runs" SF_AT_MOST("%d"), product,
                                MOST_SAMPLES);
    for (int k = p->block_count - 1; k >= 0; k--) {
        p->block[k].stride = p->rows;
        p->rows *= p->block[k].rows;
    }
    const sf_block *s = sf_plan_saltelli(p);
    if (s && p->block_count > 1)
        return sf_config_refuse(config, list, err,
                                "a sample for Sobol' indices (saltelli) stands alone: move the "
                                "other factors into it, or make a plan for each of their values");
    return SF_OK;
}

static sf_status read_factors(const sf_config *config, bool huge, sf_plan *p, sf_error *err) {
    const config_setting_t *root = config_root_setting(&config->config), *list = NULL;
    SF_TRY(sf_config_list(config, root, "factors", true, SF_SWEEP_FACTORS, &list, err));
    for (int k = 0; k < config_setting_length(list) && err->status == SF_OK; k++)
        read_block(config, config_setting_get_elem(list, (unsigned)k), huge, p, err);
    return err->status == SF_OK ? multiply(config, list, huge, p, err) : err->status;
}

/* ---- the rest ---- */

/* The key of an override, without blanks. */
static void key_of(const char *set, char *key, size_t size) {
    set += strspn(set, " \t");
    snprintf(key, size, "%.*s", (int)strcspn(set, " \t="), set);
}

/* Appends the overrides of the list `name`, "set" or "coarse". */
static sf_status read_set(const sf_config *config, const char *name, sf_plan *p, sf_error *err) {
    const config_setting_t *list = config_lookup(&config->config, name);
    int first = p->set_count;
    int most = SF_RUNNER_OVERRIDES - (config_lookup(&config->config, "refine") ? REFINE_CHANGES : 0);
    sf_config_place(config, list, p->set_where, sizeof p->set_where);
    SF_TRY(sf_config_overrides(config, name, SF_RUNNER_OVERRIDES - first, p->set, &p->set_count, err));
    if (p->set_count + p->factor_count > most)
        return sf_config_refuse(config, list, err, "%s and the factors change more than %d keys", name, most);
    for (int k = first; k < p->set_count; k++) {
        const config_setting_t *s = config_setting_get_elem(list, (unsigned)(k - first));
        char key[SF_FACTOR_KEY_SIZE];
        key_of(p->set[k], key, sizeof key);
        if (sf_runner_sets_key(key))
            return sf_config_refuse(config, s, err, "%s: " SETS_ITSELF, name, key);
        for (int f = 0; f < p->factor_count; f++)
            if (strcmp(p->factor[f].key, key) == 0)
                return sf_config_refuse(config, s, err, "%s: %s is a factor, at %s", name, key,
                                        p->factor[f].where);
    }
    return SF_OK;
}

/* Reads `refine`, and appends what it changes in the coarse drops: the spacings, and the largest expected
 * error of a_max, that of two spacings across the thickness (SF_MESH_ERROR_THICKNESS). */
static sf_status read_refine(const sf_config *config, bool coarse, sf_plan *p, sf_error *err) {
    static const char *const changes[REFINE_CHANGES] = {SPACING_FACTOR "=2", ERROR_LIMIT "=0.125"};
    const config_setting_t *s = config_lookup(&config->config, "refine");
    int method = 0;
    if (!s)
        return SF_OK;
    SF_TRY(
        sf_config_choice(config, config_root_setting(&config->config), "refine", "richardson", &method, err));
    if (sf_plan_is_adaptive(p))
        return sf_config_refuse(config, s, err,
                                "refine: a row that is predicted has no mesh: leave out the accuracies");
    p->refine = p->coarse = !coarse;
    sf_config_place(config, s, p->refine_where, sizeof p->refine_where);
    for (int k = 0; k < REFINE_CHANGES && coarse; k++)
        if (!(p->set[p->set_count++] = strdup(changes[k])))
            return SF_NO_MEMORY(err, "the plan %s", p->path);
    return SF_OK;
}

static sf_status add_figure(const sf_config *config, const config_setting_t *s, const char *key, double limit,
                            double accuracy, sf_plan *p, sf_error *err) {
    const sf_figure *figure = sf_figure_find(key);
    if (!figure || figure->row.type == SF_ROW_TEXT)
        return sf_config_refuse(config, s, err,
                                "unknown figure \"%.80s\" of summary.json (docs/formats.md lists them)", key);
    if (p->figure_count == SF_SWEEP_FIGURES)
        return sf_config_refuse(config, s, err, "%d figures" SF_AT_MOST("%d"), p->figure_count + 1,
                                SF_SWEEP_FIGURES);
    p->figure[p->figure_count++] = (sf_sweep_limit){figure->row.key, limit, accuracy};
    if ((accuracy > 0) != (p->figure[0].accuracy > 0))
        return sf_config_refuse(
            config, s, err, "accuracy: give it to every figure or to none, as a predicted row has no others");
    return SF_OK;
}

static sf_status read_figures(const sf_config *config, sf_plan *p, sf_error *err) {
    const config_setting_t *list = config_lookup(&config->config, "figures");
    if (!list) {
        p->figure_count = 2;
        p->figure[0] = (sf_sweep_limit){"a_max_g", SF_DEFAULT_LIMIT_G, 0};
        p->figure[1] = (sf_sweep_limit){"hic", SF_DEFAULT_LIMIT_HIC, 0};
        return SF_OK;
    }
    if (!config_setting_is_list(list) || config_setting_length(list) == 0)
        return sf_config_refuse(config, list, err,
                                "figures must be a list: ( { key = \"a_max_g\"; limit = 200.0; } )");
    for (int k = 0; k < config_setting_length(list) && err->status == SF_OK; k++) {
        const config_setting_t *s = config_setting_get_elem(list, (unsigned)k);
        const char *key = NULL;
        double limit = NAN, accuracy = 0;
        if (!config_setting_is_group(s))
            return sf_config_refuse(config, s, err, "figures: each entry must be a group: { ... }");
        if (sf_config_names(config, s, "key|limit|accuracy", err) == SF_OK &&
            sf_config_text(config, s, "key", true, &key, err) == SF_OK &&
            sf_config_number(config, s, "limit", false, -1e300, 1e300, &limit, err) == SF_OK &&
            sf_config_number(config, s, "accuracy", false, 1e-4, 0.5, &accuracy, err) == SF_OK)
            add_figure(config, s, key, limit, accuracy, p, err);
    }
    return err->status;
}

static sf_status read_plan(const sf_config *config, bool huge, bool coarse, sf_plan *p, sf_error *err) {
    const config_setting_t *root = config_root_setting(&config->config);
    const char *title = NULL;
    SF_TRY(sf_config_names(config, root, "case|title|set|coarse|refine|factors|figures", err));
    SF_TRY(sf_config_file(config, root, "case", true, &p->case_path, err));
    SF_TRY(sf_config_text(config, root, "title", false, &title, err));
    SF_TRY(read_factors(config, huge, p, err));
    SF_TRY(read_set(config, "set", p, err));
    if (coarse)
        SF_TRY(read_set(config, "coarse", p, err));
    p->title = title ? strdup(title) : NULL;
    p->folder = strdup(config->folder);
    if (!p->folder)
        return SF_NO_MEMORY(err, "the plan %s", p->path);
    SF_TRY(read_figures(config, p, err));
    const config_setting_t *list = config_lookup(&config->config, "coarse");
    p->coarse = list && !coarse;
    if (list && !sf_plan_is_adaptive(p))
        return sf_config_refuse(
            config, list, err, "coarse drops are for plans that predict rows: give each figure its accuracy");
    for (int k = 0; coarse && k < p->figure_count; k++)
        p->figure[k].accuracy *= COARSE_PART;
    return read_refine(config, coarse, p, err);
}

sf_status sf_plan_read(const char *path, bool huge, bool coarse, sf_plan *p, sf_error *err) {
    SF_OWNED_BY(sf_config_close) sf_config config = {0};
    *p = (sf_plan){.path = path};
    SF_TRY(sf_config_open(path, &config, err));
    return read_plan(&config, huge, coarse, p, err);
}

void sf_plan_free(sf_plan *p) {
    for (int k = 0; k < p->factor_count; k++)
        sf_factor_free(&p->factor[k]);
    sf_free_all((size_t)p->set_count, p->set);
    SF_CLEAR(p, p->folder, p->case_path, p->title);
}

/* ---- rows ---- */

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

int sf_plan_overrides(const sf_plan *p, int64_t row, char (*text)[SF_SWEEP_OVERRIDE_SIZE],
                      const char **list) {
    int count = 0;
    for (int groups = 1; groups >= 0; groups--) {
        for (int f = 0; f < p->factor_count; f++)
            if (is_group(&p->factor[f]) == groups)
                sf_factor_override(&p->factor[f], sf_plan_value(p, f, row), text[count++],
                                   SF_SWEEP_OVERRIDE_SIZE);
        for (int k = 0; groups && k < p->set_count; k++)
            set_override(p, k, text[count++]);
    }
    for (int k = 0; k < count && list; k++)
        list[k] = text[k];
    return count;
}

uint64_t sf_plan_hash(const sf_plan *p) {
    uint64_t hash = sf_hash_bytes(SF_HASH_START, &p->rows, sizeof p->rows);
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
    const char *list[SF_RUNNER_OVERRIDES];
    return sf_case_read(plan->case_path, sf_plan_overrides(plan, row, text, list), list, NULL, c, err);
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

/* Enters the key of a row, which is 0 if its case is refused, into the hash. The sentence names the line of
 * the factor, or of `set`. */
static sf_status check(const sf_plan *p, int64_t row, const sf_factor *f, uint64_t *hash, uint64_t *own,
                       sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    sf_error inner = SF_ERROR_INIT;
    *own = 0;
    sf_sweep_read_case(p, row, &c, &inner);
    for (int k = 0; k < SF_GEOMETRIES && inner.status == SF_OK; k++)
        sf_geo_parameters_check(sf_case_geometry(&c, k), NULL, false, &inner);
    if (inner.status == SF_OK && c.drops > 1 && (sf_plan_is_adaptive(p) || p->refine))
        SF_REFUSE(&inner, "series.drops = %g: only first drops are %s out", c.drops,
                  p->refine ? "refined; leave `refine`" : "predicted; leave `accuracy`");
    if (inner.status == SF_OK && p->refine && c.pad.spacing_factor != 1)
        return SF_REFUSE(err, "%s: " SPACING_FACTOR IS_OF_REFINE, p->refine_where);
    if (inner.status == SF_OK)
        sf_campaign_key(&c, own, &inner);
    *hash = sf_hash_bytes(*hash, own, sizeof *own);
    *hash = c.counted > 1 ? sf_hash_bytes(*hash, &c.counted, sizeof c.counted) : *hash;
    if (inner.status == SF_OK)
        return SF_OK;
    if (!p->refine && *p->refine_where) /* the rows without it were checked before */
        return SF_FAIL(err, inner.status, "%s: refine: %.900s", p->refine_where, inner.text);
    return SF_FAIL(err, inner.status, "%s: %.900s", is_of_set(p, inner.text) ? p->set_where : f->where,
                   inner.text);
}

/* Rows that the plan has: what stands beside a value in a zip or a sample belongs to it. All other blocks are
 * at their first value. */
static sf_status check_extremes(const sf_plan *p, int factor, uint64_t *hash, sf_error *err) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    size_t least, greatest;
    uint64_t key;
    gsl_stats_minmax_index(&least, &greatest, f->value, 1, (size_t)b->rows);
    SF_TRY(check(p, (int64_t)least * b->stride, f, hash, &key, err));
    return check(p, (int64_t)greatest * b->stride, f, hash, &key, err);
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
    SF_OWNED uint64_t *key = sf_alloc(err, f->count, sizeof *key, "keys");
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
    for (int f = 0; f < p->factor_count && err->status == SF_OK; f++)
        if (p->factor[f].words)
            check_words(p, f, hash, err);
        else
            check_extremes(p, f, hash, err);
    return err->status;
}
