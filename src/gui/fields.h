/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdbool.h>

#include "case/case.h"
#include "gui/gmsh/window.h"

/* The parameters of a .geo file: gmsh's tree knows them by their Name, a case by their variable. gmsh tells
 * no one which belongs to which, so the text of the file (and of what it includes) is looked through:
 * DefineConstant and DefineNumber with a Name that is written out. */

enum { SF_GEO_LABEL_SIZE = 256, SF_GEO_NAMES = 128 };

typedef struct sf_geo_name {
    char variable[SF_CASE_NAME_SIZE]; /* "thickness" */
    char name[SF_GEO_LABEL_SIZE];      /* "Pad/2 Thickness [mm]" */
} sf_geo_name;

typedef struct sf_geo_names {
    int count;
    sf_geo_name name[SF_GEO_NAMES];
} sf_geo_names;

/* Reads the names that a geometry defines; a file that is no text of gmsh's language has none. Errors: the
 * file cannot be read. */
sf_status sf_geo_names_read(const char *path, sf_geo_names *names, sf_error *err);
/* Adds the names that a text defines. */
void sf_geo_names_scan(const char *text, sf_geo_names *names);

/* The fields of the tree: the keys of the case, from the table of keys, and the parameters of its geometries.
 * A field that differs from the case is an override, as --set takes it; nothing else of the tree reaches a
 * run. */

enum {
    SF_FIELDS = 160,
    SF_FIELD_KEY_SIZE = 192,
    SF_FIELD_NAME_SIZE = 288,
    SF_FIELD_TEXT_SIZE = 512,
    SF_FIELD_OVERRIDES = 56 /* softfall-pre takes 64 */
};

typedef struct sf_field {
    char key[SF_FIELD_KEY_SIZE];    /* "missile.velocity", "geometry.parameters.thickness", "material" */
    char name[SF_FIELD_NAME_SIZE];  /* of its entry in the tree */
    char given[SF_FIELD_TEXT_SIZE]; /* as the case (or the default of the key or the geometry) has it */
    char now[SF_FIELD_TEXT_SIZE];   /* as the tree has it */
    sf_entry_kind kind;
    const char *words, *help; /* static */
    bool of_geometry;         /* an entry that the geometry makes */
    bool in_case;             /* of a geometry: the case gives it */
    bool wrong;               /* it is marked */
} sf_field;

typedef struct sf_fields {
    int count;
    sf_field field[SF_FIELDS];
} sf_fields;

/* An override as a text. */
typedef struct sf_overrides {
    int count;
    char *text[SF_FIELD_OVERRIDES]; /* owned */
} sf_overrides;

/* Reads the keys of the case without overrides; `now` is kept of the fields that were there before and
 * differed from their case. Parameters of geometries are gone: sf_fields_add_geometry. The case is the
 * caller's. */
sf_status sf_fields_read(const char *case_path, const sf_sink *sink, sf_fields *fields, sf_case *out,
                         sf_error *err);
/* Adds the parameters `names` of a geometry, key "group.VARIABLE", with what the case gives; others are known
 * once the geometry was read: sf_fields_take_defaults. `before`: the fields as they were, for what was
 * changed; or NULL. */
void sf_fields_add_geometry(const char *group, const sf_geo_names *names, const sf_geo_source *source,
                            const sf_fields *before, sf_fields *fields);

/* Puts the fields into the tree: those of the case, and the values of the geometries' parameters that are
 * known. */
void sf_fields_show(const sf_fields *fields);
/* After a geometry was read: what the case does not give is as the tree has it. */
void sf_fields_take_defaults(sf_fields *fields);
/* Takes the values that the tree has. *case_changed, *geometry_changed: a field has another value than
 * before. */
void sf_fields_take(sf_fields *fields, bool *case_changed, bool *geometry_changed);
/* Puts `text` into the entry of that key, as a user does; false: there is none. */
bool sf_fields_enter(const sf_fields *fields, const char *key, const char *text);
const sf_field *sf_fields_find(const sf_fields *fields, const char *key);

/* The overrides; release with sf_overrides_free, also on failure. SF_ERR_INPUT: too many, or
 * parameters of both geometries in one entry of the tree. */
sf_status sf_fields_overrides(const sf_fields *fields, sf_overrides *out, sf_error *err);
void sf_overrides_free(sf_overrides *overrides);

/* Parameters of geometries whose variables are not known can be seen, not changed: no run would have them. */
void sf_fields_lock_unknown(sf_fields *fields);

/* Marks the fields that the sentence of an error names (NULL: none), in the tree too. */
void sf_fields_mark(sf_fields *fields, const char *sentence);
