/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/plain_file.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/magic.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <time.h>
#include <unistd.h>

#include "base/hash.h"

enum { BLOCK = 1 << 16 };

/* "the curve path" */
#define NAMED "%s%s%s%s"
#define NAME(what, path) (what) ? "the " : "", (what) ? (what) : "", (what) ? " " : "", path

/* ---- the register ---- */

static struct {
    pthread_mutex_t lock;
    size_t count;
    sf_plain_record *entry;
} list = {.lock = PTHREAD_MUTEX_INITIALIZER};

static bool append(sf_plain_record record) {
    if (!sf_grow(&list.entry, list.count, sizeof record) || !(record.path = strdup(record.path)))
        return false;
    list.entry[list.count++] = record;
    return true;
}

static sf_status enter(const char *path, const struct stat *info, sf_error *err) {
    pthread_mutex_lock(&list.lock);
    bool done = append((sf_plain_record){path, info->st_dev, info->st_ino});
    pthread_mutex_unlock(&list.lock);
    return done ? SF_OK : SF_NO_MEMORY(err, "the path %s", path);
}

size_t sf_plain_count(void) {
    pthread_mutex_lock(&list.lock);
    size_t count = list.count;
    pthread_mutex_unlock(&list.lock);
    return count;
}

sf_plain_record sf_plain_get(size_t index) {
    pthread_mutex_lock(&list.lock);
    sf_plain_record record = list.entry[index];
    pthread_mutex_unlock(&list.lock);
    return record;
}

/* The number of an inode is given again once its file is gone. */
static bool is_still_there(const sf_plain_record *record) {
    struct stat info;
    return stat(record->path, &info) == 0 && info.st_dev == record->device && info.st_ino == record->inode;
}

const char *sf_plain_name(uint64_t device, uint64_t inode) {
    const char *name = NULL;
    pthread_mutex_lock(&list.lock);
    for (size_t k = 0; k < list.count && !name; k++)
        if (list.entry[k].device == device && list.entry[k].inode == inode && is_still_there(&list.entry[k]))
            name = list.entry[k].path;
    pthread_mutex_unlock(&list.lock);
    return name;
}

/* Hashes that are kept, each at or after the place that its path gives; behind the lock of the list. */
typedef struct kept_hash {
    char *path; /* NULL: none */
    struct stat info;
    uint64_t hash;
} kept_hash;
enum { KEPT = 256 };
static kept_hash kept[KEPT];

void sf_plain_clear(void) {
    pthread_mutex_lock(&list.lock);
    for (int k = 0; k < KEPT; k++) {
        free(kept[k].path);
        kept[k] = (kept_hash){0};
    }
    for (size_t k = 0; k < list.count; k++)
        free((char *)list.entry[k].path);
    sf_release(&list.entry);
    list.count = 0;
    pthread_mutex_unlock(&list.lock);
}

/* ---- opening ---- */

const char *sf_plain_kind(mode_t mode) {
    switch (mode & S_IFMT) {
    case S_IFREG:
        return NULL;
    case S_IFDIR:
        return "a folder";
    case S_IFIFO:
        return "a pipe";
    case S_IFSOCK:
        return "a socket";
    default:
        return "a device";
    }
}

/* The file system makes the contents up while they are read. */
static bool is_made_up(long type) {
    /* clang-format off */
    static const unsigned long known[] = {
        PROC_SUPER_MAGIC, SYSFS_MAGIC, DEBUGFS_MAGIC, TRACEFS_MAGIC, SECURITYFS_MAGIC, CGROUP_SUPER_MAGIC,
        CGROUP2_SUPER_MAGIC, BPF_FS_MAGIC, PSTOREFS_MAGIC, EFIVARFS_MAGIC, SELINUX_MAGIC, SMACK_MAGIC,
        DEVPTS_SUPER_MAGIC, BINFMTFS_MAGIC, NSFS_MAGIC, PIPEFS_MAGIC, SOCKFS_MAGIC, ANON_INODE_FS_MAGIC,
        0x07655821 /* resctrl */, 0x62656570 /* configfs */, 0x65735543 /* fusectl */,
        0x19800202 /* mqueue */, 0x67596969 /* rpc_pipefs */};
    /* clang-format on */
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if ((unsigned long)type == known[k])
            return true;
    return false;
}

static sf_status refuse_kind(const char *path, const char *what, const struct stat *info, sf_error *err) {
    const char *kind = sf_plain_kind(info->st_mode);
    return kind ? SF_REFUSE(err, NAMED " is not a plain file: it is %s", NAME(what, path), kind) : SF_OK;
}

static sf_status fail_reading(const char *path, const char *what, sf_status status, sf_error *err) {
    return SF_FAIL(err, status, NAMED " cannot be read: %s", NAME(what, path), strerror(errno));
}

/* Opens what is plain. A device is not even opened: with some that sets something going. */
static sf_status pass(const char *path, const char *what, int *handle, struct stat *info, sf_error *err) {
    struct statfs system;
    *handle = -1;
    if (stat(path, info) != 0)
        return fail_reading(path, what, SF_ERR_INPUT, err);
    SF_TRY(refuse_kind(path, what, info, err));
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file < 0)
        return fail_reading(path, what, SF_ERR_INPUT, err);
    if (fstat(file, info) != 0 || fstatfs(file, &system) != 0)
        fail_reading(path, what, SF_ERR_IO, err);
    else if (refuse_kind(path, what, info, err) == SF_OK && is_made_up(system.f_type))
        SF_REFUSE(err, NAMED " is not a plain file: the system makes it up", NAME(what, path));
    if (err->status != SF_OK)
        close(file);
    else
        *handle = file;
    return err->status;
}

sf_status sf_plain_open(const char *path, const char *what, int *handle, uint64_t *size, sf_error *err) {
    struct stat info;
    SF_TRY(pass(path, what, handle, &info, err));
    if (enter(path, &info, err) != SF_OK) {
        close(*handle);
        *handle = -1;
        return err->status;
    }
    if (size)
        *size = (uint64_t)info.st_size;
    return SF_OK;
}

sf_status sf_plain_check(const char *path, const char *what, sf_error *err) {
    int handle;
    if (sf_plain_open(path, what, &handle, NULL, err) == SF_OK)
        close(handle);
    return err->status;
}

/* ---- reading ---- */

/* A file on its way. With `keep` the content grows in `text`, else a block at a time stands there. */
typedef struct reading {
    const char *path, *what;
    int file;
    uint64_t largest, length, hash;
    bool keep;
    char *text;
    size_t room; /* of `text`, without the zero at its end */
} reading;

static sf_status refuse_size(const reading *r, sf_error *err) {
    return SF_REFUSE(err, NAMED " is larger than %.4g MB", NAME(r->what, r->path), 1e-6 * (double)r->largest);
}

static sf_status make_room(reading *r, size_t room, sf_error *err) {
    char *grown = realloc(r->text, room + 1);
    if (!grown)
        return SF_NO_MEMORY(err, "" NAMED, NAME(r->what, r->path));
    r->text = grown;
    r->room = room;
    return SF_OK;
}

/* The next piece; `*got` 0: the end. */
static sf_status read_piece(reading *r, size_t *got, sf_error *err) {
    size_t at = r->keep ? (size_t)r->length : 0;
    *got = 0;
    if (at == r->room && make_room(r, r->room < BLOCK ? BLOCK : 2 * r->room, err) != SF_OK)
        return err->status;
    ssize_t count;
    do {
        count = read(r->file, r->text + at, r->room - at);
    } while (count < 0 && errno == EINTR);
    if (count < 0)
        return fail_reading(r->path, r->what, SF_ERR_IO, err);
    *got = (size_t)count;
    r->hash = sf_hash_bytes(r->hash, r->text + at, *got);
    r->length += *got;
    return r->length > r->largest ? refuse_size(r, err) : SF_OK;
}

static bool is_same(const struct stat *a, const struct stat *b) {
    return a->st_size == b->st_size && a->st_mtim.tv_sec == b->st_mtim.tv_sec &&
           a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

/* To the end of the file, which must not have changed meanwhile. */
static sf_status read_all(reading *r, const struct stat *before, sf_error *err) {
    struct stat after;
    size_t got;
    if ((uint64_t)before->st_size > r->largest)
        return refuse_size(r, err);
    SF_TRY(make_room(r, r->keep ? (size_t)before->st_size + 1 : BLOCK, err));
    do
        SF_TRY(read_piece(r, &got, err));
    while (got > 0);
    if (fstat(r->file, &after) != 0)
        return fail_reading(r->path, r->what, SF_ERR_IO, err);
    if (!is_same(before, &after) || r->length != (uint64_t)after.st_size)
        return SF_FAIL(err, SF_ERR_IO, NAMED " changed while it was read", NAME(r->what, r->path));
    return enter(r->path, before, err);
}

static sf_status take(reading *r, sf_error *err) {
    struct stat info;
    r->hash = SF_HASH_START;
    SF_TRY(pass(r->path, r->what, &r->file, &info, err));
    read_all(r, &info, err);
    close(r->file);
    if (err->status != SF_OK || !r->keep)
        sf_release(&r->text);
    return err->status;
}

sf_status sf_plain_read(const char *path, const char *what, uint64_t largest, char **text, size_t *size,
                        sf_error *err) {
    reading r = {.path = path, .what = what, .largest = largest, .keep = true};
    *text = NULL;
    SF_TRY(take(&r, err));
    r.text[r.length] = '\0';
    *text = r.text;
    if (size)
        *size = (size_t)r.length;
    return SF_OK;
}

sf_status sf_plain_hash(const char *path, const char *what, uint64_t largest, uint64_t *hash, sf_error *err) {
    reading r = {.path = path, .what = what, .largest = largest};
    if (take(&r, err) == SF_OK)
        *hash = r.hash;
    return err->status;
}

/* ---- hashes that are kept ---- */

static bool is_unchanged(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && is_same(a, b) &&
           a->st_ctim.tv_sec == b->st_ctim.tv_sec && a->st_ctim.tv_nsec == b->st_ctim.tv_nsec;
}

/* Was it changed long enough ago for a later change to show in its times? */
static bool is_settled(const struct stat *info) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return info->st_mtim.tv_sec + 1 < now.tv_sec && info->st_ctim.tv_sec + 1 < now.tv_sec;
}

/* Returns the place of the path, or a free one: one of the PROBES places from that of its hash on, an
 * empty one first. */
static kept_hash *place_of(const char *path) {
    enum { PROBES = 16 };
    uint64_t home = sf_hash_bytes(SF_HASH_START, path, strlen(path));
    kept_hash *empty = NULL;
    for (int k = 0; k < PROBES; k++) {
        kept_hash *place = &kept[(home + (uint64_t)k) % KEPT];
        if (place->path && strcmp(place->path, path) == 0)
            return place;
        if (!empty && !place->path)
            empty = place;
    }
    return empty ? empty : &kept[home % KEPT];
}

static bool find_kept(const char *path, const struct stat *info, uint64_t *hash) {
    pthread_mutex_lock(&list.lock);
    const kept_hash *k = place_of(path);
    bool found = k->path && strcmp(k->path, path) == 0 && is_unchanged(&k->info, info);
    if (found)
        *hash = k->hash;
    pthread_mutex_unlock(&list.lock);
    return found;
}

static void keep(const char *path, const struct stat *info, uint64_t hash) {
    pthread_mutex_lock(&list.lock);
    kept_hash *k = place_of(path);
    free(k->path);
    *k = (kept_hash){.path = strdup(path), .info = *info, .hash = hash};
    pthread_mutex_unlock(&list.lock);
}

sf_status sf_plain_hash_kept(const char *path, uint64_t *hash, sf_error *err) {
    struct stat before, after;
    bool there = stat(path, &before) == 0;
    if (there && find_kept(path, &before, hash))
        return SF_OK;
    bool settled = there && is_settled(&before);
    if (sf_plain_hash(path, NULL, SF_PLAIN_GEOMETRY, hash, err) == SF_OK && settled &&
        stat(path, &after) == 0 && is_unchanged(&before, &after))
        keep(path, &before, *hash);
    return err->status;
}

static char *no_memory(const char *path, sf_error *err) {
    SF_NO_MEMORY(err, "the path %.200s", path);
    return NULL;
}

size_t sf_path_folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    if (!slash)
        return 0;
    return slash == path ? 1 : (size_t)(slash - path);
}

const char *sf_path_split(const char *path, char folder[PATH_MAX]) {
    const char *slash = strrchr(path, '/');
    snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
    return slash ? slash + 1 : path;
}

sf_status sf_path_print(char *path, size_t size, sf_error *err, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    bool fits = (size_t)vsnprintf(path, size, format, arguments) < size;
    va_end(arguments);
    return fits ? SF_OK : SF_REFUSE(err, "the path %.200s... is longer than %zu bytes", path, size - 1);
}

const char *sf_path_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Takes the parts of `path` one after another onto `whole`, which has room. */
static void append_path(char *whole, const char *path) {
    while (*path) {
        size_t length = strcspn(path, "/"), used = strlen(whole);
        if (length == 2 && strncmp(path, "..", 2) == 0)
            whole[used ? sf_path_folder_length(whole) : 0] = '\0';
        else if (length > 0 && !(length == 1 && *path == '.'))
            sprintf(whole + used, "/%.*s", (int)length, path);
        if (strcmp(whole, "/") == 0)
            *whole = '\0';
        path += length + (path[length] == '/');
    }
}

char *sf_path_whole(const char *folder, const char *path, sf_error *err) {
    char here[PATH_MAX] = "";
    bool relative = *path != '/', below_here = relative && (!folder || *folder != '/');
    if (below_here && !getcwd(here, sizeof here)) {
        SF_FAIL(err, SF_ERR_IO, "the present folder is unknown: %s", strerror(errno));
        return NULL;
    }
    char *whole = calloc(strlen(here) + (folder ? strlen(folder) : 0) + strlen(path) + 5, 1);
    if (!whole)
        return no_memory(path, err);
    append_path(whole, here);
    if (relative && folder)
        append_path(whole, folder);
    append_path(whole, path);
    if (!*whole)
        strcpy(whole, "/");
    return whole;
}

const char *sf_path_below(const char *folder, const char *path) {
    size_t length = strcmp(folder, "/") == 0 ? 0 : strlen(folder);
    return strncmp(folder, path, length) == 0 && path[length] == '/' && path[length + 1] ? path + length + 1
                                                                                         : NULL;
}

char *sf_path_between(const char *from, const char *to, sf_error *err) {
    size_t same = 0;
    char *text = NULL;
    for (size_t k = 0; from[k] && from[k] == to[k]; k++)
        if (from[k] == '/')
            same = k + 1;
    int up = 0;
    for (const char *at = from + same; (at = strchr(at, '/')); at++)
        up++;
    size_t length = 3 * (size_t)up;
    text = malloc(length + strlen(to + same) + 1);
    if (!text)
        return no_memory(to, err);
    for (int k = 0; k < up; k++)
        memcpy(text + 3 * k, "../", 3);
    strcpy(text + length, to + same);
    return text;
}
