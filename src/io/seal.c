/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/seal.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct seal {
    char name[8];
    uint64_t length, hash;
} seal;

static const char NAME[8] = {'S', 'F', 'S', 'E', 'A', 'L', '0', '1'};

enum { BLOCK = 1 << 16 };

/* Length and hash of the first `length` bytes of an open file. */
static seal compute(FILE *file, uint64_t length) {
    static char block[BLOCK];
    seal s = {.length = 0, .hash = SF_HASH_START};
    memcpy(s.name, NAME, sizeof NAME);
    while (s.length < length) {
        uint64_t left = length - s.length;
        size_t read = fread(block, 1, left < BLOCK ? (size_t)left : BLOCK, file);
        if (read == 0)
            break;
        s.hash = sf_hash(s.hash, block, read);
        s.length += read;
    }
    return s;
}

sf_status sf_seal_add(const char *path, sf_error *err) {
    int handle = sf_replace_reopen(path);
    FILE *file = handle >= 0 ? fdopen(handle, "r+b") : NULL;
    if (!file) {
        SF_FAIL(err, SF_ERR_IO, "cannot open %s: %s", path, strerror(errno));
        if (handle >= 0)
            close(handle);
        return err->status;
    }
    seal s = compute(file, UINT64_MAX);
    bool done = !ferror(file) && fseeko(file, 0, SEEK_END) == 0 && fwrite(&s, sizeof s, 1, file) == 1;
    if (fclose(file) != 0 || !done)
        return SF_FAIL(err, SF_ERR_IO, "writing %s failed: %s", path, strerror(errno));
    return SF_OK;
}

/* Examines the end of the open file. */
static sf_seal_state examine(FILE *file) {
    seal stored, found;
    if (fseeko(file, -(off_t)sizeof stored, SEEK_END) != 0 || fread(&stored, sizeof stored, 1, file) != 1 ||
        memcmp(stored.name, NAME, sizeof NAME) != 0)
        return SF_SEAL_NONE;
    off_t length = ftello(file) - (off_t)sizeof stored;
    rewind(file);
    found = compute(file, (uint64_t)length);
    return found.length == stored.length && found.hash == stored.hash ? SF_SEAL_SOUND : SF_SEAL_BROKEN;
}

sf_status sf_seal_examine(const char *path, sf_seal_state *state, sf_error *err) {
    int handle;
    *state = SF_SEAL_NO_FILE;
    if (access(path, F_OK) != 0 && errno == ENOENT)
        return SF_OK;
    SF_TRY(sf_plain_open(path, NULL, &handle, NULL, err));
    FILE *file = fdopen(handle, "rb");
    if (!file) {
        close(handle);
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory to read %s", path);
    }
    errno = 0;
    *state = examine(file);
    if (ferror(file))
        SF_FAIL(err, SF_ERR_IO, "reading %s failed: %s", path, strerror(errno));
    fclose(file);
    return err->status;
}

static sf_status check(const char *path, bool required, sf_error *err) {
    sf_seal_state state;
    SF_TRY(sf_seal_examine(path, &state, err));
    if (state == SF_SEAL_NO_FILE)
        return SF_FAIL(err, SF_ERR_IO, "%s does not exist", path);
    if (state == SF_SEAL_NONE && required)
        return SF_FAIL(err, SF_ERR_IO, "%s is incomplete: it does not end with its checksum", path);
    if (state == SF_SEAL_BROKEN)
        return SF_FAIL(err, SF_ERR_IO, "%s is damaged: it does not have the checksum that it ends with",
                       path);
    return SF_OK;
}

sf_status sf_seal_check(const char *path, sf_error *err) {
    return check(path, true, err);
}

sf_status sf_seal_check_any(const char *path, sf_error *err) {
    return check(path, false, err);
}
