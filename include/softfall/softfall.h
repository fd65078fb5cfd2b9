/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall: drop tests of rigid missiles on foam pads.
 *
 *     case -> model -> drop -> figures
 *
 * A case (case.cfg, docs/case.md) and its geometry give a model, which never changes after that. A drop is
 * the solution of a model as it advances in time. The figures are those of softfall-post, digit for digit.
 *
 * Two libraries: libsoftfall solves and evaluates; libsoftfall-build reads cases, foams and compression
 * tests, and is the only one that needs gmsh.
 *
 * Units are SI (m, kg, s, N, J, Pa), accelerations in figures are in g = 9.80665 m/s2. The frame is that of
 * the geometry, with the pad's top towards +z. Forces and energies are those of the whole pad and the whole
 * missile, whatever the symmetry of the model.
 *
 * Handles are opaque. A function that creates one gives it to the caller, who releases it with the function
 * of that name and `_free`, which takes NULL as well. On failure the handle is NULL.
 *
 * Nothing is printed and the process is never ended. A function that can fail returns a status; `error`, if
 * it is not NULL, then holds the status and a sentence that names the entity, the value and the bound. After
 * success `error` holds SOFTFALL_OK and "". Texts are UTF-8.
 *
 * Threads: different handles may be used by different threads of the host at the same time, except that only
 * one model can be built at a time and files are read and written by one thread at a time. */
#pragma once

/* libsoftfall */
#include "softfall/batch.h"
#include "softfall/curve.h"
#include "softfall/drop.h"
#include "softfall/figures.h"
#include "softfall/model.h"
#include "softfall/record.h"
#include "softfall/status.h"
#include "softfall/units.h"

/* libsoftfall-build */
#include "softfall/case.h"
#include "softfall/compression.h"
#include "softfall/form.h"
#include "softfall/material.h"
#include "softfall/settings.h"
#include "softfall/variant.h"
