/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the mesh stream (pre/mesh/mesher_protocol.h) to SF_MESHER_DATA. A parent that does not listen ends
 * this process. */
#ifndef SF_MESHER_STREAM_H
#define SF_MESHER_STREAM_H

#include <stddef.h>
#include <stdint.h>

void sf_stream_word(uint64_t word);
void sf_stream_int(int value);
void sf_stream_text(const char *text);
/* `size` bytes, a multiple of 8. */
void sf_stream_words(const void *data, size_t size);
void sf_stream_flush(void);

#endif
