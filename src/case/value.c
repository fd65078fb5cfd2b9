/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "case/value.h"

#include <ctype.h>
#include <gsl/gsl_sort.h>

#include "base/hash.h"
#include "base/text.h"

#include "case/curves.h"
#include "io/plain_file.h"

/* Reads one value of each kind of sf_key_kind into the case. */

static const double LARGEST_PARAMETER = 1e12; /* of a geometry, in its own unit */

/* A setting, and where its value goes. */
typedef struct slot {
    sf_case_reader *reader;
    const sf_key *key;
    const config_setting_t *setting;
    void *at;     /* of the type of the key's kind */
    int *count;   /* of an array's items */
    char *detail; /* [size] the SI value for the listing, "-" unless a reader sets it */
    size_t size;
    sf_error *err;
} slot;

/* Records "file:line: group.key: sentence". */
#define REFUSE(s, ...) refuse(s, __LINE__, __VA_ARGS__)

__attribute__((format(printf, 3, 4))) static sf_status refuse(const slot *s, int line, const char *format,
                                                              ...) {
    char sentence[640];
    SF_PRINT_INTO(sentence, format);
    return sf_case_refuse(s->reader, s->setting, s->err, __FILE__, line, "%s.%s: %s", s->key->group,
                          s->key->name, sentence);
}

static const char *type_phrase(const config_setting_t *setting) {
    static const char *const phrases[] = {
        [CONFIG_TYPE_GROUP] = "a group",        [CONFIG_TYPE_INT] = "a plain number",
        [CONFIG_TYPE_INT64] = "a plain number", [CONFIG_TYPE_FLOAT] = "a plain number",
        [CONFIG_TYPE_STRING] = "a text",        [CONFIG_TYPE_BOOL] = "true or false",
        [CONFIG_TYPE_ARRAY] = "an array",       [CONFIG_TYPE_LIST] = "a list"};
    return phrases[config_setting_type(setting)];
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

static bool is_finite_number(const config_setting_t *setting) {
    return config_setting_is_number(setting) && isfinite(number_of(setting));
}

/* `given`: the text of a quantity; NULL of a number. */
static sf_status check_bounds(const slot *s, double value, const char *unit, const char *given) {
    const sf_key *key = s->key;
    /* Units are converted with a rounding: 20 us may come out an ulp above 20e-6 s. */
    double high = key->high * (1.0 + 1e-12);
    bool low_bad = key->low_open ? !(value > key->low) : !(value >= key->low);
    bool high_bad = key->high != 0.0 && value > high;
    const char *blank = *unit ? " " : "";
    char upper[64] = "";
    if (!low_bad && !high_bad)
        return SF_OK;
    if (key->high != 0.0)
        snprintf(upper, sizeof upper, " and at most %g%s%s", key->high, blank, unit);
    return REFUSE(s, "%g%s%s is out of bounds; it must be %s %g%s%s%s%s%s%s", value, blank, unit,
                  key->low_open ? "above" : "at least", key->low, blank, unit, upper,
                  given ? ": is the unit of \"" : "", given ? given : "", given ? "\" right?" : "");
}

static sf_status read_quantity(const slot *s) {
    double *value = s->at;
    const sf_key *key = s->key;
    const char *unit = sf_quantity_unit(key->quantity), *text = config_setting_get_string(s->setting);
    sf_error inner = SF_ERROR_INIT;
    if (!text)
        return REFUSE(s, "the value is %s; expected %s as a text with its unit, for example \"%s\"",
                      type_phrase(s->setting), sf_quantity_phrase(key->quantity),
                      sf_quantity_example(key->quantity));
    if (key->words && strcmp(text, key->words) == 0) {
        *value = key->word_value;
        return SF_OK;
    }
    if (sf_units_parse(s->reader->units, text, key->quantity, value, &inner) != SF_OK)
        return REFUSE(s, "%s%s%s%s", inner.text, key->words ? " or \"" : "", key->words ? key->words : "",
                      key->words ? "\"" : "");
    snprintf(s->detail, s->size, "%.12g %s", *value, unit);
    return check_bounds(s, *value, unit, text);
}

static sf_status read_unit(const slot *s) {
    double *value = s->at;
    const char *text = config_setting_get_string(s->setting);
    if (!text)
        return REFUSE(s, "the value is %s; expected a unit of length, for example \"mm\"",
                      type_phrase(s->setting));
    SF_PRINTED(one, SF_CASE_NAME_SIZE, "1 %s", text);
    if (sf_units_parse(s->reader->units, one, SF_LENGTH, value, SF_IGNORED) != SF_OK)
        return REFUSE(s, "\"%s\" is not a unit of length, for example \"mm\"", text);
    snprintf(s->detail, s->size, "%.12g m", *value);
    return SF_OK;
}

static sf_status read_number(const slot *s) {
    double *value = s->at;
    if (!config_setting_is_number(s->setting))
        return REFUSE(s, "the value is %s; expected a plain number without a unit", type_phrase(s->setting));
    *value = number_of(s->setting);
    if (!isfinite(*value))
        return REFUSE(s, "the number is not finite");
    snprintf(s->detail, s->size, "%.12g", *value);
    return check_bounds(s, *value, "", NULL);
}

static sf_status read_bool(const slot *s) {
    if (config_setting_type(s->setting) != CONFIG_TYPE_BOOL)
        return REFUSE(s, "the value is %s; expected true or false", type_phrase(s->setting));
    *(int64_t *)s->at = config_setting_get_bool(s->setting) != 0;
    snprintf(s->detail, s->size, "%d", (int)*(int64_t *)s->at);
    return SF_OK;
}

static sf_status copy_name(const slot *s, const config_setting_t *item, char *name) {
    const char *text = config_setting_get_string(item);
    if (!text)
        return REFUSE(s, "the value is %s; expected a name, for example \"top\"", type_phrase(item));
    if (*text == '\0')
        return REFUSE(s, "the name is empty");
    for (const char *c = text; *c; c++)
        if (iscntrl((unsigned char)*c))
            return REFUSE(s, "the name holds a line end or another control character");
    if (strlen(text) >= SF_CASE_NAME_SIZE)
        return REFUSE(s, "the name is longer than %d characters", SF_CASE_NAME_SIZE - 1);
    memcpy(name, text, strlen(text) + 1);
    return SF_OK;
}

static sf_status read_name(const slot *s) {
    return copy_name(s, s->setting, s->at);
}

static bool is_sequence(const config_setting_t *setting) {
    return config_setting_is_array(setting) || config_setting_is_list(setting);
}

static sf_status read_names(const slot *s) {
    char(*name)[SF_CASE_NAME_SIZE] = s->at;
    int *count = s->count, length = config_setting_length(s->setting);
    if (!is_sequence(s->setting))
        return REFUSE(s, "the value is %s; expected an array of names, for example [\"base\"]",
                      type_phrase(s->setting));
    if (length > SF_CASE_MAX_GROUPS)
        return REFUSE(s, "%d names" SF_AT_MOST("%d"), length, SF_CASE_MAX_GROUPS);
    for (*count = 0; *count < length; ++*count) {
        SF_TRY(copy_name(s, config_setting_get_elem(s->setting, (unsigned)*count), name[*count]));
        for (int i = 0; i < *count; i++)
            if (strcmp(name[i], name[*count]) == 0)
                return REFUSE(s, "\"%s\" is given twice", name[i]);
    }
    return SF_OK;
}

static sf_status find_word(const slot *s, const config_setting_t *item, int *index) {
    const char *text = config_setting_get_string(item), *words = s->key->words;
    char list[256] = "";
    *index = text ? sf_word_find(words, text) : -1;
    if (*index >= 0)
        return SF_OK;
    for (; *words; words++)
        sf_text_add(list, sizeof list, *words == '|' ? ", " : "%c", *words);
    return REFUSE(s, "%s%s%s is none of: %s", text ? "\"" : "", text ? text : type_phrase(item),
                  text ? "\"" : "", list);
}

static sf_status read_choice(const slot *s) {
    int index = 0;
    SF_TRY(find_word(s, s->setting, &index));
    if (s->key->in_card)
        *(int64_t *)s->at = index;
    else
        *(int *)s->at = index;
    return SF_OK;
}

static sf_status read_fields(const slot *s) {
    int64_t *bits = s->at;
    if (!is_sequence(s->setting))
        return REFUSE(s, "the value is %s; expected an array of field names", type_phrase(s->setting));
    *bits = 0;
    for (int i = 0; i < config_setting_length(s->setting); i++) {
        int k = 0;
        SF_TRY(find_word(s, config_setting_get_elem(s->setting, (unsigned)i), &k));
        *bits |= (int64_t)1 << k;
    }
    return SF_OK;
}

/* Reads an array of texts with units; `phrase` and `example` of an item, for sentences. */
static sf_status read_items(const slot *s, const char *phrase, const char *example) {
    double *value = s->at;
    for (int i = 0; i < config_setting_length(s->setting); i++) {
        const config_setting_t *item = config_setting_get_elem(s->setting, (unsigned)i);
        const char *text = config_setting_get_string(item);
        sf_error inner = SF_ERROR_INIT;
        if (!text)
            return REFUSE(s, "item %d is %s; expected %s such as \"%s\"", i + 1, type_phrase(item), phrase,
                          example);
        if (sf_units_parse(s->reader->units, text, s->key->quantity, &value[i], &inner) != SF_OK)
            return REFUSE(s, "%s", inner.text);
        SF_TRY(check_bounds(s, value[i], sf_quantity_unit(s->key->quantity), NULL));
    }
    return SF_OK;
}

static sf_status read_times(const slot *s) {
    if (!is_sequence(s->setting) || config_setting_length(s->setting) > SF_CASE_MAX_TIMES)
        return REFUSE(s, "expected an array of at most %d times, for example [\"12 ms\", \"20 ms\"]",
                      SF_CASE_MAX_TIMES);
    *s->count = config_setting_length(s->setting);
    SF_TRY(read_items(s, "a time", "12 ms"));
    gsl_sort(s->at, 1, (size_t)*s->count);
    return SF_OK;
}

static sf_status read_quantities(const slot *s) {
    const int *lengths = s->key->lengths;
    const char *phrase = sf_quantity_phrase(s->key->quantity),
               *example = sf_quantity_example(s->key->quantity);
    int length = is_sequence(s->setting) ? config_setting_length(s->setting) : 0;
    char other[24] = "";
    if (lengths[1])
        snprintf(other, sizeof other, " or %d", lengths[1]);
    if (length == 0 || (length != lengths[0] && length != lengths[1]))
        return REFUSE(s, "expected an array of %d%s values, each %s such as \"%s\"", lengths[0], other,
                      phrase, example);
    *s->count = length;
    return read_items(s, phrase, example);
}

static sf_status read_vector(const slot *s) {
    double *value = s->at;
    bool fits = is_sequence(s->setting) && config_setting_length(s->setting) == 3;
    for (int i = 0; fits && i < 3; i++) {
        const config_setting_t *item = config_setting_get_elem(s->setting, (unsigned)i);
        fits = is_finite_number(item);
        value[i] = number_of(item);
    }
    return fits ? SF_OK
                : REFUSE(s, "expected three plain numbers, all with a decimal point or all without, for "
                            "example [0.0, 0.0, -1.0]");
}

static sf_status read_place(const slot *s) {
    const double *value = s->at;
    if (!is_sequence(s->setting) || config_setting_length(s->setting) != 2)
        return REFUSE(s, "expected an array of two lengths, x and y, for example [\"20 mm\", \"0 mm\"]");
    SF_TRY(read_items(s, "a length", "20 mm"));
    snprintf(s->detail, s->size, "%.12g %.12g %s", value[0], value[1], sf_quantity_unit(s->key->quantity));
    return SF_OK;
}

static sf_status read_drop_interval(const slot *s, const config_setting_t *setting, double *interval) {
    char detail[64];
    slot own = *s;
    own.key = sf_case_find_key(&s->reader->keys, "series", "interval");
    own.setting = setting;
    own.at = interval;
    own.detail = detail;
    own.size = sizeof detail;
    return read_quantity(&own);
}

/* Enters the content of a later drop's motion into the hash of the case: the first drop's reader does not
 * read it. What cannot be read is refused when that drop is read. */
static void hash_drop_motion(const slot *s, const config_setting_t *drop) {
    const config_setting_t *motion = config_setting_get_member(drop, "motion");
    const char *text = motion ? config_setting_get_string(motion) : NULL;
    SF_OWNED char *path = text && *text ? sf_case_resolve(s->reader, motion, text, SF_IGNORED) : NULL;
    uint64_t content = 0, *hash = &s->reader->out->values;
    if (path && sf_plain_hash(path, NULL, SF_PLAIN_TEXT, &content, SF_IGNORED) == SF_OK)
        *hash = sf_hash_bytes(*hash, &content, sizeof content);
}

/* The number of drops, or the list of them, whose keys of the missile sf_case_take_drop takes. */
static sf_status read_drops(const slot *s) {
    sf_case_drop *drop = s->reader->out->drop;
    int count = config_setting_length(s->setting);
    if (!config_setting_is_list(s->setting))
        return read_number(s);
    *(double *)s->at = count;
    snprintf(s->detail, s->size, "%d", count);
    SF_TRY(check_bounds(s, count, "", NULL));
    for (int k = 0; k < count; k++) {
        const config_setting_t *item = config_setting_get_elem(s->setting, (unsigned)k);
        if (!config_setting_is_group(item))
            return REFUSE(s,
                          "drop %d is %s; expected a group, such as { interval = \"90 s\"; velocity = \"5 "
                          "m/s\"; } or { }",
                          k + 1, type_phrase(item));
        const config_setting_t *interval = config_setting_get_member(item, "interval");
        if (interval)
            SF_TRY(read_drop_interval(s, interval, &drop[k].interval));
        hash_drop_motion(s, item);
        drop[k].own = drop[0].own || config_setting_length(item) > (interval ? 1 : 0);
    }
    return SF_OK;
}

static sf_status read_counted(const slot *s) {
    int64_t *bits = s->at;
    if (!is_sequence(s->setting) || config_setting_length(s->setting) == 0)
        return REFUSE(s, "expected an array of numbers of drops, for example [2, 3]");
    *bits = 0;
    for (int k = 0; k < config_setting_length(s->setting); k++) {
        const config_setting_t *item = config_setting_get_elem(s->setting, (unsigned)k);
        double drop = is_finite_number(item) ? number_of(item) : 0;
        if (drop != floor(drop) || drop < 1 || drop > SF_SERIES_MOST || *bits >> ((int)drop - 1) & 1)
            return REFUSE(s, "item %d is not the number of another drop, from 1 to %d", k + 1,
                          SF_SERIES_MOST);
        *bits |= (int64_t)1 << ((int)drop - 1);
    }
    return SF_OK;
}

static sf_status read_path(const slot *s) {
    char **path = s->at;
    const char *text = config_setting_get_string(s->setting);
    sf_error inner = SF_ERROR_INIT;
    if (!text || !*text)
        return REFUSE(s, "the value is %s; expected the name of a file",
                      text ? "an empty text" : type_phrase(s->setting));
    *path = sf_case_resolve(s->reader, s->setting, text, s->err);
    if (!*path)
        return s->err->status;
    return sf_plain_check(*path, NULL, &inner) == SF_OK ? SF_OK : REFUSE(s, "\"%s\": %s", text, inner.text);
}

static sf_status read_parameters(const slot *s) {
    sf_geo_source *source = s->at;
    int count = config_setting_length(s->setting);
    if (!config_setting_is_group(s->setting))
        return REFUSE(s, "the value is %s; expected a group such as { side = 400.0; }",
                      type_phrase(s->setting));
    if (count > SF_CASE_MAX_PARAMETERS)
        return REFUSE(s, "%d parameters" SF_AT_MOST("%d"), count, SF_CASE_MAX_PARAMETERS);
    for (int i = 0; i < count; i++) {
        slot own = *s;
        own.setting = config_setting_get_elem(s->setting, (unsigned)i);
        const char *name = config_setting_name(own.setting);
        sf_geo_parameter *parameter = &source->parameter[i];
        if (strlen(name) >= sizeof parameter->name)
            return REFUSE(&own, "the name \"%s\" is longer than %d characters", name, SF_CASE_NAME_SIZE - 1);
        memcpy(parameter->name, name, strlen(name) + 1);
        if (config_setting_type(own.setting) == CONFIG_TYPE_BOOL)
            parameter->value = config_setting_get_bool(own.setting);
        else if (is_finite_number(own.setting))
            parameter->value = number_of(own.setting);
        else
            return REFUSE(&own, "\"%s\" must be a finite number without a unit, in the unit of the geometry",
                          name);
        if (fabs(parameter->value) > LARGEST_PARAMETER)
            return REFUSE(&own, "%s" SF_OUTSIDE("%g", "-%g", "%g"), name, parameter->value, LARGEST_PARAMETER,
                          LARGEST_PARAMETER);
    }
    source->parameter_count = count;
    return SF_OK;
}

static sf_status read_motion(const slot *s) {
    return sf_case_read_motion(s->reader, s->setting, s->detail, s->size, s->err);
}

static sf_status read_curves(const slot *s) {
    return sf_case_read_curves(s->reader, s->setting, s->detail, s->size, s->err);
}

static sf_status (*const readers[])(const slot *s) = {
    [SF_KEY_QUANTITY] = read_quantity,
    [SF_KEY_UNIT] = read_unit,
    [SF_KEY_NUMBER] = read_number,
    [SF_KEY_BOOL] = read_bool,
    [SF_KEY_NAME] = read_name,
    [SF_KEY_NAMES] = read_names,
    [SF_KEY_CHOICE] = read_choice,
    [SF_KEY_FIELDS] = read_fields,
    [SF_KEY_TIMES] = read_times,
    [SF_KEY_QUANTITIES] = read_quantities,
    [SF_KEY_VECTOR] = read_vector,
    [SF_KEY_PLACE] = read_place,
    [SF_KEY_PATH] = read_path,
    [SF_KEY_PARAMETERS] = read_parameters,
    [SF_KEY_LAW] = NULL,
    [SF_KEY_CURVE] = read_curves,
    [SF_KEY_MOTION] = read_motion,
    [SF_KEY_DROPS] = read_drops,
    [SF_KEY_COUNTED] = read_counted,
    [SF_KEY_CURVES] = read_curves,
};

sf_status sf_case_read_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err) {
    char *whole = sf_case_home(reader, key);
    const slot s = {reader, key,  setting, whole + key->offset, (int *)(void *)(whole + key->count_offset),
                    detail, size, err};
    return readers[key->kind] ? readers[key->kind](&s) : SF_OK; /* the law is taken before all others */
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
    if (!config_setting_is_group(group))
        return SF_REFUSE_AT(reader, group, err,
                            "%s must be a group: " SF_RESPONSE_ERROR " = { %s = 0.01; %s = 0.02; }", path,
                            sf_drop_kind_get(SF_FIT_HIC)->error_key, sf_drop_kind_get(SF_FIT_HIC)->sd_key);
    for (int k = 0; k < config_setting_length(group); k++) {
        const config_setting_t *item = config_setting_get_elem(group, (unsigned)k);
        if (find_kind(config_setting_name(item)) < 0)
            return SF_REFUSE_AT(reader, item, err, "unknown key \"%.80s\" in group %s; its keys are %s",
                                config_setting_name(item), path, keys + 2);
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
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    const config_setting_t *shared = config_setting_get_member(group, about->error_key),
                           *own = config_setting_get_member(group, about->sd_key);
    if (!shared && !own)
        return SF_OK;
    if (!shared || !own)
        return SF_REFUSE_AT(reader, shared ? shared : own, err, "%s.%s is given without %s", path,
                            shared ? about->error_key : about->sd_key,
                            shared ? about->sd_key : about->error_key);
    reader->out->response_error.given[kind] = true;
    SF_TRY(read_deviation(reader, shared, path, -LARGEST, SHARED + (size_t)kind * sizeof(double), err));
    return read_deviation(reader, own, path, 0, OWN + (size_t)kind * sizeof(double), err);
}

sf_status sf_case_read_response_error(sf_case_reader *reader, sf_error *err) {
    SF_PRINTED(path, SF_CASE_GROUP_SIZE, "%s." SF_RESPONSE_ERROR, reader->material_group);
    const config_setting_t *group = config_lookup(&reader->config, path);
    if (!group || check_names(reader, group, path, err) != SF_OK)
        return err->status;
    for (int kind = 0; kind < SF_FIT_SAMPLES && err->status == SF_OK; kind++)
        read_kind(reader, group, path, kind, err);
    if (reader->material != &reader->out->material)
        reader->out->response_error = (sf_response_error){0};
    return err->status;
}
