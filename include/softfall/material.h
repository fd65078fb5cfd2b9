/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foams, and points of them under compression (libsoftfall-build). */
#pragma once
#include "softfall/status.h"

typedef struct softfall_material softfall_material;

/* Reads and checks a material file, which holds the keys of the group `material` of a case. `temperature`: of
 * the pad, K; 0: none is given. */
SOFTFALL_API softfall_status softfall_material_read(const char *path, double temperature,
                                                    softfall_material **out, softfall_error *error);
SOFTFALL_API void softfall_material_free(softfall_material *material);
/* Its values, as softfall_case_parameters has them; owned by the material. */
SOFTFALL_API const char *softfall_material_parameters(const softfall_material *material);
/* The compression curve number `index` from 0, of ascending rates: the number of its points, 0: there is no
 * such curve. `rate` is in 1/s, 0 if the material has one curve; `strain` and `stress` (Pa) are the
 * material's. */
SOFTFALL_API int64_t softfall_material_curve(const softfall_material *material, int index, double *rate,
                                             const double **strain, const double **stress);
/* Presses a point of the foam, from rest at the first point: `strain` over `time` (s) [count], straight
 * between the points; fills `stress` [count], nominal, in Pa. Compression is positive. Strains are from -1 to
 * below 1 and begin with 0, times ascend. `free_sides` 1: the foam bulges freely, 0: its sides are held, as
 * those of a large pad. DAMP, which depends on the mesh, is left out. */
SOFTFALL_API softfall_status softfall_compress(const softfall_material *material, int free_sides,
                                               const double *time, const double *strain, int64_t count,
                                               double *stress, softfall_error *error);

/* Presses a point along a record of cycles (softfall_compress, sides held), whose first strain may be above
 * 0. `pause` [count]: time (s) without load before each point, 0: none. Memory recovers in a pause. */
SOFTFALL_API softfall_status softfall_compress_cycles(const softfall_material *material, const double *time,
                                                      const double *strain, const double *pause,
                                                      int64_t count, double *stress, softfall_error *error);

/* Parameters of a hyperfoam (docs/case.md). */
enum { SOFTFALL_TERMS = 6 };
typedef struct softfall_hyperfoam {
    double density, damp; /* kg/m3, - */
    double hu, shape, unloading_alpha;
    double informed; /* largest strain of the data */
    int terms;
    double mu[SOFTFALL_TERMS], alpha[SOFTFALL_TERMS], nu[SOFTFALL_TERMS]; /* Pa, -, - */
} softfall_hyperfoam;
SOFTFALL_API softfall_status softfall_hyperfoam_material(const softfall_hyperfoam *values,
                                                         softfall_material **out, softfall_error *error);
/* Loading of a hyperfoam with free sides at ascending or descending strains: nominal stress (Pa), lateral
 * strain (positive outwards) and W (J/m3), each [count]; NaN where the sides find no rest. */
SOFTFALL_API softfall_status softfall_hyperfoam_loading(const softfall_material *material,
                                                        const double *strain, int64_t count, double *stress,
                                                        double *lateral, double *energy,
                                                        softfall_error *error);

/* Sets the peak deceleration (g, F/m, CFC 1000) of a flat mass of `static_stress` (Pa, weight over area) on a
 * block of this foam, `thickness` and `drop_height` in m (ASTM D1596). SOFTFALL_NUMERIC: it collapses. */
SOFTFALL_API softfall_status softfall_cushion(const softfall_material *material, double static_stress,
                                              double thickness, double drop_height, double *peak_g,
                                              softfall_error *error);

/* Multiplies every curve, as a fine table, by exp(bend), linear between `count` rising strains and constant
 * beyond them. Where the stress would fall with the strain it stays level. SOFTFALL_INPUT: no foam with
 * curves, or no strain. */
SOFTFALL_API softfall_status softfall_material_bend(softfall_material *material, int64_t count,
                                                    const double *strain, const double *bend,
                                                    softfall_error *error);
/* Writes `folder`/`name`.cfg with its curves beside it, `title` and `comments` (lines) above; files that are
 * there are replaced. SOFTFALL_MODEL: softfall-pre would refuse the material, and none is written. */
SOFTFALL_API softfall_status softfall_material_write(const softfall_material *material, const char *folder,
                                                     const char *name, const char *title,
                                                     const char *comments, softfall_error *error);
