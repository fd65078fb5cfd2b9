/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a run, from its history: of a drop, or of a compression test (prescribed motion). A figure
 * that the run does not define (the bodies never touched, contact had not ended, no drop) is NaN.
 *
 * To add a figure: a line in the list, and its computation in figures.c. The list declares its member of
 * sf_figures and drives summary.json and the table in docs/formats.md. */
#pragma once
#include "post/figures/injury.h"
#include "post/figures/strain_field.h"

/* X(kind, member, key in summary.json, factor from SI to the unit in the key, meaning), in the order of
 * summary.json. A key ends with its unit; one that does not is dimensionless. NUMBER, COUNT and FLAG declare
 * a member of sf_figures of type double, int64_t and bool; INNER stands in a member that is declared below;
 * FACT, FACT_COUNT and FACT_TEXT are members of sf_results (double, int64_t, text). */
/* clang-format off */
#define SF_FIGURES(X)                                                                                                  \
    X(INNER, injury.a_max_g, "a_max_g", 1, "largest deceleration, filtered like the next ones", \
      .name = "a_max", .unit = "g", .format = "%.2f") \
    X(INNER, injury.a_max_time, "a_max_time_ms", 1e3, "its time") \
    X(INNER, injury.hic.value, "hic", 1, "head injury criterion, no limit of the window", \
      .name = "HIC", .format = "%.1f") \
    X(INNER, injury.hic.t1, "hic_t1_ms", 1e3, "begin of its window") \
    X(INNER, injury.hic.t2, "hic_t2_ms", 1e3, "end of its window") \
    X(INNER, injury.hic15.value, "hic15", 1, "head injury criterion, window of 15 ms at most", \
      .name = "HIC15", .format = "%.1f") \
    X(INNER, injury.hic15.t1, "hic15_t1_ms", 1e3, "begin of its window") \
    X(INNER, injury.hic15.t2, "hic15_t2_ms", 1e3, "end of its window") \
    X(INNER, injury.hic36.value, "hic36", 1, "head injury criterion, window of 36 ms at most", \
      .name = "HIC36", .format = "%.1f") \
    X(INNER, injury.hic36.t1, "hic36_t1_ms", 1e3, "begin of its window") \
    X(INNER, injury.hic36.t2, "hic36_t2_ms", 1e3, "end of its window") \
    X(INNER, injury.gadd, "gadd", 1, "Gadd severity index", \
      .name = "Gadd index", .format = "%.1f") \
    X(INNER, injury.clip_contiguous_g, "clip_3ms_g", 1, "exceeded for 3 ms without a break", \
      .name = "3 ms clip", .unit = "g", .format = "%.2f") \
    X(INNER, injury.clip_cumulative_g, "clip_3ms_cumulative_g", 1, "exceeded for 3 ms in all") \
    X(INNER, injury_raw.a_max_g, "a_max_raw_g", 1, "largest deceleration of the raw curve", \
      .name = "a_max, raw", .unit = "g", .format = "%.2f") \
    X(INNER, injury_raw.hic.value, "hic_raw", 1, "head injury criterion of the raw curve, no limit of the window") \
    X(NUMBER, a_max_by_speed, "a_max_change_by_speed", 1, "estimated relative change of a_max for 1 % more speed (theory.md, \"Edges\")", \
      .name = "a_max, 1 % more speed", .shown = 100, .unit = "%", .format = "%+.2f") \
    X(NUMBER, a_max_by_thickness, "a_max_change_by_thickness", 1, "the same for 1 % more thickness of the pad", \
      .name = "a_max, 1 % thicker", .shown = 100, .unit = "%", .format = "%+.2f") \
    X(NUMBER, a_max_by_stress, "a_max_change_by_stress", 1, "the same for 1 % more stress of the foam") \
    X(NUMBER, a_max_by_lock_up, "a_max_change_by_lock_up", 1, "the same for a lock-up strain later by 0.005: of a foam whose stress has a pole below 1, alone in its pad", \
      .name = "a_max, lock-up later by 0.005", .shown = 100, .unit = "%", .format = "%+.2f") \
    X(NUMBER, hic_by_speed, "hic_change_by_speed", 1, "estimated relative change of HIC for 1 % more speed", \
      .name = "HIC, 1 % more speed", .shown = 100, .unit = "%", .format = "%+.2f") \
    X(NUMBER, hic_by_thickness, "hic_change_by_thickness", 1, "the same for 1 % more thickness of the pad") \
    X(NUMBER, hic_by_stress, "hic_change_by_stress", 1, "the same for 1 % more stress of the foam") \
    X(NUMBER, hic_by_lock_up, "hic_change_by_lock_up", 1, "the same for a lock-up strain later by 0.005", \
      .name = "HIC, lock-up later by 0.005", .shown = 100, .unit = "%", .format = "%+.2f") \
    X(NUMBER, a_max_scatter, "a_max_scatter", 1, "estimated standard deviation of a_max from drop to drop, over it: by `missile.speed_scatter` and `pad.thickness_tolerance`", \
      .name = "a_max, scatter of drops", .shown = 100, .unit = "%", .format = "%.2f") \
    X(NUMBER, hic_scatter, "hic_scatter", 1, "the same of HIC", \
      .name = "HIC, scatter of drops", .shown = 100, .unit = "%", .format = "%.2f") \
    X(NUMBER, a_max_mesh_error, "a_max_mesh_error", 1, "expected error of a_max by the mesh, over it: from drops of the section on finer meshes where the drop is axisymmetric, or of a drop that is like it (theory.md, section 14), else from the spacing and the size of the contact; undefined where softfall-pre estimates none", \
      .name = "a_max, by the mesh", .shown = 100, .unit = "%", .format = "%.2g") \
    X(NUMBER, hic_mesh_error, "hic_mesh_error", 1, "the same of HIC; only where the drop is axisymmetric", \
      .name = "HIC, by the mesh", .shown = 100, .unit = "%", .format = "%.2g") \
    X(NUMBER, indentation_mesh_error, "max_indentation_mesh_error", 1, "the same of the largest indentation", \
      .name = "indentation, by the mesh", .shown = 100, .unit = "%", .format = "%.2g") \
    X(COUNT, raw_peak_rows, "a_max_raw_rows", 1, "rows around that peak above half of it: 1 or 2 are an artefact of the time step") \
    X(NUMBER, peak_resultant, "peak_resultant_g", 1, "largest resultant acceleration of the centre of mass of a free missile, its axes filtered: a_max_g of it; like the next ones undefined of a guided one") \
    X(NUMBER, peak_angular_acceleration, "peak_angular_acceleration_rad_s2", 1, "largest resultant angular acceleration, its axes filtered", \
      .name = "angular acceleration", .unit = "rad/s2", .format = "%.1f") \
    X(NUMBER, peak_angular_acceleration_time, "peak_angular_acceleration_time_ms", 1e3, "its time") \
    X(NUMBER, peak_angular_velocity, "peak_angular_velocity_rad_s", 1, "largest resultant angular velocity, its axes filtered", \
      .name = "angular velocity", .unit = "rad/s", .format = "%.2f") \
    X(NUMBER, peak_angular_velocity_time, "peak_angular_velocity_time_ms", 1e3, "its time") \
    X(NUMBER, bric, "bric", 1, "brain injury criterion: root of the sum of squares of the largest angular velocities, filtered, about the axes x, y and z that turn with the missile, over 66.25, 56.45 and 42.87 rad/s; it is that of a head if the geometry has x forwards and z along the neck", \
      .name = "BrIC", .format = "%.3f") \
    X(NUMBER, cfc, "cfc", 1, "channel frequency class of the filter") \
    X(NUMBER, rate, "sampling_rate_Hz", 1, "sampling of the filtered curve") \
    X(NUMBER, v0, "v0_m_s", 1, "speed at contact") \
    X(NUMBER, v_rebound, "v_rebound_m_s", 1, "speed upwards in the first row after contact; of a free missile that of its centre, along z", \
      .name = "rebound speed", .unit = "m/s", .format = "%.3f") \
    X(NUMBER, rebound_time, "rebound_time_ms", 1e3, "time of that row") \
    X(NUMBER, absorbed_energy, "absorbed_energy_J", 1, "m (v0^2 - v_rebound^2) / 2; of a free missile the loss of its kinetic energy") \
    X(NUMBER, absorbed_energy_fraction, "absorbed_energy_fraction", 1, "that of m v0^2 / 2; of a free missile of its first kinetic energy", \
      .name = "absorbed energy", .unit = "%", .format = "%.1f", .shown = 100) \
    X(NUMBER, absorbed_density, "absorbed_energy_per_volume_kJ_m3", 1e-3, "that energy / (largest contact_area x thickness): per unit of pad volume under the missile") \
    X(NUMBER, max_indentation, "max_indentation_mm", 1e3, "largest indentation", \
      .name = "largest indentation", .unit = "mm", .format = "%.2f") \
    X(NUMBER, max_indentation_time, "max_indentation_time_ms", 1e3, "its time") \
    X(NUMBER, max_mean_strain, "max_mean_strain", 1, "largest indentation / thickness", \
      .name = "  over thickness", .format = "%.3f") \
    X(NUMBER, max_local_strain, "max_local_strain", 1, "largest of largest_compression in the history", \
      .name = "largest local strain", .format = "%.3f") \
    X(NUMBER, max_local_strain_time, "max_local_strain_time_ms", 1e3, "its time") \
    X(NUMBER, local_strain_excess, "local_strain_excess", 1, "max_local_strain - max_mean_strain") \
    X(NUMBER, local_collapse, "local_collapse", 1, "excess of a node's compression over the median of its neighbours (nodes of a common cell; of a node on a steep free face those on such faces, if less), at /peak: the largest that nodes with 0.5 % of the foam's energy reach") \
    X(NUMBER, energy_beyond_data, "energy_beyond_data", 1, "share of the foam's energy, at /peak, in nodes compressed beyond `informed_strain`, each by that of its layer") \
    X(NUMBER, smallest_jacobian, "smallest_jacobian", 1, "smallest det F") \
    X(NUMBER, max_penetration, "max_penetration_mm", 1e3, "deepest penetration of a contact point") \
    X(INNER, cut.depth, "rim_depth_mm", 1e3, "largest depth of missile or supports in the foam between the pad's nodes at /peak; of smooth surfaces the part beyond 1/16 of the spacing") \
    X(NUMBER, below_anvil, "below_anvil_mm", 1e3, "largest depth of a node below the anvil's plane, in the frames and at /peak; undefined without an anvil") \
    X(NUMBER, energy_error, "energy_error", 1, "largest magnitude over the run, like the next four", \
      .name = "energy error", .unit = "%", .format = "%.4f", .shown = 100) \
    X(NUMBER, momentum_error, "momentum_error", 1, "of the momentum balance") \
    X(NUMBER, momentum_error_space, "momentum_error_space", 1, "of the momentum in space") \
    X(NUMBER, angular_momentum_error, "angular_momentum_error", 1, "of the angular momentum") \
    X(NUMBER, constraint_residual, "constraint_residual_m_s", 1, "|G v|") \
    X(NUMBER, internal_energy_peak, "internal_energy_peak_J", 1, "largest stored + hysteresis + viscous + stabilisation") \
    X(NUMBER, internal_energy_peak_time, "internal_energy_peak_time_ms", 1e3, "its time") \
    X(NUMBER, stabilisation_energy_fraction, "stabilisation_energy_fraction", 1, "work of the stabilisation at that time, of that energy", \
      .name = "stabilisation energy", .unit = "% of the internal energy", .format = "%.3f", .shown = 100) \
    X(NUMBER, contact_energy_fraction, "contact_energy_fraction", 1, "energy lost in contact at that time, of that energy", \
      .name = "contact energy", .unit = "% of the internal energy", .format = "%.3f", .shown = 100) \
    X(NUMBER, vibration_energy_fraction, "vibration_energy_fraction", 1, "largest energy of motion that alternates from step to step, of that energy") \
    X(NUMBER, negative_dissipation, "negative_dissipation", 1, "most that hysteresis, viscosity, friction or stabilisation had given back at any time beyond what it had taken, in the whole or summed over the single nodes that gave, of that energy") \
    X(NUMBER, base_force, "base_force_N", 1, "largest force, along z, that base, anvil and support transmit: base_reaction as a force plate reads it, passed through the filter class of the acceleration (not in a prescribed motion)") \
    X(NUMBER, area, "section_mm2", 1e6, "mean cross-section: volume of the whole pad at rest / its height") \
    X(NUMBER, peak_force, "peak_force_N", 1, "largest contact force (prescribed motion, like the next four)", \
      .name = "largest force", .unit = "N", .format = "%.2f") \
    X(NUMBER, peak_force_time, "peak_force_time_ms", 1e3, "its time") \
    X(NUMBER, peak_stress, "peak_stress_kPa", 1e-3, "that force / mean cross-section", \
      .name = "  over mean section", .unit = "kPa", .format = "%.2f") \
    X(NUMBER, work, "work_J", 1, "largest work of the motion on the pad so far", \
      .name = "work", .unit = "J", .format = "%.4f") \
    X(NUMBER, returned_energy_fraction, "returned_energy_fraction", 1, "of it, given back by the end; undefined if the run ended in contact", \
      .name = "  given back", .unit = "%", .format = "%.1f", .shown = 100) \
    X(FACT_TEXT, status, "status", 1, "how the run ended: as /summary/status in results.h5") \
    X(FLAG, touched, "touched", 1, "the missile touched the pad") \
    X(FLAG, driven, "prescribed_motion", 1, "the missile's motion was prescribed") \
    X(FLAG, turns, "free_missile", 1, "the missile had six degrees of freedom: all acceleration figures, HIC too, are of the resultant") \
    X(FLAG, kinematic, "kinematic_acceleration", 1, "the figures are of the kinematic acceleration, not of the reading of an accelerometer") \
    X(FLAG, rebounded, "rebounded", 1, "contact had ended before the last row, upwards") \
    X(FACT, contact_time, "contact_time_ms", 1e3, "first contact") \
    X(NUMBER, end_time, "end_time_ms", 1e3, "time of the last row of the history") \
    X(FACT, thickness, "thickness_mm", 1e3, "of the foam under the contact, along the missile's path, its vertical part") \
    X(FACT, set, "set_mm", 1e3, "permanent set of the pad before this drop: depth at the impact point; undefined without one") \
    X(FACT, impact_x, "impact_x_mm", 1e3, "x of the impact point: where the missile's lowest point arrives at the pad's top") \
    X(FACT, impact_y, "impact_y_mm", 1e3, "its y") \
    X(NUMBER, missile_mass, "missile_mass_kg", 1, "of the whole missile") \
    X(FACT, density, "density_kg_m3", 1, "of the undeformed foam, the mean of layers") \
    X(FACT, informed_strain, "informed_strain", 1, "strain up to which the material's data inform its curve: `material.informed_strain`, or the end of the table; of layers the least") \
    X(FACT_COUNT, modelled_parts, "symmetry_factor", 1, "modelled parts that make the whole") \
    X(FACT_COUNT, modelled_nodes, "nodes", 1, "of the modelled part, like the next two") \
    X(FACT_COUNT, modelled_cells, "cells", 1, "of the background mesh") \
    X(FACT_COUNT, interactions, "interactions", 1, "(domain, node) pairs") \
    X(FACT_COUNT, frame_count, "frames", 1, "frames in results.h5 that can be used") \
    X(COUNT, steps, "steps", 1, "time steps") \
    X(FACT, wall_time, "wall_s", 1, "time of the run") \
    X(FACT_COUNT, threads, "threads", 1, "OpenMP threads")
/* clang-format on */

#define SF_FIGURE_NUMBER(member) double member;
#define SF_FIGURE_COUNT(member) int64_t member;
#define SF_FIGURE_FLAG(member) bool member;
#define SF_FIGURE_INNER(member)
#define SF_FIGURE_FACT(member)
#define SF_FIGURE_FACT_COUNT(member)
#define SF_FIGURE_FACT_TEXT(member)
#define SF_FIGURE_MEMBER(kind, member, ...) SF_FIGURE_##kind(member)
typedef struct sf_figures {
    sf_series raw;            /* s, g: the history as it is; of a missile that turns the resultant; owned */
    sf_series filtered;       /* s, g: resampled and CFC filtered, each axis by itself; owned */
    sf_signal_chain chain;    /* that the filtered curves have passed */
    const char *acceleration; /* what the curves show, a few words; static storage */
    char passed[128];         /* ", on a mount of 420 Hz (damping 0.05)", the chain; or empty */
    double free_flight;       /* g: what both are while nothing touches the missile */
    sf_injury injury_raw;
    sf_injury injury; /* of the filtered curve */
    sf_rim_cut cut;
    sf_layer_figures *layers;    /* [results->layer_count] owned; NULL: one material, or no contact */
    SF_FIGURES(SF_FIGURE_MEMBER) /* SI */
} sf_figures;

/* A line of the list. */
typedef struct sf_figure {
    sf_row row;
    bool fact; /* in sf_results instead of sf_figures */
} sf_figure;

/* g: the acceleration that a_max and HIC are of, not filtered, in a row of the history. */
double sf_figures_reading(const sf_results *results, int64_t row);

#define SF_FIGURE_ONE(...) +1
enum { SF_FIGURE_TOTAL = 0 SF_FIGURES(SF_FIGURE_ONE) };
#undef SF_FIGURE_ONE
extern const sf_figure sf_figure_at[SF_FIGURE_TOTAL];
/* The line of that key; NULL if there is none. */
const sf_figure *sf_figure_find(const char *key);

/* Returns the record of the row: `results` or `figures`. */
const void *sf_figure_record(const sf_figure *figure, const sf_results *results, const sf_figures *figures);

/* The number that summary.json shows, true as 1; NaN: not defined, or a text. */
double sf_figure_number(const sf_figure *figure, const sf_results *results, const sf_figures *figures);

/* Release with sf_figures_free. `chain`: what the accelerometer adds; NULL: nothing. */
sf_status sf_figures_compute_through(const sf_results *results, double cfc, const sf_signal_chain *chain,
                                     sf_figures *figures, sf_error *err);
sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *figures, sf_error *err);
void sf_figures_free(sf_figures *figures);

/* Extrapolates a figure from the spacings h and `ratio` h to zero (Richardson, order 1.3): `refined` receives
 * the value and its error, which is the whole correction, at least 0.5 % of the figure. `cells`: their number
 * at h over that at `ratio` h; INFINITY: not known. SF_ERR_INPUT, and NaN: a figure is no number, the mesh is
 * not coarser in all directions, or the correction is above the 10 % of the figure up to which it was
 * checked. */
sf_status sf_figure_refine(double fine, double coarse, double ratio, double cells, double refined[2],
                           sf_error *err);
