/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/foam_card.h"

#define HAS(name, condition)                                                                                 \
    bool sf_foam_has_##name(const void *card) {                                                              \
        const sf_foam_shared *foam = card;                                                                   \
        return condition;                                                                                    \
    }
SF_FOAM_ACTS(HAS)

sf_status sf_foam_check_shared(const void *card, sf_error *err) {
    const sf_foam_shared *foam = card;
    if (sf_foam_has_memory(card) && foam->hysteresis_hu == 1)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "memory.reload is %g and memory.recovery %g, but HU is 1: without hysteresis there is "
                       "no softening to remember; give HU, SHAPE and ALPHA of the unloading",
                       foam->memory.reload, foam->memory.recovery);
    if (foam->hysteresis_alpha == 1 || foam->hysteresis_shape >= SF_UNLOADING_LEAST_SHAPE)
        return SF_OK;
    return SF_FAIL(err, SF_ERR_MODEL,
                   "SHAPE is %g; with ALPHA = %g, which is not 1, the least possible SHAPE is %g",
                   foam->hysteresis_shape, foam->hysteresis_alpha, SF_UNLOADING_LEAST_SHAPE);
}

/* All keys of one of the two laws of a shift, or none, and rates for it. */
static sf_status check_shift(const sf_foam_shared *foam, bool rates, sf_error *err) {
    bool wlf = sf_foam_has_wlf(foam), arrhenius = sf_foam_has_arrhenius(foam);
    bool has_rates =
        rates || foam->rate_factor > 0 || foam->maxwell_modulus > 0 || foam->kelvin_viscosity > 0;
    const char *wrong = NULL;
    if (wlf && arrhenius)
        wrong = "has C1 and C2 of WLF and E_a of Arrhenius: a foam has one of the two laws";
    else if (wlf && !(foam->shift_c1 > 0 && foam->shift_c2 > 0))
        wrong = "needs both C1 and C2";
    else if ((wlf || arrhenius) != sf_foam_has_shift(foam))
        wrong = "needs T_ref, and with it C1 and C2, or E_a";
    else if (sf_foam_has_shift(foam) && !has_rates)
        wrong = "moves nothing: this material has no curves at several rates, rate_factor, ED or eta";
    return wrong ? SF_REFUSE(err, "material.shift %s", wrong) : SF_OK;
}

double sf_foam_shift(void *card, sf_law_curves *curves, double temperature) {
    static const double GAS = 8.31446261815324 /* J mol-1 K-1 */, MOST = 6 /* decades */;
    sf_foam_shared *foam = card;
    double above = temperature - foam->shift_reference, decades = INFINITY;
    if (!sf_foam_has_shift(card))
        return 0;
    if (sf_foam_has_arrhenius(card))
        decades = foam->shift_energy / (GAS * M_LN10) * (1 / temperature - 1 / foam->shift_reference);
    else if (foam->shift_c2 + above > 0)
        decades = -foam->shift_c1 * above / (foam->shift_c2 + above);
    if (!(fabs(decades) <= MOST))
        return NAN;
    double shift = pow(10, decades);
    for (int64_t k = 0; curves && k < curves->curve_count; k++)
        curves->curve_rate[k] /= shift;
    foam->rate_reference /= shift;
    foam->maxwell_rate /= shift;
    foam->kelvin_viscosity *= shift;
    foam->shift_c1 = foam->shift_c2 = foam->shift_energy = foam->shift_reference = 0;
    return shift;
}

sf_status sf_foam_check_shared_keys(const sf_foam_shared *foam, bool rates, const sf_given *given,
                                    const char **place, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    *place = foam->hysteresis_hu == 1 ? "material.memory" : "material.SHAPE";
    if (sf_foam_check_shared(foam, &inner) != SF_OK)
        return SF_REFUSE(err, "material.%s", inner.text);
    *place = "material.shift";
    SF_TRY(check_shift(foam, rates, err));
    *place = "material.ED";
    if (given->is(given->reader, "material", "ED") && foam->maxwell_modulus > 0.0 &&
        !given->is(given->reader, "material", "BETA1"))
        return SF_REFUSE(err,
                         "material.BETA1 is missing: a Maxwell branch (ED) needs its decay rate, for example "
                         "BETA1 = \"5000 1/s\"");
    *place = "material.rate_reference";
    if (foam->rate_factor > 0 && !given->is(given->reader, "material", "rate_reference"))
        return SF_REFUSE(err,
                         "material.rate_reference is missing: a rate factor needs the rate at which it is 1, "
                         "for example rate_reference = \"0.01 1/s\"");
    return SF_OK;
}
