/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/near.h"
#include "case/case.h"
#include <libconfig.h>

/* The table of the case file's keys. Internal to src/case.
 *
 * One row per key drives reading, checking, the list of unknown keys, the used-parameters listing, `--keys`
 * and docs/case.md. The rows of a material are those of its law (material/card.h). Defaults are texts in
 * libconfig syntax and pass through the same reader as given values.
 */

/* The kind says how a value is written in the case, and which type the member at the key's offset in
 * sf_case has. */
typedef enum sf_key_kind {
    SF_KEY_QUANTITY,   /* "4.6 kg" or the word `words`: double, SI (the word's value is `word_value`) */
    SF_KEY_UNIT,       /* "mm": double, m per unit */
    SF_KEY_NUMBER,     /* 0.9: double */
    SF_KEY_BOOL,       /* true: int64_t */
    SF_KEY_NAME,       /* "pad": char[SF_CASE_NAME_SIZE] */
    SF_KEY_NAMES,      /* ["base"]: char[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE], int at count_offset */
    SF_KEY_CHOICE,     /* one of `words` ("a|b"): int, its index */
    SF_KEY_FIELDS,     /* list of `words`: int64_t, bit k for word k */
    SF_KEY_TIMES,      /* ["12 ms", "20 ms"]: double[SF_CASE_MAX_TIMES] ascending, s; int at count_offset */
    SF_KEY_QUANTITIES, /* ["0 mm", "0 mm", "50 mm"]: double[..], SI; int at count_offset, one of `lengths` */
    SF_KEY_VECTOR,     /* [0.0, 0.0, -1.0]: double[3] */
    SF_KEY_PLACE,      /* ["10 mm", "0 mm"]: double[2], SI */
    SF_KEY_PATH,       /* "file": char *, relative to the file that holds the key; must be readable */
    SF_KEY_PARAMETERS, /* { side = 400.0; }: sf_geo_source */
    SF_KEY_LAW,        /* the name of a law: sf_case.material */
    SF_KEY_CURVE,      /* "curve.csv": the card's curves */
    SF_KEY_MOTION,     /* "motion.csv": the motion arrays */
    SF_KEY_DROPS,      /* 3, or ( { velocity = "5 m/s"; }, ... ): double, their number; sf_case.drop */
    SF_KEY_COUNTED,    /* [2, 3], drops of the series: int64_t, bit k for drop k + 1 */
    SF_KEY_CURVES,     /* ( { rate = "1 1/s"; file = "curve.csv"; }, ... ): likewise */
} sf_key_kind;

typedef struct sf_key {
    const char *group; /* "missile", or "material.densification" */
    const char *name;
    sf_key_kind kind;
    const char *fallback;    /* default in libconfig syntax; NULL: required; "": may be absent */
    size_t offset;           /* in sf_case, or in the card of its material if in_card */
    const char *description; /* one phrase */
    sf_quantity quantity;    /* SF_KEY_QUANTITY */
    double low, high;        /* bounds in SI, inclusive; high 0 = none */
    bool low_open;           /* the lower bound itself is refused */
    const char *words;       /* see sf_key_kind; NULL = none */
    double word_value;
    size_t count_offset; /* SF_KEY_NAMES, SF_KEY_TIMES, SF_KEY_QUANTITIES */
    int lengths[2];      /* SF_KEY_QUANTITIES; the second may be 0 */
    bool in_card;        /* a parameter of the law */
    int list;            /* SF_LIST_*: the list of groups that has the key; 0: none */
    bool idle;           /* its value cannot change a drop: it does not count in sf_case.values */
} sf_key;

enum { SF_KEY_MAX = 160 };

/* Lists of groups in the case, and where the offsets of their keys lead: sf_case_support,
 * sf_interface_entry. */
enum { SF_LIST_SUPPORTS = 1, SF_LIST_INTERFACES };

/* An entry of the list `interfaces`, as it is given. */
typedef struct sf_interface_entry {
    int between_count;
    char between[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    int kind;        /* SF_INTERFACE_* */
    double friction; /* -; NaN: not given */
} sf_interface_entry;

enum { SF_KEY_GROUP_SIZE = 160, SF_KEY_LAYER_GROUPS = 8 };

typedef struct sf_key_list {
    sf_key key[SF_KEY_MAX];
    size_t count;
    char layer_group[SF_KEY_LAYER_GROUPS][SF_KEY_GROUP_SIZE]; /* names that keys of a layer point to */
} sf_key_list;

/* The keys of a case with this law. */
void sf_case_list_keys(const sf_law *law, sf_key_list *list);
/* Only the keys of a material with this law, whose group is `group` in place of "material". The list must
 * stay where it is. */
void sf_case_list_layer_keys(const sf_law *law, const char *group, sf_key_list *list);
/* "material" or what lies below it, in the group that stands in its place. */
void sf_case_material_path(const char *group, const char *path, char *out, size_t size);
/* The row of group.name; NULL if there is none. */
const sf_key *sf_case_find_key(const sf_key_list *list, const char *group, const char *name);
/* True if `group` is, or begins, the group of some key. */
bool sf_case_is_group(const sf_key_list *list, const char *group);
/* Writes "name, name, ..." of the keys and sub-groups of a group ("" = the groups). */
void sf_case_list_names(const sf_key_list *list, const char *group, char *out, size_t size);
/* Writes the hint about the existing name nearest to `name` (base/near.h); returns `out`. */
const char *sf_case_near_hint(const sf_key_list *list, const char *group, const char *name,
                              char out[SF_NEAR_HINT]);
