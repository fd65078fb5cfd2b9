/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A drop on a pad that has been hit before: its foam's history goes on from the end of an earlier run. The
 * laws have no permanent set, so that the pad at rest is the undeformed one, exactly: the history is unloaded
 * to it and rests, and nothing else of the earlier run remains. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* The pad from which a run begins. */
typedef struct sf_earlier {
    const char
        *results; /* of the earlier run, with its checkpoint beside it; NULL: the pad is new; borrowed */
    double pause; /* s, of the pad between them */
} sf_earlier;

/* A new state (sf_state_create) on that pad. SF_ERR_INPUT if the earlier run has not ended with the missile
 * away from the pad, or if its pad is another one: nodes, volumes, layers or what the laws remember. */
sf_status sf_series_begin(const sf_earlier *earlier, const sf_model *model, const sf_operators *operators,
                          sf_state *state, sf_error *err);
