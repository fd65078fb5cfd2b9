/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/error.h"

#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

void sf_error_clean(char *sentence) {
    for (char *c = sentence; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            *c = ' ';
}

sf_status sf_error_set(sf_error *err, sf_status status, const char *where, int line, const char *format,
                       ...) {
    SF_TRY(err->status);
    err->status = status;
    err->where = where;
    err->line = line;
    SF_PRINT_INTO(err->text, format);
    sf_error_clean(err->text);
    return status;
}

/* Large blocks are advised to use large pages: a step reads them from end to end, and address translation of
 * small pages costs a few percent of it. */
static void *allocate(unsigned long bytes) {
    static const unsigned long large = 2UL << 20;
    void *block = NULL;
    if (posix_memalign(&block, bytes < large ? 64 : large, bytes) != 0)
        return NULL;
    if (bytes >= large)
        madvise(block, bytes, MADV_HUGEPAGE); /* advice: nothing depends on it */
    return block;
}

void *sf_allocate(sf_error *err, unsigned long count, unsigned long size, const char *what) {
    if (size != 0 && count > (SIZE_MAX - 64) / size) {
        SF_FAIL(err, SF_ERR_MEMORY, "%s: %lu items of %lu bytes exceed the address space", what, count, size);
        return NULL;
    }
    unsigned long bytes = (count * size + 63) / 64 * 64;
    void *block = allocate(bytes ? bytes : 64);
    if (!block) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %s (%.1f MB)", what, (double)bytes / 1e6);
        return NULL;
    }
    memset(block, 0, bytes ? bytes : 64);
    return block;
}

sf_status sf_alloc_all(sf_error *err, const char *what, size_t rooms, const sf_room *room) {
    for (size_t k = 0; k < rooms; k++) {
        void *block = sf_allocate(err, room[k].count, room[k].size, what);
        memcpy(room[k].pointer, &block, sizeof block);
    }
    return err->status;
}

bool sf_grow(void *array, size_t count, size_t size) {
    void *block, *more;
    memcpy(&block, array, sizeof block);
    if (block && (count & (count - 1))) /* the array has room up to the next power of two */
        return true;
    if (!(more = realloc(block, (count ? 2 * count : 1) * size)))
        return false;
    memcpy(array, &more, sizeof more);
    return true;
}

void sf_release(void *pointer) {
    void *block;
    memcpy(&block, pointer, sizeof block);
    free(block);
    memset(pointer, 0, sizeof block);
}

void *sf_keep(void *block, const sf_error *err) {
    if (err->status == SF_OK)
        return block;
    free(block);
    return NULL;
}

void sf_free_all(size_t count, void *pointers) {
    for (size_t k = 0; k < count && pointers; k++)
        sf_release((char *)pointers + k * sizeof(void *));
}

void sf_clear(void *record, size_t size, size_t count, void *pointers) {
    sf_free_all(count, pointers);
    memset(record, 0, size);
}

void sf_log_print(FILE *log, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (log) {
        vfprintf(log, format, arguments);
        fflush(log);
    }
    va_end(arguments);
}

void sf_sink_tell(const sf_sink *sink, sf_severity severity, const char *format, ...) {
    char sentence[1024];
    if (!sink || !sink->tell)
        return;
    SF_PRINT_INTO(sentence, format);
    sf_error_clean(sentence);
    sink->tell(sink->user, severity, sentence);
}
