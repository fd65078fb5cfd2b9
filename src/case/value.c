/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/value.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "case/curves.h"
#include "io/plain_file.h"

/* Reads one value of each kind of sf_key_kind into the case. */

enum { KEY_PATH_SIZE = 160 };
static const double LARGEST_PARAMETER = 1e12; /* of a geometry, in its own unit */

static const char *key_path(const sf_key *key, char *out) {
    snprintf(out, KEY_PATH_SIZE, "%s.%s", key->group, key->name);
    return out;
}

/* Records "file:line: group.key = value: sentence". */
#define FAIL_AT(reader, key, setting, err, ...) fail_at(reader, key, setting, err, __LINE__, __VA_ARGS__)

__attribute__((format(printf, 6, 7))) static sf_status fail_at(const sf_case_reader *reader,
                                                               const sf_key *key,
                                                               const config_setting_t *setting, sf_error *err,
                                                               int line, const char *format, ...) {
    char where[SF_CASE_WHERE_SIZE], path[KEY_PATH_SIZE], sentence[640];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return sf_error_set(err, SF_ERR_INPUT, __FILE__, line, "%s: %s: %s",
                        sf_case_where(reader, setting, where), key_path(key, path), sentence);
}

static const char *type_phrase(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_GROUP:
        return "a group";
    case CONFIG_TYPE_INT:
    case CONFIG_TYPE_INT64:
    case CONFIG_TYPE_FLOAT:
        return "a plain number";
    case CONFIG_TYPE_STRING:
        return "a text";
    case CONFIG_TYPE_BOOL:
        return "true or false";
    case CONFIG_TYPE_ARRAY:
        return "an array";
    default:
        return "a list";
    }
}

/* libconfig's get_float returns 0 for the integer types unless automatic conversion is on. */
static double number_of(const config_setting_t *setting) {
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
        return config_setting_get_int(setting);
    case CONFIG_TYPE_INT64:
        return (double)config_setting_get_int64(setting);
    default:
        return config_setting_get_float(setting);
    }
}

static sf_status check_bounds(const sf_case_reader *reader, const sf_key *key,
                              const config_setting_t *setting, double value, const char *unit,
                              sf_error *err) {
    /* Units are converted with a rounding: 20 us may come out an ulp above 20e-6 s. */
    double high = key->high * (1.0 + 1e-12);
    bool low_bad = key->low_open ? !(value > key->low) : !(value >= key->low);
    bool high_bad = key->high != 0.0 && value > high;
    if (!low_bad && !high_bad)
        return SF_OK;
    char upper[64] = "";
    if (key->high != 0.0)
        snprintf(upper, sizeof upper, " and at most %g%s%s", key->high, *unit ? " " : "", unit);
    return FAIL_AT(reader, key, setting, err, "%g%s%s is out of bounds; it must be %s %g%s%s%s", value,
                   *unit ? " " : "", unit, key->low_open ? "greater than" : "at least", key->low,
                   *unit ? " " : "", unit, upper);
}

/* Returns the place of the key's value. */
static void *place_of(const sf_case_reader *reader, const sf_key *key) {
    return (key->in_card ? (char *)reader->material->card : (char *)reader->out) + key->offset;
}

static sf_status read_quantity(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                               char *detail, size_t size, sf_error *err) {
    double *value = place_of(reader, key);
    const char *unit = sf_quantity_unit(key->quantity);
    const char *text = config_setting_get_string(setting);
    if (!text)
        return FAIL_AT(reader, key, setting, err,
                       "the value is %s; expected %s as a text with its unit, for example \"%s\"",
                       type_phrase(setting), sf_quantity_phrase(key->quantity),
                       sf_quantity_example(key->quantity));
    if (key->words && strcmp(text, key->words) == 0) {
        *value = key->word_value;
        snprintf(detail, size, "-");
        return SF_OK;
    }
    sf_error inner = SF_ERROR_INIT;
    if (sf_units_parse(reader->units, text, key->quantity, value, &inner) != SF_OK)
        return FAIL_AT(reader, key, setting, err, "%s%s%s%s", inner.text, key->words ? " or \"" : "",
                       key->words ? key->words : "", key->words ? "\"" : "");
    snprintf(detail, size, "%.12g %s", *value, unit);
    return check_bounds(reader, key, setting, *value, unit, err);
}

static sf_status read_unit(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                           char *detail, size_t size, sf_error *err) {
    double *value = (double *)((char *)reader->out + key->offset);
    const char *text = config_setting_get_string(setting);
    char one[SF_CASE_NAME_SIZE];
    sf_error inner = SF_ERROR_INIT;
    if (!text)
        return FAIL_AT(reader, key, setting, err,
                       "the value is %s; expected a unit of length, for example \"mm\"",
                       type_phrase(setting));
    snprintf(one, sizeof one, "1 %s", text);
    if (sf_units_parse(reader->units, one, SF_LENGTH, value, &inner) != SF_OK)
        return FAIL_AT(reader, key, setting, err, "\"%s\" is not a unit of length, for example \"mm\"", text);
    snprintf(detail, size, "%.12g m", *value);
    return SF_OK;
}

static sf_status read_number(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    double *value = place_of(reader, key);
    if (!config_setting_is_number(setting))
        return FAIL_AT(reader, key, setting, err, "the value is %s; expected a plain number without a unit",
                       type_phrase(setting));
    *value = number_of(setting);
    if (!isfinite(*value))
        return FAIL_AT(reader, key, setting, err, "the number is not finite");
    snprintf(detail, size, "%.12g", *value);
    return check_bounds(reader, key, setting, *value, "", err);
}

static sf_status read_bool(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                           char *detail, size_t size, sf_error *err) {
    if (config_setting_type(setting) != CONFIG_TYPE_BOOL)
        return FAIL_AT(reader, key, setting, err, "the value is %s; expected true or false",
                       type_phrase(setting));
    int value = config_setting_get_bool(setting);
    *(int64_t *)((char *)reader->out + key->offset) = value != 0;
    snprintf(detail, size, "%d", value != 0);
    return SF_OK;
}

static sf_status copy_name(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                           char *name, sf_error *err) {
    const char *text = config_setting_get_string(setting);
    if (!text)
        return FAIL_AT(reader, key, setting, err, "%s stands where a name is expected, for example \"top\"",
                       type_phrase(setting));
    if (*text == '\0')
        return FAIL_AT(reader, key, setting, err, "the name is empty");
    for (const char *c = text; *c; c++)
        if (iscntrl((unsigned char)*c))
            return FAIL_AT(reader, key, setting, err,
                           "the name holds a line end or another control character");
    if (strlen(text) >= SF_CASE_NAME_SIZE)
        return FAIL_AT(reader, key, setting, err, "the name is longer than %d characters",
                       SF_CASE_NAME_SIZE - 1);
    memcpy(name, text, strlen(text) + 1);
    return SF_OK;
}

static bool is_sequence(const config_setting_t *setting) {
    return config_setting_is_array(setting) || config_setting_is_list(setting);
}

static sf_status read_names(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                            char *detail, size_t size, sf_error *err) {
    char(*name)[SF_CASE_NAME_SIZE] = (char(*)[SF_CASE_NAME_SIZE])((char *)reader->out + key->offset);
    int *count = (int *)((char *)reader->out + key->count_offset);
    if (!is_sequence(setting))
        return FAIL_AT(reader, key, setting, err,
                       "the value is %s; expected an array of names, for example [\"base\"]",
                       type_phrase(setting));
    int length = config_setting_length(setting);
    if (length > SF_CASE_MAX_GROUPS)
        return FAIL_AT(reader, key, setting, err, "%d names; at most %d are allowed", length,
                       SF_CASE_MAX_GROUPS);
    for (*count = 0; *count < length; ++*count) {
        if (copy_name(reader, key, config_setting_get_elem(setting, (unsigned)*count), name[*count], err) !=
            SF_OK)
            return err->status;
        for (int i = 0; i < *count; i++)
            if (strcmp(name[i], name[*count]) == 0)
                return FAIL_AT(reader, key, setting, err, "\"%s\" is named twice", name[i]);
    }
    snprintf(detail, size, "-");
    return SF_OK;
}

/* Index of `text` among the words "a|b|c"; -1 if it is none of them. */
static int word_index(const char *words, const char *text) {
    size_t length = strlen(text);
    for (int k = 0; words; k++) {
        size_t word = strcspn(words, "|");
        if (word == length && strncmp(words, text, length) == 0)
            return k;
        words = words[word] ? words + word + 1 : NULL;
    }
    return -1;
}

/* "a|b|c" as "a, b, c". */
static const char *word_list(const char *words, char *out, size_t size) {
    size_t used = 0;
    for (const char *w = words; *w && used + 3 < size; w++) {
        if (*w == '|') {
            out[used++] = ',';
            out[used++] = ' ';
        } else {
            out[used++] = *w;
        }
    }
    out[used] = '\0';
    return out;
}

static sf_status find_word(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                           int *index, sf_error *err) {
    const char *text = config_setting_get_string(setting);
    char list[256];
    *index = text ? word_index(key->words, text) : -1;
    if (*index >= 0)
        return SF_OK;
    return FAIL_AT(reader, key, setting, err, "%s%s%s is none of: %s", text ? "\"" : "",
                   text ? text : type_phrase(setting), text ? "\"" : "",
                   word_list(key->words, list, sizeof list));
}

static sf_status read_choice(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    int index = 0;
    snprintf(detail, size, "-");
    if (find_word(reader, key, setting, &index, err) != SF_OK)
        return err->status;
    if (key->in_card)
        *(int64_t *)place_of(reader, key) = index;
    else
        *(int *)place_of(reader, key) = index;
    return SF_OK;
}

static sf_status read_fields(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    int64_t *bits = (int64_t *)((char *)reader->out + key->offset);
    if (!is_sequence(setting))
        return FAIL_AT(reader, key, setting, err, "the value is %s; expected an array of field names",
                       type_phrase(setting));
    *bits = 0;
    for (int i = 0; i < config_setting_length(setting); i++) {
        int k = 0;
        if (find_word(reader, key, config_setting_get_elem(setting, (unsigned)i), &k, err) != SF_OK)
            return err->status;
        *bits |= (int64_t)1 << k;
    }
    snprintf(detail, size, "-");
    return SF_OK;
}

static int by_time(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static sf_status read_times(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                            char *detail, size_t size, sf_error *err) {
    double *value = (double *)((char *)reader->out + key->offset);
    int *count = (int *)((char *)reader->out + key->count_offset);
    if (!is_sequence(setting) || config_setting_length(setting) > SF_CASE_MAX_TIMES)
        return FAIL_AT(reader, key, setting, err,
                       "expected an array of at most %d times, for example [\"12 ms\", \"20 ms\"]",
                       SF_CASE_MAX_TIMES);
    *count = config_setting_length(setting);
    for (int i = 0; i < *count; i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        const char *text = config_setting_get_string(item);
        sf_error inner = SF_ERROR_INIT;
        if (!text)
            return FAIL_AT(reader, key, setting, err, "item %d is %s; expected a time such as \"12 ms\"",
                           i + 1, type_phrase(item));
        if (sf_units_parse(reader->units, text, key->quantity, &value[i], &inner) != SF_OK)
            return FAIL_AT(reader, key, setting, err, "%s", inner.text);
        if (check_bounds(reader, key, setting, value[i], "s", err) != SF_OK)
            return err->status;
    }
    qsort(value, (size_t)*count, sizeof *value, by_time);
    snprintf(detail, size, "-");
    return SF_OK;
}

static sf_status read_quantities(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                                 char *detail, size_t size, sf_error *err) {
    double *value = (double *)((char *)reader->out + key->offset);
    int *count = (int *)((char *)reader->out + key->count_offset), length = 0;
    char other[24] = "";
    if (is_sequence(setting))
        length = config_setting_length(setting);
    if (key->lengths[1])
        snprintf(other, sizeof other, " or %d", key->lengths[1]);
    if (length == 0 || (length != key->lengths[0] && length != key->lengths[1]))
        return FAIL_AT(reader, key, setting, err, "expected an array of %d%s values, each %s such as \"%s\"",
                       key->lengths[0], other, sf_quantity_phrase(key->quantity),
                       sf_quantity_example(key->quantity));
    for (*count = 0; *count < length; ++*count) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)*count);
        const char *text = config_setting_get_string(item);
        sf_error inner = SF_ERROR_INIT;
        if (!text)
            return FAIL_AT(reader, key, setting, err, "item %d is %s; expected %s such as \"%s\"", *count + 1,
                           type_phrase(item), sf_quantity_phrase(key->quantity),
                           sf_quantity_example(key->quantity));
        if (sf_units_parse(reader->units, text, key->quantity, &value[*count], &inner) != SF_OK)
            return FAIL_AT(reader, key, setting, err, "%s", inner.text);
        if (check_bounds(reader, key, setting, value[*count], sf_quantity_unit(key->quantity), err) != SF_OK)
            return err->status;
    }
    snprintf(detail, size, "-");
    return SF_OK;
}

static sf_status read_vector(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    double *value = (double *)((char *)reader->out + key->offset);
    bool fits = is_sequence(setting) && config_setting_length(setting) == 3;
    for (int i = 0; fits && i < 3; i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        fits = config_setting_is_number(item) && isfinite(number_of(item));
        value[i] = number_of(item);
    }
    if (!fits)
        return FAIL_AT(
            reader, key, setting, err,
            "expected three plain numbers, all with a decimal point or all without, for example [0.0, 0.0, -1.0]");
    snprintf(detail, size, "-");
    return SF_OK;
}

static sf_status read_place(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                            char *detail, size_t size, sf_error *err) {
    double *value = (double *)((char *)reader->out + key->offset);
    const char *unit = sf_quantity_unit(key->quantity);
    if (!is_sequence(setting) || config_setting_length(setting) != 2)
        return FAIL_AT(reader, key, setting, err,
                       "expected an array of two lengths, x and y, for example [\"20 mm\", \"0 mm\"]");
    for (int i = 0; i < 2; i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        const char *text = config_setting_get_string(item);
        sf_error inner = SF_ERROR_INIT;
        if (!text)
            return FAIL_AT(reader, key, setting, err, "item %d is %s; expected a length such as \"20 mm\"",
                           i + 1, type_phrase(item));
        if (sf_units_parse(reader->units, text, key->quantity, &value[i], &inner) != SF_OK)
            return FAIL_AT(reader, key, setting, err, "%s", inner.text);
        if (check_bounds(reader, key, setting, value[i], unit, err) != SF_OK)
            return err->status;
    }
    snprintf(detail, size, "%.12g %.12g %s", value[0], value[1], unit);
    return SF_OK;
}

static sf_status read_path(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                           char *detail, size_t size, sf_error *err) {
    char **path = (char **)((char *)reader->out + key->offset);
    const char *text = config_setting_get_string(setting);
    if (!text || !*text)
        return FAIL_AT(reader, key, setting, err, "%s stands where a file name is expected",
                       text ? "an empty text" : type_phrase(setting));
    *path = sf_case_resolve(reader, setting, text, err);
    if (!*path)
        return err->status;
    sf_error inner = SF_ERROR_INIT;
    if (sf_plain_check(*path, NULL, &inner) != SF_OK)
        return FAIL_AT(reader, key, setting, err, "\"%s\": %s", text, inner.text);
    snprintf(detail, size, "-");
    return SF_OK;
}

static sf_status read_parameters(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                                 char *detail, size_t size, sf_error *err) {
    sf_geo_source *source = (sf_geo_source *)((char *)reader->out + key->offset);
    if (!config_setting_is_group(setting))
        return FAIL_AT(reader, key, setting, err,
                       "the value is %s; expected a group such as { side = 400.0; }", type_phrase(setting));
    int count = config_setting_length(setting);
    if (count > SF_CASE_MAX_PARAMETERS)
        return FAIL_AT(reader, key, setting, err, "%d parameters; at most %d are allowed", count,
                       SF_CASE_MAX_PARAMETERS);
    for (int i = 0; i < count; i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        const char *name = config_setting_name(item);
        sf_geo_parameter *parameter = &source->parameter[i];
        if (strlen(name) >= sizeof parameter->name)
            return FAIL_AT(reader, key, item, err, "the name \"%s\" is longer than %d characters", name,
                           SF_CASE_NAME_SIZE - 1);
        memcpy(parameter->name, name, strlen(name) + 1);
        if (config_setting_type(item) == CONFIG_TYPE_BOOL)
            parameter->value = config_setting_get_bool(item);
        else if (config_setting_is_number(item) && isfinite(number_of(item)))
            parameter->value = number_of(item);
        else
            return FAIL_AT(reader, key, item, err,
                           "\"%s\" is not a finite plain number (in the geometry's own unit)", name);
        if (fabs(parameter->value) > LARGEST_PARAMETER)
            return FAIL_AT(reader, key, item, err, "%s = %g is out of bounds; it must be between -%g and %g",
                           name, parameter->value, LARGEST_PARAMETER, LARGEST_PARAMETER);
    }
    source->parameter_count = count;
    snprintf(detail, size, "-");
    return SF_OK;
}

sf_status sf_case_read_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    switch (key->kind) {
    case SF_KEY_QUANTITY:
        return read_quantity(reader, key, setting, detail, size, err);
    case SF_KEY_UNIT:
        return read_unit(reader, key, setting, detail, size, err);
    case SF_KEY_NUMBER:
        return read_number(reader, key, setting, detail, size, err);
    case SF_KEY_BOOL:
        return read_bool(reader, key, setting, detail, size, err);
    case SF_KEY_NAME:
        snprintf(detail, size, "-");
        return copy_name(reader, key, setting, (char *)reader->out + key->offset, err);
    case SF_KEY_NAMES:
        return read_names(reader, key, setting, detail, size, err);
    case SF_KEY_CHOICE:
        return read_choice(reader, key, setting, detail, size, err);
    case SF_KEY_FIELDS:
        return read_fields(reader, key, setting, detail, size, err);
    case SF_KEY_TIMES:
        return read_times(reader, key, setting, detail, size, err);
    case SF_KEY_QUANTITIES:
        return read_quantities(reader, key, setting, detail, size, err);
    case SF_KEY_VECTOR:
        return read_vector(reader, key, setting, detail, size, err);
    case SF_KEY_PLACE:
        return read_place(reader, key, setting, detail, size, err);
    case SF_KEY_PATH:
        return read_path(reader, key, setting, detail, size, err);
    case SF_KEY_PARAMETERS:
        return read_parameters(reader, key, setting, detail, size, err);
    case SF_KEY_MOTION:
        return sf_case_read_motion(reader, setting, detail, size, err);
    case SF_KEY_LAW: /* taken before all others */
        return SF_OK;
    case SF_KEY_CURVE:
    case SF_KEY_CURVES:
        return sf_case_read_curves(reader, setting, detail, size, err);
    }
    return SF_FAIL(err, SF_ERR_INPUT, "%s.%s: unknown kind of key", key->group, key->name);
}

static const double LARGEST = 1; /* of ln(number) */

bool sf_case_is_response_error(const sf_case_reader *reader, const char *group, const char *name) {
    return strcmp(group, reader->material_group) == 0 && strcmp(name, SF_RESPONSE_ERROR) == 0;
}

/* The case has the numbers of kind 0 at this offset. */
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
static sf_status read_deviation(sf_case_reader *reader, const config_setting_t *setting, const char *path,
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
    if (read_deviation(reader, shared, path, -LARGEST, SHARED + (size_t)kind * sizeof(double), err) == SF_OK)
        read_deviation(reader, own, path, 0, OWN + (size_t)kind * sizeof(double), err);
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
