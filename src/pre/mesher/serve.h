/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

/* Forks the spare of the host (pre/mesh/mesher_spare.h) if it has asked for one, and returns; in the spare it
 * returns in each child that is forked for a geometry, and not in the spare itself. */
void sf_serve(void);
