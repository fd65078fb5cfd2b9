/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/hyperfoam_request.h"

#include "io/table_csv.h"
#include "material/hyperfoam.h"
#include <stdlib.h>

enum { LAW_HYPERFOAM = 1, LEAST_LATERAL = 6 };
#define LAW_WORDS "low_density_foam|hyperfoam"

sf_status sf_hyperfoam_request_asked(const sf_config *file, const config_setting_t *root, bool *asked,
                                     sf_error *err) {
    int law = 0;
    SF_TRY(sf_config_choice(file, root, "law", LAW_WORDS, &law, err));
    *asked = law == LAW_HYPERFOAM;
    return SF_OK;
}

/* ---- lateral strain ---- */

static sf_status check_lateral(const sf_table_point *p, sf_error *err) {
    if (p->value[0] >= 1 || p->value[1] <= -1 || p->value[1] >= 1)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s and lateral strain %s: both must be between -1 and 1; columns in "
                       "percent are named strain_percent and lateral_strain_percent",
                       p->path, p->line, p->text[0], p->text[1]);
    return SF_OK;
}

static sf_table_layout lateral_layout(void) {
    static const sf_table_name names[] = {{"strain", 0, 1, "1"},
                                          {"strain_percent", 0, 0.01, "%"},
                                          {"lateral_strain", 1, 1, "1"},
                                          {"lateral_strain_percent", 1, 0.01, "%"},
                                          {"transverse_strain", 1, 1, "1"},
                                          {"transverse_strain_percent", 1, 0.01, "%"}};
    return (sf_table_layout){
        .what = "test",
        .column = {"strain", "lateral strain"},
        .wanted = {"\"strain\" or \"strain_percent\"", "\"lateral_strain\" or \"lateral_strain_percent\""},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .check = check_lateral};
}

/* Rows up to the largest strain: loading. Ascending afterwards. */
static sf_status read_lateral(const char *path, sf_hyperfoam_request *data, sf_error *err) {
    const sf_table_layout layout = lateral_layout();
    sf_table table = {0};
    if (sf_table_read(path, &layout, &table, err) != SF_OK)
        return err->status;
    int64_t end = 0;
    for (int64_t i = 1; i < table.count; i++)
        end = table.value[0][i] > table.value[0][end] ? i : end;
    data->lateral_count = (int)(end + 1);
    data->lateral_at = table.value[0];
    data->lateral = table.value[1];
    table.value[0] = table.value[1] = NULL;
    sf_table_free(&table);
    for (int i = 1; i < data->lateral_count; i++)
        for (int k = i; k > 0 && data->lateral_at[k] < data->lateral_at[k - 1]; k--) {
            double at = data->lateral_at[k], side = data->lateral[k];
            data->lateral_at[k] = data->lateral_at[k - 1];
            data->lateral[k] = data->lateral[k - 1];
            data->lateral_at[k - 1] = at;
            data->lateral[k - 1] = side;
        }
    if (data->lateral_count < LEAST_LATERAL)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %d points of lateral strain while loading; %d are needed",
                       path, data->lateral_count, LEAST_LATERAL);
    return SF_OK;
}

/* ---- the keys ---- */

static sf_status read_test(const sf_config *file, const config_setting_t *root, sf_hyperfoam_request *r,
                           sf_compression_test *test, sf_error *err) {
    const config_setting_t *tests, *entry;
    sf_compression_source source = {0};
    char *path = NULL, *lateral = NULL;
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_config_list(file, root, "tests", true, 8, &tests, err));
    entry = config_setting_get_elem(tests, 0);
    if (config_setting_length(tests) != 1)
        return sf_config_refuse(
            file, tests, err,
            "the hyperfoam is fitted to one test, at one rate; fit the others in files of "
            "their own, and compare nu and mu");
    SF_TRY(sf_config_names(file, entry, "file|rate|lateral", err));
    SF_TRY(sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, &source.rate, err));
    if (sf_config_file(file, entry, "lateral", false, &lateral, err) == SF_OK &&
        sf_config_file(file, entry, "file", true, &path, err) == SF_OK) {
        source.path = path;
        if (sf_compression_test_read(&source, test, &inner) == SF_OK && lateral)
            read_lateral(lateral, r, &inner);
        if (inner.status != SF_OK)
            SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                    config_setting_source_line(entry));
    }
    free(path);
    free(lateral);
    return err->status;
}

sf_status sf_hyperfoam_request_read(const sf_config *file, const config_setting_t *root,
                                    sf_hyperfoam_request *r, sf_compression_test *test, sf_error *err) {
    double terms = 2;
    SF_TRY(sf_config_number(file, root, "terms", false, 1, SF_HYPERFOAM_TERMS, &terms, err));
    SF_TRY(sf_config_number(file, root, "nu", false, 0, 0.45, &r->nu, err));
    r->terms = (int)terms;
    if (r->terms != terms)
        return sf_config_refuse(file, config_setting_get_member(root, "terms"), err,
                                "terms is %g; it must be 1, 2 or 3", terms);
    SF_TRY(read_test(file, root, r, test, err));
    bool given = config_setting_get_member(root, "nu") != NULL, measured = r->lateral_count > 0;
    if (given == measured)
        return sf_config_refuse(file, root, err,
                                given ? "nu is given, and lateral strain is measured; one of them says it"
                                      : "give the test a table of lateral strain (lateral = \"FILE\", which "
                                        "may be its own file), or nu for all terms");
    return SF_OK;
}

void sf_hyperfoam_request_free(sf_hyperfoam_request *r) {
    free(r->lateral_at);
    free(r->lateral);
    *r = (sf_hyperfoam_request){0};
}
