/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/replace.h"

#include "base/hash.h"
#include "io/plain_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define PARTIAL ".partial-"
enum { TOKEN_DIGITS = 8, SEAL_SIZE = 24 /* io/replace.h */ };

/* ---- names ---- */

/* The same for all files of this process. */
static unsigned token(void) {
    static unsigned value;
    if (value == 0 && getrandom(&value, sizeof value, GRND_NONBLOCK) != (ssize_t)sizeof value)
        value = (unsigned)time(NULL);
    value += value == 0;
    return value;
}

sf_status sf_replace_begin(const char *path, char partial[SF_PATH_SIZE], sf_error *err) {
    if ((size_t)snprintf(partial, SF_PATH_SIZE, "%s" PARTIAL "%d-%0*x", path, (int)getpid(), TOKEN_DIGITS,
                         token()) >= SF_PATH_SIZE)
        return SF_REFUSE(err, "the path of an output file is longer than %d bytes", SF_PATH_SIZE);
    return SF_OK;
}

bool sf_replace_is_partial(const char *name, const char *of, int *process) {
    size_t length = strlen(of);
    int owner = 0, end = 0;
    if (strncmp(name, of, length) != 0 || sscanf(name + length, PARTIAL "%d-%n", &owner, &end) != 1)
        return false;
    const char *digits = name + length + end;
    if (end == 0 || owner <= 0 || strlen(digits) != TOKEN_DIGITS ||
        strspn(digits, "0123456789abcdef") != TOKEN_DIGITS)
        return false;
    if (process)
        *process = owner;
    return true;
}

/* ---- what may be replaced ---- */

bool sf_replace_exists(const char *path) {
    struct stat info;
    return lstat(path, &info) == 0 || errno != ENOENT;
}

/* `info`: of what has the name already. */
static sf_status check_present(const char *path, const struct stat *info, sf_error *err) {
    const char *input = sf_plain_name(info->st_dev, info->st_ino);
    if (!S_ISREG(info->st_mode))
        return SF_REFUSE(err, "the output %s cannot be written: it is %s", path,
                         sf_plain_kind(info->st_mode));
    if (input)
        return SF_REFUSE(err, "the output %s would replace an input, %s: give another name", path, input);
    return SF_OK;
}

/* Without slashes at its end the path names what is in the folder. */
sf_status sf_replace_check_folder(const char *path, sf_error *err) {
    char name[SF_PATH_SIZE], folder[SF_PATH_SIZE];
    size_t length = (size_t)snprintf(name, sizeof name, "%s", path);
    while (length > 1 && length < sizeof name && name[length - 1] == '/')
        name[--length] = '\0';
    sf_path_split(name, folder);
    if (access(folder, W_OK | X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the output %s cannot be written: %s", path, strerror(errno));
    return SF_OK;
}

sf_status sf_replace_check(const char *path, sf_error *err) {
    char partial[SF_PATH_SIZE], folder[SF_PATH_SIZE];
    struct stat info;
    if (!*path)
        return SF_REFUSE(err, "the name of the output is empty");
    SF_TRY(sf_replace_begin(path, partial, err));
    if (!*sf_path_split(path, folder))
        return SF_REFUSE(err, "the output %s cannot be written: it is a folder", path);
    if (stat(path, &info) == 0)
        SF_TRY(check_present(path, &info, err));
    else if (lstat(path, &info) == 0)
        return SF_REFUSE(err, "the output %s cannot be written: it is a link to nothing", path);
    if (lstat(partial, &info) != 0 && errno == ENAMETOOLONG)
        return SF_REFUSE(err,
                         "the output %s cannot be written: its name is too long, as it is written under a "
                         "longer name first",
                         path);
    return sf_replace_check_folder(path, err);
}

/* ---- writing ---- */

FILE *sf_replace_create(const char *path, sf_error *err) {
    int handle = open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    FILE *file = handle >= 0 ? fdopen(handle, "w") : NULL;
    if (file)
        return file;
    SF_FAIL(err, SF_ERR_IO, "%s cannot be written: %s", path, strerror(errno));
    if (handle >= 0)
        close(handle);
    return NULL;
}

int sf_replace_reopen(const char *path) {
    struct stat info;
    int file = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file < 0 || (fstat(file, &info) == 0 && S_ISREG(info.st_mode)))
        return file;
    close(file);
    errno = EINVAL;
    return -1;
}

static int sync_handle(int file) {
    if (file < 0)
        return -1;
    int result = fsync(file), reason = errno;
    close(file);
    errno = reason;
    return result;
}

/* The new name survives a power cut when the folder has been written. Some file systems cannot do that for
 * folders; the name is then as safe as they make it. */
void sf_replace_sync_name(const char *path) {
    char folder[SF_PATH_SIZE];
    sf_path_split(path, folder);
    sync_handle(open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

sf_status sf_replace_commit(const char *partial, const char *path, sf_error *err) {
    struct stat info;
    if (err->status == SF_OK && sync_handle(sf_replace_reopen(partial)) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be brought to the disk: %s", partial, strerror(errno));
    else if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        SF_FAIL(err, SF_ERR_IO, "%s cannot be written: it is %s", path, sf_plain_kind(info.st_mode));
    else if (err->status == SF_OK && rename(partial, path) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be renamed to %s: %s", partial, path, strerror(errno));
    if (err->status != SF_OK)
        unlink(partial);
    else
        sf_replace_sync_name(path);
    return err->status;
}

FILE *sf_replace_open(const char *path, sf_replacement *out, sf_error *err) {
    out->file = NULL;
    if (sf_replace_begin(path, out->partial, err) == SF_OK) {
        snprintf(out->path, sizeof out->path, "%s", path);
        out->file = sf_replace_create(out->partial, err);
    }
    return out->file;
}

sf_status sf_replace_close(sf_replacement *out, sf_error *err) {
    bool failed = ferror(out->file) != 0;
    if (fclose(out->file) != 0 || failed)
        SF_FAIL(err, SF_ERR_IO, SF_NOT_WRITTEN, out->path);
    return sf_replace_commit(out->partial, out->path, err);
}

/* ---- what killed processes left ---- */

/* Begins as HDF5 files do or ends with a seal (io/replace.h): a damaged file is ours too. */
static bool is_ours_open(int file, const struct stat *info) {
    static const char signature[8] = "\211HDF\r\n\032\n", seal[8] = {'S', 'F', 'S', 'E', 'A', 'L', '0', '1'};
    char part[8];
    return S_ISREG(info->st_mode) &&
           (info->st_size == 0 ||
            (pread(file, part, sizeof part, 0) == (ssize_t)sizeof part &&
             memcmp(part, signature, sizeof part) == 0) ||
            (info->st_size >= SEAL_SIZE &&
             pread(file, part, sizeof part, info->st_size - SEAL_SIZE) == (ssize_t)sizeof part &&
             memcmp(part, seal, sizeof part) == 0));
}

/* `idle`: and no program has it open; HDF5 locks the files that it has. */
static bool is_ours(int folder, const char *name, bool idle) {
    struct stat info;
    if (fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(info.st_mode))
        return false;
    int file = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file < 0)
        return false;
    bool ours = fstat(file, &info) == 0 && is_ours_open(file, &info) &&
                !(idle && flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK);
    close(file);
    return ours;
}

bool sf_replace_is_ours(int folder, const char *name) {
    return is_ours(folder, name, false);
}

/* -1: there is no plain file of that name that can be read. */
static int open_present(const char *path, struct stat *info) {
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file >= 0 && (fstat(file, info) != 0 || !S_ISREG(info->st_mode))) {
        close(file);
        return -1;
    }
    return file;
}

bool sf_replace_is_hdf5(const char *path) {
    struct stat info;
    int file = open_present(path, &info);
    bool ours = file >= 0 ? is_ours_open(file, &info) : !sf_replace_exists(path);
    if (file >= 0)
        close(file);
    return ours;
}

bool sf_replace_is_page(const char *path) {
    static const char name[] = "softfall";
    enum { KEPT = sizeof name - 2, PART = 1 << 14 }; /* the name may lie across two parts */
    char part[KEPT + PART];
    struct stat info;
    size_t kept = 0;
    ssize_t read_now;
    int file = open_present(path, &info);
    if (file < 0)
        return !sf_replace_exists(path);
    bool ours = info.st_size == 0;
    while (!ours && (read_now = read(file, part + kept, PART)) > 0) {
        size_t size = kept + (size_t)read_now;
        ours = memmem(part, size, name, sizeof name - 1) != NULL;
        kept = size < KEPT ? size : KEPT;
        memmove(part, part + size - kept, kept);
    }
    close(file);
    return ours;
}

void sf_replace_clean(const char *path) {
    char folder[SF_PATH_SIZE];
    const char *name = sf_path_split(path, folder);
    DIR *list = opendir(folder);
    struct dirent *entry;
    while (list && (entry = readdir(list)) != NULL) {
        int process;
        if (sf_replace_is_partial(entry->d_name, name, &process) && kill(process, 0) != 0 && errno == ESRCH &&
            is_ours(dirfd(list), entry->d_name, true))
            unlinkat(dirfd(list), entry->d_name, 0);
    }
    if (list)
        closedir(list);
}

/* ---- seals ---- */

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
        SF_FAIL(err, SF_ERR_IO, "%s cannot be opened: %s", path, strerror(errno));
        if (handle >= 0)
            close(handle);
        return err->status;
    }
    seal s = compute(file, UINT64_MAX);
    bool done = !ferror(file) && fseeko(file, 0, SEEK_END) == 0 && fwrite(&s, sizeof s, 1, file) == 1;
    if (fclose(file) != 0 || !done)
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be written: %s", path, strerror(errno));
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
        return SF_NO_MEMORY(err, "%s", path);
    }
    errno = 0;
    *state = examine(file);
    if (ferror(file))
        SF_FAIL(err, SF_ERR_IO, "%s cannot be read: %s", path, strerror(errno));
    fclose(file);
    return err->status;
}

sf_status sf_seal_check(const char *path, sf_error *err) {
    sf_seal_state state;
    SF_TRY(sf_seal_examine(path, &state, err));
    if (state == SF_SEAL_NO_FILE)
        return SF_FAIL(err, SF_ERR_IO, "%s does not exist", path);
    if (state == SF_SEAL_NONE)
        return SF_FAIL(
            err, SF_ERR_IO,
            "%s does not end with its checksum: it was cut, or another program has changed it; make "
            "it anew with softfall-solve",
            path);
    if (state == SF_SEAL_BROKEN)
        return SF_FAIL(err, SF_ERR_IO,
                       "%s is damaged: it does not have the checksum that it ends with; make it anew with "
                       "softfall-solve",
                       path);
    return SF_OK;
}
