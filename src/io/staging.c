/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/staging.h"

#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the output directory ---- */

/* The staging directory's name begins so, then follow the process and six letters. */
#define STAGING ".softfall-"

static char *join(const char *directory, const char *name, sf_error *err) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s", directory, name) < 0) {
        SF_NO_MEMORY(err, "the path of %s", name);
        return NULL;
    }
    return path;
}

/* True of the names by which a folder is known to hold what softfall wrote, or to be somebody else's. */
static bool is_page(const char *name) {
    return strcmp(name, "report.html") == 0 || strcmp(name, "summary.json") == 0;
}

/* Each file that is there may be replaced: it is plain and not an input, and a page is one of softfall. */
static sf_status check_files(const char *directory, const char *const *names, bool force, sf_error *err) {
    for (; *names && err->status == SF_OK; names++) {
        SF_OWNED char *path = join(directory, *names, err);
        if (!path || sf_replace_check(path, err) != SF_OK)
            return err->status;
        if (!force && sf_replace_exists(path))
            SF_REFUSE(err, "%s already holds %s: give another folder, or --force to replace it", directory,
                      *names);
        else if (is_page(*names) && !sf_replace_is_page(path))
            SF_REFUSE(err, "%s is not of softfall, and is not replaced: give another folder", path);
    }
    return err->status;
}

sf_status sf_staging_check(const char *directory, const char *const *names, bool force, sf_error *err) {
    struct stat info;
    if (!*directory)
        return SF_REFUSE(err, "the name of the output directory is empty");
    if (stat(directory, &info) == 0)
        return S_ISDIR(info.st_mode) ? check_files(directory, names, force, err)
                                     : SF_REFUSE(err, "%s exists and is not a folder", directory);
    if (errno != ENOENT || lstat(directory, &info) == 0)
        return SF_REFUSE(err, "the folder %s cannot be made: %s", directory, strerror(errno));
    return sf_replace_check_folder(directory, err);
}

static sf_status make_directory(sf_staging *output, bool force, sf_error *err) {
    SF_TRY(sf_staging_check(output->directory, output->names, force, err));
    if (mkdir(output->directory, 0777) == 0)
        output->created = true;
    else if (errno != EEXIST)
        SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", output->directory, strerror(errno));
    return err->status;
}

/* Removes the plain files of a directory with softfall's mark, and itself; a link instead of a directory is
 * not followed. */
static void remove_flat(int parent, const char *name) {
    int handle = openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    bool own = handle >= 0 && sf_folder_is_own(handle);
    DIR *listing = handle >= 0 ? fdopendir(handle) : NULL;
    struct dirent *entry;
    while (own && listing && (entry = readdir(listing)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(handle, entry->d_name, 0);
    if (listing)
        closedir(listing);
    else if (handle >= 0)
        close(handle);
    unlinkat(parent, name, AT_REMOVEDIR);
}

/* Removes the staging directories of processes that no longer exist (killed runs). */
static void remove_stale(const char *directory) {
    DIR *listing = opendir(directory);
    struct dirent *entry;
    while (listing && (entry = readdir(listing)) != NULL) {
        int owner = 0, end = 0;
        if (sscanf(entry->d_name, STAGING "%d-%n", &owner, &end) == 1 && end > 0 && owner > 0 &&
            strlen(entry->d_name + end) == 6 && kill(owner, 0) != 0 && errno == ESRCH)
            remove_flat(dirfd(listing), entry->d_name);
    }
    if (listing)
        closedir(listing);
}

sf_status sf_staging_begin(const char *directory, const char *const *names, bool force, sf_staging *output,
                           sf_error *err) {
    char name[64];
    *output = (sf_staging){.names = names};
    output->directory = strdup(directory);
    if (!output->directory)
        return SF_NO_MEMORY(err, "the path %s", directory);
    if (make_directory(output, force, err) == SF_OK) {
        remove_stale(directory);
        snprintf(name, sizeof name, STAGING "%d-XXXXXX", (int)getpid());
        output->aside = join(directory, name, err);
    }
    if (output->aside && !mkdtemp(output->aside)) {
        SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be written in: %s", directory, strerror(errno));
        sf_release(&output->aside);
    }
    if (output->aside && sf_folder_own(output->aside, err) == SF_OK)
        return SF_OK;
    sf_staging_end(output);
    return err->status;
}

char *sf_staging_path(const sf_staging *output, const char *name, sf_error *err) {
    return join(output->aside, name, err);
}

FILE *sf_staging_open(const sf_staging *output, const char *name, sf_error *err) {
    SF_OWNED char *path = sf_staging_path(output, name, err);
    return path ? sf_replace_create(path, err) : NULL;
}

sf_status sf_staging_close(FILE *file, const char *name, sf_error *err) {
    bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed)
        return SF_FAIL(err, SF_ERR_IO, SF_NOT_WRITTEN, name);
    return SF_OK;
}

bool sf_staging_has(const sf_staging *output, const char *name) {
    SF_OWNED char *path = join(output->aside ? output->aside : output->directory, name, SF_IGNORED);
    return path && sf_replace_exists(path);
}

void sf_staging_remove(const sf_staging *output, const char *name) {
    SF_OWNED char *path = sf_staging_path(output, name, SF_IGNORED);
    if (path)
        unlink(path);
}

sf_status sf_staging_commit(sf_staging *output, sf_error *err) {
    SF_TRY(check_files(output->directory, output->names, true, err));
    for (const char *const *name = output->names; *name && err->status == SF_OK; name++) {
        SF_OWNED char *from = join(output->aside, *name, err);
        SF_OWNED char *to = from ? join(output->directory, *name, err) : NULL;
        if (to && access(from, F_OK) != 0) {
            if (unlink(to) != 0 && errno != ENOENT)
                SF_FAIL(err, SF_ERR_IO, "the old %s cannot be removed: %s", to, strerror(errno));
        } else if (to) {
            sf_replace_commit(from, to, err);
        }
    }
    SF_TRY(err->status);
    if (output->created)
        sf_replace_sync_name(output->directory);
    output->created = false;
    remove_flat(AT_FDCWD, output->aside);
    sf_release(&output->aside);
    return SF_OK;
}

void sf_staging_end(sf_staging *output) {
    if (output->aside)
        remove_flat(AT_FDCWD, output->aside);
    if (output->created)
        rmdir(output->directory);
    SF_CLEAR(output, output->aside, output->directory);
}

/* ---- a new folder of folders ---- */

static sf_status check_place(const char *path, bool *there, sf_error *err) {
    struct stat info;
    if (!*path)
        return SF_REFUSE(err, "the name of the new folder is empty");
    *there = lstat(path, &info) == 0;
    if (*there && (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
        return SF_REFUSE(err, "%s exists and is not a folder: give another name", path);
    if (*there && access(path, W_OK | X_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be written in: %s", path, strerror(errno));
    if (*there)
        return sf_folder_count(path, "") == 0
                   ? SF_OK
                   : SF_REFUSE(err, "the folder %s exists and is not empty: give another name", path);
    return sf_replace_check_folder(path, err);
}

/* Without the slashes at its end, as rename and the name aside need it. */
static char *copy_name(const char *path) {
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    return strndup(path, length);
}

/* Gives the folder the mode that mkdir would give; mkdtemp lets only the owner in. */
static void open_to_others(const char *path) {
    mode_t mask = umask(0);
    umask(mask);
    if (chmod(path, 0777 & ~mask) != 0)
        return; /* a file system without modes */
}

sf_status sf_tree_begin(const char *path, sf_tree *tree, sf_error *err) {
    *tree = (sf_tree){0};
    SF_TRY(check_place(path, &tree->there, err));
    tree->path = copy_name(path);
    if (!tree->path ||
        asprintf(&tree->aside, "%s%s.partial-XXXXXX", tree->path, tree->there ? "/" : "") < 0) {
        tree->aside = NULL;
        return SF_NO_MEMORY(err, "the path %s", path);
    }
    if (!mkdtemp(tree->aside)) {
        SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
        sf_release(&tree->aside);
        return err->status;
    }
    open_to_others(tree->aside);
    return SF_OK;
}

static sf_status path_in(const char *folder, const char *name, char path[PATH_MAX], sf_error *err) {
    return sf_path_print(path, PATH_MAX, err, "%s/%s", folder, name);
}

static bool is_made(const sf_tree *tree, const char *name) {
    for (int k = 0; k < tree->count; k++)
        if (strcmp(tree->made[k], name) == 0)
            return true;
    return false;
}

/* Notes the name of what is made next. */
static sf_status note(sf_tree *tree, const char *name, size_t length, sf_error *err) {
    char *copy = sf_grow(&tree->made, (size_t)tree->count, sizeof *tree->made) ? strndup(name, length) : NULL;
    if (!copy)
        return SF_NO_MEMORY(err, "the files of %s", tree->path);
    tree->made[tree->count++] = copy;
    return SF_OK;
}

static sf_status make_folders(sf_tree *tree, const char *name, sf_error *err) {
    char path[PATH_MAX];
    for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
        SF_PRINTED(folder, PATH_MAX, "%.*s", (int)(slash - name), name);
        if (is_made(tree, folder))
            continue;
        SF_TRY(path_in(tree->aside, folder, path, err));
        if (mkdir(path, 0777) != 0)
            return SF_FAIL(err, SF_ERR_IO, "the folder %s cannot be made: %s", path, strerror(errno));
        SF_TRY(note(tree, folder, strlen(folder), err));
    }
    return SF_OK;
}

sf_status sf_tree_put(sf_tree *tree, const char *name, const char *text, size_t size, sf_error *err) {
    char path[PATH_MAX];
    SF_TRY(path_in(tree->aside, name, path, err));
    SF_TRY(make_folders(tree, name, err));
    FILE *file = sf_replace_create(path, err);
    SF_TRY(err->status);
    note(tree, name, strlen(name), err);
    bool done = fwrite(text, 1, size, file) == size && fflush(file) == 0 && fsync(fileno(file)) == 0;
    if (fclose(file) != 0 || !done)
        SF_FAIL(err, SF_ERR_IO, SF_NOT_WRITTEN, path);
    return err->status;
}

/* Never onto something; some file systems cannot promise that. */
static sf_status move_one(const char *from, const char *to, sf_error *err) {
    if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0 ||
        ((errno == EINVAL || errno == ENOSYS) && access(to, F_OK) != 0 && rename(from, to) == 0))
        return SF_OK;
    if (errno == EEXIST || errno == ENOTEMPTY || errno == ENOTDIR)
        return SF_REFUSE(err, "%s has come to be meanwhile: give another name", to);
    return SF_FAIL(err, SF_ERR_IO, "%s cannot be moved to %s: %s", from, to, strerror(errno));
}

/* Into the empty folder that is there, one by one. */
static sf_status move_into(sf_tree *tree, sf_error *err) {
    char from[PATH_MAX], to[PATH_MAX];
    for (int k = 0; k < tree->count; k++)
        if (!strchr(tree->made[k], '/') &&
            (path_in(tree->aside, tree->made[k], from, err) != SF_OK ||
             path_in(tree->path, tree->made[k], to, err) != SF_OK || move_one(from, to, err) != SF_OK))
            return err->status;
    rmdir(tree->aside);
    return SF_OK;
}

sf_status sf_tree_commit(sf_tree *tree, sf_error *err) {
    SF_TRY(tree->there ? move_into(tree, err) : move_one(tree->aside, tree->path, err));
    sf_replace_sync_name(tree->path);
    sf_release(&tree->aside);
    return SF_OK;
}

void sf_tree_end(sf_tree *tree) {
    sf_error none = SF_ERROR_INIT;
    char path[PATH_MAX];
    while (tree->count > 0) {
        const char *name = tree->made[--tree->count];
        if (tree->aside && path_in(tree->aside, name, path, &none) == SF_OK)
            remove(path);
        free(tree->made[tree->count]);
    }
    if (tree->aside)
        rmdir(tree->aside);
    SF_CLEAR(tree, tree->made, tree->aside, tree->path);
}
