/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/foam_card.h"

#include "material/unloading.h"

bool sf_foam_has_length(const void *card) {
    return ((const sf_foam_shared *)card)->damp_length > 0;
}
bool sf_foam_has_maxwell(const void *card) {
    return ((const sf_foam_shared *)card)->maxwell_modulus > 0;
}
bool sf_foam_has_kelvin(const void *card) {
    return ((const sf_foam_shared *)card)->kelvin_viscosity > 0;
}
bool sf_foam_has_rate_factor(const void *card) {
    return ((const sf_foam_shared *)card)->rate_factor > 0;
}
bool sf_foam_has_informed(const void *card) {
    return ((const sf_foam_shared *)card)->informed_strain > 0;
}

bool sf_foam_has_memory(const void *card) {
    return sf_memory_acts(&((const sf_foam_shared *)card)->memory);
}
bool sf_foam_has_recovery(const void *card) {
    return ((const sf_foam_shared *)card)->memory.recovery > 0;
}

sf_status sf_foam_check_shared(const void *card, sf_error *err) {
    const sf_foam_shared *foam = card;
    if (sf_foam_has_memory(card) && foam->hysteresis_hu == 1)
        return SF_FAIL(
            err, SF_ERR_MODEL,
            "memory.reload is %g and memory.recovery %g, but HU is 1: without hysteresis there is no "
            "softening to remember; give HU, SHAPE and ALPHA of the unloading",
            foam->memory.reload, foam->memory.recovery);
    if (foam->hysteresis_alpha == 1 || foam->hysteresis_shape >= SF_UNLOADING_LEAST_SHAPE)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_MODEL,
                   "SHAPE is %g; with ALPHA = %g, which is not 1, the least possible SHAPE is %g",
                   foam->hysteresis_shape, foam->hysteresis_alpha, SF_UNLOADING_LEAST_SHAPE);
}

sf_status sf_foam_check_shared_keys(const sf_foam_shared *foam, const sf_given *given, const char **place,
                                    sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    *place = foam->hysteresis_hu == 1 ? "material.memory" : "material.SHAPE";
    if (sf_foam_check_shared(foam, &inner) != SF_OK)
        return SF_FAIL(err, SF_ERR_INPUT, "material.%s", inner.text);
    *place = "material.ED";
    if (given->is(given->reader, "material", "ED") && foam->maxwell_modulus > 0.0 &&
        !given->is(given->reader, "material", "BETA1"))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "material.BETA1 is missing: a Maxwell branch (ED) needs its decay rate, for example "
                       "BETA1 = \"5000 1/s\"");
    *place = "material.rate_reference";
    if (foam->rate_factor > 0 && !given->is(given->reader, "material", "rate_reference"))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "material.rate_reference is missing: a rate factor needs the rate at which it is 1, for "
            "example rate_reference = \"0.01 1/s\"");
    return SF_OK;
}
