/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of the strain over the pad at the peak, from the fields of /peak. */
#pragma once
#include "post/results/results.h"
#include "report/row.h"

/* Fields at the nodes at the peak; each may be NULL but the compression. */
typedef struct sf_peak_fields {
    const double *compression;    /* [node_count] 1 - smallest principal stretch */
    const double *displacement;   /* [node_count][3] m; NULL: own layers only */
    const double *pressure;       /* [node_count] Pa, of the missile; NULL: no walls */
    const double *energy_density; /* [node_count] J m-3; NULL: a single node counts */
} sf_peak_fields;

/* Part of the foam's energy in the nodes that collapse: one node at a notch, which carries nothing, exceeds
 * its neighbours on any mesh. */
#define SF_COLLAPSE_SHARE 0.005

/* Excess of a node's compression over the median of its neighbours, the nodes that share a cell with it,
 * counted once per cell: the largest that nodes with SF_COLLAPSE_SHARE of the energy reach. Where the strain
 * is smooth it is small, below a missile in a pad of any thickness, and so it is along a straight edge of the
 * loaded area; nodes, rows or layers that collapse alone stand out. A node without cells has no excess.
 *
 * At a tied interface of a pad of layers, whose nodes at one place have moved together, the excess is the
 * less of that over the neighbours in the node's own layer and that over those in all layers there: a layer
 * that its stiffer or softer partner carries along does not collapse. Likewise of a node of a wall, a steep
 * free face that the missile does not press, and its neighbours on walls: a wall that bends. */
sf_status sf_strain_field_collapse(const sf_results *results, const sf_peak_fields *peak, double *collapse,
                                   sf_error *err);

/* Share, of the energy of the foam, of the nodes whose compression exceeds `strain`; 0 without energy.
 * energy_density: [node_count] J m-3. */
double sf_strain_field_energy_beyond(const sf_results *results, const double *compression,
                                     const double *energy_density, double strain);

/* The depth of missile or supports in the foam between its nodes. */
typedef struct sf_rim_cut {
    double depth;    /* m, from the nearest free face; of smooth surfaces the part beyond what is sharp */
    double share;    /* -, largest of it over the shortest edge of its face */
    double spacing;  /* m, shortest edge of all faces; INFINITY: there are none */
    double place[3]; /* m, of a node of that face at rest */
} sf_rim_cut;

/* Measures it at the vertices and along the edges of their triangles; displacement: [node_count][3]
 * m. */
sf_status sf_rim_cut_measure(const sf_results *results, const sf_frame_head *head, const double *displacement,
                             sf_rim_cut *cut, sf_error *err);

/* Figures of each layer of a pad of several materials. */

/* X(member, key in summary.json, factor from SI to the unit in the key, meaning and, of a row that is
 * printed, its name, unit and format). */
/* clang-format off */
#define SF_LAYER_FIGURES(X)                                                                                            \
    X(volume, "volume_cm3", 1e6, "of the undeformed layer, whole pad", .name = "volume", .unit = "cm³", .format = "%.1f") \
    X(density, "density_kg_m3", 1, "of the undeformed material", .name = "density", .unit = "kg/m³", .format = "%.1f") \
    X(max_local_strain, "max_local_strain", 1, "largest compression (1 - smallest principal stretch) of the run",      \
      .name = "largest strain", .format = "%.3f")                                                                      \
    X(absorbed_energy, "absorbed_energy_J", 1, "stored, lost and viscous energy in the last frame, whole pad",         \
      .name = "absorbed", .unit = "J", .format = "%.3f")                                                               \
    X(stored_energy, "stored_energy_J", 1, "of it, recoverable")                                                       \
    X(hysteresis_energy, "hysteresis_energy_J", 1, "of it, lost by the unloading rule")                                \
    X(viscous_energy, "viscous_energy_J", 1, "of it, viscous work", .name = "of it viscous", .unit = "J", .format = "%.3f") \
    X(energy_share, "energy_share", 1, "of the energy of the foams' curves at /peak",                                  \
      .name = "share at the peak", .unit = "%", .format = "%.1f", .shown = 100)                                        \
    X(energy_beyond_data, "energy_beyond_data", 1, "share of the layer's own such energy in nodes compressed beyond its `informed_strain`", \
      .name = "beyond its data", .unit = "%", .format = "%.1f", .shown = 100)                                          \
    X(informed_strain, "informed_strain", 1, "strain up to which the data of its material inform its curve")
/* clang-format on */

#define SF_LAYER_MEMBER(member, ...) double member;
typedef struct sf_layer_figures {
    const char *name;                 /* of the results */
    SF_LAYER_FIGURES(SF_LAYER_MEMBER) /* SI; NaN: the file does not say */
} sf_layer_figures;
#undef SF_LAYER_MEMBER

/* The rows of an sf_layer_figures, its name first; static storage. */
sf_rows sf_layer_figure_rows(void);

/* [results->layer_count] owned by the caller (free); NULL without layers or on failure. compression and
 * energy_density: [node_count] of /peak, or NULL. */
sf_layer_figures *sf_layer_figures_compute(const sf_results *results, const double *compression,
                                           const double *energy_density, sf_error *err);

/* Notes by how much layers slide on each other at the peak, if that is more than 2 % of the thickness: their
 * ties hold along the undeformed normal, which is right for small slips. */
sf_status sf_layers_note_slip(sf_results *results, sf_error *err);
