/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fields of a frame: one value, vector or tensor per node. This list is the only one of them: the bits of
 * output_fields, the names of output.fields in a case, /frames and /peak in results.h5, reading and checking,
 * pad.xdmf and the table in docs/formats.md follow it.
 *
 * To add a field: a line at the end of the list, and its values in solver/run/frame.c. */
#ifndef SF_CORE_FRAME_FIELD_H
#define SF_CORE_FRAME_FIELD_H

/* X(constant, name, components (1, 3 or 9), units, name in ParaView, description, remark), with BETWEEN
 * between two. The remark is for docs/formats.md. */
/* clang-format off */
#define SF_FRAME_FIELD_LIST(X, BETWEEN)                                                                                \
    X(DISPLACEMENT, displacement, 3, "m", "displacement_m", "u_h at the nodes", "") BETWEEN                            \
    X(VELOCITY, velocity, 3, "m s-1", "velocity_m_s", "time derivative of u_h, half a step later", "") BETWEEN         \
    X(CAUCHY_STRESS, cauchy_stress, 9, "Pa", "cauchy_stress_Pa",                                                       \
      "Cauchy stress xx xy xz yx yy yz zx zy zz of the smoothing domain", "") BETWEEN                                  \
    X(VON_MISES, von_mises, 1, "Pa", "von_mises_Pa", "von Mises stress", "") BETWEEN               \
    X(PRINCIPAL_STRETCHES, principal_stretches, 3, "1", "principal_stretches_1",                                       \
      "principal stretches, ascending", "") BETWEEN                                                                    \
    X(LARGEST_COMPRESSION, largest_compression, 1, "1", "largest_compression_1",                                       \
      "1 - smallest principal stretch", "") BETWEEN                                                                    \
    X(ENERGY_DENSITY, energy_density, 1, "J m-3", "energy_density_J_m3",                                               \
      "W of the loading curve per reference volume", "") BETWEEN                                                       \
    X(HYSTERESIS_FACTOR, hysteresis_factor, 1, "1", "hysteresis_factor_1", "factor on the curve's stress", "") BETWEEN \
    X(CONTACT_PRESSURE, contact_pressure, 1, "Pa", "contact_pressure_Pa",                                              \
      "normal force of the missile on the node over the undeformed surface that belongs to it", "0 without contact")
/* clang-format on */

#define SF_FRAME_CONSTANT(constant, ...) SF_FRAME_##constant,
typedef enum sf_frame_field { SF_FRAME_FIELD_LIST(SF_FRAME_CONSTANT, ) SF_FRAME_FIELDS } sf_frame_field;
#undef SF_FRAME_CONSTANT

/* Bits of output_fields. */
#define SF_FIELD_BIT(constant, ...) SF_FIELD_##constant = 1 << SF_FRAME_##constant,
enum { SF_FRAME_FIELD_LIST(SF_FIELD_BIT, ) SF_FIELD_ALL = (1 << SF_FRAME_FIELDS) - 1 };
#undef SF_FIELD_BIT

typedef struct sf_frame_field_info {
    const char *name; /* in a case and below /frames/NNNNNN */
    int components;   /* 1, 3 or 9 */
    const char *units;
    const char *array; /* in pad-HASH.h5 and ParaView: the name with its unit */
    const char *description, *remark;
} sf_frame_field_info;

/* Static storage. */
const sf_frame_field_info *sf_frame_field_get(sf_frame_field field);

#endif
