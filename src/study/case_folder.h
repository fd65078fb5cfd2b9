/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case with everything that it needs in a folder of its own, which can be moved, packed and sent:
 * case.cfg, its geometries with what they include and merge, its materials with their curves, and a README.
 * Its drop has the same bits as that of the case itself. */
#pragma once
#include "base/error.h"

typedef struct sf_case_folder_request {
    const char *case_path;
    int override_count;           /* values that differ from the file's */
    const char *const *overrides; /* [override_count] "group.key=value" or "group=@file", as for --set */
    const char *folder;           /* to be made; not there yet, or empty */
    const char *origin;           /* of the case, for the README: "the example eva50-v4.5"; NULL: its path */
} sf_case_folder_request;

/* Makes the folder, as a whole or not at all (io/staging.h). The texts of the case stay as they are but for
 * the overrides and the names of files; gmsh runs on each geometry twice, here and in the new folder, to
 * learn what it reads and that its mesh is the same. Warnings about the case go to `sink`.
 *
 * SF_ERR_INPUT: sf_case_read or gmsh refuses the case; `folder` exists and is not an empty folder; a geometry
 * gives another mesh in the new folder, or reads files there that are not in it. SF_ERR_IO: the folder cannot
 * be written. SF_INTERRUPTED: a signal came (sf_process_stopped). */
sf_status sf_case_folder_make(const sf_case_folder_request *request, const sf_sink *sink, sf_error *err);
