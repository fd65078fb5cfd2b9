/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/memory.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/* Largest size of the file, which each run reads as a whole. */
static const size_t LARGEST = (size_t)1 << 28;

typedef struct head {
    uint64_t key, count;
} head;

enum { FRAME = sizeof(head) + sizeof(uint64_t) /* bytes of a record beside its values */ };

static head head_at(const char *record) {
    head h;
    memcpy(&h, record, sizeof h);
    return h;
}

/* Bytes of the record that begins here; 0: it is not whole. */
static size_t measure(const char *record, size_t left) {
    uint64_t hash;
    if (left < FRAME || head_at(record).count > (left - FRAME) / sizeof(double))
        return 0;
    size_t length = sizeof(head) + (size_t)head_at(record).count * sizeof(double);
    memcpy(&hash, record + length, sizeof hash);
    return hash == sf_hash_identity(SF_HASH_START, record, length) ? length + sizeof hash : 0;
}

/* Opened and locked; -1 on failure. */
static int open_locked(const char *path) {
    sf_error none = SF_ERROR_INIT;
    FILE *made = sf_replace_exists(path) ? NULL : sf_replace_create(path, &none);
    if (made)
        fclose(made);
    int file = sf_replace_reopen(path);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

void sf_fit_memory_open(const char *path, sf_fit_memory *m) {
    char program[PATH_MAX];
    sf_error err = SF_ERROR_INIT;
    size_t size = 0, length;
    *m = (sf_fit_memory){.file = -1};
    if (sf_process_find("softfall-fit", program, sizeof program, &err) != SF_OK ||
        sf_plain_hash(program, NULL, SF_PLAIN_ANY, &m->program, &err) != SF_OK ||
        (m->file = open_locked(path)) < 0)
        return;
    if (sf_plain_read(path, NULL, LARGEST, &m->text, &size, &err) != SF_OK) {
        sf_fit_memory_close(m);
        return;
    }
    while ((length = measure(m->text + m->size, size - m->size)) != 0)
        m->size += length;
    m->end = m->size;
}

void sf_fit_memory_close(sf_fit_memory *m) {
    if (m->file >= 0)
        close(m->file);
    free(m->text);
    *m = (sf_fit_memory){.file = -1};
}

bool sf_fit_memory_find(sf_fit_memory *m, uint64_t key, size_t count, double *value) {
    size_t at = m ? m->next : 0, length;
    for (size_t seen = 0; m && seen < m->size; seen += length, at += length) {
        if (at == m->size)
            at = 0;
        head h = head_at(m->text + at);
        length = FRAME + (size_t)h.count * sizeof *value;
        if (h.key == key && h.count == count) {
            memcpy(value, m->text + at + sizeof h, count * sizeof *value);
            m->next = at + length;
            return true;
        }
    }
    return false;
}

void sf_fit_memory_add(sf_fit_memory *m, uint64_t key, size_t count, const double *value) {
    size_t length = sizeof(head) + count * sizeof *value, size = length + sizeof key;
    if (!m || m->file < 0 || size > LARGEST - m->end)
        return;
    sf_error none = SF_ERROR_INIT;
    char *record = sf_alloc(&none, 1, size, "record");
    if (record) {
        const head h = {key, count};
        memcpy(record, &h, sizeof h);
        memcpy(record + sizeof h, value, count * sizeof *value);
        uint64_t hash = sf_hash_identity(SF_HASH_START, record, length);
        memcpy(record + length, &hash, sizeof hash);
    }
    if (record && pwrite(m->file, record, size, (off_t)m->end) == (ssize_t)size) {
        m->end += size;
    } else {
        close(m->file);
        m->file = -1;
    }
    free(record);
}
