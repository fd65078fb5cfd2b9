/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small synthetic results.h5 with closed-form contents, for the tests of softfall-post.
 *
 * Pad: 2 x 2 x 2 hexahedra over [-0.1, 0.1]^2 x [-0.05, 0] m, one pyramid and one tetrahedron on the side x =
 * 0.1 (29 nodes). Missile: a square pyramid, point down, its pole at the origin (5 nodes, 4 triangles),
 * moving along -z. History: a half-sine of FIXTURE_PEAK_G over FIXTURE_DURATION, then free flight for 2 ms;
 * unevenly spaced rows. Frame k of FIXTURE_FRAMES, at k FIXTURE_DURATION / 4: displacement u_z = -0.005 k (z
 * + 0.05) / 0.05, von Mises 1000 k + 10 node Pa, largest compression 0.7 - node / 1000, missile lowered by
 * 0.005 k m. /peak is like frame 2. */
#ifndef SF_TESTS_POST_FIXTURE_H
#define SF_TESTS_POST_FIXTURE_H

#include "base/error.h"
#include <stdbool.h>
#include <stdint.h>

#define FIXTURE_PEAK_G 100.0
#define FIXTURE_CONTACT_AREA 0.01 /* m2, largest */
#define FIXTURE_DURATION 0.04     /* s */
#define FIXTURE_SPEED 15.0        /* m s-1 */
#define FIXTURE_MASS 4.6          /* kg */
#define FIXTURE_THICKNESS 0.05    /* m */
enum { FIXTURE_FRAMES = 4, FIXTURE_NODES = 29, FIXTURE_CELLS = 10, FIXTURE_TRIANGLES = 4 };

/* Zeroed: a sound file of a run that rebounded. */
typedef struct fixture_options {
    const char *format;     /* NULL = softfall-results */
    bool untouched;         /* the missile never meets the pad */
    bool no_summary;        /* a killed run */
    bool no_peak;           /* without /peak */
    bool no_stress;         /* frames without von Mises */
    bool kinematic;         /* figures of the kinematic acceleration */
    bool headless_frame;    /* the last frame has lost its time */
    bool bad_frame;         /* the last frame holds a NaN */
    bool bad_cell;          /* a vertex index beyond the nodes */
    int64_t lost_rows;      /* at the end of /history/velocity */
    int64_t nan_row;        /* > 0: this row of the acceleration is NaN */
    double end_time;        /* > 0: the history stops there (s) */
    const char *status;     /* NULL = rebound */
    const char *notes;      /* /summary/notes, NULL = none there */
    double informed_strain; /* > 0: /model/informed_strain */
    double anvil_depth;     /* > 0: /model/anvil_depth (m) */
    double peak_time;       /* > 0: of /peak (s), else that of frame 2 */
    double sphere_radius;   /* > 0: /model/sphere_radius (m), its centre that far above the pole */
    int64_t part;           /* 2: half a model, mirrored at x = -0.1; 0: whole */
} fixture_options;

sf_status fixture_write(const char *path, const fixture_options *options, sf_error *err);

#endif
