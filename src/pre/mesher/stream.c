/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesher/stream.h"

#include "pre/mesh/mesher_protocol.h"
#include <errno.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 65536 };

static char block[ROOM];
static size_t used;

static void write_all(const char *data, size_t size) {
    while (size > 0) {
        ssize_t written = write(SF_MESHER_DATA, data, size);
        if (written < 0 && errno != EINTR)
            _exit(1);
        data += written > 0 ? written : 0;
        size -= written > 0 ? (size_t)written : 0;
    }
}

void sf_stream_flush(void) {
    write_all(block, used);
    used = 0;
}

void sf_stream_words(const void *data, size_t size) {
    if (used + size > ROOM)
        sf_stream_flush();
    if (size > ROOM) {
        write_all(data, size);
    } else if (size > 0) {
        memcpy(block + used, data, size);
        used += size;
    }
}

void sf_stream_word(uint64_t word) {
    sf_stream_words(&word, sizeof word);
}

void sf_stream_int(int value) {
    sf_stream_word((uint64_t)(int64_t)value);
}

void sf_stream_text(const char *text) {
    size_t length = strlen(text);
    uint64_t last = 0;
    sf_stream_word(length);
    sf_stream_words(text, length / 8 * 8);
    memcpy(&last, text + length / 8 * 8, length % 8);
    if (length % 8 > 0)
        sf_stream_word(last);
}
