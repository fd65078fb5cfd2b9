/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The activity of the window, and the next one that a button or the end of a program leads to. */
#ifndef SF_GUI_STATE_H
#define SF_GUI_STATE_H

#include <stdbool.h>

/* Name as it is shown. */
#define SF_ACTIVITIES(X)                                                                                     \
    X(IDLE, "ready")                                                                                         \
    X(MESHING, "meshing") /* softfall-pre for the checks */                                                  \
    X(MESHED, "meshed")                                                                                      \
    X(PREPARING, "meshing before the run") /* softfall-pre for a run */                                      \
    X(RUNNING, "running")                  /* softfall-solve */                                              \
    X(STOPPING, "stopping")                /* a run was asked to end */                                      \
    X(CANCELLING, "cancelling")            /* softfall-pre or Save case was asked to end */                  \
    X(STOPPED, "stopped")                  /* a run can be resumed */                                        \
    X(REPORTING, "writing the report")     /* softfall-post */                                               \
    X(SAVING, "saving the case")                                                                             \
    X(SAVED, "saved")                                                                                        \
    X(DONE, "done")                                                                                          \
    X(FAILED, "failed")

#define SF_ACTIVITY_CONSTANT(constant, name) SF_##constant,
typedef enum sf_activity { SF_ACTIVITIES(SF_ACTIVITY_CONSTANT) SF_ACTIVITY_COUNT } sf_activity;
#undef SF_ACTIVITY_CONSTANT

typedef enum sf_event {
    SF_PRESS_MESH,
    SF_PRESS_RUN, /* of what is done: its report */
    SF_PRESS_STOP,
    SF_PRESS_SAVE,
    SF_CHILD_DONE,        /* the program ended well */
    SF_CHILD_INTERRUPTED, /* it ended because it was asked to */
    SF_CHILD_FAILED,
    SF_EDIT, /* a value or a file has changed */
    SF_EVENT_COUNT
} sf_event;

/* "ready", ...; static. */
const char *sf_activity_name(sf_activity activity);
/* A program is at work. */
bool sf_activity_is_busy(sf_activity activity);
/* The activity after the event; the same one where the event means nothing. */
sf_activity sf_activity_next(sf_activity activity, sf_event event);

#endif
