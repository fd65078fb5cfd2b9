/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/contact/contact_rows.h"

/* The surface of the rigid missile for contact: gap and outward normal at a point, for an exact sphere cap or
 * a triangulated surface. All points are in the missile's frame, that of its position at t = 0: the caller
 * moves a point back by the missile's translation. */

typedef struct sf_missile_surface {
    int64_t shape; /* SF_SHAPE_* */
    double centre[3], radius, cap_cosine;
    double axis[3]; /* unit vector from the centre to the middle of the cap */
    double spacing; /* m, smallest of the points that it can touch */

    /* Triangles binned on a grid over (x, y); SF_SHAPE_SURFACE only. */
    const double *position;  /* borrowed from the model */
    const int32_t *triangle; /* borrowed */
    double *normal;          /* [triangles][3] unit, outward */
    double *vertex_normal;   /* [nodes][3] angle-weighted pseudo-normal (Baerentzen, Aanaes 2005) */
    /* [triangles][3 edges][3] sum of the two faces' normals, edge k from vertex k to k+1 */
    double *edge_normal;
    uint8_t *rim_edge;      /* [triangles][3 edges] 1 = no second face */
    uint8_t *rim_vertex;    /* [nodes] 1 = end of such an edge */
    double reach;           /* m, larger gaps are not searched for */
    double low[3], high[3]; /* of all nodes */
    int64_t bins[2];
    int64_t *start;  /* [bins + 1] */
    int32_t *member; /* triangles whose box, grown by reach, meets the bin */
} sf_missile_surface;

/* `axis`: the missile's direction. */
sf_status sf_missile_surface_build(const sf_model *model, const double axis[3], sf_missile_surface *surface,
                                   sf_error *err);
void sf_missile_surface_free(sf_missile_surface *surface);

/* Can sf_missile_surface_gap be less than `margin` (m, from 0) at `x`? False is certain. */
bool sf_missile_surface_near(const sf_missile_surface *surface, const double x[3], double margin);

/* Signed distance of `x` (negative inside the missile) and outward normal at the nearest surface point.
 * Returns false when the surface is farther than its reach, when the nearest point lies beyond the sphere
 * cap's rim, and when x is behind triangles that end there, beside their rim. */
bool sf_missile_surface_gap(const sf_missile_surface *surface, const double x[3], double *gap,
                            double normal[3]);

/* A resting pad on the anvil, a rigid plane z = constant below its underside (theory, section "Anvil";
 * docs/adr/0019). The contact itself is that of contact.h, with the anvil as a second partner.
 *
 * At t = 0 the pad has settled: the anvil's loads q0 (sf_model.rest_load) carry its weight. The reference
 * configuration is that state, so that weight and the stress that it causes act on the coefficients with the
 * sum -Phi^T q0, a constant. */

typedef struct sf_anvil {
    int64_t count;     /* nodes that the weight acts on; 0: the pad is held */
    int32_t *node;     /* [count] ascending */
    double (*pull)[3]; /* [count] N, constant */
} sf_anvil;

sf_status sf_anvil_build(const sf_model *model, const sf_contact_rows *rows, sf_anvil *anvil, sf_error *err);
void sf_anvil_free(sf_anvil *anvil);

/* Adds the pull to force [node_count][3], N. */
void sf_anvil_pull(const sf_anvil *anvil, double *force);

/* Work (J) of the pull on the coefficients d [node_count][3], m, since t = 0. */
double sf_anvil_work(const sf_anvil *anvil, const double *d);

/* Height (m) above the anvil of a resting node at x. */
static inline double sf_anvil_gap(const sf_model *model, int64_t node, const double x[3]) {
    return x[2] - model->position[3 * node + 2];
}
