/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Folders. */
#ifndef SF_IO_FOLDER_H
#define SF_IO_FOLDER_H

#include "core/error.h"

/* Makes the folder unless something of that name is there. */
sf_status sf_folder_make(const char *path, sf_error *err);

#endif
