/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/lanes.h"
#include "base/units.h"

/* sf_law: a material law, as one constant entry of the table in material/laws.h (which says how to add
 * one). Its parameters are declared once, in `parameter`: that list drives the keys of the case file,
 * `softfall-pre --keys`, the check of a model, model.h5 and written material files. A card is the values of
 * the parameters, a struct of the law's own; all other code accesses it by the offsets given here.
 *
 * Points are updated in batches (sf_law_batch) with the data that `build` derives from a card. Pure functions
 * throughout. */

struct sf_law_batch; /* material/laws.h */
struct sf_uniaxial;

typedef enum sf_parameter_kind {
    SF_PARAMETER_NUMBER,   /* double, dimensionless */
    SF_PARAMETER_QUANTITY, /* double, SI */
    SF_PARAMETER_CHOICE,   /* int64_t, index of one of `words` */
    SF_PARAMETER_CURVE,    /* one compression curve into the card's sf_law_curves */
    SF_PARAMETER_CURVES,   /* curves at several strain rates, instead */
} sf_parameter_kind;

typedef struct sf_parameter {
    const char *group; /* of the case: "material" or "material.NAME" */
    const char *key;
    sf_parameter_kind kind;
    const char *fallback; /* default in libconfig syntax; NULL: required; "": may be absent */
    size_t offset;        /* in the card */
    const char *meaning;  /* one phrase */
    sf_quantity quantity; /* SF_PARAMETER_QUANTITY */
    double low, high;     /* bounds in SI, inclusive */
    bool low_open;        /* the lower bound itself is refused */
    const char *words;    /* of a choice "a|b"; of a quantity: a word instead of a value, with `word_value` */
    double word_value;    /* beyond the bounds */
    const char *unit;     /* in which a material file is written, `unit_size` SI units; NULL: SI */
    double unit_size;
    bool (*acts)(const void *card); /* false: the value changes nothing, may be 0, and is not written to a
                                       material file. NULL = always */
    bool optional; /* where it does not act it is neither stored in a model nor hashed, so that models of
                      before it keep both */
} sf_parameter;

/* Compression curves: `curve_count` of them, in ascending strain rate; points of curve k are [curve_ptr[k],
 * curve_ptr[k+1]). Strain and stress are engineering, positive in compression. Arrays from sf_alloc. A card
 * holds them as `curves`. */
typedef struct sf_law_curves {
    int64_t curve_count;
    int64_t curve_points;
    double *curve_rate;   /* [curve_count] s-1 */
    int64_t *curve_ptr;   /* [curve_count + 1] */
    double *curve_strain; /* [curve_points] - */
    double *curve_stress; /* [curve_points] Pa */
} sf_law_curves;

/* A place where a curve lies below that of the next lower rate. */
typedef struct sf_curve_fall {
    double strain;     /* - */
    double slow, fast; /* Pa, stress there of the lower and of the higher rate */
} sf_curve_fall;

/* True if the stress of curve k >= 1 falls with the rate, beyond noise: such a foam would create energy.
 * `fall`: the worst place. */
bool sf_law_curve_falls(const sf_law_curves *curves, int64_t k, sf_curve_fall *fall);
/* Stress (Pa) of curve k at a strain within it. */
double sf_law_curve_stress(const sf_law_curves *curves, int64_t k, double strain);

/* A history variable of a point: rows first .. first + components - 1 of sf_law_batch.history. All begin as
 * 0; those that a card does not need are 0 at every update, and take no memory. */
typedef struct sf_history_variable {
    const char *name, *units;
    int first, components;
    bool (*needed)(const void *card); /* NULL = always */
} sf_history_variable;

/* Which keys were given? */
typedef struct sf_given {
    bool (*is)(const void *reader, const char *group, const char *key);
    const void *reader;
} sf_given;

typedef struct sf_law {
    const char *name; /* in the case (material.law) and in model.h5 */
    const char *description;

    /* The card. */
    size_t card_size;
    const sf_parameter *parameter;
    int parameter_count;
    size_t density;  /* offset of the double: kg m-3, undeformed */
    size_t length;   /* m, a fixed length of damping, 0: each node's spacing; SIZE_MAX: no such member */
    size_t curves;   /* of sf_law_curves; SIZE_MAX: none */
    size_t informed; /* -, largest compressive strain about which the data inform; of a value of 0 data_end */
    double (*rest_modulus)(const void *card); /* Pa: the least stiffness of the stabilisation */
    /* Rules beyond the bounds of each parameter; SF_ERR_MODEL. NULL: none. */
    sf_status (*check)(const void *card, sf_error *err);
    /* Rules that join keys of a case; the sentence begins with a key, `*place` is the one (or its group)
     * whose line it concerns. NULL: none. */
    sf_status (*check_keys)(const void *card, const sf_given *given, const char **place, sf_error *err);
    /* -, compressive strain where the data end; INFINITY: none. */
    double (*data_end)(const void *card);
    /* -, compressive strain that the law does not let a foam reach, at most 1; NULL: 1. */
    double (*limit_strain)(const void *card);
    const char *data_end_words; /* before that strain in a sentence: "the compression table ends at" */
    const char *stiffness_keys; /* those of the stiffness at rest: "E, curve" */
    /* Bounds on the tangent (Pa) and the viscosity (Pa s) of an undeformed point with this damping length
     * (m): the first time step. */
    void (*rest_bounds)(const void *card, double length, double *tangent, double *viscosity);

    /* True if the card lies where the solver is known to be weak; `text` is then a sentence that begins
     * with the law's name. NULL: no card does. */
    bool (*caution)(const void *card, char *text, size_t size);

    /* Points. */
    const sf_history_variable *history;
    int history_count;
    /* Derives from a card the data for the functions below; the caller owns `*numbers` until release. */
    sf_status (*build)(const void *card, void **numbers, sf_error *err);
    void (*release)(void *numbers);
    /* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. Stress, energies, and
     * the stiffness bounds for the time step. */
    void (*update)(const void *numbers, double dt, struct sf_law_batch *batch);
    /* Divides the rates of a card and of its curves by the shift of a pad at this temperature (K), which it
     * returns; 0: the card has none; NaN: it does not reach so far. */
    double (*shift)(void *card, sf_law_curves *curves, double temperature);
    /* Advances the history [SF_LAW_HISTORY] of points over a pause (s) at rest. */
    void (*rest)(const void *numbers, double pause, double (*history)[SF_LANES]);
    /* J m-3, energy by which the next loading of a lane, to the largest W so far, takes up less than the
     * first. */
    double (*softening)(const void *numbers, double (*history)[SF_LANES], int lane);
    /* J m-3, energy of loading in uniaxial compression to `strain`; beyond the data that at their end. */
    double (*energy)(const void *numbers, double strain);
    /* Advances a point under uniaxial compression with the lateral stretches held at 1 to `strain` over dt
     * (s); returns the nominal stress (Pa), compression positive. Without the terms that depend on a
     * length. */
    double (*uniaxial)(const void *numbers, double dt, double strain, struct sf_uniaxial *point);
    /* Returns the lateral stretch of uniaxial compression with free sides, where the stress of loading across
     * it vanishes; NaN if there is none. NULL: 1. */
    double (*lateral)(const void *numbers, double strain);
} sf_law;

/* sf_material: a law and a card of it. The functions here use the law's declarations and depend on no
 * particular law. */

enum { SF_MATERIAL_NAME_SIZE = 64 };

typedef struct sf_material {
    const sf_law *law;                /* constant, of the table */
    void *card;                       /* law->card_size bytes, owned; its curves too */
    char name[SF_MATERIAL_NAME_SIZE]; /* of its layer; "" in a pad of one material */
} sf_material;

/* A card of zeros. */
sf_status sf_material_create(const sf_law *law, sf_material *material, sf_error *err);
/* A copy with a card and curves of its own. */
sf_status sf_material_copy(const sf_material *from, sf_material *out, sf_error *err);
/* Safe on a zeroed material; leaves one. */
void sf_material_free(sf_material *material);

/* The curves of the card; NULL if the law has none. */
sf_law_curves *sf_material_curves(const sf_material *material);
void sf_law_curves_free(sf_law_curves *curves);

double sf_material_density(const sf_material *material);      /* kg m-3 */
double sf_material_informed(const sf_material *material);     /* -, see sf_law.informed */
double sf_material_rest_modulus(const sf_material *material); /* Pa */
/* m, L of damping at a node with this spacing (m). */
double sf_material_length(const sf_material *material, double spacing);

/* Bounds of all parameters, the curves, the law's own rules. SF_ERR_MODEL with a sentence that names material
 * `index`, parameter, value and bound. */
sf_status sf_material_check(const sf_material *material, int64_t index, sf_error *err);

/* The hash continued over name, law, parameters and curves. */
uint64_t sf_material_hash(uint64_t hash, const sf_material *material);

/* True if the value at `parameter` has an effect. */
bool sf_parameter_acts(const sf_parameter *parameter, const void *card);
/* True if the value is a dataset of its own in model.h5, and part of the hash. */
bool sf_parameter_is_stored(const sf_parameter *parameter, const void *card);
