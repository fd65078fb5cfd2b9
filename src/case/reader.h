/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the readers of a case's keys: the case under construction, the location of a setting, the keys
 * given. Internal to src/case. */
#pragma once
#include "case/keys.h"
#include "case/grammar.h"

typedef struct sf_case_reader {
    const char *path; /* of the case file, as given */
    sf_units *units;
    sf_case *out;
    config_t config;
    sf_case_source source;                  /* of the settings without a hook */
    sf_key_list keys;                       /* of the case's law */
    const config_setting_t *layers;         /* the group `materials`; NULL: one material */
    sf_material *material;                  /* under construction */
    char material_group[SF_KEY_GROUP_SIZE]; /* "material", or "materials.NAME" */
    bool given[SF_KEY_MAX];                 /* per row of `keys` */
    bool thermal;                           /* the material has curves at several temperatures */
    bool material_only;                     /* read the keys of the material, and no others */
    const config_setting_t *list;           /* of groups, under construction; NULL: none */
    int item;                               /* of it */
    sf_interface_entry entry;               /* likewise, if the list is `interfaces` */
    int drop;                               /* of the series, from 1; 0: a material alone */
    const sf_sink *sink;                    /* borrowed */
    FILE *listing;                          /* the parameters text under construction */
    size_t listing_size;
    const struct sf_case_listener *listener; /* of each value; NULL: nobody; borrowed */
} sf_case_reader;

enum { SF_CASE_GROUP_SIZE = 200 /* of a text "group.key" */ };

/* The hook of a setting that does not stand in the case file: line 0: `text` is the --set text that put it
 * there; else the path of the file, given with "group=@file", and the line that holds it. */
typedef struct sf_case_origin {
    unsigned line;
    char text[];
} sf_case_origin;

/* The structure of which a key's value is a member. */
static inline char *sf_case_home(sf_case_reader *reader, const sf_key *key) {
    return key->in_card                      ? reader->material->card
           : key->list == SF_LIST_SUPPORTS   ? (char *)&reader->out->support[reader->item]
           : key->list == SF_LIST_INTERFACES ? (char *)&reader->entry
                                             : (char *)reader->out;
}

/* "file:line", or "--set key=value" for a setting that came from the command line. */
const char *sf_case_where(const sf_case_reader *reader, const config_setting_t *setting, char *out);
/* The setting "group.name", of the reader's material if it is one of "material"; else its group; NULL:
 * neither is there. */
const config_setting_t *sf_case_setting(const sf_case_reader *reader, const char *path);
/* Records "where: sentence", SF_ERR_INPUT, for a setting; NULL: the file. */
#define SF_REFUSE_AT(reader, setting, err, ...)                                                              \
    sf_case_refuse(reader, setting, err, __FILE__, __LINE__, __VA_ARGS__)
sf_status sf_case_refuse(const sf_case_reader *reader, const config_setting_t *setting, sf_error *err,
                         const char *file, int line, const char *format, ...)
    __attribute__((format(printf, 6, 7)));
/* Resolves `path` against the folder of the file in which `setting` stands; from malloc. */
char *sf_case_resolve(const sf_case_reader *reader, const config_setting_t *setting, const char *path,
                      sf_error *err);
/* True if the case gives the key. */
bool sf_case_is_given(const sf_case_reader *reader, const char *group, const char *name);
/* Records that the key is missing. */
sf_status sf_case_missing_key(const sf_case_reader *reader, const sf_key *key, sf_error *err);

/* Values from the command line. Internal to src/case. */

/* Puts one --set text into the configuration, whose destructor must be free(). */
sf_status sf_case_override(config_t *config, const char *text, sf_error *err);
/* Puts what the list `series.drops` says of a drop, from 1, into the group `missile`. */
sf_status sf_case_take_drop(sf_case_reader *reader, int drop, sf_error *err);
