/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The card of the low-density foam (docs/theory.md, section "Foam"); material/low_density_foam.c
 * declares key, bounds and default of each member. And what the cards of all foam laws begin with
 * (material/foam_parameters.h). */
#ifndef SF_CORE_FOAM_CARD_H
#define SF_CORE_FOAM_CARD_H

#include "material/card.h"

enum { SF_DENSIFICATION_H1 = 0, SF_DENSIFICATION_H2 = 1 };

/* Density, hysteresis, viscosity and rate of a foam law. A card holds them as the members of SF_FOAM_SHARED,
 * at its beginning. */
#define SF_FOAM_SHARED                                                                                       \
    double density;          /* kg m-3, of the undeformed foam */                                            \
    double hysteresis_hu;    /* -, HU, 0 < HU <= 1; 1 = no hysteresis */                                     \
    double hysteresis_shape; /* -, SHAPE > 0 */                                                              \
    double hysteresis_alpha; /* -, ALPHA > 0 */                                                              \
    double damp;             /* -, DAMP >= 0 */                                                              \
    double damp_length;      /* m, L of DAMP; 0 = the spacing of each node */                                \
    double maxwell_modulus;  /* Pa, ED >= 0; 0 = no Maxwell branch */                                        \
    double maxwell_rate;     /* s-1, BETA1 > 0 */                                                            \
    double kelvin_viscosity; /* Pa s, eta >= 0 */                                                            \
    double rate_factor;      /* -, by which stress of loading grows with each decade of rate; 0: none */     \
    double rate_reference;   /* s-1, rate up to which it does not */                                         \
    double rate_filter_time; /* s, time constant of the strain rate */                                       \
    double informed_strain;  /* -, up to here the data of the material inform the law; 0 = data_end */
typedef struct sf_foam_shared {
    SF_FOAM_SHARED
} sf_foam_shared;

typedef struct sf_foam_card {
    union {
        struct {
            SF_FOAM_SHARED
        };
        sf_foam_shared shared;
    };
    double modulus;        /* Pa, E: tension, and the least stiffness of the stabilisation */
    double tension_cutoff; /* Pa, largest tensile nominal stress; huge = none */
    /* SF_DENSIFICATION_*: the keys that a case must give; the solver reads the numbers only */
    int64_t densification_rule;
    double densification_start;    /* -, strain from which the law replaces the table; 0 = its end */
    double densification_limit;    /* -, strain eps_L at which the stress becomes infinite; 1 for rule H1 */
    double densification_exponent; /* -, exponent; 0 = the one that makes the additive constant vanish */
    union {
        struct {
            SF_LAW_CURVES
        };
        sf_law_curves curves;
    };
} sf_foam_card;

/* The card of a material that is a low-density foam. */
static inline sf_foam_card *sf_foam_card_of(const sf_material *material) {
    return material->card;
}

#endif
