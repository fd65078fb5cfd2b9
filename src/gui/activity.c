/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/activity.h"

const char *sf_activity_name(sf_activity activity) {
#define NAME(constant, name) name,
    static const char *const names[] = {SF_ACTIVITIES(NAME)};
#undef NAME
    return names[activity];
}

bool sf_activity_is_busy(sf_activity a) {
    return a == SF_MESHING || a == SF_PREPARING || a == SF_RUNNING || a == SF_STOPPING ||
           a == SF_CANCELLING || a == SF_REPORTING || a == SF_SAVING;
}

/* After a program has ended well. */
static sf_activity succeed(sf_activity a) {
    switch (a) {
    case SF_MESHING:
        return SF_MESHED;
    case SF_PREPARING:
        return SF_RUNNING;
    case SF_RUNNING:
        return SF_REPORTING;
    case SF_SAVING:
        return SF_SAVED;
    case SF_REPORTING:
    case SF_STOPPING: /* the run had ended before it was asked to */
        return SF_DONE;
    case SF_CANCELLING:
        return SF_STOPPED;
    default:
        return a;
    }
}

/* Only a run leaves results. */
static sf_activity stop(sf_activity a) {
    switch (a) {
    case SF_MESHING:
    case SF_PREPARING:
    case SF_SAVING:
        return SF_CANCELLING;
    case SF_RUNNING:
    case SF_REPORTING:
        return SF_STOPPING;
    default:
        return a;
    }
}

sf_activity sf_activity_next(sf_activity a, sf_event event) {
    bool busy = sf_activity_is_busy(a);
    switch (event) {
    case SF_PRESS_MESH:
        return busy ? a : SF_MESHING;
    case SF_PRESS_RUN:
        return busy ? a : a == SF_DONE ? SF_REPORTING : SF_PREPARING;
    case SF_PRESS_SAVE:
        return busy ? a : SF_SAVING;
    case SF_PRESS_STOP:
        return stop(a);
    case SF_CHILD_DONE:
        return succeed(a);
    case SF_CHILD_INTERRUPTED:
        return busy ? SF_STOPPED : a;
    case SF_CHILD_FAILED:
        return a == SF_STOPPING || a == SF_CANCELLING ? SF_STOPPED : busy ? SF_FAILED : a;
    case SF_EDIT:
        return busy ? a : SF_IDLE;
    default:
        return a;
    }
}
