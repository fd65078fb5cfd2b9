/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/broker.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "pre/mesh/mesher_protocol.h"
#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

enum { MOST_FILES = 1000 };

/* The files that the libraries below gmsh look for: they are told that the file is not there. */
static const char *const of_libraries[] = {
    "/etc/", "/proc/", "/sys/", "/usr/lib/locale/", "/usr/share/locale/", "/usr/share/zoneinfo/",
};

void sf_broker_free(sf_broker *b) {
    for (size_t k = 0; k < b->count; k++) {
        if (b->file[k].text)
            close(b->file[k].memory);
        SF_FREE(b->file[k].path, b->file[k].text);
    }
    SF_CLEAR(b, b->file);
}

/* Some systems insist on MFD_NOEXEC_SEAL, which older ones do not know. */
static int create_memory(void) {
    int file = -1;
#ifdef MFD_NOEXEC_SEAL
    file = memfd_create("softfall", MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_NOEXEC_SEAL);
#endif
    return file >= 0 ? file : memfd_create("softfall", MFD_CLOEXEC | MFD_ALLOW_SEALING);
}

int sf_broker_memory(const char *text, size_t size) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && size > limit.rlim_cur) { /* writing would send SIGXFSZ */
        errno = EFBIG;
        return -1;
    }
    int file = create_memory();
    size_t done = 0;
    while (file >= 0 && done < size) {
        ssize_t written = write(file, text + done, size - done);
        if (written < 0 && errno != EINTR)
            break;
        done += written > 0 ? (size_t)written : 0;
    }
    if (file >= 0 && done == size &&
        fcntl(file, F_ADD_SEALS, F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0 &&
        lseek(file, 0, SEEK_SET) == 0)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

/* gmsh drops all but the first statement of a last line without its end. */
static sf_status end_last_line(sf_broker_file *f, sf_error *err) {
    f->is_text = memchr(f->text, '\0', f->size) == NULL;
    if (!f->is_text || f->size == 0 || f->text[f->size - 1] == '\n')
        return SF_OK;
    char *longer = realloc(f->text, f->size + 2);
    if (!longer)
        return SF_NO_MEMORY(err, "a geometry");
    f->text = longer;
    memcpy(f->text + f->size++, "\n", 2);
    return SF_OK;
}

static void refuse(sf_broker *b, const char *path, const char *cause) {
    if (*b->refused == '\0')
        snprintf(b->refused, sizeof b->refused, "%.300s cannot be handed over: %.200s", path, cause);
}

/* One copy of each content, whatever its names. 0 or an errno value. */
static int copy(sf_broker *b, sf_broker_file *f) {
    for (size_t k = 0; k < b->count; k++) {
        const sf_broker_file *other = &b->file[k];
        if (other->text && other->size == f->size && memcmp(other->text, f->text, f->size) == 0) {
            sf_release(&f->text);
            f->is_text = false;
            f->memory = other->memory;
            return 0;
        }
    }
    f->memory = sf_broker_memory(f->text, f->size);
    if (f->memory < 0)
        return errno;
    b->bytes += 2 * (uint64_t)f->size;
    return 0;
}

/* Reads the file through the gate and keeps it. 0 or an errno value. */
static int read_file(sf_broker *b, const char *path, const sf_broker_file **out) {
    sf_error err = SF_ERROR_INIT;
    if (b->count == MOST_FILES || !sf_grow(&b->file, b->count, sizeof *b->file))
        return ENFILE;
    sf_broker_file *f = &b->file[b->count];
    *f = (sf_broker_file){0};
    if (access(path, F_OK) != 0)
        return errno;
    uint64_t room = b->bytes < b->most ? (b->most - b->bytes) / 2 : 0;
    if (sf_plain_read(path, NULL, room, &f->text, &f->size, &err) == SF_OK) {
        f->hash = sf_hash_bytes(SF_HASH_START, f->text, f->size);
        f->path = strdup(path);
        int error = !f->path || end_last_line(f, &err) != SF_OK ? ENOMEM : copy(b, f);
        if (error == 0) {
            b->count++;
            *out = f;
            return 0;
        }
        refuse(b, path, error == EFBIG ? "it is larger than files may be (ulimit -f)" : strerror(error));
    } else if (*b->refused == '\0') {
        snprintf(b->refused, sizeof b->refused, "%.590s", err.text);
    }
    SF_FREE(f->path, f->text);
    return EACCES;
}

static bool is_of_libraries(const char *path) {
    for (size_t k = 0; k < sizeof of_libraries / sizeof of_libraries[0]; k++)
        if (strncmp(path, of_libraries[k], strlen(of_libraries[k])) == 0)
            return true;
    return false;
}

/* A reader with its own place in the file. Without /proc it gets a copy of its own, which counts. */
static int reopen(sf_broker *b, const sf_broker_file *f) {
    SF_PRINTED(path, 40, "/proc/self/fd/%d", f->memory);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file >= 0 || !f->text || b->bytes + f->size > b->most)
        return file;
    b->bytes += f->size;
    return sf_broker_memory(f->text, f->size);
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
    *file = reopen(b, found);
    if (*file >= 0)
        return 0;
    error = errno;
    refuse(b, path, strerror(error));
    return error;
}
