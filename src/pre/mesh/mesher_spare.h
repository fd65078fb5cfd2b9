/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A spare softfall-mesh for the further geometries of a session, as loading gmsh takes long beside a fork of
 * the loaded process (docs/adr/0014-confined-gmsh.md). The first softfall-mesh forks a copy of itself before
 * it reads anything; the copy waits, and forks a child of this process for each further geometry. It reads
 * none itself, so that no geometry sees another. */
#pragma once
#include "pre/mesh/mesher_protocol.h"

#include <sys/types.h>

/* The spare of a session, which one thread uses without a change of the folder; zeros: there is none. */
typedef struct sf_mesher_spare {
    bool is_open;  /* a softfall-mesh was started that may have left one */
    int socket;    /* to it */
    pid_t process; /* 0: not told yet */
} sf_mesher_spare;

/* Makes the socket of a spare that a softfall-mesh, about to be started, leaves behind. Returns the end that
 * this gets as SF_MESHER_SPARE, for the caller to close; -1: there will be none, which does no harm. */
int sf_mesher_spare_prepare(sf_mesher_spare *spare);

/* Lets the spare fork a child of this process that has the files of a job (mesher_protocol.h). Returns the
 * child; 0: there is no spare any more, and softfall-mesh has to be started, with other files. */
pid_t sf_mesher_spare_fork(sf_mesher_spare *spare, const int file[SF_MESHER_JOB]);

/* Ends it, and waits for its end. */
void sf_mesher_spare_end(sf_mesher_spare *spare);
