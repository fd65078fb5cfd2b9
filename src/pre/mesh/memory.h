/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much memory softfall-pre may take: SOFTFALL_MEMORY_MB of the environment if it is set, else what Linux
 * calls available. */
#ifndef SF_PRE_MESH_MEMORY_H
#define SF_PRE_MESH_MEMORY_H

/* Bytes; INFINITY if unknown. */
double sf_memory_available(void);

#endif
