/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the readers of a case's keys: the case under construction, the location of a setting, the keys
 * given. Internal to src/case. */
#pragma once
#include "case/keys.h"
#include "case/grammar.h"
#include "io/table_csv.h"

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

/* The rules that join several keys of a case, or a key with the law of the material. Each refusal is
 * SF_ERR_INPUT with place, key, value and bound. Internal to src/case. */

/* Puts an entry of the list `interfaces`, that of the reader, into the case; `group`: its settings. */
sf_status sf_case_add_interface(const sf_case_reader *reader, const config_setting_t *group, sf_error *err);
/* The card of the reader's material, and the law as the solver will build it. */
sf_status sf_case_check_card(const sf_case_reader *reader, sf_error *err);
/* The values as they are given. */
sf_status sf_case_check_given(const sf_case_reader *reader, sf_error *err);
/* The complete case; warnings go to the reader's sink. */
sf_status sf_case_check_complete(const sf_case_reader *reader, sf_error *err);

/* One setting of each kind of key. Internal to src/case. */

/* Reads one setting into the case. `detail` receives the SI value for the listing. */
sf_status sf_case_read_value(sf_case_reader *reader, const sf_key *key, const config_setting_t *setting,
                             char *detail, size_t size, sf_error *err);

/* The group response_error of a material, which belongs to no law: softfall-fit drop writes it into the draws
 * of a posterior, softfall-cfh uses it, the other programs check it and leave it. Internal to src/case. */

#define SF_RESPONSE_ERROR "response_error"

/* True if this is the group `response_error` in the group of the reader's material. */
bool sf_case_is_response_error(const sf_case_reader *reader, const char *group, const char *name);

/* Reads it into the case, if the material has it. SF_ERR_INPUT: no group, an unknown key, a value that is no
 * number or out of bounds, an error without its standard deviation. Of a layer it is checked only. */
sf_status sf_case_read_response_error(sf_case_reader *reader, sf_error *err);

/* Values from the command line. Internal to src/case. */

/* Puts one --set text into the configuration, whose destructor must be free(). */
sf_status sf_case_override(config_t *config, const char *text, sf_error *err);
/* Puts what the list `series.drops` says of a drop, from 1, into the group `missile`. */
sf_status sf_case_take_drop(sf_case_reader *reader, int drop, sf_error *err);

/* A compression curve from a CSV file (io/table_csv.h): columns `strain` or `strain_percent` and `stress_Pa`,
 * `stress_kPa` or `stress_MPa`, or a strain and a stress with units; then one point per line. Engineering
 * strain and nominal stress, positive in compression. */

enum { SF_CURVE_MIN_POINTS = 4 };
#define SF_CURVE_MIN_END 0.2 /* a shorter table does not cover the strains of an impact */

typedef struct sf_case_curve {
    int64_t count;
    double *strain;                               /* [count] -, strictly increasing from 0, below 1; owned */
    double *stress;                               /* [count] Pa, from 0, non-decreasing, finite; owned */
    char interpretation[SF_TABLE_INTERPRETATION]; /* how the file was read; empty: plainly */
    bool extended; /* the file began above zero strain and (0, 0) was put before it */
} sf_case_curve;

/* Returns the layout of a curve file, also of tests with unloading; `what` names the file in sentences. */
sf_table_layout sf_case_curve_layout(const char *what, sf_table_check *check);

/* Reads and checks a curve; SF_ERR_INPUT names file, line and value. On failure `*curve` is zeroed. */
sf_status sf_case_curve_read(const char *path, sf_case_curve *curve, sf_error *err);
void sf_case_curve_free(sf_case_curve *curve);

/* The keys material.curve and material.curves. Internal to src/case. */

/* The readers of SF_KEY_CURVE and SF_KEY_CURVES. */
sf_status sf_case_read_curves(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);
/* The reader of SF_KEY_MOTION, the displacement over time of a missile that a machine drives. */
sf_status sf_case_read_motion(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);
