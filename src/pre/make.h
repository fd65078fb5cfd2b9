/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the model of a case: the geometry through gmsh, then the build. */
#pragma once
#include "pre/build.h"

enum { SF_LIBRARIES_SIZE = 96 };

/* `libraries` receives the versions of the libraries that took part. The curves and the motion of the case
 * move into the model (sf_model_build). Warnings go to `sink`. SF_ERR_INPUT, too, if every contact point is
 * held, or if the pad is not held (hold.h). On failure `*model` is empty. */
sf_status sf_model_make(sf_case *c, sf_model *model, sf_build_report *report,
                        char libraries[SF_LIBRARIES_SIZE], const sf_sink *sink, sf_error *err);
