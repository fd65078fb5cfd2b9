/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/broker.h"

#include "io/plain_file.h"
#include "pre/mesh/mesher_protocol.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MOST_FILES = 1000 };

/* What the libraries below gmsh look for: they are told that it is not there. */
static const char *const of_libraries[] = {
    "/etc/", "/proc/", "/sys/", "/usr/lib/locale/", "/usr/share/locale/", "/usr/share/zoneinfo/",
};

void sf_broker_free(sf_broker *b) {
    for (size_t k = 0; k < b->count; k++) {
        free(b->file[k].path);
        free(b->file[k].text);
    }
    free(b->file);
    *b = (sf_broker){0};
}

int sf_broker_memory(const char *text, size_t size) {
    int file = memfd_create("softfall", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    size_t done = 0;
    while (file >= 0 && done < size) {
        ssize_t written = write(file, text + done, size - done);
        if (written < 0 && errno != EINTR) {
            close(file);
            return -1;
        }
        done += written > 0 ? (size_t)written : 0;
    }
    if (file >= 0 &&
        (fcntl(file, F_ADD_SEALS, F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) != 0 ||
         lseek(file, 0, SEEK_SET) != 0)) {
        close(file);
        return -1;
    }
    return file;
}

/* gmsh drops all but the first statement of a last line without its end. */
static sf_status end_last_line(sf_broker_file *f, sf_error *err) {
    f->is_text = memchr(f->text, '\0', f->size) == NULL;
    if (!f->is_text || f->size == 0 || f->text[f->size - 1] == '\n')
        return SF_OK;
    char *longer = realloc(f->text, f->size + 2);
    if (!longer)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a geometry");
    f->text = longer;
    memcpy(f->text + f->size++, "\n", 2);
    return SF_OK;
}

static sf_broker_file *add_file(sf_broker *b) {
    if (b->count == b->capacity) {
        size_t capacity = b->capacity ? 2 * b->capacity : 8;
        sf_broker_file *grown = realloc(b->file, capacity * sizeof *grown);
        if (!grown)
            return NULL;
        b->file = grown;
        b->capacity = capacity;
    }
    b->file[b->count] = (sf_broker_file){0};
    return &b->file[b->count];
}

/* Reads the file through the gate and keeps it. 0 or an errno value. */
static int read_file(sf_broker *b, const char *path, const sf_broker_file **out) {
    sf_error err = SF_ERROR_INIT;
    sf_broker_file *f = b->count < MOST_FILES ? add_file(b) : NULL;
    if (!f)
        return ENFILE;
    if (access(path, F_OK) != 0)
        return errno;
    if (sf_plain_read(path, NULL, b->most - b->bytes, &f->text, &f->size, &err) == SF_OK) {
        f->hash = sf_plain_get(sf_plain_count() - 1).hash;
        f->path = strdup(path);
        if (f->path && end_last_line(f, &err) == SF_OK) {
            b->bytes += f->size;
            b->count++;
            *out = f;
            return 0;
        }
    }
    if (*b->refused == '\0')
        snprintf(b->refused, sizeof b->refused, "%.590s", err.text);
    free(f->path);
    free(f->text);
    return EACCES;
}

static bool is_of_libraries(const char *path) {
    for (size_t k = 0; k < sizeof of_libraries / sizeof of_libraries[0]; k++)
        if (strncmp(path, of_libraries[k], strlen(of_libraries[k])) == 0)
            return true;
    return false;
}

int sf_broker_open(sf_broker *b, const char *path, int flags, int *file) {
    const sf_broker_file *found = NULL;
    *file = -1;
    if (!b->ready || is_of_libraries(path))
        return ENOENT;
    if ((flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC))) {
        if (*b->written == '\0')
            snprintf(b->written, sizeof b->written, "%s", path);
        return EACCES;
    }
    if ((flags & (O_DIRECTORY | O_PATH)) || strchr(path, '\n'))
        return EACCES;
    if (strcmp(path, SF_MESHER_PARAMETERS_NAME) == 0) {
        *file = sf_broker_memory(b->parameters, strlen(b->parameters));
        return *file < 0 ? errno : 0;
    }
    for (size_t k = 0; k < b->count && !found; k++)
        if (strcmp(b->file[k].path, path) == 0)
            found = &b->file[k];
    int error = found ? 0 : read_file(b, path, &found);
    if (error != 0)
        return error;
    *file = sf_broker_memory(found->text, found->size);
    return *file < 0 ? errno : 0;
}
