/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters that the foam laws share, as rows of their lists: members of sf_foam_shared, with which each
 * card begins. And the rules that join them. */
#ifndef SF_SOLVER_MATERIAL_FOAM_PARAMETERS_H
#define SF_SOLVER_MATERIAL_FOAM_PARAMETERS_H

#include "material/foam_card.h"

bool sf_foam_has_length(const void *card);
bool sf_foam_has_maxwell(const void *card);
bool sf_foam_has_kelvin(const void *card);
bool sf_foam_has_rate_factor(const void *card);
bool sf_foam_has_informed(const void *card);

/* What SHAPE and ALPHA allow together; SF_ERR_MODEL. */
sf_status sf_foam_check_shared(const void *card, sf_error *err);

/* Rules on the keys of a case: sf_law.check_keys. */
sf_status sf_foam_check_shared_keys(const sf_foam_shared *card, const sf_given *given, const char **place,
                                    sf_error *err);

#define SF_FOAM_AT(member) .offset = offsetof(sf_foam_shared, member)
#define SF_FOAM_POSITIVE .low = 0.0, .low_open = true
#define SF_FOAM_IN(name, size) .unit = name, .unit_size = size
/* clang-format off */
#define SF_FOAM_DENSITY \
    {"material", "density", SF_PARAMETER_QUANTITY, NULL, SF_FOAM_AT(density), \
     "of the undeformed foam", .quantity = SF_DENSITY, .low = 1e-3, .high = 1e5, SF_FOAM_IN("kg/m3", 1)}
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
#define SF_FOAM_INFORMED \
    {"material", "informed_strain", SF_PARAMETER_NUMBER, "0.0", SF_FOAM_AT(informed_strain), \
     "largest compressive strain about which the material's data say something; 0 = where the table or its use ends; " \
     "beyond it softfall-post marks a run", .high = 0.999, .acts = sf_foam_has_informed}
/* clang-format on */

#endif
