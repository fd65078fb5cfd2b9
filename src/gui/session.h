/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One case in the window: its fields, its geometry, its run, and what is shown of them. */
#pragma once
#include "study/run_folder.h"
#include "gui/fields.h"
#include "gui/pictures.h"
#include "gui/activity.h"
#include "io/process.h"

typedef struct sf_session {
    const char *case_path; /* borrowed */
    int threads;           /* of softfall-solve; 0: as it chooses */
    char cache[PATH_MAX];  /* its runs are there; "": there is no place for them */
    sf_case case_file;     /* without the changes of the window */
    sf_fields fields;
    sf_watch watch; /* what was read of the case and its geometries */
    sf_activity activity;
    sf_check_entries checks; /* in the tree */
    char sentence[1100];     /* the last one told */
    bool failed;             /* it is an error */
    sf_pictures pictures;
    sf_pictures_place place;
    double next_look; /* s, at the program that runs and the files */

    sf_run_folder at; /* of the present values; path "" until Mesh or Run */
    sf_child child;
    int lock;      /* on the folder of the run while a program is at work; 0: none */
    FILE *log;     /* its output */
    bool resuming; /* softfall-solve goes on from a checkpoint */
    bool told;     /* softfall-solve has told its progress */
} sf_session;

/* Reads the case and shows it in the window. Failures are told there. Release with sf_session_end. */
void sf_session_begin(sf_session *session);
/* Ends the program that runs, so that its results can be resumed; releases. */
void sf_session_end(sf_session *session);

/* A button ("mesh", "run", "stop", "report", "paraview", "save") or "check". */
void sf_session_act(sf_session *session, const char *action);
/* Looks after the program that runs, its results and the files that were read. */
void sf_session_refresh(sf_session *session);
