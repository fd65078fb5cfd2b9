/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a case: file, overrides, unknown keys, the rows of the table, then the rules that join several keys.
 */

#include "case/read.h"

#include "base/hash.h"
#include "base/mat3.h"
#include "base/text.h"
#include "case/rules.h"
#include "case/value.h"
#include "case/values.h"
#include "io/folder.h"
#include "material/laws.h"

enum { NAMED_UNKNOWN = 10 };

/* Names that are not in the table: the first one in full, the next ones in short. */
typedef struct unknown {
    const config_setting_t *first;
    char group[SF_CASE_GROUP_SIZE]; /* of the first; "": the file */
    int count;
    char others[400];
} unknown;

static void add_unknown(unknown *u, const config_setting_t *item, const char *group) {
    if (u->count++ == 0) {
        u->first = item;
        snprintf(u->group, sizeof u->group, "%s", group);
    } else if (u->count <= NAMED_UNKNOWN) {
        sf_text_add(u->others, sizeof u->others, "%s%s%s%.24s", *u->others ? ", " : "", group,
                    *group ? "." : "", config_setting_name(item));
    }
}

static sf_status refuse_unknown(const sf_case_reader *reader, const unknown *u, sf_error *err) {
    char names[400], meant[SF_NEAR_HINT], more[480] = "";
    const char *name = config_setting_name(u->first);
    sf_case_list_names(&reader->keys, u->group, names, sizeof names);
    sf_case_near_hint(&reader->keys, u->group, name, meant);
    if (u->count > NAMED_UNKNOWN)
        snprintf(more, sizeof more, "; unknown too: %s and %d more", u->others, u->count - NAMED_UNKNOWN);
    else if (u->count > 1)
        snprintf(more, sizeof more, "; unknown too: %s", u->others);
    if (strcmp(u->group, "") == 0)
        strncat(names, ", materials, supports", sizeof names - strlen(names) - 1);
    else if (strcmp(u->group, reader->material_group) == 0)
        strncat(names, ", " SF_RESPONSE_ERROR, sizeof names - strlen(names) - 1);
    if (*u->group)
        return SF_REFUSE_AT(reader, u->first, err, "unknown key \"%.80s\" in group %s%s%s; its keys are %s",
                            name, u->group, meant, more, names);
    return SF_REFUSE_AT(reader, u->first, err, "unknown group \"%.80s\"%s%s; the groups are %s", name, meant,
                        more, names);
}

/* Finds everything in `setting` (the group called `group`, "" for the file) that is not in the table. */
static sf_status find_unknown(const sf_case_reader *reader, const config_setting_t *setting,
                              const char *group, unknown *u, sf_error *err) {
    for (int i = 0; i < config_setting_length(setting); i++) {
        const config_setting_t *item = config_setting_get_elem(setting, (unsigned)i);
        const char *name = config_setting_name(item);
        char inner[SF_CASE_GROUP_SIZE];
        int length = snprintf(inner, sizeof inner, "%s%s%s", group, *group ? "." : "", name);
        if (sf_case_find_key(&reader->keys, group, name) || item == reader->layers ||
            (!*group && (strcmp(name, "supports") == 0 || strcmp(name, "interfaces") == 0)) ||
            sf_case_is_response_error(reader, group, name))
            continue;
        if (length >= (int)sizeof inner || !sf_case_is_group(&reader->keys, inner))
            add_unknown(u, item, group);
        else if (!config_setting_is_group(item))
            return SF_REFUSE_AT(reader, item, err, "%s must be a group: %s: { ... }", inner, name);
        else
            SF_TRY(find_unknown(reader, item, inner, u, err));
    }
    return SF_OK;
}

/* Checks the names of everything in `setting`, the group called `group`; "" for the file. */
static sf_status check_names(const sf_case_reader *reader, const config_setting_t *setting, const char *group,
                             sf_error *err) {
    unknown u = {0};
    SF_TRY(find_unknown(reader, setting, group, &u, err));
    return u.count > 0 ? refuse_unknown(reader, &u, err) : SF_OK;
}

/* True if the key names files, whose contents are hashed where they are read. */
static bool names_files(const sf_key *key) {
    return key->kind == SF_KEY_PATH || key->kind == SF_KEY_CURVE || key->kind == SF_KEY_CURVES ||
           key->kind == SF_KEY_MOTION;
}

/* Hashes the parameters of a geometry in any order: a --set text puts its own behind the others. */
static void hash_parameters(sf_case *out, const sf_key *key, const sf_geo_source *source) {
    uint64_t sum = 0;
    for (int k = 0; k < source->parameter_count; k++) {
        const sf_geo_parameter *p = &source->parameter[k];
        sum +=
            sf_hash_bytes(sf_hash_bytes(SF_HASH_START, p->name, strlen(p->name)), &p->value, sizeof p->value);
    }
    out->values = sf_hash_bytes(sf_hash_bytes(out->values, key->name, strlen(key->name)), &sum, sizeof sum);
}

/* `detail`: the value in SI. Texts end with a zero: no two lists of values look the same. */
static void hash_value(sf_case_reader *reader, const sf_key *key, const char *name, const char *text,
                       const char *detail) {
    sf_case *out = reader->out;
    const char *const part[] = {name, text, detail};
    if (key->kind == SF_KEY_PARAMETERS)
        hash_parameters(out, key,
                        (const sf_geo_source *)(const void *)(sf_case_home(reader, key) + key->offset));
    for (int k = 0; k < 3 && key->kind != SF_KEY_PARAMETERS && !names_files(key) && !key->idle; k++)
        out->values = sf_hash_bytes(out->values, part[k], strlen(part[k]) + 1);
}

/* A kind of key that is not listed is of SF_CASE_VALUE_OTHER. */
static const sf_case_value_kind value_kind[SF_KEY_CURVES + 1] = {
    [SF_KEY_QUANTITY] = SF_CASE_VALUE_TEXT,   [SF_KEY_UNIT] = SF_CASE_VALUE_TEXT,
    [SF_KEY_NAME] = SF_CASE_VALUE_TEXT,       [SF_KEY_NAMES] = SF_CASE_VALUE_LIST,
    [SF_KEY_FIELDS] = SF_CASE_VALUE_LIST,     [SF_KEY_TIMES] = SF_CASE_VALUE_LIST,
    [SF_KEY_QUANTITIES] = SF_CASE_VALUE_LIST, [SF_KEY_VECTOR] = SF_CASE_VALUE_LIST,
    [SF_KEY_PLACE] = SF_CASE_VALUE_LIST,      [SF_KEY_COUNTED] = SF_CASE_VALUE_LIST,
    [SF_KEY_NUMBER] = SF_CASE_VALUE_NUMBER,   [SF_KEY_DROPS] = SF_CASE_VALUE_NUMBER,
    [SF_KEY_BOOL] = SF_CASE_VALUE_FLAG,       [SF_KEY_CHOICE] = SF_CASE_VALUE_WORD,
    [SF_KEY_PATH] = SF_CASE_VALUE_FILE,       [SF_KEY_MOTION] = SF_CASE_VALUE_FILE,
};

/* A text without the quotes that its print has. */
static void tell_value(const sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                       const char *text, bool given) {
    const char *plain = setting ? config_setting_get_string(setting) : NULL;
    bool list = key->kind == SF_KEY_DROPS && setting && config_setting_is_list(setting);
    if (!setting)
        text = "";
    else if (plain)
        text = plain;
    const sf_case_value value = {.group = key->group,
                                 .name = key->name,
                                 .text = text,
                                 .given = given,
                                 .kind = list ? SF_CASE_VALUE_OTHER : value_kind[key->kind],
                                 .of_material = key->in_card || key->kind == SF_KEY_LAW,
                                 .words = key->words,
                                 .help = key->description};
    if (reader->listener && !reader->material_only && !reader->list)
        reader->listener->hear(reader->listener->user, &value);
}

static void list_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                       const char *detail, const char *origin) {
    SF_OWNED SF_TEXT_STREAM(value, text, size);
    if (!value)
        return;
    if (setting)
        sf_case_print_setting(value, setting);
    else
        fputs("(absent)", value);
    fclose(value);
    char name[SF_CASE_GROUP_SIZE];
    if (reader->list)
        snprintf(name, sizeof name, "%s.%d.%s", config_setting_name(reader->list), reader->item + 1,
                 key->name);
    else
        snprintf(name, sizeof name, "%s.%s", key->group, key->name);
    fprintf(reader->listing, "%-34s %-24s %-24s %s\n", name, text ? text : "", detail, origin);
    hash_value(reader, key, name, text ? text : "", detail);
    tell_value(reader, key, setting, text ? text : "", strcmp(origin, "given") == 0);
}

static sf_status read_default(sf_case_reader *reader, const sf_key *key, sf_error *err) {
    SF_OWNED_BY(config_destroy) config_t scratch;
    config_init(&scratch);
    char line[512], detail[128] = "-";
    snprintf(line, sizeof line, "%s = %s;", key->name, key->fallback);
    if (!config_read_string(&scratch, line))
        return SF_REFUSE(err, "the default of %s.%s is not valid: %s", key->group, key->name, line);
    const config_setting_t *value = config_setting_get_elem(scratch.root, 0);
    SF_TRY(sf_case_read_value(reader, key, value, detail, sizeof detail, err));
    list_value(reader, key, value, detail, "default");
    return SF_OK;
}

static sf_status read_layers(sf_case_reader *reader, sf_error *err);
static sf_status read_supports(sf_case_reader *reader, size_t first, sf_error *err);
static sf_status read_interfaces(sf_case_reader *reader, size_t first, sf_error *err);

/* Reads the value of row `k` of the keys from its setting; NULL: it is not given. */
static sf_status read_key(sf_case_reader *reader, size_t k, const config_setting_t *setting, sf_error *err) {
    const sf_key *key = &reader->keys.key[k];
    char detail[128] = "-";
    reader->given[k] = setting != NULL;
    if (key->kind == SF_KEY_LAW)
        snprintf(detail, sizeof detail, "%s", reader->material->law->name);
    if (setting) {
        SF_TRY(sf_case_read_value(reader, key, setting, detail, sizeof detail, err));
        list_value(reader, key, setting, detail, "given");
    } else if (!key->fallback) {
        return sf_case_missing_key(reader, key, err);
    } else if (*key->fallback == '\0') {
        list_value(reader, key, NULL, detail, "default");
    } else {
        return read_default(reader, key, err);
    }
    return SF_OK;
}

static sf_status read_keys(sf_case_reader *reader, sf_error *err) {
    for (size_t k = 0; k < reader->keys.count; k++) {
        const sf_key *key = &reader->keys.key[k];
        const config_setting_t *group = config_lookup(&reader->config, key->group);
        bool of_material = key->in_card || key->kind == SF_KEY_LAW;
        if (reader->material_only && !of_material)
            continue;
        if (reader->layers && key->kind == SF_KEY_LAW)
            SF_TRY(read_layers(reader, err));
        if (!reader->layers && key->kind == SF_KEY_LAW)
            SF_TRY(sf_case_read_response_error(reader, err));
        if (reader->layers && of_material)
            continue;
        if (!key->list)
            SF_TRY(read_key(reader, k, group ? config_setting_get_member(group, key->name) : NULL, err));
        else if (reader->keys.key[k - 1].list != key->list)
            SF_TRY((key->list == SF_LIST_SUPPORTS ? read_supports : read_interfaces)(reader, k, err));
    }
    return SF_OK;
}

/* Derives values from those read; the only function that changes values after reading. */
static void complete(const sf_case_reader *reader, sf_case *c) {
    sf_missile_card *card = &c->missile_card;
    double turn[9];
    sf_unit3(card->direction);
    sf_unit3(card->down);
    sf_unit3(c->up);
    sf_turn_to_z(c->up, turn);
    sf_mat3_apply(turn, card->direction);
    sf_mat3_apply(turn, card->down);
    sf_mat3_apply(turn, c->angular_velocity);
    sf_mat3_apply(turn, c->centre);
    sf_sym3_turn(turn, c->inertia);
    c->pad.unit = c->length_unit;
    c->missile.unit = c->missile.unit > 0 ? c->missile.unit : c->length_unit;
    for (int k = 0; k < c->support_count; k++) {
        sf_geo_source *source = &c->support[k].source;
        source->unit = source->unit > 0 ? source->unit : c->length_unit;
        sf_unit3(c->support[k].normal);
    }
    if (c->motion_count > 0)
        card->gravity = 0.0;
    c->position_given = sf_case_is_given(reader, "missile", "position");
    c->symmetry_given = sf_case_is_given(reader, "pad", "symmetry");
}

/* The law, on which the other keys of the material depend, and its card. */
static sf_status choose_law(sf_case_reader *reader, sf_error *err) {
    SF_PRINTED(path, SF_CASE_GROUP_SIZE, "%s.law", reader->material_group);
    const config_setting_t *setting = config_lookup(&reader->config, path);
    const char *name = setting ? config_setting_get_string(setting) : NULL;
    const sf_law *law = NULL;
    if (!setting)
        law = sf_law_get(0);
    else if (name)
        law = sf_law_find(name);
    if (!law) {
        char known[256] = "";
        for (int k = 0; sf_law_get(k); k++)
            sf_text_add(known, sizeof known, "%s%s", k ? ", " : "", sf_law_get(k)->name);
        return SF_REFUSE_AT(reader, setting, err, "%s: \"%.80s\" is none of: %s", path, name ? name : "",
                            known);
    }
    if (reader->material_only && strcmp(reader->material_group, "material") != 0)
        sf_case_list_layer_keys(law, reader->material_group, &reader->keys);
    else
        sf_case_list_keys(law, &reader->keys);
    return reader->layers ? SF_OK : sf_material_create(law, reader->material, err);
}

/* The material of one layer, by the same keys as those of `material`. */
static sf_status read_layer(const sf_case_reader *reader, const config_setting_t *setting,
                            sf_material *material, sf_error *err) {
    SF_OWN(sf_case_reader, own, 1, "a layer's material", err);
    *own = *reader;
    own->layers = NULL;
    own->material_only = true;
    own->material = material;
    snprintf(own->material_group, sizeof own->material_group, "materials.%s", config_setting_name(setting));
    if (choose_law(own, err) == SF_OK && check_names(own, setting, own->material_group, err) == SF_OK &&
        read_keys(own, err) == SF_OK && sf_case_check_card(own, err) == SF_OK)
        snprintf(material->name, sizeof material->name, "%s", config_setting_name(setting));
    return err->status;
}

static sf_status read_layers(sf_case_reader *reader, sf_error *err) {
    sf_case *c = reader->out;
    int count = config_setting_length(reader->layers);
    c->layer = sf_alloc(err, count, sizeof *c->layer, "materials");
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        const config_setting_t *setting = config_setting_get_elem(reader->layers, (unsigned)k);
        const char *name = config_setting_name(setting);
        if (!config_setting_is_group(setting))
            return SF_REFUSE_AT(reader, setting, err,
                                "materials.%.80s must be a group, the material of the volume of this name: "
                                "materials = { NAME = { density = ...; }; }",
                                name);
        if (strlen(name) >= SF_MATERIAL_NAME_SIZE)
            return SF_REFUSE_AT(reader, setting, err,
                                "materials: the name \"%.80s\" is longer than %d characters", name,
                                SF_MATERIAL_NAME_SIZE - 1);
        c->layer_count++;
        read_layer(reader, setting, &c->layer[k], err);
    }
    return err->status;
}

/* A support is a surface of a file, or a plane. `group`: its settings; NULL: there is none. */
static sf_status check_support(const sf_case_reader *reader, const config_setting_t *group, sf_error *err) {
    const sf_case_support *s = &reader->out->support[reader->item];
    bool plane = sf_dot3(s->normal, s->normal) > 0;
    if (group && plane == (s->source.path != NULL))
        return SF_REFUSE_AT(reader, group, err,
                            "a support is either the surface of a file, { file = \"post.geo\"; }, or a plane "
                            "with the normal towards the pad, { plane = [0.0, 0.0, 1.0]; }");
    const config_setting_t *wrong = NULL;
    if (group)
        wrong = config_setting_get_member(group, plane ? "parameters" : "place");
    if (group && plane && !wrong)
        wrong = config_setting_get_member(group, "group");
    if (wrong)
        return SF_REFUSE_AT(reader, wrong, err, "support.%s has no meaning for a support that is %s",
                            config_setting_name(wrong), plane ? "a plane" : "the surface of a file");
    return SF_OK;
}

/* Reads an item of a list, of the settings `group` (NULL: absent), by the rows of keys from `first` on. */
static sf_status read_item(sf_case_reader *reader, size_t first, const config_setting_t *group,
                           sf_error *err) {
    const sf_key *key = reader->keys.key;
    for (size_t k = first; k < reader->keys.count && key[k].list == key[first].list; k++)
        SF_TRY(read_key(reader, k, group ? config_setting_get_member(group, key[k].name) : NULL, err));
    return SF_OK;
}

/* Reads the group `support`, or each of the list `supports`, by the rows of the keys from `first` on. */
static sf_status read_supports(sf_case_reader *reader, size_t first, sf_error *err) {
    sf_case *c = reader->out;
    const config_setting_t *one = config_lookup(&reader->config, "support"),
                           *several = reader->list = config_lookup(&reader->config, "supports");
    int count = several ? config_setting_length(several) : one != NULL;
    if (several && (one || count < 1 || count > SF_SUPPORTS || config_setting_is_array(several)))
        return SF_REFUSE_AT(reader, several, err,
                            "supports must be a list of 1 to %d supports, in place of a group support: "
                            "supports = ( { file = \"post.geo\"; }, { plane = [0.0, 0.0, 1.0]; } )",
                            SF_SUPPORTS);
    for (int n = 0; n < count || n == 0; n++) {
        const config_setting_t *group = several ? config_setting_get_elem(several, (unsigned)n) : one;
        if (several && !config_setting_is_group(group))
            return SF_REFUSE_AT(reader, group, err, "a support must be a group: { file = \"post.geo\"; }");
        if (several)
            SF_TRY(check_names(reader, group, "support", err));
        reader->item = n;
        SF_TRY(read_item(reader, first, group, err));
        SF_TRY(check_support(reader, group, err));
    }
    reader->list = NULL;
    c->support_count = count;
    c->support_alone = one != NULL;
    return SF_OK;
}

/* Reads each of the list `interfaces` likewise. */
static sf_status read_interfaces(sf_case_reader *reader, size_t first, sf_error *err) {
    const config_setting_t *list = reader->list = config_lookup(&reader->config, "interfaces");
    int count = list ? config_setting_length(list) : 0;
    if (list && (count < 1 || count > SF_CASE_MAX_INTERFACES / 2 || !config_setting_is_aggregate(list) ||
                 config_setting_is_array(list)))
        return SF_REFUSE_AT(reader, list, err,
                            "interfaces must be a list of 1 to %d interfaces: interfaces = ( { between = "
                            "[\"upper\", \"cover\"]; kind = \"loose\"; friction = 0.3; } )",
                            SF_CASE_MAX_INTERFACES / 2);
    for (int n = 0; n < count; n++) {
        const config_setting_t *group = config_setting_get_elem(list, (unsigned)n);
        if (!config_setting_is_group(group))
            return SF_REFUSE_AT(reader, group, err,
                                "an interface must be a group: { between = [\"upper\", \"cover\"]; kind = "
                                "\"loose\"; }");
        SF_TRY(check_names(reader, group, "interfaces", err));
        reader->item = n;
        reader->entry = (sf_interface_entry){.friction = NAN};
        SF_TRY(read_item(reader, first, group, err));
        SF_TRY(sf_case_add_interface(reader, group, err));
    }
    reader->list = NULL;
    return SF_OK;
}

/* The group `materials`, if there is one; `parted`: the case file has it, and no group `material`. */
static sf_status find_layers(sf_case_reader *reader, bool parted, sf_error *err) {
    const config_setting_t *found = config_lookup(&reader->config, "materials");
    int count = found && config_setting_is_group(found) ? config_setting_length(found) : 0;
    reader->layers = found;
    if (found && config_lookup(&reader->config, "material"))
        return SF_REFUSE_AT(
            reader, found, err, "%s",
            parted ? "the pad is of layers, each with a material of its own: there is no place for one "
                     "material from outside the case file; a layer takes it as materials.NAME (--set "
                     "materials.NAME=@FILE)"
                   : "the case has both material and materials: the first is for a pad of one material, "
                     "the second for one of layers");
    if (found && (count < 1 || count > SF_CASE_MAX_LAYERS))
        return SF_REFUSE_AT(reader, found, err,
                            "materials must be a group with the materials of 1 to %d layers by the names of "
                            "their volumes: materials = { NAME = { density = ...; }; }",
                            SF_CASE_MAX_LAYERS);
    return SF_OK;
}

static sf_status parse_text(sf_case_reader *reader, int count, const char *const *overrides, sf_error *err) {
    config_t *config = &reader->config;
    if (!config_read_string(config, reader->out->text)) {
        int line = 0;
        const char *path = sf_case_source_find(&reader->source, config_error_line(config), &line);
        return SF_REFUSE(
            err, "%s:%d: %s", path, line,
            sf_case_syntax_phrase(config_error_text(config), reader->out->text, config_error_line(config)));
    }
    bool parted = config_lookup(config, "materials") && !config_lookup(config, "material");
    for (int i = 0; i < count; i++)
        SF_TRY(sf_case_override(config, overrides[i], err));
    if (sf_case_take_drop(reader, reader->drop, err) != SF_OK || find_layers(reader, parted, err) != SF_OK ||
        choose_law(reader, err) != SF_OK)
        return err->status;
    return check_names(reader, config_root_setting(config), "", err);
}

/* Opens what a reader needs, and reads the text of the case or, of a material alone, puts its file in place
 * of the group. */
static sf_status begin_reading(sf_case_reader *reader, int count, const char *const *overrides,
                               sf_error *err) {
    sf_case *c = reader->out;
    SF_OWNED char *material = NULL;
    config_init(&reader->config);
    config_set_destructor(&reader->config, free); /* of the hooks */
    reader->listing = open_memstream(&c->parameters, &reader->listing_size);
    c->path = strdup(reader->path);
    if (!reader->listing || !c->path || asprintf(&material, "material=@%s", reader->path) < 0)
        return SF_NO_MEMORY(err, "the case %s", reader->path);
    if (sf_units_open(&reader->units, err) == SF_OK && reader->material_only) {
        if (sf_case_override(&reader->config, material, err) == SF_OK && choose_law(reader, err) == SF_OK)
            check_names(reader, config_root_setting(&reader->config), "", err);
    } else if (err->status == SF_OK &&
               (c->text = sf_case_load_text(reader->path, true, count, overrides, &reader->source, err))) {
        parse_text(reader, count, overrides, err);
    }
    return err->status;
}

static void end_reading(sf_case_reader *reader) {
    if (reader->listing)
        fclose(reader->listing);
    sf_units_close(&reader->units);
    config_destroy(&reader->config);
    sf_case_source_free(&reader->source);
}

sf_status sf_case_read_values(const sf_case_input *input, const sf_sink *sink,
                              const sf_case_listener *listener, sf_case *out, sf_error *err) {
    *out = (sf_case){.values = SF_HASH_START, .store = sf_store_folder(NULL)};
    sf_case_reader reader = {.path = input->path,
                             .out = out,
                             .drop = input->drop,
                             .sink = sink,
                             .material = &out->material,
                             .material_group = "material",
                             .listener = listener};
    if (begin_reading(&reader, input->count, input->overrides, err) == SF_OK &&
        read_keys(&reader, err) == SF_OK && sf_case_check_given(&reader, err) == SF_OK) {
        complete(&reader, out);
        sf_case_check_complete(&reader, err);
    }
    end_reading(&reader);
    if (err->status != SF_OK)
        sf_case_free(out);
    return err->status;
}

sf_status sf_case_read(const char *path, int count, const char *const *overrides, const sf_sink *sink,
                       sf_case *out, sf_error *err) {
    return sf_case_read_values(&(sf_case_input){path, 1, count, overrides}, sink, NULL, out, err);
}

/* The keys of a material file alone, into an empty case. */
static sf_status read_alone(const char *path, sf_case *scratch, sf_error *err) {
    sf_case_reader reader = {.path = path,
                             .out = scratch,
                             .material = &scratch->material,
                             .material_group = "material",
                             .material_only = true};
    if (begin_reading(&reader, 0, NULL, err) == SF_OK && read_keys(&reader, err) == SF_OK)
        sf_case_check_card(&reader, err);
    end_reading(&reader);
    return err->status;
}

sf_status sf_case_check_material(const char *path, double temperature, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case scratch = {.run.temperature = temperature};
    return read_alone(path, &scratch, err);
}

sf_status sf_case_read_material(const char *path, double temperature, sf_material *material,
                                char **parameters, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case scratch = {.run.temperature = temperature};
    *material = (sf_material){0};
    if (read_alone(path, &scratch, err) != SF_OK)
        return err->status;
    *material = scratch.material;
    scratch.material = (sf_material){0};
    if (parameters) {
        *parameters = scratch.parameters;
        scratch.parameters = NULL;
    }
    return SF_OK;
}
