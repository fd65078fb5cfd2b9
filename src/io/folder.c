/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/folder.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/hash.h"
#include "build_info.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "io/replace.h"

static const char MARK[] = ".softfall-own";
static const char TEXT[] =
    "softfall keeps this folder: it removes files of its own here when they are no longer needed\n";

int sf_folder_open(const char *path) {
    return open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

static DIR *list_folder(int handle) {
    int copy = openat(handle, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *list = copy >= 0 ? fdopendir(copy) : NULL;
    if (!list && copy >= 0)
        close(copy);
    return list;
}

/* Counts the names in the open folder that begin with `prefix`, and the bytes of the plain files among them;
 * returns -1 if the folder cannot be read. */
static int64_t count_names(int handle, const char *prefix, uint64_t *bytes) {
    DIR *list = handle >= 0 ? list_folder(handle) : NULL;
    struct dirent *entry;
    struct stat info;
    int64_t count = 0;
    *bytes = 0;
    if (!list)
        return -1;
    while ((entry = readdir(list)) != NULL) {
        if (strncmp(entry->d_name, prefix, strlen(prefix)) != 0 || strcmp(entry->d_name, ".") == 0 ||
            strcmp(entry->d_name, "..") == 0)
            continue;
        count++;
        if (fstatat(handle, entry->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode))
            *bytes += (uint64_t)info.st_size;
    }
    closedir(list);
    return count;
}

/* Number of entries but the mark; -1: unknown. */
static int64_t count_others(int handle) {
    uint64_t bytes;
    int64_t all = count_names(handle, "", &bytes);
    return all > 0 ? all - (faccessat(handle, MARK, F_OK, AT_SYMLINK_NOFOLLOW) == 0) : all;
}

static bool was_read(int handle, const char *name) {
    struct stat info;
    return fstatat(handle, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && sf_plain_name(info.st_dev, info.st_ino);
}

sf_status sf_folder_check(int handle, const char *path, bool (*known)(const char *name), sf_error *err) {
    DIR *list = list_folder(handle);
    struct dirent *entry;
    if (!list)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be read: %s", path, strerror(errno));
    while (err->status == SF_OK && (entry = readdir(list)) != NULL)
        if (known(entry->d_name) && was_read(handle, entry->d_name))
            SF_REFUSE(err, "the output %s/%s would replace an input: give another name", path, entry->d_name);
        else if (known(entry->d_name) && !sf_replace_is_ours(handle, entry->d_name))
            SF_REFUSE(err, "%s/%s is not a file of softfall: move it away", path, entry->d_name);
    closedir(list);
    return err->status;
}

void sf_folder_remove_known(int handle, bool (*known)(const char *name), const char *kept) {
    DIR *list = list_folder(handle);
    struct dirent *entry;
    while (list && (entry = readdir(list)) != NULL)
        if (known(entry->d_name) && !(kept && strcmp(entry->d_name, kept) == 0) &&
            sf_replace_is_ours(handle, entry->d_name))
            unlinkat(handle, entry->d_name, 0);
    if (list)
        closedir(list);
}

/* A process that was killed may have written the beginning of the text only. */
bool sf_folder_is_own(int handle) {
    char text[sizeof TEXT];
    int file = openat(handle, MARK, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    struct stat info;
    if (file < 0)
        return false;
    ssize_t length = fstat(file, &info) == 0 && S_ISREG(info.st_mode) ? read(file, text, sizeof text) : -1;
    close(file);
    return length >= 0 && length <= (ssize_t)strlen(TEXT) && memcmp(text, TEXT, (size_t)length) == 0;
}

/* Another process may make the mark at the same time: both have it then. */
static sf_status make_mark(int handle, const char *path, sf_error *err) {
    int file = openat(handle, MARK, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0 && errno == EEXIST && sf_folder_is_own(handle))
        return SF_OK;
    bool done = file >= 0 && write(file, TEXT, strlen(TEXT)) == (ssize_t)strlen(TEXT);
    int reason = errno;
    if (file >= 0 && close(file) != 0)
        done = false;
    return done ? SF_OK
                : SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be written in: %s", path, strerror(reason));
}

static sf_status take(int handle, const char *path, sf_error *err) {
    if (sf_folder_is_own(handle))
        return SF_OK;
    if (count_others(handle) != 0 && !sf_folder_is_own(handle)) /* nor by another process meanwhile */
        return SF_REFUSE(err,
                         "the folder %s holds files and was not made by softfall: move it away, or give "
                         "another output",
                         path);
    return make_mark(handle, path, err);
}

sf_status sf_folder_own(const char *path, sf_error *err) {
    bool made = mkdir(path, 0777) == 0;
    if (!made && errno != EEXIST)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
    int handle = sf_folder_open(path);
    if (handle < 0)
        return SF_FAIL(err, errno == ENOTDIR ? SF_ERR_INPUT : SF_ERR_IO, "the folder %s cannot be opened: %s",
                       path, strerror(errno));
    take(handle, path, err);
    close(handle);
    if (made && err->status != SF_OK)
        sf_folder_leave(path);
    else if (made)
        sf_replace_sync_name(path);
    return err->status;
}

/* The lock belongs to the open folder: a program that is started does not get it (but sf_process.held), and
 * it ends with the process and its copies. Asks `tries` times in vain, below 0 without end. */
static bool is_locked(int handle, int tries) {
    const struct timespec pause = {0, 20000000};
    while (flock(handle, LOCK_EX | LOCK_NB) != 0 &&
           errno == EWOULDBLOCK) { /* some file systems have no locks */
        if (tries == 0 || sf_process_stopped())
            return true;
        nanosleep(&pause, NULL);
        tries -= tries > 0;
    }
    return false;
}

sf_status sf_folder_lock(const char *path, int *handle, sf_error *err) {
    enum { TRIES = 50 }; /* the copies of a process that was killed end a moment after it */
    *handle = sf_folder_open(path);
    if (*handle < 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be opened: %s", path, strerror(errno));
    if (!is_locked(*handle, TRIES))
        return SF_OK;
    close(*handle);
    *handle = -1;
    return SF_REFUSE(err, "another campaign is at work in %s: wait for it, or give another directory", path);
}

void sf_folder_leave(const char *path) {
    int handle = sf_folder_open(path);
    if (handle < 0)
        return;
    if (sf_folder_is_own(handle) && count_others(handle) == 0)
        unlinkat(handle, MARK, 0);
    close(handle);
    rmdir(path);
}

int64_t sf_folder_count(const char *path, const char *prefix) {
    uint64_t bytes;
    int handle = sf_folder_open(path);
    int64_t count = count_names(handle, prefix, &bytes);
    if (handle >= 0)
        close(handle);
    return count;
}

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
    *out = (sf_stored){0};
    if (!name_file(folder, kind, key, path) || !sf_replace_exists(path) ||
        sf_plain_read(path, NULL, SF_STORE_MOST, &text, &size, SF_IGNORED) != SF_OK)
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

const char *sf_store_folder(const char *given) {
    const char *set = getenv("SOFTFALL_SHARE");
    return set && *set ? set : given;
}

bool sf_store_begin_key(uint64_t *key) {
    uint64_t code[2] = {0};
    Dl_info own = {0};
    if (sf_plain_hash_kept("/proc/self/exe", &code[0], SF_IGNORED) != SF_OK || dladdr(MAGIC, &own) == 0 ||
        (strstr(sf_path_name(own.dli_fname), ".so") &&
         sf_plain_hash_kept(own.dli_fname, &code[1], SF_IGNORED) != SF_OK))
        return false;
    *key = sf_hash_bytes(SF_HASH_START, code, sizeof code);
    *key = sf_hash_bytes(*key, SF_GIT_REVISION, sizeof SF_GIT_REVISION);
    return true;
}

static void empty_store(int handle) {
    DIR *list = list_folder(handle);
    struct dirent *entry;
    while (list && (entry = readdir(list)) != NULL)
        if (strcmp(entry->d_name + strcspn(entry->d_name, "."), ".bin") == 0)
            unlinkat(handle, entry->d_name, 0);
    if (list)
        closedir(list);
}

void sf_store_keep(const char *folder, const char *kind, uint64_t key, int count, const sf_store_part *part) {
    char path[SF_PATH_SIZE];
    sf_error none = SF_ERROR_INIT;
    sf_replacement file;
    size_t size;
    if (!name_file(folder, kind, key, path) || sf_folder_own(folder, &none) != SF_OK)
        return;
    uint64_t bytes;
    SF_OWNED char *all = join(count, part, &size);
    int handle = sf_folder_open(folder);
    if (handle >= 0 && count_names(handle, "", &bytes) > 0 && bytes + size > SF_STORE_MOST)
        empty_store(handle);
    close(handle);
    if (all && size <= SF_STORE_MOST && sf_replace_open(path, &file, &none)) {
        head h = {.key = key, .size = size, .hash = sf_hash(SF_HASH_START, all, size)};
        memcpy(h.magic, MAGIC, sizeof MAGIC);
        fwrite(&h, sizeof h, 1, file.file);
        fwrite(all, 1, size, file.file);
        sf_replace_close(&file, &none);
    }
}
