/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <math.h>
#include <stdbool.h>

/* The checks of a good run: a value of each beyond its first bound is a remark on the run's figures, beyond
 * the second they are not to be used. This list is the only one of them; the verdict of softfall-post
 * (post/figures/verdict.h), what warns, the studies and the table in docs/formats.md follow it. */

/* X(name, bound of a remark, title, value: as figures of summary.json, why it matters, other members of
 * sf_good_run_rule). The magnitude of a value is compared; a value that a run does not define is not judged.
 */
/* clang-format off */
#define SF_GOOD_RUN(X) \
    X(ending, 0, "end of the run", \
      "`status`, `touched`: 0 `finished` or `rebound`, 1 interrupted or no end, 2 failed or never touched", \
      "figures of a part of the drop are not those of the drop", \
      .refuse = 1) \
    X(ended_in_contact, 0, "deceleration left at the end", \
      "deceleration in the last row / `a_max_g`; 0 if `rebounded`", \
      "the peak or a part of the HIC window may lie after the end", \
      .refuse = 0.4, .sure = 1, .percent = true) \
    X(energy_error, 0.01, "energy error", \
      "`energy_error`", \
      "energy that appears or disappears falsifies the deceleration", \
      .refuse = 0.05, .percent = true) \
    X(momentum, 1e-6, "error of the momentum", \
      "the largest of `momentum_error`, `momentum_error_space` and `angular_momentum_error`, magnitudes", \
      "a force acts without its counterpart, where rounding alone is allowed: please report the case as a fault of softfall", \
      .refuse = 1e-3) \
    X(edge, 0.1, "edge: change of a_max for 1 % of speed or thickness", \
      "the larger of `a_max_change_by_speed` and `a_max_change_by_thickness`, magnitudes", \
      "the foam is about to lock up: what no laboratory can set as closely decides the peak", \
      .refuse = 0.5, .sure = 1, .percent = true) \
    X(stabilisation, 0.01, "stabilisation energy", \
      "`stabilisation_energy_fraction`", \
      "the stabilisation, which is not of the foam, bears load: the mesh decides the peak", \
      .refuse = 0.04, .sure = 0.7, .percent = true) \
    X(contact, 0.01, "contact energy", \
      "`contact_energy_fraction`", \
      "contact consumes energy that the foam should take", \
      .refuse = 0.05, .percent = true) \
    X(dissipation, 1e-3, "energy given back by what dissipates", \
      "`negative_dissipation`", \
      "hysteresis, viscosity, friction or stabilisation creates energy: the foam's curves or the mesh are wrong", \
      .refuse = 0.01, .sure = 0.7, .percent = true) \
    X(vibration, 2e-5, "energy of motion that alternates from step to step", \
      "`vibration_energy_fraction`", \
      "the time step is too long for something in the model: try a smaller `solver.step_safety`", \
      .refuse = 1e-3, .percent = true) \
    X(filter, 0.03, "raw peak against the filtered one", \
      "`a_max_raw_g` / `a_max_g` - 1; not of a `step_artefact`", \
      "the filter makes the peak, or single steps do", \
      .refuse = 0.25, .percent = true) \
    X(step_artefact, 0, "raw peak of one or two time steps", \
      "1 if `a_max_raw_rows` < 3, else 0", \
      "the raw peak grows as the time step shrinks and means nothing; the filtered figures do not depend on it", \
      .refuse = INFINITY) \
    X(coarse, 0.01, "mean strain above the largest local one", \
      "-`local_strain_excess`, at least 0", \
      "the mesh is too coarse to show the strain below the missile", \
      .refuse = INFINITY) \
    X(local_collapse, 0.1, "strain of nodes above their neighbours", \
      "`local_collapse`", \
      "nodes with 0.5 % of the energy collapse or carry the missile alone: the foam is unstable or the mesh too coarse", \
      .refuse = 0.3) \
    X(mesh, 0.03, "expected error of a_max from the mesh", \
      "`a_max_mesh_error`", \
      "the spacing under the missile is too coarse for its pad", \
      .refuse = 0.25, .sure = 1, .percent = true) \
    X(slit, 0, "nodes at a slit, hole or gap narrower than their supports", \
      "`/model/slit_fraction` of results.h5", \
      "the faces of the slit pass through each other where it closes", \
      .refuse = INFINITY, .percent = true) \
    X(informed, 0.01, "energy of the foam beyond the strains that its data inform", \
      "`energy_beyond_data`", \
      "there the material's curve is extrapolated, and with it the peak", \
      .refuse = 0.5, .percent = true) \
    X(anvil, 0.9, "indentation over the thickness", \
      "`max_mean_strain`", \
      "the missile reaches the anvil; its stiffness is not in the model", \
      .refuse = 0.95, .sure = 1) \
    X(rim, 0.01, "depth of missile or support in faces, over the spacing", \
      "the larger of `rim_depth_mm` / the edge of the face and `max_penetration_mm` / the pad's shortest edge", \
      "a part of missile or support is in the foam between the nodes: the foam beside it is pressed too little", \
      .refuse = 0.5, .percent = true) \
    X(below_anvil, 0.01, "foam below the anvil", \
      "`below_anvil_mm` / `thickness_mm`", \
      "the anvil acts on the surfaces of `pad.fixed` only: other foam passes through it and is too soft", \
      .refuse = 0.2, .sure = 1, .percent = true) \
    X(notes, 0, "notes of the programs", \
      "number of `notes` that do not only repeat `ending`", \
      "a program warned of the run or left something out", \
      .refuse = INFINITY)
/* clang-format on */

#define SF_GOOD_RUN_LIMIT(name, ...) double name;
typedef struct sf_good_run {
    SF_GOOD_RUN(SF_GOOD_RUN_LIMIT)
} sf_good_run;
#undef SF_GOOD_RUN_LIMIT

/* The bounds of a remark; static storage. */
const sf_good_run *sf_good_run_limits(void);

/* A line of the list. */
typedef struct sf_good_run_rule {
    const char *key, *title;
    double remark, refuse; /* the bounds; refuse INFINITY: none */
    double sure;           /* -, part of a_max that is sure beyond `refuse`; 1: a_max can only be too low; 0:
                              nothing is known */
    bool percent;          /* a sentence shows the value so */
    const char *figures, *why;
} sf_good_run_rule;

#define SF_GOOD_RUN_INDEX(name, ...) SF_CHECK_##name,
enum { SF_GOOD_RUN(SF_GOOD_RUN_INDEX) SF_CHECKS };
#undef SF_GOOD_RUN_INDEX

/* Line k of the list, 0 <= k < SF_CHECKS; static storage. */
const sf_good_run_rule *sf_good_run_rule_get(int k);
