/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/card.h"
#include "material/memory.h"

/* The card of the low-density foam (docs/theory.md, section "Foam"); material/low_density_foam.c
 * declares key, bounds and default of each member. And what the cards of all foam laws begin with
 * (material/foam_card.h). */

enum { SF_DENSIFICATION_H1 = 0, SF_DENSIFICATION_H2 = 1 };

/* Density, hysteresis, viscosity and rate of a foam law: the first member of each card. */
typedef struct sf_foam_shared {
    double density;            /* kg m-3, of the undeformed foam */
    double hysteresis_hu;      /* -, HU, 0 < HU <= 1; 1 = no hysteresis */
    double hysteresis_shape;   /* -, SHAPE > 0 */
    double hysteresis_alpha;   /* -, ALPHA > 0 */
    double damp;               /* -, DAMP >= 0 */
    double damp_length;        /* m, L of DAMP; 0 = the spacing of each node */
    double maxwell_modulus;    /* Pa, ED >= 0; 0 = no Maxwell branch */
    double maxwell_rate;       /* s-1, BETA1 > 0 */
    double kelvin_viscosity;   /* Pa s, eta >= 0 */
    double rate_factor;        /* -, by which stress of loading grows with each decade of rate; 0: none */
    double rate_reference;     /* s-1, rate up to which it does not */
    double rate_filter_time;   /* s, time constant of the strain rate */
    double shift_c1, shift_c2; /* -, K: constants of WLF, both 0: none */
    double shift_energy;       /* J mol-1, of Arrhenius, instead; 0: none */
    double shift_reference;    /* K, temperature of the data; 0: the rates have no shift */
    sf_memory memory;
    double informed_strain; /* -, up to here the data of the material inform the law; 0 = data_end */
} sf_foam_shared;

typedef struct sf_foam_card {
    sf_foam_shared shared;
    double modulus;        /* Pa, E: tension, and the least stiffness of the stabilisation */
    double tension_cutoff; /* Pa, largest tensile nominal stress; huge = none */
    /* SF_DENSIFICATION_*: the keys that a case must give; the solver reads the numbers only */
    int64_t densification_rule;
    double densification_start;    /* -, strain from which the law replaces the table; 0 = its end */
    double densification_limit;    /* -, strain eps_L at which the stress becomes infinite; 1 for rule H1 */
    double densification_exponent; /* -, exponent; 0 = the one that makes the additive constant vanish */
    sf_law_curves curves;
} sf_foam_card;
_Static_assert(offsetof(sf_foam_card, shared) == 0, "a foam's card begins with sf_foam_shared");

/* The memory of a foam law, as all laws are. */
static inline const sf_memory *sf_foam_memory(const sf_material *material) {
    return &((const sf_foam_shared *)material->card)->memory;
}

/* The card of a material that is a low-density foam. */
static inline sf_foam_card *sf_foam_card_of(const sf_material *material) {
    return material->card;
}

/* Parameters that the foam laws share, as rows of their lists: members of sf_foam_shared, with which each
 * card begins. And the rules that join them. */

/* X(name, condition on the card `foam`): sf_foam_has_NAME(card) says whether a parameter acts. */
#define SF_FOAM_ACTS(X)                                                                                      \
    X(length, foam->damp_length > 0)                                                                         \
    X(maxwell, foam->maxwell_modulus > 0)                                                                    \
    X(kelvin, foam->kelvin_viscosity > 0)                                                                    \
    X(rate_factor, foam->rate_factor > 0)                                                                    \
    X(informed, foam->informed_strain > 0)                                                                   \
    X(wlf, foam->shift_c1 + foam->shift_c2 > 0)                                                              \
    X(arrhenius, foam->shift_energy > 0)                                                                     \
    X(shift, foam->shift_reference > 0)                                                                      \
    X(memory, foam->memory.reload + foam->memory.recovery > 0)                                               \
    X(recovery, foam->memory.recovery > 0)                                                                   \
    X(rest, foam->memory.recovery + foam->memory.set * foam->memory.set_recovery > 0)                        \
    X(set, foam->memory.set > 0)
#define SF_FOAM_HAS(name, condition) bool sf_foam_has_##name(const void *card);
SF_FOAM_ACTS(SF_FOAM_HAS)
#undef SF_FOAM_HAS

/* Checks the bounds that SHAPE and ALPHA have together; SF_ERR_MODEL. */
sf_status sf_foam_check_shared(const void *card, sf_error *err);

/* Rules on the keys of a case: sf_law.check_keys; `rates`: the law's own terms depend on the rate. */
sf_status sf_foam_check_shared_keys(const sf_foam_shared *card, bool rates, const sf_given *given,
                                    const char **place, sf_error *err);

/* sf_law.shift. */
double sf_foam_shift(void *card, sf_law_curves *curves, double temperature);

#define SF_FOAM_AT(member) .offset = offsetof(sf_foam_shared, member)
#define SF_FOAM_POSITIVE .low = 0.0, .low_open = true
#define SF_FOAM_IN(name, size) .unit = name, .unit_size = size
/* clang-format off */
#define SF_FOAM_DENSITY \
    {"material", "density", SF_PARAMETER_QUANTITY, NULL, SF_FOAM_AT(density), \
     "of the undeformed foam", .quantity = SF_DENSITY, .low = 0.3, .high = 3000, SF_FOAM_IN("kg/m3", 1)}
#define SF_FOAM_PARAMETERS \
    {"material", "HU", SF_PARAMETER_NUMBER, "1.0", SF_FOAM_AT(hysteresis_hu), \
     "hysteretic unloading factor; 1 = no hysteresis", .low = 1e-6, .high = 1.0}, \
    {"material", "SHAPE", SF_PARAMETER_NUMBER, "1.0", SF_FOAM_AT(hysteresis_shape), \
     "shape of unloading", .low = 1e-3, .high = 100.0}, \
    {"material", "ALPHA", SF_PARAMETER_NUMBER, "1.0", SF_FOAM_AT(hysteresis_alpha), \
     "second exponent of unloading; below 1 the stress falls steeply at the reversal", .low = 0.1, .high = 10.0}, \
    {"material", "DAMP", SF_PARAMETER_NUMBER, "0.0", SF_FOAM_AT(damp), \
     "viscous coefficient: stress DAMP x density x wave speed x length x strain rate", .high = 10.0}, \
    {"material", "damp_length", SF_PARAMETER_QUANTITY, "\"spacing\"", SF_FOAM_AT(damp_length), \
     "the length in DAMP: \"spacing\" (of each node) or a fixed length", .quantity = SF_LENGTH, \
     SF_FOAM_POSITIVE, .high = 1e3, .words = "spacing", .word_value = 0.0, SF_FOAM_IN("mm", 1e-3), \
     .acts = sf_foam_has_length}, \
    {"material", "ED", SF_PARAMETER_QUANTITY, "\"0 Pa\"", SF_FOAM_AT(maxwell_modulus), \
     "modulus of the Maxwell branch; 0 = none", .quantity = SF_PRESSURE, .high = 1e12, \
     SF_FOAM_IN("MPa", 1e6), .acts = sf_foam_has_maxwell}, \
    {"material", "BETA1", SF_PARAMETER_QUANTITY, "\"5000 1/s\"", SF_FOAM_AT(maxwell_rate), \
     "decay rate of the Maxwell branch; must be given when ED is", .quantity = SF_RATE, .low = 1e-6, \
     .high = 1e12, SF_FOAM_IN("1/s", 1), .acts = sf_foam_has_maxwell}, \
    {"material", "eta", SF_PARAMETER_QUANTITY, "\"0 Pa s\"", SF_FOAM_AT(kelvin_viscosity), \
     "Kelvin viscosity; bounds the time step", .quantity = SF_VISCOSITY, .high = 1e9, \
     SF_FOAM_IN("Pa s", 1), .acts = sf_foam_has_kelvin}
#define SF_FOAM_MEMORY_NUMBER(key, fallback, member, meaning, most, has) \
    {"material.memory", key, SF_PARAMETER_NUMBER, fallback, SF_FOAM_AT(memory.member), meaning, .high = most, .acts = has}
#define SF_FOAM_MEMORIES \
    SF_FOAM_MEMORY_NUMBER("reload", "0.0", reload, \
     "part of what unloading takes from the stress that a second loading, up to the largest energy so far, has again; " \
     "0 = it follows unloading", 1.0, sf_foam_has_memory), \
    SF_FOAM_MEMORY_NUMBER("drift", "0.0", drift, \
     "fall of `reload` from loading to loading: reload / (1 + drift (n - 1)) in the n-th second loading", 10.0, \
     sf_foam_has_memory), \
    SF_FOAM_MEMORY_NUMBER("recovery", "0.0", recovery, \
     "part of the softening that each decade of time at rest takes back, between drops", 1.0, sf_foam_has_recovery), \
    {"material.memory", "recovery_start", SF_PARAMETER_QUANTITY, "\"1 s\"", SF_FOAM_AT(memory.start), \
     "time at rest from which its decades count: log10(1 + t / recovery_start)", .quantity = SF_TIME, .low = 1e-3, \
     .high = 1e6, SF_FOAM_IN("s", 1), .acts = sf_foam_has_rest}, \
    SF_FOAM_MEMORY_NUMBER("permanent", "0.0", permanent, "part of the softening, and of the set, that never recovers", 1.0, \
     sf_foam_has_rest), \
    SF_FOAM_MEMORY_NUMBER("set", "0.0", set, \
     "part of the largest displacement of a drop that is left when the load is gone, for the drops after it; 0 = none", \
     0.49, sf_foam_has_set), \
    SF_FOAM_MEMORY_NUMBER("set_recovery", "0.0", set_recovery, \
     "part of the set that each decade of time at rest takes back, between drops", 1.0, sf_foam_has_set)
#define SF_FOAM_RATE_FACTOR(reference) \
    {"material", "rate_factor", SF_PARAMETER_NUMBER, "0.0", SF_FOAM_AT(rate_factor), \
     "part by which the stress of loading grows with each decade of the strain rate above `rate_reference`", \
     .high = 10.0, .acts = sf_foam_has_rate_factor}, \
    {"material", "rate_reference", SF_PARAMETER_QUANTITY, "\"0.01 1/s\"", SF_FOAM_AT(rate_reference), \
     reference "; must be given when rate_factor is", .quantity = SF_RATE, .low = 1e-9, .high = 1e6, SF_FOAM_IN("1/s", 1), .acts = sf_foam_has_rate_factor}
#define SF_FOAM_RATE_FILTER(use, has) \
    {"material", "rate_filter_time", SF_PARAMETER_QUANTITY, "\"0.1 ms\"", SF_FOAM_AT(rate_filter_time), \
     "time constant of the strain rate " use, .quantity = SF_TIME, .low = 1e-9, .high = 1e3, \
     SF_FOAM_IN("ms", 1e-3), .acts = has}
#define SF_FOAM_SHIFTS \
    {"material.shift", "C1", SF_PARAMETER_NUMBER, "", SF_FOAM_AT(shift_c1), \
     "of WLF: the logarithm to base 10 of the shift of the rates is -C1 (T - T_ref)/(C2 + T - T_ref)", SF_FOAM_POSITIVE, \
     .high = 100.0, .acts = sf_foam_has_wlf}, \
    {"material.shift", "C2", SF_PARAMETER_QUANTITY, "", SF_FOAM_AT(shift_c2), \
     "of WLF, a difference of temperatures in K", .quantity = SF_TEMPERATURE, SF_FOAM_POSITIVE, .high = 270.0, \
     SF_FOAM_IN("K", 1), .acts = sf_foam_has_wlf}, \
    {"material.shift", "E_a", SF_PARAMETER_QUANTITY, "", SF_FOAM_AT(shift_energy), \
     "activation energy of Arrhenius, instead of C1 and C2: the natural logarithm of the shift is E_a/R (1/T - 1/T_ref)", \
     .quantity = SF_MOLAR_ENERGY, SF_FOAM_POSITIVE, .high = 1e6, SF_FOAM_IN("kJ/mol", 1e3), .acts = sf_foam_has_arrhenius}, \
    {"material.shift", "T_ref", SF_PARAMETER_QUANTITY, "", SF_FOAM_AT(shift_reference), \
     "temperature of the material's data, and of the pad unless `pad.temperature` is given", .quantity = SF_TEMPERATURE, \
     .low = 100.0, .high = 600.0, SF_FOAM_IN("K", 1), .acts = sf_foam_has_shift}
#define SF_FOAM_INFORMED \
    {"material", "informed_strain", SF_PARAMETER_NUMBER, "0.0", SF_FOAM_AT(informed_strain), \
     "largest compressive strain about which the material's data say something; 0 = where the table or its use ends; " \
     "beyond it softfall-post marks a run", .high = 0.999, .acts = sf_foam_has_informed}
/* clang-format on */
