/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/response_error.h"

#include "case/value.h"
#include <string.h>

static const double LARGEST = 1; /* of ln(number) */

bool sf_case_is_response_error(const sf_case_reader *reader, const char *group, const char *name) {
    return strcmp(group, reader->material_group) == 0 && strcmp(name, SF_RESPONSE_ERROR) == 0;
}

/* Where the case has the numbers of kind 0. */
static const size_t SHARED = offsetof(sf_case, response_error) + offsetof(sf_response_error, shared),
                    OWN = offsetof(sf_case, response_error) + offsetof(sf_response_error, own_sd);

/* The kind whose key, or key of the standard deviation, this is; -1: none. */
static int find_kind(const char *name) {
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        if (strcmp(name, sf_drop_kind_get(kind)->error_key) == 0 ||
            strcmp(name, sf_drop_kind_get(kind)->sd_key) == 0)
            return kind;
    return -1;
}

static sf_status check_names(const sf_case_reader *reader, const config_setting_t *group, const char *path,
                             sf_error *err) {
#define KEYS(name, key, error_key, ...) ", " error_key ", " SF_DROP_SD(error_key)
    static const char keys[] = SF_DROP_KINDS(KEYS);
    char where[SF_CASE_WHERE_SIZE];
    if (!config_setting_is_group(group))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: %s must be a group: " SF_RESPONSE_ERROR " = { %s = 0.01; %s = 0.02; }",
                       sf_case_where(reader, group, where), path, sf_drop_kind_get(SF_FIT_HIC)->error_key,
                       sf_drop_kind_get(SF_FIT_HIC)->sd_key);
    for (int k = 0; k < config_setting_length(group); k++) {
        const config_setting_t *item = config_setting_get_elem(group, (unsigned)k);
        if (find_kind(config_setting_name(item)) < 0)
            return SF_FAIL(err, SF_ERR_INPUT, "%s: unknown key \"%.80s\" in group %s; its keys are %s",
                           sf_case_where(reader, item, where), config_setting_name(item), path, keys + 2);
    }
    return SF_OK;
}

/* One number into the case, at `offset` there. */
static sf_status read_number(sf_case_reader *reader, const config_setting_t *setting, const char *path,
                             double low, size_t offset, sf_error *err) {
    char detail[64];
    const sf_key key = {.group = path,
                        .name = config_setting_name(setting),
                        .kind = SF_KEY_NUMBER,
                        .offset = offset,
                        .low = low,
                        .high = LARGEST};
    return sf_case_read_value(reader, &key, setting, detail, sizeof detail, err);
}

static sf_status read_kind(sf_case_reader *reader, const config_setting_t *group, const char *path, int kind,
                           sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const config_setting_t *shared = config_setting_get_member(group, about->error_key),
                           *own = config_setting_get_member(group, about->sd_key);
    if (!shared && !own)
        return SF_OK;
    if (!shared || !own)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %s.%s is given without %s",
                       sf_case_where(reader, shared ? shared : own, where), path,
                       shared ? about->error_key : about->sd_key, shared ? about->sd_key : about->error_key);
    reader->out->response_error.given[kind] = true;
    if (read_number(reader, shared, path, -LARGEST, SHARED + (size_t)kind * sizeof(double), err) == SF_OK)
        read_number(reader, own, path, 0, OWN + (size_t)kind * sizeof(double), err);
    return err->status;
}

sf_status sf_case_read_response_error(sf_case_reader *reader, sf_error *err) {
    char path[SF_CASE_GROUP_SIZE];
    snprintf(path, sizeof path, "%s." SF_RESPONSE_ERROR, reader->material_group);
    const config_setting_t *group = config_lookup(&reader->config, path);
    if (!group || check_names(reader, group, path, err) != SF_OK)
        return err->status;
    for (int kind = 0; kind < SF_FIT_SAMPLES && err->status == SF_OK; kind++)
        read_kind(reader, group, path, kind, err);
    if (reader->material != &reader->out->material)
        reader->out->response_error = (sf_response_error){0};
    return err->status;
}
