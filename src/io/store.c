/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/store.h"

#include "base/hash.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include <stdlib.h>
#include <string.h>

/* In the machine's byte order. */
typedef struct head {
    char magic[8];
    uint64_t key, size, hash;
} head;

static const char MAGIC[8] = {'S', 'F', 'S', 'T', 'O', 'R', 'E', '1'};

static bool name_file(const char *folder, const char *kind, uint64_t key, char path[SF_PATH_SIZE]) {
    return folder && snprintf(path, SF_PATH_SIZE, "%s/%s-%016llx.bin", folder, kind,
                              (unsigned long long)key) < SF_PATH_SIZE - 64;
}

bool sf_store_find(const char *folder, const char *kind, uint64_t key, sf_stored *out) {
    char path[SF_PATH_SIZE], *text = NULL;
    size_t size = 0;
    head h;
    sf_error none = SF_ERROR_INIT;
    *out = (sf_stored){0};
    if (!name_file(folder, kind, key, path) || !sf_replace_exists(path) ||
        sf_plain_read(path, NULL, SF_STORE_MOST, &text, &size, &none) != SF_OK)
        return false;
    if (size >= sizeof h) {
        memcpy(&h, text, sizeof h);
        if (memcmp(h.magic, MAGIC, sizeof MAGIC) == 0 && h.key == key && h.size == size - sizeof h &&
            h.hash == sf_hash(SF_HASH_START, text + sizeof h, size - sizeof h))
            *out = (sf_stored){text, text + sizeof h, size - sizeof h};
    }
    if (!out->block)
        free(text);
    return out->block != NULL;
}

/* In one piece, as its hash is. */
static char *join(int count, const sf_store_part *part, size_t *size) {
    *size = 0;
    for (int k = 0; k < count; k++)
        *size += part[k].size;
    char *all = malloc(*size ? *size : 1), *at = all;
    for (int k = 0; all && k < count; at += part[k].size, k++)
        if (part[k].size > 0)
            memcpy(at, part[k].data, part[k].size);
    return all;
}

void sf_store_keep(const char *folder, const char *kind, uint64_t key, int count, const sf_store_part *part) {
    char path[SF_PATH_SIZE];
    sf_error none = SF_ERROR_INIT;
    sf_replacement file;
    size_t size;
    if (!name_file(folder, kind, key, path) || sf_folder_own(folder, &none) != SF_OK)
        return;
    char *all = join(count, part, &size);
    if (all && sf_folder_bytes(folder) + size <= SF_STORE_MOST && sf_replace_open(path, &file, &none)) {
        head h = {.key = key, .size = size, .hash = sf_hash(SF_HASH_START, all, size)};
        memcpy(h.magic, MAGIC, sizeof MAGIC);
        fwrite(&h, sizeof h, 1, file.file);
        fwrite(all, 1, size, file.file);
        sf_replace_close(&file, &none);
    }
    free(all);
}
